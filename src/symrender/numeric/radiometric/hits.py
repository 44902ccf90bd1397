"""Where rays meet the shapes of a radiometric scene, the way a ray tracer finds out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried, turned
from symrender.numeric.radiometric.flats import (
    box_distance,
    box_normal,
    box_place,
    corner_distance,
    corner_normal,
    corner_place,
    disk_distance,
    triple,
)
from symrender.numeric.radiometric.hierarchy import first_blade
from symrender.numeric.radiometric.meshes import face_normal, face_place
from symrender.numeric.radiometric.world import World
from symrender.numeric.rays import floor_distance, sphere_offset, sphere_roots
from symrender.numeric.vectors import Vector, along, dot, minus
from symrender.scene.arrays import CHECKER, MARBLE, PLANE, SOLID
from symrender.scene.radiometric.arrays import BOX, DISK, MESH, RECTANGLE, SPHERE, TRIANGLE
from symrender.scene.records import Frame


class Hit(NamedTuple):
    """A place of shape ``own`` (-1: none) at ``distance``; ``outward`` is the shape's normal there.

    ``face`` is the face of a mesh, -1 of others. ``behind`` says that the ray came from the side the normal points away
    from.
    """

    own: int
    face: int
    distance: float
    place: Vector
    outward: Vector
    behind: bool


@inlined
def level(frame: Frame, p: Vector, d: Vector) -> float:
    """Distance along a unit ray to a plane, inf where it is not met."""
    return floor_distance(carried(frame, p)[2], turned(frame, d)[2])


@jitable
def first_hit(world: World, origin: Vector, d: Vector, left: int, face: int, inside: bool) -> Hit:
    """What the unit ray meets first; shape ``left``, which it starts from, only from its ``inside``.

    Of a mesh it starts from a ``face``, which it does not meet again.
    """
    part, distance = first_blade(world.blades, world.nodes, world.grid, world.stack, origin, d, face)
    best = int(world.faces[part].owner) if part >= 0 else -1
    far = False
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            f = minus(origin, triple(shape.place))
            reach, from_within = math.inf, False
            if j == left:
                if inside:
                    # a chord from the sphere itself
                    reach, from_within = -2.0 * dot(f, d), True
            else:
                power = dot(f, f) - shape.radius * shape.radius
                near, other = sphere_roots(f, d, shape.radius, power)
                from_within = power <= 0.0
                reach = other if from_within else near
            if 0.0 < reach < distance:
                best, distance, far = j, reach, from_within
        elif shape.kind == BOX:
            if j != left or inside:
                reach, from_within = box_distance(shape, origin, d, j == left)
                if reach < distance:
                    best, distance, far = j, reach, from_within
        elif j != left and shape.kind != MESH:
            if shape.kind == PLANE:
                reach = level(world.frames[j], origin, d)
            elif shape.kind == DISK:
                reach = disk_distance(world.frames[j], shape.radius, origin, d)
            else:
                reach = corner_distance(shape, origin, d)
            if reach < distance:
                best, distance, far = j, reach, False
    if best < 0:
        return Hit(-1, -1, math.inf, origin, d, False)
    shape, frame = world.shapes[best], world.frames[best]
    if shape.kind == MESH:
        n = face_normal(world.faces[part])
        return Hit(best, part, distance, along(origin, distance, d), n, dot(n, d) > 0.0)
    if shape.kind == BOX:
        p = along(origin, distance, d)
        n = box_normal(shape, p)
        return Hit(best, -1, distance, p, n, far)
    if shape.kind == RECTANGLE or shape.kind == TRIANGLE:
        n = corner_normal(shape)
        return Hit(best, -1, distance, along(origin, distance, d), n, dot(n, d) > 0.0)
    if shape.kind == SPHERE:
        n = sphere_offset(minus(origin, triple(shape.place)), d, shape.radius, far)
        return Hit(best, -1, distance, along(triple(shape.place), shape.radius, n), n, far)
    n = triple(frame.up)
    return Hit(best, -1, distance, along(origin, distance, d), n, dot(n, d) > 0.0)


@jitable
def reaches(world: World, hit: Hit, toward: Vector, limit: float) -> bool:
    """Whether nothing is met before ``limit`` along a unit direction on the side of a hit that the ray came from."""
    return first_hit(world, hit.place, toward, hit.own, hit.face, hit.behind).distance >= limit


@inlined
def odd_field(x: float) -> bool:
    """Whether x lies in an odd field; an edge belongs to the field it begins."""
    return bool(np.floor(x) - 2.0 * np.floor(np.floor(x) / 2.0) != 0.0)


@jitable
def flat_place(world: World, hit: Hit) -> tuple[float, float]:
    """(x, y) of the texture of a flat shape at a hit."""
    shape = world.shapes[hit.own]
    if shape.kind == MESH:
        return face_place(world.faces[hit.face], hit.place)
    if shape.kind == BOX:
        return box_place(shape, hit.place, hit.outward)
    if shape.kind == RECTANGLE or shape.kind == TRIANGLE:
        return corner_place(shape, hit.place)
    p = carried(world.frames[hit.own], hit.place)
    return p[0], p[1]


@jitable
def albedo(world: World, hit: Hit) -> Vector:
    """Reflectance at a hit."""
    shape = world.shapes[hit.own]
    material = world.materials[int(shape.material)]
    bright, dark = triple(material.bright), triple(material.dark)
    if material.texture == SOLID:
        return bright
    if shape.kind == SPHERE:
        n = hit.outward
        x = (math.pi + math.atan2(n[1], n[0])) / (math.pi * material.cell)
        y = math.atan2(math.sqrt(n[0] * n[0] + n[1] * n[1]), n[2]) / (math.pi * material.cell)
    else:
        x, y = flat_place(world, hit)
        x, y = x / material.cell, y / material.cell
    if material.texture == MARBLE:
        wave = math.sin(3.0 * math.pi * y)
        m = 0.5 + 0.5 * math.sin(2.0 * math.pi * x + 0.7 * math.pi * wave)
        return along(dark, m, minus(bright, dark))
    if material.texture == CHECKER:
        return dark if odd_field(x) != odd_field(y) else bright
    return dark if odd_field(x) else bright
