"""Textures, by angles: the chart of a sphere and the checker of the floor. Ties go to the bright side."""

from __future__ import annotations

import math

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.vectors import Vector
from symrender.scene.arrays import CHECKER, MARBLE, SOLID
from symrender.scene.records import Floor, Sphere


@inlined
def sin_pi(x: float) -> float:
    """sin(pi x), exactly 0 at whole x; ``np.floor``, since in kernels ``math.floor`` overflows beyond 2^63."""
    r = x - 2.0 * np.floor(x / 2.0)
    return 0.0 if r in (0.0, 1.0) else math.sin(math.pi * r)


@inlined
def sphere_factor(sphere: Sphere, n: Vector) -> float:
    """Factor on the albedo where the outward unit normal is ``n``; u = (atan2(ny, nx) + pi)/2pi, v = acos(nz)/pi."""
    kind = sphere.texture
    if kind == SOLID:
        return 1.0
    u = (math.atan2(n[1], n[0]) + math.pi) / (2.0 * math.pi)
    v = math.acos(max(-1.0, min(1.0, n[2]))) / math.pi
    if kind == MARBLE:
        inner = math.sin(3.0 * math.pi * sphere.kv * v)
        m = 0.5 + 0.5 * math.sin(2.0 * math.pi * (sphere.ku * u + 0.35 * inner))
        return 0.55 + 0.45 * m
    s = sin_pi(u * sphere.ku)
    if kind == CHECKER:
        s *= sin_pi(v * sphere.kv)
    return 1.0 if s >= 0.0 else sphere.dark


@inlined
def sphere_albedo(sphere: Sphere, n: Vector) -> Vector:
    """Albedo of a sphere where its outward unit normal is ``n``."""
    factor = sphere_factor(sphere, n)
    return (sphere.color[0] * factor, sphere.color[1] * factor, sphere.color[2] * factor)


@inlined
def floor_sign(floor: Floor, x: float, y: float) -> float:
    """1 on a bright cell of the floor and on its edges, -1 on a dark one; 1 everywhere on a plain floor."""
    if floor.kind == SOLID:
        return 1.0
    return (
        1.0 if sin_pi((x - floor.offset[0]) / floor.cell) * sin_pi((y - floor.offset[1]) / floor.cell) >= 0.0 else -1.0
    )


@inlined
def floor_albedo(floor: Floor, sign: float) -> Vector:
    """Albedo of the floor where the (mean) sign of its checker is ``sign`` in [-1, 1]."""
    bright = 0.5 + 0.5 * sign
    dark = 0.5 - 0.5 * sign
    return (
        bright * floor.bright[0] + dark * floor.dark[0],
        bright * floor.bright[1] + dark * floor.dark[1],
        bright * floor.bright[2] + dark * floor.dark[2],
    )
