"""Planes and disks, which lie in a frame."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried, turned
from symrender.numeric.rays import floor_distance
from symrender.numeric.vectors import Vector, along, triple
from symrender.scene.records import Frame


@inlined
def level(frame: Frame, p: Vector, d: Vector) -> float:
    """Distance along a unit ray to a plane, inf where it is not met."""
    return floor_distance(carried(frame, p)[2], turned(frame, d)[2])


@jitable
def disk_distance(frame: Frame, radius: float, origin: Vector, d: Vector) -> float:
    """Distance along a unit ray to a disk, inf where it is not met."""
    p, w = carried(frame, origin), turned(frame, d)
    reach = floor_distance(p[2], w[2])
    if not reach < math.inf:
        return math.inf
    x, y = p[0] + reach * w[0], p[1] + reach * w[1]
    return reach if x * x + y * y <= radius * radius else math.inf


@jitable
def disk_point(frame: Frame, radius: float, a: float, b: float) -> Vector:
    """A place of a disk, uniform by area."""
    r, t = radius * math.sqrt(a), 2.0 * math.pi * b
    p = along(triple(frame.origin), r * math.cos(t), triple(frame.east))
    return along(p, r * math.sin(t), triple(frame.north))
