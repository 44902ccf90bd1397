"""Light between flat faces: Lambert's term of an edge, the exchange of two small areas, what lies behind a face."""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, azimuth, length, pi
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, cross, dot, norm2


def edge_share(first: Vec3, second: Vec3, normal: Vec3) -> Real:
    """Lambert's term of the edge between two corners seen from the origin: they sum to a polygon's form factor."""
    axis = cross(first, second)
    size = length(norm2(axis))
    return azimuth(size, dot(first, second)) * dot(axis, normal) / (2 * pi(size) * size)


def exchange(height: Real, normal: Vec3, offset: Vec3) -> Real:
    """cos cos'/r^2 = h (N.w)/|w|^4 of a place w of a plane from which the origin has the height h."""
    square = norm2(offset)
    return height * dot(normal, offset) / (square * square)


def edge_plane(first: Vec3, second: Vec3) -> Vec3:
    """Unit normal of the plane through the origin and an edge; zero where the edge points to the origin."""
    axis = cross(first, second)
    return axis / length(norm2(axis))


LEAVES: Final = (
    Leaf(edge_share, ("share",)),
    Leaf(exchange, ("weight",)),
    Leaf(edge_plane, ("normal:3",)),
)
"""All leaves, in the order they are emitted."""
