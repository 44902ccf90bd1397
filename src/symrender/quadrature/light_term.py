"""What one light point adds to a lit point, inside a chamber: no maxima, no visibility, no texture sign."""

from __future__ import annotations

import math
from typing import Final

from symrender.kernel_cache import jitable

MOST_SQUARED: Final = 4096.0
"""Whole exponents up to this one are taken by squaring, several times quicker than a general power."""


@jitable
def gleam(base: float, shininess: float) -> float:
    """base^shininess for a base in (0, 1]; 0 where it is below 1e-17."""
    if shininess * (1.0 - base) > 40.0:
        # ln base <= base - 1
        return 0.0
    power = int(min(shininess, MOST_SQUARED))
    if power != shininess:
        return float(base**shininess)
    found = 1.0
    while power > 0:
        if power % 2 == 1:
            found *= base
        base *= base
        power //= 2
    return found


@jitable
def light_term(
    lx: float, ly: float, lz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float, phong: bool,
    shininess: float,
) -> tuple[float, float]:  # fmt: skip
    """(N.l, s) for the light at offset ``l`` (any length), unit normal and view; s is 0 where its base is negative."""
    inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
    lx, ly, lz = lx * inv, ly * inv, lz * inv
    cosine = lx * nx + ly * ny + lz * nz
    if phong:
        base = 2.0 * cosine * (nx * vx + ny * vy + nz * vz) - (lx * vx + ly * vy + lz * vz)
    else:
        hx, hy, hz = lx + vx, ly + vy, lz + vz
        length = math.sqrt(hx * hx + hy * hy + hz * hz)
        base = (hx * nx + hy * ny + hz * nz) / length if length > 0.0 else 0.0
    if not base > 0.0:
        return cosine, 0.0 if shininess > 0.0 else 1.0
    return cosine, gleam(base, shininess)


@jitable
def marble_factor(nx: float, ny: float, nz: float, ku: float, kv: float) -> float:
    """Albedo factor of the veins at a unit normal."""
    u = (math.atan2(ny, nx) + math.pi) / (2.0 * math.pi)
    v = math.acos(max(-1.0, min(1.0, nz))) / math.pi
    return 0.55 + 0.225 * (1.0 + math.sin(2.0 * math.pi * (ku * u + 0.35 * math.sin(3.0 * math.pi * kv * v))))
