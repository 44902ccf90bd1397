"""The adjoint of a square that conics cross: lines y = const, whose roots move by the implicit function theorem.

Lines are integrated between the y at which the walls met along them change, found by bisection where no closed form
gives them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.conic_slopes import level_adjoint
from symrender.adjoint.floor_node import grid_density, grid_node, lit_sum
from symrender.adjoint.records import Strip
from symrender.adjoint.sums import add, clear, contract, largest_change
from symrender.adjoint.work import Charted, GridWork
from symrender.chambers.labels import PARTLY
from symrender.chambers.work import Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.floor_conics import conic_roots, square_cuts
from symrender.quadrature.gauss import MAX_ORDER, order
from symrender.quadrature.split_line import SOFT_LOG
from symrender.quadrature.square_nodes import seen, taper

Array = npt.NDArray[np.float64]

MOST_HALVINGS = 10
"""Most halvings of a strip."""


class Block(NamedTuple):
    """2^level x 2^level squares from (x, y) on, from the foot, ``sign`` that of the first; ``crossings`` cross it.

    ``step`` and ``log_rho`` choose the orders; beyond the taper's ``reach`` nothing is looked at.
    """

    x: float
    y: float
    side: float
    level: int
    sign: float
    step: int
    log_rho: float
    reach: float
    crossings: int


class Rows(NamedTuple):
    """Lines y = const of a square from x0 to x1, crossed by ``crossings`` conics.

    ``nodes`` at most on a piece; the integrand is tame over the length ``span``.
    """

    x0: float
    x1: float
    crossings: int
    nodes: int
    step: int
    span: float
    reach: float


@inlined
def row_roots(y: float, rows: Rows, work: Work, grid: GridWork) -> int:
    """Roots of the crossing conics on a line of a square, in order, into ``roots``; their number."""
    roots, which = grid.roots, grid.which
    k = 0
    for i in range(rows.crossings):
        c = int(grid.crossing[i])
        found = conic_roots(grid.conics[c], y, rows.x0, rows.x1, work.walls, work.chart, work.quartic)
        for j in range(found):
            x = work.quartic[j]
            if rows.x0 < x < rows.x1 and k < roots.shape[0] - 1:
                p = k
                while p > 0 and roots[p - 1] > x:
                    roots[p], which[p] = roots[p - 1], which[p - 1]
                    p -= 1
                roots[p], which[p] = x, c
                k += 1
    return k


@jitable
def scan_row(y: float, rows: Rows, on: Charted, grid: GridWork) -> int:
    """A signature of the structure of a square's line."""
    roots, which, below, above = grid.roots, grid.which, grid.below, grid.above
    lights = on.world.points.shape[0]
    k = row_roots(y, rows, on.work, grid)
    signature = 1469598103934665603
    left = rows.x0
    for i in range(k + 1):
        right = rows.x1 if i == k else roots[i]
        if right - left > 1e-14:
            lit = seen(left + 0.5 * (right - left), y, on.lobe, on.world, on.work, above)
            changed = i == 0
            for l in range(lights):
                state = 1.0 + above[l] if lit else 0.0
                if state != below[l]:
                    changed = True
                below[l] = state
            if lights == 0:
                changed = True
            if changed:
                signature = (signature ^ (17 + (which[i - 1] if i > 0 else -1))) * 1099511628211
                for l in range(lights):
                    signature = (signature ^ (3 + int(below[l]))) * 1099511628211
        left = right
    return signature


@inlined
def root_adjoint(
    conic: int, x: float, y: float, weight: float, was_lit: bool, lit: bool, rows: Rows, on: Charted, grid: GridWork,
    adjoint: Array,
) -> None:  # fmt: skip
    """Add the motion of a ``conic``'s root at (x, y); its two sides are lit as ``below`` and ``above`` tell."""
    own = on.tangent.own
    density, _, _ = grid_density(x, y, on.lobe, on.work.chart)
    lit_sum(x, y, rows.step, grid.above, on, grid.here)
    lit_sum(x, y, rows.step, grid.below, on, grid.before)
    jump, bar = grid.jump, grid.bar
    some = False
    for a in range(3):
        jump[a] = grid.half[a] * ((grid.before[a] if was_lit else 0.0) - (grid.here[a] if lit else 0.0))
        some = some or jump[a] != 0.0
    if not some:
        return
    level_adjoint(grid.origins[conic], x, y, on, bar)
    if bar[0] == 0.0:
        return
    scale = -weight * taper(math.hypot(x, y), rows.reach) * density / bar[0]
    for a in range(3):
        for c in range(own.shape[0]):
            adjoint[a, c] += scale * jump[a] * own[c]


@inlined
def stretch_adjoint(
    left: float, right: float, y: float, weight: float, rows: Rows, on: Charted, grid: GridWork, adjoint: Array
) -> None:  # fmt: skip
    """Add the nodes of a lit stretch of a line."""
    gauss, step, lights = on.gauss, rows.step, on.world.points.shape[0]
    width = right - left
    soft = False
    for l in range(lights):
        soft = soft or grid.above[l] >= PARTLY
    n = rows.nodes
    if not soft:
        ratio = rows.span / width
        n = min(n, order(step, math.log(ratio + math.sqrt(1.0 + ratio * ratio))))
    on.work.counts.evaluations += n
    inner = n * (n - 1) // 2
    for e in range(n):
        u, along = gauss[0, inner + e], width
        if soft:
            s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
            u, along = s * s, width * math.pi * s * c
        x = left + width * u
        w = weight * taper(math.hypot(x, y), rows.reach) * along * gauss[1, inner + e]
        grid_node(x, y, w, step, on, grid, adjoint)


@inlined
def row_adjoint(
    y: float, weight: float, found: int, rows: Rows, on: Charted, grid: GridWork, adjoint: Array
) -> None:  # fmt: skip
    """Add weight times the integral of a line with ``found`` roots, differentiated, to the adjoint."""
    below, above = grid.below, grid.above
    left = rows.x0
    was_lit = False
    for i in range(found + 1):
        right = rows.x1 if i == found else grid.roots[i]
        if right - left < 1e-14:
            continue
        lit = seen(left + 0.5 * (right - left), y, on.lobe, on.world, on.work, above)
        # nothing jumps at a penumbra's edge
        moves = i > 0 and grid.origins[grid.which[i - 1]].moves != 0 and grid.conics[grid.which[i - 1]].soft <= 0.0
        if moves and (lit or was_lit):
            root_adjoint(grid.which[i - 1], left, y, weight, was_lit, lit, rows, on, grid, adjoint)
        if lit and on.nodes:
            stretch_adjoint(left, right, y, weight, rows, on, grid, adjoint)
        for l in range(on.world.points.shape[0]):
            below[l] = above[l]
        was_lit = lit
        left = right


@inlined
def push_strip(start: float, stop: float, depth: int, strips: Table[Strip], top: int) -> int:
    """Stack a strip; the new height."""
    row = strips[top]
    row.start, row.stop, row.depth = start, stop, depth
    return top + 1


@jitable
def cut_strips(a: float, b: float, rows: Rows, on: Charted, grid: GridWork, top: int) -> int:
    """Cut a..b where the structure of its lines changes and stack the strips; new height."""
    strips = grid.strips
    inset = 1e-9 * (b - a)
    start = a
    left = a + inset
    before = scan_row(left, rows, on, grid)
    for i in range(1, 5):
        right = b - inset if i == 4 else a + (b - a) * i / 4.0
        after = scan_row(right, rows, on, grid)
        tries = 0
        while after != before and tries < 6:
            tries += 1
            low, high = left, right
            while high - low > 1e-15 * (1.0 + abs(low)):
                middle = 0.5 * (low + high)
                if middle in (low, high):
                    break
                if scan_row(middle, rows, on, grid) == before:
                    low = middle
                else:
                    high = middle
            if top + 1 < strips.shape[0]:
                top = push_strip(start, high, 0, strips, top)
            start = high
            left = high + inset
            if not left < right:
                before = after
                break
            before = scan_row(left, rows, on, grid)
        left, before = right, after
    if top + 1 < strips.shape[0] and start < b:
        top = push_strip(start, b, 0, strips, top)
    return top


@jitable
def strip_adjoint(
    a: float, b: float, n: int, sign: float, rows: Rows, on: Charted, grid: GridWork, out: Array
) -> None:  # fmt: skip
    """The derivatives of a strip by ``n`` lines, with a square-root map at both ends."""
    gauss, adjoint = on.gauss, on.tangent.sums[0]
    clear(adjoint)
    base = n * (n - 1) // 2
    for q in range(n):
        u = gauss[0, base + q]
        s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
        y = a + (b - a) * s * s
        slope = sign * gauss[1, base + q] * (b - a) * math.pi * s * c
        found = row_roots(y, rows, on.work, grid)
        row_adjoint(y, slope, found, rows, on, grid, adjoint)
    clear(out)
    contract(adjoint, on.moves, out)


@inlined
def lines_of(block: Block, grid: GridWork) -> Rows:
    """The lines of a square and the most nodes on a piece of them."""
    nodes = min(MAX_ORDER, order(block.step, block.log_rho))
    for i in range(block.crossings):
        if grid.conics[int(grid.crossing[i])].soft > 0.0:
            nodes = max(nodes, min(MAX_ORDER, order(block.step, SOFT_LOG)))
    # the length over which the integrand is tame
    span = block.side * math.sinh(block.log_rho)
    return Rows(block.x, block.x + block.side, block.crossings, nodes, block.step, span, block.reach)


@jitable
def square_adjoint(block: Block, share: float, on: Charted, grid: GridWork) -> float:
    """Add the derivatives of a square that some conics cross to ``square``; their error estimate."""
    t, cuts, strips = on.tangent, grid.cuts, grid.strips
    rows = lines_of(block, grid)
    stop = block.y + block.side
    k = square_cuts(
        rows.x0, rows.x1, block.y, stop, grid.crossing, block.crossings, grid.conics, cuts, grid.kinds
    )  # fmt: skip
    top = 0
    for i in range(k - 1):
        if cuts[i + 1] - cuts[i] > 1e-13 * block.side:
            top = cut_strips(cuts[i], cuts[i + 1], rows, on, grid, top)
    error = 0.0
    while top > 0:
        top -= 1
        a, b, depth = strips[top].start, strips[top].stop, strips[top].depth
        n = min(MAX_ORDER - 2, max(3, order(block.step, block.log_rho * 0.7)))
        strip_adjoint(a, b, n, block.sign, rows, on, grid, t.low)
        strip_adjoint(a, b, n + 2, block.sign, rows, on, grid, t.high)
        change = largest_change(t.high, t.low)
        if change > share and depth < MOST_HALVINGS and top + 2 < strips.shape[0]:
            middle = 0.5 * (a + b)
            top = push_strip(a, middle, depth + 1, strips, top)
            top = push_strip(middle, b, depth + 1, strips, top)
            continue
        add(t.high, t.square)
        error += change
    return error
