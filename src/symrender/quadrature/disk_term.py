"""What a disk light adds to a lit point: means over the disk of the Lambert cosine and of the highlight.

(1/(pi rho^2)) int_disk V(x) (max(0, N.l), s) dA, l = unit(x - Q). Where nothing cuts the disk the integrand is
analytic in x and a rule of low degree will do. Otherwise the disk is cut: the edge of what a ball hides is a conic in
the disk's plane, the terminator N.(x - Q) = 0 and the floor are lines, and along a chord each is met at the roots of a
quadratic. Chords run along the gradient of the first curve; between the chords through the corners (curve and
circle) and the chords that touch a curve the integral over a chord is analytic after the map b0 + (b1 - b0)
sin^2(pi u/2). Corners of two curves inside the disk are not looked for: one more kink across chords, which
successive orders of the rule tell.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import PARTLY
from symrender.chambers.penumbra import (
    CLEAR,
    COVERS,
    DISK_E1,
    DISK_E2,
    DISK_RADIUS,
    TOUCHES,
    cover,
    segment_distance2,
)
from symrender.chambers.roots import quadratic_roots
from symrender.chambers.walls import SHAPE_INDEX, SIDE
from symrender.chambers.work import CASTERS, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.gauss import DISK_STARTS, MAX_ORDER, disk_level, order
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import FLOOR_PRESENT, OPEN, PHONG

Array = npt.NDArray[np.float64]

# a curve in the disk's plane: k0 + k1 a + k2 b + k11 a^2 + 2 k12 a b + k22 b^2, in units of rho; then what it bounds
BOUNDS: Final = 6
CONE: Final = 0.0
"""Hidden where negative."""
BALL: Final = 1.0
"""The ball of index ``BOUNDS + 1`` touches the disk: every point is asked of the ball itself."""
TERMINATOR: Final = 2.0
"""Above the horizon of Q where positive."""
EDGE: Final = 3.0
"""A circle in which a touching ball cuts the disk's plane; it only cuts chords."""

EVENTS: Final = 0
BREAKS: Final = 1
LOGS: Final = 2
"""Row of ``work.disk`` that holds ``disk_logs`` of every light, then the curves."""
CURVES: Final = 3
CHORD_LOG: Final = 1.7
"""log rho that decides the number of chords of a piece."""
TURNS: Final = 16


@jitable
def disk_logs(distance: float, radius: float, phong: bool, shininess: float) -> float:
    """log rho of the Bernstein ellipse on a chord of a disk at least ``distance`` away: N.l, and the highlight.

    The highlight (N.h)^p grows like exp(p y^2/8) at y radians off the real directions, that of Phong like
    exp(p y^2/2); y is where that reaches e^1.5.
    """
    x = max(1.02, distance / radius)
    best = math.log(x + math.sqrt(x * x - 1.0))
    y = distance / radius * min(1.0, (1.7 if phong else 3.4) / math.sqrt(shininess + 1e-9))
    return max(0.05, min(best, math.log(y + math.sqrt(1.0 + y * y))))


@jitable
def note_logs(view: View, work: Work) -> None:
    """Fill the row ``LOGS`` of ``work.disk`` for the charted shape."""
    j = int(work.geo[SHAPE_INDEX])
    for i in range(view.points.shape[0]):
        p = view.points[i]
        if p[DISK_RADIUS] > 0.0:
            distance = abs(p[2])
            if j >= 0:
                s = view.spheres[j]
                distance = math.sqrt((p[0] - s[0]) ** 2 + (p[1] - s[1]) ** 2 + (p[2] - s[2]) ** 2) - s[3]
            work.disk[LOGS, i] = disk_logs(distance, p[DISK_RADIUS], view.shading[4] == PHONG, view.shading[3])


@jitable
def place_events(curve: Array, events: Array, count: int) -> int:
    """Insert b of the corners of a curve with the circle and of the chords that touch it; new count of ``events``."""
    k0, k1, k2, k11, k12, k22 = curve[0], curve[1], curve[2], curve[3], curve[4], curve[5]
    # corners: sign changes of a trigonometric polynomial of degree two, and its turns between samples
    step = 2.0 * math.pi / TURNS
    t0 = t1 = f0 = f1 = f = 0.0
    for k in range(TURNS + 2):
        t2 = k * step
        c, s = math.cos(t2), math.sin(t2)
        f2 = k0 + k1 * c + k2 * s + k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
        pieces = 0
        middle = 0.0
        if k > 0 and k <= TURNS and f1 * f2 < 0.0:
            pieces = 1
        elif k > 1 and f0 * f1 > 0.0 and f1 * f2 > 0.0 and abs(f1) < abs(f0) and abs(f1) <= abs(f2):
            bend = f0 - 2.0 * f1 + f2
            middle = t1 + 0.5 * step * (f0 - f2) / bend
            for _ in range(4):
                c, s = math.cos(middle), math.sin(middle)
                slope = -k1 * s + k2 * c + (k22 - k11) * 2.0 * c * s + 2.0 * k12 * (c * c - s * s)
                curvature = -k1 * c - k2 * s + 2.0 * (k22 - k11) * (c * c - s * s) - 8.0 * k12 * c * s
                if curvature == 0.0:
                    break
                middle = max(t0, min(t2, middle - slope / curvature))
            c, s = math.cos(middle), math.sin(middle)
            f = k0 + k1 * c + k2 * s + k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
            if f * f1 < 0.0:
                pieces = 2
        for i in range(pieces):
            if pieces == 1:
                a, b, fa, fb = t1, t2, f1, f2
            elif i == 0:
                a, b, fa, fb = t0, middle, f0, f
            else:
                a, b, fa, fb = middle, t2, f, f2
            for _ in range(50):
                t = (a * fb - b * fa) / (fb - fa)
                c, s = math.cos(t), math.sin(t)
                g = k0 + k1 * c + k2 * s + k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
                move = abs(t - b)
                if g * fb < 0.0:
                    a, fa = b, fb
                else:
                    fa *= 0.5
                b, fb = t, g
                if g == 0.0 or move < 1e-14:
                    break
            count = insert(events, count, math.sin(b))
        t0, f0, t1, f1 = t1, f1, t2, f2
    if k11 != 0.0:
        found, b1, b2 = quadratic_roots(k12 * k12 - k11 * k22, 0.5 * (k1 * k12 - k11 * k2), 0.25 * k1 * k1 - k11 * k0)
        for i in range(found):
            b = b1 if i == 0 else b2
            if abs(b) < 1.0:
                a = -(k12 * b + 0.5 * k1) / k11
                if a * a + b * b < 1.0:
                    count = insert(events, count, b)
    return count


@jitable
def insert(values: Array, count: int, value: float) -> int:
    """Insert in ascending order, if there is room; new count."""
    if count >= values.shape[0]:
        return count
    k = count
    while k > 0 and values[k - 1] > value:
        values[k] = values[k - 1]
        k -= 1
    values[k] = value
    return count + 1


@jitable
def disk_curves(
    i: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, view: View, work: Work
) -> int:  # fmt: skip
    """List the curves that cut disk ``i`` as seen from Q in ``work.disk``; their number, -1 where all is hidden.

    A point above the terminator has a positive level of the ``TERMINATOR`` curve, which is present only where it cuts.
    """
    p = view.points[i]
    rho = p[DISK_RADIUS]
    j = int(work.geo[SHAPE_INDEX])
    curves = work.disk[CURVES:]
    n = 0
    yx, yy, yz = p[0] - qx, p[1] - qy, p[2] - qz
    e1x, e1y, e1z = p[DISK_E1], p[DISK_E1 + 1], p[DISK_E1 + 2]
    e2x, e2y, e2z = p[DISK_E2], p[DISK_E2 + 1], p[DISK_E2 + 2]
    y1, y2 = yx * e1x + yy * e1y + yz * e1z, yx * e2x + yy * e2y + yz * e2z
    far2 = yx * yx + yy * yy + yz * yz
    for c in range(work.counts[CASTERS]):
        if work.casters[c, 0] != i or n + 2 > curves.shape[0]:
            continue
        ball = view.spheres[work.casters[c, 1]]
        how = cover(qx, qy, qz, p, ball[0], ball[1], ball[2], ball[3])
        if how == COVERS:
            return -1
        if how == CLEAR:
            continue
        ox, oy, oz = ball[0] - qx, ball[1] - qy, ball[2] - qz
        c2 = ox * ox + oy * oy + oz * oz
        power, m = (c2 - ball[3] * ball[3]) / (c2 * far2), (yx * ox + yy * oy + yz * oz) / (c2 * far2)
        scale = 1.0 / (c2 * far2)
        c1, d1 = ox * e1x + oy * e1y + oz * e1z, ox * e2x + oy * e2y + oz * e2z
        row = curves[n]
        row[0] = power * far2 - m * m / scale
        row[1] = 2.0 * rho * (power * y1 - m * c1)
        row[2] = 2.0 * rho * (power * y2 - m * d1)
        row[3] = rho * rho * (power - scale * c1 * c1)
        row[4] = -rho * rho * scale * c1 * d1
        row[5] = rho * rho * (power - scale * d1 * d1)
        row[BOUNDS] = BALL if how == TOUCHES else CONE
        row[BOUNDS + 1] = work.casters[c, 1]
        n += 1
        if how == TOUCHES:
            n = add_circle_curve(curves, n, p, ball, EDGE)
    if j >= 0:
        own = view.spheres[j]
        reach = own[3] + rho
        if (p[0] - own[0]) ** 2 + (p[1] - own[1]) ** 2 + (p[2] - own[2]) ** 2 < reach * reach and n < curves.shape[0]:
            n = add_circle_curve(curves, n, p, own, CONE)
    if view.floor[FLOOR_PRESENT] != 0.0 and abs(p[2]) < rho * math.hypot(e1z, e2z) and n < curves.shape[0]:
        up = 1.0 if (qz if j >= 0 else work.geo[SIDE]) >= 0.0 else -1.0
        row = curves[n]
        row[0], row[1], row[2], row[BOUNDS] = up * p[2], up * rho * e1z, up * rho * e2z, CONE
        row[3] = row[4] = row[5] = 0.0
        n += 1
    n1, n2 = nx * e1x + ny * e1y + nz * e1z, nx * e2x + ny * e2y + nz * e2z
    lift = yx * nx + yy * ny + yz * nz
    if abs(lift) < rho * math.hypot(n1, n2) and n < curves.shape[0]:
        row = curves[n]
        row[0], row[1], row[2], row[BOUNDS] = lift, rho * n1, rho * n2, TERMINATOR
        row[3] = row[4] = row[5] = 0.0
        n += 1
    return n


@jitable
def add_circle_curve(curves: Array, n: int, p: Array, ball: Array, bounds: float) -> int:
    """Append |x - C|^2 - R^2 on the disk's plane; new count."""
    rho = p[DISK_RADIUS]
    x, y, z = p[0] - ball[0], p[1] - ball[1], p[2] - ball[2]
    row = curves[n]
    row[0] = x * x + y * y + z * z - ball[3] * ball[3]
    row[1] = 2.0 * rho * (x * p[DISK_E1] + y * p[DISK_E1 + 1] + z * p[DISK_E1 + 2])
    row[2] = 2.0 * rho * (x * p[DISK_E2] + y * p[DISK_E2 + 1] + z * p[DISK_E2 + 2])
    row[3], row[4], row[5], row[BOUNDS] = rho * rho, 0.0, rho * rho, bounds
    return n + 1


@jitable
def turn_curves(curves: Array, n: int) -> tuple[float, float]:
    """Rotate all curves so that a runs along the first one's gradient at the centre; (cos, sin) of the rotation."""
    size = math.hypot(curves[0, 1], curves[0, 2])
    if size == 0.0:
        return 1.0, 0.0
    c, s = curves[0, 1] / size, curves[0, 2] / size
    for k in range(n):
        row = curves[k]
        k1, k2, k11, k12, k22 = row[1], row[2], row[3], row[4], row[5]
        row[1], row[2] = k1 * c + k2 * s, k2 * c - k1 * s
        row[3] = k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
        row[4] = (k22 - k11) * c * s + k12 * (c * c - s * s)
        row[5] = k11 * s * s - 2.0 * k12 * c * s + k22 * c * c
    return c, s


@jitable
def chord_breaks(b: float, half: float, n: int, work: Work) -> int:
    """Cut the chord at height b, -half <= a <= half, at every curve; number of ascending breaks in ``work.disk``."""
    breaks = work.disk[BREAKS]
    breaks[0] = -half
    count = 1
    for k in range(n):
        row = work.disk[CURVES + k]
        found, a1, a2 = quadratic_roots(row[3], row[4] * b + 0.5 * row[1], row[0] + b * (row[2] + b * row[5]))
        for r in range(found):
            a = a1 if r == 0 else a2
            if abs(a) < half:
                count = insert(breaks[: breaks.shape[0] - 1], count, a)
    breaks[count] = half
    return count + 1


@jitable
def shown(
    a: float, b: float, qx: float, qy: float, qz: float, x: float, y: float, z: float, n: int, view: View, work: Work
) -> tuple[bool, bool]:
    """Whether the point (a, b) of the disk, at offset (x, y, z) from Q, is unhidden, and whether it is above Q."""
    above = True
    for k in range(n):
        row = work.disk[CURVES + k]
        bounds = row[BOUNDS]
        if bounds == EDGE:
            continue
        if bounds == BALL:
            ball = view.spheres[int(row[BOUNDS + 1])]
            if segment_distance2(qx, qy, qz, x, y, z, ball[0], ball[1], ball[2]) < ball[3] * ball[3]:
                return False, above
            continue
        level = row[0] + row[1] * a + row[2] * b + row[3] * a * a + 2.0 * row[4] * a * b + row[5] * b * b
        if bounds == CONE:
            if level < 0.0:
                return False, above
        else:
            above = level > 0.0
    return True, above


@jitable
def clear_term(
    p: Array, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    phong: bool, shininess: float, rule: int, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the whole disk, whose centre is at offset y from Q."""
    rho = p[DISK_RADIUS]
    cosine, gleam = 0.0, 0.0
    for k in range(DISK_STARTS[rule], DISK_STARTS[rule + 1]):
        a, b, w = rho * gauss[0, k], rho * gauss[1, k], gauss[2, k]
        d, s = light_term(
            yx + a * p[DISK_E1] + b * p[DISK_E2], yy + a * p[DISK_E1 + 1] + b * p[DISK_E2 + 1],
            yz + a * p[DISK_E1 + 2] + b * p[DISK_E2 + 2], nx, ny, nz, vx, vy, vz, phong, shininess,
        )  # fmt: skip
        cosine += w * d
        gleam += w * s
    return cosine, gleam


@jitable
def disk_term(
    i: int, state: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, vx: float, vy: float,
    vz: float, step: int, log_rho: float, view: View, work: Work, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s) over disk ``i`` from Q, whose state is not ``DARK``.

    ``step`` chooses the orders; ``log_rho`` as of ``disk_logs``. In scene units: 1 is a light of the disk's colour at
    the zenith.
    """
    p = view.points[i]
    phong, shininess = view.shading[4] == PHONG, view.shading[3]
    rho = p[DISK_RADIUS]
    cosine, gleam = 0.0, 0.0
    yx, yy, yz = p[0] - qx, p[1] - qy, p[2] - qz
    e1x, e1y, e1z = rho * p[DISK_E1], rho * p[DISK_E1 + 1], rho * p[DISK_E1 + 2]
    e2x, e2y, e2z = rho * p[DISK_E2], rho * p[DISK_E2 + 1], rho * p[DISK_E2 + 2]
    n = 0 if state < PARTLY else disk_curves(i, qx, qy, qz, nx, ny, nz, view, work)
    if n < 0:
        return 0.0, 0.0
    opened = view.shading[6] == OPEN
    lifted = yx * nx + yy * ny + yz * nz > 0.0
    if n == 0:
        if not (lifted or opened):
            return 0.0, 0.0
        rule = disk_level(step, log_rho)
        cosine, gleam = clear_term(p, yx, yy, yz, nx, ny, nz, vx, vy, vz, phong, shininess, rule, gauss)
        return (cosine if lifted else 0.0), gleam
    lifted = lifted or work.disk[CURVES + n - 1, BOUNDS] == TERMINATOR
    c, s = turn_curves(work.disk[CURVES:], n)
    ax, ay, az = c * e1x + s * e2x, c * e1y + s * e2y, c * e1z + s * e2z
    bx, by, bz = c * e2x - s * e1x, c * e2y - s * e1y, c * e2z - s * e1z
    events = work.disk[EVENTS]
    events[0], events[1] = -1.0, 1.0
    count = 2
    for k in range(n):
        count = place_events(work.disk[CURVES + k], events, count)
    chords, nodes = min(MAX_ORDER, order(step, CHORD_LOG)), min(MAX_ORDER, order(step, log_rho))
    base, inner = chords * (chords - 1) // 2, nodes * (nodes - 1) // 2
    for e in range(count - 1):
        b0, b1 = events[e], events[e + 1]
        if b1 - b0 < 1e-13:
            continue
        for q in range(chords):
            u = 0.5 * math.pi * gauss[0, base + q]
            su, cu = math.sin(u), math.cos(u)
            b = b0 + (b1 - b0) * su * su
            slope = gauss[1, base + q] * (b1 - b0) * su * cu
            half = math.sqrt(max(0.0, (1.0 - b) * (1.0 + b)))
            pieces = chord_breaks(b, half, n, work) - 1
            for k in range(pieces):
                a0, a1 = work.disk[BREAKS, k], work.disk[BREAKS, k + 1]
                a = 0.5 * (a0 + a1)
                x, y, z = yx + a * ax + b * bx, yy + a * ay + b * by, yz + a * az + b * bz
                clear, above = shown(a, b, qx, qy, qz, x, y, z, n, view, work)
                above = above and lifted
                if not clear or not (above or opened):
                    continue
                for r in range(nodes):
                    a = a0 + (a1 - a0) * gauss[0, inner + r]
                    w = slope * (a1 - a0) * gauss[1, inner + r]
                    d, h = light_term(
                        yx + a * ax + b * bx, yy + a * ay + b * by, yz + a * az + b * bz, nx, ny, nz, vx, vy, vz, phong,
                        shininess,
                    )  # fmt: skip
                    if above:
                        cosine += w * d
                    gleam += w * h
    # dA = rho^2 da db, db = (b1 - b0) pi su cu du, and the mean divides by pi rho^2
    return cosine, gleam
