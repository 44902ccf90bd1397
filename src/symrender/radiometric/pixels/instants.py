"""A world at an instant, and the instants at which what a single ray meets changes."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Eye, ray_of
from symrender.radiometric.pixels.curves import put_level
from symrender.radiometric.pixels.records import CONIC, LINE, MARKS, Ints, Room, Wall
from symrender.radiometric.pixels.walls import put_families, put_walls, sight_walls
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array, Vector, dot, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import DIRECTIONAL

LOOKS: Final = 17
"""Instants at which walls are looked at, at first."""
MOST_INSTANTS: Final = 512
"""Most instants, and events, of a ray."""
_BISECTIONS: Final = 56
_REFINED: Final = 4
_NEAR: Final = 0.3
"""Part of a level below which the least that a parabola foretells is looked at."""
_NOTHING: Final = 1e-14


class Motion(NamedTuple):
    """Velocities of pieces, lights and eye, in units of the time the shutter is open."""

    pieces: Array
    """(pieces, 3)"""
    lights: Array
    """(lights, 3)"""
    camera: Array
    """(3,)"""


class Watch(NamedTuple):
    """Scratch of a ray's events."""

    levels: Array
    """(LOOKS, walls): levels of walls at the first instants."""
    seen: Ints
    """(LOOKS, walls): 1 where the wall may change what the ray meets then."""
    layouts: Ints
    """(LOOKS,): which walls these are."""
    times: Array
    """(MOST_INSTANTS,): instants in order."""
    panels: Array
    """(MOST_INSTANTS,): ends of panels."""


@jitable
def move_pieces(pieces: Table[Piece], velocity: Array, t: float, moved: Table[Piece]) -> None:
    """Write where pieces are at an instant."""
    for j in range(pieces.shape[0]):
        piece, there = pieces[j], moved[j]
        for c in range(3):
            shift = t * velocity[j, c]
            there.place[c] = piece.place[c] + shift
            for k in range(int(piece.count)):
                there.corners[3 * k + c] = piece.corners[3 * k + c] + shift


@jitable
def put_instant(still: World, motion: Motion, t: float, world: World, mean: World) -> None:
    """Write where all is at an instant; ``mean`` shares its lights with ``world``."""
    move_pieces(still.pieces, motion.pieces, t, world.pieces)
    move_pieces(still.pieces, motion.pieces, t, mean.pieces)
    for i in range(still.lights.shape[0]):
        if still.lights[i].kind != DIRECTIONAL:
            for c in range(3):
                world.lights[i].place[c] = still.lights[i].place[c] + t * motion.lights[i, c]


@jitable
def place_at(place: Vector, motion: Motion, t: float) -> Vector:
    """Where the eye is at an instant."""
    v = motion.camera
    return (place[0] + t * v[0], place[1] + t * v[1], place[2] + t * v[2])


@jitable
def level_of(wall: Wall, v: Vector, room: Room) -> float:
    """The level of a wall at a ray; 0 where roundings may have made all of it."""
    still, out = (0.0, 0.0, 0.0), room.work[7]
    put_level(wall, v, still, still, room.work, out)
    size = dot(v, v)
    if wall.kind == LINE:
        n = vector(wall.normal)
        size = math.sqrt(size * dot(n, n))
    elif wall.kind == CONIC:
        most = 0.0
        for k in range(6):
            most += abs(wall.form[k])
        size *= most
    else:
        size = 0.0
    return float(out[0]) if abs(out[0]) > _NOTHING * size else 0.0


@jitable
def state_of(
    still: World, motion: Motion, eye: Eye, v: Vector, t: float, room: Room, watch: Watch, row: int
) -> int:  # fmt: skip
    """A number that is the same at two instants where the ray lies on the same side of every wall that may matter.

    ``row`` of ``watch`` takes the levels, -1 for none. Walls of sight matter, others where the ray meets their piece.
    -1 where there is no room for the walls.
    """
    put_instant(still, motion, t, eye.world, eye.mean)
    at = place_at(eye.place, motion, t)
    walls = eye.walls
    count = put_walls(eye.world, at, walls, -1)
    sights = sight_walls(eye.world, at, walls, 0, -1)
    put_families(eye.world, at, eye.families)
    if count > walls.shape[0]:
        return -1
    _, d = ray_of(eye, v)
    own, _, _, _, _ = nearest(eye.world, at, d)
    found, layout = own + 2, count
    for k in range(count):
        wall = walls[k]
        matters = k < sights or int(wall.own) == own
        level = level_of(wall, v, room)
        layout = (layout * 31 + int(wall.kind) + 5 * int(wall.own) + 11 * int(wall.other)) % 1000000007
        if row >= 0:
            watch.levels[row, k], watch.seen[row, k] = level, 1 if matters else 0
        if matters:
            side = 1 if level > 0.0 else (2 if level < 0.0 else 3)
            found = (found * 1009 + side * (k + 1)) % MARKS
    for f in range(eye.families.shape[0]):
        family = eye.families[f]
        if int(family.own) == own and family.cuts != 0.0:
            x = dot(vector(family.numerator), v) / dot(vector(family.denominator), v)
            found = (found * 1009 + math.floor(x) % 100003) % MARKS
    if row >= 0:
        watch.layouts[row] = layout
    return found


@jitable
def add_time(watch: Watch, count: int, t: float) -> int:
    """Put an instant in its order; returns how many there are."""
    if count >= MOST_INSTANTS:
        return count
    k = count
    while k > 0 and watch.times[k - 1] > t:
        watch.times[k] = watch.times[k - 1]
        k -= 1
    watch.times[k] = t
    return count + 1


@jitable
def vertex(a: float, b: float, c: float, fa: float, fb: float, fc: float) -> tuple[float, float]:
    """(where the parabola through three levels is least in size, its level there); outside where it bends away."""
    first, second = (fb - fa) / (b - a), (fc - fb) / (c - b)
    bend = (second - first) / (c - a)
    if bend * fb <= 0.0:
        return a - 1.0, fb
    t = 0.5 * (a + b) - 0.5 * first / bend
    return t, fa + (t - a) * (first + bend * (t - b))


@jitable
def look_closer(
    still: World, motion: Motion, eye: Eye, v: Vector, room: Room, watch: Watch, k: int, wall: int, count: int
) -> int:  # fmt: skip
    """Add instants at which a wall comes nearest the ray between three looks; returns how many instants there are."""
    step = 1.0 / (LOOKS - 1)
    a, b, c = (k - 1) * step, k * step, (k + 1) * step
    fa, fb, fc = watch.levels[k - 1, wall], watch.levels[k, wall], watch.levels[k + 1, wall]
    for _ in range(_REFINED):
        t, least = vertex(a, b, c, fa, fb, fc)
        if not a < t < c or (abs(least) > _NEAR * abs(fb) and least * fb > 0.0) or t == b:
            return count
        count = add_time(watch, count, t)
        put_instant(still, motion, t, eye.world, eye.mean)
        if put_walls(eye.world, place_at(eye.place, motion, t), eye.walls, -1) <= wall:
            return count
        f = level_of(eye.walls[wall], v, room)
        if f * fb <= 0.0:
            return count
        if t < b:
            c, fc, b, fb = b, fb, t, f
        else:
            a, fa, b, fb = b, fb, t, f
    return count


@jitable
def put_events(still: World, motion: Motion, eye: Eye, v: Vector, room: Room, watch: Watch) -> int:
    """Write the ends of stretches of time, 0 to 1, in which no wall crosses the ray; returns how many stretches.

    Levels of walls are polynomials of time: a wall that passes and returns between two looks leaves a least level
    there, which is followed. 0 where there is no room.
    """
    count = 0
    for k in range(LOOKS):
        if state_of(still, motion, eye, v, k / (LOOKS - 1), room, watch, k) < 0:
            return 0
        count = add_time(watch, count, k / (LOOKS - 1))
    for k in range(1, LOOKS - 1):
        if watch.layouts[k - 1] != watch.layouts[k] or watch.layouts[k] != watch.layouts[k + 1]:
            continue
        for wall in range(watch.levels.shape[1]):
            if watch.seen[k, wall] == 0:
                continue
            before, here, after = watch.levels[k - 1, wall], watch.levels[k, wall], watch.levels[k + 1, wall]
            if before * here > 0.0 and here * after > 0.0:
                count = look_closer(still, motion, eye, v, room, watch, k, wall, count)
        for wall in range(watch.levels.shape[1]):
            watch.seen[k - 1, wall] = 0
    if count >= MOST_INSTANTS:
        return 0
    panels, found = watch.panels, 0
    panels[0] = 0.0
    start, state = 0.0, state_of(still, motion, eye, v, 0.0, room, watch, -1)
    for k in range(1, count):
        stop = watch.times[k]
        last = state_of(still, motion, eye, v, stop, room, watch, -1)
        while state != last:
            low, high, above = start, stop, last
            for _ in range(_BISECTIONS):
                middle = 0.5 * (low + high)
                if not low < middle < high:
                    break
                there = state_of(still, motion, eye, v, middle, room, watch, -1)
                if there == state:
                    low = middle
                else:
                    high, above = middle, there
            if found + 2 >= MOST_INSTANTS:
                return 0
            found += 1
            panels[found] = start = high
            state = above
        start = stop
    if panels[found] < 1.0:
        found += 1
        panels[found] = 1.0
    return found
