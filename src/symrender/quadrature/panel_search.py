"""Panels between events that no closed form tells: searched for between lines of different structure."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT, SMOOTH, crossing
from symrender.chambers.line import scan_line
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import jitable
from symrender.jit.moving import held, moves
from symrender.jit.records import Table
from symrender.quadrature.panel_maps import (
    add_panel,
)
from symrender.quadrature.records import Panel, Span

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NARROW = 1e-13
"""Share of a span in which an event is found by halving where numbers move."""
SPARE = 8
"""Panels kept for the spans at hand when no others are cut: each adds one at most, and none is lost."""


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
    # lines of a search may lie as near to a crossing as they like
    work.chart.apart = 0.0
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
