"""Boxes: three pairs of planes in coordinates in which a box stands straight."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.numeric.vectors import Vector, along, minus, triple
from symrender.scene.radiometric.records import Shape

_DEGREE: Final = math.pi / 180.0


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


@inlined
def turned_back(shape: Shape, v: Vector) -> Vector:
    """A direction of a box's coordinates in the world."""
    east, north = straight(shape, (1.0, 0.0, 0.0)), straight(shape, (0.0, 1.0, 0.0))
    return (east[0] * v[0] + east[1] * v[1], north[0] * v[0] + north[1] * v[1], v[2])


@jitable
def box_area(shape: Shape) -> float:
    """Area of all faces of a box."""
    a, b, c = triple(shape.second)
    return 2.0 * (a * b + b * c + c * a)


@jitable
def box_point(shape: Shape, a: float, b: float) -> Vector:
    """A place on a box, uniform over its faces."""
    x, y, z = triple(shape.second)
    pair = 0.5 * box_area(shape)
    level, side = 2.0 * a, -0.5
    if level >= 1.0:
        level, side = level - 1.0, 0.5
    level = level * pair
    if level < y * z:
        p = (side * x, (level / (y * z) - 0.5) * y, (b - 0.5) * z)
    elif level < y * z + z * x:
        p = ((b - 0.5) * x, side * y, ((level - y * z) / (z * x) - 0.5) * z)
    else:
        p = (((level - y * z - z * x) / (x * y) - 0.5) * x, (b - 0.5) * y, side * z)
    return along(triple(shape.place), 1.0, turned_back(shape, p))
