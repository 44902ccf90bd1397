"""Vectors as triples of floats, in the kernels of this side."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]


@inlined
def vector(three: Array) -> Vector:
    """A vector of a record as a tuple."""
    return (three[0], three[1], three[2])


@inlined
def minus(a: Vector, b: Vector) -> Vector:
    """a - b"""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inlined
def dot(a: Vector, b: Vector) -> float:
    """a . b"""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """a x b"""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def minus_of(a: Vector) -> Vector:
    """-a"""
    return (-a[0], -a[1], -a[2])
