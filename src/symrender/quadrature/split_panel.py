"""The outer integral of the split rule: panels of azimuth between events, refined by order until they agree.

A panel has one structure: the same walls in the same order with the same labels on every line. Its two-dimensional
integral is then analytic in both coordinates, after a square-root event at an end is removed by a quadratic map, and
Gauss rules converge geometrically. Two successive orders give the error estimate. Every quadrature line proves the
structure again; a line that disagrees sends its panel back to the event search.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.crossings import all_events
from symrender.chambers.events import ROOT, SMOOTH, crossing, line_range
from symrender.chambers.highlights import find_highlights, highlight_end, highlights_between, seeing
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import rim_interval, scan_line
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.lobes.width import broken_rim
from symrender.chambers.records import Chart, Event, Spot
from symrender.chambers.senders import find_sent, sender_of
from symrender.chambers.walls import (
    BALL,
    NORMAL,
    UNBOUNDED,
    tangent_lines,
)
from symrender.chambers.work import View, Work, is_crowded, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.crossed_poles import crossed_pole
from symrender.quadrature.gauss import FALLS, LEVELS, MAX_ORDER, MIDDLE, NODE_GAP, order
from symrender.quadrature.records import Panel, Span
from symrender.quadrature.split_line import across_error, ends_bluntly, has_disk, integrate_cells, kinked

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


LINE = 32
PANEL = 40
"""Where the sums of a line and of a panel lie in the scratch array."""
MAX_FIRST = 3
"""Most lines of a panel's first estimate."""
NARROW = 1e-13
"""Share of a span in which an event is found by halving where numbers move."""
MUCH = 40.0
"""How many times its share a panel with events inside may hold and still be tried in one piece."""
MAX_KINKED = 5
"""Most lines of a panel with events inside, before it is cut there."""
ROUNDED_LEVEL = 2.5e-16
"""Error of the cosine of a circle, and of a place's cosine from its axis."""
FINE = 0.05
"""Share of the tolerance that refined means over disks may take."""
SPARE = 8
"""Panels kept for the spans at hand when no others are cut: each adds one at most, and none is lost."""
FELT_ROOT = 0.1
"""Share of a panel's length from which on a square root beyond its end is left to the error estimate."""
WEAK = 0.25
"""Share of a panel's last coefficients that what is weak is taken to hold."""
FELT_LINES = 20.0
"""Twice the lines of a panel of which singularities are compared that choose no node counts."""
SAFETY = 4.0
"""Error reported over the sum of the panels' estimates."""
UNFALLEN = 1.0
"""Share of a panel's size from which on its last coefficients are those of a spike between lines, and tell nothing."""
FLANK = 100.0
"""By how much the flank of a highlight may be brighter between its panel's lines than on them."""


@inlined
def azimuth(u: float, a: float, b: float, kind_a: float, kind_b: float) -> tuple[float, float]:
    """Azimuth and its derivative at u in [0, 1]: quadratic at an end with a square root."""
    length = b - a
    if kind_a == ROOT and kind_b == ROOT:
        h = 0.5 * math.pi
        s, c = math.sin(h * u), math.cos(h * u)
        if u < 0.5:
            return a + length * s * s, length * math.pi * s * c
        return b - length * c * c, length * math.pi * s * c
    if kind_a == ROOT:
        return a + length * u * u, 2.0 * length * u
    if kind_b == ROOT:
        return b - length * (1.0 - u) * (1.0 - u), 2.0 * length * (1.0 - u)
    return a + length * u, length


@inlined
def panel_azimuth(u: float, p: Panel) -> tuple[float, float]:
    """``azimuth`` of a panel, whose map begins where its square roots do."""
    first, last = p.roots[0], p.roots[1]
    if first == 0.0 and last == 0.0:
        return azimuth(u, p.ends[0], p.ends[1], p.kinds[0], p.kinds[1])
    a, b = p.ends[0] - first, p.ends[1] + last
    low, high = math.sqrt(first / (b - a)), 1.0 - math.sqrt(last / (b - a))
    if p.kinds[0] == ROOT and p.kinds[1] == ROOT:
        half = 0.5 * math.pi
        low, high = math.asin(low) / half, math.acos(1.0 - high) / half
    phi, slope = azimuth(low + (high - low) * u, a, b, p.kinds[0], p.kinds[1])
    return phi, slope * (high - low)


@jitable
def ellipse_sum(x: float, y: float, a: float, b: float, kind_a: float, kind_b: float) -> float:
    """rho + 1/rho over 2 of the Bernstein ellipse, in the mapped coordinate, through the singularity x + iy."""
    u, v = (x - a) / (b - a), y / (b - a)
    if kind_a == ROOT or kind_b == ROOT:
        # near either end the map is quadratic; the nearer one decides
        far = kind_a != ROOT or (kind_b == ROOT and u > 0.5)
        if far:
            u = 1.0 - u
        r = math.sqrt(u * u + v * v)
        u, v = math.sqrt(max(0.0, 0.5 * (r + u))), math.sqrt(max(0.0, 0.5 * (r - u)))
        if kind_a == kind_b:
            # sin^2 of a right angle times the mapped coordinate
            one, other = math.sqrt((u + 1.0) ** 2 + v * v), math.sqrt((u - 1.0) ** 2 + v * v)
            deep = max(1.0, 0.5 * (one + other))
            u = (2.0 / math.pi) * math.asin(max(-1.0, min(1.0, 0.5 * (one - other))))
            v = (2.0 / math.pi) * math.log(deep + math.sqrt(deep * deep - 1.0))
    return math.sqrt(u * u + v * v) + math.sqrt((u - 1.0) * (u - 1.0) + v * v)


@jitable
def branch_sum(
    middle: float, offset: float, y: float, a: float, b: float, kind_a: float, kind_b: float, best: float
) -> float:
    """Smallest of ``best`` and the ``ellipse_sum`` of a circle's tangencies to scan lines (see ``tangent_lines``)."""
    half = 0.5 * (b - a)
    centre = 0.5 * (a + b)
    if y > 2.0 * half + 0.5:
        return best
    for branch in range(4):
        x = middle + (offset if branch < 2 else math.pi - offset) * (1.0 if branch % 2 == 0 else -1.0)
        x -= 2.0 * math.pi * math.floor((x - centre + math.pi) / (2.0 * math.pi))
        if abs(x - centre) > 3.0 * half + 0.1:
            continue
        if y == 0.0 and (abs(x - a) < 1e-9 or abs(x - b) < 1e-9):
            continue
        if y == 0.0 and a < x < b:
            # a tangency outside the lobe or behind the limb: no singularity of this panel
            continue
        best = min(best, ellipse_sum(x, y, a, b, kind_a, kind_b))
    return best


@inlined
def spot_sum(spot: Spot, a: float, b: float, kind_a: float, kind_b: float) -> float:
    """``ellipse_sum`` of one of the chart's spots."""
    away = spot.azimuth - 0.5 * (a + b)
    away -= 2.0 * math.pi * math.floor(away / (2.0 * math.pi) + 0.5)
    if spot.depth == 0.0 and abs(away) < 0.5 * (b - a):
        # the lines of this panel end before it
        return math.inf
    return ellipse_sum(0.5 * (a + b) + away, spot.depth, a, b, kind_a, kind_b)


@inlined
def felt_spot(work: Work, p: Panel) -> None:
    """Give a panel the spot that it feels most of those that choose no node counts."""
    p.slow, p.share, most = math.inf, 0.0, 0.0
    for i in range(work.counts.spots):
        spot = work.spots[i]
        if spot.share < 1.0:
            rho = spot_sum(spot, p.ends[0], p.ends[1], p.kinds[0], p.kinds[1])
            slow = math.log(rho + math.sqrt(max(0.0, rho * rho - 1.0)))
            felt = spot.share * math.exp(-FELT_LINES * slow)
            if felt > most:
                p.slow, p.share, most = slow, spot.share, felt


@jitable
def swept_log(a: float, b: float, kind_a: float, kind_b: float, chart: Chart) -> float:
    """log rho of a panel over whose veins the lobe's rim sweeps: along the lines they are tame in a strip only."""
    least_low, most_low, least_high, most_high = math.inf, 0.0, math.inf, 0.0
    for q in range(3):
        phi, _ = azimuth(0.01 + 0.49 * q, a, b, kind_a, kind_b)
        low, high, _, _ = rim_interval(math.cos(phi), math.sin(phi), chart)
        if low < high:
            least_low, most_low = min(least_low, low), max(most_low, low)
            least_high, most_high = min(least_high, high), max(most_high, high)
    sweep = max(most_low - least_low, most_high - least_high)
    if not sweep > 0.0:
        return math.inf
    x = 2.0 * chart.strip_vein / sweep
    return math.log(x + math.sqrt(1.0 + x * x))


@inlined
def panel_log(work: Work, a: float, b: float, kind_a: float, kind_b: float) -> float:
    """log rho that decides a panel's node counts."""
    chart = work.chart
    half = 0.5 * (b - a)
    x = chart.strip_across / half
    if kind_a == ROOT or kind_b == ROOT:
        x *= 0.7
    best = math.sqrt(1.0 + x * x)
    highlight, _ = highlights_between(a, b, work)
    if kind_a == ROOT or kind_b == ROOT:
        # its excess over 1 is the square of what lies off the line
        highlight = 1.0 + 0.5 * (highlight - 1.0)
    best = min(best, highlight)
    for i in range(work.counts.spots):
        if work.spots[i].share == 1.0:
            best = min(best, spot_sum(work.spots[i], a, b, kind_a, kind_b))
    if chart.lobe.rim_cos >= 0.0:
        middle, offset, depth = tangent_lines(chart.lobe_sin, 0.0, chart.lobe.rim_sin)
        best = branch_sum(middle, offset, depth, a, b, kind_a, kind_b, best)
    for i in range(work.counts.walls):
        row = work.walls[i]
        if row.kind <= NORMAL or (chart.shape_index < 0.0 and row.kind <= BALL):
            best = branch_sum(row.touch_azimuth, row.touch_offset, row.touch_depth, a, b, kind_a, kind_b, best)
    log_rho = math.log(best + math.sqrt(max(0.0, best * best - 1.0)))
    if chart.strip_vein < math.inf:
        log_rho = min(log_rho, swept_log(a, b, kind_a, kind_b, chart))
    return log_rho


@inlined
def panel_density(a: float, b: float, chart: Chart) -> float:
    """The lobe's largest density between two azimuths, on the charted shape."""
    phi = min(max(0.0, a), b)
    along = chart.lobe_sin * math.cos(phi)
    beta = math.atan2(along, chart.lobe_cos)
    if beta < 0.0 and chart.lobe_cos < 0.0:
        # the axis is behind on both counts: the nearest is one end or the other
        s, c = math.sin(chart.beta_max), math.cos(chart.beta_max)
        beta = chart.beta_max if c * chart.lobe_cos + s * along > chart.lobe_cos else 0.0
    beta = min(max(0.0, beta), chart.beta_max)
    s, c = math.sin(beta), math.cos(beta)
    d0, d1, d2 = c - chart.lobe_cos, s * math.cos(phi) - chart.lobe_sin, s * math.sin(phi)
    return float(largest_density(d0 * d0 + d1 * d1 + d2 * d2, chart.lobe))


@inlined
def panel_bound(a: float, b: float, chart: Chart) -> float:
    """What a panel can hold at most: its solid angle at the lobe's largest density and the largest radiance there."""
    half = math.sin(0.5 * chart.beta_max)
    return float(chart.bright) * min(1.0, panel_density(a, b, chart) * (b - a) * 2.0 * half * half)


@inlined
def sliver_bound(a: float, b: float, chart: Chart) -> float:
    """What may open and close again between two azimuths: no more of a line there than the azimuths are of a radian."""
    return (b - a) * panel_bound(a, b, chart)


@jitable
def add_panel(panels: Table[Panel], n: int, a: float, b: float, kind_a: float, kind_b: float, work: Work) -> int:
    """Append an unevaluated panel; new count."""
    if n < panels.shape[0]:
        p = panels[n]
        p.ends[0], p.ends[1], p.kinds[0], p.kinds[1], p.step = a, b, kind_a, kind_b, -1
        p.roots[0] = p.roots[1] = p.blind = 0.0
        p.value[0] = p.value[1] = p.value[2] = 0.0
        p.bound = p.error = held(panel_bound(a, b, work.chart))
        p.inside = p.settled = 0
        p.foreign = math.nan
        p.per_radian = 0.0
        _, narrowest = highlights_between(a, b, work)
        p.glare = seeing(b - a, narrowest)
        if narrowest < math.inf:
            # a rim or a wall that sweeps over a highlight narrow along the lines hides it within less
            p.glare = max(p.glare, MAX_KINKED if work.chart.clipped != 0.0 else MAX_FIRST + 1)
        p.log_rho = panel_log(work, a, b, kind_a, kind_b)
        felt_spot(work, p)
    return n + 1


@jitable
def find_crossing(left: float, right: float, view: View, work: Work, ids: Ints, scratch: Array) -> float:
    """One event between two lines of different structure: a crossing of a pair of walls, else NaN."""
    scan_line(left, view, work, scratch)
    n = work.counts.cells
    for i in range(n + 1):
        ids[0, i] = work.cell_wall[i]
    scan_line(right, view, work, scratch)
    m = work.counts.cells
    for i in range(m + 1):
        ids[1, i] = work.cell_wall[i]
    if n == 0 or m == 0:
        return math.nan
    i = 0
    while i < n and i < m and ids[0, i] == ids[1, i]:
        i += 1
    # the wall that differs first crossed the one it changed places with, or vanished into a neighbour
    for attempt in range(5):
        if attempt == 0:
            one, other = ids[0, i], ids[1, i]
        elif attempt < 3:
            k = i + 1 if attempt == 1 else i - 1
            if k < 0 or k > n:
                continue
            one, other = ids[0, i], ids[0, k]
        else:
            k = i + 1 if attempt == 3 else i - 1
            if k < 0 or k > m:
                continue
            one, other = ids[1, i], ids[1, k]
        if one != other:
            phi = crossing(one, other, left, right, work, scratch)
            if phi == phi:
                return phi
    return math.nan


@jitable
def split_span(
    a: float, b: float, kind_a: float, kind_b: float, scans: int, view: View, work: Work, panels: Table[Panel], n: int,
    spans: Table[Span], ids: Ints, scratch: Array,
) -> int:  # fmt: skip
    """Cut [a, b] at the crossings found between scan lines and append its panels; new panel count.

    ``spans`` rows are (left, right, left signature, right signature) as a stack. Long because what ends a search early
    has to leave every azimuth in some panel.
    """
    width = b - a
    if not width > 0.0:
        return n
    inset = 1e-9 * width
    top = 0
    # rightmost span lies deepest, so panels come out from left to right
    right = b - inset
    right_signature = scan_line(right, view, work, scratch)
    for i in range(scans, -1, -1):
        left = a + inset if i == 0 else a + width * i / (scans + 1.0)
        left_signature = scan_line(left, view, work, scratch)
        spans[top].left, spans[top].right = left, right
        ids[2, 2 * top], ids[2, 2 * top + 1] = left_signature, right_signature
        top += 1
        right, right_signature = left, left_signature
    start, start_kind = a, kind_a
    start_signature = left_signature
    first, sliver = n, 0.0
    while top > 0:
        top -= 1
        left, right = spans[top].left, spans[top].right
        ls, rs = ids[2, 2 * top], ids[2, 2 * top + 1]
        if ls == rs:
            continue
        span = right - left
        narrow = span < (max(NARROW * width, 1e-14) if moves(span) else max(1e-8 * width, 1e-12))
        if narrow or top + 3 >= spans.shape[0] or n + top + SPARE >= panels.shape[0] or is_spent(work):
            middle = held(0.5 * (left + right))
            if not narrow and (ls == 0 or rs == 0):
                # what was not looked at may be seen, whatever its ends see
                if start_signature == 0:
                    start, start_kind = left, SMOOTH
                if rs == 0:
                    n = add_panel(panels, n, start, right, start_kind, SMOOTH, work)
                    start = right
                start_signature = rs
                continue
            if start_signature != 0:
                n = add_panel(panels, n, start, middle, start_kind, ROOT, work)
            sliver = max(sliver, held(span))
            start, start_kind, start_signature = middle, ROOT, rs
            continue
        phi = find_crossing(left, right, view, work, ids, scratch)
        if phi == phi:
            gap = 2e-9 * width
            lo, hi = phi - gap, phi + gap
            if lo > left and hi < right:
                los = scan_line(lo, view, work, scratch)
                his = scan_line(hi, view, work, scratch)
                if los == his:
                    # a crossing that changes nothing: halve instead
                    phi = math.nan
                else:
                    # right part first
                    if ls == los:
                        # common case: left part is settled
                        if start_signature != 0:
                            n = add_panel(panels, n, start, phi, start_kind, SMOOTH, work)
                        start, start_kind, start_signature = phi, SMOOTH, his
                        spans[top].left, spans[top].right = hi, right
                        ids[2, 2 * top], ids[2, 2 * top + 1] = his, rs
                        top += 1
                        continue
                    spans[top].left, spans[top].right = hi, right
                    ids[2, 2 * top], ids[2, 2 * top + 1] = his, rs
                    spans[top + 1].left, spans[top + 1].right = lo, hi
                    ids[2, 2 * top + 2], ids[2, 2 * top + 3] = los, his
                    spans[top + 2].left, spans[top + 2].right = left, lo
                    ids[2, 2 * top + 4], ids[2, 2 * top + 5] = ls, los
                    top += 3
                    continue
            else:
                phi = math.nan
        middle = 0.5 * (left + right)
        ms = scan_line(middle, view, work, scratch)
        spans[top].left, spans[top].right = middle, right
        ids[2, 2 * top], ids[2, 2 * top + 1] = ms, rs
        spans[top + 1].left, spans[top + 1].right = left, middle
        ids[2, 2 * top + 2], ids[2, 2 * top + 3] = ls, ms
        top += 2
    if start_signature != 0:
        n = add_panel(panels, n, start, b, start_kind, kind_b, work)
    if moves(width):
        # of what opens there like a square root, a sliver holds so much of the tangent
        for k in range(first, min(n, panels.shape[0])):
            panels[k].blind = math.sqrt(sliver / max(held(panels[k].ends[1] - panels[k].ends[0]), 1e-300))
    return n


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
    thin: float, dense: float, uneven: bool, view: View, work: Work,
) -> float:  # fmt: skip
    """Error of a panel's rule of ``n`` lines by the last coefficients across them.

    Of what the panel holds, and where numbers move of what that changes by: coefficients, ``size``, ``bound`` and
    ``thin`` are then of the tangents. Arguments are many because they are asked of both.
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
    known = max(known, share * size * math.exp(-2.0 * n * slow) / (2.0 * n * math.sqrt(2.0 * n)))
    # where a wall and a pole cross, coefficients may be small by chance
    known = max(known, held(p.crossed_share) * size * math.exp(-2.0 * n * held(p.crossed)) / (2.0 * n))
    if kinked(view) or ends_bluntly(view, work.chart) or broken_rim(work.chart.lobe):
        known = max(known, last, 0.5 * before)
    error = max(2.0 * max(across_error(n, last, before, middle, lower, size, log_rho), known), unseen)
    if p.glare > 0 and top > UNFALLEN * size:
        # what lies of a highlight between lines may be far brighter than on them
        error = max(error, min(bound, FLANK * size))
    return error


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
    line = scratch[LINE : LINE + 6]
    for i in range(6):
        out[i] = 0.0
    signature = 0
    foreign = math.nan
    inner, thin, peak = 0.0, 0.0, 0.0
    last0, last1, last2, before0, before1, before2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    middle0, middle1, middle2, lower0, lower1, lower2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
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
        # between two lines, or a line and an end, a sliver may open and close again
        if inside > 0 and q == 0:
            thin += sliver_bound(a, events[e - 1].azimuth, work.chart)
        elif inside > 0 and q == n:
            thin += sliver_bound(first, b, work.chart)
        elif inside > 1:
            thin += sliver_bound(first, events[e - 1].azimuth, work.chart)
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
        if view.conductors is not None and step > 0:
            crossed_pole(phi, crossing_from if found == signature else math.nan, n, p, work)
            crossing_from = held(phi)
        integrate_cells(phi, step, view, work, gauss, line)
        peak = max(peak, line[5])
        w = gauss[1, base + q] * slope
        for i in range(3):
            out[i] += w * line[i]
        grown = stretched(w)
        out[4] += grown * line[3]
        inner += grown * line[4]
        t = w * gauss[2, base + q]
        last0 += t * line[0]
        last1 += t * line[1]
        last2 += t * line[2]
        t = w * gauss[3, base + q]
        before0 += t * line[0]
        before1 += t * line[1]
        before2 += t * line[2]
        t = w * gauss[MIDDLE, base + q]
        middle0 += t * line[0]
        middle1 += t * line[1]
        middle2 += t * line[2]
        t = w * gauss[MIDDLE + 1, base + q]
        lower0 += t * line[0]
        lower1 += t * line[1]
        lower2 += t * line[2]
    last = max(abs(last0), abs(last1), abs(last2))
    before = max(abs(before0), abs(before1), abs(before2))
    middle, lower = max(abs(middle0), abs(middle1), abs(middle2)), max(abs(lower0), abs(lower1), abs(lower2))
    size = out[4]
    uneven = out[5] > 0.0 or foreign == foreign
    dense = 1.0
    if step == 0 or (work.chart.lobe.kind == CONDUCTOR and signature != 0):
        # a line or two say little more than the order of magnitude, where the lobe is as dense as there: that a panel
        # holds little is believed of its bound only
        dense = max(1.0, panel_density(a, b, work.chart) / max(peak, 1e-300))
    error = rule_error(
        p, n, step, last, before, middle, lower, size, held(p.bound), held(thin), held(dense), uneven, view, work
    )
    if moves(error):
        rate = tangent(size) / max(held(size), 1e-300)
        missed = rule_error(
            p, n, step, steepest(last0, last1, last2), steepest(before0, before1, before2),
            steepest(middle0, middle1, middle2), steepest(lower0, lower1, lower2), tangent(size),
            rate * held(p.bound), rate * held(thin), held(dense), uneven, view, work,
        )  # fmt: skip
        error = moved(held(error), held(missed) + held(p.blind) * tangent(size))
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
    line = scratch[LINE : LINE + 6]
    work.chart.apart = 0.5 * width
    scan_line(phi, view, work, scratch)
    integrate_cells(phi, 2, view, work, gauss, line)
    for i in range(3):
        p.value[i] = width * line[i]
    p.error = stretched(width) * line[3]
    p.step = 1
    p.settled = 1


@jitable
def inside(p: Panel, events: Table[Event], many: int) -> int:
    """How many of the ``many`` events lie inside a panel."""
    margin = 1e-9 * (p.ends[1] - p.ends[0])
    found = 0
    for e in range(many):
        if p.ends[0] + margin < events[e].azimuth < p.ends[1] - margin:
            found += 1
    return found


@jitable
def cut_panel(
    p: Panel, i: int, events: Table[Event], many: int, work: Work, panels: Table[Panel], n: int
) -> int:  # fmt: skip
    """Cut panel ``i`` at the events inside it; new count.

    A square root at an end of the whole is felt in all parts that are not short beside their distance from it.
    """
    start, stop, first_kind, last_kind = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1]
    left, right = start - p.roots[0], stop + p.roots[1]
    mean, first, blind = p.per_radian, n, p.blind
    margin = 1e-9 * (stop - start)
    slot, begin = i, start
    for e in range(many + 1):
        phi = events[e].azimuth if e < many else stop
        if e < many and not (phi > begin + margin and phi < stop - margin):
            continue
        near, far = begin - left, right - phi
        kind = first_kind if begin == start or near < FELT_ROOT * (phi - begin) else SMOOTH
        end_kind = last_kind if phi == stop or far < FELT_ROOT * (phi - begin) else SMOOTH
        if slot == i:
            add_panel(panels, i, begin, phi, kind, end_kind, work)
        else:
            n = add_panel(panels, n, begin, phi, kind, end_kind, work)
        if slot < panels.shape[0]:
            panels[slot].roots[0] = near if kind == ROOT else 0.0
            panels[slot].roots[1] = far if end_kind == ROOT else 0.0
        slot, begin = n, phi
    panels[i].per_radian, panels[i].blind = mean, blind
    for k in range(first, min(n, panels.shape[0])):
        panels[k].per_radian, panels[k].blind = mean, blind
    return n


@jitable
def rounded_walls(work: Work) -> float:
    """What the rounding of the circles of normals that lines met may move from one side of them to the other.

    A level rounded by e moves a circle of half-angle a by e/sin a, of places R e/sin a, seen from the distance t of
    its nearest place: a strip of at most R e/(t sin a) times min(2 pi, 2 pi R sin a/t). It is felt where a low point
    sees a tiny ball stand in a huge one.
    """
    chart, most = work.chart, 0.0
    if chart.shape_index < 0 or chart.bright >= UNBOUNDED:
        return most
    gap = (1.0 - chart.ratio) / chart.ratio
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        if row.kind != NORMAL or row.met == 0.0:
            continue
        turned = row.axis[0] * row.cos + math.sqrt(max(0.0, 1.0 - row.axis[0] * row.axis[0])) * row.sin
        away = math.sqrt(gap * gap + 2.0 * max(0.0, 1.0 - turned) / chart.ratio)
        sine = max(row.sin, 1e-300)
        most += min(4.0, ROUNDED_LEVEL / (away * sine)) * 2.0 * math.pi * min(1.0, sine / away)
    low = max(0.0, chart.lobe_beta - chart.beta_max)
    return chart.bright * min(1.0, largest_density(4.0 * math.sin(0.5 * min(low, math.pi)) ** 2, chart.lobe) * most)


@jitable
def split_chart(
    tol: float, view: View, work: Work, gauss: Array, panels: Table[Panel], spans: Table[Span], ids: Ints, events:
    Table[Event], scratch: Array, max_evaluations: int, value: Array,
) -> tuple[float, int]:  # fmt: skip
    """Add the charted shape's integral to ``value``; returns (error estimate, panels that stayed unresolved)."""
    low, high = line_range(work.chart)
    if not low < high:
        return 0.0, 0
    work.chart.fine = FINE * tol / (SAFETY * max(1e-300, work.chart.bright))
    bound = SAFETY * panel_bound(low, high, work.chart)
    if bound < 0.1 * tol:
        return bound, 0
    if is_crowded(work):
        # a wall that nobody knows of may run through any line
        return moved(held(bound), math.inf) if moves(bound) else bound, 0
    sender = sender_of(view, work.chart)
    if sender >= 0:
        left_out = find_sent(tol, low, high, sender, view, work)
    else:
        left_out = find_highlights(tol, low, high, view, work)
    m = all_events(view, work, events, low, high)
    n = 0
    start = 0
    for e in range(1, m):
        if e + 1 == m or (events[e].kind >= SMOOTH and n + SPARE < panels.shape[0]):
            n = add_panel(panels, n, events[start].azimuth, events[e].azimuth, events[start].kind, events[e].kind, work)
            start = e
    n = min(n, panels.shape[0])
    out = scratch[PANEL : PANEL + 6]
    bad = 0
    for _ in range(64):
        total, accepted, open_panels = 0.0, 0.0, 0
        for i in range(n):
            total += panels[i].error
        if SAFETY * total <= tol or is_spent(work):
            break
        share = 0.5 * tol / (SAFETY * max(1, n))
        for i in range(n):
            if panels[i].error <= share or panels[i].settled != 0.0:
                accepted += panels[i].error
            else:
                open_panels += 1
        share = max(share, 0.7 * (tol / SAFETY - accepted) / max(1, open_panels))
        known = n
        for i in range(known):
            p = panels[i]
            if p.error <= share or p.settled != 0.0:
                continue
            step = p.step
            width = p.ends[1] - p.ends[0]
            if step < 0:
                p.inside = inside(p, events, m)
            if p.inside > 0.0 and n + p.inside + 2 < panels.shape[0]:
                # events are known inside: cut there, unless a few lines may be enough
                if step > 0 or p.error > MUCH * share:
                    n = cut_panel(p, i, events, m, work, panels, n)
                    continue
            elif step > 0 and p.foreign == p.foreign:
                # an event without a closed form: search on both sides of the line that told
                a, b, ka, kb, middle = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1], p.foreign
                if width > 1e-8 and n + SPARE < panels.shape[0]:
                    p.ends[0] = p.ends[1] = a
                    p.value[0] = p.value[1] = p.value[2] = p.error = 0.0
                    n = split_span(a, middle, ka, SMOOTH, 1, view, work, panels, n, spans, ids, scratch)
                    n = split_span(middle, b, SMOOTH, kb, 1, view, work, panels, n, spans, ids, scratch)
                    n = min(n, panels.shape[0])
                    continue
                if width > 1e-8:
                    # no room for its parts, and one line tells little of so wide a panel
                    p.error, p.settled = p.bound, 1
                    continue
                rough_panel(p, view, work, gauss, scratch)
                bad += 1
                continue
            need = step + 1
            holds = p.error if step > 0 else 10.0 * p.per_radian * width
            if step < 0 and (p.inside > 0.0 or holds > 3.0 * share or p.glare > MAX_FIRST):
                need = 1
            if p.inside == 0.0 and need > 0:
                # a first estimate is ten times what the panel holds
                aim = LEVELS[max(0, step)] + math.log(max(holds, 1e-300) / share) + 0.5 - (2.3 if step <= 0 else 0.0)
                while need + 1 < len(LEVELS) and LEVELS[need] < aim:
                    need += 1
            if need >= len(LEVELS) or p.glare > MAX_ORDER or (step >= 0 and panel_order(need, p.log_rho) >= MAX_ORDER):
                if n >= panels.shape[0] or width < 1e-9:
                    if step < 0 and width < 1e-9:
                        rough_panel(p, view, work, gauss, scratch)
                    p.settled = 1
                    continue
                middle = highlight_end(p.ends[0], p.ends[1], work)
                right, kind = p.ends[1], p.kinds[1]
                left, left_kind = p.ends[0], p.kinds[0]
                near, far, blind = p.roots[0], p.roots[1], p.blind
                add_panel(panels, i, left, middle, left_kind, SMOOTH, work)
                n = add_panel(panels, n, middle, right, SMOOTH, kind, work)
                p.roots[0], panels[n - 1].roots[1] = near, far
                p.blind = panels[n - 1].blind = blind
                continue
            foreign = evaluate_panel(p, need, view, work, gauss, events, m, out, scratch)
            if out[3] == math.inf:
                break
            p.value[0], p.value[1], p.value[2] = out[0], out[1], out[2]
            p.step = need
            p.error = out[3]
            p.inside = out[5]
            p.foreign = foreign
            p.per_radian = out[4] / width
            if moves(width):
                p.per_radian = moved(held(p.per_radian), tangent(out[4]) / held(width))
    error = held(left_out) + held(rounded_walls(work))
    for i in range(work.counts.walls):
        if work.walls[i].met != 0.0:
            work.counts.crossings += 1
    for i in range(n):
        p = panels[i]
        value[0] += p.value[0]
        value[1] += p.value[1]
        value[2] += p.value[2]
        error += SAFETY * p.error
        if moves(error) and p.step >= 0:
            width = held(p.ends[1] - p.ends[0])
            scratch[62] += held(p.per_radian) * width
            scratch[63] += tangent(p.per_radian) * width
            scratch[64] += SAFETY * held(p.error) if p.step > 0 else 0.0
    return error, bad
