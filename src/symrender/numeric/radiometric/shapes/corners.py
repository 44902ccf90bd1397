"""Rectangles and triangles, and the faces of meshes: the place of a hit is solved for in two edges.

T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 2(1), 1997.
"""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.numeric.vectors import Vector, along, cross, dot, minus, triple, unit
from symrender.scene.radiometric.arrays import RECTANGLE, TRIANGLE
from symrender.scene.radiometric.records import Shape


@jitable
def edges(shape: Shape) -> tuple[Vector, Vector]:
    """The two edges that leave the first corner of a rectangle or a triangle."""
    if shape.kind == RECTANGLE:
        return triple(shape.second), triple(shape.third)
    return minus(triple(shape.second), triple(shape.place)), minus(triple(shape.third), triple(shape.place))


@jitable
def corner_normal(shape: Shape) -> Vector:
    """Unit normal of a rectangle or a triangle."""
    u, v = edges(shape)
    return unit(cross(unit(u), unit(v)))


@jitable
def corner_distance(shape: Shape, origin: Vector, d: Vector) -> float:
    """Distance along a unit ray to a rectangle or a triangle, inf where it is not met."""
    return edges_distance(triple(shape.place), *edges(shape), shape.kind == RECTANGLE, origin, d)


@jitable
def edges_distance(corner: Vector, u: Vector, v: Vector, four: bool, origin: Vector, d: Vector) -> float:
    """Distance along a unit ray to what edges u and v span from a corner, with three corners or ``four``, or inf."""
    p = cross(d, v)
    volume = dot(u, p)
    if volume == 0.0:
        return math.inf
    s = minus(origin, corner)
    a = dot(s, p) / volume
    q = cross(s, u)
    b = dot(d, q) / volume
    reach = dot(v, q) / volume
    end = max(a, b) if four else a + b
    return reach if a >= 0.0 and b >= 0.0 and end <= 1.0 and reach > 0.0 else math.inf


@jitable
def corner_place(shape: Shape, place: Vector) -> tuple[float, float]:
    """(x, y) of a place along the first edge of a rectangle or a triangle, and across it."""
    u = unit(edges(shape)[0])
    offset = minus(place, triple(shape.place))
    return dot(offset, u), dot(offset, cross(corner_normal(shape), u))


@jitable
def corner_area(shape: Shape) -> float:
    """Area of a rectangle or a triangle."""
    u, v = edges(shape)
    n = cross(u, v)
    whole = math.sqrt(dot(n, n))
    return 0.5 * whole if shape.kind == TRIANGLE else whole


@jitable
def corner_point(shape: Shape, a: float, b: float) -> Vector:
    """A place of a rectangle or a triangle, uniform by area."""
    u, v = edges(shape)
    if shape.kind == RECTANGLE:
        return along(along(triple(shape.place), a, u), b, v)
    r = math.sqrt(a)
    return along(along(triple(shape.place), r * (1.0 - b), u), r * b, v)


@jitable
def edge_shares(corner: Vector, u: Vector, v: Vector, place: Vector) -> tuple[float, float]:
    """Coordinates of a place of a flat shape in the two edges that leave its first corner."""
    n, s = cross(u, v), minus(place, corner)
    size = dot(n, n)
    return dot(cross(s, v), n) / size, dot(cross(u, s), n) / size
