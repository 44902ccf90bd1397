"""Textures, by angles: the chart of a sphere and the checker of the floor. Ties go to the bright side."""

from __future__ import annotations

import math

import numpy as np

from symrender.kernel_cache import inlined
from symrender.numeric.vectors import Vector
from symrender.scene.arrays import CHECKER, COLOR, DARK, KU, KV, MARBLE, SOLID, TEXTURE, Array


@inlined
def sin_pi(x: float) -> float:
    """sin(pi x), exactly 0 at whole x; ``np.floor``, since in kernels ``math.floor`` overflows beyond 2^63."""
    r = x - 2.0 * np.floor(x / 2.0)
    return 0.0 if r in (0.0, 1.0) else math.sin(math.pi * r)


@inlined
def sphere_factor(sphere: Array, n: Vector) -> float:
    """Factor on the albedo where the outward unit normal is ``n``; u = (atan2(ny, nx) + pi)/2pi, v = acos(nz)/pi."""
    kind = sphere[TEXTURE]
    if kind == SOLID:
        return 1.0
    u = (math.atan2(n[1], n[0]) + math.pi) / (2.0 * math.pi)
    v = math.acos(max(-1.0, min(1.0, n[2]))) / math.pi
    if kind == MARBLE:
        inner = math.sin(3.0 * math.pi * sphere[KV] * v)
        m = 0.5 + 0.5 * math.sin(2.0 * math.pi * (sphere[KU] * u + 0.35 * inner))
        return 0.55 + 0.45 * m
    s = sin_pi(u * sphere[KU])
    if kind == CHECKER:
        s *= sin_pi(v * sphere[KV])
    return 1.0 if s >= 0.0 else sphere[DARK]


@inlined
def sphere_albedo(sphere: Array, n: Vector) -> Vector:
    """Albedo of a sphere where its outward unit normal is ``n``."""
    factor = sphere_factor(sphere, n)
    return (sphere[COLOR] * factor, sphere[COLOR + 1] * factor, sphere[COLOR + 2] * factor)


@inlined
def floor_sign(floor: Array, x: float, y: float) -> float:
    """1 on a bright cell of the floor and on its edges, -1 on a dark one; 1 everywhere on a plain floor."""
    if floor[1] == SOLID:
        return 1.0
    return 1.0 if sin_pi((x - floor[9]) / floor[8]) * sin_pi((y - floor[10]) / floor[8]) >= 0.0 else -1.0


@inlined
def floor_albedo(floor: Array, sign: float) -> Vector:
    """Albedo of the floor where the (mean) sign of its checker is ``sign`` in [-1, 1]."""
    bright = 0.5 + 0.5 * sign
    dark = 0.5 - 0.5 * sign
    return (
        bright * floor[2] + dark * floor[5],
        bright * floor[3] + dark * floor[6],
        bright * floor[4] + dark * floor[7],
    )
