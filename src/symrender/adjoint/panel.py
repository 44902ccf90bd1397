"""The derivative of the outer integral: accepted panels of azimuth, replayed with their adjoint.

The line integral is continuous at every event, so the ends of panels may stay where they are; its slope has an inverse
square root where a wall is tangent to a scan line, which the panel's quadratic map removes, so orders converge as for
values. Two differences from values remain: how well ends must be known (``panel_ends.py``), and walls that *are* scan
lines (``radial_walls.py``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.line import line_adjoint
from symrender.adjoint.moves import wall_moves
from symrender.adjoint.panel_ends import NARROW, cut_odd_ends, polish_ends
from symrender.adjoint.sums import add, clear, clear_used, contract, largest_channel, put
from symrender.adjoint.work import LINE_SUM, Charted, PanelWork, TangentWork
from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.line import LIMB, POLE_END, scan_line
from symrender.chambers.lobes.width import blunt_rim
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.gauss import FALLS, LEVELS, MAX_ORDER, MIDDLE, order
from symrender.quadrature.line_errors import tail_error
from symrender.quadrature.panel_maps import add_panel, panel_azimuth
from symrender.quadrature.panel_search import split_span
from symrender.quadrature.records import Panel
from symrender.quadrature.split_line import kinked

Array = npt.NDArray[np.float64]

UNUSED = -2
"""Step of a row of the panel table that no panel has taken."""
ROUNDING = 3e-12
"""Relative error, times its width, that rounding may leave a panel with a root at an end: a tangency is known to some
1e-14 there, and the slope is an inverse square root of the distance from it, so that cutting makes it worse."""
OVER_DISK = 3.0
"""Error of the rules over a disk light, which err alike on every line, over what their step aims at."""
CANCELLED = 1e-15
"""Rounding of a derivative over the sum of what moves it: rims and densities sweep much that cancels."""
STALLED = 0.95
"""Most that a change is taken to be of the one before."""


class Reached(NamedTuple):
    """What the orders of a panel came to: its largest error and what rounding leaves, the step of the last order.

    ``foreign`` is the azimuth of a line of another structure than the first one's, or NaN.
    """

    foreign: float
    most: float
    noise: float
    step: int


@jitable
def clear_panels(panels: Table[Panel]) -> None:
    """Mark the rows in use as free, so that the next chart's panels can be told from them."""
    for i in range(panels.shape[0]):
        if panels[i].step == UNUSED:
            return
        panels[i].step = UNUSED


@jitable
def panels_in_use(panels: Table[Panel]) -> int:
    """How many rows hold panels."""
    n = 0
    while n < panels.shape[0] and panels[n].step != UNUSED:
        n += 1
    return n


@inlined
def panel_adjoint(p: Panel, step: int, n: int, scratch: Array, on: Charted) -> tuple[float, float]:
    """The adjoint of one panel by ``n`` lines into sums[0]; azimuth of a line of another structure, or NaN.

    Then the error of the rules along its lines, over what they hold. ``sums`` also gets the last Legendre coefficients
    across the lines and two from the middle. ``step`` chooses the orders along the lines.
    """
    gauss, sums = on.gauss, on.tangent.sums
    line = sums[LINE_SUM]
    size, missed = 0.0, 0.0
    for t in range(LINE_SUM):
        clear_used(sums[t], on.used)
    base = n * (n - 1) // 2
    signature = 0
    for q in range(n):
        phi, slope = panel_azimuth(gauss[0, base + q], p)
        found = scan_line(phi, on.world, on.work, scratch)
        if q == 0:
            signature = found
        elif found != signature:
            return phi, 1.0
        clear(line)
        whole, miss = line_adjoint(phi, gauss[1, base + q] * slope, step, on, line)
        size += whole
        missed += miss
        last, before, middle, lower = (
            gauss[2, base + q], gauss[3, base + q], gauss[MIDDLE, base + q], gauss[MIDDLE + 1, base + q]
        )  # fmt: skip
        for row in range(4):
            for k in on.used:
                t = line[row, k]
                sums[0, row, k] += t
                sums[1, row, k] += last * t
                sums[2, row, k] += before * t
                sums[3, row, k] += middle * t
                sums[4, row, k] += lower * t
    return math.nan, (missed / size if size > 0.0 else 0.0)


@inlined
def panel_lines(p: Panel, step: int) -> int:
    """Lines of a panel at one order, of which there is a next one."""
    return min(MAX_ORDER - 1, max(p.glare, order(step, p.log_rho) + (1 if step > 0 else 0)))


@jitable
def panel_misses(n: int, more: int, panel: Panel, blunt: bool, inner: float, on: Charted) -> float:
    """Estimated errors of a panel's derivatives at the higher order into ``misses``; the largest.

    Two orders agree by chance now and then, most of all where each has few lines: how the coefficients across the lines
    fall is a second witness, and the worse of the two counts. A third is what ``misses`` held at ``more`` lines fewer,
    0 before the first estimate: no rule's error falls faster than its singularities let it, and changes that stay as
    large, of which the last column keeps the largest, add up. All are blind to what all lines err alike: ``inner`` is
    the share of what moves that the rules along the lines, and over a disk light, may miss. And what chooses no node
    counts falls slowly from a level of its own: where ends of cells move past it by one power less than in a value.
    """
    moves, sums = on.moves, on.tangent.sums
    low, high, misses = on.tangent.low, on.tangent.high, on.tangent.misses
    most, fall = 0.0, math.exp(-2.0 * more * panel.log_rho)
    slowly = panel.share * math.exp(-2.0 * n * panel.slow) / math.sqrt(2.0 * n)
    for p in range(moves.shape[0]):
        largest, previous, grown = 0.0, misses[p, 3], 1.0
        for c in range(3):
            largest = max(largest, abs(high[p, c] - low[p, c]))
        misses[p, 3] = largest
        if 0.0 < previous < 2.0 * largest:
            # changes that hardly fall go on: r + r^2 + ... of the last one is left
            ratio = min(STALLED, largest / previous)
            grown = max(1.0, ratio / (1.0 - ratio))
        for c in range(3):
            last = before = middle = lower = moved = 0.0
            for k in range(moves.shape[1]):
                t = moves[p, k]
                if t != 0.0:
                    moved += abs(sums[0, c, k] * t)
                    last += sums[1, c, k] * t
                    before += sums[2, c, k] * t
                    middle += sums[3, c, k] * t
                    lower += sums[4, c, k] * t
            size = max(abs(high[p, c]), abs(low[p, c]), abs(last))
            middle = max(abs(middle), abs(lower)) if n >= 6 else 0.0
            tail = max(tail_error(n, last, before, middle, size, panel.log_rho), slowly * moved)
            if blunt:
                tail = max(tail, abs(last), 0.5 * abs(before))
            change, doubt = grown * abs(high[p, c] - low[p, c]), misses[p, c]
            misses[p, c] = max(change, tail, fall * doubt) + inner * moved
            most = max(most, misses[p, c])
            misses[p, c] += CANCELLED * moved
    return most


@jitable
def stands_still(p: Panel, view: View, work: Work, scratch: Array, moving: Array) -> bool:
    """Whether no wall on the lines of a panel that all had one structure is ``moving``."""
    if p.foreign == p.foreign or p.step < 1.0:
        return False
    scan_line(0.5 * (p.ends[0] + p.ends[1]), view, work, scratch)
    for cell in range(work.counts.cells + 1):
        wall = work.cell_wall[cell]
        if wall not in (POLE_END, LIMB) and wall_moves(wall, moving):
            return False
    return True


@inlined
def panel_slopes(
    p: Panel, share: float, most_evaluations: int, blunt: bool, scratch: Array, on: Charted
) -> Reached:  # fmt: skip
    """A panel's derivatives at higher and higher orders until they err by no more than ``share``.

    They are left in ``high``, those of the order before in ``low``, their errors in ``misses``.
    """
    low, high, misses = on.tangent.low, on.tangent.high, on.tangent.misses
    adjoint = on.tangent.sums[0]
    step = max(0, p.step - 1)
    n_lines = panel_lines(p, step)
    clear(low)
    foreign, _ = panel_adjoint(p, step, n_lines, scratch, on)
    contract(adjoint, on.moves, low)
    put(low, high)
    clear(misses)
    most = noise = 0.0
    while foreign != foreign:
        step += 1
        clear(high)
        # two orders of as many lines would only tell what differs along them
        fewer, n_lines = n_lines, max(n_lines + 1, panel_lines(p, step))
        foreign, inner = panel_adjoint(p, step, n_lines, scratch, on)
        contract(adjoint, on.moves, high)
        if on.disk is not None:
            inner += OVER_DISK * FALLS[step]
        most = panel_misses(n_lines, n_lines - fewer, p, blunt, inner, on)
        largest = largest_channel(high)
        noise = 1e-15 * largest
        if ROOT in (p.kinds[0], p.kinds[1]) and 0.0 < p.missed < 2.0 * most:
            noise = ROUNDING / (p.ends[1] - p.ends[0]) * largest
        last = step + 1 >= len(LEVELS) or max(n_lines, order(step + 1, p.log_rho)) >= MAX_ORDER
        if most <= max(share, noise) or last or on.work.counts.evaluations > most_evaluations:
            break
        put(high, low)
    return Reached(foreign, most, noise, step)


@inlined
def cut_panel(p: Panel, n: int, reached: Reached, exact: bool, outer: PanelWork, on: Charted) -> int:
    """Put two panels in the place of one: where a line of another structure lies, or its halves; their new number."""
    view, work, panels, scratch = on.world, on.work, outer.panels, outer.scratch
    foreign = reached.foreign
    first, end, kind, end_kind = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1]
    p.ends[0] = p.ends[1] = first
    before = n
    if foreign == foreign:
        # no search between scan lines is sure to find an event; the line that told is where it is looked for
        n = split_span(first, foreign, kind, SMOOTH, 1, view, work, panels, n, outer.spans, outer.ids, scratch)
        n = split_span(foreign, end, SMOOTH, end_kind, 1, view, work, panels, n, outer.spans, outer.ids, scratch)
    else:
        middle = 0.5 * (first + end)
        n = add_panel(panels, n, first, middle, kind, SMOOTH, work)
        n = add_panel(panels, n, middle, end, SMOOTH, end_kind, work)
        panels[n - 1].step = panels[n - 2].step = max(1, reached.step - 1)
        panels[n - 1].missed = panels[n - 2].missed = reached.most
    n = min(n, panels.shape[0])
    return polish_ends(panels, before, n, first, end, view, work, scratch) if exact else n


@inlined
def take_panel(broken: bool, t: TangentWork) -> None:
    """Add a panel's derivatives and their errors; of a ``broken`` one nothing is known but its size.

    Its lines have several structures, or are cut short.
    """
    add(t.high, t.value)
    for a in range(t.value.shape[0]):
        for c in range(3):
            if broken:
                t.error[a, c] += max(abs(t.high[a, c]), abs(t.low[a, c]), t.misses[a, c])
            else:
                t.error[a, c] += t.misses[a, c]


@jitable
def replay_chart(tol: float, exact: bool, max_evaluations: int, outer: PanelWork, on: Charted) -> None:
    """Add the charted shape's derivatives to ``value``, their estimated errors to ``error``.

    The panels are those of ``split_chart`` on the same scratch. ``tol`` is absolute, of every derivative. Beyond half
    of the evaluations left no panel is refined any more: other charts follow.
    """
    view, work, panels, scratch = on.world, on.work, outer.panels, outer.scratch
    n = panels_in_use(panels)
    most_evaluations = work.counts.evaluations + (max_evaluations - work.counts.evaluations) // 2
    if exact:
        n = polish_ends(panels, 0, n, -math.inf, math.inf, view, work, scratch)
    n = cut_odd_ends(panels, n, view, work, scratch)
    for i in range(n):
        panels[i].missed = 0.0
    spent, blunt = 0.0, kinked(view) or blunt_rim(work.chart.lobe)
    i = 0
    while i < n:
        # most panels err far less than their share and leave the rest to those that follow
        share = max(tol - spent, 0.05 * tol) / (n - i)
        p = panels[i]
        i += 1
        if not p.ends[0] < p.ends[1] or (not on.nodes and stands_still(p, view, work, scratch, on.tangent.moving)):
            continue
        reached = panel_slopes(p, share, most_evaluations, blunt, scratch, on)
        foreign = reached.foreign == reached.foreign
        room = n + 8 < panels.shape[0] and work.counts.evaluations <= most_evaluations
        missed = reached.most > max(share, reached.noise)
        if (foreign or missed) and room and p.ends[1] - p.ends[0] > NARROW:
            n = cut_panel(p, n, reached, exact, outer, on)
            continue
        spent += reached.most
        take_panel(foreign or is_spent(work), on.tangent)
