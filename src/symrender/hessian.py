"""Second derivatives of the lobe integral, by extrapolated differences of exact first ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError, SceneError, Unsupported
from symrender.gradient import gradient
from symrender.probe import probe
from symrender.scene.load import load
from symrender.scene.moves import components
from symrender.scene.parameters import get
from symrender.scene.scene import Scene

Array = npt.NDArray[np.float64]

LEVELS: Final = 9
"""Steps of the extrapolation, each half the last."""
FIRST_STEP: Final = 2.0**-6
"""Largest step, over the parameter's size or over 1 where it is smaller."""


@dataclass(frozen=True)
class Hessian:
    """Second derivatives in Q parameters ``names``.

    ``values`` (Q, Q, ..., 3), symmetric in the first two axes; ``error`` (Q, Q, ...) the estimated largest absolute
    error over the channels. ``...`` is N for points, (h, w) for an image.
    """

    names: tuple[str, ...]
    values: Array
    error: Array


def hessian(
    scene: Scene | str | Path | Mapping[str, Any],
    wrt: Sequence[str],
    points: npt.ArrayLike | None = None,
    *,
    surface: str = "floor",
    size: int | tuple[int, int] | None = None,
    tol: float = 1e-11,
    disk: str = "2x2",
) -> Hessian:
    """Second derivatives of ``probe`` at ``points`` of ``surface``, or of ``truth``'s radiance at ``size``.

    Each column is a central difference of exact gradients, whose structure is found anew on both sides, extrapolated
    over halved steps (C. J. F. Ridders, Advances in Engineering Software 4, 1982,
    doi:10.1016/S0141-1195(82)80057-0); the step of least estimated error is taken point by point, so an event inside
    a larger step only costs that step. ``tol`` is the gradients' own. Choose it for single points and small images: it
    takes eighteen gradients a parameter. Raises Unsupported for a parameter at the end of its range.
    """
    loaded = load(scene, "hessian")
    names = components(loaded, wrt)
    if (points is None) == (size is None):
        raise OptionError("points, size: give points of a surface or the size of an image")

    def slopes(changed: Scene) -> tuple[Array, Array]:
        if points is not None:
            found = probe(changed, points, surface=surface, tol=tol, disk=disk, wrt=names)
            stated = np.stack([found.gradient_error[name] for name in names])
            return np.stack([found.gradient[name] for name in names]), stated
        assert size is not None
        images = gradient(changed, names, size=size, tol=tol, disk=disk)
        stated = np.stack([images[name].layer("error") for name in names])
        return np.stack([images[name].radiance for name in names]), stated

    columns = [_column(loaded, name, slopes) for name in names]
    values = np.stack([value for value, _ in columns], axis=1)
    error = np.stack([estimate for _, estimate in columns], axis=1)
    # the two orders of differentiation are two estimates of one number
    flipped, flipped_error = values.swapaxes(0, 1), error.swapaxes(0, 1)
    best = np.where((flipped_error < error)[..., None], flipped, values)
    apart = np.abs(values - flipped).max(axis=-1)
    return Hessian(names, best, np.minimum(error, flipped_error) + np.minimum(apart, np.maximum(error, flipped_error)))


def _column(scene: Scene, name: str, slopes: Callable[[Scene], tuple[Array, Array]]) -> tuple[Array, Array]:
    """Derivative of all slopes in one parameter, (Q, ..., 3), and its error (Q, ...).

    ``slopes`` gives them with their errors (Q, ...), which a difference divides by its step: small steps that agree on
    an error of the slopes are no better for it.
    """
    value = float(get(scene, name))
    step = FIRST_STEP * max(1.0, abs(value))
    rows: list[Array] = []
    doubts: list[Array] = []
    best: Array | None = None
    error: Array | None = None
    for _ in range(LEVELS):
        try:
            above, below = (slopes(scene.replace({name: value + s})) for s in (step, -step))
        except SceneError as fault:
            raise Unsupported(f"{name}: no second derivative at the end of its range, {value:g}: {fault}") from None
        row = [(above[0] - below[0]) / (2.0 * step)]
        doubt = [(above[1] + below[1]) / (2.0 * step)]
        for k, coarse in enumerate(rows):
            share = 1.0 / (4.0 ** (k + 1) - 1.0)
            row.append(row[k] + (row[k] - coarse) * share)
            doubt.append((1.0 + share) * doubt[k] + share * doubts[k])
            change = np.maximum(np.abs(row[k + 1] - row[k]), np.abs(row[k + 1] - coarse)).max(axis=-1) + doubt[k + 1]
            if best is None or error is None:
                best, error = row[k + 1], change
            else:
                better = change < error
                best = np.where(better[..., None], row[k + 1], best)
                error = np.where(better, change, error)
        rows, doubts = row, doubt
        step *= 0.5
    assert best is not None and error is not None
    return best, error
