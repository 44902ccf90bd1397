"""Rectangles, triangles, disks and boxes: where a ray meets them, their normals, the coordinates of their textures.

Of a rectangle and a triangle the place of a hit is solved for in its two edges (T. Moeller, B. Trumbore, "Fast, minimum
storage ray/triangle intersection", JGT 2(1), 1997); a box is three pairs of planes in coordinates in which it stands
straight.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried, turned
from symrender.numeric.rays import floor_distance
from symrender.numeric.vectors import Vector, cross, dot, minus, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import RECTANGLE
from symrender.scene.radiometric.records import Shape
from symrender.scene.records import Frame

_DEGREE: Final = math.pi / 180.0


@inlined
def triple(a: Array) -> Vector:
    """A vector of a record as a tuple."""
    return (a[0], a[1], a[2])


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
def edge_shares(corner: Vector, u: Vector, v: Vector, place: Vector) -> tuple[float, float]:
    """Coordinates of a place of a flat shape in the two edges that leave its first corner."""
    n, s = cross(u, v), minus(place, corner)
    size = dot(n, n)
    return dot(cross(s, v), n) / size, dot(cross(u, s), n) / size


@jitable
def disk_distance(frame: Frame, radius: float, origin: Vector, d: Vector) -> float:
    """Distance along a unit ray to a disk, inf where it is not met."""
    p, w = carried(frame, origin), turned(frame, d)
    reach = floor_distance(p[2], w[2])
    if not reach < math.inf:
        return math.inf
    x, y = p[0] + reach * w[0], p[1] + reach * w[1]
    return reach if x * x + y * y <= radius * radius else math.inf


@inlined
def straight(shape: Shape, v: Vector) -> Vector:
    """A direction in the coordinates of a box."""
    c, s = math.cos(_DEGREE * shape.rotation), math.sin(_DEGREE * shape.rotation)
    return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])


@jitable
def box_distance(shape: Shape, origin: Vector, d: Vector, leaves: bool) -> tuple[float, bool]:
    """(distance along a unit ray to a box or inf, whether from inside); a ray that ``leaves`` a face goes inward."""
    p, w = straight(shape, minus(origin, triple(shape.place))), straight(shape, d)
    enter, leave = -math.inf, math.inf
    for k in range(3):
        half = 0.5 * shape.second[k]
        at, way = p[0], w[0]
        if k == 1:
            at, way = p[1], w[1]
        if k == 2:
            at, way = p[2], w[2]
        if way == 0.0:
            if abs(at) > half:
                return math.inf, False
            continue
        first, last = (-half - at) / way, (half - at) / way
        enter, leave = max(enter, min(first, last)), min(leave, max(first, last))
    if leaves:
        return leave if leave > 0.0 else math.inf, True
    if enter > leave or leave <= 0.0:
        return math.inf, False
    return (enter, False) if enter > 0.0 else (leave, True)


@jitable
def box_normal(shape: Shape, place: Vector) -> Vector:
    """Outward unit normal of the face of a box that a place of it is nearest to."""
    p = straight(shape, minus(place, triple(shape.place)))
    x, y, z = abs(p[0]) - 0.5 * shape.second[0], abs(p[1]) - 0.5 * shape.second[1], abs(p[2]) - 0.5 * shape.second[2]
    c, s = math.cos(_DEGREE * shape.rotation), math.sin(_DEGREE * shape.rotation)
    if x >= y and x >= z:
        side = math.copysign(1.0, p[0])
        return (side * c, side * s, 0.0)
    if y >= z:
        side = math.copysign(1.0, p[1])
        return (-side * s, side * c, 0.0)
    return (0.0, 0.0, math.copysign(1.0, p[2]))


@jitable
def box_place(shape: Shape, place: Vector, normal: Vector) -> tuple[float, float]:
    """(x, y) of a place of a box in the texture of its face: along its lower edge, or its x where it lies flat.

    x grows to the right as the face is seen from outside, from the face's corner on the left; y upward, and on the top
    and the bottom with the box's own y.
    """
    p, n = straight(shape, minus(place, triple(shape.place))), straight(shape, normal)
    a, b, c = 0.5 * shape.second[0], 0.5 * shape.second[1], 0.5 * shape.second[2]
    if abs(n[2]) > 0.5:
        return (p[0] + a if n[2] > 0.0 else a - p[0]), p[1] + b
    if abs(n[0]) > 0.5:
        return (p[1] + b if n[0] > 0.0 else b - p[1]), p[2] + c
    return (p[0] + a if n[1] < 0.0 else a - p[0]), p[2] + c
