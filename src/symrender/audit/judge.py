"""The tests: signed means of regions, the scale of the whole, every pixel by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.distributions import critical, detectable, two_sided
from symrender.audit.measured import SINGLE, Measured
from symrender.audit.regions import Region
from symrender.audit.verdict import Finding, Outcome, PixelTest

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

ARITHMETIC: Final = 1e-5
"""Relative error allowed to a renderer without noise that computes in 32 bits, _DOUBLE to one in 64."""
_DOUBLE: Final = 1e-9
_DOMINANT: Final = 0.1
"""Share of a region's variance in one pixel beyond which its sum is not taken for normal."""
_TAIL: Final = 1.0
"""Relative change of a tail by skewness beyond which it is not taken for normal."""
_NOISY: Final = 0.2
"""Standard error of a pixel over its truth beyond which it is not judged alone: its tail is that of few samples."""
_GROUPS: Final = 10
_PROBABLE: Final = 1e-300


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the tests look at: measured mean less truth, the variance of a pixel's mean, and what is allowed for.

    ``truth``, ``difference``, ``variance``, ``pooled`` and ``allowance`` are (h, w, c), ``usable`` (h, w). ``pooled``
    is the mean variance of pixels of one shape and like light, which does not follow a pixel's own luck, and
    ``usual`` that of the whole shape.
    """

    measured: Measured
    truth: Array
    difference: Array
    variance: Array
    pooled: Array
    usual: Array
    allowance: Array
    usable: Mask
    spread: float

    @property
    def channels(self) -> tuple[int, ...]:
        """Indices of the channels, one where all are equal."""
        grey = all(np.array_equal(a[..., 0], a[..., c]) for a in (self.truth, self.measured.mean) for c in (1, 2))
        return (0,) if grey else (0, 1, 2)

    def channel(self, index: int) -> str:
        """Its name."""
        return "grey" if len(self.channels) == 1 else self.measured.channels[index]


def evidence(measured: Measured, radiance: Array, error: Array, classes: Array | None) -> Evidence:
    """What was measured beside the truth ``radiance`` (h, w, 3) of stated ``error`` (h, w), infinite if unknown."""
    usable = np.isfinite(error) & measured.origin.held(*error.shape)
    truth = measured.of(np.where(usable[..., None], radiance, 0.0))
    bound = np.where(usable, error, 0.0)[..., None] * np.abs(measured.basis).sum(axis=1)
    if measured.source == "none":
        # there is nothing but arithmetic then, and it is that of a whole renderer
        size = ARITHMETIC if measured.single else _DOUBLE
        rounding = size * (np.abs(truth) + 1e-2 * np.abs(truth).mean())
    else:
        rounding = (SINGLE if measured.single else 1e-14) * np.abs(truth)
    allowance = bound + rounding + measured.origin.rounding(measured.mean)
    pooled = _pooled(measured.variance, truth, classes, usable, _GROUPS)
    usual = _pooled(measured.variance, truth, classes, usable, 1)
    difference = np.where(usable[..., None], measured.mean - truth, 0.0)
    spread = 1.0 if measured.seeds is not None else _correlation(difference, pooled, usable)
    return Evidence(measured, truth, difference, measured.variance, pooled, usual, allowance, usable, spread)


def region_tests(seen: Evidence, regions: Sequence[Region]) -> list[Finding]:
    """Signed mean of every region and channel, not yet judged together."""
    planes = [Plane.of(seen, c) for c in seen.channels]
    found = []
    for region in regions:
        mask = region.mask & seen.usable
        places = np.flatnonzero(mask)
        if len(places):
            found += [_region(seen, region, mask, places, plane) for plane in planes]
    return found


@dataclass(frozen=True, eq=False)
class Plane:
    """One channel, pixels in a row: what ``Evidence`` holds, and of seeds their images and powers of residuals."""

    name: str
    truth: Array
    difference: Array
    variance: Array
    allowance: Array
    seeds: Array | None
    powers: Array | None

    @classmethod
    def of(cls, seen: Evidence, c: int) -> Plane:
        """Channel ``c``."""
        parts = (seen.truth, seen.difference, seen.variance, seen.allowance)
        truth, difference, variance, allowance = (np.ascontiguousarray(part[..., c]).ravel() for part in parts)
        if seen.measured.seeds is None:
            return cls(seen.channel(c), truth, difference, variance, allowance, None, None)
        images = np.ascontiguousarray(seen.measured.seeds[..., c]).reshape(len(seen.measured.seeds), -1)
        mean = images.mean(axis=0)
        powers = np.zeros((3, images.shape[1]))
        for image in images:
            residual = image - mean
            square = residual * residual
            powers[0] += square
            powers[1] += square * residual
            powers[2] += square * square * square
        return cls(seen.channel(c), truth, difference, variance, allowance, images, powers)


def scale_test(seen: Evidence) -> Finding:
    """Whether the render is the truth times 1 + b, by least squares with weights that the noise of no pixel moves."""
    chosen = list(seen.channels)
    mask = seen.usable
    parts = (seen.truth, seen.difference, seen.pooled, seen.variance, seen.allowance)
    mu, d, pooled, v, a = (part[mask][:, chosen] for part in parts)
    # never far above the weight of the mean variance: where light is rare, quiet pixels have only not met it yet
    weights = 1.0 / (pooled + pooled.mean(axis=0) + a * a + _PROBABLE)
    whole = float((weights * mu * mu).sum())
    if whole <= 0.0:
        return _test("scale", "all", "all", mask, 0.0, 0.0, 0.0, 0.0, math.inf, "the truth is black")
    bias = float((weights * mu * d).sum()) / whole
    allowance = float((weights * np.abs(mu) * a).sum()) / whole
    if seen.measured.seeds is not None:
        weighted = weights * mu
        each = np.array([float((weighted * (s[mask][:, chosen] - mu)).sum()) / whole for s in seen.measured.seeds])
        error, freedom = float(each.std(ddof=1)) / math.sqrt(len(each)), float(len(each) - 1)
    else:
        # channels of a pixel share their samples: their standard errors add
        together = ((weights * mu * np.sqrt(v)).sum(axis=1) ** 2).sum()
        error, freedom = math.sqrt(seen.spread * float(together)) / whole, math.inf
    return _test("scale", "all", "all", mask, 1.0, bias, error, allowance, freedom, "")


def _region(seen: Evidence, region: Region, mask: Mask, places: npt.NDArray[np.intp], plane: Plane) -> Finding:
    count, why = len(places), ""
    d, v = plane.difference[places], plane.variance[places]
    bias, allowance = float(d.mean()), float(plane.allowance[places].mean())
    total = float(v.sum())
    if plane.seeds is not None and plane.powers is not None:
        each = np.array([float(image[places].mean()) for image in plane.seeds])
        error, freedom = float(each.std(ddof=1)) / math.sqrt(len(each)), float(len(each) - 1)
        skew = _skewness(*(float(power[places].sum()) for power in plane.powers))
    else:
        error = math.sqrt(seen.spread * total) / count
        squares = float((v * v).sum())
        freedom = total**2 / squares * seen.measured.freedom if squares > 0 else math.inf
        freedom = math.inf if freedom > 1e4 else max(freedom, 1.0)
        square = (d - bias) ** 2
        skew = _skewness(float(square.sum()), float((square * (d - bias)).sum()), float((square**3).sum()))
    if total > 0.0:
        why = _unsafe(float(v.max()) / total, skew, min(freedom, 1e4))
    mean = float(plane.truth[places].mean())
    return _test("mean", region.name, plane.name, mask, mean, bias, error, allowance, freedom, why)


def _unsafe(dominant: float, skew: float, freedom: float) -> str:
    """Why a sum must not be taken for normal, or nothing."""
    if dominant > _DOMINANT:
        return f"heavy tails: one pixel carries {100 * dominant:.0f} % of the variance"
    # first term of Edgeworth's series of a mean over its estimated error, at the edge of a level of 1e-4
    z = critical(1e-4)
    if freedom < 100.0 or abs(skew) * (2.0 * z * z + 1.0) / 6.0 * z < _TAIL:
        return ""
    return f"heavy tails: skewness {skew:+.2g} of the mean moves its tail"


def _skewness(second: float, third: float, sixth: float) -> float:
    """Skewness of a sum whose terms' residuals have these sums of powers, less twice its own standard error."""
    if second <= 0.0:
        return 0.0
    left = max(abs(third) - 2.0 * math.sqrt(sixth), 0.0)
    return float(math.copysign(left, third) / second**1.5)


def _test(
    name: str, region: str, channel: str, mask: Mask, truth: float, bias: float, error: float, allowance: float,
    freedom: float, why: str,
) -> Finding:  # fmt: skip
    beyond = math.copysign(max(abs(bias) - allowance, 0.0), bias)
    if error > 0.0:
        z = beyond / error
        p = float(two_sided(z, freedom)[0])
    else:
        z = math.copysign(math.inf, bias) if beyond else 0.0
        p = 0.0 if beyond else 1.0
    return Finding(
        name, region, channel, int(mask.sum()), truth, bias, error, allowance, freedom, z, p, p, 0.0,
        "not judged" if why else "passed", why,
    )  # fmt: skip


def judged(tests: Sequence[Finding], level: float) -> list[Finding]:
    """Holm over the tests that are safe to judge; every one gets its adjusted p and its smallest visible bias.

    A test that is not safe fails none the less for too much light, and for too little where Chebyshev's inequality,
    which holds for every distribution of known variance, rejects it.
    """
    count = max(len(tests), 1)
    # ordered by what each may be judged by: by its own p an unsafe test would come first and shield all after it
    ps = [_judged_by(test) for test in tests]
    adjusted, largest = {}, 0.0
    for rank, k in enumerate(sorted(range(len(tests)), key=ps.__getitem__)):
        largest = max(largest, min(1.0, (count - rank) * ps[k]))
        adjusted[k] = largest
    found = []
    for k, test in enumerate(tests):
        visible = test.allowance + detectable(level / count, test.freedom) * test.error
        if test.why:
            visible = test.allowance + (math.sqrt(count / level) + critical(0.2)) * test.error
        outcome: Outcome = "failed" if adjusted[k] <= level else "not judged" if test.why else "passed"
        found.append(replace(test, adjusted=adjusted[k], visible=visible, outcome=outcome))
    return found


def _judged_by(test: Finding) -> float:
    """What a test is judged by: its own probability, Chebyshev's bound where it is unsafe and light is missing."""
    # rare bright samples raise the error with the mean: too much light is no chance of theirs, too little may be
    if not test.why or test.z > 0.0:
        return test.p
    return min(1.0, 1.0 / (test.z * test.z)) if test.z else 1.0


def pixel_test(seen: Evidence, level: float) -> tuple[PixelTest, dict[str, Array]]:
    """Every pixel by itself, its worst channel, and the maps of the image.

    A pixel's noise is taken to be no smaller than is usual on its shape: where light is rare, few samples say nothing.
    """
    sure = np.maximum(np.maximum(seen.variance, seen.pooled), seen.usual)
    beyond = np.maximum(np.abs(seen.difference) - seen.allowance, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        signed = np.where(beyond > 0.0, np.copysign(beyond / np.sqrt(sure), seen.difference), 0.0)
    chosen = list(seen.channels)
    z = np.abs(signed[..., chosen]).max(axis=-1)
    noisy = (np.sqrt(sure) > _NOISY * np.abs(seen.truth))[..., chosen].any(axis=-1) & (sure[..., chosen] > 0).any(
        axis=-1
    )
    able = seen.usable & ~noisy
    count = int(able.sum())
    freedom = math.inf if seen.measured.source == "none" else float(seen.measured.freedom)
    finite = np.where(np.isfinite(z), z, 1e9)[able]
    p = np.ones(count)
    # what is likelier than the level decides nothing: most pixels need no tail
    rare = finite > critical(min(1.0, level / len(chosen)), freedom)
    p[rare] = np.minimum(1.0, len(chosen) * two_sided(finite[rare], freedom))
    rejected, discovered = holm(p, level), benjamini_hochberg(p, level)
    maps = {"difference": seen.difference, "z": signed, "error": np.sqrt(seen.variance)}
    for name, chosen_ones in (("rejected", rejected), ("discovered", discovered)):
        mask = np.zeros(able.shape)
        mask[able] = chosen_ones
        maps[name] = mask
    shown = np.where(able, np.nan_to_num(z, posinf=1e9), 0.0)
    row, column = np.unravel_index(int(shown.argmax()), shown.shape)
    signed_z = signed[..., chosen[0]][able]
    kurtosis = _kurtosis(signed_z[np.isfinite(signed_z)])
    number = int(rejected.sum())
    why = ""
    if count == 0:
        why = f"every pixel's noise exceeds {100 * _NOISY:.0f} % of its light"
    outcome: Outcome = "failed" if number else "passed" if count else "not judged"
    total = able.size - count
    worst = (int(column), int(row))
    return PixelTest(
        count, total, number, int(discovered.sum()), worst, float(shown.max()), kurtosis, outcome, why
    ), maps


def holm(p: Array, level: float) -> Mask:
    """Rejections by Holm's step-down rule: the chance of any false one is at most ``level``."""
    order = np.argsort(p, kind="stable")
    held = p[order] > level / (len(p) - np.arange(len(p)))
    stop = int(held.argmax()) if held.any() else len(p)
    return _first(order, stop)


def benjamini_hochberg(p: Array, level: float) -> Mask:
    """Discoveries of which at most the share ``level`` is false in the mean, for independent pixels."""
    order = np.argsort(p, kind="stable")
    under = np.flatnonzero(p[order] <= level * (1.0 + np.arange(len(p))) / max(len(p), 1))
    return _first(order, int(under[-1]) + 1 if len(under) else 0)


def _first(order: npt.NDArray[np.intp], count: int) -> Mask:
    found = np.zeros(len(order), dtype=bool)
    found[order[:count]] = True
    return found


def _kurtosis(z: Array) -> float:
    centred = z - z.mean() if len(z) else z
    square = float((centred**2).mean()) if len(z) else 0.0
    return float((centred**4).mean()) / square**2 if square > 0.0 else 3.0


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
