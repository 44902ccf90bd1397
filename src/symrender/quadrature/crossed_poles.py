"""Walls across which a conductor's pole wanders: where the integral over lines is singular that no list foretells.

A line ends in pieces at walls, and D is singular beside it at x + iy. Where a wall lies at x, on some line, the ridge
of D passes from one of its sides to the other, as one line follows another, within y over the speed at which they part:
of a jump at the wall the integral over lines takes a step as steep as that, a logarithm beside real azimuths. Between
two lines of one panel both go nearly straight, so that what they say of it tells where it is.
"""

from __future__ import annotations

import math

from symrender.chambers.events import SMOOTH
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.walls import HIGHLIGHT
from symrender.chambers.work import Work
from symrender.jit.marks import jitable
from symrender.jit.moving import held
from symrender.quadrature.panel_maps import ellipse_sum
from symrender.quadrature.records import Panel

FAINT = 1e-4
"""Share of a line that a jump of the lobe itself is: Walter's fit jumps by 6e-5."""
BEYOND = 1.0
"""How far beyond the last line, in distances of lines, what both say is followed."""
LEAP = 0.5
"""By how much the pole may go from line to line; farther off it is another zero, which took over behind the pole."""
SURE = 4.0
"""Where the ridge and the wall are so many times its width apart on both lines, and on one side, nothing is between."""


@jitable
def crossed_pole(phi: float, before: float, n: int, p: Panel, work: Work) -> None:
    """Give a panel the singularity that it feels most of those between the lines at ``before`` (NaN: none) and ``phi``.

    It is felt by a rule of ``n`` lines, of which the one at ``phi`` is integrated: its first pole is the lobe's.
    ``work.beside`` keeps of the scanned line x in the first place, then how far every wall is from it, and y, for the
    next one.
    """
    chart, azimuth = work.chart, held(phi)
    if chart.lobe.kind != CONDUCTOR:
        return
    x, y = held(work.poles[0, 0]), max(1e-12, held(work.poles[0, 1]))
    a, b = held(p.ends[0]), held(p.ends[1])
    if abs(x - held(work.beside[0, 0])) > LEAP:
        before = math.nan
    work.beside[0, 0] = x
    for cell in range(1, work.counts.cells):
        gap = held(work.cell_from[cell]) - x
        last_gap, last_y = held(work.beside[0, cell]), held(work.beside[1, cell])
        work.beside[0, cell], work.beside[1, cell] = gap, y
        wall = work.cell_wall[cell]
        if before != before or wall < 0 or gap == last_gap:
            continue
        if gap * last_gap > 0.0 and abs(gap) > SURE * y and abs(last_gap) > SURE * last_y:
            continue
        t = last_gap / (last_gap - gap)
        if not -BEYOND < t < 1.0 + BEYOND:
            continue
        slope = abs(gap - last_gap) / (azimuth - before)
        depth = (last_y + (y - last_y) * min(1.0, max(0.0, t))) / slope
        rho = ellipse_sum(before + t * (azimuth - before), depth, a, b, SMOOTH, SMOOTH)
        slow = math.log(rho + math.sqrt(max(0.0, rho * rho - 1.0)))
        share = FAINT if work.walls[wall // 4].tag == HIGHLIGHT else 1.0
        if held(p.crossed_share) * math.exp(-2.0 * n * held(p.crossed)) < share * math.exp(-2.0 * n * slow):
            p.crossed, p.crossed_share = slow, share
