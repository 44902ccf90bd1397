"""Walls on the floor as conics A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F = 0 in the plane z = 0."""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, ratio
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3


def cone_conic(axis: Vec3, sine2: Real, apex: Vec3) -> tuple[Real, Real, Real, Real, Real, Real]:
    """(A..F) of sin^2 |w|^2 - |w x a|^2 with w from the apex: where a cone of revolution meets the floor.

    A sphere's shadow from its light, a silhouette or a rim from P, a disk light's penumbra from its apex.
    """
    k = sine2 - 1
    a = k + axis.x * axis.x
    b = axis.x * axis.y
    c = k + axis.y * axis.y
    d = -axis.x * axis.z * apex.z - (a * apex.x + b * apex.y)
    e = -axis.y * axis.z * apex.z - (b * apex.x + c * apex.y)
    at_apex = apex.z * apex.z * (k + axis.z * axis.z)
    f = (
        at_apex + a * apex.x * apex.x + 2 * b * apex.x * apex.y + c * apex.y * apex.y
        + 2 * apex.z * axis.z * (axis.x * apex.x + axis.y * apex.y)
    )  # fmt: skip
    return a, b, c, d, e, f


def ball_conic(center: Vec3, radius: Real) -> tuple[Real, Real, Real, Real, Real, Real]:
    """(A..F) of the circle in which a ball meets the floor."""
    one, zero = 1 + 0 * radius, 0 * radius
    return (
        one, zero, one, -center.x, -center.y,
        center.x * center.x + center.y * center.y - (radius - center.z) * (radius + center.z),
    )  # fmt: skip


def plane_conic(normal: Vec3, height: Real) -> tuple[Real, Real, Real, Real, Real, Real]:
    """(A..F) of the line in which the floor meets the plane across ``normal`` through a point ``height`` above it."""
    zero, half = 0 * height, ratio(1, 2, height)
    return zero, zero, zero, half * normal.x, half * normal.y, -height * normal.z


def conic_level(a: Real, b: Real, c: Real, d: Real, e: Real, f: Real, x: Real, y: Real) -> Real:
    """A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F"""
    return a * x * x + 2 * b * x * y + c * y * y + 2 * (d * x + e * y) + f


_SIX: Final = ("a", "b", "c", "d", "e", "f")

LEAVES: Final = (
    Leaf(cone_conic, _SIX),
    Leaf(ball_conic, _SIX),
    Leaf(plane_conic, _SIX),
    Leaf(conic_level, ("level",)),
)
