"""The reflection lobe: its axis and frame, and the maps from the unit square to directions with their densities.

A direction at angle theta from the axis is held by 1 - cos theta, which keeps its digits however narrow the lobe is.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.vectors import Vector, along, cross, dot, unit
from symrender.scene.arrays import Array

# lobes[c]: weight k 0, exponent n 1, theta_max 2, height 1 - cos theta_max 3, cos 4 and sin 5 of theta_max,
# mass 1 - cos^(n+1) theta_max 6, ratio 7 of the cone's solid angle to the lobe's integral, scale 8 of the mean
WEIGHT: Final = 0
EXPONENT: Final = 1
THETA_MAX: Final = 2
HEIGHT: Final = 3
COS_MAX: Final = 4
SIN_MAX: Final = 5
MASS: Final = 6
RATIO: Final = 7
SCALE: Final = 8
LOBE_COLUMNS: Final = 9

_NEARLY_ALONG = 1e-6


def lobe_rows(lobes: Array, *, brdf: bool = False) -> Array:
    """Constants of lobes given as rows (weight, exponent, theta_max).

    ``brdf``: gloss is int (n + 2)/(2 pi) cos^n theta (w.N) f dw, the scale int (n + 2)/(2 pi) cos^n theta dw times the
    mean of (w.N) f under the lobe; else it is the mean of f. A mirror has scale 1.
    """
    rows = np.zeros((len(lobes), LOBE_COLUMNS))
    for row, (weight, exponent, theta_max) in zip(rows, lobes.tolist(), strict=True):
        height = min(1.0, 2.0 * math.sin(theta_max / 2) ** 2)
        u = exponent + 1.0
        mass = -math.expm1(u * math.log1p(-height)) if height < 1.0 else 1.0
        ratio = u * height / mass if u * height > 1e-17 else 1.0
        scale = (exponent + 2.0) * mass / u if brdf and theta_max > 0.0 else 1.0
        row[:] = weight, exponent, theta_max, height, math.cos(theta_max), math.sin(theta_max), mass, ratio, scale
    return rows


@inlined
def mirror_direction(d: Vector, n: Vector) -> Vector:
    """The direction d - 2 (d.n) n into which a mirror of unit normal n turns the unit direction d."""
    return along(d, -2.0 * dot(d, n), n)


@inlined
def frame_about(m: Vector, n: Vector) -> tuple[Vector, Vector]:
    """Unit vectors u1, u2 with (u1, u2, m) right-handed; u1 is along n x m, so the frame turns with the scene.

    Where m is nearly along n any frame serves (Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1),
    2017).
    """
    side = cross(n, m)
    if dot(side, side) > _NEARLY_ALONG:
        u1 = unit(side)
        return u1, cross(m, u1)
    sign = math.copysign(1.0, m[2])
    a = -1.0 / (sign + m[2])
    b = m[0] * m[1] * a
    return (1.0 + sign * m[0] * m[0] * a, sign * b, -sign * m[0]), (b, sign + m[1] * m[1] * a, -m[1])


@inlined
def direction(u1: Vector, u2: Vector, m: Vector, depth: float, turn: float) -> Vector:
    """Unit vector with 1 - cos theta = ``depth`` and azimuth 2 pi ``turn`` in the frame (u1, u2, m)."""
    sine = math.sqrt(depth * (2.0 - depth))
    phi = 2.0 * math.pi * turn
    a, b, c = sine * math.cos(phi), sine * math.sin(phi), 1.0 - depth
    return (
        a * u1[0] + b * u2[0] + c * m[0],
        a * u1[1] + b * u2[1] + c * m[1],
        a * u1[2] + b * u2[2] + c * m[2],
    )


@inlined
def cone_depth(s: float, height: float) -> float:
    """1 - cos theta, uniform in solid angle over the cone, for s uniform in [0, 1)."""
    return s * height


@inlined
def cone_density(height: float) -> float:
    """Density of ``cone_depth`` with a uniform azimuth, per solid angle."""
    return 1.0 / (2.0 * math.pi * height)


@inlined
def lobe_depth(s: float, exponent: float, mass: float) -> float:
    """1 - cos theta with density proportional to cos^n theta over the cone, for s uniform in [0, 1)."""
    return -math.expm1(math.log1p(-s * mass) / (exponent + 1.0))


@inlined
def lobe_density(depth: float, exponent: float, mass: float) -> float:
    """Density of ``lobe_depth`` with a uniform azimuth, per solid angle: u cos^n theta / (2 pi (1 - c^u))."""
    return (exponent + 1.0) * math.exp(exponent * math.log1p(-depth)) / (2.0 * math.pi * mass)
