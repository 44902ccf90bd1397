"""What is smooth and may still be missed by nodes: highlights narrower than a cell, lights nearer than it is wide."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.bumps import shading_normal
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Cell, Eye, ray_of, step
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.pixels.sight import may_show
from symrender.radiometric.pixels.spots import shows_spot
from symrender.radiometric.sight import height_over, nearest
from symrender.radiometric.vectors import Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import MARBLE
from symrender.scene.radiometric.arrays import AREA, CONDUCTOR, DIFFUSE, DIRECTIONAL, POINT, SKY, SPHERE, SPOT
from symrender.scene.radiometric.records import Material

NEAR: Final = 0.8
"""Largest part of the way to a light, or to where light bounces, that a cell's places may spread over."""
_WIDE: Final = 0.7
"""Largest part of a highlight's width, or of the way to its middle, that a cell may spread over."""
_VEINS: Final = 0.5
"""Largest part of a vein that a side of a cell may spread over."""
_BENT: Final = 3.3
"""By how much veins bend along the other coordinate, at most."""


@jitable
def off_axis(material: Material, normal: Vector, view: Vector, toward: Vector) -> tuple[float, float, float, float]:
    """(how far a direction is from the middle of a highlight as a vector, the highlight's width)."""
    if material.kind == CONDUCTOR:
        x, y, z = view[0] + toward[0], view[1] + toward[1], view[2] + toward[2]
        size = math.sqrt(max(x * x + y * y + z * z, 1e-30))
        # across the normal, and along it, so that a half vector behind is far
        return x / size - normal[0], y / size - normal[1], z / size - normal[2], material.alpha
    x, y, z = values.mirror_direction(-view[0], -view[1], -view[2], *normal)
    return toward[0] - x, toward[1] - y, toward[2] - z, 1.0 / math.sqrt(material.exponent + 1.0)


@jitable
def far_apart(one: Vector, other: Vector, width: float) -> bool:
    """Whether places so far off the middle of a highlight of this width are too far apart for nodes to tell it."""
    apart = minus(one, other)
    spread = math.sqrt(dot(apart, apart))
    return spread > _WIDE * (math.sqrt(min(dot(one, one), dot(other, other))) + 2.0 * width)


@jitable
def plane_spreads(piece: Piece, eye: Vector, there: Vector, size: float, share: float, cell: Cell) -> bool:
    """Whether rays of a cell meet a plane at places that spread over more than a share of their way to a place.

    Of what has a ``size`` there, over more than that share of it if it is larger. h v + (u.v)(L - E) is the way times
    u.v: linear, so that it is bounded to the horizon and beyond.
    """
    up, at = vector(piece.up), minus(there, eye)
    height = height_over(piece, eye)
    far, wide = 0.0, 0.0
    for c in range(3):
        middle = height * cell.v[c] + dot(up, cell.v) * at[c]
        half = abs(height * cell.vx[c] + dot(up, cell.vx) * at[c]) + abs(height * cell.vy[c] + dot(up, cell.vy) * at[c])
        far += middle * middle
        wide += half * half
    own = dot(up, cell.v) * size
    return wide > share * share * max(far, own * own)


@jitable
def place_spreads(
    world: World, own: int, light: int, ray: Vector, place: Vector, normal: Vector,
    other_ray: Vector, other: Vector, other_normal: Vector,
) -> bool:  # fmt: skip
    """Whether a light looks too different from two places of shape ``own`` for nodes between them to tell."""
    lamp, piece = world.lights[light], world.pieces[own]
    material = world.materials[int(piece.material)]
    step = minus(other, place)
    moved = math.sqrt(dot(step, step))
    if lamp.kind == SKY:
        return False
    if lamp.kind == AREA:
        # emitters are shapes: all of their pieces are spheres here
        for k in range(world.pieces.shape[0]):
            ball = world.pieces[k]
            way = minus(vector(ball.place), place)
            near = abs(math.sqrt(dot(way, way)) - ball.radius)
            if ball.owner == lamp.emitter and k != own and moved > NEAR * near:
                return True
        return False
    at = vector(lamp.place)
    if lamp.kind == DIRECTIONAL:
        toward = (-at[0], -at[1], -at[2])
        other_toward = toward
    else:
        way, other_way = minus(at, place), minus(at, other)
        far, other_far = math.sqrt(dot(way, way)), math.sqrt(dot(other_way, other_way))
        if piece.kind == SPHERE and moved > NEAR * max(far, other_far):
            return True
        if far == 0.0 or other_far == 0.0:
            return True
        toward = (way[0] / far, way[1] / far, way[2] / far)
        other_toward = (other_way[0] / other_far, other_way[1] / other_far, other_way[2] / other_far)
    if material.kind == DIFFUSE or dot(normal, toward) <= 0.0 >= dot(other_normal, other_toward):
        return False
    x, y, z, width = off_axis(material, normal, (-ray[0], -ray[1], -ray[2]), toward)
    a, b, c, _ = off_axis(material, other_normal, (-other_ray[0], -other_ray[1], -other_ray[2]), other_toward)
    return far_apart((x, y, z), (a, b, c), width)


@jitable
def veins_turn(world: World, own: int, place: Vector, other: Vector) -> bool:
    """Whether the veins of a sphere turn too far between two places of shape ``own`` for nodes to tell them.

    Those of planes are looked at where lines of textures are listed.
    """
    ball = world.pieces[own]
    material = world.materials[int(ball.material)]
    if ball.kind != SPHERE or material.texture != MARBLE:
        return False
    center, r = vector(ball.place), float(ball.radius)
    first, second = minus(place, center), minus(other, center)
    x, y = leaves.sphere_turns(first[0] / r, first[1] / r, first[2] / r)
    a, b = leaves.sphere_turns(second[0] / r, second[1] / r, second[2] / r)
    round_ = abs(x - a)
    return min(round_, 2.0 - round_) + _BENT * abs(y - b) > _VEINS * material.cell


@jitable
def met_by(eye: Eye, origin: Vector, d: Vector, room: Room) -> tuple[int, Vector, Vector]:
    """(piece or -1, place, unit normal by which it reflects) that a ray of an eye meets."""
    if eye.lobe is not None:
        own, _, place, normal, front = nearest(eye.lobe.sight, origin, d)
    else:
        own, _, place, normal, front = nearest(eye.world, origin, d)
    if own >= 0:
        normal = shading_normal(eye.world, own, front, place, normal, room.sky)
    return own, place, normal


@jitable
def too_sharp(eye: Eye, cell: Cell, room: Room, limit: float) -> bool:
    """Whether nodes of a cell may miss what is sharp in it."""
    if not eye.delicate:
        return False
    world = eye.world
    for j in range(world.pieces.shape[0]):
        if world.pieces[j].kind == SPHERE or not may_show(room, float(j), limit):
            continue
        for i in range(world.lights.shape[0]):
            lamp = world.lights[i]
            point = lamp.kind in (POINT, SPOT)
            if point and plane_spreads(world.pieces[j], eye.place, vector(lamp.place), 0.0, NEAR, cell):
                return True
    if shows_spot(eye, cell, room, limit):
        return True
    origin, ray = ray_of(eye, cell.v)
    own, place, normal = met_by(eye, origin, ray, room)
    for corner in range(4):
        a, b = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
        origin, d = ray_of(eye, step(cell.v, a, cell.vx, b, cell.vy))
        other, at, facing = met_by(eye, origin, d, room)
        if own >= 0 and other == own:
            if veins_turn(world, own, place, at):
                return True
            for i in range(world.lights.shape[0]):
                if place_spreads(world, own, i, ray, place, normal, d, at, facing):
                    return True
        ray, own, place, normal = d, other, at, facing
    return False
