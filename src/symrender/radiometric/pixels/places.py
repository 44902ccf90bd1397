"""The kernels of places that reflect: where rays meet them, and what they send on of the light of one bounce."""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.radiometric.arcs import Room as Arcs
from symrender.radiometric.bumps import shading_normal
from symrender.radiometric.pixels.cells import BOX, Eye, Lobe
from symrender.radiometric.pixels.records import Family, Ints, Queue, Room, Wall
from symrender.radiometric.pixels.walls import put_families, put_line, put_walls
from symrender.radiometric.pixels.worst import worst_sum
from symrender.radiometric.reflection import reflectance
from symrender.radiometric.sight import height_over, nearest, passes
from symrender.radiometric.vectors import Array, Vector, cross, dot, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import SPHERE

_ULP = 2.0**-52


@jitable
def some_side(v: Vector) -> Vector:
    """Some vector across a direction, of no length in particular."""
    return cross(v, (1.0, 0.0, 0.0) if abs(v[0]) < 0.6 else (0.0, 1.0, 0.0))


@jitable
def in_a_plane(world: World, own: int, place: Vector) -> bool:
    """Whether a place lies, as far as rounding tells, on a flat piece of another shape."""
    size = max(abs(place[0]), max(abs(place[1]), abs(place[2])))
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind == SPHERE or piece.owner == world.pieces[own].owner:
            continue
        far = max(abs(piece.place[0]), max(abs(piece.place[1]), abs(piece.place[2])))
        height = height_over(piece, place)
        if abs(height) <= 4.0 * _ULP * (size + far) and passes(piece, height, 1.0, place, vector(piece.up)):
            return True
    return False


def fill_places(
    world: World, origins: Array, directions: Array, sky: Arcs, pieces: Array, place: Array, facing: Array,
    turned: Array, albedo: Array, shows: Array,
) -> None:  # fmt: skip
    """Which of ``pieces`` every ray meets first, -1 for none, where, its unit normals and how it reflects.

    ``shows`` is 1 where the place sends light back, 0 where what is seen is black, -1 where nothing is known: of the
    inside of a sphere, and of a place in the plane of another shape.
    """
    for k in range(origins.shape[0]):
        origin, d = (
            (origins[k, 0], origins[k, 1], origins[k, 2]),
            (directions[k, 0], directions[k, 1], directions[k, 2]),
        )
        own, _, at, normal, front = nearest(world, origin, d)
        pieces[k], shows[k] = own, 0.0
        if own < 0:
            continue
        by, reflects = shading_normal(world, own, front, at, normal, sky), reflectance(world, own, at)
        for c in range(3):
            place[k, c], facing[k, c], turned[k, c], albedo[k, c] = at[c], normal[c], by[c], reflects[c]
        piece = world.pieces[own]
        material = world.materials[int(piece.material)]
        if (front or material.two_sided != 0.0) and not dot(by, d) >= 0.0:
            known = dot(by, by) > 0.0 and (front or piece.kind != SPHERE) and not in_a_plane(world, own, at)
            shows[k] = 1.0 if known else -1.0


def fill_sent(
    world: World, mean: World, sight: World, own: int, place: Array, facing: Array, turned: Array, back: Array,
    albedo: Array, tol: float, budget: int, walls: Table[Wall], families: Table[Family], queue: Queue, room: Room,
    light: Array, error: Array, evaluations: Ints,
) -> None:  # fmt: skip
    """What places of piece ``own`` reflect of what shapes send them, each to ``tol`` or ``budget`` evaluations.

    ``back`` (N, 3) are unit directions to where it goes. Arguments are many because a kernel takes arrays.
    """
    for k in range(place.shape[0]):
        at, up = (place[k, 0], place[k, 1], place[k, 2]), (facing[k, 0], facing[k, 1], facing[k, 2])
        by, view = (turned[k, 0], turned[k, 1], turned[k, 2]), (back[k, 0], back[k, 1], back[k, 2])
        count = put_walls(world, at, walls, own)
        if dot(up, by) < 1.0 - _ULP:
            count = put_line(walls, count, by, -1, -1)
        put_families(world, at, families)
        if count > walls.shape[0]:
            error[k] = math.inf
            continue
        first = some_side(up)
        size = math.sqrt(dot(first, first))
        first = (first[0] / size, first[1] / size, first[2] / size)
        second = cross(up, first)
        lobe = Lobe(own, sight, up, by, view, (albedo[k, 0], albedo[k, 1], albedo[k, 2]), 0.0)
        eye = Eye(world, mean, at, walls, families, 0.0, True, BOX, None, None, lobe, False)
        evaluations[k] = int(worst_sum(eye, lobe, first, second, count, queue, room, tol, budget))
        error[k] = room.best[6]
        for c in range(3):
            light[k, c] = room.best[3 + c]
