"""Where rays meet the shapes of a radiometric scene, the way a ray tracer finds out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.hierarchy import first_blade
from symrender.numeric.radiometric.meshes import face_normal, face_place
from symrender.numeric.radiometric.shapes.dispatch import distance_to, place_at, texture_place
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, along, dot, minus, triple
from symrender.scene.arrays import CHECKER, MARBLE, SOLID
from symrender.scene.radiometric.arrays import MESH


class Hit(NamedTuple):
    """A place of shape ``own`` (-1: none) at ``distance``; ``outward`` is the shape's normal there.

    ``face`` is the face of a mesh, of other shapes the part of them that was met, below 0. ``behind`` says that the ray
    came from the side the normal points away from.
    """

    own: int
    face: int
    distance: float
    place: Vector
    outward: Vector
    behind: bool


@jitable
def first_hit(world: World, origin: Vector, d: Vector, left: int, face: int, inside: bool) -> Hit:
    """What the unit ray meets first; shape ``left``, which it starts from, only from its ``inside``.

    Of a mesh it starts from a ``face``, which it does not meet again.
    """
    part, distance = first_blade(world.blades, world.nodes, world.grid, world.stack, origin, d, face)
    best = int(world.faces[part].owner) if part >= 0 else -1
    far = False
    for j in range(world.shapes.shape[0]):
        reach, met, within = distance_to(world.shapes[j], world.frames[j], origin, d, j == left, face, inside)
        if reach < distance:
            best, part, distance, far = j, met, reach, within
    if best < 0:
        return Hit(-1, -1, math.inf, origin, d, False)
    shape = world.shapes[best]
    if shape.kind == MESH:
        n = face_normal(world.faces[part])
        return Hit(best, part, distance, along(origin, distance, d), n, dot(n, d) > 0.0)
    place, n, behind = place_at(shape, world.frames[best], origin, d, distance, part, far)
    return Hit(best, part, distance, place, n, behind)


@jitable
def reaches(world: World, hit: Hit, toward: Vector, limit: float, inside: bool) -> bool:
    """Whether nothing is met before ``limit`` along a unit direction from a hit, to the ``inside`` of its shape."""
    return first_hit(world, hit.place, toward, hit.own, hit.face, inside).distance >= limit


@inlined
def odd_field(x: float) -> bool:
    """Whether x lies in an odd field; an edge belongs to the field it begins."""
    return bool(np.floor(x) - 2.0 * np.floor(np.floor(x) / 2.0) != 0.0)


@jitable
def chart_place(world: World, hit: Hit, cell: float) -> tuple[float, float]:
    """(x, y) of the texture at a hit, counted in cells."""
    if world.shapes[hit.own].kind == MESH:
        x, y = face_place(world.faces[hit.face], hit.place)
        return x / cell, y / cell
    return texture_place(world.shapes[hit.own], world.frames[hit.own], hit.place, hit.outward, hit.face, cell)


@jitable
def albedo(world: World, hit: Hit) -> Vector:
    """Reflectance at a hit."""
    shape = world.shapes[hit.own]
    material = world.materials[int(shape.material)]
    bright, dark = triple(material.bright), triple(material.dark)
    if material.texture == SOLID:
        return bright
    x, y = chart_place(world, hit, material.cell)
    if material.texture == MARBLE:
        wave = math.sin(3.0 * math.pi * y)
        m = 0.5 + 0.5 * math.sin(2.0 * math.pi * x + 0.7 * math.pi * wave)
        return along(dark, m, minus(bright, dark))
    if material.texture == CHECKER:
        return dark if odd_field(x) != odd_field(y) else bright
    return dark if odd_field(x) else bright
