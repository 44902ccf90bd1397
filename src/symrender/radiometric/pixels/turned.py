"""Where a bump turns its normals away from the eye or from a light: curves of no known shape, followed by models.

Within a cell the place that a ray meets, the height's gradient there and the turned normal are polynomials with a
bound of what they miss (``models.py``), and so is the level N'.v or N'.(L - Q) of a wall. A cell that the polynomial
misses by more than the bound holds no such wall; in one that it cuts the wall lies in a strip about it as wide as the
bound says.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Cell, Eye
from symrender.radiometric.pixels.curves import put_linear, put_square, spread
from symrender.radiometric.pixels.models import (
    add_scaled,
    is_known,
    put_grown,
    put_number,
    put_product,
    put_reciprocal,
    put_root,
    put_scaled,
    put_wave,
)
from symrender.radiometric.pixels.records import KINK, MODELS, REST, TERMS, TURNED, Room, Wall
from symrender.radiometric.pixels.sight import may_show
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Array, Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import (
    ALONG_Z,
    COSINE,
    DIFFERENCE,
    DIFFUSE,
    DIRECTIONAL,
    DISTANCE,
    EXPONENTIAL,
    NUMBER,
    POINT,
    PRODUCT,
    SINE,
    SPHERE,
    SPOT,
    SUM,
)
from symrender.scene.radiometric.records import Material, Term

# rows of ``room.models``
_RAY: Final = 0
_PLACE: Final = 3
_NORMAL: Final = 6
_OUTWARD: Final = 9
_AT: Final = 12
_SLOPE: Final = 15
_SERIES: Final = 18
_WORK: Final = 20
_NEARNESS: Final = 25

_TURNS: Final = 0.5
"""Largest angle a normal may turn by within a cell, in radians or widths of the lobe, for nodes to follow it."""
_LOOSE: Final = 0.1
"""Largest part of what a normal turns by that its polynomial may miss."""
_LITTLE: Final = 0.1
"""What a normal may turn by, over ``width_of``, that its polynomial may miss altogether: beside a limb."""


@jitable
def put_depth(piece: Piece, center: Vector, eye: Vector, cell: Cell, models: Array) -> None:
    """How far along its ray v a piece is met, in ``models[_WORK]``."""
    t, a, b, work = models[_WORK], models[_WORK + 1], models[_WORK + 2], models[_SERIES : _SERIES + 2]
    v, vx, vy = cell.v, cell.vx, cell.vy
    if piece.kind != SPHERE:
        up, height = vector(piece.up), height_over(piece, eye)
        put_linear(up, 0.0, v, vx, vy, a)
        put_reciprocal(a, work, t)
        put_scaled(t, -height, t)
        # of what is flat its inverse is known up to the horizon
        put_scaled(a, -1.0 / height if height != 0.0 else 0.0, models[_NEARNESS])
        return
    power = leaves.sphere_power(*center, piece.radius)
    put_square(v, vx, vy, a)
    put_linear(center, 0.0, v, vx, vy, b)
    put_product(b, b, t)
    add_scaled(a, -power, t)
    root = models[_WORK + 3]
    put_root(t, work, root)
    add_scaled(b, 1.0, root)
    if power > 0.0:
        put_reciprocal(root, work, t)
        put_scaled(t, power, t)
    else:
        put_reciprocal(a, work, b)
        put_product(root, b, t)


@jitable
def put_distance(term: Term, models: Array, row: int) -> None:
    """Distance from a centre and its gradient, four rows from ``row`` on."""
    square, other, work = models[_WORK], models[_WORK + 1], models[_SERIES : _SERIES + 2]
    put_number(0.0, square)
    for c in range(3):
        offset = models[_WORK + 2 + c]
        put_scaled(models[_AT + c], 1.0, offset)
        offset[0] -= term.center[c]
        put_product(offset, offset, other)
        add_scaled(other, 1.0, square)
    put_root(square, work, models[row])
    put_reciprocal(models[row], work, other)
    for c in range(3):
        put_product(models[_WORK + 2 + c], other, models[row + 1 + c])


@jitable
def put_function(term: Term, first: int, models: Array, row: int) -> None:
    """A function of one term, and its gradient: its slope times that of the term."""
    slope, other, work, inner = models[_WORK], models[_WORK + 1], models[_SERIES : _SERIES + 2], models[first]
    if term.kind == SINE:
        put_wave(inner, 0.0, work, models[row])
        put_wave(inner, 1.0, work, slope)
    elif term.kind == COSINE:
        put_wave(inner, 1.0, work, models[row])
        put_wave(inner, 0.0, work, slope)
        put_scaled(slope, -1.0, slope)
    elif term.kind == EXPONENTIAL:
        put_grown(inner, work, models[row])
        put_scaled(models[row], 1.0, slope)
    else:
        put_number(1.0, slope)
        for _k in range(int(term.number) - 1):
            put_product(slope, inner, other)
            put_scaled(other, 1.0, slope)
        put_product(slope, inner, models[row])
        put_scaled(slope, term.number, slope)
    for c in range(1, 4):
        put_product(slope, models[first + c], models[row + c])


@jitable
def put_pair(term: Term, first: int, second: int, models: Array, row: int) -> None:
    """A sum, a difference or a product of two terms, and its gradient."""
    other = models[_WORK]
    if term.kind != PRODUCT:
        for c in range(4):
            put_scaled(models[first + c], 1.0, models[row + c])
            add_scaled(models[second + c], 1.0 if term.kind == SUM else -1.0, models[row + c])
        return
    put_product(models[first], models[second], models[row])
    for c in range(1, 4):
        put_product(models[first], models[second + c], models[row + c])
        put_product(models[first + c], models[second], other)
        add_scaled(other, 1.0, models[row + c])


@jitable
def put_height(world: World, material: Material, models: Array) -> int:
    """The height of a bump at the place in ``models[_AT]`` and its gradient; returns the first of their rows."""
    row = MODELS
    for k in range(int(material.terms)):
        term = world.terms[int(material.begin) + k]
        row = MODELS + 4 * k
        first, second = MODELS + 4 * int(term.first), MODELS + 4 * int(term.second)
        if term.kind == DISTANCE:
            put_distance(term, models, row)
        elif term.kind <= ALONG_Z:
            for c in range(4):
                put_number(0.0, models[row + c])
            if term.kind == NUMBER:
                models[row, 0] = term.number
            else:
                axis = int(term.kind) - (ALONG_Z - 2)
                put_scaled(models[_AT + axis], 1.0, models[row])
                models[row + 1 + axis, 0] = 1.0
        elif term.kind in (SUM, DIFFERENCE, PRODUCT):
            put_pair(term, first, second, models, row)
        else:
            put_function(term, first, models, row)
    return row


@jitable
def put_place(piece: Piece, material: Material, eye: Vector, center: Vector, models: Array) -> None:
    """The place of a piece that is met, in the coordinates of its height, in ``models[_AT]``."""
    for c in range(3):
        put_scaled(models[_PLACE + c], 1.0, models[_AT + c])
    if material.own == 0.0 or piece.kind == SPHERE:
        for c in range(3):
            models[_AT + c, 0] += eye[c] if material.own == 0.0 else -center[c]
        return
    x, y, offset = models[_AT], models[_AT + 1], minus(eye, vector(piece.place))
    put_number(dot(offset, vector(piece.east)), x)
    put_number(dot(offset, vector(piece.north)), y)
    put_number(0.0, models[_AT + 2])
    for c in range(3):
        add_scaled(models[_PLACE + c], piece.east[c], x)
        add_scaled(models[_PLACE + c], piece.north[c], y)


@jitable
def put_slope(piece: Piece, material: Material, row: int, models: Array) -> None:
    """The gradient of the height in the world, in ``models[_SLOPE]``; that in its coordinates is beside ``row``."""
    for c in range(3):
        slope = models[_SLOPE + c]
        if material.own == 0.0 or piece.kind == SPHERE:
            put_scaled(models[row + 1 + c], material.amplitude, slope)
        else:
            put_scaled(models[row + 1], material.amplitude * piece.east[c], slope)
            add_scaled(models[row + 2], material.amplitude * piece.north[c], slope)


@jitable
def put_turned_normal(piece: Piece, center: Vector, models: Array) -> None:
    """N - grad h + N (N.grad h), of no length in particular, in ``models[_NORMAL]``."""
    along, other = models[_WORK], models[_WORK + 1]
    put_number(0.0, along)
    for c in range(3):
        outward = models[_OUTWARD + c]
        if piece.kind == SPHERE:
            put_scaled(models[_PLACE + c], 1.0 / piece.radius, outward)
            outward[0] -= center[c] / piece.radius
        else:
            put_number(piece.up[c], outward)
        put_product(outward, models[_SLOPE + c], other)
        add_scaled(other, 1.0, along)
    for c in range(3):
        normal = models[_NORMAL + c]
        put_product(models[_OUTWARD + c], along, normal)
        add_scaled(models[_OUTWARD + c], 1.0, normal)
        add_scaled(models[_SLOPE + c], -1.0, normal)


@jitable
def put_bump(eye: Eye, cell: Cell, own: int, models: Array) -> None:
    """Models of ray, place relative to the eye, and turned normal of piece ``own`` in a cell."""
    piece = eye.world.pieces[own]
    material = eye.world.materials[int(piece.material)]
    center = minus(vector(piece.place), eye.place)
    put_depth(piece, center, eye.place, cell, models)
    for c in range(3):
        ray = models[_RAY + c]
        put_number(cell.v[c], ray)
        ray[5], ray[1] = cell.vx[c], cell.vy[c]
        put_product(models[_WORK], models[_RAY + c], models[_PLACE + c])
    put_place(piece, material, eye.place, center, models)
    put_slope(piece, material, put_height(eye.world, material, models), models)
    put_turned_normal(piece, center, models)


@jitable
def put_turned_level(eye: Eye, light: int, flat: bool, models: Array, out: Array) -> None:
    """The level of a wall of the piece that ``models`` are of: N'.v, or N' along the way to a light.

    That way is, from what is flat, divided by how far it is along the ray: known up to the horizon.
    """
    way, other = models[_WORK], models[_WORK + 1]
    put_number(0.0, out)
    for c in range(3):
        if light < 0:
            put_scaled(models[_RAY + c], 1.0, way)
        else:
            lamp = eye.world.lights[light]
            put_number(lamp.place[c], way)
            if lamp.kind != DIRECTIONAL:
                way[0] -= eye.place[c]
                if flat:
                    put_scaled(models[_NEARNESS], way[0], way)
                    add_scaled(models[_RAY + c], -1.0, way)
                else:
                    add_scaled(models[_PLACE + c], -1.0, way)
        put_product(models[_NORMAL + c], way, other)
        add_scaled(other, 1.0, out)


@jitable
def put_turned_curve(eye: Eye, cell: Cell, wall: Wall, held: int, models: Array, out: Array) -> int:
    """The curve of a TURNED wall, its largest number 1; returns the piece that ``models`` are of then.

    ``held`` is the one they are of before. One of which nothing is known may be anywhere, one that is 0 is nowhere.
    """
    own = int(wall.own)
    if held != own:
        put_bump(eye, cell, own, models)
    put_turned_level(eye, int(wall.rest), eye.world.pieces[own].kind != SPHERE, models, out)
    if not is_known(out):
        put_number(0.0, out)
        out[REST] = 1.0
        return own
    most = 0.0
    for k in range(TERMS):
        most = max(most, abs(out[k]))
    if most == 0.0:
        put_number(1.0, out)
        return own
    for k in range(TERMS):
        out[k] /= most
    return own


@inlined
def labour(world: World, own: int) -> float:
    """How many evaluations models of a piece take as long as, about."""
    return 4.0 + 4.0 * world.materials[int(world.pieces[own].material)].terms


@jitable
def put_turned_wall(eye: Eye, cell: Cell, room: Room, wall: Wall, held: int, out: Array) -> tuple[bool, int]:
    """(whether a wall is TURNED, and its curve written, the piece that the cell's models are of then).

    It is written anew in every cell, for a smaller one is known better.
    """
    if room.models is None:
        return False, held
    if wall.kind != TURNED:
        return False, held
    room.total[7] += 1.0 if held == int(wall.own) else labour(eye.world, int(wall.own))
    return True, put_turned_curve(eye, cell, wall, held, room.models, out)


@jitable
def bump_cap(eye: Eye, cell: Cell, room: Room, own: int, models: Array) -> tuple[Vector, float]:
    """(unit turned normal of piece ``own`` in the middle of a cell, largest angle off it in the cell)."""
    room.total[7] += labour(eye.world, own)
    put_bump(eye, cell, own, models)
    wide = 0.0
    for c in range(3):
        turned = spread(models[_NORMAL + c]) + abs(models[_NORMAL + c, REST])
        wide += turned * turned
    n = (models[_NORMAL, 0], models[_NORMAL + 1, 0], models[_NORMAL + 2, 0])
    size, wide = math.sqrt(dot(n, n)), math.sqrt(wide)
    if not wide < size:
        return vector(eye.world.pieces[own].up), math.pi
    return (n[0] / size, n[1] / size, n[2] / size), math.asin(wide / size)


@inlined
def width_of(material: Material) -> float:
    """By how much a normal may turn before what it reflects has changed altogether, about."""
    if material.kind == DIFFUSE:
        return 1.0
    return min(1.0, material.alpha if material.alpha > 0.0 else 0.5 / math.sqrt(material.exponent + 1.0))


@jitable
def waves(eye: Eye, cell: Cell, room: Room, models: Array, limit: float, least: float) -> bool:
    """Whether a bump that may be seen in a cell turns too far in it for nodes to follow.

    What changes light by less than the part ``least`` need not be followed.
    """
    world = eye.world
    for j in range(world.pieces.shape[0]):
        material = world.materials[int(world.pieces[j].material)]
        if material.terms == 0.0 or not may_show(room, float(j), limit):
            continue
        room.total[7] += labour(world, j)
        put_bump(eye, cell, j, models)
        size, wide, rest = 0.0, 0.0, 0.0
        for c in range(3):
            normal = models[_NORMAL + c]
            if not is_known(normal):
                return True
            size += normal[0] * normal[0]
            turned = spread(normal)
            wide += turned * turned
            rest += normal[REST] * normal[REST]
        size, wide, rest = math.sqrt(size), math.sqrt(wide), math.sqrt(rest)
        width = width_of(material) * size
        if wide > _TURNS * width or (rest > _LOOSE * wide and wide > max(least, _LITTLE) * width):
            return True
    return False


@jitable
def put_turned(walls: Table[Wall], count: int, own: int, light: int, soft: float) -> int:
    """List where the turned normal of a bump is at right angles to the way to a light, or to the eye if that is -1."""
    if count < walls.shape[0]:
        wall = walls[count]
        wall.kind, wall.own, wall.other, wall.soft, wall.rest = TURNED, own, -1, soft, light
    return count + 1


@jitable
def turned_walls(world: World, walls: Table[Wall], count: int, unseen: int) -> int:
    """Where normals turn away from the eye or a light: all of what a bump adds under points and directions.

    What arrives by the cosine of the turned normal goes to nothing there, what by another's jumps.
    """
    for own in range(world.pieces.shape[0]):
        material = world.materials[int(world.pieces[own].material)]
        if material.terms == 0.0 or own == unseen:
            continue
        count = put_turned(walls, count, own, -1, 0.0)
        for light in range(world.lights.shape[0]):
            if world.lights[light].kind in (POINT, DIRECTIONAL, SPOT):
                count = put_turned(walls, count, own, light, 0.0 if material.geometric != 0.0 else KINK)
    return count
