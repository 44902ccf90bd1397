"""What a ray meets first, and whether a shape hides a light."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.world import Array, Vector, World
from symrender.scene.radiometric.arrays import SPHERE

_FARTHEST: Final = 1e150
"""Beyond it, where squares overflow, nothing is met."""


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


@jitable
def nearest(world: World, origin: Vector, d: Vector) -> tuple[int, float, Vector, Vector, bool]:
    """(shape or -1, distance, place, unit normal towards the ray, whether the shape's own normal shows to the ray)."""
    best, distance = -1, math.inf
    place, facing, front = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), True
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            offset = minus(vector(shape.place), origin)
            outside = leaves.sphere_power(*offset, shape.radius) > 0.0
            if leaves.sphere_level(*offset, *d, shape.radius) < 0.0 or (outside and dot(offset, d) <= 0.0):
                continue
            side = 1.0 if outside else -1.0
            reach, x, y, z = leaves.sphere_entry(*offset, *d, shape.radius, side)
            if reach < distance:
                best, distance, facing, front = j, reach, (x, y, z), outside
                out = side * shape.radius
                place = (shape.place[0] + out * x, shape.place[1] + out * y, shape.place[2] + out * z)
        else:
            frame = world.frames[j]
            up = vector(frame.up)
            slope = dot(up, d)
            if slope == 0.0:
                continue
            reach = leaves.plane_reach(leaves.height(*origin, *vector(frame.origin), *up), *up, *d)
            if 0.0 < reach < min(distance, _FARTHEST):
                best, distance, front = j, reach, slope < 0.0
                facing = up if front else (-up[0], -up[1], -up[2])
                place = (origin[0] + reach * d[0], origin[1] + reach * d[1], origin[2] + reach * d[2])
    return best, distance, place, facing, front


@jitable
def hidden_point(world: World, own: int, front: bool, place: Vector, light: Vector) -> bool:
    """Whether a shape lies between a place of shape ``own`` and a light on the lit side of its normal."""
    segment = minus(light, place)
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            ahead = leaves.sphere_power(*minus(vector(shape.place), light), shape.radius)
            if j == own:
                # from inside a sphere all of its inside is seen, and nothing else
                if not front and ahead > 0.0:
                    return True
                continue
            offset = minus(vector(shape.place), place)
            here = leaves.sphere_power(*offset, shape.radius)
            along, whole, level = leaves.segment_pass(*offset, *segment, shape.radius)
            between = here >= 0.0 and ahead >= 0.0 and 0.0 < along < whole and level >= 0.0
            if between or here * ahead < 0.0:
                return True
        elif j != own:
            frame = world.frames[j]
            here = leaves.height(*place, *vector(frame.origin), *vector(frame.up))
            ahead = leaves.height(*light, *vector(frame.origin), *vector(frame.up))
            if here * ahead < 0.0:
                return True
    return False


@jitable
def hidden_direction(world: World, own: int, front: bool, place: Vector, toward: Vector) -> bool:
    """Whether a shape is met from a place of shape ``own`` in a unit direction on the lit side of its normal."""
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            if j == own:
                if not front:
                    return True
                continue
            offset = minus(vector(shape.place), place)
            if leaves.sphere_power(*offset, shape.radius) < 0.0:
                return True
            if dot(offset, toward) > 0.0 and leaves.sphere_level(*offset, *toward, shape.radius) >= 0.0:
                return True
        elif j != own:
            frame = world.frames[j]
            up = vector(frame.up)
            if leaves.height(*place, *vector(frame.origin), *up) * dot(up, toward) < 0.0:
                return True
    return False
