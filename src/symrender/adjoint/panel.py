"""The derivative of the outer integral: accepted panels of azimuth, replayed with their adjoint.

The line integral is continuous at every event, so the ends of panels may stay where they are; its slope has an inverse
square root where a wall is tangent to a scan line, which the panel's quadratic map removes, so orders converge as for
values. Two differences from values remain. An event only known to 1e-8 costs a value 1e-12 but a slope 1e-4: ends with
a root are bisected to the last bit, those of a closed form too, which is right to some 1e-14. And a wall that *is* a
scan line (a great circle through the pole of the chart, seen by symmetry) makes the line integral jump: it moves
sideways, which is one integral along that line.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.line import BAR, RADIANCE, line_adjoint, log_density, radiance, set_view
from symrender.adjoint.walls import (
    ONE_SIDED,
    chart_place,
    condition_of,
    on_a_parallel,
    pull_back,
    wall_gradient,
)
from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import LIMB, POLE_END, scan_line
from symrender.chambers.lobes.width import blunt_rim
from symrender.chambers.records import Chart, Event
from symrender.chambers.walls import DIRECTION, FLOOR_CUT, NORMAL, TEXTURE_EDGE
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.gauss import FALLS, LEVELS, MAX_ORDER, MIDDLE, order
from symrender.quadrature.records import Panel, Span
from symrender.quadrature.split_line import kinked, tail_error
from symrender.quadrature.split_panel import (
    add_panel,
    panel_azimuth,
    panel_log,
    split_span,
)

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

UNUSED = -2
"""Step of a row of the panel table that no panel has taken."""
NARROW = 1e-9
"""Panels thinner than this stay as they are."""
MERGED = 2e-13
"""Events closer than this are one that rounding blurs."""
ROUNDING = 3e-12
"""Relative error, times its width, that rounding may leave a panel with a root at an end: a tangency is known to some
1e-14 there, and the slope is an inverse square root of the distance from it, so that cutting makes it worse."""
OVER_DISK = 3.0
"""Error of the rules over a disk light, which err alike on every line, over what their step aims at."""
CANCELLED = 1e-15
"""Rounding of a derivative over the sum of what moves it: rims and densities sweep much that cancels."""
STALLED = 0.95
"""Most that a change is taken to be of the one before."""
SUMS = 6
"""Adjoints kept of a panel: its own, four of its coefficients across the lines, and that of the line at hand."""
LINE_SUM = SUMS - 1
SIDEWAYS = len(LEVELS) - 2
"""Step of the orders along a wall that is a scan line."""
RADIAL = 1e-12
"""A circle whose axis and level lie closer to the pole's great circles than this is one of them."""


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


@jitable
def contract(adjoint: Array, tangents: Array, out: Array, sign: float) -> None:
    """out[p, c] += sign x sum over columns of adjoint[c] tangents[p]; ``out`` (parameters, 4)."""
    for p in range(tangents.shape[0]):
        for c in range(4):
            total = 0.0
            for k in range(tangents.shape[1]):
                total += adjoint[c, k] * tangents[p, k]
            out[p, c] += sign * total


@inlined
def panel_adjoint(
    p: Panel, step: int, n: int, lobe: Array, view: View, work: Work, gauss: Array, disk: Array | None, scratch: Array,
    here: Array, own: Array, nodes: bool, moving: Array, sums: Array,
) -> tuple[float, float]:  # fmt: skip
    """The adjoint of one panel by ``n`` lines into sums[0]; azimuth of a line of another structure, or NaN.

    Then the error of the rules along its lines, over what they hold. ``sums`` (SUMS, 4, columns) also gets the last
    Legendre coefficients across the lines and two from the middle. ``step`` chooses the orders along the lines.
    """
    line = sums[LINE_SUM]
    size, missed = 0.0, 0.0
    for t in range(sums.shape[0]):
        for row in range(4):
            for k in range(sums.shape[2]):
                sums[t, row, k] = 0.0
    base = n * (n - 1) // 2
    signature = 0
    for q in range(n):
        phi, slope = panel_azimuth(gauss[0, base + q], p)
        found = scan_line(phi, view, work, scratch)
        if q == 0:
            signature = found
        elif found != signature:
            return phi, 1.0
        whole, miss = line_adjoint(
            phi, gauss[1, base + q] * slope, step, lobe, view, work, gauss, disk, here, own, nodes, moving, line
        )
        size += whole
        missed += miss
        last, before, middle, lower = (
            gauss[2, base + q], gauss[3, base + q], gauss[MIDDLE, base + q], gauss[MIDDLE + 1, base + q]
        )  # fmt: skip
        for row in range(4):
            for k in range(sums.shape[2]):
                t = line[row, k]
                sums[0, row, k] += t
                sums[1, row, k] += last * t
                sums[2, row, k] += before * t
                sums[3, row, k] += middle * t
                sums[4, row, k] += lower * t
                line[row, k] = 0.0
    return math.nan, (missed / size if size > 0.0 else 0.0)


@inlined
def panel_lines(p: Panel, step: int) -> int:
    """Lines of a panel at one order, of which there is a next one."""
    return min(MAX_ORDER - 1, max(p.glare, order(step, p.log_rho) + (1 if step > 0 else 0)))


@jitable
def panel_misses(
    n: int, more: int, panel: Panel, blunt: bool, inner: float, sums: Array, tangents: Array, low_order: Array,
    high_order: Array, misses: Array,
) -> float:  # fmt: skip
    """Estimated errors of a panel's derivatives at the higher order into ``misses`` (parameters, 4); the largest.

    Two orders agree by chance now and then, most of all where each has few lines: how the coefficients across the lines
    fall is a second witness, and the worse of the two counts. A third is what ``misses`` held at ``more`` lines fewer,
    0 before the first estimate: no rule's error falls faster than its singularities let it, and changes that stay as
    large, of which the last column keeps the largest, add up. All are blind to what all lines err alike: ``inner`` is
    the share of what moves that the rules along the lines, and over a disk light, may miss. And what chooses no node
    counts falls slowly from a level of its own: where ends of cells move past it by one power less than in a value.
    """
    most, fall = 0.0, math.exp(-2.0 * more * panel.log_rho)
    slowly = panel.share * math.exp(-2.0 * n * panel.slow) / math.sqrt(2.0 * n)
    for p in range(tangents.shape[0]):
        largest, previous, grown = 0.0, misses[p, 3], 1.0
        for c in range(3):
            largest = max(largest, abs(high_order[p, c] - low_order[p, c]))
        misses[p, 3] = largest
        if 0.0 < previous < 2.0 * largest:
            # changes that hardly fall go on: r + r^2 + ... of the last one is left
            ratio = min(STALLED, largest / previous)
            grown = max(1.0, ratio / (1.0 - ratio))
        for c in range(3):
            last = before = middle = lower = moved = 0.0
            for k in range(tangents.shape[1]):
                t = tangents[p, k]
                if t != 0.0:
                    moved += abs(sums[0, c, k] * t)
                    last += sums[1, c, k] * t
                    before += sums[2, c, k] * t
                    middle += sums[3, c, k] * t
                    lower += sums[4, c, k] * t
            size = max(abs(high_order[p, c]), abs(low_order[p, c]), abs(last))
            middle = max(abs(middle), abs(lower)) if n >= 6 else 0.0
            tail = max(tail_error(n, last, before, middle, size, panel.log_rho), slowly * moved)
            if blunt:
                tail = max(tail, abs(last), 0.5 * abs(before))
            change, doubt = grown * abs(high_order[p, c] - low_order[p, c]), misses[p, c]
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
        if wall not in (POLE_END, LIMB) and moving[wall // 4 if wall >= 0 else moving.shape[0] - 1] != 0.0:
            return False
    return True


@jitable
def leaves(low: float, high: float, signature: int, view: View, work: Work, scratch: Array) -> float:
    """Where lines stop having ``signature``: that at ``low`` has it, that at ``high`` has not; to the last bit."""
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if scan_line(middle, view, work, scratch) == signature:
            low = middle
        else:
            high = middle


@jitable
def polish_end(
    panels: Table[Panel], i: int, side: int, first: int, n: int, view: View, work: Work, scratch: Array
) -> int:
    """Move an end of panel ``i``, and of its neighbour there, to the event between them; new number of panels.

    Both must move together, and what lies between two events that had been taken for one becomes a panel: a piece
    counted twice or not at all costs the square root of its width.
    """
    p = panels[i]
    end, inside = p.ends[side], 0.5 * (p.ends[0] + p.ends[1])
    beyond, neighbour = 2.0 * end - inside, -1
    for k in range(first, n):
        q = panels[k]
        if q.ends[0] < q.ends[1] and q.ends[1 - side] == end:
            neighbour, beyond = k, 0.5 * (q.ends[0] + q.ends[1])
    if side == 0 and neighbour >= 0 and panels[neighbour].kinds[1] == ROOT:
        # the neighbour's turn
        return n
    own = scan_line(inside, view, work, scratch)
    other = scan_line(beyond, view, work, scratch) if neighbour >= 0 else 0
    most = 0.5 * min(abs(end - inside), abs(beyond - end))
    reach = 1e-13 * (1.0 + abs(end))
    for _ in range(4):
        # a closed form rounds, the search brackets
        low, high = (end - reach, end + reach) if side else (end + reach, end - reach)
        after = scan_line(high, view, work, scratch)
        if reach < most and scan_line(low, view, work, scratch) == own != after and (neighbour < 0 or after == other):
            event = leaves(low, high, own, view, work, scratch)
            p.ends[side] = event
            if neighbour >= 0:
                back = leaves(high, low, other, view, work, scratch)
                between = back - event if side else event - back
                if between > MERGED * (1.0 + abs(end)) and n < panels.shape[0]:
                    n = add_panel(panels, n, min(event, back), max(event, back), ROOT, ROOT, work)
                    event = back
                panels[neighbour].ends[1 - side] = event
            return n
        reach *= 80.0
    return n


@jitable
def polish_ends(
    panels: Table[Panel], first: int, n: int, low: float, high: float, view: View, work: Work, scratch: Array
) -> int:
    """Move ends with a root, between ``low`` and ``high``, to where scan lines see their events; new panel count."""
    known = n
    for i in range(first, known):
        for side in range(2):
            p = panels[i]
            end = p.ends[side]
            if p.ends[0] < p.ends[1] and p.kinds[side] == ROOT and low < end < high:
                n = polish_end(panels, i, side, first, n, view, work, scratch)
    held: int = panels.shape[0]
    return min(n, held)


@jitable
def cut_odd_ends(panels: Table[Panel], n: int, view: View, work: Work, scratch: Array) -> int:
    """Cut off panels' ends whose lines have another structure than their middles; new number of panels.

    A shadow that touches a scan line just before the event that ends the panel opens a sliver no line sees. Its share
    of the value grows with the third half power of its width, that of the derivative with the square root.
    """
    known = n
    for i in range(known):
        p = panels[i]
        if not p.ends[1] - p.ends[0] > NARROW:
            continue
        middle = 0.5 * (p.ends[0] + p.ends[1])
        inside = scan_line(middle, view, work, scratch)
        for side in range(2):
            end = p.ends[side]
            inset = 1e-13 * (1.0 + abs(end)) + 1e-11 * (p.ends[1] - p.ends[0])
            odd, even = end - inset if side else end + inset, middle
            if scan_line(odd, view, work, scratch) == inside or n >= panels.shape[0]:
                continue
            while True:
                between = 0.5 * (odd + even)
                if between in (odd, even):
                    break
                if scan_line(between, view, work, scratch) == inside:
                    even = between
                else:
                    odd = between
            if side:
                n = add_panel(panels, n, even, end, ROOT, p.kinds[1], work)
                p.ends[1], p.kinds[1] = even, ROOT
            else:
                n = add_panel(panels, n, end, even, p.kinds[0], ROOT, work)
                p.ends[0], p.kinds[0] = even, ROOT
            p.log_rho = panel_log(work, p.ends[0], p.ends[1], p.kinds[0], p.kinds[1])
    return n


@jitable
def replay_chart(
    tol: float, lobe: Array, view: View, work: Work, gauss: Array, disk: Array | None, panels: Table[Panel], spans:
    Table[Span], ids: Ints, events: Table[Event], scratch: Array, here: Array, own: Array, nodes: bool, moving: Array,
    sums: Array, tangents: Array, exact: bool, max_evaluations: int, value: Array, error: Array, low_order: Array,
    high_order: Array, misses: Array,
) -> None:  # fmt: skip
    """Add the charted shape's derivatives to ``value`` (parameters, 4), their estimated errors to ``error``.

    ``panels`` are those of ``split_chart`` on the same ``work``; ``tangents`` (parameters, columns) is how every
    column moves, ``nodes`` and ``moving`` are those of ``what_moves``; ``low_order``, ``high_order`` and ``misses``
    (parameters, 4) and ``sums`` (SUMS, 4, columns) are scratch. ``tol`` is absolute, of every derivative. Beyond half
    of the evaluations left no panel is refined any more: other charts follow.
    """
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
        if not p.ends[0] < p.ends[1] or (not nodes and stands_still(p, view, work, scratch, moving)):
            continue
        step = max(0, p.step - 1)
        n_lines = panel_lines(p, step)
        for a in range(tangents.shape[0]):
            for c in range(4):
                low_order[a, c] = 0.0
        foreign, _ = panel_adjoint(
            p, step, n_lines, lobe, view, work, gauss, disk, scratch, here, own, nodes, moving, sums
        )
        contract(sums[0], tangents, low_order, 1.0)
        for a in range(tangents.shape[0]):
            for c in range(4):
                high_order[a, c] = low_order[a, c]
                misses[a, c] = 0.0
        most = noise = 0.0
        while foreign != foreign:
            step += 1
            for a in range(tangents.shape[0]):
                for c in range(4):
                    high_order[a, c] = 0.0
            # two orders of as many lines would only tell what differs along them
            fewer, n_lines = n_lines, max(n_lines + 1, panel_lines(p, step))
            foreign, inner = panel_adjoint(
                p, step, n_lines, lobe, view, work, gauss, disk, scratch, here, own, nodes, moving, sums
            )
            contract(sums[0], tangents, high_order, 1.0)
            if disk is not None:
                inner += OVER_DISK * FALLS[step]
            most = panel_misses(
                n_lines, n_lines - fewer, p, blunt, inner, sums, tangents, low_order, high_order, misses
            )
            largest = 0.0
            for a in range(tangents.shape[0]):
                for c in range(3):
                    largest = max(largest, abs(high_order[a, c]))
            noise = 1e-15 * largest
            if ROOT in (p.kinds[0], p.kinds[1]) and 0.0 < p.missed < 2.0 * most:
                noise = ROUNDING / (p.ends[1] - p.ends[0]) * largest
            last = step + 1 >= len(LEVELS) or max(n_lines, order(step + 1, p.log_rho)) >= MAX_ORDER
            if most <= max(share, noise) or last or work.counts.evaluations > most_evaluations:
                break
            for a in range(tangents.shape[0]):
                for c in range(4):
                    low_order[a, c] = high_order[a, c]
        room = n + 8 < panels.shape[0] and work.counts.evaluations <= most_evaluations
        if (foreign == foreign or most > max(share, noise)) and room and p.ends[1] - p.ends[0] > NARROW:
            first, end, kind, end_kind = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1]
            p.ends[0] = p.ends[1] = first
            before = n
            if foreign == foreign:
                # no search between scan lines is sure to find an event; the line that told is where it is looked for
                n = split_span(first, foreign, kind, SMOOTH, 1, view, work, panels, n, spans, ids, scratch)
                n = split_span(foreign, end, SMOOTH, end_kind, 1, view, work, panels, n, spans, ids, scratch)
            else:
                middle = 0.5 * (first + end)
                n = add_panel(panels, n, first, middle, kind, SMOOTH, work)
                n = add_panel(panels, n, middle, end, SMOOTH, end_kind, work)
                panels[n - 1].step = panels[n - 2].step = max(1, step - 1)
                panels[n - 1].missed = panels[n - 2].missed = most
            n = min(n, panels.shape[0])
            if exact:
                n = polish_ends(panels, before, n, first, end, view, work, scratch)
            continue
        spent += most
        for a in range(tangents.shape[0]):
            for c in range(4):
                value[a, c] += high_order[a, c]
            for c in range(3):
                if foreign == foreign or is_spent(work):
                    # lines of several structures, or cut short: of this panel nothing is known but its size
                    error[a, c] += max(abs(high_order[a, c]), abs(low_order[a, c]), misses[a, c])
                else:
                    error[a, c] += misses[a, c]


@jitable
def radial_walls(
    lobe: Array, view: View, work: Work, gauss: Array, disk: Array | None, scratch: Array, here: Array, own: Array,
    adjoint: Array,
) -> bool:  # fmt: skip
    """The adjoint (4, columns) of walls that are scan lines; whether there are any."""
    for channel in range(adjoint.shape[0]):
        for k in range(adjoint.shape[1]):
            adjoint[channel, k] = 0.0
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
                    _sideways(i, near, -1.0 if side else 1.0, lobe, view, work, gauss, disk, here, own, adjoint)
    return found


@jitable
def _sideways(
    i: int, phi: float, sign: float, lobe: Array, view: View, work: Work, gauss: Array, disk: Array | None,
    here: Array, own: Array, adjoint: Array,
) -> None:  # fmt: skip
    """Add sign x the scanned line's integral of F times how wall ``i`` moves across the line."""
    chart = work.chart
    c, s = math.cos(phi), math.sin(phi)
    bar = here[BAR : BAR + 3]
    n = MAX_ORDER
    base = n * (n - 1) // 2
    for cell in range(work.counts.cells):
        if work.cell_side[cell] == HIDDEN:
            continue
        a, length = work.cell_from[cell], work.cell_to[cell] - work.cell_from[cell]
        for q in range(n):
            x = a + length * gauss[0, base + q]
            measure, _ = chart_place(x, c, s, chart, here)
            density = log_density(here, lobe, chart)[2]
            set_view(here, view, chart)
            radiance(work.cell_side[cell], work.lit[cell], SIDEWAYS, here, view, work, gauss, disk, here[RADIANCE])
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
                for k in range(own.shape[0]):
                    own[k] = 0.0
                wall_gradient(i, condition, here, view, work, bar, own)
                across = _across(bar, here, c, s, chart)
                pull_back(1.0, bar, here, j < 0, own)
                for channel in range(4):
                    rate = w / across * here[RADIANCE, channel % 3]
                    if channel == ONE_SIDED:
                        rate = (rate if which == 0 else -rate) if beside else 0.0
                    elif which == 1:
                        continue
                    for k in range(own.shape[0]):
                        adjoint[channel, k] += rate * own[k]


@jitable
def _across(bar: Array, here: Array, c: float, s: float, chart: Chart) -> float:
    """Slope in phi of a function of gradients ``bar``: phi turns Q - P, N and w about the pole."""
    slope = 0.0
    for row in range(3):
        x, y, z = here[row, 0], here[row, 1], here[row, 2]
        px, py, pz = chart.pole[0], chart.pole[1], chart.pole[2]
        slope += bar[row, 0] * (py * z - pz * y) + bar[row, 1] * (pz * x - px * z) + bar[row, 2] * (px * y - py * x)
    return slope
