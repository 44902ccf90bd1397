"""Lines y = const through a square of the checkered floor: where conics cut them, where that changes, and strips."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.records import Chart, Wall
from symrender.chambers.work import Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.floor_conics import TANGENT, conic_roots, touched_lines
from symrender.quadrature.panel_maps import ellipse_sum
from symrender.quadrature.records import Conic

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ONE_HEIGHT = 1e-13
"""Difference of two heights, in squares, up to which they are one."""
BRANCHES = 16
"""Most roots of one conic on a line."""


@jitable
def row_pieces(
    y: float, x0: float, x1: float, crossing: Array, crossings: int, conics: Table[Conic], walls: Table[Wall], chart:
    Chart, roots: Array, ends: Array, ids: Ints,
) -> tuple[int, int]:  # fmt: skip
    """Pieces of the line y = const between x0 and x1; their number and the signature of their order.

    ``ends`` gets their ends, one more than pieces, ``ids`` the wall at the lower end of each; ``roots`` is scratch.
    """
    n = 1
    ends[0], ids[0] = x0, -1
    for i in range(crossings):
        found = conic_roots(conics[int(crossing[i])], y, x0, x1, walls, chart, roots)
        for j in range(found):
            x = roots[j]
            if x0 < x < x1 and n < ends.shape[0] - 1:
                p = n
                while p > 0 and ends[p - 1] > x:
                    ends[p], ids[p] = ends[p - 1], ids[p - 1]
                    p -= 1
                ends[p], ids[p] = x, BRANCHES * i + j
                n += 1
    ends[n], ids[n] = x1, -1
    signature = n
    for i in range(1, n):
        signature = (signature * 1000003) ^ ids[i]
    return n, signature


@inlined
def root_named(name: int, n: int, work: Work) -> float:
    """Where the root of this name lies on the row at hand, of ``n`` pieces, or NaN."""
    for i in range(1, n):
        if work.root_id[i] == name:
            return float(work.root_x[i])
    return math.nan


@inlined
def note_gaps(many: int, n: int, gaps: Array, work: Work) -> None:
    """The gaps between neighbours of the lower row, whose names are noted, on the row at hand, of ``n`` pieces."""
    x = root_named(work.row_names[1], n, work)
    for i in range(1, many - 1):
        beyond = root_named(work.row_names[i + 1], n, work)
        gaps[i] = beyond - x
        x = beyond


@inlined
def change_of_rows(
    low: float, high: float, x0: float, x1: float, crossing: Array, crossings: int, conics: Table[Conic], work: Work
) -> float:  # fmt: skip
    """The y between ``low`` and ``high``, whose rows differ in structure, where the structure of ``low`` ends.

    Neighbours that change places are followed until the first two of them meet; anything else is found by halving.
    """
    walls, chart, roots, ends, ids = work.walls, work.chart, work.quartic, work.root_x, work.root_id
    near, far = work.row_gaps[0], work.row_gaps[1]
    many, before = row_pieces(low, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
    for i in range(1, many):
        work.row_names[i] = work.root_id[i]
    note_gaps(many, many, near, work)
    n, _ = row_pieces(high, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
    note_gaps(many, n, far, work)
    # as in the Illinois method, an end that stays twice counts half
    weight, kept = 1.0, 0
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high or high - low < 1e-13 * (abs(low) + abs(high) + x1 - x0):
            return held(middle)
        share = 1.0
        for i in range(1, many - 1):
            if far[i] < 0.0 < near[i]:
                share = min(share, near[i] / (near[i] - weight * far[i]))
        if share < 1.0:
            middle = low + min(0.999, max(0.001, share)) * (high - low)
        n, found = row_pieces(middle, x0, x1, crossing, crossings, conics, walls, chart, roots, ends, ids)
        if found == before:
            low = middle
            note_gaps(many, n, near, work)
            weight = 0.5 * weight if kept > 0 else 1.0
            kept = 1
        else:
            high = middle
            note_gaps(many, n, far, work)
            weight = 2.0 * weight if kept < 0 else 1.0
            kept = -1


@inlined
def nearest_branch(
    a: float, b: float, kind_a: float, kind_b: float, pieces: int, crossing: Array, conics: Table[Conic], work: Work
) -> float:  # fmt: skip
    """log rho of a strip a..b by the places, real or not, where the conics on the row at hand touch lines y = const.

    There the two roots of a conic meet, and the ends of pieces move like a square root: just outside of the square too,
    where it is no cut.
    """
    best = math.inf
    for piece in range(1, pieces):
        owner = int(work.root_id[piece]) // BRANCHES
        row = conics[int(crossing[owner])]
        square = row.xy * row.xy - row.xx * row.yy
        half, free = row.xy * row.x - row.xx * row.y, row.x * row.x - row.xx * row.free
        if row.soft > 0.0 or (square == 0.0 and half == 0.0):
            continue
        if square == 0.0:
            # a parabola touches one of them
            half, free = 0.5 * free / half, (0.5 * free / half) ** 2
        else:
            half, free = half / square, free / square
        inner = half * half - free
        root = math.sqrt(abs(inner))
        for way in range(2):
            y, depth = -half, root
            if inner >= 0.0:
                y, depth = -half + (root if way == 0 else -root), 0.0
                if a - 1e-9 * (b - a) < y < b + 1e-9 * (b - a):
                    # where the map begins, or the conic leaves the square before it
                    continue
            best = min(best, ellipse_sum(y, depth, a, b, kind_a, kind_b))
    return math.log(best + math.sqrt(max(0.0, best * best - 1.0))) if best < math.inf else math.inf


@jitable
def roots_beyond(
    a: float, b: float, size: float, crossing: Array, crossings: int, conics: Table[Conic]
) -> tuple[float, float]:  # fmt: skip
    """How far below a and above b the nearest conic touches y = const; infinite where farther than b is from a.

    What rounding may put inside of a strip in a square of this ``size`` is at its end.

    There the ends of pieces move like a square root: a conic that leaves the square just before it touches such a line
    makes no cut there.
    """
    slack = min(ONE_HEIGHT * held(size), 0.25 * held(b - a))
    below, above = math.inf, math.inf
    for i in range(crossings):
        row = conics[int(crossing[i])]
        if row.soft > 0.0:
            continue
        found, one, other = touched_lines(row)
        for j in range(found):
            y = held(one if j == 0 else other)
            if y < held(a) + slack:
                below = min(below, max(0.0, held(a) - y))
            if y > held(b) - slack:
                above = min(above, max(0.0, y - held(b)))
    length = held(b) - held(a)
    return below if below <= length else math.inf, above if above <= length else math.inf


@inlined
def push_strips(
    cuts: Array, kinds: Array, n: int, size: float, bound: float, step: int, stack: Array
) -> tuple[int, float]:  # fmt: skip
    """Put the strips between ``n`` cuts of a square on the empty ``stack``; their number, and the error of that.

    Cuts of one height are one. A strip between them would hold nothing, but its ends move apart, and so would those of
    its neighbours if it were left out: they share one end instead. A root that begins there begins elsewhere by as
    much, which tangents alone feel.
    """
    top, error = 0, 0.0
    low, kind = cuts[0], SMOOTH
    for i in range(1, n):
        here = ROOT if kinds[i] == TANGENT else SMOOTH
        if cuts[i] - low <= ONE_HEIGHT * size or top == stack.shape[0]:
            kind = max(kind, here)
            if top > 0:
                stack[top - 1, 3] = max(stack[top - 1, 3], here)
                if i == n - 1:
                    stack[top - 1, 1] = cuts[i]
            if kind == ROOT:
                error = error + sliver_error(low, cuts[i], size, bound)
            continue
        row = stack[top]
        row[0], row[1], row[2], row[3], row[4], row[5] = low, cuts[i], kind, here, 0.0, step
        top += 1
        low, kind = cuts[i], here
    return top, error


@inlined
def sliver_error(a: float, b: float, size: float, bound: float) -> float:
    """What the derivative of a thin strip a..b of a square may be besides that its ends move, as a tangent of 0.

    Pieces that open there like a root of the distance hold so much of it.
    """
    if moves(a):
        pace = abs(tangent(a)) + abs(tangent(b))
        thin = max(held(b - a) / held(size), 1e-15)
        return moved(0.0, held(bound) * pace / held(size) * math.sqrt(thin))
    return 0.0
