"""Where a conductor's density is singular beside real directions: what its node counts are aimed by.

D has poles where the half-way direction h has tan theta_h = +- i alpha, on a line of directions w at the zeros of

    p(w) = 2 + 2 w.w_o - (1 - alpha^2) ((w + w_o).N)^2.

About the mirror direction m, with a and b the distances from it along and across a meridian of the chart and psi the
angle of the plane of incidence to that meridian, p is a quadratic form,

    A a^2 + 2 B a b + C b^2 + (2 alpha cos_o)^2,    A = cos_o^2 cos^2 psi + sin^2 psi, ..., A C - B^2 = cos_o^2.

On a line its zeros follow by Newton's method from that form's; the integral over lines is singular where both zeros
of a line meet between them, or at the line's end.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.lobes.record import CONDUCTOR, Conductor
from symrender.chambers.records import Chart
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table

STEPS: Final = 6
"""Most steps of Newton's method, from the quadratic form's zero and then from where p is least on the line."""
SETTLED: Final = 1e-4
"""Relative change after which it has."""
STRIDE: Final = 0.2
"""Longest step, in angle, on the way to where p is least on a line."""
LEAST_STEPS: Final = 20
"""Most of them."""
BELL: Final = 2.0
"""Widths of a Gauss curve off the real line within which it is taken as tame: it grows by e^4."""
FOOT: Final = 6.0
"""Widths from its middle beyond which a Gauss curve is nothing: e^-36."""


@inlined
def form(chart: Chart) -> tuple[float, float, float]:
    """(A, B, C) of the quadratic form of p about m."""
    cos_view = chart.lobe.cos_view
    along, aside = 0.0, 0.0
    for a in range(3):
        # along the meridian at m, away from the pole, then across it
        along += chart.normal[a] * (chart.lobe_cos * chart.e1[a] - chart.lobe_sin * chart.pole[a])
        aside += chart.normal[a] * chart.e2[a]
    # the part of N across m has the length sin(theta_o) = sqrt(1 - cos_o^2)
    return 1.0 - along * along, -along * aside, 1.0 - aside * aside if cos_view < 1.0 else 1.0


@jitable
def pole_across(chart: Chart, conductors: Table[Conductor] | None) -> tuple[float, float]:
    """(azimuth, depth) at which the integral over lines is singular beside the real azimuths; depth inf: nowhere."""
    if conductors is None:
        return 0.0, math.inf
    lobe = chart.lobe
    if lobe.kind != CONDUCTOR or not chart.lobe_sin > 1e-9:
        return 0.0, math.inf
    one, both, other = form(chart)
    wide = 2.0 * lobe.alpha * lobe.cos_view
    off = chart.beta_max - chart.lobe_beta
    if off >= 0.0:
        # both zeros of a line meet
        return 0.0, 2.0 * lobe.alpha * math.sqrt(max(0.0, one)) / chart.lobe_sin
    # one of them comes to the line's end
    depth = math.sqrt((lobe.cos_view * off) ** 2 + wide * wide * other) / max(other, 1e-12)
    return -both * off / max(other, 1e-12) / chart.lobe_sin, depth / chart.lobe_sin


@jitable
def pole_on_horizon(chart: Chart, conductors: Table[Conductor] | None) -> tuple[float, float]:
    """(azimuth, depth) at which a zero of p comes to the horizon of P, where it ends lines that see the shape."""
    if conductors is None:
        return 0.0, math.inf
    lobe = chart.lobe
    if lobe.kind != CONDUCTOR:
        return 0.0, math.inf
    return on_horizon(-1.0 + 0.5 * (1.0 - lobe.alpha) * (1.0 + lobe.alpha) * lobe.cos_view * lobe.cos_view, chart)


@jitable
def on_horizon(level: float, chart: Chart) -> tuple[float, float]:
    """(azimuth, depth) of the place on the horizon of P at which w.w_o is this level, one not above -sin(theta_o).

    On the great circle across N, w = m' cos chi + (N x m') sin chi with m' the direction of m in it, w.w_o is
    -sin(theta_o) cos(chi), and that is at chi = +- iy, cosh y = -level/sin(theta_o).
    """
    lobe = chart.lobe
    if not lobe.cos_view < 1.0 - 1e-9:
        return 0.0, math.inf
    cos_view = lobe.cos_view
    sine = math.sqrt((1.0 - cos_view) * (1.0 + cos_view))
    n1, n2, n3 = 0.0, 0.0, 0.0
    for a in range(3):
        n1 += chart.normal[a] * chart.e1[a]
        n2 += chart.normal[a] * chart.e2[a]
        n3 += chart.normal[a] * chart.pole[a]
    h1, h2 = (chart.lobe_sin - cos_view * n1) / sine, -cos_view * n2 / sine
    h3 = (chart.lobe_cos - cos_view * n3) / sine
    if h3 < math.cos(chart.beta_max):
        # the horizon is beyond the shape there
        return 0.0, math.inf
    t1, t2 = n2 * h3 - n3 * h2, n3 * h1 - n1 * h3
    ch = max(1.0, -level / sine)
    sh = math.sqrt((ch - 1.0) * (ch + 1.0))
    # the azimuth of w is -i/2 log of (w.e1 + i w.e2)/(w.e1 - i w.e2)
    ur, ui = h1 * ch - t2 * sh, t1 * sh + h2 * ch
    vr, vi = h1 * ch + t2 * sh, t1 * sh - h2 * ch
    depth = 0.5 * abs(math.log(max(1e-300, math.hypot(ur, ui)) / max(1e-300, math.hypot(vr, vi))))
    phi = 0.5 * (math.atan2(ui, ur) - math.atan2(vi, vr))
    return phi + (math.pi if math.cos(phi) * h1 + math.sin(phi) * h2 < 0.0 else 0.0), depth


@jitable
def pole_on_line(c: float, s: float, chart: Chart) -> tuple[float, float]:
    """(x, y): polar angle from the chart's pole at which p is 0 on the line (c, s), x + iy or x - iy."""
    lobe = chart.lobe
    cos_view = lobe.cos_view
    one, both, _ = form(chart)
    # the line's distance from m, and where it is nearest
    b = math.atan2(chart.lobe_sin * s, math.hypot(chart.lobe_cos, chart.lobe_sin * c))
    nearest = math.atan2(chart.lobe_sin * c, chart.lobe_cos)
    one = max(one, 1e-12)
    guess = nearest - both * b / one
    depth = max(1e-9, cos_view * math.sqrt(b * b + 4.0 * lobe.alpha * lobe.alpha * one) / one)
    gn, en, gm, em = 0.0, 0.0, chart.lobe_cos, chart.lobe_sin * c
    for a in range(3):
        gn += chart.normal[a] * chart.pole[a]
        en += chart.normal[a] * (c * chart.e1[a] + s * chart.e2[a])
    go, eo = 2.0 * cos_view * gn - gm, 2.0 * cos_view * en - em
    x, y = settled_zero(guess, min(depth, 3.0), cos_view, gn, en, go, eo, lobe.alpha)
    if y == 0.0:
        # far from a grazing mirror direction the form misleads: begin where p is least on the line
        x, y = lowest(guess, cos_view, gn, en, go, eo, lobe.alpha)
        x, y = settled_zero(x, y, cos_view, gn, en, go, eo, lobe.alpha)
    return (x, y) if y > 0.0 else (guess, depth)


@jitable
def settled_zero(
    x: float, y: float, cos_view: float, gn: float, en: float, go: float, eo: float, alpha: float
) -> tuple[float, float]:
    """A zero of p on a line by Newton's method from x + iy; y is 0 where that does not settle.

    ``gn`` and ``en`` are N along the chart's pole and along the line's azimuth, ``go`` and ``eo`` are w_o.
    """
    kappa = (1.0 - alpha) * (1.0 + alpha)
    for _ in range(STEPS):
        sx, cx, sh, ch = math.sin(x), math.cos(x), math.sinh(y), math.cosh(y)
        cr, ci, sr, si = cx * ch, -sx * sh, sx * ch, cx * sh
        ur, ui = cr * gn + sr * en + cos_view, ci * gn + si * en
        vr, vi = -sr * gn + cr * en, -si * gn + ci * en
        pr = 2.0 + 2.0 * (cr * go + sr * eo) - kappa * (ur * ur - ui * ui)
        pi = 2.0 * (ci * go + si * eo) - 2.0 * kappa * ur * ui
        qr = 2.0 * (-sr * go + cr * eo) - 2.0 * kappa * (ur * vr - ui * vi)
        qi = 2.0 * (-si * go + ci * eo) - 2.0 * kappa * (ur * vi + ui * vr)
        size = qr * qr + qi * qi
        if not size > 0.0:
            break
        dx, dy = (pr * qr + pi * qi) / size, (pi * qr - pr * qi) / size
        x, y = x - dx, y - dy
        if not (abs(x) < 10.0 and abs(y) < 10.0):
            break
        if abs(dx) + abs(dy) < SETTLED * abs(y):
            return x, abs(y)
    return x, 0.0


@jitable
def lowest(x: float, cos_view: float, gn: float, en: float, go: float, eo: float, alpha: float) -> tuple[float, float]:
    """The real x where p is least on a line, and the y of its parabola's zeros there; arguments as of ``settled_zero``.

    Where p bends downwards a step is taken against its slope.
    """
    kappa = (1.0 - alpha) * (1.0 + alpha)
    depth = STRIDE
    for _ in range(LEAST_STEPS):
        sx, cx = math.sin(x), math.cos(x)
        u, v = cx * gn + sx * en + cos_view, cx * en - sx * gn
        p = 2.0 + 2.0 * (cx * go + sx * eo) - kappa * u * u
        slope = 2.0 * (cx * eo - sx * go) - 2.0 * kappa * u * v
        bend = -2.0 * (cx * go + sx * eo) - 2.0 * kappa * (v * v - u * (u - cos_view))
        step = -slope / bend if bend > 0.0 else -STRIDE if slope > 0.0 else STRIDE
        step = max(-STRIDE, min(STRIDE, step))
        x += step
        depth = math.sqrt(2.0 * max(0.0, p) / bend) if bend > 0.0 else STRIDE
        if abs(step) < SETTLED * depth:
            break
    return x, min(max(depth, 1e-9), 3.0)


@jitable
def bell_width(x: float, y: float, c: float, s: float, chart: Chart) -> float:
    """How wide Beckmann's D is along the line (c, s), of which x +- iy are the zeros of p.

    D falls like exp(-q), q = tan^2 theta_h/alpha^2, and near x p is (1 + q_x) (1 + (t - x)^2/y^2) for a factor, so that
    q grows by 1 within y/sqrt(1 + q_x).
    """
    lobe = chart.lobe
    sx, cx = math.sin(x), math.cos(x)
    facing, back = lobe.cos_view, 1.0
    for a in range(3):
        wn = cx * chart.pole[a] + sx * (c * chart.e1[a] + s * chart.e2[a])
        facing += wn * chart.normal[a]
        m = chart.lobe_cos * chart.pole[a] + chart.lobe_sin * chart.e1[a]
        back += wn * (2.0 * lobe.cos_view * chart.normal[a] - m)
    # 2 + 2 w.w_o is the square of |w + w_o|, whose part along N is ``facing``
    gap = max(0.0, 2.0 * back - facing * facing)
    wide = lobe.alpha * abs(facing)
    return y * wide / math.sqrt(wide * wide + gap)


@jitable
def lobe_pole(c: float, s: float, chart: Chart) -> tuple[float, float, float]:
    """(x, y, bell): inner coordinate of the density's nearest pole x +- iy of the line (c, s), of a conductor's lobe.

    Beckmann's density has none, but off the real line it grows as it falls along it: ``bell`` is its width there, and y
    no more than ``BELL`` of them. Of GGX ``bell`` is 0.
    """
    x, y = pole_on_line(c, s, chart)
    at, deep = inner_pole(x, y, chart)
    if chart.lobe.beckmann == 0:
        return at, deep, 0.0
    bell = bell_width(x, y, c, s, chart) * deep / y
    return at, min(deep, BELL * bell), bell


@inlined
def foot_of_bell(start: float, stop: float, x: float, bell: float) -> tuple[float, float]:
    """Where a Gauss curve about ``x`` is most felt on start..stop, and how far off the real line it is tame there.

    At a distance d from its middle it grows by e within bell^2/(2 d).
    """
    at = min(max(start, x), stop)
    away = abs(at - x)
    if away > FOOT * bell:
        return at, math.inf
    return at, BELL * bell / max(1.0, 2.0 * away / bell)


@jitable
def inner_pole(x: float, y: float, chart: Chart) -> tuple[float, float]:
    """The inner coordinate of the polar angle x + iy."""
    if chart.shape_index >= 0.0:
        # it is the arc sine of sin(beta)/k
        u, v = math.sin(x) * math.cosh(y) / chart.ratio, math.cos(x) * math.sinh(y) / chart.ratio
        low, high = math.hypot(u + 1.0, v), math.hypot(u - 1.0, v)
        x = math.asin(max(-1.0, min(1.0, 0.5 * (low - high))))
        ample = max(1.0, 0.5 * (low + high))
        y = math.log(ample + math.sqrt((ample - 1.0) * (ample + 1.0)))
    return x, y
