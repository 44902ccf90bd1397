"""Mean of the floor's checker over the patch of floor a pixel covers, in closed form.

With s(x) = sign(sin pi x) and S its triangle-wave integral, Green's theorem turns the mean over a polygon into
edge integrals: area * mean = contour integral of (S(x) - c) s(y) dy for any constant c. An edge is cut where it crosses
a whole x or y; on a piece S is linear and s constant, so the midpoint is exact.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.rays import window_direction
from symrender.numeric.textures import floor_sign
from symrender.scene.arrays import PLANE, SOLID, Array
from symrender.scene.records import Floor

Quad = tuple[float, float, float, float, float, float, float, float]
"""x and y of four corners in order around the patch, relative to the pixel's own floor point."""

MAX_CROSSINGS: Final = 4096
"""Most cell edges the contour of one patch may cross. Beyond it the mean is taken as 0; what that neglects is at most
min(sum |dx|, sum |dy|) / (2 area) over the contour, lengths in cells."""


@inlined
def footprint(frame: Array, a: float, b: float, da: float, db: float, x: float, y: float) -> tuple[bool, Quad]:
    """Whether the four corners of the pixel (a, b) of half-size (da, db) meet the floor, and where from (x, y)."""
    if frame[0] == PLANE:
        w, h = frame[4] * da, frame[4] * db
        return True, (-w, -h, w, -h, w, h, -w, h)
    x0, y0, x1, y1 = 0.0, 0.0, 0.0, 0.0
    x2, y2, x3, y3 = 0.0, 0.0, 0.0, 0.0
    for corner in range(4):
        sa = -da if corner in (0, 3) else da
        sb = -db if corner < 2 else db
        d = window_direction(frame, a + sa, b + sb)
        t = -frame[3] / d[2] if d[2] != 0.0 else -1.0
        if not 0.0 < t < math.inf:
            return False, (x0, y0, x1, y1, x2, y2, x3, y3)
        cx, cy = frame[1] + t * d[0] - x, frame[2] + t * d[1] - y
        if corner == 0:
            x0, y0 = cx, cy
        elif corner == 1:
            x1, y1 = cx, cy
        elif corner == 2:
            x2, y2 = cx, cy
        else:
            x3, y3 = cx, cy
    return True, (x0, y0, x1, y1, x2, y2, x3, y3)


@inlined
def wave(x: float) -> float:
    """Integral from 0 to x of sign(sin pi t): the triangle wave of period 2 between 0 and 1."""
    r = x - 2.0 * np.floor(x / 2.0)
    return float(r if r < 1.0 else 2.0 - r)


@inlined
def crossings(a: float, b: float) -> float:
    """How many whole numbers lie between a and b, at most."""
    return float(abs(np.floor(b) - np.floor(a)) + 1.0)


@inlined
def next_crossing(start: float, step: float, whole: float) -> float:
    """Parameter at which start + t step reaches ``whole``; inf for a step of 0."""
    return (whole - start) / step if step != 0.0 else math.inf


@inlined
def edge_integral(ax: float, ay: float, bx: float, by: float, level: float) -> float:
    """Integral of (S(x) - level) s(y) dy along the segment from (ax, ay) to (bx, by)."""
    dx, dy = bx - ax, by - ay
    if dy == 0.0:
        return 0.0
    forward, upward = (1.0 if dx > 0.0 else -1.0), (1.0 if dy > 0.0 else -1.0)
    next_x = np.floor(ax) + 1.0 if dx > 0.0 else np.ceil(ax) - 1.0
    next_y = np.floor(ay) + 1.0 if dy > 0.0 else np.ceil(ay) - 1.0
    total, t = 0.0, 0.0
    while t < 1.0:
        tx, ty = next_crossing(ax, dx, next_x), next_crossing(ay, dy, next_y)
        end = min(1.0, tx, ty)
        if tx <= end:
            next_x += forward
        if ty <= end:
            next_y += upward
        if end > t:
            middle = 0.5 * (t + end)
            y = ay + middle * dy
            sign = 1.0 if y - 2.0 * np.floor(y / 2.0) < 1.0 else -1.0
            total += (wave(ax + middle * dx) - level) * sign * (end - t) * dy
        t = max(t, end)
    return total


@inlined
def mean_sign(cx: float, cy: float, quad: Quad) -> float:
    """Mean of s(x) s(y) over the quadrilateral ``quad`` about (cx, cy), all in cells; nan for one without area."""
    cx -= 2.0 * np.floor(cx / 2.0)
    cy -= 2.0 * np.floor(cy / 2.0)
    x0, y0, x1, y1 = cx + quad[0], cy + quad[1], cx + quad[2], cy + quad[3]
    x2, y2, x3, y3 = cx + quad[4], cy + quad[5], cx + quad[6], cy + quad[7]
    area = 0.5 * ((quad[4] - quad[0]) * (quad[7] - quad[3]) - (quad[6] - quad[2]) * (quad[5] - quad[1]))
    if not 0.0 < abs(area) < math.inf:
        return math.nan
    split = crossings(x0, x1) + crossings(x1, x2) + crossings(x2, x3) + crossings(x3, x0)
    split += crossings(y0, y1) + crossings(y1, y2) + crossings(y2, y3) + crossings(y3, y0)
    if not split <= MAX_CROSSINGS:
        return 0.0
    level = wave(cx)
    total = edge_integral(x0, y0, x1, y1, level) + edge_integral(x1, y1, x2, y2, level)
    total += edge_integral(x2, y2, x3, y3, level) + edge_integral(x3, y3, x0, y0, level)
    return max(-1.0, min(1.0, total / area))


@inlined
def pixel_sign(floor: Floor, frame: Array, a: float, b: float, da: float, db: float, x: float, y: float) -> float:
    """Mean sign of the checker over the pixel's patch of floor, area measure; 0 where it reaches the horizon.

    Exact for both cameras up to rounding; a patch too small to have an area is its own point.
    """
    if floor.kind == SOLID:
        return 1.0
    whole, q = footprint(frame, a, b, da, db, x, y)
    if not whole:
        return 0.0
    c = floor.cell
    scaled = (q[0] / c, q[1] / c, q[2] / c, q[3] / c, q[4] / c, q[5] / c, q[6] / c, q[7] / c)
    mean = mean_sign((x - floor.offset[0]) / c, (y - floor.offset[1]) / c, scaled)
    return floor_sign(floor, x, y) if math.isnan(mean) else mean
