"""Azimuths at which a scan line touches a wall that is no circle: a shadow's edge, or a ball where it meets the floor.

A shadow too thin for the first lines of a panel lies between two such events, and would go unseen without them.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.caps import Cone
from symrender.chambers.events import CROSSING, ROOT, SMOOTH, add_event, within_lobe
from symrender.chambers.penumbra_walls import edge_search
from symrender.chambers.records import DISTANT, Chart, Event, LightPoint, Wall
from symrender.chambers.walls import (
    BALL,
    GLEAM_EDGE,
    HIGHLIGHT,
    PENUMBRA,
    SHADOW,
    SHADOW_EDGE,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moves
from symrender.jit.records import Table
from symrender.leaves.values import sphere_pass
from symrender.scene.arrays import CUT
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

EDGE_LINES = 48
"""Scan lines on which the end of a highlight is asked for."""
RAYS = 32
"""Rays along a shadow's edge between which its azimuth is looked at for turns."""


@jitable
def floor_tangencies(row: Wall, chart: Chart, events: Table[Event], n: int, low: float, high: float) -> int:
    """Azimuths at which a scan line of the floor touches a shadow's edge or a ball.

    Both are a r^2 + 2 b r + c = 0 along a line; b^2 - a c is a quadratic form of the azimuth's cosine and sine. The
    wall gets where, off the lobe and off the real line too: its roots branch there, and panels beside it feel it. A
    penumbra's edges lie inside the shadow of a ball about the disk, and the line integral is smooth where that begins.
    """
    # a and b as sums over products of (c, s); the constant third coefficient
    if row.kind == BALL:
        axx, axy, ayy, bx, by, free = 1.0, 0.0, 1.0, -row.foot[0], -row.foot[1], row.power
    else:
        axx = row.sine2 - row.first[1] * row.first[1] - row.second[1] * row.second[1]
        axy = -row.first[1] * row.first[2] - row.second[1] * row.second[2]
        ayy = row.sine2 - row.first[2] * row.first[2] - row.second[2] * row.second[2]
        bx = row.sine2 * row.origin[1] - row.first_level * row.first[1] - row.second_level * row.second[1]
        by = row.sine2 * row.origin[2] - row.first_level * row.first[2] - row.second_level * row.second[2]
        free = row.sine2 * row.origin2 - row.first_level * row.first_level - row.second_level * row.second_level
    if row.kind != BALL:
        # where the edge runs off to the floor's horizon
        level, even = 0.5 * (axx + ayy), 0.5 * (axx - ayy)
        size = math.sqrt(even * even + axy * axy)
        if abs(level) < size:
            middle, offset = 0.5 * math.atan2(axy, even), 0.5 * math.acos(-level / size)
            for branch in range(4):
                phi = middle + (offset if branch % 2 == 0 else -offset) + (0.0 if branch < 2 else math.pi)
                if within_lobe(phi, 0.5 * math.pi, chart):
                    n = add_event(events, n, phi, low, high, CROSSING)
    xx, xy, yy = bx * bx - axx * free, bx * by - axy * free, by * by - ayy * free
    level, even = 0.5 * (xx + yy), 0.5 * (xx - yy)
    size = math.sqrt(even * even + xy * xy)
    middle = 0.5 * math.atan2(xy, even)
    if not abs(level) < size:
        # no real one: cos 2 (phi - middle) = -level / size has its solutions off the line
        row.touch_azimuth, row.touch_offset = middle, 0.0 if level < 0.0 else 0.5 * math.pi
        ratio = abs(level) / size if size > 0.0 else math.inf
        row.touch_depth = 0.5 * math.log(ratio + math.sqrt(ratio * ratio - 1.0)) if ratio < math.inf else math.inf
        return n
    offset = 0.5 * math.acos(-level / size)
    row.touch_azimuth, row.touch_offset, row.touch_depth = middle, offset, 0.0
    for branch in range(4):
        phi = middle + (offset if branch % 2 == 0 else -offset) + (0.0 if branch < 2 else math.pi)
        c, s = math.cos(phi), math.sin(phi)
        a, b = axx * c * c + 2.0 * axy * c * s + ayy * s * s, bx * c + by * s
        # the double root -b/a lies on the line, on this side of the horizon
        if a * b < 0.0 and within_lobe(phi, math.atan2(abs(b), abs(a) * chart.height), chart):
            n = add_event(events, n, phi, low, high, SMOOTH if row.kind == PENUMBRA else ROOT)
    return n


@inlined
def straight_place(
    c: float, s: float, caster: Sphere, beyond: bool, chart: Chart, frame: Array
) -> tuple[float, float, float, bool]:  # fmt: skip
    """``edge_place`` of the shadow of a distant light, whose rays are parallel and touch the occluder."""
    x = caster.center[0] + c * frame[1, 0] + s * frame[2, 0]
    y = caster.center[1] + c * frame[1, 1] + s * frame[2, 1]
    z = caster.center[2] + c * frame[1, 2] + s * frame[2, 2]
    ux, uy, uz = frame[0, 0], frame[0, 1], frame[0, 2]
    if chart.shape_index < 0.0:
        if not uz < 0.0:
            return 0.0, 0.0, 0.0, False
        t = -z / uz
        return x + t * ux, y + t * uy, 0.0, True
    wx, wy, wz = x - chart.center[0], y - chart.center[1], z - chart.center[2]
    b = wx * ux + wy * uy + wz * uz
    square = b * b - (wx * wx + wy * wy + wz * wz) + chart.radius * chart.radius
    if not square > 0.0:
        return 0.0, 0.0, 0.0, False
    t = -b + (math.sqrt(square) if beyond else -math.sqrt(square))
    return x + t * ux, y + t * uy, z + t * uz, True


@jitable
def straight_turn(
    psi: float, caster: Sphere, beyond: bool, chart: Chart, frame: Array
) -> tuple[float, float, float, float, bool]:  # fmt: skip
    """``edge_turn`` of a distant light, whose rays are parallel and touch the occluder."""
    c, s = math.cos(psi), math.sin(psi)
    b, across, far2 = 0.0, 0.0, 0.0
    for a in range(3):
        start = caster.center[a] - chart.center[a] + c * frame[1, a] + s * frame[2, a]
        b += start * frame[0, a]
        far2 += start * start
    square = b * b - far2 + chart.radius * chart.radius
    if not square > 0.0:
        return math.nan, 0.0, 0.0, 0.0, False
    root = -math.sqrt(square) if beyond else math.sqrt(square)
    t = -b - root
    for a in range(3):
        start = caster.center[a] - chart.center[a] + c * frame[1, a] + s * frame[2, a]
        across += (start + t * frame[0, a]) * (c * frame[2, a] - s * frame[1, a])
    slope = across / root
    x, y, z, dx, dy, facing = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for a in range(3):
        q = caster.center[a] + c * frame[1, a] + s * frame[2, a] + t * frame[0, a]
        dq = slope * frame[0, a] + c * frame[2, a] - s * frame[1, a]
        x += (q - chart.point[a]) * chart.e1[a]
        y += (q - chart.point[a]) * chart.e2[a]
        z += (q - chart.point[a]) * chart.pole[a]
        dx += dq * chart.e1[a]
        dy += dq * chart.e2[a]
        facing += (chart.point[a] - q) * (q - chart.center[a])
    return x * dy - y * dx, x, y, z, facing > 0.0


@jitable
def edge_turn(
    psi: float, light: LightPoint, caster: Sphere, beyond: bool, chart: Chart, frame: Array
) -> tuple[float, float, float, float, bool]:  # fmt: skip
    """Where a ray along a shadow's edge meets the charted sphere, as of P: (turn, x, y, z, faces P).

    x and y lie across the chart's pole and z along it; ``turn`` = x y' - y x' has the sign of the azimuth's change
    with the angle ``psi`` about the shadow's axis, NaN where the ray misses. ``frame`` (3, 3): the axis times the
    cosine of the shadow's half-angle, and two unit vectors across it times its sine, or, of a distant light, times the
    occluder's radius.
    """
    if light.fall == DISTANT:
        return straight_turn(psi, caster, beyond, chart, frame)
    c, s = math.cos(psi), math.sin(psi)
    o, p = chart.center, light.position
    fx, fy, fz = o[0] - p[0], o[1] - p[1], o[2] - p[2]
    ux = frame[0, 0] + c * frame[1, 0] + s * frame[2, 0]
    uy = frame[0, 1] + c * frame[1, 1] + s * frame[2, 1]
    uz = frame[0, 2] + c * frame[1, 2] + s * frame[2, 2]
    along, square = sphere_pass(fx, fy, fz, ux, uy, uz, chart.radius)
    change = 0.0
    for a in range(3):
        change -= (o[a] - p[a]) * (c * frame[2, a] - s * frame[1, a])
    if not square > 0.0:
        return math.nan, 0.0, 0.0, 0.0, False
    # where the ray enters the sphere, or where it leaves it
    root = -math.sqrt(square) if beyond else math.sqrt(square)
    t = along - root
    slope = change * t / root
    x, y, z, dx, dy, facing = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for a in range(3):
        u = frame[0, a] + c * frame[1, a] + s * frame[2, a]
        q = light.position[a] + t * u
        dq = slope * u + t * (c * frame[2, a] - s * frame[1, a])
        x += (q - chart.point[a]) * chart.e1[a]
        y += (q - chart.point[a]) * chart.e2[a]
        z += (q - chart.point[a]) * chart.pole[a]
        dx += dq * chart.e1[a]
        dy += dq * chart.e2[a]
        facing += (chart.point[a] - q) * (q - chart.center[a])
    return x * dy - y * dx, x, y, z, facing > 0.0


@inlined
def edge_frame(light: LightPoint, caster: Sphere, frame: Array) -> bool:
    """Fill ``frame`` (3, 3) for the rays along a shadow's edge, see ``edge_turn``; whether the light is outside."""
    far2 = 0.0
    for a in range(3):
        frame[0, a] = caster.center[a] - light.position[a]
        far2 += frame[0, a] * frame[0, a]
    if not far2 > caster.radius * caster.radius:
        return False
    far = math.sqrt(far2)
    sine = caster.radius / far
    cosine = math.sqrt((1.0 - sine) * (1.0 + sine))
    ex, ey, ez = frame[0, 0] / far, frame[0, 1] / far, frame[0, 2] / far
    if abs(ex) < 0.6:
        fx, fy, fz = 0.0, ez, -ey
    else:
        fx, fy, fz = -ez, 0.0, ex
    # the rays of a distant light are parallel, and what matters is how far apart they are
    scale = (caster.radius if light.fall == DISTANT else sine) / math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx * scale, fy * scale, fz * scale
    frame[0, 0], frame[0, 1], frame[0, 2] = ex * cosine, ey * cosine, ez * cosine
    frame[1, 0], frame[1, 1], frame[1, 2] = fx, fy, fz
    frame[2, 0], frame[2, 1], frame[2, 2] = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    return True


@jitable
def sphere_tangencies(
    light: LightPoint, caster: Sphere, beyond: bool, chart: Chart, frame: Array, events: Table[Event], n: int, low:
    float, high: float
) -> int:  # fmt: skip
    """Azimuths at which a scan line of the charted sphere touches the shadow of ``caster``: no closed form.

    The edge's azimuth turns back there; turns are bracketed by rays along the edge and solved (Illinois).
    """
    if not edge_frame(light, caster, frame):
        return n
    step = 2.0 * math.pi / RAYS
    before, _, _, _, _ = edge_turn(0.0, light, caster, beyond, chart, frame)
    for k in range(1, RAYS + 1):
        turn, x, y, z, _ = edge_turn(k * step, light, caster, beyond, chart, frame)
        left, right, fa, fb = (k - 1) * step, k * step, before, turn
        if (fa != fa) != (fb != fb):
            # the edge leaves the sphere's lit side between the two: look up to there
            hit, miss, last = (right, left, fb) if fa != fa else (left, right, fa)
            for _ in range(30):
                psi = 0.5 * (hit + miss)
                f, _, _, _, _ = edge_turn(psi, light, caster, beyond, chart, frame)
                if f == f:
                    hit, last = psi, f
                else:
                    miss = psi
            if fa != fa:
                left, fa = hit, last
            else:
                right, fb = hit, last
        if fa * fb < 0.0:
            f, faces = math.nan, False
            for _ in range(60):
                psi = (left * fb - right * fa) / (fb - fa)
                f, x, y, z, faces = edge_turn(psi, light, caster, beyond, chart, frame)
                if f != f:
                    break
                moved = abs(psi - right)
                if f * fb < 0.0:
                    left, fa = right, fb
                else:
                    fa *= 0.5
                right, fb = psi, f
                # the azimuth is stationary here, so half the digits of psi are all of its own
                if f == 0.0 or moved < 1e-9:
                    break
            if f == f and faces:
                if moves(x):
                    # the azimuth is stationary: it moves as at a place of the edge that stands still
                    _, x, y, z, _ = edge_turn(held(right), light, caster, beyond, chart, frame)
                phi = math.atan2(y, x)
                if within_lobe(phi, math.atan2(math.sqrt(x * x + y * y), z), chart):
                    n = add_event(events, n, phi, low, high, ROOT)
        before = turn
    return n


@jitable
def cone_tangencies(
    c: int, cones: Table[Cone] | None, work: Work, events: Table[Event], n: int, low: float, high: float
) -> int:  # fmt: skip
    """Azimuths at which a scan line of the charted sphere touches a cone: either half, where it enters and leaves."""
    if cones is None:
        return n
    cone = cones[c]
    for side in range(2):
        n = sphere_tangencies(cone.apex, cone.ball, side == 1, work.chart, work.frame, events, n, low, high)
        if cone.apex.fall != DISTANT:
            n = sphere_tangencies(cone.apex, cone.twin, side == 1, work.chart, work.frame, events, n, low, high)
    return n


@jitable
def gleam_tangencies(row: Wall, work: Work, events: Table[Event], n: int, low: float, high: float) -> int:
    """Azimuths at which a scan line begins or ceases to meet the end of a highlight: no closed form.

    How often the line meets it is asked on ``EDGE_LINES`` lines; where the number changes from one to the next the
    place is found by halving. An end that is met on fewer than two neighbouring lines may be missed.
    """
    end = 0.5 * math.pi * (1.0 - 1e-12)
    before, at = 0, low
    for k in range(EDGE_LINES + 1):
        phi = low + (high - low) * k / EDGE_LINES
        met = edge_search(row, 0.0, end, math.cos(phi), math.sin(phi), work.chart, work.bernstein)
        if k > 0 and met != before:
            left, right = at, phi
            for _ in range(50):
                middle = 0.5 * (left + right)
                c, s = math.cos(middle), math.sin(middle)
                if edge_search(row, 0.0, end, c, s, work.chart, work.bernstein) == before:
                    left = middle
                else:
                    right = middle
            n = add_event(events, n, 0.5 * (left + right), low, high, ROOT)
        before, at = met, phi
    return n


@inlined
def tangencies(view: View, work: Work, events: Table[Event], n: int, low: float, high: float) -> int:
    """Add them to ``events``; new count."""
    chart = work.chart
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        kind = row.kind
        if kind == GLEAM_EDGE:
            n = gleam_tangencies(row, work, events, n, low, high)
        elif chart.shape_index < 0.0:
            if kind in (SHADOW, BALL, PENUMBRA):
                n = floor_tangencies(row, chart, events, n, low, high)
        elif kind == SHADOW and row.tag == SHADOW_EDGE:
            # light from behind matters where terminators are open to highlights
            for side in range(2 if view.shading.terminator != CUT and view.shading.ks > 0.0 else 1):
                n = sphere_tangencies(
                    view.points[row.light], view.spheres[row.shape_index], side == 1, chart, work.frame, events, n,
                    low, high,
                )  # fmt: skip
        elif kind == SHADOW and row.tag == HIGHLIGHT:
            n = cone_tangencies(row.light, view.cones, work, events, n, low, high)
    return n
