"""Where light that bounces comes from nearby: under lights close to a surface, from beams of spots, and from balls.

Bounced light is smooth, but on the scale of the way to where it comes from. A lamp close to a wall, the disc a narrow
spot lights, that spot's image in a metal and a small ball are seen from the floor beside them by a part of a pixel,
and nodes of the whole pixel agree that there is nothing. Cells near such a hot place are halved until they are not.
"""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.radiometric.pixels.cells import Cell, Eye, ray_of, step
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.pixels.sharp import NEAR, plane_spreads
from symrender.radiometric.pixels.sight import may_show
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array, Vector, dot, minus
from symrender.scene.radiometric.arrays import SPHERE


@jitable
def hot_between(places: Array, own: float, one: Vector, other: Vector, share: float) -> bool:
    """Whether two places of shape ``own`` are too far apart beside their way to some hot place of another."""
    apart = minus(other, one)
    moved = dot(apart, apart)
    for k in range(places.shape[0]):
        if places[k, 4] == own:
            continue
        way = minus((places[k, 0], places[k, 1], places[k, 2]), one)
        if moved > share * share * max(dot(way, way), places[k, 3] * places[k, 3]):
            return True
    return False


@jitable
def near_hot(eye: Eye, cell: Cell, room: Room, limit: float, steps: float) -> bool:
    """Whether a cell spreads too far beside its way to a hot place for nodes between its corners to tell.

    ``steps`` is how many times denser the nodes are than those of a cell that takes four.
    """
    if eye.hot is None:
        return False
    places, world, share = eye.hot, eye.world, NEAR * steps
    if places.shape[0] == 0:
        return False
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind == SPHERE or not may_show(room, float(j), limit):
            continue
        for k in range(places.shape[0]):
            hot = (places[k, 0], places[k, 1], places[k, 2])
            if places[k, 4] != piece.owner and plane_spreads(piece, eye.place, hot, places[k, 3], share, cell):
                return True
    origin, ray = ray_of(eye, cell.v)
    own, _, place, _, _ = nearest(world, origin, ray)
    for corner in range(4):
        a, b = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
        origin, d = ray_of(eye, step(cell.v, a, cell.vx, b, cell.vy))
        other, _, at, _, _ = nearest(world, origin, d)
        on_ball = own >= 0 and other == own and world.pieces[own].kind == SPHERE
        # of the diagonal half: what is told of sides elsewhere
        if on_ball and hot_between(places, world.pieces[own].owner, place, at, share * math.sqrt(0.5)):
            return True
        own, place = other, at
    return False
