"""Shapes that emit: directions towards them and the density of these, what is seen of them."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.flats import box_normal, corner_normal, edges, straight, triple
from symrender.numeric.radiometric.hits import Hit
from symrender.numeric.radiometric.meshes import Face, face_normal, sides
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, along, cross, dot, minus, unit
from symrender.scene.radiometric.arrays import AREA, BOX, DISK, MESH, RECTANGLE, SPHERE, TRIANGLE
from symrender.scene.radiometric.records import Shape

_UNIFORM: Final = 1.0 / (2.0 * math.pi)


@jitable
def cone_of(world: World, sphere: int, place: Vector) -> tuple[Vector, float]:
    """(unit axis, 1 - cosine of the half-angle) of the cone that a sphere fills; 0 where it is seen from inside."""
    lamp = world.shapes[sphere]
    way = minus(triple(lamp.place), place)
    far2 = dot(way, way)
    sine2 = lamp.radius * lamp.radius / far2
    height = sine2 / (1.0 + math.sqrt(1.0 - sine2)) if sine2 < 1.0 else 0.0
    return unit(way), height


@jitable
def area_of(shape: Shape) -> float:
    """Area of a flat shape, of all faces of a box."""
    if shape.kind == DISK:
        return math.pi * shape.radius * shape.radius
    if shape.kind == BOX:
        a, b, c = triple(shape.second)
        return 2.0 * (a * b + b * c + c * a)
    u, v = edges(shape)
    n = cross(u, v)
    whole = math.sqrt(dot(n, n))
    return 0.5 * whole if shape.kind == TRIANGLE else whole


@jitable
def face_area(face: Face) -> float:
    """Area of a face of a mesh."""
    _, u, v = sides(face)
    n = cross(u, v)
    return 0.5 * math.sqrt(dot(n, n))


@inlined
def turned_back(shape: Shape, v: Vector) -> Vector:
    """A direction of a box's coordinates in the world."""
    east, north = straight(shape, (1.0, 0.0, 0.0)), straight(shape, (0.0, 1.0, 0.0))
    return (east[0] * v[0] + east[1] * v[1], north[0] * v[0] + north[1] * v[1], v[2])


@jitable
def box_point(shape: Shape, a: float, b: float) -> Vector:
    """A place on a box, uniform over its faces."""
    x, y, z = triple(shape.second)
    pair = 0.5 * area_of(shape)
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


@jitable
def flat_point(world: World, emitter: int, a: float, b: float) -> Vector:
    """A place of a flat shape, uniform by area."""
    shape = world.shapes[emitter]
    if shape.kind == BOX:
        return box_point(shape, a, b)
    if shape.kind == DISK:
        frame = world.frames[emitter]
        r, t = shape.radius * math.sqrt(a), 2.0 * math.pi * b
        p = along(triple(frame.origin), r * math.cos(t), triple(frame.east))
        return along(p, r * math.sin(t), triple(frame.north))
    u, v = edges(shape)
    if shape.kind == RECTANGLE:
        return along(along(triple(shape.place), a, u), b, v)
    r = math.sqrt(a)
    return along(along(triple(shape.place), r * (1.0 - b), u), r * b, v)


@jitable
def face_point(face: Face, a: float, b: float) -> Vector:
    """A place of a face of a mesh, uniform by area."""
    corner, u, v = sides(face)
    r = math.sqrt(a)
    return along(along(corner, r * (1.0 - b), u), r * b, v)


@jitable
def emitter_sample(world: World, emitter: int, place: Vector, a: float, b: float) -> tuple[Vector, bool, int]:
    """(unit direction towards a shape that emits, whether there is one, the face of a mesh that it leads to, else -1).

    In the cone of a sphere, on any face of a mesh alike, by area else.
    """
    shape = world.shapes[emitter]
    if shape.kind == MESH:
        chosen = min(int(a * shape.faces), int(shape.faces) - 1)
        face = int(shape.start) + chosen
        way = minus(face_point(world.faces[face], a * shape.faces - chosen, b), place)
        return unit(way), dot(way, face_normal(world.faces[face])) < 0.0, face
    if shape.kind != SPHERE:
        at = flat_point(world, emitter, a, b)
        way = minus(at, place)
        # a way to the far side of a box is none, for it meets the near side, to which there are ways already
        if shape.kind == BOX:
            n = box_normal(shape, at)
        else:
            n = triple(world.frames[emitter].up) if shape.kind == DISK else corner_normal(shape)
        return unit(way), dot(way, n) < 0.0, -1
    axis, height = cone_of(world, emitter, place)
    up = 1.0 - a * height
    r = math.sqrt(max(0.0, a * height * (2.0 - a * height)))
    first = unit(cross(axis, (0.0, 0.0, 1.0) if abs(axis[2]) < 0.7 else (1.0, 0.0, 0.0)))
    x, y = r * math.cos(2.0 * math.pi * b), r * math.sin(2.0 * math.pi * b)
    d = along(along((up * axis[0], up * axis[1], up * axis[2]), x, first), y, cross(axis, first))
    return d, height > 0.0, -1


@jitable
def chance_of(world: World, hit: Hit, place: Vector, d: Vector) -> float:
    """Density, per solid angle, with which ``emitter_sample`` of a shape chooses the direction d to a hit of it."""
    shape = world.shapes[hit.own]
    if shape.kind == SPHERE:
        return _UNIFORM / cone_of(world, hit.own, place)[1]
    way = minus(hit.place, place)
    area = shape.faces * face_area(world.faces[hit.face]) if shape.kind == MESH else area_of(shape)
    return dot(way, way) / max(abs(dot(d, hit.outward)) * area, 1e-300)


@jitable
def shining(world: World, hit: Hit) -> Vector:
    """Radiance that a hit emits: of shapes that are lights, on the side of their normal."""
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        if light.kind == AREA and int(light.emitter) == hit.own and not hit.behind:
            return triple(light.emitted)
    return (0.0, 0.0, 0.0)
