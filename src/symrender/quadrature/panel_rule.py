"""The rule of one panel: its lines, its integral and the error of that."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import scan_line
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.lobes.width import blunt_rim, broken_rim
from symrender.chambers.records import Chart, Event
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.crossed_poles import crossed_pole
from symrender.quadrature.gauss import FALLS, MAX_ORDER, MIDDLE, NODE_GAP, order
from symrender.quadrature.line_errors import across_error
from symrender.quadrature.panel_maps import (
    MAX_FIRST,
    MAX_KINKED,
    panel_azimuth,
    panel_density,
    sliver_bound,
)
from symrender.quadrature.records import Panel
from symrender.quadrature.split_line import ends_bluntly, has_disk, integrate_cells, kinked

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Three = tuple[float, float, float]

UNFALLEN = 1.0
"""Share of a panel's size from which on its last coefficients are those of a spike between lines, and tell nothing."""
FLANK = 100.0
"""By how much the flank of a highlight may be brighter between its panel's lines than on them."""
WEAK = 0.25
"""Share of a panel's last coefficients that what is weak is taken to hold."""


class Falls(NamedTuple):
    """The Legendre coefficients of a panel's lines by which its error is told, a number a channel.

    ``last`` and the one ``before`` are the highest that the rule knows, ``middle`` and ``lower`` of half their degree.
    """

    last: Three
    before: Three
    middle: Three
    lower: Three


@inlined
def shape_key(chart: Chart) -> int:
    """A number of the charted shape: 2 and more of spheres, 1 and less of planes."""
    return chart.shape_index + 2 if chart.shape_index >= 0 else 1 - chart.plane


@inlined
def note_chambers(work: Work) -> None:
    """Count the labels of the scanned line that this point has not met before, and mark its walls as met."""
    for cell in range(work.counts.cells):
        if cell > 0 and work.cell_wall[cell] >= 0:
            work.walls[work.cell_wall[cell] // 4].met = 1
        if work.cell_side[cell] == HIDDEN:
            continue
        key = shape_key(work.chart) * 1099511628211 + work.cell_side[cell]
        for i in range(work.lit.shape[1]):
            key = (key ^ work.lit[cell, i]) * 1099511628211
        known = min(work.counts.chambers, work.labels.shape[0])
        fresh = True
        for i in range(known):
            if work.labels[i] == key:
                fresh = False
                break
        if fresh:
            if known < work.labels.shape[0]:
                work.labels[known] = key
            work.counts.chambers += 1


@inlined
def panel_order(step: int, log_rho: float) -> int:
    """Lines of a panel, more with every step: one less tame than it looked is then found out.

    The first step asks for the order of magnitude only.
    """
    if step == 0:
        return min(MAX_FIRST, order(0, log_rho))
    return min(MAX_ORDER, order(step, log_rho) + 1)


@inlined
def stretched(w: float) -> float:
    """A weight, no smaller for what its panel grows by."""
    if moves(w):
        return moved(held(w), abs(tangent(w)))
    return w


@inlined
def steepest(x: float, y: float, z: float) -> float:
    """Largest magnitude of three tangents."""
    return max(abs(tangent(x)), abs(tangent(y)), abs(tangent(z)))


@inlined
def rule_error(
    p: Panel, n: int, step: int, last: float, before: float, middle: float, lower: float, size: float, bound: float,
    thin: float, dense: float, uneven: bool, of_slopes: bool, view: View, work: Work,
) -> float:  # fmt: skip
    """Error of a panel's rule of ``n`` lines by the last coefficients across them.

    Of what the panel holds, or ``of_slopes``, of what that changes by: coefficients, ``size``, ``bound`` and ``thin``
    are then of the tangents. Arguments are many because they are asked of both.
    """
    if step == 0:
        return max(bound, 10.0 * size * dense)
    unseen = 0.0
    if work.chart.lobe.kind == CONDUCTOR and not moves(p.error):
        # what a spike between the lines may hold, that they saw little of, by how fast rules of such a spike converge
        unseen = min(bound, size * dense) * math.exp(-2.0 * n * held(p.log_rho))
    if uneven:
        return max(2.0 * (last + before) + (size if n == 2 else 0.0) + thin, unseen)
    log_rho, slow, share = held(p.log_rho), held(p.slow), held(p.share)
    top = max(last, 0.5 * before)
    known = max(top * math.exp(-(n + 1) * log_rho), WEAK * top * math.exp(-(n + 1) * slow))
    # a square root's coefficients fall by the power 3/2 beside, and the last ones tell nothing of them by chance
    rooted = share * size * math.exp(-2.0 * n * slow) / (2.0 * n * math.sqrt(2.0 * n))
    if of_slopes:
        # ends of cells move past it by one power less, and blunt ends have slopes without a bound
        rooted *= 2.0 * n
        if blunt_rim(work.chart.lobe):
            known = max(known, last, 0.5 * before)
    known = max(known, rooted)
    # where a wall and a pole cross, coefficients may be small by chance
    known = max(known, held(p.crossed_share) * size * math.exp(-2.0 * n * held(p.crossed)) / (2.0 * n))
    if p.logarithm != 0 or kinked(view) or ends_bluntly(view, work.chart) or broken_rim(work.chart.lobe):
        known = max(known, last, 0.5 * before)
    error = max(2.0 * max(across_error(n, last, before, middle, lower, size, log_rho), known), unseen)
    if top > UNFALLEN * size and (p.glare > 0 or work.chart.lobe.kind == CONDUCTOR):
        # what lies of a highlight, or of the foot of a Gauss curve, between lines may be far brighter than on them
        error = max(error, min(bound, FLANK * size))
    return error


@inlined
def added(weight: float, line: Array, sums: Three) -> Three:
    """The sums of the channels and a line of this weight."""
    return sums[0] + weight * line[0], sums[1] + weight * line[1], sums[2] + weight * line[2]


@inlined
def largest(sums: Three) -> float:
    """Largest magnitude of the channels."""
    return max(abs(sums[0]), abs(sums[1]), abs(sums[2]))


@inlined
def panel_error(
    p: Panel, n: int, step: int, falls: Falls, size: float, thin: float, dense: float, uneven: bool, view: View, work:
    Work
) -> float:  # fmt: skip
    """Error of a panel's rule of ``n`` lines, and where numbers move of its derivative: see ``rule_error``."""
    last, before, middle, lower = (
        largest(falls.last),
        largest(falls.before),
        largest(falls.middle),
        largest(falls.lower),
    )
    error = rule_error(
        p, n, step, last, before, middle, lower, size, held(p.bound), held(thin), held(dense), uneven, False, view, work
    )
    if moves(error):
        rate = tangent(size) / max(held(size), 1e-300)
        missed = rule_error(
            p, n, step, steepest(*falls.last), steepest(*falls.before), steepest(*falls.middle),
            steepest(*falls.lower), tangent(size), rate * held(p.bound), rate * held(thin), held(dense), uneven, True,
            view, work,
        )  # fmt: skip
        error = moved(held(error), held(missed) + held(p.blind) * tangent(size))
    return error


@inlined
def line_density(p: Panel, step: int, signature: int, peak: float, work: Work) -> float:
    """How many times denser than on its lines, ``peak``, the lobe may be in a panel whose rule has a line or two.

    They say little more than the order of magnitude, where the lobe is as dense as there: that a panel holds little is
    believed of its bound only.
    """
    if step == 0 or (work.chart.lobe.kind == CONDUCTOR and signature != 0):
        return max(1.0, panel_density(p.ends[0], p.ends[1], work.chart) / max(peak, 1e-300))
    return 1.0


@inlined
def line_sliver(q: int, n: int, inside: int, first: float, last: float, p: Panel, chart: Chart) -> float:
    """What may open and close between lines q - 1 and q, or an end; ``inside`` events lie there, first to last."""
    if inside > 0 and q == 0:
        return sliver_bound(p.ends[0], last, chart)
    if inside > 0 and q == n:
        return sliver_bound(first, p.ends[1], chart)
    if inside > 1:
        return sliver_bound(first, last, chart)
    return 0.0


@inlined
def evaluate_panel(
    p: Panel, step: int, view: View, work: Work, gauss: Array, events: Table[Event], many: int, out: Array, scratch:
    Array
) -> float:  # fmt: skip
    """Integral of one panel at one order in out[0:3], its error in out[3]; azimuth of a foreign line, or NaN.

    ``out`` also gets its size in [4] and in [5] how many of the ``many`` events
    lie inside. A panel of one structure is analytic and its error is read off the fall of its Legendre coefficients;
    with a kink inside they fall slowly, and the last ones themselves are the error. Where the budget ends first the
    error is inf, and what the panel held before stands.
    """
    a, b = p.ends[0], p.ends[1]
    n = panel_order(step, p.log_rho)
    if step == 1 and p.inside > 0.0:
        # kinks decide, not how far off the integrand is tame between them
        n = min(n, MAX_KINKED)
    n = min(MAX_ORDER, max(n, p.glare))
    base = n * (n - 1) // 2
    # the map of a square root's end is twice as steep as the plain one at most
    work.chart.apart = NODE_GAP * (b - a) / n * (2.0 if p.kinds[0] == ROOT or p.kinds[1] == ROOT else 1.0)
    line = work.notes.line
    for i in range(6):
        out[i] = 0.0
    signature = 0
    foreign = math.nan
    inner, thin, peak = 0.0, 0.0, 0.0
    last, before, middle, lower = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    margin = 1e-9 * (b - a)
    p.crossed, p.crossed_share, crossing_from = math.inf, 0.0, math.nan
    e = 0
    while e < many and events[e].azimuth <= a + margin:
        e += 1
    for q in range(n + 1):
        phi, slope = (b - margin, 0.0) if q == n else panel_azimuth(gauss[0, base + q], p)
        first, inside = phi, 0
        while e < many and events[e].azimuth < phi:
            if inside == 0:
                first = events[e].azimuth
            inside += 1
            e += 1
        out[5] += inside
        thin += line_sliver(q, n, inside, first, events[max(0, e - 1)].azimuth, p, work.chart)
        if q == n:
            break
        found = scan_line(phi, view, work, scratch)
        if q == 0:
            signature = found
        elif found != signature and foreign != foreign:
            foreign = phi
        if p.step < 0.0 or found != signature:
            note_chambers(work)
        if is_spent(work):
            out[3] = math.inf
            return math.nan
        integrate_cells(phi, step, view, work, gauss, line)
        if view.conductors is not None and step > 0:
            crossed_pole(phi, crossing_from if found == signature else math.nan, n, p, work)
            crossing_from = held(phi)
        peak = max(peak, line[5])
        w = gauss[1, base + q] * slope
        for i in range(3):
            out[i] += w * line[i]
        grown = stretched(w)
        out[4] += grown * line[3]
        inner += grown * line[4]
        last = added(w * gauss[2, base + q], line, last)
        before = added(w * gauss[3, base + q], line, before)
        middle = added(w * gauss[MIDDLE, base + q], line, middle)
        lower = added(w * gauss[MIDDLE + 1, base + q], line, lower)
    size = out[4]
    uneven = out[5] > 0.0 or foreign == foreign
    dense = line_density(p, step, signature, peak, work)
    error = panel_error(p, n, step, Falls(last, before, middle, lower), size, thin, dense, uneven, view, work)
    if has_disk(view):
        # the rules over a disk light keep to the panel's level and err alike on every line
        inner += 3.0 * FALLS[step] * size
    out[3] = error + inner + 1e-15 * size
    return foreign


@jitable
def rough_panel(p: Panel, view: View, work: Work, gauss: Array, scratch: Array) -> None:
    """Settle a panel too thin to be cut by one line; all of its size is its error."""
    width = p.ends[1] - p.ends[0]
    phi = 0.5 * (p.ends[0] + p.ends[1])
    line = work.notes.line
    work.chart.apart = 0.5 * width
    scan_line(phi, view, work, scratch)
    integrate_cells(phi, 2, view, work, gauss, line)
    for i in range(3):
        p.value[i] = width * line[i]
    p.error = stretched(width) * line[3]
    p.step = 1
    p.settled = 1
