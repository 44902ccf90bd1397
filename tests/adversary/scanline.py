"""Compiled: the integral along one line of a chart, cut wherever the label changes.

A line is looked at in even steps, and where any highlight, the lobe or a sphere comes nearest, and where a shadow may
touch it; between looks of different labels the change is bisected; each piece is integrated by Gauss-Kronrod rules
that halve where the two orders disagree.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.polynomial.legendre import legval

from .chart import SINE, base_at, direction, gap, look, place_of
from .compile import kernel
from .light import Vector
from .world import EXPONENT, MASS, MIRROR, PLACE, SHININESS, SURFACE, THETA_MAX, Array, World

_NODES = np.array([
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851, 0.864864423359769072789712788640926,
    0.741531185599394439863864773280788, 0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0])  # fmt: skip
_KRONROD = np.array([
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204, 0.104790010322250183839876322541518,
    0.140653259715525918745189590510238, 0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714])  # fmt: skip
_GAUSS = np.array([
    0.0, 0.129484966168869693270611432679082, 0.0, 0.279705391489276667901467771423780,
    0.0, 0.381830050505118944950369775488975, 0.0, 0.417959183673469387755102040816327])  # fmt: skip

# Legendre coefficients of orders 5 and 6 from the seven nodes of Gauss, which are every second of the fifteen
_X7 = np.concatenate([-_NODES[1:7:2], _NODES[7::-2]])
_W7 = np.concatenate([_GAUSS[1:7:2], _GAUSS[7::-2]])
_LAST = np.stack([0.5 * (2 * k + 1) * _W7 * legval(_X7, np.eye(7)[k]) for k in (5, 6)])

TICKS: Final = np.concatenate([-_NODES[:7], _NODES[::-1]])
KRONROD: Final = np.concatenate([_KRONROD[:7], _KRONROD[::-1]])
GAUSS: Final = np.concatenate([_GAUSS[:7], _GAUSS[::-1]])
_CUT = 1e-12
_DEEP = 16
_MOST = 400
_SHARP = 4.0
_BESIDE = 0.02  # a light so near to a surface, as seen from the point, lights a spot that even steps may pass over
_BROAD = 4.0  # peaks so many steps wide are met by the nodes of any piece


@kernel
def embedded(values: Array, length: float, total: Array) -> float:
    """Kronrod's sum of 15 rows into ``total``; returns the error of its worst channel, as QUADPACK estimates it."""
    worst = 0.0
    for c in range(3):
        k, g = 0.0, 0.0
        for i in range(15):
            k += KRONROD[i] * values[i, c]
            g += GAUSS[i] * values[i, c]
        spread, size = 0.0, 0.0
        for i in range(15):
            spread += KRONROD[i] * abs(values[i, c] - 0.5 * k)
            size += KRONROD[i] * abs(values[i, c])
        error = abs(k - g)
        if spread > 0.0 and error > 0.0:
            error = spread * min(1.0, (200.0 * error / spread) ** 1.5)
        total[c] = 0.5 * length * k
        worst = max(worst, 0.5 * length * max(error, 4e-16 * size))
    return worst


@kernel
def gauss(values: Array, length: float, total: Array) -> float:
    """Gauss's sum of every second of 15 rows into ``total``; the error of its worst channel by its last coefficients.

    Coefficients that fall like r^k leave r^14 where the last is r^6; its power 1.5 is r^9.
    """
    worst = 0.0
    for c in range(3):
        g, fifth, sixth = 0.0, 0.0, 0.0
        for i in range(7):
            f = values[2 * i + 1, c]
            g += _W7[i] * f
            fifth += _LAST[0, i] * f
            sixth += _LAST[1, i] * f
        spread, size = 0.0, 0.0
        for i in range(7):
            spread += _W7[i] * abs(values[2 * i + 1, c] - 0.5 * g)
            size += _W7[i] * abs(values[2 * i + 1, c])
        error = abs(fifth) + abs(sixth)
        if spread > 0.0 and error > 0.0:
            error = spread * min(1.0, (10.0 * error / spread) ** 1.5)
        total[c] = 0.5 * length * g
        worst = max(worst, 0.5 * length * max(error, 4e-16 * size))
    return worst


@kernel
def top(w: World, lobe: Array, chart: Array, charted: Array, low: float, high: float, phi: float, k: int) -> float:
    """Where highlight k is brightest on a stretch of a line, by golden section."""
    g = 0.6180339887498949
    a, b = high - g * (high - low), low + g * (high - low)
    f_a = base_at(w, lobe, chart, charted, a, phi, k)
    f_b = base_at(w, lobe, chart, charted, b, phi, k)
    for _ in range(16):
        if f_a > f_b:
            high, b, f_b = b, a, f_a
            a = high - g * (high - low)
            f_a = base_at(w, lobe, chart, charted, a, phi, k)
        else:
            low, a, f_a = a, b, f_b
            b = low + g * (high - low)
            f_b = base_at(w, lobe, chart, charted, b, phi, k)
    return 0.5 * (low + high)


@kernel
def bent(before: float, here: float, after: float, step: float, power: float) -> float:
    """Standard width of a peak here^power whose base was looked at a step to either side; 0 for none."""
    curve = (2.0 * here - before - after) / (step * step)
    return math.sqrt(here / (power * curve)) if curve > 0.0 and here > 0.0 else 0.0


@kernel
def along_chart(lobe: Array, chart: Array, phi: float, c: Vector) -> float:
    """The t of a line at which it comes nearest to the direction c, or -1."""
    e = (
        math.cos(phi) * chart[4] + math.sin(phi) * chart[7],
        math.cos(phi) * chart[5] + math.sin(phi) * chart[8],
        math.cos(phi) * chart[6] + math.sin(phi) * chart[9],
    )
    angle = math.atan2(e[0] * c[0] + e[1] * c[1] + e[2] * c[2], chart[1] * c[0] + chart[2] * c[1] + chart[3] * c[2])
    return tilt_to_t(lobe, chart, angle)


@kernel
def tilt_to_t(lobe: Array, chart: Array, angle: float) -> float:
    """The t at an angle to the chart's axis, or -1 outside the chart."""
    if angle < 0.0:
        return -1.0
    if chart[0] != 0.0:
        x = math.sin(angle) / chart[10]
        return math.asin(x) if x < 1.0 and angle < 0.5 * math.pi else -1.0
    depth = 2.0 * math.sin(0.5 * angle) ** 2
    if depth >= 1.0:
        return -1.0
    s = -math.expm1((lobe[EXPONENT] + 1.0) * math.log1p(-depth)) / lobe[14]
    return math.sqrt(s) if s < 1.0 else -1.0


@kernel
def foot(w: World, k: int, i: int, o: Vector) -> tuple[Vector, float]:
    """Unit direction from o to the place of sphere i, or of the floor (-1), that light k is nearest to, and how wide
    what the light does there is seen: as far as the light is off."""
    p = (w.points[k, 0], w.points[k, 1], w.points[k, 2])
    if i < 0:
        q, off = (p[0], p[1], 0.0), abs(p[2])
    else:
        s = w.spheres[i]
        d = (p[0] - s[0], p[1] - s[1], p[2] - s[2])
        far = max(1e-300, math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]))
        q = (s[0] + s[3] * d[0] / far, s[1] + s[3] * d[1] / far, s[2] + s[3] * d[2] / far)
        off = abs(far - s[3])
    e = (q[0] - o[0], q[1] - o[1], q[2] - o[2])
    size = max(1e-300, math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]))
    return (e[0] / size, e[1] / size, e[2] / size), off / size


@kernel
def special(
    w: World, lobe: Array, chart: Array, charted: Array, phi: float, t: Array, seen: Array, ends: Array, more: Array
) -> int:
    """Fill ``more`` with places of a line that even steps may pass over: peaks and their flanks, nearest approaches,
    shadows that may touch between two looks. Returns how many; their second column marks ends of pieces."""
    count, high = 0, t[-1]
    room = more.shape[0] - 12
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    if chart[0] != 0.0:
        # the lobe and its cone, where they are narrow on the disc
        m = (lobe[MIRROR], lobe[MIRROR + 1], lobe[MIRROR + 2])
        angle = math.atan2(
            m[0] * (math.cos(phi) * chart[4] + math.sin(phi) * chart[7])
            + m[1] * (math.cos(phi) * chart[5] + math.sin(phi) * chart[8])
            + m[2] * (math.cos(phi) * chart[6] + math.sin(phi) * chart[9]),
            m[0] * chart[1] + m[1] * chart[2] + m[2] * chart[3],
        )
        width = min(lobe[THETA_MAX], 1.0 / math.sqrt(lobe[EXPONENT] + 1.0))
        for k in (-8.0, -3.0, -1.0, 0.0, 1.0, 3.0, 8.0):
            at = tilt_to_t(lobe, chart, angle + k * width)
            if 0.0 < at < high:
                more[count, 0], more[count, 1] = at, 1.0
                count += 1
    for i in range(w.spheres.shape[0]):
        s = w.spheres[i]
        if 1 + i == int(chart[0]) or 1 + i == int(lobe[SURFACE]) or s[3] == 0.0:
            continue
        at = along_chart(lobe, chart, phi, (s[0] - o[0], s[1] - o[1], s[2] - o[2]))
        if 0.0 < at < high and count < room:
            more[count, 0], more[count, 1] = at, 0.0
            count += 1
    points = w.points.shape[0]
    step = t[1] - t[0]
    for k in range(points):
        for i in range(-1, w.spheres.shape[0]):
            if w.points[k, 3] + w.points[k, 4] + w.points[k, 5] <= 0.0 or (i >= 0 and w.spheres[i, 3] == 0.0):
                continue
            c, width = foot(w, k, i, o)
            if width > _BESIDE or count + 9 >= room:
                continue
            along = math.cos(phi) * (chart[4] * c[0] + chart[5] * c[1] + chart[6] * c[2])
            along += math.sin(phi) * (chart[7] * c[0] + chart[8] * c[1] + chart[9] * c[2])
            angle = math.atan2(along, chart[1] * c[0] + chart[2] * c[1] + chart[3] * c[2])
            for f in (-12.0, -4.0, -1.5, -0.5, 0.0, 0.5, 1.5, 4.0, 12.0):
                at = tilt_to_t(lobe, chart, angle + f * width)
                if 0.0 < at < high:
                    more[count, 0], more[count, 1] = at, 1.0
                    count += 1
    if w.rules[SHININESS] >= _SHARP and w.rules[2] > 0.0:
        for k in range(points):
            if w.points[k, 3] + w.points[k, 4] + w.points[k, 5] <= 0.0:
                continue
            for i in range(t.shape[0]):
                left = seen[i - 1, k] if i > 0 else -3.0
                right = seen[i + 1, k] if i + 1 < t.shape[0] else -3.0
                here = seen[i, k]
                if here < 0.3 or here < left or here <= right or count >= room:
                    continue
                low, top_t = max(0.0, t[i] - step), min(high, t[i] + step)
                at = top(w, lobe, chart, charted, low, top_t, phi, k)
                h = 0.05 * step
                width = bent(
                    base_at(w, lobe, chart, charted, at - h if at > h else at, phi, k),
                    base_at(w, lobe, chart, charted, at, phi, k),
                    base_at(w, lobe, chart, charted, min(high, at + h), phi, k),
                    h,
                    w.rules[SHININESS],
                )
                if width <= 0.0 or at <= h or at >= high - h:
                    width = step / w.rules[SHININESS]
                if width > _BROAD * step:
                    continue
                for f in (-12.0, -4.0, -1.5, 0.0, 1.5, 4.0, 12.0):
                    if 0.0 < at + f * width < high and count < room:
                        more[count, 0], more[count, 1] = at + f * width, 1.0
                        count += 1
    places, met = np.empty((t.shape[0], 3)), np.empty(t.shape[0], np.bool_)
    for a in range(t.shape[0]):
        met[a], q = place_of(w, lobe, chart, t[a], phi)
        places[a, 0], places[a, 1], places[a, 2] = q
    for k in range(points):
        light = (w.points[k, 0], w.points[k, 1], w.points[k, 2])
        for i in range(w.spheres.shape[0]):
            if 1 + i == int(chart[0]) or w.spheres[i, 3] == 0.0 or count >= room:
                continue
            for a in range(t.shape[0]):
                q = (places[a, 0], places[a, 1], places[a, 2])
                ends[a] = gap(w.spheres, i, q, light) if met[a] else 1e9
            count = slivers(w, lobe, chart, i, light, phi, t, ends, more, count, room)
    return count


@kernel
def slivers(
    w: World, lobe: Array, chart: Array, i: int, light: Vector, phi: float, t: Array, gaps: Array, more: Array,
    count: int, room: int,
) -> int:  # fmt: skip
    """Add to ``more`` the places at which the shadow of sphere i comes nearest between looks."""
    g = 0.6180339887498949
    for a in range(1, t.shape[0] - 1):
        here = gaps[a]
        if here <= 0.0 or here > gaps[a - 1] or here >= gaps[a + 1] or gaps[a - 1] > 1e8 or gaps[a + 1] > 1e8:
            continue
        if here > 3.0 * max(gaps[a - 1] - here, gaps[a + 1] - here) or count >= room:
            # the nearest approach lies far above 0
            continue
        low, high = t[a - 1], t[a + 1]
        best = t[a]
        for _ in range(20):
            p, r = high - g * (high - low), low + g * (high - low)
            f_p = gap(w.spheres, i, place_of(w, lobe, chart, p, phi)[1], light)
            f_r = gap(w.spheres, i, place_of(w, lobe, chart, r, phi)[1], light)
            if f_p < f_r:
                high, best = r, p
            else:
                low, best = p, r
            if f_p < 0.0 or f_r < 0.0:
                break
        more[count, 0], more[count, 1] = best, 0.0
        count += 1
    return count


@kernel
def line(
    w: World, lobe: Array, chart: Array, charted: Array, phi: float, cells: int, tol: float, ease: float,
    on_disk: Array, out: Array,
) -> tuple[float, int]:  # fmt: skip
    """Integral over t at one phi, into ``out``; returns its error and how many looks it took.

    With ``ease`` seven nodes of a piece are enough where their error is below that share of what is allowed, and
    places of jumps are found as closely as the tolerance needs.
    """
    high = 1.0 if chart[0] == 0.0 else 0.5 * math.pi
    lights = w.points.shape[0] + w.disks.shape[0]
    t, seen = np.empty(cells + 1), np.full((cells + 1, lights), -3.0)
    gaps, more = np.empty(cells + 1), np.empty((400, 2))
    bases, rgb = np.empty(lights), np.zeros(3)
    looks = cells + 1
    for i in range(cells + 1):
        t[i] = high * i / cells
    # the very ends stand on walls
    t[0], t[cells] = 1e-9 * high, high * (1.0 - 1e-12)
    even = np.empty(cells + 1, np.int64)
    for i in range(cells + 1):
        even[i] = look(w, lobe, chart, charted, t[i], phi, on_disk, seen[i], rgb, False)
    count = special(w, lobe, chart, charted, phi, t, seen, gaps, more)
    at, ends = np.empty(cells + 1 + count), np.zeros(cells + 1 + count)
    at[: cells + 1] = t
    at[cells + 1 :], ends[cells + 1 :] = more[:count, 0], more[:count, 1]
    order = np.argsort(at)
    at, ends = at[order], ends[order]
    labels = np.empty(at.shape[0], np.int64)
    for i in range(at.shape[0]):
        if order[i] <= cells:
            labels[i] = even[order[i]]
        else:
            labels[i] = look(w, lobe, chart, charted, at[i], phi, on_disk, bases, rgb, False)
    looks += count
    cut = _CUT
    if ease > 0.0:
        # what a jump displaced by so much is worth, by the largest weight of the chart
        most = 1.0
        if chart[0] != 0.0:
            most = max(1.0, (lobe[EXPONENT] + 2.0) / (2.0 * math.pi * lobe[MASS]) * chart[SINE] * chart[SINE])
        cut = min(1e-7, max(_CUT, 1e-3 * tol / most))
    stack_t, stack_l = np.empty((128, 2)), np.empty((128, 2), np.int64)
    cuts, cut_labels = np.empty(_MOST), np.empty(_MOST, np.int64)
    cuts[0], cut_labels[0], pieces = 0.0, labels[0], 1
    for i in range(at.shape[0] - 1):
        if ends[i] > 0.0 and pieces < _MOST - 1 and at[i] > cuts[pieces - 1]:
            cuts[pieces], cut_labels[pieces] = at[i], labels[i]
            pieces += 1
        if labels[i] == labels[i + 1]:
            continue
        stack_t[0, 0], stack_t[0, 1], stack_l[0, 0], stack_l[0, 1], depth = (
            at[i],
            at[i + 1],
            labels[i],
            labels[i + 1],
            1,
        )
        while depth > 0 and pieces < _MOST - 1:
            depth -= 1
            a, b, l_a, l_b = stack_t[depth, 0], stack_t[depth, 1], stack_l[depth, 0], stack_l[depth, 1]
            if l_a == l_b:
                continue
            m = 0.5 * (a + b)
            if b - a <= cut * high or m <= a or m >= b:
                cuts[pieces], cut_labels[pieces] = m, l_b
                pieces += 1
                continue
            l_m = look(w, lobe, chart, charted, m, phi, on_disk, bases, rgb, False)
            looks += 1
            stack_t[depth, 0], stack_t[depth, 1], stack_l[depth, 0], stack_l[depth, 1] = m, b, l_m, l_b
            stack_t[depth + 1, 0], stack_t[depth + 1, 1] = a, m
            stack_l[depth + 1, 0], stack_l[depth + 1, 1] = l_a, l_m
            depth += 2
    if pieces >= _MOST - 1:
        out[:] = 0.0
        return math.inf, looks
    error = 0.0
    cuts[pieces] = high
    out[:] = 0.0
    values, part = np.empty((15, 3)), np.empty(3)
    for i in range(pieces):
        if cut_labels[i] % 2 == 0:
            continue
        stack_t[0, 0], stack_t[0, 1], stack_l[0, 0], depth = cuts[i], cuts[i + 1], 0, 1
        while depth > 0:
            depth -= 1
            a, b, level = stack_t[depth, 0], stack_t[depth, 1], stack_l[depth, 0]
            enough = tol * max((b - a) / high, 0.02)
            for first in (1, 0):
                for k in range(first, 15, 2):
                    rgb[:] = 0.0
                    x = 0.5 * (a + b) + 0.5 * (b - a) * TICKS[k]
                    look(w, lobe, chart, charted, x, phi, on_disk, bases, rgb, True)
                    values[k] = rgb
                    looks += 1
                miss = gauss(values, b - a, part) if first == 1 else embedded(values, b - a, part)
                if miss <= ease * enough:
                    break
            if miss <= enough or level >= _DEEP:
                for c in range(3):
                    out[c] += part[c]
                error += miss
                continue
            m = 0.5 * (a + b)
            stack_t[depth, 0], stack_t[depth, 1], stack_l[depth, 0] = a, m, level + 1
            stack_t[depth + 1, 0], stack_t[depth + 1, 1], stack_l[depth + 1, 0] = m, b, level + 1
            depth += 2
    return error, looks


@kernel
def axis_turn(chart: Array, c: Vector) -> float:
    """The phi of the line through the direction c."""
    return math.atan2(
        chart[7] * c[0] + chart[8] * c[1] + chart[9] * c[2], chart[4] * c[0] + chart[5] * c[1] + chart[6] * c[2]
    )


@kernel
def separation(chart: Array, c: Vector) -> float:
    """Angle between the chart's axis and the unit direction c."""
    x = (chart[2] * c[2] - chart[3] * c[1], chart[3] * c[0] - chart[1] * c[2], chart[1] * c[1] - chart[2] * c[0])
    return math.atan2(
        math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), chart[1] * c[0] + chart[2] * c[1] + chart[3] * c[2]
    )


__all__ = ["axis_turn", "direction", "embedded", "line", "separation", "top"]
