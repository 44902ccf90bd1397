"""Functions of the program that filter the checker of a floor or plane over a pixel."""

from __future__ import annotations

import sympy as sp

from symrender.expression import footprint
from symrender.kernel.block import Block, real
from symrender.kernel.program import Function
from symrender.kernel.shade import SQUARES
from symrender.limits import MAX_FOOTPRINT_LINES

CELL, *OFFSET = SQUARES
_RESOLVED = 2**52
"""Farthest from the origin, in cells, that a double still tells one cell from the next."""


def _leave_share(block: Block, mean: sp.Expr) -> None:
    """Leave with (1 + mean)/2, kept in [0, 1] where rounding would leave it: no albedo may be negative."""
    share = block.let("share", (1 + mean) / 2)
    with block.when(share < 0):
        block.leave(sp.Integer(0))
    with block.when(share > 1):
        block.leave(sp.Integer(1))
    block.leave(share)


def _leave_mean_beyond_resolution(block: Block, x: sp.Expr, y: sp.Expr) -> None:
    """Leave with 1/2 where the cell a point lies in is lost to rounding, and its number to any integer."""
    for k, value in enumerate((x, y)):
        with block.when(sp.Abs(value - OFFSET[k]) > _RESOLVED * CELL):
            block.leave(sp.Rational(1, 2))


def box_share() -> Function:
    """Bright share of an axis-aligned rectangle of the floor: exact, and exact for every pixel of a plane camera."""
    x, y, width, height = real("x"), real("y"), real("width"), real("height")
    block = Block()
    for side in (-1, 1):
        _leave_mean_beyond_resolution(block, x + side * width, y + side * height)
    across = block.let("across", footprint.interval_mean((x - OFFSET[0]) / CELL, width / CELL))
    along = block.let("along", footprint.interval_mean((y - OFFSET[1]) / CELL, height / CELL))
    _leave_share(block, across * along)
    return Function("box_share", (x, y, width, height, *SQUARES), block.statements, "bright share of a floor rectangle")


def edge_share() -> Function:
    """Part of one straight edge, in cell coordinates, in the integral of the checker's sign over a polygon.

    The edge is cut where it meets a checker line; the caller has made sure that these are not too many.
    """
    a0, b0, a1, b1 = (real(name) for name in ("a_0", "b_0", "a_1", "b_1"))
    block = Block()
    run, rise = block.lets({"run": a1 - a0, "rise": b1 - b0})
    lines_a = block.count("lines_a", sp.Abs(sp.floor(a1) - sp.floor(a0)))
    lines_b = block.count("lines_b", sp.Abs(sp.floor(b1) - sp.floor(b0)))
    total, done = block.let("total", sp.Integer(0)), block.let("done", sp.Integer(0))
    next_a, next_b = block.let("next_a", sp.Integer(2)), block.let("next_b", sp.Integer(2))
    step_a, step_b = block.let("step_a", sp.Integer(0)), block.let("step_b", sp.Integer(0))
    for slope, start, following, step in ((run, a0, next_a, step_a), (rise, b0, next_b, step_b)):
        with block.when(slope > 0):
            block.set(following, (sp.floor(start) + 1 - start) / slope)
            block.set(step, 1 / slope)
        with block.when(slope < 0):
            block.set(following, (sp.floor(start) - start) / slope)
            block.set(step, -1 / slope)
    with block.loop("piece", lines_a + lines_b + 3):
        stop = block.let("stop", sp.Min(1, next_a, next_b))
        middle = block.let("middle", (done + stop) / 2)
        value = footprint.edge_integral(a0 + run * middle, b0 + rise * done, b0 + rise * stop, run * (stop - done))
        block.set(total, block.let("more", total + value))
        block.set(done, stop)
        with block.when(stop >= 1):
            block.leave(total)
        with block.when(next_a <= stop):
            block.set(next_a, next_a + step_a)
        with block.when(next_b <= stop):
            block.set(next_b, next_b + step_b)
    block.leave(total)
    return Function("edge_share", (a0, b0, a1, b1), block.statements, "one edge's part of the integral of the sign")


def quad_share() -> Function:
    """Bright share of a convex quadrilateral of the floor, exact in floor area up to ``MAX_FOOTPRINT_LINES``.

    Where its contour crosses more lines the share is 1/2. The integral of the sign is at most half the contour's
    length, so the mean dropped is at most length/(2 area), in cells.
    """
    corners = [real(f"{axis}_{k}") for k in range(4) for axis in "xy"]
    block = Block()
    for k in range(4):
        _leave_mean_beyond_resolution(block, corners[2 * k], corners[2 * k + 1])
    # in cells, from an even grid point near the first corner: the pattern is the same and no digits are lost
    base = [
        block.let(f"base_{axis}", 2 * sp.floor((corners[k] - OFFSET[k]) / (2 * CELL))) for k, axis in enumerate("ab")
    ]
    scaled = [
        block.let(f"{'ab'[k % 2]}_{k // 2}", (value - OFFSET[k % 2]) / CELL - base[k % 2])
        for k, value in enumerate(corners)
    ]
    apart = [block.let(f"{'uv'[k % 2]}_{k // 2}", value - scaled[k % 2]) for k, value in enumerate(scaled)]
    edges = [(*scaled[2 * k : 2 * k + 2], *scaled[2 * ((k + 1) % 4) : 2 * ((k + 1) % 4) + 2]) for k in range(4)]
    crossed = [sp.Abs(sp.floor(e[k]) - sp.floor(e[k + 2])) + 1 for e in edges for k in (0, 1)]
    lines = block.let("lines", sum(crossed))
    turns = [apart[2 * k] * apart[2 * k + 3] - apart[2 * k + 2] * apart[2 * k + 1] for k in (1, 2)]
    area = block.let("area", sum(turns) / 2)
    with block.when(sp.Or(lines > MAX_FOOTPRINT_LINES, sp.Eq(area, 0))):
        block.leave(sp.Rational(1, 2))
    parts = [block.call("edge_share", edge, f"part_{k}")[0] for k, edge in enumerate(edges)]
    _leave_share(block, sum(parts) / area)
    return Function(
        "quad_share", (*corners, *SQUARES), block.statements, "bright share of a convex floor quadrilateral"
    )
