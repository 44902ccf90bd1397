"""Cosine power about the mirror direction: f = reflectance (n + 2)/(2 pi) cos^n."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.bsdfs.choice import Choice, mirrored, spread
from symrender.numeric.vectors import Vector, cross, dot
from symrender.scene.radiometric.records import Material


@inlined
def cosine_power(w: Vector, axis: Vector, exponent: float) -> float:
    """cos^n of the angle between two directions, 0 from the right angle on."""
    c = dot(w, axis)
    if c <= 0.0:
        return 0.0
    s = cross(w, axis)
    return math.exp(-0.5 * exponent * math.log1p(dot(s, s) / (c * c)))


@jitable
def value(material: Material, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel."""
    n = material.exponent
    share = (n + 2.0) / (2.0 * math.pi) * cosine_power(wi, mirrored(wo), n) * wi[2]
    return (reflectance[0] * share, reflectance[1] * share, reflectance[2] * share)


@jitable
def density(material: Material, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    n = material.exponent
    return (n + 1.0) / (2.0 * math.pi) * cosine_power(wi, mirrored(wo), n)


@jitable
def choose(material: Material, wo: Vector, a: float, b: float) -> Choice:
    """A direction by two numbers in [0, 1), by cos^n about the mirror; it may lie below the surface."""
    turn = 2.0 * math.pi * b
    c = (1.0 - a) ** (1.0 / (material.exponent + 1.0))
    s = math.sqrt(max(0.0, 1.0 - c * c))
    m = mirrored(wo)
    e = (m[2], 0.0, -m[0]) if abs(m[1]) > 0.5 else (0.0, -m[2], m[1])
    size = math.sqrt(dot(e, e))
    e = (e[0] / size, e[1] / size, e[2] / size)
    f = cross(m, e)
    x, y = s * math.cos(turn), s * math.sin(turn)
    return spread((c * m[0] + x * e[0] + y * f[0], c * m[1] + x * e[1] + y * f[1], c * m[2] + x * e[2] + y * f[2]))
