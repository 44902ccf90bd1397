"""Walls across which a conductor's poles wander: where the integral over lines is singular that no list foretells.

A line ends in pieces at walls, and D is singular beside it at x + iy; so is the root of masking where both directions
graze, and its pole, at two places each.
Where a wall lies at x, on some line, the ridge passes from one of its sides to the other, as one line follows another,
within y over the speed at which they part: of a jump at the wall the integral over lines takes a step as steep as that,
a logarithm beside real azimuths. Between two lines of one panel both go nearly straight, so that what they say of it
tells where it is.
"""

from __future__ import annotations

import math

from symrender.chambers.events import SMOOTH
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.walls import HIGHLIGHT
from symrender.chambers.work import TRACKS, Work
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
"""Where D's ridge and the wall are so many times its width apart on both lines, on one side, nothing is between.

Of masking that tells nothing: its pole is real, and its root is felt from a panel's end on, before the first line.
"""


@jitable
def crossed_pole(phi: float, before: float, n: int, p: Panel, work: Work) -> None:
    """Give a panel the singularity that it feels most of those between the lines at ``before`` (NaN: none) and ``phi``.

    It is felt by a rule of ``n`` lines, of which the one at ``phi`` is integrated. ``work.tracks`` has (x, y, share) of
    what is followed, x NaN where it is not there; ``work.beside`` keeps x of each in the first place, then how far
    every wall is from it, and y, for the next line.
    """
    chart, azimuth = work.chart, held(phi)
    if chart.lobe.kind != CONDUCTOR:
        return
    a, b = held(p.ends[0]), held(p.ends[1])
    for track in range(TRACKS):
        x, y = held(work.tracks[track, 0]), max(1e-12, held(work.tracks[track, 1]))
        gaps, depths = work.beside[2 * track], work.beside[2 * track + 1]
        # NaN follows nothing
        follows = before == before and abs(x - held(gaps[0])) <= LEAP
        gaps[0] = x
        if x != x:
            continue
        for cell in range(1, work.counts.cells):
            gap = held(work.cell_from[cell]) - x
            last_gap, last_y = held(gaps[cell]), held(depths[cell])
            gaps[cell], depths[cell] = gap, y
            wall = work.cell_wall[cell]
            if not follows or wall < 0 or gap == last_gap:
                continue
            if track == 0 and gap * last_gap > 0.0 and abs(gap) > SURE * y and abs(last_gap) > SURE * last_y:
                continue
            t = last_gap / (last_gap - gap)
            if not -BEYOND < t < 1.0 + BEYOND:
                continue
            slope = abs(gap - last_gap) / (azimuth - before)
            depth = (last_y + (y - last_y) * min(1.0, max(0.0, t))) / slope
            rho = ellipse_sum(before + t * (azimuth - before), depth, a, b, SMOOTH, SMOOTH)
            slow = math.log(rho + math.sqrt(max(0.0, rho * rho - 1.0)))
            share = held(work.tracks[track, 2]) * (FAINT if work.walls[wall // 4].tag == HIGHLIGHT else 1.0)
            if held(p.crossed_share) * math.exp(-2.0 * n * held(p.crossed)) < share * math.exp(-2.0 * n * slow):
                p.crossed, p.crossed_share = slow, share
