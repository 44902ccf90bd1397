"""What derivatives of pixels are summed from: the cells of their means, the walls of those that are not resolved."""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.radiometric.pixels.cells import Cell, Eye, cell_at, heaviest, step
from symrender.radiometric.pixels.moving import (
    FULL,
    UNKNOWN,
    UNRESOLVED,
    Sweep,
    order_before,
    put_edge,
    sweep_lines,
    sweep_smooth,
)
from symrender.radiometric.pixels.parts import put_path, whole_of
from symrender.radiometric.pixels.pixel import begin, block_walls, pixel_mean
from symrender.radiometric.pixels.records import COARSE, CUT, LOGGED, SMOOTH, Ints, Part, Room
from symrender.radiometric.pixels.rules import cutting_mode
from symrender.radiometric.pixels.sight import may_show, put_reach
from symrender.radiometric.pixels.textures import put_lines, spanned
from symrender.radiometric.vectors import Array, dot, vector


@jitable
def sweep_pixel(
    eye: Eye, whole: Cell, room: Room, candidates: Ints, count: int, tol: float, budget: int, sweep: Sweep
) -> float:  # fmt: skip
    """Add what the derivative of a pixel is summed from; returns the length of sides of cells that are not resolved.

    ``room.total`` is left as by ``pixel_mean``.
    """
    pixel_mean(eye, whole, room, candidates, count, tol, budget)
    held = int(room.log[LOGGED, 0])
    coarse = 0.0
    if held >= LOGGED - 1:
        sweep.counts[2] = UNKNOWN
        return coarse
    for index in range(held):
        log = room.log[index]
        sweep.counts[3] += 1
        level, path = int(log[0]), int(log[1])
        for k in range(level, 0, -1):
            room.path[k] = path % 4
            path = path // 4
        cell = cell_at(whole, room, level, tol)
        order = int(log[3])
        limit = put_reach(eye, cell, room)
        if not begin(eye, cell, room, candidates, count, limit):
            sweep.counts[2] = UNKNOWN
            continue
        own, lines = int(room.counts[cell.level]), put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
        if log[2] == COARSE or log[4] < 0:
            coarse += cell.half * heaviest(eye.domain, cell)
            sweep_coarse(eye, cell, room, sweep, own, max(0, lines))
            if lines < 0:
                sweep_means(eye, cell, room, sweep, limit)
        # walls on its edges alone have not made it one that is cut
        elif lines < 0:
            sweep.counts[2] = UNKNOWN
            continue
        elif own + lines > 0 and (log[2] == CUT or cutting_mode(room, own, lines, cell.level) >= 0):
            for rule in range(2):
                nodes = order if rule == 0 else order_before(order)
                sweep_lines(eye, cell, room, sweep, nodes, own, lines, max(0, int(log[4])), rule == 1)
            continue
        for rule in range(2):
            nodes = order if log[2] == SMOOTH else 3
            sweep_smooth(eye, cell, sweep, nodes if rule == 0 else order_before(nodes), rule == 1)
    return coarse


def sweep_pixels(
    eye: Eye, window: Array, width: int, height: int, reach: float, columns: Ints, rows: Ints, room: Room,
    candidates: Ints, tol: float, budget: int, sweep: Sweep, ends: Ints, cells: Array,
) -> int:  # fmt: skip
    """List what the derivatives of pixels are summed from, of as many as there is room for; returns how many.

    Those of pixel n end before ``ends[n, 0]`` and ``ends[n, 1]``; ``ends[n, 2]`` is 1 where that is not known or too
    much, and then nothing is listed. ``cells[n]`` is what ``sweep_pixel`` returns and what radiance spans. Many
    arguments because a kernel's are.
    """
    sweep.counts[0], sweep.counts[1], sweep.counts[3] = 0, 0, 0
    for n in range(columns.shape[0]):
        nodes, edges = int(sweep.counts[0]), int(sweep.counts[1])
        sweep.counts[2], ends[n, 2] = 0, 0
        whole = whole_of(window, width, height, reach, int(columns[n]), int(rows[n]))
        count = block_walls(eye, whole, room, candidates)
        cells[n, 0] = sweep_pixel(eye, whole, room, candidates, count, tol, budget, sweep)
        span = room.span
        most = max(span[1, 0] - span[0, 0], max(span[1, 1] - span[0, 1], span[1, 2] - span[0, 2]))
        cells[n, 1] = max(most, eye.bright)
        if sweep.counts[2] != 0:
            sweep.counts[0], sweep.counts[1] = nodes, edges
            if sweep.counts[2] == FULL and nodes > 0:
                return n
            ends[n, 2] = 1
        ends[n, 0], ends[n, 1] = sweep.counts[0], sweep.counts[1]
    return int(columns.shape[0])


@jitable
def sweep_coarse(eye: Eye, cell: Cell, room: Room, sweep: Sweep, own: int, lines: int) -> None:
    """Add the walls of a cell of which nothing is known, along both of its sides; its weight is the largest."""
    for curve in range(own + lines):
        for across in range(2):
            tx, ty = (cell.half, 0.0) if across == 0 else (0.0, cell.half)
            k = put_edge(eye, room, sweep, cell.level, own, curve, cell.x, cell.y, tx, ty, 0.0, UNRESOLVED)
            if k >= 0:
                sweep.edges[k, 4] = heaviest(eye.domain, cell)


@jitable
def sweep_means(eye: Eye, cell: Cell, room: Room, sweep: Sweep, limit: float) -> None:
    """Add a line of each texture that is replaced by its mean in a cell, through its corners, as ``sweep_coarse``.

    However many they are, their sweep is about that of one, at the end of the lines along which the other coordinate
    stays.
    """
    for f in range(eye.families.shape[0]):
        family = eye.families[f]
        if not may_show(room, family.own, limit):
            continue
        low, high = spanned(family, cell.v, cell.vx, cell.vy)
        if not high - low < math.inf:
            # towards the horizon they move ever faster
            sweep.counts[2] = UNKNOWN
            continue
        for corner in range(4):
            x, y = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
            v = step(cell.v, x, cell.vx, y, cell.vy)
            room.numbers[0, 0] = f
            room.numbers[0, 1] = math.floor(dot(vector(family.numerator), v) / dot(vector(family.denominator), v) + 0.5)
            for across in range(2):
                tx, ty = (cell.half, 0.0) if across == 0 else (0.0, cell.half)
                a, b = cell.x + cell.half * x, cell.y + cell.half * y
                k = put_edge(eye, room, sweep, cell.level, 0, 0, a, b, tx, ty, 0.0, UNRESOLVED)
                if k >= 0:
                    sweep.edges[k, 4] = heaviest(eye.domain, cell)


def sweep_parts(
    eye: Eye, window: Array, width: int, height: int, reach: float, parts: Table[Part], orders: Ints, room: Room,
    candidates: Ints, sweep: Sweep, ends: Ints,
) -> None:  # fmt: skip
    """List nodes and edges of a rule of an order for each of some parts (``parts.py``).

    Those of part n end before ``ends[n, 0]`` and ``ends[n, 1]``; ``ends[n, 2]`` is 1 where walls are not known, and
    then nothing is. Of a part that is not resolved the walls are listed alone. Many arguments because a kernel's are.
    """
    sweep.counts[0], sweep.counts[1], sweep.counts[2] = 0, 0, 0
    for n in range(parts.shape[0]):
        part, order = parts[n], int(orders[n])
        whole = whole_of(window, width, height, reach, int(part.column), int(part.row))
        put_path(room, int(part.level), int(part.path))
        cell = cell_at(whole, room, int(part.level), 0.0)
        ends[n, 2] = 0
        if part.kind == SMOOTH:
            # lines that are too many to be cut at sweep as much as a few do: no mean of the texture tells
            ends[n, 2] = part.blurred
            if part.blurred == 0:
                sweep_smooth(eye, cell, sweep, order, False)
        else:
            limit = put_reach(eye, cell, room)
            count = block_walls(eye, cell, room, candidates)
            fits = begin(eye, cell, room, candidates, count, limit)
            lines = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
            own = int(room.counts[cell.level])
            if not fits or lines < 0:
                ends[n, 2] = 1
            elif part.kind == CUT:
                # slopes beside a limb are as one over a root: where its piece shrinks to nothing their sum is as a root
                sweep_lines(eye, cell, room, sweep, order, own, lines, 4, False)
            else:
                sweep_smooth(eye, cell, sweep, order, False)
                sweep_coarse(eye, cell, room, sweep, own, lines)
        ends[n, 0], ends[n, 1] = sweep.counts[0], sweep.counts[1]
