"""Cylinders, in coordinates in which their axis is z and their base lies in z = 0.

Across the axis a ray is a line in the plane. With l its place nearest to the axis the discriminant radius^2 - |l|^2
does not cancel for far or thin cylinders, nor do the roots, as those of a sphere (``numeric/rays.py``).
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried, turned
from symrender.numeric.vectors import Vector, along, dot, triple
from symrender.scene.radiometric.records import Shape
from symrender.scene.records import Frame

SIDE: Final = -1
BASE: Final = -2
TOP: Final = -3
"""The parts of a cylinder."""


@inlined
def height_of(shape: Shape) -> float:
    """Length of the axis."""
    axis = triple(shape.normal)
    return math.sqrt(dot(axis, axis))


@jitable
def nearest_to_axis(p: Vector, w: Vector) -> tuple[float, float, float]:
    """(distance along the ray to where it is nearest to the axis, x and y there); w is not along the axis."""
    toward = -(p[0] * w[0] + p[1] * w[1]) / (w[0] * w[0] + w[1] * w[1])
    return toward, p[0] + toward * w[0], p[1] + toward * w[1]


@jitable
def side_distances(radius: float, p: Vector, w: Vector, leaves: bool, part: int) -> tuple[float, float]:
    """Distances at which a ray enters and leaves the endless cylinder; inf where it does not or is where it starts."""
    across = w[0] * w[0] + w[1] * w[1]
    if across == 0.0:
        return math.inf, math.inf
    toward, x, y = nearest_to_axis(p, w)
    if leaves and part == SIDE:
        # a chord from the side itself
        return math.inf, 2.0 * toward
    square = radius * radius - x * x - y * y
    if square < 0.0:
        return math.inf, math.inf
    half = math.sqrt(square / across)
    q = toward + half if toward >= 0.0 else toward - half
    if q == 0.0:
        return math.inf, math.inf
    power = p[0] * p[0] + p[1] * p[1] - radius * radius
    other = power / (across * q)
    # from a cap and from within the only way is out
    enters = min(q, other) if power > 0.0 and not leaves else math.inf
    return enters, max(q, other)


@jitable
def cylinder_distance(
    shape: Shape, frame: Frame, origin: Vector, d: Vector, leaves: bool, part: int, inside: bool
) -> tuple[float, int, bool]:  # fmt: skip
    """(distance along a unit ray or inf, the part met, whether from inside), as ``distance_to`` asks."""
    if leaves and not inside:
        # nothing of a cylinder is seen from its outside, with or without caps
        return math.inf, SIDE, False
    p, w, height = carried(frame, origin), turned(frame, d), height_of(shape)
    best, found, within = math.inf, SIDE, False
    enters, leaving = side_distances(shape.radius, p, w, leaves, part)
    if 0.0 < enters < math.inf and 0.0 <= p[2] + enters * w[2] <= height:
        best = enters
    elif 0.0 < leaving < math.inf and 0.0 <= p[2] + leaving * w[2] <= height:
        best, within = leaving, True
    if shape.caps != 0.0 and w[2] != 0.0:
        for cap in (BASE, TOP):
            if leaves and part == cap:
                continue
            reach = ((height if cap == TOP else 0.0) - p[2]) / w[2]
            x, y = p[0] + reach * w[0], p[1] + reach * w[1]
            if 0.0 < reach < best and x * x + y * y <= shape.radius * shape.radius:
                best, found, within = reach, cap, (w[2] > 0.0) == (cap == TOP)
    return best, found, within


@jitable
def cylinder_hit(
    shape: Shape, frame: Frame, origin: Vector, d: Vector, distance: float, part: int, far: bool
) -> tuple[Vector, Vector]:  # fmt: skip
    """(place, outward unit normal) of what ``cylinder_distance`` found."""
    if part != SIDE:
        up = triple(frame.up)
        n = up if part == TOP else (-up[0], -up[1], -up[2])
        return along(origin, distance, d), n
    p, w = carried(frame, origin), turned(frame, d)
    _, x, y = nearest_to_axis(p, w)
    root = math.sqrt(max(0.0, shape.radius * shape.radius - x * x - y * y) / (w[0] * w[0] + w[1] * w[1]))
    root = root if far else -root
    x, y = x + root * w[0], y + root * w[1]
    size = math.sqrt(x * x + y * y)
    n = outward(frame, x / size, y / size)
    level = min(max(p[2] + distance * w[2], 0.0), height_of(shape))
    return along(along(triple(frame.origin), level, triple(frame.up)), shape.radius, n), n


@inlined
def outward(frame: Frame, x: float, y: float) -> Vector:
    """Direction in the world of one across the axis."""
    east = triple(frame.east)
    return along((x * east[0], x * east[1], x * east[2]), y, triple(frame.north))


@jitable
def cylinder_chart(shape: Shape, frame: Frame, place: Vector, part: int) -> tuple[float, float]:
    """(x, y) of the texture: half turns about the axis, and the share of the height, or of the radius on a cap."""
    p = carried(frame, place)
    x = (math.pi + math.atan2(p[1], p[0])) / math.pi
    return x, p[2] / height_of(shape) if part == SIDE else math.sqrt(p[0] * p[0] + p[1] * p[1]) / shape.radius


@jitable
def cylinder_area(shape: Shape) -> float:
    """Area of the side, and of both caps if there are any."""
    return 2.0 * math.pi * shape.radius * (height_of(shape) + (shape.radius if shape.caps != 0.0 else 0.0))


@jitable
def cylinder_point(shape: Shape, frame: Frame, a: float, b: float) -> tuple[Vector, Vector]:
    """(place, outward unit normal) on a cylinder, uniform by area."""
    height, origin, up = height_of(shape), triple(frame.origin), triple(frame.up)
    level = a * (height + (shape.radius if shape.caps != 0.0 else 0.0))
    n = outward(frame, math.cos(2.0 * math.pi * b), math.sin(2.0 * math.pi * b))
    if level < height:
        return along(along(origin, level, up), shape.radius, n), n
    # of what is beyond the side one half is the base, the other the top
    share = 2.0 * (level - height) / shape.radius
    if share < 1.0:
        return along(origin, shape.radius * math.sqrt(share), n), (-up[0], -up[1], -up[2])
    return along(along(origin, height, up), shape.radius * math.sqrt(min(share - 1.0, 1.0)), n), up
