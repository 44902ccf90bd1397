"""Crossings of two walls of which neither is a circle of the chart: one is walked along, the other's level solved.

The edge of a shadow from a light point is swept by rays along the shadow's cone, a ball's circle on the floor by an
angle. Along such a curve the level of any other wall is smooth: it is sampled, sign changes are solved (Illinois), and
where it turns back towards zero between samples the turning point is looked at, so that two roots close to each other
are found too.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.contacts import chart_place_of, contacts
from symrender.chambers.events import CROSSING, add_event, within_lobe
from symrender.chambers.labels import is_hidden
from symrender.chambers.line import wall_level
from symrender.chambers.place import surface_point
from symrender.chambers.reach import are_apart
from symrender.chambers.records import DISTANT, Event, Wall
from symrender.chambers.tangencies import edge_frame, straight_place
from symrender.chambers.walk import SAMPLES
from symrender.chambers.walls import (
    BALL,
    DIRECTION,
    LIMB_ROW,
    NORMAL,
    RIM_ROW,
    SHADOW,
    SHADOW_EDGE,
    TERMINATOR,
    TEXTURE_EDGE,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.scene.arrays import CUT

Array = npt.NDArray[np.float64]


class Pair(NamedTuple):
    """A wall whose curve is walked along, on a sphere also ``beyond`` the light's side, and ``other``; -1: the rim.

    ``hides``: one of the two bounds what is seen, so that sight cannot be asked at their crossing.
    """

    walked: int
    other: int
    beyond: bool
    hides: bool


@jitable
def set_circles(work: Work) -> None:
    """Write the rim and the limb as wall rows."""
    chart = work.chart
    rim, limb = work.circles[RIM_ROW], work.circles[LIMB_ROW]
    rim.kind, rim.axis[0], rim.axis[1], rim.axis[2] = DIRECTION, chart.lobe_cos, chart.lobe_sin, 0.0
    rim.cos, rim.sin = chart.lobe.rim_cos, chart.lobe.rim_sin
    limb.kind, limb.axis[0], limb.axis[1], limb.axis[2] = NORMAL, 1.0, 0.0, 0.0
    # just inside, so that its places count as seen
    limb.cos = min(1.0, chart.ratio + 1e-12)
    limb.sin = math.sqrt((1.0 - limb.cos) * (1.0 + limb.cos))


@inlined
def edge_place(psi: float, row: Wall, beyond: bool, view: View, work: Work) -> tuple[float, float, float, bool]:
    """Place at angle ``psi`` of a shadow's edge or a ball's circle, and whether there is one.

    A sphere is met twice, the second time ``beyond`` the light's side.
    """
    chart, frame = work.chart, work.frame
    c, s = math.cos(psi), math.sin(psi)
    if row.kind == BALL:
        size2 = row.foot[0] * row.foot[0] + row.foot[1] * row.foot[1] - row.power
        size = math.sqrt(max(0.0, size2))
        along, across = row.foot[0] + size * c, row.foot[1] + size * s
        x = chart.point[0] + along * chart.e1[0] + across * chart.e2[0]
        y = chart.point[1] + along * chart.e1[1] + across * chart.e2[1]
        return x, y, 0.0, size2 > 0.0
    light = view.points[row.light]
    if light.fall == DISTANT:
        return straight_place(c, s, view.spheres[row.shape_index], beyond, chart, frame)
    ux = frame[0, 0] + c * frame[1, 0] + s * frame[2, 0]
    uy = frame[0, 1] + c * frame[1, 1] + s * frame[2, 1]
    uz = frame[0, 2] + c * frame[1, 2] + s * frame[2, 2]
    if chart.shape_index < 0.0:
        if not uz * light.position[2] < 0.0:
            return 0.0, 0.0, 0.0, False
        t = -light.position[2] / uz
        return light.position[0] + t * ux, light.position[1] + t * uy, 0.0, True
    wx, wy, wz = (
        light.position[0] - chart.center[0],
        light.position[1] - chart.center[1],
        light.position[2] - chart.center[2],
    )
    b = wx * ux + wy * uy + wz * uz
    square = b * b - (wx * wx + wy * wy + wz * wz) + chart.radius * chart.radius
    if not square > 0.0:
        return 0.0, 0.0, 0.0, False
    t = -b + (math.sqrt(square) if beyond else -math.sqrt(square))
    return light.position[0] + t * ux, light.position[1] + t * uy, light.position[2] + t * uz, t > 0.0


@inlined
def level_there(x: float, c: float, s: float, other: int, work: Work) -> float:
    """Level of wall ``other``, or of the rim for -1, at inner coordinate ``x`` of the line (c, s)."""
    chart = work.chart
    if other >= 0:
        return wall_level(other, x, c, s, work)
    if chart.shape_index < 0.0:
        sb, cb = math.sin(x), math.cos(x)
    else:
        sb = chart.ratio * math.sin(x)
        cb = math.sqrt(max(0.0, (1.0 - sb) * (1.0 + sb)))
    return float(cb * chart.lobe_cos + sb * c * chart.lobe_sin - chart.lobe.rim_cos)


@inlined
def along_level(
    psi: float, row: Wall, other: int, beyond: bool, view: View, work: Work
) -> tuple[float, float, float, float]:  # fmt: skip
    """(level of wall ``other``, or of the rim for -1, at ``psi`` along ``row``; inner coordinate, cos and sin phi).

    The level is NaN where the curve has no place.
    """
    qx, qy, qz, there = edge_place(psi, row, beyond, view, work)
    if not there:
        return math.nan, 0.0, 1.0, 0.0
    x, c, s = chart_place_of(qx, qy, qz, work)
    level = level_there(x, c, s, other, work)
    return level, x, c, s


@inlined
def note_trace(
    psi: float, pair: Pair, view: View, work: Work, events: Table[Event], n: int, low: float, high: float
) -> int:  # fmt: skip
    """Note the crossing at ``psi`` if it is inside the lobe and seen; new count."""
    level, x, c, s = along_level(psi, work.walls[pair.walked], pair.other, pair.beyond, view, work)
    if not (level == level and 0.0 < x < 0.5 * math.pi):
        return n
    phi = math.atan2(s, c)
    chart = work.chart
    beta = x if chart.shape_index < 0.0 else math.asin(chart.ratio * math.sin(x))
    if not within_lobe(phi, beta, chart):
        return n
    if not pair.hides:
        qx, qy, qz, _, _, _ = surface_point(x, c, s, chart)
        if is_hidden(qx, qy, qz, view, work):
            return n
    return add_event(events, n, phi, low, high, CROSSING)


@jitable
def trace_pair(
    pair: Pair, view: View, work: Work, events: Table[Event], n: int, low: float, high: float
) -> int:  # fmt: skip
    """Note where the other wall crosses the curve of the one that ``walk`` is laid along; new count."""
    row, other, beyond = work.walls[pair.walked], pair.other, pair.beyond
    step = 2.0 * math.pi / SAMPLES
    f0, f1 = math.nan, math.nan
    first = SAMPLES if beyond else 0
    for k in range(SAMPLES + 3):
        psi, at = k * step, work.walk[first + k % SAMPLES]
        f2 = level_there(at.inner, at.c, at.s, other, work) if at.there != 0 else math.nan
        left, right, fa, fb = psi - step, psi, f1, f2
        if 0 < k <= SAMPLES and (fa != fa) != (fb != fb):
            # the curve ends between the two: look up to there
            hit, miss, last = (right, left, fb) if fa != fa else (left, right, fa)
            for _ in range(30):
                middle = 0.5 * (hit + miss)
                f, _, _, _ = along_level(middle, row, other, beyond, view, work)
                if f == f:
                    hit, last = middle, f
                else:
                    miss = middle
            if fa != fa:
                left, fa = hit, last
            else:
                right, fb = hit, last
        if 0 < k <= SAMPLES and fa * fb < 0.0:
            n = solve_trace(left, right, fa, fb, pair, view, work, events, n, low, high)
        elif k > 1 and f0 * f1 > 0.0 and f1 * f2 > 0.0 and abs(f1) <= abs(f0) and abs(f1) <= abs(f2):
            # the level turns back short of zero at the samples: its turning point may lie beyond
            a, m, b, fm = psi - 2.0 * step, psi - step, psi, f1
            for _ in range(40):
                u = m + 0.381966 * (b - m) if b - m > m - a else m - 0.381966 * (m - a)
                f, _, _, _ = along_level(u, row, other, beyond, view, work)
                if f != f:
                    break
                if f * fm < 0.0:
                    lo, hi = min(u, m), max(u, m)
                    flo, fhi = (f, fm) if u < m else (fm, f)
                    # one root between, the other on the far side of u
                    n = solve_trace(lo, hi, flo, fhi, pair, view, work, events, n, low, high)
                    if u < m:
                        fl, _, _, _ = along_level(a, row, other, beyond, view, work)
                        n = solve_trace(a, u, fl, f, pair, view, work, events, n, low, high)
                    else:
                        fr, _, _, _ = along_level(b, row, other, beyond, view, work)
                        n = solve_trace(u, b, f, fr, pair, view, work, events, n, low, high)
                    break
                if abs(f) < abs(fm):
                    if u < m:
                        b = m
                    else:
                        a = m
                    m, fm = u, f
                elif u < m:
                    a = u
                else:
                    b = u
                if b - a < 1e-7:
                    break
        f0, f1 = f1, f2
    return n


@jitable
def solve_trace(
    left: float, right: float, fa: float, fb: float, pair: Pair, view: View, work: Work, events: Table[Event], n: int,
    low: float, high: float,
) -> int:  # fmt: skip
    """Note the one crossing between two places whose levels differ in sign (Illinois); new count."""
    if not fa * fb < 0.0:
        return n
    psi = right
    for _ in range(60):
        psi = (left * fb - right * fa) / (fb - fa)
        f, _, _, _ = along_level(psi, work.walls[pair.walked], pair.other, pair.beyond, view, work)
        if f != f:
            return n
        moved = abs(psi - right)
        if f * fb < 0.0:
            left, fa = right, fb
        else:
            fa *= 0.5
        right, fb = psi, f
        if f == 0.0 or moved < 1e-14:
            break
    # where walls cross the line integral is continuous: its panels may end beside a crossing that moves
    return note_trace(held(psi), pair, view, work, events, n, low, high)


@jitable
def walk_along(row: Wall, beyond: bool, view: View, work: Work) -> bool:
    """Fill the places of ``walk`` along the curve of a wall; whether it may pass through the lobe.

    One of the places is then no farther from it than their spacing, or the curve ends somewhere between two.
    """
    chart = work.chart
    most, least, ends, first = -1.0, 1.0, False, SAMPLES if beyond else 0
    x0, y0, z0 = 0.0, 0.0, 0.0
    for k in range(SAMPLES):
        at = work.walk[first + k]
        x, y, z, there = edge_place(2.0 * math.pi * k / SAMPLES, row, beyond, view, work)
        at.place[0], at.place[1], at.place[2], at.there = x, y, z, int(there)
        ends = ends or at.there != work.walk[first].there
        if not there:
            continue
        dx, dy, dz, _, _ = values.heading(x - chart.point[0], y - chart.point[1], z - chart.point[2])
        along = 0.0
        for a in range(3):
            axis = chart.lobe_cos * chart.pole[a] + chart.lobe_sin * chart.e1[a]
            along += axis * (dx if a == 0 else dy if a == 1 else dz)
        most = max(most, along)
        if k > 0:
            least = min(least, dx * x0 + dy * y0 + dz * z0)
        x0, y0, z0 = dx, dy, dz
    if ends or work.walk[first].there == 0:
        return ends
    last = work.walk[first].place
    dx, dy, dz, _, _ = values.heading(last[0] - chart.point[0], last[1] - chart.point[1], last[2] - chart.point[2])
    least = min(least, dx * x0 + dy * y0 + dz * z0)
    nearest = math.acos(min(1.0, most)) - math.atan2(chart.lobe.rim_sin, chart.lobe.rim_cos)
    return nearest < math.acos(max(-1.0, least))


@jitable
def chart_walk(beyond: bool, work: Work) -> None:
    """Fill inner coordinates and lines of the places of ``walk``."""
    first = SAMPLES if beyond else 0
    for k in range(first, first + SAMPLES):
        at = work.walk[k]
        if at.there != 0:
            at.inner, at.c, at.s = chart_place_of(at.place[0], at.place[1], at.place[2], work)


@inlined
def trace_crossings(view: View, work: Work, events: Table[Event], n: int, low: float, high: float) -> int:
    """Add the crossings of curves that can be walked along with all walls no closed form has them with; new count.

    On a sphere these are shadow edges with each other, with cones of directions and with the rim; on the floor shadow
    edges and balls with each other. Edges of penumbrae are met here, but not walked along.
    """
    n = contacts(view, work, events, n, low, high)
    walls = work.walls
    count = min(work.counts.walls, walls.shape[0])
    sphere = work.chart.shape_index >= 0.0
    sides = 2 if sphere and view.shading.terminator != CUT and view.shading.ks > 0.0 else 1
    for i in range(count):
        one = walls[i]
        kind = one.kind
        walked = kind == BALL or (kind == SHADOW and one.tag == SHADOW_EDGE)
        if not walked or (
            kind == SHADOW and not edge_frame(view.points[one.light], view.spheres[one.shape_index], work.frame)
        ):
            continue
        near, beyond = walk_along(one, False, view, work), sides == 2 and walk_along(one, True, view, work)
        if not (near or beyond):
            continue
        charted = False
        for j in range(-1, count):
            if j < 0:
                # the floor's rim is a circle of directions, for which there is a closed form
                wanted = sphere
            else:
                also = walls[j].kind
                both = also == BALL or (also == SHADOW and walls[j].tag == SHADOW_EDGE)
                wanted = j != i and (not both or j < i) and (also > DIRECTION or sphere) and also != NORMAL
            if not wanted or (j >= 0 and are_apart(one, walls[j])):
                continue
            hides = j < 0 or not (one.tag == SHADOW_EDGE and (walls[j].tag in (TEXTURE_EDGE, TERMINATOR, SHADOW_EDGE)))
            for side in range(sides):
                if near if side == 0 else beyond:
                    if not charted:
                        chart_walk(side == 1, work)
                    n = trace_pair(Pair(i, j, side == 1, hides), view, work, events, n, low, high)
            charted = True
    return n
