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
from symrender.radiometric.pieces import POLYGON, Piece, corner
from symrender.radiometric.pixels.records import (
    CONIC,
    LIMB,
    LINE,
    QUARTIC,
    RIM,
    TOUCH,
    Family,
    Section,
    Wall,
)
from symrender.radiometric.pixels.turned import turned_walls
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import CHECKER, MARBLE, SOLID, STRIPES
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, DISK, POINT, SKY, SPHERE, SPOT


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
    piece = world.pieces[own]
    xx, yy, zz, xy, xz, yz, x, y, z, rest = quadric
    if piece.kind != SPHERE:
        up = vector(piece.up)
        height = height_over(piece, eye)
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
        wall.center[0], wall.center[1], wall.center[2] = minus(vector(piece.place), eye)
        wall.rest, wall.radius = rest, piece.radius
    return count + 1


@jitable
def put_section(
    world: World, eye: Vector, walls: Table[Wall], count: int, own: int, other: int, soft: float, axis: Vector,
    level: float,
) -> int:  # fmt: skip
    """List where the plane m.p = k, of places relative to the eye, cuts shape ``own``."""
    piece = world.pieces[own]
    if piece.kind != SPHERE:
        up = vector(piece.up)
        height = height_over(piece, eye)
        return put_line(walls, count, leaves.section_on_plane(*axis, level, *up, height), own, other)
    center = minus(vector(piece.place), eye)
    size = math.sqrt(dot(axis, axis))
    if size == 0.0 or abs(dot(axis, center) - level) >= size * piece.radius * (1.0 + 1e-9):
        return count
    if abs(level) <= 1e-13 * size * (math.sqrt(dot(center, center)) + piece.radius):
        # seen edge-on
        return put_line(walls, count, axis, own, other)
    return put_conic(
        walls, count, own, other, soft, *leaves.section_on_ball(*axis, level, *center, piece.radius)
    )  # fmt: skip


@jitable
def put_outline(world: World, eye: Vector, walls: Table[Wall], count: int, own: int) -> int:
    """List what bounds a piece as the eye sees it."""
    piece = world.pieces[own]
    c = minus(vector(piece.place), eye)
    if piece.kind == SPHERE:
        if leaves.sphere_power(*c, piece.radius) > 0.0:
            count = put_conic(walls, count, own, -1, LIMB, *leaves.silhouette_conic(*c, piece.radius))
    elif piece.kind == DISK:
        count = put_quadric(world, eye, walls, count, own, 0.0, leaves.ball_quadric(*c, piece.radius))
    elif piece.kind == POLYGON:
        last = minus(corner(piece, int(piece.count) - 1), eye)
        for k in range(int(piece.count)):
            here = minus(corner(piece, k), eye)
            count = put_line(walls, count, cross(last, here), own, -1)
            last = here
    else:
        count = put_line(walls, count, vector(piece.up), own, -1)
    return count


@jitable
def put_meeting(world: World, eye: Vector, walls: Table[Wall], count: int, j: int, i: int) -> int:
    """List where the surfaces of two pieces meet, those of flat ones as if they had no end."""
    piece, other = world.pieces[j], world.pieces[i]
    if piece.kind == SPHERE and other.kind == SPHERE:
        c, o = minus(vector(piece.place), eye), minus(vector(other.place), eye)
        way = minus(o, c)
        apart = math.sqrt(dot(way, way))
        low, high = abs(piece.radius - other.radius), piece.radius + other.radius
        if low * (1.0 - 1e-9) <= apart <= high * (1.0 + 1e-9):
            level = leaves.sphere_power(*o, other.radius) - leaves.sphere_power(*c, piece.radius)
            axis = (2.0 * way[0], 2.0 * way[1], 2.0 * way[2])
            count = put_section(world, eye, walls, count, j, i, 0.0, axis, level)
    elif piece.owner != other.owner:
        if piece.kind != SPHERE:
            count = put_section(world, eye, walls, count, i, j, 0.0, vector(piece.up), -height_over(piece, eye))
        else:
            count = put_section(world, eye, walls, count, j, i, 0.0, vector(other.up), -height_over(other, eye))
    return count


@jitable
def sight_walls(world: World, eye: Vector, walls: Table[Wall], count: int, unseen: int) -> int:
    """Rims and horizons, and where two pieces meet: nothing else changes what a ray meets first.

    Piece ``unseen`` is one that the eye is on and never sees.
    """
    for j in range(world.pieces.shape[0]):
        if j == unseen:
            continue
        count = put_outline(world, eye, walls, count, j)
        for i in range(j):
            if i != unseen:
                count = put_meeting(world, eye, walls, count, j, i)
    return count


@jitable
def texture_walls(world: World, eye: Vector, walls: Table[Wall], count: int, unseen: int) -> int:
    """Meridians and parallels of textured spheres: all of them, and the meridian where marble does not close."""
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        material = world.materials[int(piece.material)]
        if piece.kind != SPHERE or material.texture == SOLID or j == unseen:
            continue
        c = minus(vector(piece.place), eye)
        turns = 0 if material.texture == MARBLE else math.ceil(2.0 / material.cell)
        for k in range(turns + 1):
            angle = math.pi * (min(k * material.cell, 2.0) - 1.0)
            axis = (math.sin(angle), -math.cos(angle), 0.0)
            count = put_section(world, eye, walls, count, j, -1, 0.0, axis, dot(axis, c))
        if material.texture == CHECKER:
            for k in range(1, math.ceil(1.0 / material.cell)):
                level = c[2] + piece.radius * math.cos(math.pi * k * material.cell)
                count = put_section(world, eye, walls, count, j, -1, 0.0, (0.0, 0.0, 1.0), level)
    return count


@jitable
def put_shadow(
    world: World, eye: Vector, walls: Table[Wall], count: int, own: int, i: int, far: bool, at: Vector
) -> int:  # fmt: skip
    """List the edge of the shadow of piece i on piece ``own`` from a point ``at``, or in light along ``at``."""
    other = world.pieces[i]
    o = minus(vector(other.place), eye)
    if other.kind == SPHERE:
        if not far:
            count = put_quadric(world, eye, walls, count, own, 0.0, leaves.cylinder_quadric(*o, other.radius, *at))
        elif leaves.sphere_power(*minus(o, at), other.radius) > 0.0:
            quadric = leaves.envelope_quadric(*o, other.radius, *at, 0.0)
            count = put_quadric(world, eye, walls, count, own, 0.0, quadric)
    elif other.kind == DISK:
        up = vector(other.up)
        if far:
            quadric = leaves.disk_cone_quadric(*o, *up, other.radius, *at)
        else:
            quadric = leaves.disk_cylinder_quadric(*o, *up, other.radius, *at)
        count = put_quadric(world, eye, walls, count, own, 0.0, quadric)
    elif other.kind == POLYGON and other.owner != world.pieces[own].owner:
        last = minus(corner(other, int(other.count) - 1), eye)
        for k in range(int(other.count)):
            here = minus(corner(other, k), eye)
            axis = cross(minus(last, at), minus(here, at)) if far else cross(minus(here, last), at)
            count = put_section(world, eye, walls, count, own, -1, 0.0, axis, dot(axis, here))
            last = here
    return count


@jitable
def point_walls(world: World, eye: Vector, own: int, light: int, walls: Table[Wall], count: int) -> int:
    """Terminator, rims of a spot's cone and edges of shadows, on piece ``own``, of light from a point or a direction.

    What is flat is in its own shadow as a whole, and a plane's shadow ends where it meets what it falls on.
    """
    piece, lamp = world.pieces[own], world.lights[light]
    far = lamp.kind != DIRECTIONAL
    at = minus(vector(lamp.place), eye) if far else vector(lamp.place)
    if piece.kind == SPHERE:
        c = minus(vector(piece.place), eye)
        axis = minus(at, c) if far else at
        level = dot(axis, c) + (piece.radius * piece.radius if far else 0.0)
        count = put_section(world, eye, walls, count, own, -1, 0.0, axis, level)
    if lamp.kind == SPOT:
        for side in range(2):
            angle = lamp.cutoff if side == 0 else lamp.beam
            cosine = math.cos(angle * (math.pi / 180.0))
            quadric = leaves.cone_quadric(*at, *vector(lamp.axis), cosine)
            count = put_quadric(world, eye, walls, count, own, 0.0, quadric)
    for i in range(world.pieces.shape[0]):
        if i != own:
            count = put_shadow(world, eye, walls, count, own, i, far, at)
    return count


@jitable
def cap_walls(world: World, eye: Vector, own: int, light: int, walls: Table[Wall], count: int) -> int:
    """Where caps that bound what shape ``own`` sees of a sky or a sphere touch each other."""
    piece, sky = world.pieces[own], world.lights[light].kind == SKY
    c = minus(vector(piece.place), eye)
    for i in range(world.pieces.shape[0]):
        first = world.pieces[i]
        if i == own or first.kind != SPHERE:
            continue
        o = minus(vector(first.place), eye)
        if piece.kind == SPHERE:
            axis = minus(o, c)
            for side in range(2):
                reach = piece.radius * (piece.radius + (first.radius if side == 0 else -first.radius))
                count = put_section(world, eye, walls, count, own, -1, TOUCH, axis, dot(axis, c) + reach)
        for k in range(world.pieces.shape[0]):
            second = world.pieces[k]
            if k == own:
                continue
            if second.kind != SPHERE:
                if sky:
                    up = vector(second.up)
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


@jitable
def put_walls(world: World, at: Vector, walls: Table[Wall], unseen: int) -> int:
    """List all walls; returns how many there are, of which only those that fit into ``walls`` are written.

    Piece ``unseen`` is one that the eye is on and never sees.
    """
    count = texture_walls(world, at, walls, sight_walls(world, at, walls, 0, unseen), unseen)
    count = turned_walls(world, walls, count, unseen)
    for own in range(world.pieces.shape[0]):
        if own == unseen:
            continue
        for light in range(world.lights.shape[0]):
            kind = world.lights[light].kind
            if kind in (POINT, DIRECTIONAL, SPOT):
                count = point_walls(world, at, own, light, walls, count)
            elif kind in (SKY, AREA):
                count = cap_walls(world, at, own, light, walls, count)
    return count


def list_walls(world: World, eye: Array, walls: Table[Wall]) -> int:
    """The same as a kernel."""
    return put_walls(world, (eye[0], eye[1], eye[2]), walls, -1)


def list_seen_walls(world: World, eye: Array, walls: Table[Wall]) -> int:
    """Walls at which what arrives at the places that are seen, or how they reflect it, jumps whatever shines."""
    at = (eye[0], eye[1], eye[2])
    return texture_walls(world, at, walls, sight_walls(world, at, walls, 0, -1), -1)


def list_series_walls(world: World, eye: Array, sections: Table[Section], walls: Table[Wall]) -> int:
    """Walls of a scene in units of the series, whose textures of spheres are cut at ``sections``."""
    at = (eye[0], eye[1], eye[2])
    count = sight_walls(world, at, walls, 0, -1)
    for k in range(sections.shape[0]):
        section = sections[k]
        count = put_section(world, at, walls, count, int(section.own), -1, 0.0, vector(section.axis), section.level)
    for own in range(world.pieces.shape[0]):
        for light in range(world.lights.shape[0]):
            count = point_walls(world, at, own, light, walls, count)
    return count


@jitable
def put_family(families: Table[Family], count: int, own: int, cuts: bool, piece: Piece, axis: Vector, eye: Vector,
               cell: float) -> int:  # fmt: skip
    """List a coordinate of a plane's texture: x = (e.(E - O) (u.v) - h (e.v))/(u.v), in cells."""
    if count < families.shape[0]:
        family = families[count]
        up = vector(piece.up)
        start = minus(eye, vector(piece.place))
        height, along = dot(start, up), dot(start, axis)
        family.own, family.cuts = own, 1.0 if cuts else 0.0
        for q in range(3):
            family.numerator[q] = (along * up[q] - height * axis[q]) / cell
            family.denominator[q] = up[q]
    return count + 1


@jitable
def put_families(world: World, at: Vector, families: Table[Family]) -> int:
    """List the coordinates of all textured planes, x then y; returns how many there are."""
    count = 0
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        material = world.materials[int(piece.material)]
        if piece.kind == SPHERE or material.texture == SOLID:
            continue
        cuts = material.texture != MARBLE
        count = put_family(families, count, j, cuts, piece, vector(piece.east), at, material.cell)
        if material.texture != STRIPES:
            count = put_family(families, count, j, cuts, piece, vector(piece.north), at, material.cell)
    return count


def list_families(world: World, eye: Array, families: Table[Family]) -> int:
    """The same as a kernel."""
    return put_families(world, (eye[0], eye[1], eye[2]), families)


@jitable
def put_lens_walls(
    world: World, at: Vector, forward: Vector, focus: float, walls: Table[Wall], count: int
) -> int:  # fmt: skip
    """List the rim of a lens, and where shapes cut it: rays on their two sides begin inside and outside.

    The lens lies at right angles to ``forward``, ``focus`` before the place ``at`` that its rays meet in.
    """
    if count < walls.shape[0]:
        wall = walls[count]
        wall.kind, wall.own, wall.other, wall.soft = RIM, -1, -1, 0.0
    count += 1
    for j in range(world.pieces.shape[0]):
        count = put_section(world, at, walls, count, j, -1, 0.0, forward, -focus)
    return count
