"""How the ends of a scan line's cells move: the second sum of a line's adjoint (``line.py``)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.adjoint.moves import wall_moves
from symrender.adjoint.node import log_density, radiance, set_view
from symrender.adjoint.sums import clear_columns
from symrender.adjoint.walls import (
    CUT_BY,
    ONE_SIDED,
    along_line,
    chart_place,
    condition_of,
    on_a_parallel,
    pull_back,
    rim_gradient,
    wall_gradient,
)
from symrender.adjoint.work import Charted
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import LIMB, POLE_END
from symrender.chambers.lobes.density import rim_density
from symrender.chambers.walls import FLOOR_CUT, HORIZON, TEXTURE_EDGE
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.split_line import disk_edge

Array = npt.NDArray[np.float64]


@jitable
def wall_adjoint(i: int, tag: int, scale: float, on: Charted, adjoint: Array, first: int, last: int) -> None:
    """Add scale x the jump x (how wall ``i``, as of condition ``tag``, moves on the line) to rows first..last - 1.

    The jump is in the place's ``above``. Wall -1 is the lobe's rim.
    """
    here, own = on.tangent.here, on.tangent.own
    bar, jump = here.bar, here.above
    clear_columns(own)
    if i < 0:
        rim_gradient(here, on.work, on.lobe, bar, own)
    else:
        wall_gradient(i, tag, here, on.world, on.work, bar, own)
    slope = along_line(bar, here)
    if slope == 0.0:
        return
    pull_back(1.0, bar, here, on.work.chart.shape_index < 0.0, own)
    for c in range(first, last):
        weight = -scale * jump[c % 3] / slope
        if weight != 0.0:
            for k in range(own.shape[0]):
                adjoint[c, k] += weight * own[k]


@inlined
def jump_at(cell: int, side_above: int, side_below: int, step: int, on: Charted) -> bool:
    """The radiance before the end of a cell less that behind it, into the place's ``above``; whether there is any."""
    work, here = on.work, on.tangent.here
    above, below = here.above, here.below
    work.counts.evaluations += 2
    radiance(side_above, work.lit[min(cell, work.counts.cells - 1)], step, on, above)
    radiance(side_below, work.lit[max(cell - 1, 0)], step, on, below)
    for a in range(3):
        above[a] = below[a] - above[a]
    return bool(above[0] != 0.0 or above[1] != 0.0 or above[2] != 0.0)


@inlined
def end_adjoint(wall: int, hidden: bool, scale: float, on: Charted, adjoint: Array) -> None:
    """Add the moving end of a cell at the place at hand; ``hidden``: whether one of its sides is not seen."""
    view, work, here = on.world, on.work, on.tangent.here
    if wall < 0:
        wall_adjoint(-1, 0, scale, on, adjoint, 0, 3)
        return
    tag = condition_of(wall // 4, here, hidden, view, work)
    if tag < 0:
        # several conditions meet here and none is known to be the one that moves
        for column in range(adjoint.shape[1]):
            adjoint[ONE_SIDED, column] = 1.0
        return
    wall_adjoint(wall // 4, tag, scale, on, adjoint, 0, 3)
    j = work.chart.shape_index
    merged = work.walls[wall // 4].tag > FLOOR_CUT
    if j >= 0 and merged and (tag == HORIZON or tag >= CUT_BY) and on_a_parallel(here, view.spheres[j]):
        # a field of another colour lies just beyond: from the other side the derivative is another one
        wall_adjoint(wall // 4, tag, scale, on, adjoint, 3, 4)
        # the row's axis is that of the parallel too
        wall_adjoint(wall // 4, TEXTURE_EDGE, -scale, on, adjoint, 3, 4)


@inlined
def walls_adjoint(c: float, s: float, weight: float, step: int, on: Charted, adjoint: Array) -> None:
    """Add the moving ends of all cells of the scanned line (c, s)."""
    work, here = on.work, on.tangent.here
    chart = work.chart
    cells = work.counts.cells
    for cell in range(cells + 1):
        wall = work.cell_wall[cell]
        if wall in (POLE_END, LIMB):
            # at the pole and at the limb the solid angle vanishes, and neither moves
            continue
        if not wall_moves(wall, on.tangent.moving):
            continue
        if disk_edge(wall, work):
            # nothing jumps where a disk begins or ends to be hidden
            continue
        side_above = work.cell_side[cell] if cell < cells else HIDDEN
        side_below = work.cell_side[cell - 1] if cell > 0 else HIDDEN
        if side_above == HIDDEN and side_below == HIDDEN:
            continue
        x = work.cell_from[cell] if cell < cells else work.cell_to[cells - 1]
        if not x > 0.0:
            continue
        measure, _ = chart_place(x, c, s, chart, here)
        density = rim_density(chart.lobe) if wall < 0 else log_density(here, on.lobe, chart)[2]
        set_view(here, on.world, chart)
        if jump_at(cell, side_above, side_below, step, on):
            hidden = side_above == HIDDEN or side_below == HIDDEN
            end_adjoint(wall, hidden, weight * measure * density, on, adjoint)
