"""How near lines and panels are to highlights, once those are found."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.work import Work
from symrender.jit.marks import inlined

Array = npt.NDArray[np.float64]


NARROW = 0.08
"""``narrow`` of highlights that are powers of a cosine: beside it they are soft, and coefficients soon tell of them."""
BETWEEN_POLES = 0.25
"""``narrow`` of those of conductors, which have poles as far off as they are wide."""
SPACING = 1.05
"""Gauss nodes of a piece are no farther apart than pi/2 of its length over their number, 3 widths."""


@inlined
def nearest_sum(a: float, b: float, first: float, last: float, y: float) -> float:
    """rho + 1/rho over 2 of the Bernstein ellipse of a..b through the nearest of the places first..last, y off."""
    x = min(max(0.5 * (a + b), first), last)
    return (math.sqrt((x - a) ** 2 + y * y) + math.sqrt((x - b) ** 2 + y * y)) / (b - a)


@inlined
def highlights_between(a: float, b: float, work: Work) -> tuple[float, float]:
    """Of highlights felt between two azimuths: the smallest ``nearest_sum`` of narrow ones, and the narrowest strip.

    Both are inf where there are none.
    """
    nearest, narrowest = math.inf, math.inf
    rows = work.highlights
    for i in range(work.counts.highlights):
        row = rows[i]
        if row.first < b and row.last > a:
            narrowest = min(narrowest, row.strip)
            if row.strip < work.chart.narrow:
                nearest = min(nearest, nearest_sum(a, b, row.first, row.last, row.strip))
    return nearest, narrowest


@inlined
def highlight_end(a: float, b: float, work: Work) -> float:
    """Where to cut azimuths a..b: where a highlight begins or ends well inside, else in the middle."""
    middle = 0.5 * (a + b)
    margin = 0.1 * (b - a)
    best = 0.5 * (b - a)
    found = middle
    rows = work.highlights
    for i in range(work.counts.highlights):
        for x in (rows[i].first, rows[i].last):
            if a + margin < x < b - margin and abs(x - middle) < best:
                found, best = x, abs(x - middle)
    return found


@inlined
def line_highlights(phi: float, work: Work) -> None:
    """Note those felt on the scan line at azimuth ``phi``."""
    n, rows = 0, work.highlights
    for i in range(work.counts.highlights):
        if rows[i].first <= phi <= rows[i].last:
            work.felt[n] = i
            n += 1
    work.counts.felt = n


@inlined
def piece_highlights(start: float, stop: float, work: Work) -> tuple[float, float]:
    """As ``highlights_between``, of those felt on start..stop of the line of which ``line_highlights`` took note."""
    nearest, narrowest = math.inf, math.inf
    for i in range(work.counts.felt):
        row = work.highlights[work.felt[i]]
        if stop >= row.innermost and start <= row.outermost:
            narrowest = min(narrowest, row.along)
            if row.along < work.chart.narrow:
                nearest = min(nearest, nearest_sum(start, stop, row.innermost, row.outermost, row.along))
    return nearest, narrowest


@inlined
def seeing(length: float, strip: float) -> int:
    """Gauss nodes of a piece of which one at least lies within 1.6 widths of any highlight whose strip is this."""
    return math.ceil(min(1e6, SPACING * length / strip))
