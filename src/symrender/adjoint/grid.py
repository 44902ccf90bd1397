"""The derivative of the checkered floor in a lobe: squares carried along, conics moving across them.

The squares are fixed to the checker, not to the point, so nothing of it moves unless its cell or offset does; then the
nodes ride with it, Q = offset + cell (i, j), and areas grow by (cell)^2 (``floor_node.py``). All other walls are conics
(``conic_slopes.py``), and their roots on a line y = const move by the implicit function theorem as on a scan line
(``square.py``). Here blocks of squares are gone through, under tapers of growing reach.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.conic_slopes import level_adjoint, moving_conics, name_conics
from symrender.adjoint.floor_node import grid_node
from symrender.adjoint.lobe import steepness
from symrender.adjoint.square import Block, square_adjoint
from symrender.adjoint.sums import add, clear, contract, largest_change, largest_channel, put
from symrender.adjoint.walls import BRIGHT, DARK
from symrender.adjoint.work import Charted, GridWork
from symrender.chambers.work import View
from symrender.jit.marks import inlined, jitable
from symrender.leaves.values import floor_phases
from symrender.quadrature.fall_off import most_floor_light
from symrender.quadrature.floor_conics import floor_conics, may_cross
from symrender.quadrature.gauss import step_of
from symrender.quadrature.grid_blocks import block_bound, block_level, block_sign, push_quarters
from symrender.quadrature.grid_tail import REST, remainders_of
from symrender.quadrature.split_grid import LEAVES, MAX_BLOCK_ORDER, SMALLEST, grid_reach
from symrender.quadrature.square_nodes import seen, taper

Array = npt.NDArray[np.float64]

REPLAY_REACH = 12.0
"""Squares from the foot of a point whose lobe holds endless squares, at first."""
MOST_REPLAY_REACH = 500.0
"""The farthest reach; one more doubling than values need shows that they changed no more."""


class Squares(NamedTuple):
    """2^level squares a side from (x, y) on, from the foot, under a taper of this ``reach``; the sign of the first."""

    x: float
    y: float
    level: int
    reach: float
    sign: float


@inlined
def contrast_of(view: View) -> float:
    """Half the contrast of the checker times kd: the largest channel."""
    most = 0.0
    for a in range(3):
        most = max(most, abs(view.floor.bright[a] - view.floor.dark[a]))
    return 0.5 * abs(view.shading.kd) * most


@inlined
def ran_out(max_evaluations: int, on: Charted) -> bool:
    """Whether no more evaluations are left."""
    return bool(max(on.work.counts.evaluations, on.work.counts.labour) > max_evaluations)


@inlined
def is_crossed(x: float, y: float, half: float, count: int, grid: GridWork) -> bool:
    """Whether some conic that moves may cross the square of this half side about (x, y)."""
    moved = False
    for k in range(count):
        moved = moved or (grid.origins[k].moves != 0 and may_cross(grid.conics[k], x, y, half))
    return moved


@inlined
def list_crossings(x: float, y: float, half: float, level: int, count: int, grid: GridWork) -> int:
    """Note the conics that may cross a square, of a larger block one of them; their number."""
    crossings = 0
    for k in range(count):
        if may_cross(grid.conics[k], x, y, half) and crossings < grid.crossing.shape[0]:
            grid.crossing[crossings] = k
            crossings += 1
            if level > 0:
                break
    return crossings


@inlined
def smooth_adjoint(block: Block, n: int, on: Charted, grid: GridWork) -> None:
    """Add the derivatives of a block that no conic crosses to ``square``, by n x n nodes."""
    gauss, adjoint, side = on.gauss, on.tangent.sums[0], block.side
    base = n * (n - 1) // 2
    weights = gauss[1] if block.level == 0 else gauss[3 + block.level]
    on.work.counts.evaluations += n * n
    clear(adjoint)
    for q in range(n):
        y = block.y + side * gauss[0, base + q]
        for e in range(n):
            x = block.x + side * gauss[0, base + e]
            w = block.sign * weights[base + q] * weights[base + e] * side * side
            w *= taper(math.hypot(x, y), block.reach)
            grid_node(x, y, w, block.step, on, grid, adjoint)
    contract(adjoint, on.moves, on.tangent.square)


@inlined
def block_adjoint(
    block: Block, bound: float, fall: float, share: float, on: Charted, grid: GridWork
) -> tuple[float, bool]:  # fmt: skip
    """The derivatives of a block into ``square``: their error, and whether it must be quartered instead.

    ``fall`` is how many times smaller than its ``bound`` it is wanted, as a logarithm.
    """
    level, square = block.level, on.tangent.square
    clear(square)
    if block.crossings > 0:
        if level > 0:
            return 0.0, True
        return square_adjoint(block, share, on, grid), False
    middle = 0.5 * block.side
    if not seen(block.x + middle, block.y + middle, on.lobe, on.world, on.work, grid.above):
        return 0.0, False
    n = 1 + max(2, math.ceil((0.5 * fall if level == 0 else fall - 0.693 * level) / block.log_rho))
    if n > MAX_BLOCK_ORDER:
        return 0.0, True
    smooth_adjoint(block, n, on, grid)
    if level == 0:
        return largest_channel(square) * math.exp(-2.0 * (n - 1) * block.log_rho), False
    return 10.0 * contrast_of(on.world) * bound * 2.0**-level * math.exp(-n * block.log_rho), False


@jitable
def replay_once(
    tol: float, squares: Squares, count: int, max_evaluations: int, on: Charted, grid: GridWork
) -> float:  # fmt: skip
    """The derivatives under one taper, into ``longer``; their error estimate.

    The blocks are those of ``split_grid``; how fine a block's rule must be is judged by what the block can hold.
    """
    view, work, blocks, reach = on.world, on.work, grid.blocks, squares.reach
    cell, contrast, light = view.floor.cell, contrast_of(view), most_floor_light(view)
    for a in range(3):
        grid.half[a] = 0.5 * view.shading.kd * (view.floor.bright[a] - view.floor.dark[a])
    aim = 0.1 * tol / max(contrast, 1e-300) / LEAVES
    error = 0.0
    clear(on.tangent.longer)
    blocks[0, 0], blocks[0, 1] = squares.x, squares.y
    blocks[0, 2], blocks[0, 3] = cell * 2.0**squares.level, squares.level
    top = 1
    while top > 0:
        top -= 1
        x, y, side, level = blocks[top, 0], blocks[top, 1], blocks[top, 2], int(blocks[top, 3])
        bound, span, near = block_bound(x, y, side, reach, light, on.lobe, view, work.chart)
        work.counts.labour += 1
        if bound <= 0.01 * aim / (1.0 + near / cell) or ran_out(max_evaluations, on):
            # a derivative may be larger than what is differentiated, by the inverse of its lengths
            error += 100.0 * contrast * bound
            continue
        half = 0.5 * side
        if not on.nodes and not is_crossed(x + half, y + half, half, count, grid):
            continue
        ratio = span / side
        quarter = ratio < 0.8
        if not quarter:
            log_rho = math.log(ratio + math.sqrt(1.0 + ratio * ratio))
            crossings = list_crossings(x + half, y + half, half, level, count, grid)
            fall = max(1.0, math.log(bound / aim))
            sign = squares.sign * block_sign(x - squares.x, y - squares.y, side, view.floor)
            block = Block(x, y, side, level, sign, step_of(fall), log_rho, reach, crossings)
            missed, quarter = block_adjoint(block, bound, fall, 0.5 * tol / LEAVES, on, grid)
            error += missed
        if quarter:
            if side < SMALLEST * cell or top + 4 > blocks.shape[0]:
                error += 100.0 * contrast * bound
                continue
            top = push_quarters(x, y, side, level, blocks, top)
            continue
        add(on.tangent.square, on.tangent.longer)
    return error


@jitable
def tail_slopes(n: int, on: Charted, grid: GridWork) -> float:
    """Estimate of what ``n`` places beyond the taper leave of the derivatives: the largest of all parameters.

    What a place holds changes by ``swing`` for every unit by which a wall moves across the checker there.
    """
    moves, own, bar = on.moves, on.tangent.own, grid.bar
    largest, contrast = 0.0, contrast_of(on.world)
    for p in range(moves.shape[0]):
        tint, other = 0.0, 0.0
        for k in range(moves.shape[1]):
            if BRIGHT <= k < DARK + 3:
                tint = max(tint, abs(moves[p, k]))
            else:
                other = max(other, abs(moves[p, k]))
        total = 0.0
        for k in range(n):
            row = grid.remainders[k]
            # of the two colours the value is linear
            total += 0.5 * abs(on.world.shading.kd) * tint * row.left / max(contrast, 1e-300)
            if on.nodes and other > 0.0:
                # slopes in places and exponents are larger than what they are of
                total += row.left * steepness(10.0, on.work.chart.lobe)
            if row.wall < 0:
                # a light's spot, which no wall moves
                total += row.swing * other
            for end in range(2):
                at = row.wall if end == 0 else row.other
                if at < 0 or grid.origins[at].moves == 0:
                    continue
                level_adjoint(grid.origins[at], row.x, row.y, on, bar)
                moved = 0.0
                for c in range(own.shape[0]):
                    moved += own[c] * moves[p, c]
                total += row.swing * abs(moved) / max(math.sqrt(bar[0] * bar[0] + bar[1] * bar[1]), 1e-300)
        largest = max(largest, total)
    return REST * contrast * largest


@jitable
def tail_at(tol: float, reach: float, count: int, on: Charted, grid: GridWork) -> float:
    """Estimate of what no taper of this reach has seen of the derivatives."""
    aim = 0.1 * min(1.0, on.world.floor.cell) * tol / max(contrast_of(on.world), 1e-300)
    n = remainders_of(
        aim, reach, on.lobe, on.world, on.work, grid.conics, count, grid.above, grid.blocks[:8], grid.remainders
    )  # fmt: skip
    return tail_slopes(n, on, grid)


@jitable
def replay_grid(tol: float, own: int, max_evaluations: int, on: Charted, grid: GridWork) -> float:
    """Add the derivatives of what the checker adds to a floor of mean albedo to ``value``; their error estimate.

    The chart is the floor's, the point lies on shape ``own``. Where the squares are endless the taper's reach is
    doubled until the derivatives no longer change, and what no taper has seen is small: walls that move far out fall
    off more slowly than the value does.
    """
    view, work, t = on.world, on.work, on.tangent
    chart, floor, cell = work.chart, view.floor, view.floor.cell
    count = floor_conics(own, on.lobe, view, work, grid.conics)
    if count > grid.conics.shape[0]:
        return math.inf
    name_conics(view, work, grid.origins)
    if not moving_conics(count, on, grid.origins) and not on.nodes:
        return 0.0
    px, py = chart.point[0] - floor.offset[0], chart.point[1] - floor.offset[1]
    whole, reach, far, east, north, beyond = grid_reach(REPLAY_REACH, on.lobe, view, work)
    across, down = floor_phases(px + east, py + north, cell, 0.0, 0.0)
    ci, cj = math.floor(across), math.floor(down)
    lowest = 1.0 if (ci + cj) % 2 == 0 else -1.0
    passes, before = 0, math.inf
    while True:
        level = block_level(far / cell)
        first = 2.0 ** (level - 1)
        squares = Squares((ci - first) * cell - px, (cj - first) * cell - py, level, reach, lowest)
        error = replay_once(tol, squares, count, max_evaluations, on, grid)
        change = 0.0 if whole else math.inf
        if passes > 0:
            change = 3.0 * largest_change(t.longer, t.shorter)
        if not whole:
            change += tail_at(tol, reach, count, on, grid)
        spent = ran_out(max_evaluations, on)
        if spent and error + change > before:
            # what the last reach gave stands
            error, change = before, 0.0
            put(t.shorter, t.longer)
            break
        if whole or spent or error + change <= tol:
            break
        if passes > 0 and (1.5 * far > MOST_REPLAY_REACH * cell or error >= change):
            break
        put(t.longer, t.shorter)
        passes, before = passes + 1, error + change
        reach = far = min(2.0 * reach, max(reach, MOST_REPLAY_REACH * cell))
    add(t.longer, t.value)
    # slopes in places and exponents are larger than what they are of
    return float(error + change + beyond * steepness(10.0, chart.lobe))
