"""Where two walls of one chart cross, in closed form: two circles of one kind, or a circle and any quadric wall.

Two circles of one sphere meet where ``x = u a + v b +- w (a x b)``. Every other wall of a sphere's chart is a quadratic
form of the hit point, and every wall of the floor's chart a quadratic form of the direction; along a circle
``x(t) = p + q cos t + r sin t`` either becomes a quartic in tan(t/2). A shadow edge against another one, or against a
cone of directions on a sphere, has no such form: these are traced (``chambers/traces.py``). What neither finds, the
scan lines that disagree tell of (``quadrature/panel_search.py``).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import CROSSING, ROOT, add_event, axis_events, chart_events, close_events
from symrender.chambers.labels import is_hidden
from symrender.chambers.reach import are_apart
from symrender.chambers.records import Chart, Event, Wall
from symrender.chambers.roots import quartic_roots
from symrender.chambers.tangencies import tangencies
from symrender.chambers.traces import set_circles, trace_crossings
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
    is_rooted,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, most, moves, tangent
from symrender.jit.records import Table
from symrender.scene.arrays import MARBLE

Array = npt.NDArray[np.float64]

NEAR_PLANE = 1e-2
"""Cosine of a cone's half-angle below which its crossings with circles are found from those of a plane as well."""
ONE_OF_TWO = 1e-6
"""Radians between two crossings below which they may be one that rounding parts, as the root of a double one."""
FAST = 30.0
"""How many times faster than half of a chart's events a crossing must move to be held."""
MOST_HELD = 256
"""Events of a chart beyond which none is."""
NEAR_ROOT = 1e-3
"""Largest correction of a half-tangent; a root on the cone's other half moves farther."""


@jitable
def add_product(p: Array, a: Array, b: Array, scale: float) -> None:
    """Add ``scale`` times the product of two quadratics (3,) to the quartic ``p``."""
    p[0] += scale * a[0] * b[0]
    p[1] += scale * (a[0] * b[1] + a[1] * b[0])
    p[2] += scale * (a[0] * b[2] + a[1] * b[1] + a[2] * b[0])
    p[3] += scale * (a[1] * b[2] + a[2] * b[1])
    p[4] += scale * a[2] * b[2]


@jitable
def lift(p: float, q: float, r: float, out: Array) -> None:
    """(1 + t^2) (p + q cos + r sin) of the angle with half-tangent t, as a quadratic in t."""
    out[0], out[1], out[2] = p + q, 2.0 * r, p - q


@jitable
def cone_level(axis0: float, axis1: float, axis2: float, sine: float, v: Array, p: Array, f: Array, g: Array) -> None:
    """Quartic of |v x axis|^2 - sine^2 |v|^2 for a vector ``v`` (3, 3) of quadratics; ``f``, ``g`` scratch (3,)."""
    if abs(axis0) < 0.6:
        f0, f1, f2 = 0.0, axis2, -axis1
    else:
        f0, f1, f2 = -axis2, 0.0, axis0
    inv = 1.0 / math.sqrt(f0 * f0 + f1 * f1 + f2 * f2)
    f0, f1, f2 = f0 * inv, f1 * inv, f2 * inv
    g0, g1, g2 = axis1 * f2 - axis2 * f1, axis2 * f0 - axis0 * f2, axis0 * f1 - axis1 * f0
    for i in range(5):
        p[i] = 0.0
    for i in range(3):
        f[i] = f0 * v[0, i] + f1 * v[1, i] + f2 * v[2, i]
        g[i] = g0 * v[0, i] + g1 * v[1, i] + g2 * v[2, i]
    add_product(p, f, f, 1.0)
    add_product(p, g, g, 1.0)
    for i in range(3):
        add_product(p, v[i], v[i], -sine * sine)


@jitable
def shadow_quadric(row: Wall, chart: Chart, v: Array, p: Array, f: Array, g: Array) -> None:
    """Quartic of a shadow edge's level; ``v`` rows: the normal's frame coordinates, or the direction's on the floor."""
    for i in range(5):
        p[i] = 0.0
    if chart.shape_index >= 0.0:
        r = chart.radius
        # the constant one, lifted, is (1, 0, 1)
        for i in range(3):
            one = 0.0 if i == 1 else 1.0
            f[i] = row.first_level * one + r * (
                -row.first[0] * v[0, i] + row.first[1] * v[1, i] + row.first[2] * v[2, i]
            )
            g[i] = row.second_level * one + r * (
                -row.second[0] * v[0, i] + row.second[1] * v[1, i] + row.second[2] * v[2, i]
            )
        add_product(p, f, f, -1.0)
        add_product(p, g, g, -1.0)
        for i in range(3):
            one = 0.0 if i == 1 else 1.0
            f[i] = (row.origin2 + r * r) * one + 2.0 * r * (
                -row.origin[0] * v[0, i] + row.origin[1] * v[1, i] + row.origin[2] * v[2, i]
            )
            g[i] = one
        add_product(p, f, g, row.sine2)
        return
    h = chart.height
    for i in range(3):
        f[i] = row.first_level * v[0, i] + h * (row.first[1] * v[1, i] + row.first[2] * v[2, i])
        g[i] = row.second_level * v[0, i] + h * (row.second[1] * v[1, i] + row.second[2] * v[2, i])
    add_product(p, f, f, -1.0)
    add_product(p, g, g, -1.0)
    for i in range(3):
        f[i] = row.origin2 * v[0, i] + 2.0 * h * (row.origin[1] * v[1, i] + row.origin[2] * v[2, i])
    add_product(p, v[0], f, row.sine2)
    add_product(p, v[1], v[1], row.sine2 * h * h)
    add_product(p, v[2], v[2], row.sine2 * h * h)


@jitable
def ball_quadric(row: Wall, chart: Chart, v: Array, p: Array, f: Array) -> None:
    """Quartic of the floor's circle inside a ball along a circle of directions."""
    h = chart.height
    for i in range(5):
        p[i] = 0.0
    for i in range(3):
        f[i] = row.power * v[0, i] - 2.0 * h * (row.foot[0] * v[1, i] + row.foot[1] * v[2, i])
    add_product(p, v[0], f, 1.0)
    add_product(p, v[1], v[1], h * h)
    add_product(p, v[2], v[2], h * h)


@inlined
def add_crossing(
    x0: float, x1: float, x2: float, normal: bool, hides: bool, kind: float, view: View, work: Work,
    events: Table[Event], n: int, low: float, high: float,
) -> int:  # fmt: skip
    """Note a crossing at frame coordinates ``x``, of the normal or of the direction, if it is inside the lobe and seen.

    ``hides`` says that one of the two walls bounds what is seen, so that sight cannot be asked at the crossing;
    ``kind`` is that of the event.
    """
    chart = work.chart
    k = chart.ratio
    if normal:
        if x0 <= k:
            return n
        w0, w1, w2 = 1.0 - k * x0, k * x1, k * x2
    else:
        if x0 <= 0.0 or x0 * x0 <= (1.0 - k * k) * (1.0 - 1e-12):
            return n
        w0, w1, w2 = x0, x1, x2
    size2 = w0 * w0 + w1 * w1 + w2 * w2
    along = w0 * chart.lobe_cos + w1 * chart.lobe_sin
    if not along > (chart.lobe.rim_cos - 1e-9) * math.sqrt(size2):
        return n
    if not hides:
        if normal:
            a, r = -x0, chart.radius
            qx = chart.center[0] + r * (a * chart.pole[0] + x1 * chart.e1[0] + x2 * chart.e2[0])
            qy = chart.center[1] + r * (a * chart.pole[1] + x1 * chart.e1[1] + x2 * chart.e2[1])
            qz = chart.center[2] + r * (a * chart.pole[2] + x1 * chart.e1[2] + x2 * chart.e2[2])
        else:
            r = chart.height / x0
            qx = chart.point[0] + r * (x1 * chart.e1[0] + x2 * chart.e2[0])
            qy = chart.point[1] + r * (x1 * chart.e1[1] + x2 * chart.e2[1])
            qz = 0.0
        if is_hidden(qx, qy, qz, view, work):
            return n
    return add_event(events, n, math.atan2(x2, x1), low, high, kind)


@inlined
def circle_crossings(
    one: Wall, other: Wall, hides: bool, kind: float, view: View, work: Work, events: Table[Event], n: int, low: float,
    high: float,
) -> int:  # fmt: skip
    """Note where two circles a.x = p and b.x = q of one sphere meet."""
    a0, a1, a2, p, normal = one.axis[0], one.axis[1], one.axis[2], one.cos, one.kind == NORMAL
    b0, b1, b2, q = other.axis[0], other.axis[1], other.axis[2], other.cos
    x0, x1, x2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    s2 = x0 * x0 + x1 * x1 + x2 * x2
    if s2 < 1e-24:
        return n
    d = a0 * b0 + a1 * b1 + a2 * b2
    u, v = (p - d * q) / s2, (q - d * p) / s2
    w2 = (1.0 - (u * p + v * q)) / s2
    if not w2 >= 0.0:
        return n
    w = math.sqrt(w2)
    for _ in range(2):
        n = add_crossing(
            u * a0 + v * b0 + w * x0, u * a1 + v * b1 + w * x1, u * a2 + v * b2 + w * x2, normal, hides, kind, view,
            work, events, n, low, high,
        )  # fmt: skip
        w = -w
    return n


@jitable
def half_tangent(t: float, cosine: float, v: Array, p: Array) -> float:
    """From t near it to the root of p(t) = cosine |v(t)|, p the inner product of v and a cone's axis, by Newton.

    ``v`` (3, 3) and ``p`` are quadratics in t, all over 1 + t^2.
    """
    for _ in range(6):
        square, slope = 0.0, 0.0
        for a in range(3):
            value = v[a, 0] + t * (v[a, 1] + t * v[a, 2])
            square += value * value
            slope += value * (v[a, 1] + 2.0 * t * v[a, 2])
        size = math.sqrt(square)
        rise = p[1] + 2.0 * t * p[2] - (cosine * slope / size if size > 0.0 else 0.0)
        if rise == 0.0:
            break
        t -= (p[0] + t * (p[1] + t * p[2]) - cosine * size) / rise
    return t


@inlined
def along_circle(
    row: Wall, other: Wall, hides: bool, kind: float, view: View, work: Work, events: Table[Event], n: int, low: float,
    high: float,
) -> int:  # fmt: skip
    """Note where the circle ``row`` meets another wall: a cone of directions, a shadow's edge or a ball's circle.

    The quadric of a cone near a plane is near a square, whose double roots are lost in its rounding: such a cone is
    met from the plane's roots too.
    """
    chart = work.chart
    normal = row.kind == NORMAL
    axis0, axis1, axis2, cosine = other.axis[0], other.axis[1], other.axis[2], other.cos
    sine = other.sin if other.kind == DIRECTION else -1.0
    a0, a1, a2 = row.axis[0], row.axis[1], row.axis[2]
    if abs(a0) < 0.6:
        f0, f1, f2 = 0.0, a2, -a1
    else:
        f0, f1, f2 = -a2, 0.0, a0
    inv = 1.0 / math.sqrt(f0 * f0 + f1 * f1 + f2 * f2)
    f0, f1, f2 = f0 * inv, f1 * inv, f2 * inv
    g0, g1, g2 = a1 * f2 - a2 * f1, a2 * f0 - a0 * f2, a0 * f1 - a1 * f0
    c, s, k = row.cos, row.sin, chart.ratio
    v, p, f, g, lean = work.quadric[:3], work.quadric[3], work.quadric[4], work.quadric[5], work.quadric[6]
    for _ in range(2):
        lift(c * a0, s * f0, s * g0, v[0])
        lift(c * a1, s * f1, s * g1, v[1])
        lift(c * a2, s * f2, s * g2, v[2])
        if sine >= 0.0 and normal:
            for i in range(3):
                one = 0.0 if i == 1 else 1.0
                v[0, i] = one - k * v[0, i]
                v[1, i] *= k
                v[2, i] *= k
        for i in range(3):
            lean[i] = axis0 * v[0, i] + axis1 * v[1, i] + axis2 * v[2, i]
        for plane in range(2):
            if plane == 1:
                if sine < 0.0 or abs(cosine) > NEAR_PLANE:
                    continue
                for i in range(3):
                    p[i] = lean[i]
                p[3] = p[4] = 0.0
            elif sine >= 0.0:
                if cosine == 0.0:
                    continue
                cone_level(axis0, axis1, axis2, sine, v, p, f, g)
            elif other.kind == SHADOW:
                shadow_quadric(other, chart, v, p, f, g)
            else:
                ball_quadric(other, chart, v, p, f)
            # Bernstein coefficients on t in [-1, 1]
            b = work.bernstein
            b[0] = p[0] - p[1] + p[2] - p[3] + p[4]
            b[1] = p[0] - 0.5 * p[1] + 0.5 * p[3] - p[4]
            b[2] = p[0] - p[2] / 3.0 + p[4]
            b[3] = p[0] + 0.5 * p[1] - 0.5 * p[3] - p[4]
            b[4] = p[0] + p[1] + p[2] + p[3] + p[4]
            found = quartic_roots(b, work.stack, work.quartic)
            for i in range(min(found, 4)):
                t = 2.0 * work.quartic[i] - 1.0
                if sine >= 0.0 and cosine != 0.0:
                    # the quartic is of squares: near the point's foot on a huge ball its roots have half the digits
                    polished = half_tangent(t, cosine, v, lean)
                    if plane == 1 or abs(polished - t) < NEAR_ROOT:
                        t = polished
                inv = 1.0 / (1.0 + t * t)
                ct, st = (1.0 - t * t) * inv, 2.0 * t * inv
                n = add_crossing(
                    c * a0 + s * (f0 * ct + g0 * st), c * a1 + s * (f1 * ct + g1 * st),
                    c * a2 + s * (f2 * ct + g2 * st), normal, hides, kind, view, work, events, n, low, high,
                )  # fmt: skip
        f0, f1, f2, g0, g1, g2 = -f0, -f1, -f2, -g0, -g1, -g2
    return n


@inlined
def chart_crossings(view: View, work: Work, events: Table[Event], n: int, low: float, high: float) -> int:
    """Add the azimuths of all closed-form crossings inside the lobe to ``events``; new count."""
    chart, walls = work.chart, work.walls
    count = min(work.counts.walls, walls.shape[0])
    floor = chart.shape_index < 0.0
    for i in range(count):
        one = walls[i]
        kind = one.kind
        for j in range(-2, i):
            # the limb and the rim come first; circles at the limb are among ``chart_events``
            if j == -2 and (floor or kind != SHADOW):
                continue
            other = walls[j] if j >= 0 else work.circles[LIMB_ROW if j == -2 else RIM_ROW]
            if j >= 0 and are_apart(one, other):
                continue
            also, hides = other.kind, True
            if j >= 0:
                hides = not (
                    (one.tag == TEXTURE_EDGE or one.tag == TERMINATOR or one.tag == SHADOW_EDGE)
                    and (other.tag == TEXTURE_EDGE or other.tag == TERMINATOR or other.tag == SHADOW_EDGE)
                )
            # the root of the distance from a wall leaves the power 3/2 of that from where another cuts it off
            event = ROOT if is_rooted(one) or is_rooted(other) else CROSSING
            if kind <= NORMAL and also == kind:
                n = circle_crossings(one, other, hides, event, view, work, events, n, low, high)
                continue
            # along which of the two
            row, wall = one, other
            if kind == NORMAL and also == DIRECTION:
                pass
            elif (kind == DIRECTION and also == NORMAL) or (
                kind in (SHADOW, BALL) and (also == NORMAL or (also == DIRECTION and floor))
            ):
                row, wall = other, one
            elif not (also in (SHADOW, BALL) and (kind == NORMAL or (kind == DIRECTION and floor))):
                continue
            n = along_circle(row, wall, hides, event, view, work, events, n, low, high)
    return n


@jitable
def hold_fast(events: Table[Event], n: int) -> None:
    """Let crossings stand still that move far faster than half of all events, and such as are two of one.

    Walls that all but touch cross at a place that runs along both as they move, and what the two panels that end there
    sweep is large and cancels. Where they touch, rounding makes two crossings of one, which part at any speed. A
    panel's end is there for a kink alone, which the derivative may leave behind.
    """
    if n > MOST_HELD or not moves(events[0].azimuth):
        return
    for e in range(1, n):
        close = held(events[e].azimuth - events[e - 1].azimuth) < ONE_OF_TWO
        if close and events[e].kind == CROSSING and events[e - 1].kind == CROSSING:
            events[e].azimuth, events[e - 1].azimuth = held(events[e].azimuth), held(events[e - 1].azimuth)
    for e in range(n):
        if events[e].kind != CROSSING:
            continue
        speed, slower = most(abs(tangent(events[e].azimuth))), 0
        for i in range(n):
            if FAST * most(abs(tangent(events[i].azimuth))) < speed:
                slower += 1
        if 2 * slower >= n:
            events[e].azimuth = held(events[e].azimuth)


@inlined
def all_events(view: View, work: Work, events: Table[Event], low: float, high: float) -> int:
    """Events between low and high, with both ends, ascending. Their number."""
    set_circles(work)
    n = chart_events(work, events, low, high) - 1
    if work.chart.shape_index >= 0 and view.spheres[work.chart.shape_index].texture == MARBLE:
        n = axis_events(0.0, 0.0, 1.0, work, events, n, low, high)
    if work.chart.shape_index >= 0 and view.glows is not None:
        for k in range(view.sides.shape[0]):
            up = view.sides[k].up
            n = axis_events(up[0], up[1], up[2], work, events, n, low, high)
    n = chart_crossings(view, work, events, n, low, high)
    n = tangencies(view, work, events, n, low, high)
    n = trace_crossings(view, work, events, n, low, high)
    n = close_events(events, n, high)
    hold_fast(events, n)
    return int(n)
