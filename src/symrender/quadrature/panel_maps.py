"""Panels of azimuth: how they are mapped, how tame what they hold is, and what they can hold at most."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT
from symrender.chambers.highlight_strips import highlights_between, seeing
from symrender.chambers.line import rim_interval
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.records import Chart, Spot
from symrender.chambers.walls import (
    BALL,
    NORMAL,
    is_rooted,
    tangent_lines,
)
from symrender.chambers.work import Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.jit.records import Table
from symrender.quadrature.paces import unseen_panel
from symrender.quadrature.records import Panel

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MAX_FIRST = 3
"""Most lines of a panel's first estimate."""
MAX_KINKED = 5
"""Most lines of a panel with events inside, before it is cut there."""
AT_END = 1e-9
"""Difference of two azimuths up to which they are one."""
FELT_LINES = 20.0
"""Twice the lines of a panel of which singularities are compared that choose no node counts."""


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
def rooted_azimuth(
    u: float, a: float, b: float, first: float, last: float, kind_a: float, kind_b: float
) -> tuple[float, float]:  # fmt: skip
    """``azimuth`` of a..b where the square roots lie ``first`` before a and ``last`` behind b."""
    if first == 0.0 and last == 0.0:
        return azimuth(u, a, b, kind_a, kind_b)
    a, b = a - first, b + last
    low, high = math.sqrt(first / (b - a)), 1.0 - math.sqrt(last / (b - a))
    if kind_a == ROOT and kind_b == ROOT:
        half = 0.5 * math.pi
        low, high = math.asin(low) / half, math.acos(1.0 - high) / half
    phi, slope = azimuth(low + (high - low) * u, a, b, kind_a, kind_b)
    return phi, slope * (high - low)


@inlined
def panel_azimuth(u: float, p: Panel) -> tuple[float, float]:
    """``azimuth`` of a panel, whose map begins where its square roots do."""
    return rooted_azimuth(u, p.ends[0], p.ends[1], p.roots[0], p.roots[1], p.kinds[0], p.kinds[1])


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


@jitable
def touches_root(a: float, b: float, work: Work) -> bool:
    """Whether a circle beside which what is integrated is a root of the distance touches the line at an end.

    Of sqrt(t^2 + x), t along the lines, x log(x) is left across them, which no map of square roots makes smooth.
    """
    for i in range(work.counts.walls):
        row = work.walls[i]
        if not is_rooted(row) or row.touch_depth != 0.0:
            continue
        for branch in range(4):
            x = row.touch_azimuth
            x += (row.touch_offset if branch < 2 else math.pi - row.touch_offset) * (1.0 if branch % 2 == 0 else -1.0)
            for end in range(2):
                away = x - (a if end == 0 else b)
                away -= 2.0 * math.pi * math.floor(away / (2.0 * math.pi) + 0.5)
                if abs(away) < AT_END:
                    return True
    return False


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
        p.bound = held(panel_bound(a, b, work.chart))
        p.error = unseen_panel(a, b, held(p.bound), work)
        p.inside = p.settled = 0
        p.logarithm = int(touches_root(held(a), held(b), work))
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
