"""What is smooth and may still be missed by nodes: veins narrower than a cell, lamps nearer than it is wide."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Cell, Eye, ray_of, step
from symrender.radiometric.sight import height_over, nearest
from symrender.radiometric.vectors import Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import MARBLE
from symrender.scene.radiometric.arrays import AREA, CONDUCTOR, SPHERE
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
def lamp_spreads(world: World, own: int, place: Vector, other: Vector) -> bool:
    """Whether a lamp looks too different from two places of shape ``own`` for nodes between them to tell."""
    apart = minus(other, place)
    moved = math.sqrt(dot(apart, apart))
    for i in range(world.lights.shape[0]):
        lamp = world.lights[i]
        if lamp.kind != AREA:
            continue
        # emitters are shapes: all of their pieces are spheres here
        for k in range(world.pieces.shape[0]):
            ball = world.pieces[k]
            way = minus(vector(ball.place), place)
            near = abs(math.sqrt(dot(way, way)) - ball.radius)
            if ball.owner == lamp.emitter and k != own and moved > NEAR * near:
                return True
    return False


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
def is_even(world: World) -> bool:
    """Whether a world has neither lamps with an extent nor veins about a sphere."""
    for i in range(world.lights.shape[0]):
        if world.lights[i].kind == AREA:
            return False
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind == SPHERE and world.materials[int(piece.material)].texture == MARBLE:
            return False
    return True


@jitable
def too_sharp(eye: Eye, cell: Cell) -> bool:
    """Whether nodes of a cell may miss what veins about a sphere and lamps with an extent show in it."""
    world = eye.lobe.sight if eye.lobe is not None else eye.world
    if is_even(world):
        return False
    origin, ray = ray_of(eye, cell.v)
    own, _, place, _, _ = nearest(world, origin, ray)
    for corner in range(4):
        a, b = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
        origin, d = ray_of(eye, step(cell.v, a, cell.vx, b, cell.vy))
        other, _, at, _, _ = nearest(world, origin, d)
        if own >= 0 and other == own and (veins_turn(world, own, place, at) or lamp_spreads(world, own, place, at)):
            return True
        own, place = other, at
    return False
