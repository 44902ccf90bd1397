"""Walls that are scan lines: a great circle through the pole of the chart, seen by symmetry.

Such a wall makes the line integral jump as a function of azimuth. It moves sideways, which is one integral along it.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.node import log_density, radiance, set_view
from symrender.adjoint.records import Place
from symrender.adjoint.sums import clear, clear_columns
from symrender.adjoint.walls import ONE_SIDED, chart_place, condition_of, on_a_parallel, pull_back, wall_gradient
from symrender.adjoint.work import Charted
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import scan_line
from symrender.chambers.records import Chart
from symrender.chambers.walls import DIRECTION, FLOOR_CUT, NORMAL, TEXTURE_EDGE
from symrender.jit.marks import jitable
from symrender.quadrature.gauss import LEVELS, MAX_ORDER

Array = npt.NDArray[np.float64]

SIDEWAYS = len(LEVELS) - 2
"""Step of the orders along a wall that is a scan line."""
RADIAL = 1e-12
"""A circle whose axis and level lie closer to the pole's great circles than this is one of them."""


@jitable
def radial_walls(scratch: Array, on: Charted, adjoint: Array) -> bool:
    """The adjoint (4, columns) of walls that are scan lines; whether there are any."""
    view, work = on.world, on.work
    clear(adjoint)
    found = False
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        kind = row.kind
        if kind not in (NORMAL, DIRECTION) or abs(row.axis[0]) > RADIAL or abs(row.cos) > RADIAL:
            continue
        middle = math.atan2(row.axis[2], row.axis[1])
        for half in range(2):
            phi = middle + (0.5 if half else -0.5) * math.pi
            for side in range(2):
                # the wall's own line is approached from both sides
                near = phi + (1e-10 if side else -1e-10)
                if scan_line(near, view, work, scratch) != 0:
                    found = True
                    _sideways(i, near, -1.0 if side else 1.0, on, adjoint)
    return found


@jitable
def _sideways(i: int, phi: float, sign: float, on: Charted, adjoint: Array) -> None:
    """Add sign x the scanned line's integral of F times how wall ``i`` moves across the line."""
    view, work, gauss, here, own = on.world, on.work, on.gauss, on.tangent.here, on.tangent.own
    chart = work.chart
    c, s = math.cos(phi), math.sin(phi)
    bar = here.bar
    n = MAX_ORDER
    base = n * (n - 1) // 2
    for cell in range(work.counts.cells):
        if work.cell_side[cell] == HIDDEN:
            continue
        a, length = work.cell_from[cell], work.cell_to[cell] - work.cell_from[cell]
        for q in range(n):
            x = a + length * gauss[0, base + q]
            measure, _ = chart_place(x, c, s, chart, here)
            density = log_density(here, on.lobe, chart)[2]
            set_view(here, view, chart)
            radiance(work.cell_side[cell], work.lit[cell], SIDEWAYS, on, here.above)
            tag = condition_of(i, here, True, view, work)
            if tag < 0:
                for column in range(adjoint.shape[1]):
                    adjoint[ONE_SIDED, column] = 1.0
                continue
            w = -sign * gauss[1, base + q] * length * measure * density
            j = chart.shape_index
            beside = j >= 0 and work.walls[i].tag > FLOOR_CUT and on_a_parallel(here, view.spheres[j])
            for which in range(2 if beside else 1):
                # beside the wall lies a field of another colour: from the other side the derivative is another one
                condition = TEXTURE_EDGE if which else tag
                clear_columns(own)
                wall_gradient(i, condition, here, view, work, bar, own)
                across = _across(bar, here, c, s, chart)
                pull_back(1.0, bar, here, j < 0, own)
                for channel in range(4):
                    rate = w / across * here.above[channel % 3]
                    if channel == ONE_SIDED:
                        rate = (rate if which == 0 else -rate) if beside else 0.0
                    elif which == 1:
                        continue
                    for k in range(own.shape[0]):
                        adjoint[channel, k] += rate * own[k]


@jitable
def _across(bar: Array, here: Place, c: float, s: float, chart: Chart) -> float:
    """Slope in phi of a function of gradients ``bar``: phi turns Q - P, N and w about the pole."""
    slope = 0.0
    for row in range(3):
        x, y, z = here.at[row, 0], here.at[row, 1], here.at[row, 2]
        px, py, pz = chart.pole[0], chart.pole[1], chart.pole[2]
        slope += bar[row, 0] * (py * z - pz * y) + bar[row, 1] * (pz * x - px * z) + bar[row, 2] * (px * y - py * x)
    return slope
