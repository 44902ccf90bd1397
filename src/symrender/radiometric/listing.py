"""Which pieces may hide what a place sees, and which side of each shows to it."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.radiometric.arcs import Room
from symrender.radiometric.bounds import note_listed, outside_before
from symrender.radiometric.cones import edge_on
from symrender.radiometric.pieces import FACES, Piece, corner, same
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK

_CLEAR: Final = 1e-9
"""Sine below the horizon beyond which a direction is below it, whatever was rounded."""
_GRAZING: Final = 1e-12
"""Height over a face, in parts of the way to it, beyond which it is not seen edge on."""


@jitable
def faces_away(world: World, own: int, front: bool, place: Vector, j: int) -> bool:
    """Whether other faces of the box that face j belongs to hide all that it hides."""
    if turned_away(world, own, front, j):
        return True
    piece = world.pieces[j]
    if piece.solid == 0.0 or height_over(piece, place) >= 0.0:
        return False
    first = j - int(piece.face)
    before = False
    for k in range(first, first + FACES):
        before = before or (k != own and height_over(world.pieces[k], place) > 0.0)
    return before


@jitable
def sunk(world: World, own: int, place: Vector, normal: Vector, piece: Piece) -> bool:
    """Whether a polygon is below the horizon but for vertices that it shares with the polygon ``own``."""
    left = world.pieces[own]
    for k in range(int(piece.count)):
        there, shared = corner(piece, k), False
        for m in range(int(left.count)):
            shared = shared or same(there, corner(left, m))
        at = minus(there, place)
        if not (shared or dot(normal, at) < -_CLEAR * (abs(at[0]) + abs(at[1]) + abs(at[2]))):
            return False
    return piece.count > 0.0


@jitable
def shows(
    world: World, own: int, front: bool, place: Vector, normal: Vector, j: int, far: float, direction: Vector
) -> int:  # fmt: skip
    """Which side of flat piece j shows to a place, 1 that of its normal and -1 the other; 0 where it hides nothing.

    What lies in, or on, the plane ``far`` along ``direction`` is what may be hidden.
    """
    piece = world.pieces[j]
    if piece.kind != PLANE and (
        (height_over(piece, place) < 0.0 and outside_before(piece, place, far, direction))
        or sunk(world, own, place, normal, piece)
        or edge_on(piece, place)
        or faces_away(world, own, front, place, j)
    ):
        return 0
    return 1 if height_over(piece, place) > 0.0 else -1


@jitable
def sides(piece: Piece, place: Vector, direction: Vector, far: float) -> tuple[bool, bool]:
    """Whether some of a polygon or a disk lies before the plane ``far`` along a direction, and some beyond it."""
    if piece.kind == DISK:
        middle = dot(minus(vector(piece.place), place), direction)
        across = cross(vector(piece.up), direction)
        reach = piece.radius * math.sqrt(dot(across, across))
        return middle - reach < far, middle + reach >= far
    before, beyond = False, False
    for k in range(int(piece.count)):
        if dot(minus(corner(piece, k), place), direction) < far:
            before = True
        else:
            beyond = True
    return before, beyond


@jitable
def shows_before(
    world: World, own: int, front: bool, place: Vector, normal: Vector, j: int, far: float, direction: Vector
) -> int:  # fmt: skip
    """``shows`` of what flat piece j hides of what lies in, or on, the plane ``far`` along a unit ``direction``."""
    piece = world.pieces[j]
    if piece.kind != PLANE:
        before, _ = sides(piece, place, direction, far)
        if not before:
            return 0
    return shows(world, own, front, place, normal, j, far, direction)


@jitable
def shows_in(
    world: World, own: int, front: bool, place: Vector, normal: Vector, j: int, clear: float, far: float,
    direction: Vector,
) -> int:  # fmt: skip
    """``shows_before`` of flat piece j; little is to be asked of it if ``clear_within`` of its leaf is not 0."""
    if clear > 0.0:
        height = height_over(world.pieces[j], place)
        if height < 0.0:
            return 0
        if height > _GRAZING * clear:
            return 1
    return shows_before(world, own, front, place, normal, j, far, direction)


@jitable
def begin_listing(room: Room, count: int) -> None:
    """Forget what was listed; the first ``count`` arcs are those of the light."""
    for c in range(room.side.shape[0]):
        room.side[c], room.begin[c], room.stop[c] = 0.0, 0.0, 0.0
    for k in range(room.nodes.shape[0]):
        room.nodes[k] = 0.0
    room.stop[0] = 1.0 * count


@inlined
def mark(room: Room, listed: int, j: int, side: int) -> int:
    """List piece j, unless its ``side`` is 0; returns how many are listed."""
    if side == 0:
        return listed
    room.side[1 + j], room.listed[listed] = 1.0 * side, 1.0 * j
    return listed + 1


@inlined
def end_leaf(room: Room, node: int, listed: int) -> None:
    """Note that so many pieces of a leaf are listed."""
    if listed > 0:
        room.nodes[node] = 1.0


@jitable
def end_listing(world: World, room: Room, count: int) -> None:
    """Note how many arcs there are, and which bounds hold leaves with listed pieces."""
    room.used[0] = 1.0 * count
    last = world.bounds.shape[0] - 1
    for back in range(last + 1):
        note_listed(world.bounds, last - back, room.nodes)


@jitable
def list_beside(
    world: World, own: int, front: bool, place: Vector, normal: Vector, room: Room, listed: int, far: float,
    direction: Vector,
) -> int:  # fmt: skip
    """Note of faces beside the ``listed`` pieces which side they show, where some are in nodes that were passed by.

    Returns how many pieces are listed, which are no more than before.
    """
    for k in range(listed if room.nodes[world.bounds.shape[0]] != 0.0 else 0):
        piece = world.pieces[int(room.listed[k])]
        if not outside_before(piece, place, far, direction):
            continue
        out = minus(vector(piece.middle), place)
        reach = abs(out[0]) + abs(out[1]) + abs(out[2]) + piece.reach
        for edge in range(int(piece.count)):
            j = int(piece.beside[edge])
            if room.side[1 + j] == 0.0:
                # of one below the horizon all edges are, so that what it shows changes nothing
                room.side[1 + j] = 1.0 * shows_in(world, own, front, place, normal, j, reach, far, direction)
    return listed
