"""The cones of directions that pieces fill, as arcs: polygons and disks, and halves of space cut off by planes."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room, put_circle, put_edge, put_rim
from symrender.radiometric.pieces import Piece, corner
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Vector, minus, minus_of, vector
from symrender.scene.radiometric.arrays import DISK

_EDGE_ON: Final = 1e-15
"""Height over a polygon's plane, in parts of the distance, below which it is seen edge on and hides nothing."""


@jitable
def toward_plane(piece: Piece, place: Vector) -> tuple[float, Vector]:
    """(distance, unit direction) from a place to the plane of a flat piece."""
    height = height_over(piece, place)
    up = vector(piece.up)
    return abs(height), (minus_of(up) if height >= 0.0 else up)


@jitable
def edge_on(piece: Piece, place: Vector) -> bool:
    """Whether a polygon or a disk is seen from its own plane."""
    far = piece.radius
    if piece.kind == DISK:
        v = minus(vector(piece.place), place)
        far = max(far, abs(v[0]), max(abs(v[1]), abs(v[2])))
    for k in range(int(piece.count)):
        v = minus(corner(piece, k), place)
        far = max(far, abs(v[0]), max(abs(v[1]), abs(v[2])))
    return abs(height_over(piece, place)) <= _EDGE_ON * far


@jitable
def put_polygon(room: Room, count: int, cone: int, piece: Piece, place: Vector) -> int:
    """Add the edges of a polygon, or the rim of a disk, to a cone; returns how many arcs there are."""
    if piece.kind == DISK:
        _, way = toward_plane(piece, place)
        return put_rim(room, count, cone, minus(vector(piece.place), place), way, vector(piece.east), piece.radius)
    above = height_over(piece, place) > 0.0
    corners = int(piece.count)
    for k in range(corners):
        here, other = corner(piece, k), corner(piece, (k + 1) % corners)
        # from above, corners that go counter-clockwise about the normal go clockwise
        if above:
            here, other = other, here
        beside = int(piece.beside[k]) if cone > 0 else -1
        inner = beside >= 0 and is_inner(room, cone, beside)
        count = put_edge(room, count, cone, minus(here, place), minus(other, here), inner)
        if cone > 0:
            room.arcs[count - 1].edge = 1.0 * k
            if beside >= 0 and not inner and room.side[1 + beside] != 0.0:
                room.arcs[count - 1].beside = 1.0 + beside
    return count


@jitable
def put_convex(room: Room, count: int, cone: int, piece: Piece, place: Vector) -> int:
    """Add the edges of a face of a convex body that bound something; returns how many arcs there are.

    No other face of the body hides them, so that the rest of the cone may wait until another arc comes near it.
    """
    above = height_over(piece, place) > 0.0
    corners = int(piece.count)
    for k in range(corners):
        beside = int(piece.beside[k])
        if beside >= 0 and is_inner(room, cone, beside):
            continue
        here, other = corner(piece, k), corner(piece, (k + 1) % corners)
        if above:
            here, other = other, here
        count = put_edge(room, count, cone, minus(here, place), minus(other, here), False)
        room.arcs[count - 1].edge = 1.0 * k
        if beside >= 0 and room.side[1 + beside] != 0.0:
            room.arcs[count - 1].beside = 1.0 + beside
    return count


@jitable
def is_inner(room: Room, cone: int, beside: int) -> bool:
    """Whether the edge between a listed polygon and one that may be listed bounds nothing.

    It does not between two that show the same side. Of two that are folded over each other the one that shows its front
    has the edge.
    """
    own, other = room.side[cone], room.side[1 + beside]
    return bool(other != 0.0 and (own == other or own < 0.0))


@jitable
def put_nearer(
    room: Room, count: int, cone: int, near: float, way: Vector, far: float, direction: Vector
) -> int:  # fmt: skip
    """Add to a cone the hemisphere that meets the plane ``near`` along ``way`` before that ``far`` along another."""
    x, y, z = leaves.nearer(near, *way, far, *direction)
    size = math.sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return count
    return put_circle(room, count, cone, (x / size, y / size, z / size), 0.0, 1.0)


@jitable
def bounds_nothing(room: Room, j: int, piece: Piece) -> bool:
    """Whether all edges of listed polygon j are inner ones."""
    for k in range(int(piece.count)):
        beside = int(piece.beside[k])
        if beside < 0:
            return False
        if not is_inner(room, 1 + j, beside):
            return False
    return piece.count > 0.0
