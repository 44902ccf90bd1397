"""Second derivatives of values, by extrapolated differences of exact first ones."""

from __future__ import annotations

import math
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
from symrender.scene.scales import scale_of
from symrender.settings import Filter
from symrender.truth import truth

Array = npt.NDArray[np.float64]

FIRST: Final = 2.0**-5
"""Largest step, over the scale of the parameter."""
RATIO: Final = math.exp(-1.0)
"""Ratio of each step to the one before it.

The steps are incommensurate: they are not all whole multiples of one length. Halved steps that are multiples of the
period of a texture or a bump see a constant on several levels, and agree on it.
"""
LEAST: Final = 7
"""Smallest number of steps."""
MOST: Final = 34
"""Largest number of steps; the last is then 5e-15 of the first."""
ORDERS: Final = 6
"""Largest number of extrapolations; each of them uses one coarser step more."""
FINER: Final = 2
"""Number of finer steps that must agree with a step before it is accepted."""
NARROWEST: Final = 2.0**-20
"""Part of the first step at least that must fit between the parameter and the end of its range."""
ROUNDED: Final = 1e-14
"""Part of a value or a slope that its mean may be off by roundings, beside what is stated."""
FINEST: Final = 64.0
"""Smallest step, in units of the last place of the parameter."""
GROWTH: Final = 4.0
"""How many times the least error what means miss at finer steps may come to; beyond, no step is small enough."""
BOTH_SIDES: Final = 4.0
"""What a mean that misses its middle counts for.

Where the second derivative jumps by J at the very value, slopes on both sides have a mean that misses the middle one by
J/2 of the step, of which extrapolation over ``RATIO`` leaves at least .7; either side's second derivative is J/2 from
their mean.
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
    columns = [_column(loaded, name, at, look, middle) for at, name in enumerate(names)]
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


@dataclass
class _Level:
    """Second derivatives (Q, ..., 3) by one step and coarser ones, their error, what means ``missed`` (Q, ...)."""

    value: Array
    error: Array
    missed: Array

    @classmethod
    def unknown(cls, like: Array) -> _Level:
        """Nothing is known of second derivatives of the shape ``like``."""
        none = np.zeros(like.shape[:-1])
        return cls(np.zeros_like(like), none + np.inf, none)

    def take(self, other: _Level) -> None:
        """Take what ``other`` knows better."""
        better = other.error < self.error
        self.value = np.where(better[..., None], other.value, self.value)
        self.missed = np.where(better, other.missed, self.missed)
        self.error = np.minimum(self.error, other.error)

    def heed(self, finer: _Level) -> None:
        """Let the error hold what a finer step says: its value, within its own error, and what its means miss."""
        self.error = np.fmax(self.error, np.abs(self.value - finer.value).max(axis=-1) - finer.error)
        self.missed = np.maximum(self.missed, finer.missed)


@dataclass(frozen=True)
class _Differences:
    """Central differences, extrapolated from the steps between ``step`` and ``coarsest``.

    ``slope`` (Q, ..., 3) is the derivative of the slopes, ``doubt`` (Q, ...) its error from those of the slopes.
    ``even`` (Q + 2, ..., 3) holds what is known at the middle: slopes and the value as means of both sides, and the
    slope in the parameter as the difference quotient of the value; ``even_doubt`` (Q + 2, ...).
    """

    step: float
    coarsest: float
    slope: Array
    doubt: Array
    even: Array
    even_doubt: Array

    def extrapolated(self, coarse: _Differences) -> _Differences:
        """One order higher, by Neville's rule in the square of the step."""
        share = 1.0 / ((coarse.coarsest / self.step) ** 2 - 1.0)
        return _Differences(
            self.step, coarse.coarsest,
            self.slope + (self.slope - coarse.slope) * share, (1.0 + share) * self.doubt + share * coarse.doubt,
            self.even + (self.even - coarse.even) * share, (1.0 + share) * self.even_doubt + share * coarse.even_doubt,
        )  # fmt: skip


def _column(
    scene: AnyScene, name: str, at: int, look: Callable[[AnyScene], _Found], middle: _Found
) -> tuple[Array, Array]:
    """Derivative of all slopes in the parameter ``name``, number ``at`` of them, (Q, ..., 3), and its error (Q, ...).

    A finer step has a smaller error of truncation, and a larger one from the errors of the slopes, which it divides.
    The error of a step is at least what keeps it within the error of every finer one. The ladder ends where the errors
    of the slopes alone, over the step, exceed the best error found.
    """
    value = float(get(scene, name))
    first, finest = _first_step(scene, name, value), FINEST * float(np.spacing(abs(value)))
    levels: list[_Level] = []
    rows: list[_Differences] = []
    best = _Level.unknown(middle.slopes)
    unresolved = ~np.isfinite(best.error)
    for number in range(MOST):
        above = value + first * RATIO**number
        # the step that is taken: the one asked for is rounded
        step = above - value
        if step < finest:
            break
        sides = look(scene.replace({name: above})), look(scene.replace({name: value - step}))
        row = [_differences(sides, middle, step)]
        found, least = _Level.unknown(middle.slopes), np.full(best.error.shape, np.inf)
        for coarse in rows[:ORDERS]:
            row.append(row[-1].extrapolated(coarse))
            fine, (missed, surely) = row[-1], _missed(row[-1], sides, middle, at)
            change = np.maximum(np.abs(fine.slope - row[-2].slope), np.abs(fine.slope - coarse.slope)).max(axis=-1)
            found.take(_Level(fine.slope, change + fine.doubt + missed, surely))
            least = np.minimum(least, surely)
        found.missed = least if rows else found.missed
        for level in levels:
            level.heed(found)
        rows, levels, best = row, [*levels, found], _Level.unknown(middle.slopes)
        for level in levels[:-FINER]:
            best.take(level)
        unresolved = best.missed > GROWTH * best.error
        if number + 1 >= LEAST and not ((best.error > row[0].doubt) | unresolved).any():
            break
    return best.value, np.where(unresolved, np.inf, np.maximum(best.error, best.missed))


def _differences(sides: tuple[_Found, _Found], middle: _Found, step: float) -> _Differences:
    """What ``step`` on both sides tells."""
    above, below = sides
    stated = (above.slope_error + below.slope_error) / 2.0
    value_stated = ((above.value_error + below.value_error) / 2.0)[None]
    mean, quotient = (above.value + below.value) / 2.0, (above.value - below.value) / (2.0 * step)
    return _Differences(
        step, step, (above.slopes - below.slopes) / (2.0 * step), (stated + middle.slope_error) / step,
        np.concatenate([(above.slopes + below.slopes) / 2.0, mean[None], quotient[None]]),
        np.concatenate([stated, value_stated, value_stated / step]),
    )  # fmt: skip


def _first_step(scene: AnyScene, name: str, value: float) -> float:
    """The largest step for which there are scenes on both sides, halved from ``FIRST`` of its scale."""
    first = step = FIRST * scale_of(scene, name)
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


def _missed(found: _Differences, sides: tuple[_Found, _Found], middle: _Found, at: int) -> tuple[Array, Array]:
    """What second derivatives may be off by, and surely are, (Q, ...), because the light has an event within the step.

    Means of both sides and the difference quotient of the value, extrapolated, are those of the middle. What they miss
    counts from half of what roundings may explain on, so that an event which these hide is in one or the other.
    """
    known = np.concatenate([middle.slopes, middle.value[None], middle.slopes[at : at + 1]])
    stated = np.concatenate([middle.slope_error, middle.value_error[None], middle.slope_error[at : at + 1]])
    # an event at the very middle is in what is stated there, but not beside it
    stated = found.even_doubt + np.minimum(stated, 4.0 * found.even_doubt) + ROUNDED * np.abs(known).max(axis=-1)
    off = np.abs(found.even - known).max(axis=-1)
    sizes = np.max([np.abs(each.slopes).max(axis=-1) for each in (*sides, middle)], axis=0)
    # what is said of the slope in the parameter holds in proportion for the slopes in others
    share = np.divide(sizes, sizes[at], out=np.zeros_like(sizes), where=sizes[at] > 0.0)
    share[at] = 1.0

    def of_second(even: Array) -> Array:
        slopes = np.maximum(even[:-2], even[-1] * share)
        return np.asarray(BOTH_SIDES * np.maximum(slopes / found.step, even[-2] / found.step**2))

    return of_second(np.where(off > 0.5 * stated, off, 0.0)), of_second(np.maximum(off - stated, 0.0))
