"""Ends of panels with a root, found to the last bit.

An event only known to 1e-8 costs a value 1e-12 but a slope 1e-4: ends with a root are bisected, those of a closed form
too, which is right to some 1e-14.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT
from symrender.chambers.line import scan_line
from symrender.chambers.work import View, Work
from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.quadrature.panel_maps import add_panel, panel_log
from symrender.quadrature.records import Panel

Array = npt.NDArray[np.float64]

NARROW = 1e-9
"""Panels thinner than this stay as they are."""
MERGED = 2e-13
"""Events closer than this are one that rounding blurs."""


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
