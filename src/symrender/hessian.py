"""Second derivatives of values, by extrapolated differences of exact first ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError, SceneError, Unsupported
from symrender.gradient import gradient
from symrender.probe import probe
from symrender.probe_rays import Rays
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import components
from symrender.scene.parameters import get
from symrender.settings import Filter
from symrender.truth import truth

Array = npt.NDArray[np.float64]

LEVELS: Final = 9
"""Steps of the extrapolation, each half the last; more, up to MOST, while a step still halves an error."""
MOST: Final = 22
FIRST_STEP: Final = 2.0**-6
"""Largest step, over the parameter's size or over 1 where it is smaller."""
NARROWEST: Final = 2.0**-20
"""Part of the first step at least that must fit between the parameter and the end of its range."""
ROUNDED: Final = 1e-14
"""Part of a value or a slope that its mean may be off by roundings, beside what is stated."""
GROWTH: Final = 4.0
"""How many times the least error what means miss at the smallest step may come to; beyond, no step is small enough."""
BOTH_SIDES: Final = 4.0
"""What a mean that misses its middle counts for.

Where the second derivative jumps by J at the very value, slopes on both sides have a mean that misses the middle one by
J/4 of the step, of which extrapolation leaves at least .6; either side's second derivative is J/2 from their mean.
"""


@dataclass(frozen=True)
class Hessian:
    """Second derivatives by Q parameters.

    Attributes
    ----------
    names : tuple of str
        The parameters.
    values : ndarray
        (Q, Q, ..., 3), symmetric in the first two axes; ``...`` is N for points and rays, (h, w) for an image.
    error : ndarray
        Estimated largest absolute error over the channels, (Q, Q, ...); infinite without a finite derivative.
    """

    names: tuple[str, ...]
    values: Array
    error: Array


@dataclass(frozen=True)
class _Found:
    """Of one scene: slopes (Q, ..., 3) and values (..., 3) with their errors (Q, ...) and (...)."""

    slopes: Array
    slope_error: Array
    value: Array
    value_error: Array


def hessian(
    scene: Source,
    wrt: Sequence[str],
    points: npt.ArrayLike | None = None,
    *,
    rays: Rays | None = None,
    surface: str = "floor",
    size: int | tuple[int, int] | None = None,
    tol: float = 1e-11,
    disk: str = "2x2",
    filter: Filter = "centre",
    filter_radius: float = 0.0,
) -> Hessian:
    """Compute second derivatives of ``probe`` at points or along rays, or of ``truth`` at a size.

    Use it for single points and small images: it takes eighteen gradients a parameter and more.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    wrt : sequence of str
        Dotted names of real numbers; a vector stands for its components.
    points : array_like, optional
        Points of a surface, as for ``probe`` (scenes in units of the series).
    rays : (origins, directions), optional
        Rays through a radiometric scene, (N, 3) each.
    surface : str
        The surface of the points.
    size : int or (int, int), optional
        Size of an image, instead of points or rays.
    tol : float
        Absolute error asked of the gradients.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points, ``"exact"`` integrates it (scenes in units of the series).
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}
        What a pixel is: the ray through its centre, or the weighted mean over a square about it.
    filter_radius : float
        Half the width of the filter in pixels, 0.5 to 2; 0 takes the filter's own.

    Returns
    -------
    Hessian
        Values (Q, Q, ..., 3) and errors (Q, Q, ...).

    Raises
    ------
    OptionError
        Not exactly one of points, rays and size is given, or a filter without a size.
    SceneError
        A name is not a real number.
    Unsupported
        A parameter is at the end of its range.

    See Also
    --------
    gradient : First derivatives.

    Notes
    -----
    Each column is a central difference of exact gradients, extrapolated over halved steps (C. J. F. Ridders, Advances
    in Engineering Software 4, 1982, doi:10.1016/S0141-1195(82)80057-0). The step of least estimated error is taken
    point by point. Values and slopes on both sides must have the middle ones as their mean, by the same extrapolation;
    their deviation is part of ``error``, which is infinite where the second derivative does not exist.

    Examples
    --------
    >>> import symrender as sr
    >>> name = "materials.gold05.alpha"
    >>> curve = sr.hessian("metal", [name], rays=([0, -9.5, 3.1], [0, 9.5, -2.5]))
    >>> curve.values.shape
    (1, 1, 1, 3)
    """
    loaded = load_any(scene)
    names = components(loaded, wrt)
    if sum(given is not None for given in (points, rays, size)) != 1:
        raise OptionError("points, rays, size: give points of a surface, rays, or the size of an image")
    if size is None and filter != "centre":
        raise OptionError(f"filter: single points and rays have none, got {filter}")

    def look(changed: AnyScene) -> _Found:
        if size is None:
            return _probed(changed, names, points, rays, surface, tol, disk)
        asked: dict[str, Any] = {
            "size": size, "tol": tol, "disk": disk, "filter": filter, "filter_radius": filter_radius
        }  # fmt: skip
        images, image = gradient(changed, names, **asked), truth(changed, **asked)
        return _Found(
            np.stack([images[name].radiance for name in names]),
            np.stack([images[name].layer("error") for name in names]),
            image.radiance, image.layer("error"),
        )  # fmt: skip

    middle = look(loaded)
    columns = [_column(loaded, name, look, middle) for name in names]
    values = np.stack([value for value, _ in columns], axis=1)
    error = np.stack([estimate for _, estimate in columns], axis=1)
    # the two orders of differentiation are two estimates of one number
    flipped, flipped_error = values.swapaxes(0, 1), error.swapaxes(0, 1)
    best = np.where((flipped_error < error)[..., None], flipped, values)
    apart = np.abs(values - flipped).max(axis=-1)
    return Hessian(names, best, np.minimum(error, flipped_error) + np.minimum(apart, np.maximum(error, flipped_error)))


def _probed(
    scene: AnyScene, names: tuple[str, ...], points: npt.ArrayLike | None, rays: Rays | None, surface: str, tol: float,
    disk: str,
) -> _Found:  # fmt: skip
    """What ``probe`` finds at points or along rays."""
    if rays is not None:
        sent = probe(scene, rays=rays, tol=tol, wrt=names)
        slopes, stated = sent.gradient, sent.gradient_error
        value, error = sent.radiance, sent.error
    else:
        assert points is not None
        found = probe(scene, points, surface=surface, tol=tol, disk=disk, wrt=names)
        slopes, stated = found.gradient, found.gradient_error
        value, error = found.gloss, found.error
    return _Found(np.stack([slopes[n] for n in names]), np.stack([stated[n] for n in names]), value, error)


def _column(scene: AnyScene, name: str, look: Callable[[AnyScene], _Found], middle: _Found) -> tuple[Array, Array]:
    """Derivative of all slopes in one parameter, (Q, ..., 3), and its error (Q, ...).

    A difference divides the errors of the slopes by its step: small steps that agree on an error of the slopes are no
    better for it.
    """
    value = float(get(scene, name))
    step = _first_step(scene, name, value)
    rows: list[tuple[Array, Array]] = []
    doubts: list[tuple[Array, Array]] = []
    best, error = np.zeros_like(middle.slopes), np.full(middle.slope_error.shape, np.inf)
    nowhere = ~np.isfinite(middle.slope_error)
    for level in range(MOST):
        above, below = (look(scene.replace({name: value + s})) for s in (step, -step))
        slope, stated = (above.slopes - below.slopes) / (2.0 * step), (above.slope_error + below.slope_error) / 2.0
        row = [(slope, 0.5 * (_both(above) + _both(below)))]
        doubt = [
            (np.where(nowhere, np.inf, (stated + middle.slope_error) / step), 0.5 * (_stated(above) + _stated(below)))
        ]
        before, missed = error, np.zeros_like(error)
        for k, (coarse, doubted) in enumerate(zip(rows, doubts, strict=True)):
            share = 1.0 / (4.0 ** (k + 1) - 1.0)
            slope, mean = (fine + (fine - far) * share for fine, far in zip(row[k], coarse, strict=True))
            blur = [(1.0 + share) * fine + share * far for fine, far in zip(doubt[k], doubted, strict=True)]
            row.append((slope, mean))
            doubt.append((blur[0], blur[1]))
            change = np.maximum(np.abs(slope - row[k][0]), np.abs(slope - coarse[0])).max(axis=-1) + blur[0]
            missed = _missed(middle, mean, blur[1], step)
            better = change + missed < error
            best, error = np.where(better[..., None], slope, best), np.where(better, change + missed, error)
        unresolved = missed > GROWTH * error
        if level + 1 >= LEVELS and not ((error < 0.5 * before) | unresolved).any():
            break
        rows, doubts = row, doubt
        step *= 0.5
    return best, np.where(unresolved, np.inf, error)


def _first_step(scene: AnyScene, name: str, value: float) -> float:
    """The largest step for which there are scenes on both sides, halved from ``FIRST_STEP``."""
    first = step = FIRST_STEP * max(1.0, abs(value))
    while True:
        try:
            for side in (step, -step):
                scene.replace({name: value + side})
            return step
        except SceneError as fault:
            step *= 0.5
            if step < NARROWEST * first:
                said = f"{name}: no second derivative at the end of its range, {value:g}: {fault}"
                raise Unsupported(said) from None


def _both(found: _Found) -> Array:
    """Slopes, and values as the last of them."""
    return np.concatenate([found.slopes, found.value[None]])


def _stated(found: _Found) -> Array:
    """The errors of ``_both``."""
    return np.concatenate([found.slope_error, found.value_error[None]])


def _missed(middle: _Found, mean: Array, blur: Array, step: float) -> Array:
    """What means of slopes and of values, extrapolated to the middle, say of events within ``step``: (Q, ...)."""
    known = _both(middle)
    off = np.abs(mean - known).max(axis=-1) - blur - _stated(middle) - ROUNDED * np.abs(known).max(axis=-1)
    off = np.where(off > 0.0, off, 0.0)
    return np.asarray(BOTH_SIDES * np.maximum(off[:-1] / step, off[-1] / (step * step)))
