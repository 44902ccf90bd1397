"""All walls of a scene as an eye sees them: what makes the list complete is said where each kind is put.

Radiance along a ray is smooth but where the shape met changes (silhouettes, horizons, places where shapes meet), where
a texture does, and where the direct light does: at terminators and edges of shadows of points and directions, and, of
lights with an extent, where a cap that bounds what is seen of them touches another (two spheres seen from a place: the
cones tangent to both; a sphere and the horizon of the place, or that of another plane). Walls behind the eye or hidden
cost time and no more.
"""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pixels.records import CONIC, LIMB, LINE, QUARTIC, TOUCH, Family, Wall
from symrender.radiometric.sight import dot, minus, vector
from symrender.radiometric.world import Array, Vector, World
from symrender.scene.arrays import CHECKER, MARBLE, SOLID, STRIPES
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, POINT, SKY, SPHERE
from symrender.scene.records import Frame


@jitable
def put_line(walls: Table[Wall], count: int, n: Vector, own: int, other: int) -> int:
    """List the line n.v = 0; returns how many walls there are, of which only those that fit are written."""
    if max(abs(n[0]), abs(n[1]), abs(n[2])) == 0.0:
        return count
    if count < walls.shape[0]:
        wall = walls[count]
        wall.kind, wall.own, wall.other, wall.soft = LINE, own, other, 0.0
        wall.normal[0], wall.normal[1], wall.normal[2] = n
    return count + 1


@jitable
def put_conic(
    walls: Table[Wall], count: int, own: int, other: int, soft: float, xx: float, yy: float, zz: float, xy: float,
    xz: float, yz: float,
) -> int:  # fmt: skip
    """List the conic v.M v = 0."""
    if count < walls.shape[0]:
        wall = walls[count]
        wall.kind, wall.own, wall.other, wall.soft = CONIC, own, other, soft
        form = wall.form
        form[0], form[1], form[2], form[3], form[4], form[5] = xx, yy, zz, xy, xz, yz
    return count + 1


@jitable
def put_quadric(
    world: World, eye: Vector, walls: Table[Wall], count: int, own: int, soft: float, quadric: tuple[
        float, float, float, float, float, float, float, float, float, float],
) -> int:  # fmt: skip
    """List where a quadric cuts shape ``own``."""
    shape = world.shapes[own]
    xx, yy, zz, xy, xz, yz, x, y, z, rest = quadric
    if shape.kind != SPHERE:
        up = vector(world.frames[own].up)
        height = leaves.height(*eye, *vector(world.frames[own].origin), *up)
        return put_conic(
            walls, count, own, -1, soft,
            *leaves.quadric_on_plane(xx, yy, zz, xy, xz, yz, x, y, z, rest, *up, height),
        )  # fmt: skip
    if count < walls.shape[0]:
        wall = walls[count]
        wall.kind, wall.own, wall.other, wall.soft = QUARTIC, own, -1, soft
        form = wall.form
        form[0], form[1], form[2], form[3], form[4], form[5] = xx, yy, zz, xy, xz, yz
        wall.linear[0], wall.linear[1], wall.linear[2] = x, y, z
        wall.center[0], wall.center[1], wall.center[2] = minus(vector(shape.place), eye)
        wall.rest, wall.radius = rest, shape.radius
    return count + 1


@jitable
def put_section(
    world: World, eye: Vector, walls: Table[Wall], count: int, own: int, other: int, soft: float, axis: Vector,
    level: float,
) -> int:  # fmt: skip
    """List where the plane m.p = k, of places relative to the eye, cuts shape ``own``."""
    shape = world.shapes[own]
    if shape.kind != SPHERE:
        up = vector(world.frames[own].up)
        height = leaves.height(*eye, *vector(world.frames[own].origin), *up)
        return put_line(walls, count, leaves.section_on_plane(*axis, level, *up, height), own, other)
    center = minus(vector(shape.place), eye)
    size = math.sqrt(dot(axis, axis))
    if size == 0.0 or abs(dot(axis, center) - level) >= size * shape.radius * (1.0 + 1e-9):
        return count
    if abs(level) <= 1e-13 * size * (math.sqrt(dot(center, center)) + shape.radius):
        # seen edge-on
        return put_line(walls, count, axis, own, other)
    return put_conic(
        walls, count, own, other, soft, *leaves.section_on_ball(*axis, level, *center, shape.radius)
    )  # fmt: skip


@jitable
def sight_walls(world: World, eye: Vector, walls: Table[Wall], count: int) -> int:
    """Silhouettes, horizons, and where two shapes meet: nothing else changes what a ray meets first."""
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        c = minus(vector(shape.place), eye)
        if shape.kind == SPHERE:
            if leaves.sphere_power(*c, shape.radius) > 0.0:
                count = put_conic(walls, count, j, -1, LIMB, *leaves.silhouette_conic(*c, shape.radius))
        else:
            count = put_line(walls, count, vector(world.frames[j].up), j, -1)
        for i in range(j):
            other = world.shapes[i]
            o = minus(vector(other.place), eye)
            if shape.kind == SPHERE and other.kind == SPHERE:
                way = minus(o, c)
                apart = math.sqrt(dot(way, way))
                if (
                    abs(shape.radius - other.radius) * (1.0 - 1e-9)
                    <= apart
                    <= (shape.radius + other.radius) * (1.0 + 1e-9)
                ):
                    level = leaves.sphere_power(*o, other.radius) - leaves.sphere_power(*c, shape.radius)
                    axis = (2.0 * way[0], 2.0 * way[1], 2.0 * way[2])
                    count = put_section(world, eye, walls, count, j, i, 0.0, axis, level)
            elif shape.kind != SPHERE:
                up = vector(world.frames[j].up)
                height = leaves.height(*eye, *vector(world.frames[j].origin), *up)
                count = put_section(world, eye, walls, count, i, j, 0.0, up, -height)
            else:
                up = vector(world.frames[i].up)
                height = leaves.height(*eye, *vector(world.frames[i].origin), *up)
                count = put_section(world, eye, walls, count, j, i, 0.0, up, -height)
    return count


@jitable
def texture_walls(world: World, eye: Vector, walls: Table[Wall], count: int) -> int:
    """Meridians and parallels of textured spheres: all of them, and the meridian where marble does not close."""
    for j in range(world.shapes.shape[0]):
        shape = world.shapes[j]
        material = world.materials[int(shape.material)]
        if shape.kind != SPHERE or material.texture == SOLID:
            continue
        c = minus(vector(shape.place), eye)
        turns = 0 if material.texture == MARBLE else math.ceil(2.0 / material.cell)
        for k in range(turns + 1):
            angle = math.pi * (min(k * material.cell, 2.0) - 1.0)
            axis = (math.sin(angle), -math.cos(angle), 0.0)
            count = put_section(world, eye, walls, count, j, -1, 0.0, axis, dot(axis, c))
        if material.texture == CHECKER:
            for k in range(1, math.ceil(1.0 / material.cell)):
                level = c[2] + shape.radius * math.cos(math.pi * k * material.cell)
                count = put_section(world, eye, walls, count, j, -1, 0.0, (0.0, 0.0, 1.0), level)
    return count


@jitable
def point_walls(world: World, eye: Vector, own: int, light: int, walls: Table[Wall], count: int) -> int:
    """Terminator and shadow edges of a point or a direction on shape ``own``: of planes only where shapes meet."""
    shape, lamp = world.shapes[own], world.lights[light]
    far = lamp.kind == POINT
    at = minus(vector(lamp.place), eye) if far else vector(lamp.place)
    c = minus(vector(shape.place), eye)
    if shape.kind == SPHERE:
        axis = minus(at, c) if far else at
        level = dot(axis, c) + (shape.radius * shape.radius if far else 0.0)
        count = put_section(world, eye, walls, count, own, -1, 0.0, axis, level)
    for i in range(world.shapes.shape[0]):
        other = world.shapes[i]
        if i == own or other.kind != SPHERE:
            continue
        o = minus(vector(other.place), eye)
        if not far:
            count = put_quadric(world, eye, walls, count, own, 0.0, leaves.cylinder_quadric(*o, other.radius, *at))
        elif leaves.sphere_power(*minus(o, at), other.radius) > 0.0:
            count = put_quadric(world, eye, walls, count, own, 0.0, leaves.envelope_quadric(*o, other.radius, *at, 0.0))
    return count


@jitable
def cap_walls(world: World, eye: Vector, own: int, light: int, walls: Table[Wall], count: int) -> int:
    """Where caps that bound what shape ``own`` sees of a sky or a sphere touch each other."""
    shape, sky = world.shapes[own], world.lights[light].kind == SKY
    c = minus(vector(shape.place), eye)
    for i in range(world.shapes.shape[0]):
        first = world.shapes[i]
        if i == own or first.kind != SPHERE:
            continue
        o = minus(vector(first.place), eye)
        if shape.kind == SPHERE:
            axis = minus(o, c)
            for side in range(2):
                reach = shape.radius * (shape.radius + (first.radius if side == 0 else -first.radius))
                count = put_section(world, eye, walls, count, own, -1, TOUCH, axis, dot(axis, c) + reach)
        for k in range(world.shapes.shape[0]):
            second = world.shapes[k]
            if k == own:
                continue
            if second.kind != SPHERE:
                if sky:
                    up = vector(world.frames[k].up)
                    middle = dot(up, o)
                    count = put_section(world, eye, walls, count, own, -1, TOUCH, up, middle + first.radius)
                    count = put_section(world, eye, walls, count, own, -1, TOUCH, up, middle - first.radius)
                continue
            if k >= i:
                continue
            p = minus(vector(second.place), eye)
            way = minus(o, p)
            apart = dot(way, way)
            for side in range(2):
                other = second.radius if side == 0 else -second.radius
                if apart > (first.radius - other) * (first.radius - other):
                    count = put_quadric(
                        world, eye, walls, count, own, TOUCH, leaves.envelope_quadric(*o, first.radius, *p, other)
                    )
    return count


def list_walls(world: World, eye: Array, walls: Table[Wall]) -> int:
    """List all walls; returns how many there are, of which only those that fit into ``walls`` are written."""
    at = (eye[0], eye[1], eye[2])
    count = texture_walls(world, at, walls, sight_walls(world, at, walls, 0))
    for own in range(world.shapes.shape[0]):
        for light in range(world.lights.shape[0]):
            kind = world.lights[light].kind
            if kind in (POINT, DIRECTIONAL):
                count = point_walls(world, at, own, light, walls, count)
            elif kind in (SKY, AREA):
                count = cap_walls(world, at, own, light, walls, count)
    return count


@jitable
def put_family(families: Table[Family], count: int, own: int, cuts: bool, frame: Frame, axis: Vector, eye: Vector,
               cell: float) -> int:  # fmt: skip
    """List a coordinate of a plane's texture: x = (e.(E - O) (u.v) - h (e.v))/(u.v), in cells."""
    if count < families.shape[0]:
        family = families[count]
        up = vector(frame.up)
        start = minus(eye, vector(frame.origin))
        height, along = dot(start, up), dot(start, axis)
        family.own, family.cuts = own, 1.0 if cuts else 0.0
        for q in range(3):
            family.numerator[q] = (along * up[q] - height * axis[q]) / cell
            family.denominator[q] = up[q]
    return count + 1


def list_families(world: World, eye: Array, families: Table[Family]) -> int:
    """List the coordinates of all textured planes, x then y; returns how many there are."""
    count, at = 0, (eye[0], eye[1], eye[2])
    for j in range(world.shapes.shape[0]):
        material = world.materials[int(world.shapes[j].material)]
        if world.shapes[j].kind == SPHERE or material.texture == SOLID:
            continue
        frame, cuts = world.frames[j], material.texture != MARBLE
        count = put_family(families, count, j, cuts, frame, vector(frame.east), at, material.cell)
        if material.texture != STRIPES:
            count = put_family(families, count, j, cuts, frame, vector(frame.north), at, material.cell)
    return count
