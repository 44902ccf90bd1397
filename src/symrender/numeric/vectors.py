"""Vectors as triples of floats, in kernels and in Python."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined
from symrender.scene.arrays import Array

Vector = tuple[float, float, float]


@inlined
def dot(a: Vector, b: Vector) -> float:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Right-handed vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def along(a: Vector, scale: float, b: Vector) -> Vector:
    """The point a + scale b."""
    return (a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2])


@inlined
def minus(a: Vector, b: Vector) -> Vector:
    """Difference a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inlined
def unit(a: Vector) -> Vector:
    """Direction of a; the zero vector stays zero."""
    length = math.sqrt(dot(a, a))
    if length == 0.0:
        return (0.0, 0.0, 0.0)
    return (a[0] / length, a[1] / length, a[2] / length)


@inlined
def triple(a: Array) -> Vector:
    """A vector of a record as a tuple."""
    return (a[0], a[1], a[2])
