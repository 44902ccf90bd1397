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

from symrender.chambers.events import ROOT, SMOOTH, chart_events, crossing, line_range
from symrender.chambers.labels import HIDDEN
from symrender.chambers.line import scan_line
from symrender.chambers.walls import KIND, LOBE_BETA, MET_COLUMN, NORMAL, RIM_SIN, SHAPE_INDEX, SIN, STRIP
from symrender.chambers.work import CELLS, CHAMBERS, CROSSINGS, EVALUATIONS, WALLS, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_term import note_logs
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, order
from symrender.quadrature.split_line import integrate_cells

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

# panel columns
FROM = 0
TO = 1
KIND_FROM = 2
KIND_TO = 3
STEP = 4
VALUE = 5
ERROR = 8
LOG_RHO = 9
PANEL_COLUMNS = 12

SAFETY = 1.5
"""Error reported over the sum of the panels' estimates: of 2238 random points four missed the bare sum, by 1.3."""


@jitable
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


@jitable
def ellipse_log(x: float, y: float, a: float, b: float, kind_a: float, kind_b: float) -> float:
    """log rho of the Bernstein ellipse, in the mapped coordinate, through the singularity x + iy."""
    w = complex((x - a) / (b - a), y / (b - a))
    if kind_a == ROOT and kind_b == ROOT:
        # near either end the map is quadratic; the nearer one decides
        if w.real > 0.5:
            w = 1.0 - w
        w = (w**0.5) * (2.0 / math.pi)
    elif kind_a == ROOT:
        w = w**0.5
    elif kind_b == ROOT:
        w = 1.0 - (1.0 - w) ** 0.5
    s = abs(w) + abs(w - 1.0)
    return math.log(s + math.sqrt(max(0.0, s * s - 1.0)))


@jitable
def branch_log(
    a0: float, a1: float, a2: float, sine: float, a: float, b: float, kind_a: float, kind_b: float, best: float
) -> float:
    """Smallest of ``best`` and the log rho of a circle's tangencies to (complex) scan lines."""
    rho = math.hypot(a1, a2)
    if rho == 0.0:
        return best
    middle = math.atan2(a2, a1)
    ratio = sine / rho
    half = 0.5 * (b - a)
    centre = 0.5 * (a + b)
    if ratio >= 1.0:
        y = math.log(ratio + math.sqrt(ratio * ratio - 1.0))
        if y > 2.0 * half + 0.5:
            return best
        offset = 0.5 * math.pi
    else:
        y, offset = 0.0, math.asin(ratio)
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
        best = min(best, ellipse_log(x, y, a, b, kind_a, kind_b))
    return best


@jitable
def panel_log(work: Work, a: float, b: float, kind_a: float, kind_b: float) -> float:
    """log rho that decides a panel's node counts."""
    geo = work.geo
    half = 0.5 * (b - a)
    x = geo[STRIP + 1] / half
    if kind_a == ROOT or kind_b == ROOT:
        x *= 0.7
    best = math.log(x + math.sqrt(1.0 + x * x))
    best = branch_log(geo[LOBE_BETA + 1], geo[LOBE_BETA + 2], 0.0, geo[RIM_SIN], a, b, kind_a, kind_b, best)
    for i in range(work.counts[WALLS]):
        row = work.walls[i]
        if int(row[KIND]) <= NORMAL:
            best = branch_log(row[1], row[2], row[3], row[SIN], a, b, kind_a, kind_b, best)
    return best


@jitable
def add_panel(panels: Array, n: int, a: float, b: float, kind_a: float, kind_b: float, work: Work) -> int:
    """Append an unevaluated panel; new count."""
    if n < panels.shape[0]:
        p = panels[n]
        p[FROM], p[TO], p[KIND_FROM], p[KIND_TO], p[STEP] = a, b, kind_a, kind_b, -1.0
        p[5] = p[6] = p[7] = 0.0
        p[ERROR] = math.inf
        p[LOG_RHO] = panel_log(work, a, b, kind_a, kind_b)
    return n + 1


@jitable
def find_crossing(left: float, right: float, view: View, work: Work, ids: Ints, scratch: Array) -> float:
    """One event between two lines of different structure: a crossing of a pair of walls, else NaN."""
    scan_line(left, view, work, scratch)
    n = work.counts[CELLS]
    for i in range(n + 1):
        ids[0, i] = work.cell_wall[i]
    scan_line(right, view, work, scratch)
    m = work.counts[CELLS]
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
    a: float, b: float, kind_a: float, kind_b: float, scans: int, view: View, work: Work, panels: Array, n: int,
    spans: Array, ids: Ints, scratch: Array,
) -> int:  # fmt: skip
    """Cut [a, b] at the crossings found between scan lines and append its panels; new panel count.

    ``spans`` rows are (left, right, left signature, right signature) as a stack.
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
        spans[top, 0], spans[top, 1] = left, right
        ids[2, 2 * top], ids[2, 2 * top + 1] = left_signature, right_signature
        top += 1
        right, right_signature = left, left_signature
    start, start_kind = a, kind_a
    start_signature = left_signature
    while top > 0:
        top -= 1
        left, right = spans[top, 0], spans[top, 1]
        ls, rs = ids[2, 2 * top], ids[2, 2 * top + 1]
        if ls == rs:
            continue
        span = right - left
        if span < max(1e-8 * width, 1e-12) or top + 3 >= spans.shape[0]:
            middle = 0.5 * (left + right)
            if start_signature != 0:
                n = add_panel(panels, n, start, middle, start_kind, ROOT, work)
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
                        spans[top, 0], spans[top, 1] = hi, right
                        ids[2, 2 * top], ids[2, 2 * top + 1] = his, rs
                        top += 1
                        continue
                    spans[top, 0], spans[top, 1] = hi, right
                    ids[2, 2 * top], ids[2, 2 * top + 1] = his, rs
                    spans[top + 1, 0], spans[top + 1, 1] = lo, hi
                    ids[2, 2 * top + 2], ids[2, 2 * top + 3] = los, his
                    spans[top + 2, 0], spans[top + 2, 1] = left, lo
                    ids[2, 2 * top + 4], ids[2, 2 * top + 5] = ls, los
                    top += 3
                    continue
            else:
                phi = math.nan
        middle = 0.5 * (left + right)
        ms = scan_line(middle, view, work, scratch)
        spans[top, 0], spans[top, 1] = middle, right
        ids[2, 2 * top], ids[2, 2 * top + 1] = ms, rs
        spans[top + 1, 0], spans[top + 1, 1] = left, middle
        ids[2, 2 * top + 2], ids[2, 2 * top + 3] = ls, ms
        top += 2
    if start_signature != 0:
        n = add_panel(panels, n, start, b, start_kind, kind_b, work)
    return n


@jitable
def note_chambers(work: Work) -> None:
    """Count the labels of the scanned line that this point has not met before, and mark its walls as met."""
    for cell in range(work.counts[CELLS]):
        if cell > 0 and work.cell_wall[cell] >= 0:
            work.walls[work.cell_wall[cell] // 4, MET_COLUMN] = 1.0
        if work.cell_side[cell] == HIDDEN:
            continue
        key = (int(work.geo[SHAPE_INDEX]) + 2) * 1099511628211 + work.cell_side[cell]
        for i in range(work.lit.shape[1]):
            key = (key ^ work.lit[cell, i]) * 1099511628211
        known = min(work.counts[CHAMBERS], work.labels.shape[0])
        fresh = True
        for i in range(known):
            if work.labels[i] == key:
                fresh = False
                break
        if fresh:
            if known < work.labels.shape[0]:
                work.labels[known] = key
            work.counts[CHAMBERS] += 1


@jitable
def evaluate_panel(p: Array, step: int, view: View, work: Work, gauss: Array, out: Array, scratch: Array) -> float:
    """Integral of one panel at one order in out[0:3], its size in out[3]; azimuth of a foreign line, or NaN."""
    a, b, ka, kb = p[FROM], p[TO], p[KIND_FROM], p[KIND_TO]
    n = min(MAX_ORDER, order(step, p[LOG_RHO]) + (1 if step > 0 else 0))
    base = n * (n - 1) // 2
    out[0] = out[1] = out[2] = out[3] = 0.0
    signature = 0
    foreign = math.nan
    for q in range(n):
        phi, slope = azimuth(gauss[0, base + q], a, b, ka, kb)
        found = scan_line(phi, view, work, scratch)
        if q == 0:
            signature = found
            if step == 0:
                note_chambers(work)
        elif found != signature and foreign != foreign:
            foreign = phi
            break
        integrate_cells(phi, step, view, work, gauss, scratch[4:8])
        w = gauss[1, base + q] * slope
        for i in range(4):
            out[i] += w * scratch[4 + i]
    return foreign


@jitable
def rough_panel(p: Array, view: View, work: Work, gauss: Array, scratch: Array) -> None:
    """Settle a panel too thin to be cut by one line; all of its size is its error."""
    width = p[TO] - p[FROM]
    phi = 0.5 * (p[FROM] + p[TO])
    scan_line(phi, view, work, scratch)
    integrate_cells(phi, 2, view, work, gauss, scratch[4:8])
    for i in range(3):
        p[5 + i] = width * scratch[4 + i]
    p[ERROR] = width * scratch[7]
    p[STEP] = 1.0


@jitable
def split_chart(
    tol: float, view: View, work: Work, gauss: Array, panels: Array, spans: Array, ids: Ints, events: Array,
    scratch: Array, max_evaluations: int, value: Array,
) -> tuple[float, int]:  # fmt: skip
    """Add the charted shape's integral to ``value``; returns (error estimate, panels that stayed unresolved)."""
    low, high = line_range(work.geo)
    if not low < high:
        return 0.0, 0
    m = chart_events(work, events, low, high)
    note_logs(view, work)
    n = 0
    for i in range(m - 1):
        n = split_span(
            events[i, 0], events[i + 1, 0], events[i, 1], events[i + 1, 1], 2, view, work, panels, n, spans, ids,
            scratch,
        )  # fmt: skip
        if n >= panels.shape[0] - 2:
            break
    n = min(n, panels.shape[0])
    out = scratch[9:14]
    bad = 0
    for _ in range(64):
        total = 0.0
        for i in range(n):
            total += panels[i, ERROR]
        if SAFETY * total <= tol or work.counts[EVALUATIONS] > max_evaluations:
            break
        share = 0.5 * tol / max(1, n)
        many = n
        for i in range(many):
            p = panels[i]
            if p[ERROR] <= share or p[FROM] == p[TO]:
                continue
            step = int(p[STEP])
            if step + 1 >= len(LEVELS) or order(max(1, step + 1), p[LOG_RHO]) >= MAX_ORDER:
                if n >= panels.shape[0] or p[TO] - p[FROM] < 1e-9:
                    if step < 0:
                        rough_panel(p, view, work, gauss, scratch)
                    continue
                middle = 0.5 * (p[FROM] + p[TO])
                right, kind = p[TO], p[KIND_TO]
                left, left_kind = p[FROM], p[KIND_FROM]
                add_panel(panels, i, left, middle, left_kind, SMOOTH, work)
                n = add_panel(panels, n, middle, right, SMOOTH, kind, work)
                continue
            foreign = evaluate_panel(p, step + 1, view, work, gauss, out, scratch)
            if foreign == foreign:
                # the search between scan lines missed an event: search again on both sides of the line that told
                a, b, ka, kb = p[FROM], p[TO], p[KIND_FROM], p[KIND_TO]
                if b - a > 1e-8 and n + 8 < panels.shape[0]:
                    p[FROM] = p[TO] = a
                    p[5] = p[6] = p[7] = p[ERROR] = 0.0
                    n = split_span(a, foreign, ka, SMOOTH, 1, view, work, panels, n, spans, ids, scratch)
                    n = split_span(foreign, b, SMOOTH, kb, 1, view, work, panels, n, spans, ids, scratch)
                    continue
                rough_panel(p, view, work, gauss, scratch)
                bad += 1
                continue
            change = max(abs(out[0] - p[5]), abs(out[1] - p[6]), abs(out[2] - p[7]))
            p[5], p[6], p[7] = out[0], out[1], out[2]
            p[STEP] = step + 1.0
            if step < 0:
                # one line says little more than the order of magnitude
                p[ERROR] = 10.0 * out[3]
            else:
                # no step is believed to gain more than its order promises
                promise = math.exp(LEVELS[step] - LEVELS[step + 1]) * (0.3 if step == 0 else 1.0)
                p[ERROR] = max(change, promise * p[ERROR])
    error = 0.0
    for i in range(work.counts[WALLS]):
        if work.walls[i, MET_COLUMN] != 0.0:
            work.counts[CROSSINGS] += 1
    for i in range(n):
        p = panels[i]
        value[0] += p[5]
        value[1] += p[6]
        value[2] += p[7]
        error += SAFETY * p[ERROR]
    return error, bad
