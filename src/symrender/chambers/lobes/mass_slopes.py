"""How the share of a lobe above a horizon changes with the lobe and with its tilt."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.kernel_cache import jitable

Array = npt.NDArray[np.float64]

_PIECES = 8
_ORDER = 24
_NEGLIGIBLE = 42.0
"""e to the minus this is below rounding."""


@jitable
def normaliser_slopes(n: float, theta_max: float) -> tuple[float, float]:
    """Slopes in n and in theta_max of log W, W = 2 pi (1 - cos^u theta_max)/u, u = n + 1."""
    u = n + 1.0
    if theta_max >= 1.5707963267948966:
        return -1.0 / u, 1.0 if n == 0.0 else 0.0
    half = math.sin(0.5 * theta_max)
    log = math.log1p(-2.0 * half * half)
    missing = -math.expm1(u * log)
    power = math.exp(n * log)
    return -1.0 / u - power * math.exp(log) * log / missing, u * power * math.sin(theta_max) / missing


@jitable
def horizon_slopes(n: float, theta_max: float, alpha: float, share: float, gauss: Array) -> tuple[float, float, float]:
    """Slopes in n, theta_max and alpha of the ``share`` of a lobe cos^n above the horizon of a normal at angle alpha.

    With the directions of the horizon at angle t from the one nearest to the axis, cos(theta) = sin(alpha) cos(t), so
    tilting the lobe by d alpha takes away the density times cos(t) along it. ``gauss`` is ``gauss_table()``.
    """
    rim = min(theta_max, 0.5 * math.pi)
    if alpha + rim <= 0.5 * math.pi:
        return 0.0, 0.0, 0.0
    by_n, by_theta = normaliser_slopes(n, theta_max)
    half = math.sin(0.5 * rim)
    log_rim = math.log1p(-2.0 * half * half) if rim < 1.5707963267948966 else -1e300
    u = n + 1.0
    scale = u / (2.0 * math.pi * -math.expm1(u * log_rim))
    sa, ca = math.sin(alpha), math.cos(alpha)
    base = _ORDER * (_ORDER - 1) // 2

    last = math.acos(max(0.0, min(1.0, math.cos(rim) / sa))) if rim < 1.5707963267948966 else 0.5 * math.pi
    if n > 0.0:
        last = min(last, math.acos(math.exp(-_NEGLIGIBLE / n)) if n > 0.05 else last)
    tilt = 0.0
    for piece in range(_PIECES):
        for q in range(_ORDER):
            t = last * (piece + gauss[0, base + q]) / _PIECES
            weight = 2.0 * last * gauss[1, base + q] / _PIECES
            tilt -= weight * scale * math.exp(n * math.log(max(sa * math.cos(t), 1e-300))) * math.cos(t)

    # rings below ``low`` are whole, those up to ``high`` cut by the horizon
    low, high = 0.5 * math.pi - alpha, rim
    inner = 0.0
    if low > 0.0:
        log_low = math.log1p(-2.0 * math.sin(0.5 * low) ** 2)
        inner = -math.exp(u * log_low) * log_low / -math.expm1(u * log_rim)
    low = abs(low)
    reach = 2.0 * math.asin(math.sqrt(min(1.0, -math.expm1(-_NEGLIGIBLE / u)) * 0.5))
    high = min(high, max(reach, low + _NEGLIGIBLE / (u * max(math.tan(min(low, 1.5)), 1e-9))))
    logs = 0.0
    if low < high:
        for piece in range(_PIECES):
            for q in range(_ORDER):
                x = (piece + gauss[0, base + q]) / _PIECES
                s, c = math.sin(0.5 * math.pi * x), math.cos(0.5 * math.pi * x)
                theta = low + (high - low) * s * s
                log = math.log1p(-2.0 * math.sin(0.5 * theta) ** 2) if theta < 1.5707963267948966 else -1e300
                arc = math.acos(max(-1.0, min(1.0, -math.cos(theta) * ca / max(math.sin(theta) * sa, 1e-300))))
                weight = gauss[1, base + q] / _PIECES * math.pi * s * c * (high - low)
                if log > -1e299:
                    logs += weight * scale * math.exp(n * log) * log * math.sin(theta) * 2.0 * arc
    # of the whole rings: d/dn of (1 - c^u) over the normaliser, less the normaliser's own slope
    whole = 0.0
    if 0.5 * math.pi - alpha > 0.0:
        log_low = math.log1p(-2.0 * math.sin(0.5 * (0.5 * math.pi - alpha)) ** 2)
        whole = inner + -math.expm1(u * log_low) / -math.expm1(u * log_rim) * (-1.0 / u)
    rim_arc = math.acos(max(-1.0, min(1.0, -math.cos(rim) * ca / max(math.sin(rim) * sa, 1e-300))))
    on_rim = scale * math.exp(n * log_rim) * math.sin(rim) * 2.0 * rim_arc if log_rim > -1e299 else 0.0
    return logs + whole - by_n * share, on_rim - by_theta * share, tilt
