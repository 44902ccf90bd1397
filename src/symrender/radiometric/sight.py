"""What a ray meets first, and whether a shape hides a light."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.bounds import held_by, inside_of, next_met
from symrender.radiometric.pieces import Piece, corner
from symrender.radiometric.vectors import Vector, dot, minus, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK, SPHERE

_FARTHEST: Final = 1e150
"""Beyond it, where squares overflow, nothing is met."""


@jitable
def height_over(piece: Piece, place: Vector) -> float:
    """Signed distance of a place from the plane of a flat piece."""
    return leaves.height(*place, *vector(piece.place), *vector(piece.up))


@jitable
def passes(piece: Piece, height: float, slope: float, origin: Vector, d: Vector) -> bool:
    """Whether the line through ``origin`` meets a flat piece's plane in the piece, from ``height`` over it.

    ``slope`` is how fast the line rises. A line through an edge meets both shapes beside it.
    """
    if piece.kind == PLANE:
        return True
    if piece.kind == DISK:
        reach = -height / slope
        place = (origin[0] + reach * d[0], origin[1] + reach * d[1], origin[2] + reach * d[2])
        return leaves.disk_level(*minus(place, vector(piece.place)), piece.radius) >= 0.0
    # seen from above the corners go counter-clockwise, and the line goes down
    way = 1.0 if slope < 0.0 else -1.0
    count = int(piece.count)
    last = minus(corner(piece, count - 1), origin)
    for k in range(count):
        here = minus(corner(piece, k), origin)
        if way * leaves.edge_side(*last, *here, *d) > 0.0:
            return False
        last = here
    return True


@inlined
def is_nearer(reach: float, j: int, distance: float, best: int) -> bool:
    """Whether piece j is met before the best one, the first of both in order where both are as far."""
    return reach < distance or (reach == distance and j < best)


@jitable
def nearest(world: World, origin: Vector, d: Vector) -> tuple[int, float, Vector, Vector, bool]:
    """(piece or -1, distance, place, unit normal towards the ray, whether the piece's own normal shows to the ray)."""
    best, distance = -1, math.inf
    place, facing, front = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), True
    k = next_met(world.bounds, 0, origin, d, math.inf)
    while k < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, k)):
            j = held_by(world.bounds, k, m)
            piece = world.pieces[j]
            if piece.kind == SPHERE:
                offset = minus(vector(piece.place), origin)
                outside = leaves.sphere_power(*offset, piece.radius) > 0.0
                if leaves.sphere_level(*offset, *d, piece.radius) < 0.0 or (outside and dot(offset, d) <= 0.0):
                    continue
                side = 1.0 if outside else -1.0
                reach, x, y, z = leaves.sphere_entry(*offset, *d, piece.radius, side)
                if is_nearer(reach, j, distance, best):
                    best, distance, facing, front = j, reach, (x, y, z), outside
                    out = side * piece.radius
                    place = (piece.place[0] + out * x, piece.place[1] + out * y, piece.place[2] + out * z)
            else:
                up = vector(piece.up)
                slope = dot(up, d)
                if slope == 0.0:
                    continue
                height = height_over(piece, origin)
                reach = leaves.plane_reach(height, *up, *d)
                if (
                    0.0 < reach < _FARTHEST
                    and is_nearer(reach, j, distance, best)
                    and passes(piece, height, slope, origin, d)
                ):
                    best, distance, front = j, reach, slope < 0.0
                    facing = up if front else (-up[0], -up[1], -up[2])
                    place = (origin[0] + reach * d[0], origin[1] + reach * d[1], origin[2] + reach * d[2])
        k = next_met(world.bounds, k + 1, origin, d, distance)
    return best, distance, place, facing, front


@jitable
def turned_away(world: World, own: int, front: bool, j: int) -> bool:
    """Whether piece j is a face of the box that ``own`` is a face of, which hides nothing from outside."""
    return front and world.pieces[j].solid != 0.0 and world.pieces[j].owner == world.pieces[own].owner


@jitable
def hidden_point(world: World, own: int, front: bool, place: Vector, i: int) -> bool:
    """Whether a piece lies between a place of piece ``own`` and light ``i`` on the lit side of its normal."""
    light = vector(world.lights[i].place)
    segment = minus(light, place)
    k = next_met(world.bounds, 0, place, segment, 1.0)
    while k < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, k)):
            j = held_by(world.bounds, k, m)
            piece = world.pieces[j]
            if piece.kind == SPHERE:
                ahead = leaves.sphere_power(*minus(vector(piece.place), light), piece.radius)
                if j == own:
                    # from inside a sphere all of its inside is seen, and nothing else
                    if not front and ahead > 0.0:
                        return True
                    continue
                offset = minus(vector(piece.place), place)
                here = leaves.sphere_power(*offset, piece.radius)
                along, whole, level = leaves.segment_pass(*offset, *segment, piece.radius)
                between = here >= 0.0 and ahead >= 0.0 and 0.0 < along < whole and level >= 0.0
                if between or here * ahead < 0.0:
                    return True
            elif j != own and world.level[i, j] == 0.0 and not turned_away(world, own, front, j):
                here, ahead = height_over(piece, place), height_over(piece, light)
                if here * ahead < 0.0 and passes(piece, here, ahead - here, place, segment):
                    return True
        k = next_met(world.bounds, k + 1, place, segment, 1.0)
    return False


@jitable
def hidden_direction(world: World, own: int, front: bool, place: Vector, i: int) -> bool:
    """Whether a piece is met from a place of piece ``own`` towards directional light ``i`` on the lit side of its
    normal."""
    toward = minus_of(vector(world.lights[i].place))
    k = next_met(world.bounds, 0, place, toward, math.inf)
    while k < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, k)):
            j = held_by(world.bounds, k, m)
            piece = world.pieces[j]
            if piece.kind == SPHERE:
                if j == own:
                    if not front:
                        return True
                    continue
                offset = minus(vector(piece.place), place)
                if leaves.sphere_power(*offset, piece.radius) < 0.0:
                    return True
                if dot(offset, toward) > 0.0 and leaves.sphere_level(*offset, *toward, piece.radius) >= 0.0:
                    return True
            elif j != own and world.level[i, j] == 0.0 and not turned_away(world, own, front, j):
                here, slope = height_over(piece, place), dot(vector(piece.up), toward)
                if here * slope < 0.0 and passes(piece, here, slope, place, toward):
                    return True
        k = next_met(world.bounds, k + 1, place, toward, math.inf)
    return False
