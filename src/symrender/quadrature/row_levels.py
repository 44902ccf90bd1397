"""Where masking and reflectance of a conductor's lobe are singular beside rows of squares, and how tame they are there.

On a row (x, y, -h) of the floor, from the point, a level w.a = zeta of the lobe (``chambers/lobes/levels.py``) is

    (a.q)^2 = zeta^2 |q|^2,

a quadratic in x with complex coefficients, half of whose roots are of -zeta, where nothing happens. The smoother the
metal, the closer the root of its masking comes to the point's own horizon, in which the rows that are seen end.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.levels import LEVELS, arc_cosine, lobe_level
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.records import Chart
from symrender.chambers.roots import square_root
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.quadrature.line_poles import nearest_pole, note_pole
from symrender.quadrature.panel_maps import ellipse_sum

Array = npt.NDArray[np.float64]


@inlined
def is_metal(view: View, chart: Chart) -> bool:
    """Whether the lobe at hand has levels."""
    return bool(view.conductors is not None and chart.lobe.kind == CONDUCTOR)


@inlined
def floor_axis(of_view: bool, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """N, or w_o, in the floor's frame."""
    n0, n1, n2 = held(chart.normal[0]), held(chart.normal[1]), held(chart.normal[2])
    if of_view:
        twice = 2.0 * held(chart.lobe.cos_view)
        return twice * n0 - held(lobe[0]), twice * n1 - held(lobe[1]), twice * n2 - held(lobe[2])
    return n0, n1, n2


@inlined
def note_root(x: float, depth: float, axis: float, rest: float, real: float, imaginary: float, work: Work) -> None:
    """Note the root x + i depth of a level's square if it is of the level itself."""
    side = (axis * x + rest) * real + axis * depth * imaginary
    if (real == 0.0 or side >= 0.0) and work.counts.poles < work.poles.shape[0]:
        note_pole(x, abs(depth), work)


@jitable
def levels_on_row(at: float, column: bool, lobe: Array, view: View, work: Work) -> None:
    """Make the poles at hand those of the row y = ``at``, or of the ``column`` x = ``at``."""
    chart = work.chart
    work.counts.poles = 0
    h, y = held(chart.height), held(at)
    for i in range(LEVELS):
        of_view, real, imaginary = lobe_level(i, chart, view.conductors)
        if real == math.inf:
            continue
        a0, a1, a2 = floor_axis(of_view, lobe, chart)
        axis, rest = (a1, a0 * y - a2 * h) if column else (a0, a1 * y - a2 * h)
        zr, zi = real * real - imaginary * imaginary, 2.0 * real * imaginary
        far2 = y * y + h * h
        # (ar + i ai) x^2 + 2 b x + cr + i ci
        ar, ai, b, cr, ci = axis * axis - zr, -zi, axis * rest, rest * rest - zr * far2, -zi * far2
        dr, di = square_root(b * b - ar * cr + ai * ci, -ar * ci - ai * cr)
        tr, ti = (-b - dr, -di) if b >= 0.0 else (-b + dr, di)
        size = ar * ar + ai * ai
        if size > 1e-30:
            note_root(
                (tr * ar + ti * ai) / size, (ti * ar - tr * ai) / size, axis, rest, real, imaginary, work
            )  # fmt: skip
        size = tr * tr + ti * ti
        if size > 1e-300:
            note_root(
                (cr * tr + ci * ti) / size, (ci * tr - cr * ti) / size, axis, rest, real, imaginary, work
            )  # fmt: skip


@inlined
def piece_log(start: float, stop: float, log_rho: float, work: Work) -> float:
    """The least of ``log_rho`` and that of the Bernstein ellipse of a piece through the pole nearest to it."""
    length, nearest = held(stop) - held(start), nearest_pole(held(start), held(stop), work)
    if nearest == math.inf:
        return log_rho
    ratio = nearest / max(length, 1e-300)
    return min(log_rho, math.log(ratio + math.sqrt(max(1e-12, ratio * ratio - 1.0))))


@jitable
def sides_log(
    a: float, b: float, kind_a: float, kind_b: float, x0: float, x1: float, log_rho: float, lobe: Array, view: View,
    work: Work,
) -> float:  # fmt: skip
    """The least of ``log_rho`` and that of a strip a..b of rows whose pieces end in the columns x0 and x1.

    Across rows the integral is singular where a pole of theirs meets an end that stands still, where that is seen.
    """
    normal, best = work.chart.normal, math.inf
    low, high = held(a), held(b)
    for side in range(2):
        x = x0 if side == 0 else x1
        here = held(normal[0]) * x - held(normal[2]) * held(work.chart.height)
        if max(here + held(normal[1]) * low, here + held(normal[1]) * high) <= 0.0:
            continue
        levels_on_row(x, True, lobe, view, work)
        for i in range(work.counts.poles):
            best = min(best, ellipse_sum(work.poles[i, 0], work.poles[i, 1], low, high, kind_a, kind_b))
    if best == math.inf:
        return log_rho
    return min(log_rho, math.log(best + math.sqrt(max(1e-12, best * best - 1.0))))


@jitable
def levels_span(x: float, y: float, half: float, lobe: Array, view: View, work: Work) -> float:
    """The length over which the lobe's levels leave a block of this half side about (x, y) tame."""
    chart = work.chart
    h = held(chart.height)
    away = math.sqrt(x * x + y * y)
    d = math.sqrt(away * away + h * h)
    foot = max(0.0, away - 1.4143 * half)
    ratio = 1.4143 * half / d
    around = math.asin(ratio) if ratio < 1.0 else math.pi
    tame = math.inf
    for i in range(LEVELS):
        of_view, real, imaginary = lobe_level(i, chart, view.conductors)
        if real == math.inf:
            continue
        a0, a1, a2 = floor_axis(of_view, lobe, chart)
        theta, depth = arc_cosine(real, imaginary)
        cosine = (x * a0 + y * a1 - h * a2) / d
        gap = max(0.0, abs(math.acos(max(-1.0, min(1.0, cosine))) - theta) - around)
        tame = min(tame, math.sqrt(gap * gap + depth * depth))
    return 2.0 * math.sqrt(foot * foot + h * h) * tame
