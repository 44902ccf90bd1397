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
from symrender.chambers.walls import (
    BETA_MAX,
    COS,
    DIRECTION,
    GAMMA_MAX,
    KIND,
    LOBE_BETA,
    NORMAL,
    RATIO,
    RIM_COS,
    RIM_SIN,
    SHAPE_INDEX,
    SIN,
    TANGENT,
    tangent_lines,
)
from symrender.chambers.work import WALLS, Work
from symrender.kernel_cache import inlined, jitable

Array = npt.NDArray[np.float64]

CROSSING = -1.0
"""Two walls cross: the line integral has a kink, and no panel need end there before its error asks for it."""
SMOOTH = 0.0
"""An event of this kind leaves the line integral analytic on either side."""
ROOT = 1.0
"""An event of this kind leaves a square root on one side."""


@jitable
def add_event(events: Array, n: int, phi: float, low: float, high: float, kind: float) -> int:
    """Insert an azimuth, reduced to (low, high), in order; equal ones merge and keep the stronger kind."""
    turn = 2.0 * math.pi
    phi -= turn * math.floor((phi - low) / turn)
    if not low < phi < high or n >= events.shape[0]:
        return n
    k = n
    while k > 0 and events[k - 1, 0] > phi:
        k -= 1
    close = 1e-12
    if k > 0 and phi - events[k - 1, 0] < close:
        events[k - 1, 1] = max(events[k - 1, 1], kind)
        return n
    if k < n and events[k, 0] - phi < close:
        events[k, 1] = max(events[k, 1], kind)
        return n
    for i in range(n, k, -1):
        events[i, 0], events[i, 1] = events[i - 1, 0], events[i - 1, 1]
    events[k, 0], events[k, 1] = phi, kind
    return n + 1


@jitable
def within_lobe(phi: float, beta: float, geo: Array) -> bool:
    """Whether the direction (phi, beta) of the chart lies in the lobe, generously."""
    cosine = math.cos(beta) * geo[LOBE_BETA + 1] + math.sin(beta) * geo[LOBE_BETA + 2] * math.cos(phi)
    return bool(cosine > geo[RIM_COS] - 1e-9)


@jitable
def circle_events(
    a0: float, a1: float, a2: float, cosine: float, sine: float, middle: float, offset: float, normal: bool,
    geo: Array, events: Array, n: int, low: float, high: float, rim: bool,
) -> int:  # fmt: skip
    """Tangencies and limb passages of one circle; ``normal`` says on which sphere it lies.

    ``middle`` and ``offset`` as of ``tangent_lines``.
    """
    rho = math.sqrt(a1 * a1 + a2 * a2)
    if rho == 0.0:
        return n
    k = geo[RATIO]
    limb = geo[GAMMA_MAX] if normal else geo[BETA_MAX]
    if sine <= rho:
        for branch in range(4):
            phi = middle + (offset if branch < 2 else math.pi - offset) * (1.0 if branch % 2 == 0 else -1.0)
            b = rho * math.cos(phi - middle)
            x = math.atan2(b * cosine, a0 * cosine)
            if 0.0 < x < limb:
                if rim:
                    n = add_event(events, n, phi, low, high, ROOT)
                    continue
                beta = x
                if normal:
                    beta = math.atan2(k * math.sin(x), 1.0 - k * math.cos(x))
                if within_lobe(phi, beta, geo):
                    n = add_event(events, n, phi, low, high, ROOT)
    if math.sin(limb) > 0.0:
        ratio = (cosine - a0 * math.cos(limb)) / (rho * math.sin(limb)) if math.sin(limb) > 0.0 else 2.0
        if abs(ratio) < 1.0:
            offset = math.acos(ratio)
            for branch in range(2):
                phi = middle + (offset if branch == 0 else -offset)
                if rim or within_lobe(phi, geo[BETA_MAX], geo):
                    n = add_event(events, n, phi, low, high, CROSSING if normal else ROOT)
    return n


@jitable
def line_range(geo: Array) -> tuple[float, float]:
    """Azimuths (low, high) that can meet the lobe; low >= high if none do."""
    beta, sine, cosine = geo[LOBE_BETA], geo[LOBE_BETA + 2], geo[RIM_COS]
    # pole inside the lobe
    if geo[LOBE_BETA + 1] > cosine:
        return -math.pi, math.pi
    limb = geo[BETA_MAX]
    nearest = beta - math.atan2(geo[RIM_SIN], cosine)
    if nearest >= limb:
        return 0.0, 0.0
    if geo[RIM_SIN] < sine:
        x = math.atan2(math.sqrt((sine - geo[RIM_SIN]) * (sine + geo[RIM_SIN])) * cosine, geo[LOBE_BETA + 1] * cosine)
        if x < limb:
            offset = math.asin(geo[RIM_SIN] / sine)
            return -offset, offset
    if math.sin(limb) * sine == 0.0:
        return -math.pi, math.pi
    ratio = (cosine - geo[LOBE_BETA + 1] * math.cos(limb)) / (sine * math.sin(limb))
    offset = math.acos(max(-1.0, min(1.0, ratio)))
    return -offset, offset


@inlined
def chart_events(work: Work, events: Array, low: float, high: float) -> int:
    """Tangencies and limb passages between low and high, with both ends, ascending; columns azimuth, kind."""
    geo = work.geo
    events[0, 0], events[0, 1] = low, ROOT
    n = 1
    if high - low > 6.0:
        events[0, 1] = SMOOTH
        n = add_event(events, n, 0.0, low, high, SMOOTH)
    middle, offset, _ = tangent_lines(geo[LOBE_BETA + 2], 0.0, geo[RIM_SIN])
    n = circle_events(
        geo[LOBE_BETA + 1], geo[LOBE_BETA + 2], 0.0, geo[RIM_COS], geo[RIM_SIN], middle, offset, False, geo, events, n,
        low, high, True,
    )  # fmt: skip
    for i in range(min(work.counts[WALLS], work.walls.shape[0])):
        row = work.walls[i]
        kind = int(row[KIND])
        if kind in (NORMAL, DIRECTION):
            row[TANGENT], row[TANGENT + 1], row[TANGENT + 2] = tangent_lines(row[2], row[3], row[SIN])
            n = circle_events(
                row[1], row[2], row[3], row[COS], row[SIN], row[TANGENT], row[TANGENT + 1], kind == NORMAL, geo,
                events, n, low, high, False,
            )  # fmt: skip
    return close_events(events, n, high)


@jitable
def close_events(events: Array, n: int, high: float) -> int:
    """Append the upper end, of the same kind as the lower one; new count."""
    n = min(n, events.shape[0] - 1)
    events[n, 0], events[n, 1] = high, events[0, 1]
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
        low, high, first, last = rim_interval(c, s, work.geo)
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
    sphere = work.geo[SHAPE_INDEX] >= 0.0
    if other >= 0 and sphere and int(work.walls[other // 4][KIND]) > DIRECTION:
        one, other = other, one
        if int(work.walls[other // 4][KIND]) > DIRECTION:
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
    return b
