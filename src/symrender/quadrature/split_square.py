"""A square of the checkered floor that walls cross, cut along lines y = const."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.labels import HIDDEN, PARTLY
from symrender.chambers.records import NODES
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.floor_conics import square_cuts
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, MIDDLE, nodes
from symrender.quadrature.line_errors import across_error, tail_error
from symrender.quadrature.paces import felt
from symrender.quadrature.panel_maps import rooted_azimuth
from symrender.quadrature.records import Conic
from symrender.quadrature.row_levels import is_metal, levels_on_row, piece_log, sides_log
from symrender.quadrature.split_line import SOFT_LOG
from symrender.quadrature.square_nodes import add_tapered, floor_nodes, seen
from symrender.quadrature.square_rows import (
    BRANCHES,
    change_of_rows,
    nearest_branch,
    push_strips,
    roots_beyond,
    row_pieces,
    sliver_error,
)
from symrender.scene.arrays import MARBLE

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MAX_HALVINGS = 5
"""How often a strip of a square is halved at most."""
MORE_LEVELS = 3
"""How many levels finer than asked, each of two lines and a node more, a strip may become before it is halved."""
MAX_STRIPS = 200
"""Strips evaluated in a square; beyond, those that miss stand as they are."""
THIN = 1e-9
"""Height of a strip, in squares, below which one line is taken to tell all of it, whatever changes inside."""
NARROW = 1e-11
"""Width of a piece of a row, in squares, below which nothing is asked of it."""
TOUCHING = 1e-9
"""How close to where two walls touch a strip is cut, in squares: what is between them goes by the third power."""
UNSURE = 7
"""Factor of the label of a piece that has been too narrow on every row so far."""
ROW_LABOUR = 1
"""What looking for the ends of a strip costs for each conic, in evaluations."""
MAX_LINES = 16
"""Lines beyond which a strip is halved."""


class Ground(NamedTuple):
    """The plane under a place: its lobe, the scene in the plane's frame, scratch, walls, rules and lights' states."""

    lobe: Array
    world: View
    work: Work
    conics: Table[Conic]
    gauss: Array
    states: Array


class Square(NamedTuple):
    """A square from (x0, y0) on, ``size`` wide, crossed by the first ``crossings`` conics that ``crossing`` numbers.

    The integrand is tame over the length ``span``, nothing counts beyond the ``reach`` of the tapers, ``bound`` is what
    the square can hold and ``room`` what one of its strips may err by at the first ``step``.
    """

    x0: float
    y0: float
    size: float
    step: int
    span: float
    reach: float
    room: float
    bound: float
    crossing: Array
    crossings: int


class Strip(NamedTuple):
    """What lies between y = a and y = b of a square: ends of kinds ``kind_a`` and ``kind_b``, ``lines`` lines.

    ``first`` and ``last`` are how far beyond its ends roots lie, where they do. Pieces of its lines get ``more`` nodes
    than ``step`` asks; ``signature`` tells how many pieces, between which walls.
    """

    a: float
    b: float
    first: float
    last: float
    kind_a: float
    kind_b: float
    lines: int
    more: int
    step: int
    signature: int


@inlined
def add_pieces(
    m: int, pieces: int, base: int, step: int, reach: float, lobe: Array, view: View, work: Work, gauss: Array,
    sums: Array, out: Array,
) -> None:  # fmt: skip
    """Add the pieces at hand to ``out`` (9,), and to ``sums`` (6,) size, error and coefficients along y of their sum.

    ``base`` is where the rule of the lines begins.
    """
    floor_nodes(m, pieces, step, reach, view.floor.kind == MARBLE, lobe, view, work, gauss)
    b = work.nodes
    for k in range(pieces):
        row = work.pieces[k]
        first, n, q = row.first, row.count, row.line
        start = n * (n - 1) // 2
        whole, size, top, second, half, under = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for e in range(n):
            red, green, blue = b.radiance[0, first + e], b.radiance[1, first + e], b.radiance[2, first + e]
            add_tapered(red, green, blue, 1.0, b.near[first + e], b.between[first + e], out)
            value = red + green + blue
            whole += value
            size += abs(value)
            top += value * gauss[2, start + e]
            second += value * gauss[3, start + e]
            half += value * gauss[MIDDLE, start + e]
            under += value * gauss[MIDDLE + 1, start + e]
        # veins have both signs
        size = size if view.floor.kind == MARBLE else abs(whole)
        miss = tail_error(n, top, second, max(abs(half), abs(under)), size, row.log_rho)
        if moves(whole):
            steep, between = abs(tangent(whole)), max(abs(tangent(half)), abs(tangent(under)))
            missed = tail_error(n, tangent(top), tangent(second), between, steep, held(row.log_rho))
            sums[0] += moved(held(size), steep)
            sums[1] += moved(held(miss), missed)
        else:
            sums[0] += size
            sums[1] += miss
        sums[2] += whole * gauss[2, base + q]
        sums[3] += whole * gauss[3, base + q]
        sums[4] += whole * gauss[MIDDLE, base + q]
        sums[5] += whole * gauss[MIDDLE + 1, base + q]


@inlined
def lines_error(
    n: int, last: float, before: float, middle: float, lower: float, size: float, log_rho: float, branch: float
) -> float:  # fmt: skip
    """Error of a strip's rule of ``n`` lines by the last coefficients across them."""
    known = max(abs(last), 0.5 * abs(before)) * math.exp(-(n + 1) * branch)
    return 2.0 * max(across_error(n, last, before, middle, lower, size, log_rho), known)


@inlined
def is_labelled(
    piece: int, first: bool, left: float, width: float, y: float, size: float, ground: Ground
) -> bool:  # fmt: skip
    """Whether a piece of a row is seen, and lit by lights, as the piece of this number of the rows before.

    Two walls that touch change what lies between them, and no order tells. Of a narrow piece what was known before
    stands; on the ``first`` row it is asked all the same.
    """
    work, states = ground.work, ground.states
    narrow = width < NARROW * size
    if narrow and not first:
        return True
    side = 1 if seen(left + 0.5 * width, y, ground.lobe, ground.world, work, states) else HIDDEN
    if first or abs(work.cell_side[piece]) == UNSURE:
        work.cell_side[piece] = UNSURE * side if narrow else side
        for i in range(states.shape[0]):
            work.lit[piece, i] = int(states[i])
        return True
    same = bool(side == work.cell_side[piece])
    for i in range(states.shape[0]):
        same = same and (side == HIDDEN or work.lit[piece, i] == int(states[i]))
    return same


@inlined
def change_of_labels(low: float, high: float, square: Square, ground: Ground) -> float:
    """The y between two rows of one order of walls from which on a piece is seen, or lit, unlike on the row ``low``."""
    work = ground.work
    x0, x1 = square.x0, square.x0 + square.size
    walls, chart, roots, ends, ids = work.walls, work.chart, work.quartic, work.root_x, work.root_id
    y, first = low, True
    while True:
        pieces, _ = row_pieces(
            y, x0, x1, square.crossing, square.crossings, ground.conics, walls, chart, roots, ends, ids
        )
        same = True
        for piece in range(pieces):
            same = same and is_labelled(
                piece, first, ends[piece], ends[piece + 1] - ends[piece], y, square.size, ground
            )
        first = False
        low, high = (y, high) if same else (low, y)
        y = 0.5 * (low + high)
        if high - low < TOUCHING * square.size or not low < y < high:
            return held(high)


@inlined
def change_between(low: float, high: float, signature: int, square: Square, ground: Ground) -> float:
    """The y between two rows of other structure at which that of the row ``low``, of this signature, ends."""
    work, conics, x0, x1 = ground.work, ground.conics, square.x0, square.x0 + square.size
    _, found = row_pieces(
        high, x0, x1, square.crossing, square.crossings, conics, work.walls, work.chart, work.quartic, work.root_x,
        work.root_id,
    )  # fmt: skip
    if found == signature:
        return change_of_labels(low, high, square, ground)
    return change_of_rows(low, high, x0, x1, square.crossing, square.crossings, conics, work)


@inlined
def begins_softly(end: int, crossing: Array, conics: Table[Conic], work: Work) -> bool:
    """Whether an end of pieces on the row at hand is one at which light begins like a power of the distance."""
    name = int(work.root_id[end])
    owner = name // BRANCHES
    return bool(name >= 0 and conics[int(crossing[owner])].soft < 0)


@inlined
def strip_integral(strip: Strip, square: Square, ground: Ground, sums: Array, out: Array) -> float:
    """Integral over a strip of a square by lines of equal structure, each cut at the conics, in out[0:3].

    ``out[3:9]`` is the same under the two shorter tapers, ``out[9]`` the error estimate. Returns the y of a line of
    another structure, or NaN.
    """
    lobe, view, work, conics, gauss, states = ground
    a, b, first, last, kind_a, kind_b, n, more, step, signature = strip
    x0, x1, reach, span = square.x0, square.x0 + square.size, square.reach, square.span
    crossing, crossings = square.crossing, square.crossings
    base = n * (n - 1) // 2
    for t in range(10):
        out[t] = 0.0
    for t in range(6):
        sums[t] = 0.0
    walls, chart, roots, ends, ids = work.walls, work.chart, work.quartic, work.root_x, work.root_id
    rows, lit, side = work.nodes, work.lit, work.cell_side
    m, placed, pieces, metal = 0, 0, 0, is_metal(view, chart)
    for q in range(n):
        y, slope = rooted_azimuth(gauss[0, base + q], a, b, first, last, kind_a, kind_b)
        slope *= gauss[1, base + q]
        pieces, found = row_pieces(y, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
        if found != signature:
            return y
        if metal:
            levels_on_row(y, False, lobe, view, work)
        for piece in range(pieces):
            left, width = work.root_x[piece], work.root_x[piece + 1] - work.root_x[piece]
            if not is_labelled(piece, q == 0, left, width, y, square.size, ground):
                return y
            if side[piece] < 0 or width < 1e-14:
                continue
            soft = view.glows is not None and (
                begins_softly(piece, crossing, conics, work) or begins_softly(piece + 1, crossing, conics, work)
            )
            for i in range(states.shape[0]):
                soft = soft or lit[piece, i] >= PARTLY
            x = span / width
            log_rho = math.log(x + math.sqrt(1.0 + x * x))
            if metal:
                log_rho = piece_log(left, left + width, log_rho, work)
            nx = nodes(step, log_rho) + more
            if soft:
                nx = max(nx + (nx + 1) // 2, nodes(step, SOFT_LOG))
            nx = min(nx, MAX_ORDER)
            if m + nx > NODES:
                add_pieces(m, placed, base, step, reach, lobe, view, work, gauss, sums, out)
                m = placed = 0
            start = nx * (nx - 1) // 2
            work.counts.evaluations += nx
            row = work.pieces[placed]
            row.cell, row.first, row.count, row.log_rho, row.line = piece, m, nx, log_rho, q
            placed += 1
            for e in range(nx):
                u, along = gauss[0, start + e], width
                if soft:
                    s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
                    u, along = s * s, width * math.pi * s * c
                rows.sine[m] = left + width * u
                rows.cosine[m] = y
                rows.weight[m] = slope * along * gauss[1, start + e]
                m += 1
    if m > 0:
        add_pieces(m, placed, base, step, reach, lobe, view, work, gauss, sums, out)
    x = span / (b - a)
    log_rho = math.log(x + math.sqrt(1.0 + x * x))
    if metal:
        log_rho = sides_log(a, b, kind_a, kind_b, x0, x1, log_rho, lobe, view, work)
    branch = nearest_branch(a - first, b + last, kind_a, kind_b, pieces, crossing, conics, work)
    miss = lines_error(n, sums[2], sums[3], sums[4], sums[5], sums[0], log_rho, branch)
    out[9] = sums[1] + miss
    if moves(miss):
        missed = lines_error(
            n, tangent(sums[2]), tangent(sums[3]), tangent(sums[4]), tangent(sums[5]), tangent(sums[0]), held(log_rho),
            held(branch),
        )  # fmt: skip
        # slopes fall more slowly: beside a tangency they are like one over the root of what it is away
        out[9] = moved(held(out[9]), tangent(sums[1]) + 2.0 * missed)
    return math.nan


@jitable
def cut_square(square: Square, ground: Ground, scratch: Array, out: Array) -> tuple[float, float]:
    """Add the integral of a square some conics cross to ``out`` (9,); its error estimate, and what was not looked at.

    ``out[3:9]`` is under the two shorter tapers. Lines start at the conics' tangencies, at their passages through the
    square's sides and where two conics meet, which is where the order of their roots changes; strips that miss the
    ``room`` are halved.
    """
    work, conics = ground.work, ground.conics
    walls, chart, roots, ends, ids = work.walls, work.chart, work.quartic, work.root_x, work.root_id
    x0, y0, size, step, span, room, bound = (
        square.x0, square.y0, square.size, square.step, square.span, square.room, square.bound,
    )  # fmt: skip
    crossing, crossings = square.crossing, square.crossings
    x1, y1 = x0 + size, y0 + size
    cuts, kinds, point, part = scratch[0], scratch[1], scratch[2], scratch[3]
    stack = scratch[4:]
    n = square_cuts(x0, x1, y0, y1, crossing, crossings, conics, cuts, kinds)
    top, error = push_strips(cuts, kinds, n, size, bound, step, stack)
    strips, unseen = 0, 0.0
    while top > 0:
        top -= 1
        strips += 1
        work.counts.labour += ROW_LABOUR * (2 + crossings)
        row = stack[top]
        a, b, kind_a, kind_b, depth, level = row[0], row[1], row[2], row[3], row[4], int(row[5])
        room_left = top + 2 < stack.shape[0]
        # farther in than rounding moves a cut
        inset = min(0.25 * (b - a), max(1e-9 * (b - a), 1e-15 * (abs(a) + size)))
        pieces, signature = row_pieces(a + inset, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
        _, other = row_pieces(b - inset, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
        x = 0.7 * span / (b - a)
        more, log_rho = level - step, math.log(x + math.sqrt(1.0 + x * x))
        if is_metal(ground.world, work.chart):
            log_rho = sides_log(a, b, kind_a, kind_b, x0, x1, log_rho, ground.lobe, ground.world, work)
        lines = min(MAX_ORDER, max(3 + 2 * more, nodes(level, log_rho)))
        foreign = b - inset
        if other == signature:
            below, above = roots_beyond(a, b, size, crossing, crossings, conics)
            first, begin = (below, ROOT) if kind_a == SMOOTH and below < math.inf else (0.0, kind_a)
            last, end = (above, ROOT) if kind_b == SMOOTH and above < math.inf else (0.0, kind_b)
            strip = Strip(a, b, first, last, begin, end, lines, more, level, signature)
            foreign = strip_integral(strip, square, ground, point, part)
        if foreign == foreign:
            holds = held(bound * (b - a) / size)
            if b - a < THIN * size:
                # nothing of its own, or walls that rounding moves about: all it can hold is its error
                middle = 0.5 * (a + b)
                _, within = row_pieces(middle, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
                strip = Strip(a, b, 0.0, 0.0, SMOOTH, SMOOTH, 1, 0, step, within)
                strip_integral(strip, square, ground, point, part)
                for t in range(9):
                    out[t] += part[t]
                error += holds + sliver_error(a, b, size, bound)
                continue
            if not room_left or strips > MAX_STRIPS or is_spent(work):
                error += holds
                unseen += holds
                continue
            cut = change_between(a + inset, foreign, signature, square, ground)
            beyond, _ = row_pieces(b - inset, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
            # two conics that meet change places; an edge of a penumbra may open a piece like a square root
            kind = SMOOTH if beyond == pieces else ROOT
        else:
            finer = level < min(step + MORE_LEVELS, len(LEVELS) - 1) and lines < MAX_LINES
            ends_here = not (finer or depth < MAX_HALVINGS)
            if felt(part[9], work) <= room or ends_here or not room_left or strips > MAX_STRIPS or is_spent(work):
                for t in range(9):
                    out[t] += part[t]
                error += part[9]
                continue
            if finer:
                row[5] = level + 1
                top += 1
                continue
            cut, kind, depth, level = 0.5 * (a + b), SMOOTH, depth + 1.0, step
        low, high = stack[top], stack[top + 1]
        low[0], low[1], low[2], low[3], low[4], low[5] = a, cut, kind_a, kind, depth, level
        high[0], high[1], high[2], high[3], high[4], high[5] = cut, b, kind, kind_b, depth, level
        top += 2
    return error, unseen
