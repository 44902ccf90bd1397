"""What the tests of an audit look at: measured less truth, its variance, and what is allowed for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.audit.measured import SINGLE, Measured
from symrender.audit.reach import Reach

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

NOISE_FREE: Final = 1e-4
"""Relative margin within which a render without noise is taken for equal to the truth."""
_DARK: Final = 1e-2
"""Share of the image's mean that counts as light where a relative margin is asked of a dark pixel."""
_GROUPS: Final = 10
_DOUBLE: Final = 1e-14
"""Relative rounding of sums of 64 bits."""
_QUIET: Final = 1e-5
"""Scatter of samples over the radiance below which a pixel is one without noise."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the tests look at: measured mean less truth, the variance of a pixel's mean, and what is allowed for.

    ``truth``, ``difference``, ``variance``, ``pooled`` and ``allowance`` are (h, w, c), ``usable`` (h, w). ``pooled``
    is the mean variance of pixels of one shape and like light, which does not follow a pixel's own luck, and
    ``usual`` that of the whole shape. ``margin`` (h, w, c) is the part of ``allowance`` that is the equivalence margin.
    ``aside`` (h, w): pixels that are not usable because the truth changes by too much within reach of their rays.
    """

    measured: Measured
    truth: Array
    difference: Array
    variance: Array
    pooled: Array
    usual: Array
    allowance: Array
    margin: Array
    usable: Mask
    aside: Mask
    spread: float

    @property
    def channels(self) -> tuple[int, ...]:
        """Indices of the channels, one where all are equal."""
        grey = all(np.array_equal(a[..., 0], a[..., c]) for a in (self.truth, self.measured.mean) for c in (1, 2))
        return (0,) if grey else (0, 1, 2)

    def channel(self, index: int) -> str:
        """Its name."""
        return "grey" if len(self.channels) == 1 else self.measured.channels[index]


class Margin(NamedTuple):
    """A difference of this part of the radiance, plus this absolute size, does not count."""

    relative: float
    absolute: float

    @classmethod
    def usual(cls, measured: Measured, light: float) -> Margin:
        """The margin where none is asked for; ``light`` is the mean of the truth."""
        relative = NOISE_FREE if measured.source == "none" else SINGLE if measured.single else 0.0
        return cls(relative, _DARK * relative * light)

    def of(self, truth: Array) -> Array:
        """The margin of every value."""
        return np.asarray(self.relative * np.abs(truth) + self.absolute)


def evidence(
    measured: Measured,
    radiance: Array,
    error: Array,
    classes: Array | None,
    margin: Margin | None = None,
    reach: Reach | None = None,
) -> Evidence:
    """What was measured, with the truth ``radiance`` (h, w, 3) of stated ``error`` (h, w), infinite if unknown.

    What the truth changes by within ``reach`` of the renderer's rays is allowed for, and where it exceeds the margin of
    a render without noise, or a larger ``margin``, the pixel is set aside.
    """
    usable = np.isfinite(error) & measured.origin.held(*error.shape)
    truth = measured.of(np.where(usable[..., None], radiance, 0.0))
    to = np.abs(measured.basis)
    bound = np.where(usable, error, 0.0)[..., None] * to.sum(axis=1)
    light = float(np.abs(truth).mean())
    quiet = Margin(NOISE_FREE, _DARK * NOISE_FREE * light).of(truth)
    equal = (margin or Margin.usual(measured, light)).of(truth)
    if margin is None and measured.single:
        # what all samples agree on has the arithmetic of a whole renderer, and no scatter that would excuse it
        equal = np.where(measured.variance * measured.samples <= (_QUIET * truth) ** 2, quiet, equal)
    moves, smooth = (np.zeros_like(truth),) * 2 if reach is None else (reach.change @ to.T, reach.smooth @ to.T)
    aside = usable & (moves > np.maximum(equal, quiet)).any(axis=-1)
    usable = usable & ~aside
    rounding = _DOUBLE * np.abs(truth) + measured.origin.rounding(measured.mean)
    allowance = bound + rounding + equal + smooth + np.where(usable[..., None], moves, 0.0)
    pooled = _pooled(measured.variance, truth, classes, usable | aside, _GROUPS)
    usual = _pooled(measured.variance, truth, classes, usable | aside, 1)
    difference = np.where((usable | aside)[..., None], measured.mean - truth, 0.0)
    spread = 1.0 if measured.seeds is not None else _correlation(difference, pooled, usable)
    return Evidence(
        measured, truth, difference, measured.variance, pooled, usual, allowance, equal, usable, aside, spread
    )


def _pooled(variance: Array, truth: Array, classes: Array | None, usable: Mask, groups: int) -> Array:
    """Mean variance over the pixels of a class that are of like light, ``groups`` of equal number a channel."""
    found = variance.copy()
    labels = np.zeros(usable.shape) if classes is None else classes
    for code in np.unique(labels):
        rows = np.flatnonzero(((labels == code) & usable).ravel())
        if not len(rows):
            continue
        for c in range(variance.shape[2]):
            order = rows if groups == 1 else rows[np.argsort(truth[..., c].ravel()[rows])]
            flat = found[..., c].reshape(-1)
            source = variance[..., c].ravel()
            for part in np.array_split(order, max(1, min(groups, len(order) // 16))):
                flat[part] = source[part].mean()
            found[..., c] = flat.reshape(usable.shape)
    return found


def _correlation(difference: Array, pooled: Array, usable: Mask) -> float:
    """By what factor the variance of a sum exceeds the sum of variances, from neighbours' residuals; at least 1.

    Lags of up to two pixels, which a reconstruction filter reaches. A bias that is smooth raises it too, so it can
    only make a mean harder to reject.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.where(usable[..., None] & (pooled > 0), difference / np.sqrt(pooled), 0.0)[..., 1]
    z = z - z.mean()
    power = float((z * z).sum())
    if power <= 0.0:
        return 1.0
    factor, doubt = 1.0, 4.0 / math.sqrt(max(int((z != 0).sum()), 1))
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)):
        a = z[dy:, max(dx, 0) : z.shape[1] + min(dx, 0)]
        b = z[: z.shape[0] - dy, max(-dx, 0) : z.shape[1] + min(-dx, 0)]
        r = float((a * b).sum()) / power
        factor += 2.0 * r if r > doubt else 0.0
    return factor
