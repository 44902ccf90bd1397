"""Parts of a pixel and their nodes, for what no kernel of pixels can send along rays itself: lobes' integrals.

A pixel is cut as in ``pixel.py``, before anything is known of what its rays see: a part is a cell that no curve
enters, one that is cut along lines, or a small one of which nothing more is known. Whoever evaluates the nodes decides
which part is to be halved, or to take a rule of a higher order.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.radiometric.pixels.cells import (
    BLOCK,
    BOX,
    Cell,
    Eye,
    block_of,
    cell_at,
    heaviest,
    kinks,
    ray_of,
    step,
    window_cell,
)
from symrender.radiometric.pixels.highlights import hidden_light, hidden_powers
from symrender.radiometric.pixels.hot import near_hot
from symrender.radiometric.pixels.pixel import begin, block_walls
from symrender.radiometric.pixels.records import (
    COARSE,
    CUT,
    DENSE,
    DENSE_CUT,
    DENSER,
    LEVELS,
    MOST_CUTS,
    SMOOTH,
    Ints,
    Part,
    Room,
)
from symrender.radiometric.pixels.rules import cut_rule, cutting_mode, put_panels, tensor_rule
from symrender.radiometric.pixels.sharp import too_sharp, veins_turn
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.textures import fields, mean_error, put_lines
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array, Vector
from symrender.scene.radiometric.arrays import CONDUCTOR, PHONG
from symrender.scene.radiometric.records import Material

_HALVE: Final = -1
_TURNED: Final = 1.4
"""Largest part of a lobe's width that its axis may turn by between corners of a cell."""


@inlined
def whole_of(window: Array, width: int, height: int, reach: float, i: int, j: int) -> Cell:
    """The support of a pixel's filter."""
    beyond = reach - 0.5
    return window_cell(window, width, height, i - beyond, j - beyond, i + 1 + beyond, j + 1 + beyond, 0.0)


@jitable
def lobe_axis(material: Material, ray: Vector, normal: Vector) -> Vector:
    """What a material's lobe turns with: the mirror direction, of a diffuse one the normal."""
    if material.kind in (CONDUCTOR, PHONG):
        return values.mirror_direction(*ray, *normal)
    return normal


@jitable
def lobe_width(material: Material) -> float:
    """Angle within which most of a lobe lies, about."""
    if material.kind == CONDUCTOR:
        return min(1.0, 2.0 * material.alpha)
    return 1.0 / math.sqrt(material.exponent + 1.0) if material.kind == PHONG else 1.0


@jitable
def lobes_turn(eye: Eye, cell: Cell, steps: float) -> bool:
    """Whether lobes at the corners of a cell look so far apart that nodes may miss what one between them sees.

    ``steps`` is how many times denser the nodes are than those of a cell that takes four.
    """
    world = eye.world
    origin, ray = ray_of(eye, step(cell.v, -1.0, cell.vx, -1.0, cell.vy))
    own, _, place, normal, _ = nearest(world, origin, ray)
    for corner in range(1, 4):
        # about the cell, not across it
        a, b = 1.0 if corner in (1, 2) else -1.0, 1.0 if corner >= 2 else -1.0
        origin, d = ray_of(eye, step(cell.v, a, cell.vx, b, cell.vy))
        other, _, at, facing, _ = nearest(world, origin, d)
        if own >= 0 and other == own:
            if veins_turn(world, own, place, at):
                return True
            material = world.materials[int(world.pieces[own].material)]
            x, y, z = lobe_axis(material, ray, normal)
            p, q, r = lobe_axis(material, d, facing)
            turned = math.sqrt((x - p) * (x - p) + (y - q) * (y - q) + (z - r) * (z - r))
            if turned > _TURNED * steps * lobe_width(material):
                return True
        own, ray, place, normal = other, d, at, facing
    return False


@jitable
def put_cut(
    eye: Eye, cell: Cell, room: Room, own: int, lines: int, grain: float, part: Part
) -> int:  # fmt: skip
    """Write that a cell is cut along lines, if its curves are monotone along some: its kind, else ``_HALVE``."""
    mode = cutting_mode(room, own, lines, cell.level)
    if mode < 0:
        return _HALVE
    panels, risk = put_panels(room, own + lines, mode)
    missed = cell.area * risk * (0.25 if mode < 2 else 0.5) * heaviest(eye.domain, cell)
    if panels == 0 or missed > grain:
        return _HALVE
    part.missed = missed
    return CUT


@jitable
def followed(eye: Eye, cell: Cell, room: Room, limit: float, steps: float) -> bool:
    """Whether nodes ``steps`` times denser than four a cell follow what lobes see in it."""
    return not (lobes_turn(eye, cell, steps) or near_hot(eye, cell, room, limit, steps))


@jitable
def look(
    eye: Eye, cell: Cell, room: Room, limit: float, fits: bool, grain: float, densest: float, part: Part
) -> int:  # fmt: skip
    """Write what rule a cell takes into ``part``; its kind, or ``_HALVE``."""
    part.fields = part.missed = part.beside = 0.0
    if cell.level < kinks(eye.domain):
        return _HALVE
    share = cell.area * heaviest(eye.domain, cell)
    ends = cell.level >= LEVELS or share <= grain
    own = int(room.counts[cell.level])
    lines = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
    # how many times denser than four a cell nodes are to be, 0 where the cell is to be halved
    steps, hidden = 0, 0.0
    if densest == 0.0:
        # over the brightest light
        hidden = hidden_powers(eye, cell, room, limit) if eye.relative else hidden_light(eye, cell, room, limit)
        hidden *= share / (1.0 if eye.relative else max(eye.bright, 1e-300))
        steps = 0 if hidden > grain or too_sharp(eye, cell) else 1
    else:
        curved = own > 0 or lines > 0
        most = 1.0 if ends or not fits or lines < 0 else min(densest, 2.0) if curved else densest
        for k in range(int(most)):
            if followed(eye, cell, room, limit, k + 1.0):
                steps = k + 1
                break
    if steps == 0 and not ends:
        return _HALVE
    if lines < 0:
        part.fields = fields(eye.families, cell.v, cell.vx, cell.vy, room, limit)
    if fits and steps > 0:
        if lines < 0:
            # a weight that changes along a line counts as a break more
            breaks = own if eye.domain == BOX else own + 1
            part.beside = share * 1.5 * mean_error(eye.families, cell.v, cell.vx, cell.vy, room, limit, breaks)
        if own + max(lines, 0) == 0:
            part.missed = hidden
            return SMOOTH if steps == 1 else DENSE if steps == 2 else DENSER
        if own + max(lines, 0) <= MOST_CUTS:
            kind = put_cut(eye, cell, room, own, max(lines, 0), grain, part)
            if kind == CUT:
                part.missed += hidden
                return DENSE_CUT if steps == 2 else CUT
    if ends:
        part.missed, part.beside = share, 0.0
        return COARSE
    return _HALVE


@jitable
def put_path(room: Room, level: int, path: int) -> None:
    """Write the way to a cell into ``room.path``."""
    for k in range(level, 0, -1):
        room.path[k] = path % 4
        path //= 4


@jitable
def path_of(room: Room, level: int) -> int:
    """The way to the cell that ``room.path`` says, as a number."""
    path = 0
    for k in range(1, level + 1):
        path = 4 * path + int(room.path[k])
    return path


def list_parts(
    eye: Eye, window: Array, width: int, height: int, reach: float, starts: Table[Part], grain: float, densest: float,
    room: Room, candidates: Ints, spare: Table[Part], parts: Table[Part], origins: Ints,
) -> int:  # fmt: skip
    """List the parts of cells, which are named by pixel, level and path, and of which each is; returns how many.

    Those that fit into ``parts`` are written. A cell that weighs no more than ``grain`` is not halved any further.
    Nodes that ask for lobes may be ``densest`` times as dense as four a cell, at least 1, and 0 says that they ask for
    direct light. Many arguments because a kernel's are.
    """
    found, part, left, above, count = 0, spare[0], -1, -1, 0
    for n in range(starts.shape[0]):
        start = starts[n]
        i, j, top = int(start.column), int(start.row), int(start.level)
        whole = whole_of(window, width, height, reach, i, j)
        put_path(room, top, int(start.path))
        if i // BLOCK != left or j // BLOCK != above:
            left, above = i // BLOCK, j // BLOCK
            count = block_walls(eye, block_of(window, width, height, reach, left, above, 0.0), room, candidates)
        level = top
        while level >= top:
            cell = cell_at(whole, room, level, 0.0)
            limit = put_reach(eye, cell, room)
            # from the walls again, as ``list_nodes`` has to, and not from the curves of the level above
            fits = begin(eye, cell, room, candidates, count, limit)
            kind = look(eye, cell, room, limit, fits, grain, densest, part)
            if kind == _HALVE:
                level += 1
                room.path[level] = 0
                continue
            if found < parts.shape[0]:
                part.column, part.row, part.level, part.path = i, j, level, path_of(room, level)
                part.kind = kind
                parts[found] = part
                origins[found] = n
            found += 1
            while level > top and room.path[level] == 3:
                level -= 1
            if level == top:
                break
            room.path[level] += 1
    return found


def list_nodes(
    eye: Eye, window: Array, width: int, height: int, reach: float, parts: Table[Part], orders: Ints, room: Room,
    candidates: Ints, ends: Ints,
) -> int:  # fmt: skip
    """List the nodes of rules of an order for each of some parts in ``eye.nodes``; returns how many there are.

    Those of part n end before ``ends[n]``. Many arguments because a kernel's are.
    """
    if eye.nodes is None:
        return 0
    eye.nodes.found[0] = 0
    left, above, count = -1, -1, 0
    for n in range(parts.shape[0]):
        part, order = parts[n], int(orders[n])
        whole = whole_of(window, width, height, reach, int(part.column), int(part.row))
        put_path(room, int(part.level), int(part.path))
        cell = cell_at(whole, room, int(part.level), 0.0)
        if part.kind == CUT or part.kind == DENSE_CUT:
            if part.column // BLOCK != left or part.row // BLOCK != above:
                left, above = int(part.column) // BLOCK, int(part.row) // BLOCK
                count = block_walls(eye, block_of(window, width, height, reach, left, above, 0.0), room, candidates)
            limit = put_reach(eye, cell, room)
            begin(eye, cell, room, candidates, count, limit)
            own = int(room.counts[cell.level])
            lines = max(0, put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit))
            for k in range(own + lines):
                room.soft[k] = eye.walls[int(room.which[cell.level, k])].soft if k < own else 0.0
            mode = cutting_mode(room, own, lines, cell.level)
            panels, _ = put_panels(room, own + lines, mode)
            # drawn to the ends of panels where a piece beside a limb shrinks to nothing, from a third rule on
            cut_rule(eye, eye.world, cell, order, 0, own + lines, mode if order < 5 else mode + 4, panels, room)
        else:
            tensor_rule(eye, eye.world, cell, order, 0, room)
        ends[n] = eye.nodes.found[0]
    return int(eye.nodes.found[0])
