"""Tails and quantiles of the normal and of Student's distribution, in NumPy alone."""

from __future__ import annotations

import math
from functools import lru_cache
from statistics import NormalDist
from typing import Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_NODES: Final = 64
_DEEP: Final = 12.0
"""Standard deviations after which nothing of a tail is left to add."""
_CHUNK: Final = 1 << 14


def two_sided(size: Array | float, freedom: float = math.inf) -> Array:
    """P(|T| >= size) of Student's distribution with ``freedom`` degrees, the normal one where they are infinite.

    With t = sqrt(freedom) tan(theta) the density is proportional to cos^(freedom-1) theta, whose tail is integrated by
    Gauss' rule from the angle outwards, so that small probabilities keep their digits.
    """
    values = np.abs(np.atleast_1d(np.asarray(size, dtype=np.float64)))
    if math.isinf(freedom):
        return np.array([math.erfc(v / math.sqrt(2.0)) for v in values.ravel()]).reshape(values.shape)
    nodes, weights = _rule()
    scale = 2.0 * math.exp(math.lgamma(0.5 * (freedom + 1.0)) - math.lgamma(0.5 * freedom)) / math.sqrt(math.pi)
    found = np.empty(values.size)
    flat = values.ravel()
    for start in range(0, flat.size, _CHUNK):
        angle = np.arctan2(math.sqrt(freedom), flat[start : start + _CHUNK])
        reach = np.minimum(angle, _DEEP / math.sqrt(max(freedom - 1.0, 1e-9)))
        at = angle[:, None] - reach[:, None] * nodes
        found[start : start + _CHUNK] = scale * reach * (np.sin(at) ** (freedom - 1.0) @ weights)
    return np.minimum(found.reshape(values.shape), 1.0)


@lru_cache(maxsize=256)
def critical(level: float, freedom: float = math.inf) -> float:
    """The size that |T| exceeds with probability ``level``."""
    if level >= 1.0:
        return 0.0
    normal = NormalDist().inv_cdf(1.0 - 0.5 * level) if level > 1e-15 else 8.0
    if math.isinf(freedom):
        return normal
    low, high = 0.0, max(normal, 1.0)
    while float(two_sided(high, freedom)[0]) > level:
        low, high = high, 2.0 * high
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(two_sided(middle, freedom)[0]) > level else (low, middle)
    return high


def detectable(level: float, freedom: float, power: float = 0.9) -> float:
    """The shift, in standard errors, seen at ``level`` with probability ``power``: the sum of two quantiles."""
    return critical(level, freedom) + critical(2.0 * (1.0 - power), freedom)


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(_NODES)
    return 0.5 * (x + 1.0), 0.5 * w
