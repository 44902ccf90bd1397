"""Walls that are scan lines, and move: great circles through the pole of a chart, seen by symmetry.

Such a wall makes the line integral jump as a function of azimuth, where panels end. They end at one azimuth, and move
with it as the circle turns about the pole; where the circle leaves the pole, places of the wall move differently. What
they sweep beside the panels' ends is one integral along the wall on either side.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.line import scan_line
from symrender.chambers.records import Wall
from symrender.chambers.walls import DIRECTION, NORMAL
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import is_moving, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.records import Panel
from symrender.quadrature.split_line import integrate_cells

Array = npt.NDArray[np.float64]

STEP = len(LEVELS) - 2
"""Step of the orders along a wall."""
RADIAL = 1e-12
"""A circle whose axis and level lie closer to the pole's great circles than this is one of them."""
ENDS = 1e-8
"""How far from it ends of panels are taken to lie on it."""
BESIDE = 1e-10
"""How far from the wall its sides are looked at."""


@inlined
def is_radial(row: Wall) -> bool:
    """Whether a wall is a scan line, and does not just turn about the pole."""
    if row.kind not in (NORMAL, DIRECTION) or abs(row.axis[0]) > RADIAL or abs(row.cos) > RADIAL:
        return False
    return row.parted != 0 or is_moving(row.axis[0]) or is_moving(row.cos)


@jitable
def sweep_radial_walls(
    panels: Table[Panel], n: int, view: View, work: Work, gauss: Array, scratch: Array, value: Array
) -> None:  # fmt: skip
    """Add what walls that are scan lines sweep to the tangents of ``value``, and note those that part from others.

    The first ``n`` of ``panels`` end there at speeds of their own.
    """
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        if not moves(row.cos) or not is_radial(row):
            continue
        middle = math.atan2(row.axis[2], row.axis[1])
        for half in range(2):
            # a line that stands still
            phi = middle - moved(0.0, tangent(middle)) + (0.5 if half == 1 else -0.5) * math.pi
            for side in range(2):
                near = phi + (BESIDE if side == 1 else -BESIDE)
                if scan_line(near, view, work, scratch) == 0:
                    continue
                work.counts.parted |= row.parted
                sign = 1.0 if side == 0 else -1.0
                sweep_side(near, i, sign, panel_end(phi, 1 - side, panels, n), view, work, gauss, value)
    work.chart.swept = 0


@inlined
def panel_end(phi: float, end: int, panels: Table[Panel], n: int) -> float:
    """The end of a panel at an azimuth, the first (0) or the last (1) of it, and as it moves."""
    found = 0.0 * phi
    for k in range(n):
        away = panels[k].ends[end] - phi
        away -= 2.0 * math.pi * math.floor(away / (2.0 * math.pi) + 0.5)
        if abs(away) < ENDS and panels[k].ends[1] - panels[k].ends[0] > ENDS:
            found = panels[k].ends[end]
    return found


@inlined
def sweep_side(
    phi: float, wall: int, sign: float, end: float, view: View, work: Work, gauss: Array, value: Array
) -> None:  # fmt: skip
    """Add ``sign`` times the scanned line's integral, weighed by how fast the wall moves across it."""
    chart, line = work.chart, work.notes.line
    chart.swept, chart.swept_end = wall + 1, end
    # all else that moves along the line is the same twice
    for turn in range(2):
        chart.swept_sign = sign if turn == 0 else -sign
        integrate_cells(phi, STEP, view, work, gauss, line)
        for a in range(3):
            part = 0.5 * tangent(line[a])
            value[a] += moved(0.0, part if turn == 0 else -part)
    chart.swept = 0
