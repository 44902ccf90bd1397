"""Observed order: the slope of error against cost on logarithmic axes, with its 95 % interval."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_CONFIDENCE = 0.95
_LEAST = 3


@dataclass(frozen=True)
class PowerLaw:
    """error = factor cost^-order over ``points`` measurements from cost ``start`` to ``end``.

    ``low`` and ``high`` bound the order with 95 % confidence if the residuals in log error are independent and normal;
    a curve that bends violates that, so the range is part of the statement.
    """

    order: float
    low: float
    high: float
    factor: float
    points: int
    start: float
    end: float


def fit_power_law(cost: Sequence[float], error: Sequence[float]) -> PowerLaw | None:
    """Least squares of log error on log cost; None with fewer than three different costs or a value that is not > 0."""
    x, y = np.asarray(cost, dtype=np.float64), np.asarray(error, dtype=np.float64)
    if len(set(x.tolist())) < _LEAST or not ((x > 0).all() and (y > 0).all()):
        return None
    u, v = np.log(x), np.log(y)
    spread = float(((u - u.mean()) ** 2).sum())
    slope = float(((u - u.mean()) * (v - v.mean())).sum()) / spread
    residual = v - v.mean() - slope * (u - u.mean())
    freedom = len(x) - 2
    half = t_quantile(_CONFIDENCE, freedom) * math.sqrt(float(residual @ residual) / freedom / spread)
    factor = math.exp(float(v.mean()) - slope * float(u.mean()))
    return PowerLaw(-slope, -slope - half, -slope + half, factor, len(x), float(x.min()), float(x.max()))


def t_quantile(confidence: float, freedom: int) -> float:
    """t with P(|T| <= t) = ``confidence`` for Student's T of ``freedom`` >= 1 degrees.

    By bisection of the finite trigonometric sums of the distribution (Abramowitz, Stegun, Handbook of Mathematical
    Functions, 26.7.3 and 26.7.4), for confidence in (0, 1).
    """
    low, high = 0.0, math.pi / 2
    for _ in range(60):
        angle = 0.5 * (low + high)
        low, high = (angle, high) if _within(angle, freedom) < confidence else (low, angle)
    return math.sqrt(freedom) * math.tan(0.5 * (low + high))


def _within(angle: float, freedom: int) -> float:
    """P(|T| <= sqrt(freedom) tan(angle))."""
    s, c = math.sin(angle), math.cos(angle)
    odd = freedom % 2
    term, total = (c if odd else 1.0), 0.0
    for k in range(1 + odd, freedom, 2):
        total += term
        term *= c * c * k / (k + 1)
    return 2 / math.pi * (angle + s * total) if odd else s * total
