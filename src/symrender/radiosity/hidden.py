"""What hides a face from a place: every other face, or plane, as an intersection of half spaces.

A disk hides what a polygon in its rim does; ``rims.py`` bounds what lies between both.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.cones import edge_on
from symrender.radiometric.listing import faces_away
from symrender.radiometric.pieces import POLYGON, Piece, corner, put
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.records import Cell, Receiver, Scratch
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK

FLAT: Final = 1e-13
"""Height over a face, in parts of the coordinates, up to which another lies in its plane and hides none of it."""


_STRIDE: Final = 49
"""How far apart edges of a rim are written; it divides no power of 2."""


@inlined
def rise_of(disk: Piece, way: Vector) -> float:
    """How far a disk reaches from its centre along a unit way."""
    x = cross(vector(disk.up), way)
    found: float = disk.radius * math.sqrt(dot(x, x))
    return found


@jitable
def disk_may_hide(
    disk: Piece, face: Piece, side: float, place: Vector, normal: Vector, height: float
) -> bool:  # fmt: skip
    """``may_hide`` of a disk."""
    c = vector(disk.place)
    size = max(max(abs(place[0]), abs(place[1]), abs(place[2])), max(abs(c[0]), abs(c[1]), abs(c[2])) + disk.radius)
    above = dot(normal, minus(c, place)) + rise_of(disk, normal) > FLAT * size
    over, rise = side * height_over(face, c), rise_of(disk, vector(face.up))
    return above and over + rise > FLAT * size and over - rise < height


@jitable
def may_hide(piece: Piece, face: Piece, side: float, place: Vector, normal: Vector, height: float) -> bool:
    """Whether some of a piece lies above the horizon of a place, and between it and the plane of a face."""
    if piece.kind == PLANE:
        return True
    if piece.kind == DISK:
        return disk_may_hide(piece, face, side, place, normal, height)
    above, between, behind = False, False, True
    size = max(abs(place[0]), abs(place[1]), abs(place[2]))
    for k in range(int(piece.count)):
        c = corner(piece, k)
        size = max(size, abs(c[0]), abs(c[1]), abs(c[2]))
    for k in range(int(piece.count)):
        c = corner(piece, k)
        over = side * height_over(face, c)
        above = above or dot(normal, minus(c, place)) > FLAT * size
        between = between or over > FLAT * size
        behind = behind and over >= height
    return above and between and not behind


@jitable
def level_with(face: Piece, place: Vector, normal: Vector, height: float) -> bool:
    """Whether a face, ``height`` below a place, lies in the plane of the place across ``normal``, so that none is seen.

    Neighbours in a mesh may, and rounding then says on which side of each other they are.
    """
    if face.kind == PLANE:
        x = cross(vector(face.up), normal)
        return height <= FLAT * max(abs(place[0]), abs(place[1]), abs(place[2])) and dot(x, x) <= FLAT
    size = max(abs(place[0]), abs(place[1]), abs(place[2]))
    if face.kind == DISK:
        c = vector(face.place)
        size = max(size, max(abs(c[0]), abs(c[1]), abs(c[2])) + face.radius)
        return height <= FLAT * size and abs(dot(normal, minus(c, place))) + rise_of(face, normal) <= FLAT * size
    for k in range(int(face.count)):
        c = corner(face, k)
        size = max(size, abs(c[0]), abs(c[1]), abs(c[2]))
    for k in range(int(face.count)):
        if abs(dot(normal, minus(corner(face, k), place))) > FLAT * size:
            return False
    return height <= FLAT * size


@inlined
def put_edge_space(scratch: Scratch, b: int, k: int, here: Vector, other: Vector, sign: float) -> None:
    """Write half space k of an occluder: that of an edge."""
    x, y, z = leaves.edge_plane(*here, *other)
    space = scratch.spaces[scratch.stride * b + k]
    put(space.normal, (sign * x, sign * y, sign * z))
    space.level = 0.0


@jitable
def put_rim_spaces(scratch: Scratch, b: int, disk: Piece, place: Vector, sign: float) -> int:
    """Write the half spaces of the edges of the polygon in a disk's rim; returns how many."""
    middle, east, north = minus(vector(disk.place), place), vector(disk.east), vector(disk.north)
    count, r, c, s = int(disk.face), disk.radius, 1.0, 0.0
    cosine, sine = math.cos(2.0 * math.pi / count), math.sin(2.0 * math.pi / count)
    here = (middle[0] + r * east[0], middle[1] + r * east[1], middle[2] + r * east[2])
    for k in range(count):
        c, s = c * cosine - s * sine, s * cosine + c * sine
        other = (
            middle[0] + r * (c * east[0] + s * north[0]),
            middle[1] + r * (c * east[1] + s * north[1]),
            middle[2] + r * (c * east[2] + s * north[2]),
        )
        # neighbours are written far apart, so that one of the first few tells of most cells that they are not hidden
        put_edge_space(scratch, b, (_STRIDE * k) % count, here, other, sign)
        here = other
    return count


@jitable
def put_spaces(scratch: Scratch, b: int, piece: Piece, place: Vector) -> int:
    """Write the half spaces of what a piece hides from a place; returns how many."""
    height = height_over(piece, place)
    sign = -1.0 if height > 0.0 else 1.0
    found = corners = int(piece.count)
    for k in range(corners):
        here = minus(corner(piece, k), place)
        other = minus(corner(piece, k + 1 if k + 1 < corners else 0), place)
        put_edge_space(scratch, b, k, here, other, sign)
    if piece.kind == DISK:
        found = put_rim_spaces(scratch, b, piece, place, sign)
    space = scratch.spaces[scratch.stride * b + found]
    up = vector(piece.up)
    put(space.normal, (sign * up[0], sign * up[1], sign * up[2]))
    space.level = -abs(height)
    return found + 1


@jitable
def overlaps(scratch: Scratch, b: int, cell: Cell, place: Vector) -> tuple[bool, bool]:
    """Whether occluder b may hide some of a cell, and whether it hides all."""
    whole = True
    for k in range(scratch.counts[b]):
        space = scratch.spaces[scratch.stride * b + k]
        n = vector(space.normal)
        low = high = 0.0
        for i in range(cell.count):
            w = (cell.corners[3 * i] - place[0], cell.corners[3 * i + 1] - place[1], cell.corners[3 * i + 2] - place[2])
            over = dot(n, w) + space.level
            low, high = (over, over) if i == 0 else (min(low, over), max(high, over))
        if high <= FLAT * cell.reach:
            return False, False
        if low < 0.0:
            whole = False
    return True, whole


@jitable
def gather_occluders(world: World, at: Receiver, cell: Cell, height: float, scratch: Scratch) -> int:
    """List what may hide some of a face, whose root is ``cell``, from a place; returns how many.

    Faces of a box that show their back are left out: what they hide its other faces hide.
    """
    found = 0
    face, place = world.pieces[cell.face], at.place
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if j == at.own or j == cell.face or (piece.kind != POLYGON and piece.kind != PLANE and piece.kind != DISK):
            continue
        if cell.side > 0.0 and face.solid != 0.0 and piece.owner == face.owner:
            # a box is convex; a mesh may hide its own faces
            continue
        if edge_on(piece, place) or faces_away(world, at.own, at.front, place, j):
            continue
        if not may_hide(piece, face, cell.side, place, at.normal, height):
            continue
        scratch.counts[found] = put_spaces(scratch, found, piece, place)
        some, _ = overlaps(scratch, found, cell, place)
        if some:
            found += 1
    return found
