"""Slopes of elementary functions: what ``pushforward`` puts beside a call of them.

Of ``f(x, ...)`` they take the arguments and then their slopes. Where a function has an infinite slope at the end of its
range the slope is cut off, as the formulas cut off the value.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined

_TINY: Final = 1e-300


@inlined
def scaled(factor: float, slope: float) -> float:
    """factor slope, 0 where the factor is: what has died out has no slope, however steep its argument."""
    return factor * slope if factor != 0.0 else 0.0


@inlined
def sqrt_slope(x: float, slope: float) -> float:
    """Of the square root; infinite at 0 unless nothing moves."""
    if x > 0.0:
        return 0.5 * slope / math.sqrt(x)
    return 0.0 if slope == 0.0 else math.inf


@inlined
def exp_slope(x: float, slope: float) -> float:
    """Of exp."""
    return scaled(math.exp(x), slope)


@inlined
def log_slope(x: float, slope: float) -> float:
    """Of the logarithm."""
    return slope / x


@inlined
def log1p_slope(x: float, slope: float) -> float:
    """Of log(1 + x)."""
    return slope / (1.0 + x)


@inlined
def sin_slope(x: float, slope: float) -> float:
    """Of the sine."""
    return math.cos(x) * slope


@inlined
def cos_slope(x: float, slope: float) -> float:
    """Of the cosine."""
    return -math.sin(x) * slope


@inlined
def erf_slope(x: float, slope: float) -> float:
    """Of the error function."""
    return scaled(2.0 / math.sqrt(math.pi) * math.exp(-x * x), slope)


@inlined
def acos_slope(x: float, slope: float) -> float:
    """Of the angle with cosine x."""
    return -slope / math.sqrt(max((1.0 - x) * (1.0 + x), _TINY))


@inlined
def atan2_slope(y: float, x: float, up: float, across: float) -> float:
    """Of the azimuth of (x, y)."""
    return (x * up - y * across) / max(x * x + y * y, _TINY)


@inlined
def max_slope(a: float, b: float, first: float, second: float) -> float:
    """Of the larger: that of ``a`` where they are equal."""
    return second if b > a else first


@inlined
def min_slope(a: float, b: float, first: float, second: float) -> float:
    """Of the smaller: that of ``a`` where they are equal."""
    return second if b < a else first


@inlined
def abs_slope(x: float, slope: float) -> float:
    """Of the magnitude."""
    return -slope if x < 0.0 else slope
