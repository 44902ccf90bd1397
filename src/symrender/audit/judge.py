"""The tests: signed means of regions, the scale of the whole, every pixel by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.distributions import critical, detectable, two_sided
from symrender.audit.evidence import Evidence
from symrender.audit.reach import SubPixel
from symrender.audit.regions import Region
from symrender.audit.verdict import Finding, Outcome, PixelTest

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

_DOMINANT: Final = 0.1
"""Share of a region's variance in one pixel beyond which its sum is not taken for normal."""
_TAIL: Final = 1.0
"""Relative change of a tail by skewness beyond which it is not taken for normal."""
_NOISY: Final = 0.2
"""Standard error of a pixel over its truth beyond which it is not judged alone: its tail is that of few samples."""
_PROBABLE: Final = 1e-300


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
    margin: Array
    seeds: Array | None
    powers: Array | None

    @classmethod
    def of(cls, seen: Evidence, c: int) -> Plane:
        """Channel ``c``."""
        parts = (seen.truth, seen.difference, seen.variance, seen.allowance, seen.margin)
        truth, difference, variance, allowance, margin = (np.ascontiguousarray(part[..., c]).ravel() for part in parts)
        if seen.measured.seeds is None:
            return cls(seen.channel(c), truth, difference, variance, allowance, margin, None, None)
        images = np.ascontiguousarray(seen.measured.seeds[..., c]).reshape(len(seen.measured.seeds), -1)
        mean = images.mean(axis=0)
        powers = np.zeros((3, images.shape[1]))
        for image in images:
            residual = image - mean
            square = residual * residual
            powers[0] += square
            powers[1] += square * residual
            powers[2] += square * square * square
        return cls(seen.channel(c), truth, difference, variance, allowance, margin, images, powers)


def scale_test(seen: Evidence) -> Finding:
    """Whether the render is the truth times 1 + b, by least squares with weights that the noise of no pixel moves."""
    chosen = list(seen.channels)
    mask = seen.usable
    parts = (seen.truth, seen.difference, seen.pooled, seen.variance, seen.allowance, seen.margin)
    mu, d, pooled, v, a, m = (part[mask][:, chosen] for part in parts)
    # never far above the weight of the mean variance: where light is rare, quiet pixels have only not met it yet
    weights = 1.0 / (pooled + pooled.mean(axis=0) + a * a + _PROBABLE)
    whole = float((weights * mu * mu).sum())
    if whole <= 0.0:
        return _test("scale", "all", "all", mask, 0.0, 0.0, 0.0, 0.0, 0.0, math.inf, "the truth is black")
    bias = float((weights * mu * d).sum()) / whole
    allowance, margin = (float((weights * np.abs(mu) * part).sum()) / whole for part in (a, m))
    if seen.measured.seeds is not None:
        weighted = weights * mu
        each = np.array([float((weighted * (s[mask][:, chosen] - mu)).sum()) / whole for s in seen.measured.seeds])
        error, freedom = float(each.std(ddof=1)) / math.sqrt(len(each)), float(len(each) - 1)
    else:
        # channels of a pixel share their samples: their standard errors add
        together = ((weights * mu * np.sqrt(v)).sum(axis=1) ** 2).sum()
        error, freedom = math.sqrt(seen.spread * float(together)) / whole, math.inf
    return _test("scale", "all", "all", mask, 1.0, bias, error, allowance, margin, freedom, "")


def _region(seen: Evidence, region: Region, mask: Mask, places: npt.NDArray[np.intp], plane: Plane) -> Finding:
    count, why = len(places), ""
    d, v = plane.difference[places], plane.variance[places]
    bias, allowance, margin = (float(part.mean()) for part in (d, plane.allowance[places], plane.margin[places]))
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
    return _test("mean", region.name, plane.name, mask, mean, bias, error, allowance, margin, freedom, why)


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
    margin: float, freedom: float, why: str,
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
        "not judged" if why else "passed", why, margin,
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
    p = _tails(z[able], len(chosen), freedom, level)
    rejected, discovered = holm(p, level), benjamini_hochberg(p, level)
    maps = {"difference": seen.difference, "z": signed, "error": np.sqrt(seen.variance)}
    maps["aside"] = seen.aside.astype(np.float64)
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
    aside = int(seen.aside.sum())
    total = able.size - count - aside
    worst = (int(column), int(row))
    return PixelTest(
        count, total, number, int(discovered.sum()), worst, float(shown.max()), kurtosis, outcome, why, aside
    ), maps


def _tails(z: Array, channels: int, freedom: float, level: float) -> Array:
    """Probabilities of pixels' largest ``z`` over ``channels``, 1 where they decide nothing at ``level``."""
    finite = np.where(np.isfinite(z), z, 1e9)
    p = np.ones(len(finite))
    # what is likelier than the level decides nothing: most pixels need no tail
    rare = finite > critical(min(1.0, level / channels), freedom)
    p[rare] = np.minimum(1.0, channels * two_sided(finite[rare], freedom))
    return p


def outside(seen: Evidence, level: float, found: Sequence[SubPixel]) -> list[SubPixel]:
    """Pixels set aside whose light lies outside their sub-pixel truth, by Holm at ``level``."""
    if not found:
        return []
    rows, columns = [b.row for b in found], [b.column for b in found]
    # a value between two is no further off than the nearer of both
    to = seen.measured.basis
    low, high = (np.array([getattr(b, name) for b in found]) for name in ("low", "high"))
    middle, half = 0.5 * (high + low) @ to.T, 0.5 * (high - low) @ np.abs(to).T
    away = np.abs(seen.measured.mean[rows, columns] - middle) - half - seen.allowance[rows, columns]
    sure = np.maximum(np.maximum(seen.variance, seen.pooled), seen.usual)[rows, columns]
    noisy = np.sqrt(sure) > _NOISY * np.abs(seen.truth[rows, columns])
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.where((away > 0.0) & ~((sure > 0.0) & noisy), away / np.sqrt(sure), 0.0).max(axis=-1)
    freedom = math.inf if seen.measured.source == "none" else float(seen.measured.freedom)
    rejected = holm(_tails(z, len(seen.channels), freedom, level), level)
    return [one for one, off in zip(found, rejected.tolist(), strict=True) if off]


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
