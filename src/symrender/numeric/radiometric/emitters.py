"""Shapes that emit: directions towards them and the density of these, what is seen of them."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.numeric.radiometric.hits import Hit
from symrender.numeric.radiometric.meshes import Face, face_normal, sides
from symrender.numeric.radiometric.shapes.dispatch import area_of, point_on
from symrender.numeric.radiometric.shapes.sphere import cone_of
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, along, cross, dot, minus, triple, unit
from symrender.scene.radiometric.arrays import AREA, MESH, SPHERE

_UNIFORM: Final = 1.0 / (2.0 * math.pi)


@jitable
def face_area(face: Face) -> float:
    """Area of a face of a mesh."""
    _, u, v = sides(face)
    n = cross(u, v)
    return 0.5 * math.sqrt(dot(n, n))


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
        at, n = point_on(shape, world.frames[emitter], a, b)
        way = minus(at, place)
        # a way to the far side of a closed shape is none, for it meets the near side, to which there are ways already
        return unit(way), dot(way, n) < 0.0, -1
    axis, height = cone_of(shape, place)
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
        return _UNIFORM / cone_of(shape, place)[1]
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
