"""Events: azimuths at which the structure of a chart's scan lines changes.

Tangencies of a circle to a scan line, and a circle's passage through the limb (the edge of the visible shape), are
closed form. Two walls cross where the level of one vanishes at the root of the other: bracketed and solved on that
pair alone.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.line import HALF_PI, LIMB, POLE_END, RIM_HIGH, RIM_LOW, rim_interval, wall_level, wall_roots
from symrender.chambers.records import Chart, Event, Wall
from symrender.chambers.walls import (
    DIRECTION,
    NORMAL,
    RIM_ROW,
    tangent_lines,
)
from symrender.chambers.work import Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.jit.records import Table

Array = npt.NDArray[np.float64]

CROSSING = -1.0
"""Two walls cross: the line integral has a kink, and no panel need end there before its error asks for it."""
SMOOTH = 0.0
"""An event of this kind leaves the line integral analytic on either side."""
ROOT = 1.0
"""An event of this kind leaves a square root on one side."""
AT_LIMB = 1e-12
"""How far beyond the limb a circle may touch a line and still be taken to do so on it."""


@inlined
def merge_event(event: Event, phi: float, kind: float) -> None:
    """Let an event be one of this kind too, and move as the stronger of them."""
    if moves(phi) and kind > event.kind:
        event.azimuth = moved(held(event.azimuth), tangent(phi))
    event.kind = max(event.kind, kind)


@jitable
def add_event(events: Table[Event], n: int, phi: float, low: float, high: float, kind: float) -> int:
    """Insert an azimuth, reduced to (low, high), in order; equal ones merge and keep the stronger kind."""
    turn = 2.0 * math.pi
    phi -= turn * math.floor((phi - low) / turn)
    if not low < phi < high or n >= events.shape[0]:
        return n
    k = n
    while k > 0 and events[k - 1].azimuth > phi:
        k -= 1
    close = 1e-12
    if k > 0 and phi - events[k - 1].azimuth < close:
        merge_event(events[k - 1], phi, kind)
        return n
    if k < n and events[k].azimuth - phi < close:
        merge_event(events[k], phi, kind)
        return n
    for i in range(n, k, -1):
        events[i].azimuth, events[i].kind = events[i - 1].azimuth, events[i - 1].kind
    events[k].azimuth, events[k].kind = phi, kind
    return n + 1


@jitable
def within_lobe(phi: float, beta: float, chart: Chart) -> bool:
    """Whether the direction (phi, beta) of the chart lies in the lobe, generously."""
    cosine = math.cos(beta) * chart.lobe_cos + math.sin(beta) * chart.lobe_sin * math.cos(phi)
    return bool(cosine > chart.lobe.rim_cos - 1e-9)


@jitable
def circle_events(
    row: Wall, rim: bool, chart: Chart, events: Table[Event], n: int, low: float, high: float
) -> int:  # fmt: skip
    """Tangencies and limb passages of one circle, which may be the lobe's ``rim``; new count."""
    row.touch_azimuth, row.touch_offset, row.touch_depth = tangent_lines(row.axis[1], row.axis[2], row.sin)
    a0, a1, a2, cosine, sine, normal = row.axis[0], row.axis[1], row.axis[2], row.cos, row.sin, row.kind == NORMAL
    middle, offset = row.touch_azimuth, row.touch_offset
    rho = math.sqrt(a1 * a1 + a2 * a2)
    if rho == 0.0:
        return n
    k = chart.ratio
    limb = chart.gamma_max if normal else chart.beta_max
    if sine <= rho:
        for branch in range(4):
            phi = middle + (offset if branch < 2 else math.pi - offset) * (1.0 if branch % 2 == 0 else -1.0)
            b = rho * math.cos(phi - middle)
            x = math.atan2(b * cosine, a0 * cosine)
            # the floor's circle touches its line at the limb, where rounding decides
            if 0.0 < x < limb + AT_LIMB:
                if rim:
                    n = add_event(events, n, phi, low, high, ROOT)
                    continue
                beta = x
                if normal:
                    beta = math.atan2(k * math.sin(x), 1.0 - k * math.cos(x))
                if within_lobe(phi, beta, chart):
                    n = add_event(events, n, phi, low, high, ROOT)
    if math.sin(limb) > 0.0:
        ratio = (cosine - a0 * math.cos(limb)) / (rho * math.sin(limb)) if math.sin(limb) > 0.0 else 2.0
        if abs(ratio) < 1.0:
            offset = math.acos(ratio)
            for branch in range(2):
                phi = middle + (offset if branch == 0 else -offset)
                if rim or within_lobe(phi, chart.beta_max, chart):
                    n = add_event(events, n, phi, low, high, CROSSING if normal else ROOT)
    return n


@jitable
def line_range(chart: Chart) -> tuple[float, float]:
    """Azimuths (low, high) that can meet the lobe; low >= high if none do."""
    beta, sine, cosine = chart.lobe_beta, chart.lobe_sin, chart.lobe.rim_cos
    # pole inside the lobe
    if chart.lobe_cos > cosine:
        return -math.pi, math.pi
    limb = chart.beta_max
    nearest = beta - math.atan2(chart.lobe.rim_sin, cosine)
    if nearest >= limb:
        return 0.0, 0.0
    rim = chart.lobe.rim_sin
    if rim < sine or chart.lobe_cos > 0.0:
        # a rim through the pole itself, whose sines may round either way, touches the lines across
        opening = max(0.0, (sine - rim) * (sine + rim))
        x = math.atan2(math.sqrt(opening) * cosine, chart.lobe_cos * cosine)
        if x < limb:
            offset = math.asin(min(1.0, rim / sine))
            return -offset, offset
    if math.sin(limb) * sine == 0.0:
        return -math.pi, math.pi
    ratio = (cosine - chart.lobe_cos * math.cos(limb)) / (sine * math.sin(limb))
    offset = math.acos(max(-1.0, min(1.0, ratio)))
    return -offset, offset


@inlined
def chart_events(work: Work, events: Table[Event], low: float, high: float) -> int:
    """Tangencies and limb passages between low and high, with both ends, ascending.

    ``set_circles`` has written the rim.
    """
    chart = work.chart
    events[0].azimuth, events[0].kind = low, ROOT
    n = 1
    if high - low > 6.0:
        events[0].kind = SMOOTH
        n = add_event(events, n, 0.0, low, high, SMOOTH)
    if chart.lobe.rim_cos >= 0.0:
        n = circle_events(work.circles[RIM_ROW], True, chart, events, n, low, high)
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        if row.kind in (NORMAL, DIRECTION):
            n = circle_events(row, False, chart, events, n, low, high)
    return close_events(events, n, high)


@inlined
def axis_events(
    ax: float, ay: float, az: float, work: Work, events: Table[Event], n: int, low: float, high: float
) -> int:  # fmt: skip
    """The two places of a sphere whose normals lie along a unit axis, about which what they show turns; new count.

    All veins of marble meet there, or what bounds a sky are two horizons that are one. Past it at a distance d the line
    integral goes like d log d, which a square root's map makes tame enough.
    """
    chart = work.chart
    for end in range(2):
        side = 1.0 if end == 0 else -1.0
        along = side * (ax * chart.pole[0] + ay * chart.pole[1] + az * chart.pole[2])
        first = side * (ax * chart.e1[0] + ay * chart.e1[1] + az * chart.e1[2])
        second = side * (ax * chart.e2[0] + ay * chart.e2[1] + az * chart.e2[2])
        across = math.hypot(first, second)
        if along < -chart.ratio and across > 0.0:
            phi = math.atan2(second, first)
            beta = math.atan2(chart.ratio * across, 1.0 + chart.ratio * along)
            if within_lobe(phi, beta, chart):
                n = add_event(events, n, phi, low, high, ROOT)
    return n


@jitable
def close_events(events: Table[Event], n: int, high: float) -> int:
    """Append the upper end, of the same kind as the lower one; new count."""
    n = min(n, events.shape[0] - 1)
    events[n].azimuth, events[n].kind = high, events[0].kind
    return n + 1


@jitable
def end_position(wall: int, phi: float, work: Work, scratch: Array) -> float:
    """Inner coordinate of a wall's branch (or of an end of the line) at azimuth phi; NaN if absent."""
    c, s = math.cos(phi), math.sin(phi)
    if wall == POLE_END:
        return 0.0
    if wall == LIMB:
        return HALF_PI
    if wall in (RIM_LOW, RIM_HIGH):
        low, high, first, last = rim_interval(c, s, work.chart)
        if low < high and wall == RIM_LOW and first == RIM_LOW:
            return low
        if low < high and wall == RIM_HIGH and last == RIM_HIGH:
            return high
        return math.nan
    wall_roots(wall // 4, c, s, 0.0, HALF_PI, work, scratch)
    return float(scratch[wall % 4])


@jitable
def crossing(one: int, other: int, left: float, right: float, work: Work, scratch: Array) -> float:
    """Azimuth in (left, right) where wall branches ``one`` and ``other`` cross, NaN if that pair brackets nothing.

    Follows ``other`` and finds the zero of the level of ``one`` along it (Illinois).
    """
    if one < 0:
        one, other = other, one
    if one < 0:
        return math.nan
    sphere = work.chart.shape_index >= 0.0
    if other >= 0 and sphere and work.walls[other // 4].kind > DIRECTION:
        one, other = other, one
        if work.walls[other // 4].kind > DIRECTION:
            return math.nan
    xa = end_position(other, left, work, scratch)
    xb = end_position(other, right, work, scratch)
    if not (xa == xa and xb == xb):
        return math.nan
    i = one // 4
    fa = wall_level(i, xa, math.cos(left), math.sin(left), work)
    fb = wall_level(i, xb, math.cos(right), math.sin(right), work)
    if not fa * fb < 0.0:
        return math.nan
    a, b = left, right
    for _ in range(60):
        phi = (a * fb - b * fa) / (fb - fa)
        x = end_position(other, phi, work, scratch)
        if x != x:
            return math.nan
        f = wall_level(i, x, math.cos(phi), math.sin(phi), work)
        step = abs(phi - b)
        if f * fb < 0.0:
            a, fa = b, fb
        else:
            fa *= 0.5
        b, fb = phi, f
        if f == 0.0 or step < 1e-13 * (1.0 + abs(phi)):
            break
    # panels may end beside a crossing that moves: the line integral is continuous there
    return held(b)
