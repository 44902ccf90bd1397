"""The curves that cut a disk light as seen from a point: conics and lines in the disk's plane.

A point of the disk is L + rho (a e1 + b e2). The cone from Q about a ball cuts the plane in a conic, the terminator
N.(x - Q) = 0 and the floor in lines: all are quadratics in (a, b), and all that hide are negative where they hide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import (
    CLEAR,
    COVERS,
    DISK_AXIS,
    DISK_E1,
    DISK_E2,
    DISK_RADIUS,
    TOUCHES,
    cover,
)
from symrender.chambers.walls import SHAPE_INDEX, SIDE
from symrender.chambers.work import CASTERS, View, Work
from symrender.kernel_cache import jitable
from symrender.scene.arrays import FLOOR_PRESENT

Array = npt.NDArray[np.float64]

# columns: k0 + k1 a + k2 b + k11 a^2 + 2 k12 a b + k22 b^2, what the curve bounds, the index of its ball, the points
# of a cone's conic as of ``add_generators``
BOUNDS: Final = 6
ALONG: Final = 8
CONE: Final = 0.0
"""The cone about a ball between Q and the disk."""
TERMINATOR: Final = 1.0
LINE: Final = 2.0
"""The floor."""
BALL: Final = 3.0
"""The cone about a ball that touches the disk: every point is asked of the ball itself. From here on, chords only."""
EDGE: Final = 4.0
"""A circle in which a touching ball cuts the disk's plane."""
OWN: Final = 5.0
"""The circle in which the ball that Q lies on cuts the disk's plane."""

# rows of ``work.disk``: scratch for corners or events and for breaks, then the curves
EVENTS: Final = 0
BREAKS: Final = 1
CURVES: Final = 2
TURNS: Final = 16


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
def trig_roots(
    k0: float, k1: float, k2: float, k11: float, k12: float, k22: float, out: Array, count: int
) -> int:  # fmt: skip
    """Insert the t in [0, 2 pi) with k0 + k1 c + k2 s + k11 c^2 + 2 k12 c s + k22 s^2 = 0, c = cos t, s = sin t.

    Sign changes between samples, and turning points between samples that lie beyond zero; new count of ``out``.
    """
    h1, h2, h3 = 0.9238795325112867, 0.7071067811865476, 0.3826834323650898
    table = (1.0, h1, h2, h3, 0.0, -h3, -h2, -h1, -1.0, -h1, -h2, -h3, 0.0, h3, h2, h1)
    step = 2.0 * math.pi / TURNS
    t0 = t1 = f0 = f1 = f = middle = 0.0
    for k in range(TURNS + 2):
        t2 = k * step
        c, s = table[k % TURNS], table[(k + 12) % TURNS]
        f2 = k0 + k1 * c + k2 * s + k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
        pieces = 0
        if 0 < k <= TURNS and f1 * f2 < 0.0:
            pieces = 1
        elif k > 1 and f0 * f1 > 0.0 and f1 * f2 > 0.0 and abs(f1) < abs(f0) and abs(f1) <= abs(f2):
            middle = t1 + 0.5 * step * (f0 - f2) / (f0 - 2.0 * f1 + f2)
            for _ in range(4):
                c, s = math.cos(middle), math.sin(middle)
                slope = -k1 * s + k2 * c + (k22 - k11) * 2.0 * c * s + 2.0 * k12 * (c * c - s * s)
                curvature = -k1 * c - k2 * s + 2.0 * (k22 - k11) * (c * c - s * s) - 8.0 * k12 * c * s
                if curvature == 0.0:
                    break
                move = slope / curvature
                middle = max(t0, min(t2, middle - move))
                if abs(move) < 1e-9:
                    break
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
                if g == 0.0 or move < 1e-13:
                    break
            count = insert(out, count, b % (2.0 * math.pi))
        t0, f0, t1, f1 = t1, f1, t2, f2
    return count


@jitable
def add_generators(
    row: Array, p: Array, qx: float, qy: float, qz: float, ox: float, oy: float, oz: float, radius: float
) -> None:  # fmt: skip
    """Write the cone about the ball at offset o from Q as points of the disk's plane: columns ``ALONG`` and on.

    (a, b) = (X/Z, Y/Z) with X, Y, Z linear in (1, cos t, sin t), t the angle of a generator about the cone's axis.
    """
    far = math.sqrt(ox * ox + oy * oy + oz * oz)
    cx, cy, cz = ox / far, oy / far, oz / far
    if abs(cx) < 0.6:
        h = math.sqrt(cy * cy + cz * cz)
        fx, fy, fz = 0.0, cz / h, -cy / h
    else:
        h = math.sqrt(cx * cx + cz * cz)
        fx, fy, fz = -cz / h, 0.0, cx / h
    gx, gy, gz = cy * fz - cz * fy, cz * fx - cx * fz, cx * fy - cy * fx
    sine = radius / far
    cosine = math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine)))
    rho = p[DISK_RADIUS]
    yx, yy, yz = p[0] - qx, p[1] - qy, p[2] - qz
    height = yx * p[DISK_AXIS] + yy * p[DISK_AXIS + 1] + yz * p[DISK_AXIS + 2]
    y1 = yx * p[DISK_E1] + yy * p[DISK_E1 + 1] + yz * p[DISK_E1 + 2]
    y2 = yx * p[DISK_E2] + yy * p[DISK_E2 + 1] + yz * p[DISK_E2 + 2]
    side = 1.0 if height >= 0.0 else -1.0
    for k in range(3):
        if k == 0:
            x, y, z = cosine * cx, cosine * cy, cosine * cz
        elif k == 1:
            x, y, z = sine * fx, sine * fy, sine * fz
        else:
            x, y, z = sine * gx, sine * gy, sine * gz
        along = x * p[DISK_AXIS] + y * p[DISK_AXIS + 1] + z * p[DISK_AXIS + 2]
        w1 = x * p[DISK_E1] + y * p[DISK_E1 + 1] + z * p[DISK_E1 + 2]
        w2 = x * p[DISK_E2] + y * p[DISK_E2 + 1] + z * p[DISK_E2 + 2]
        row[ALONG + k] = side * (height * w1 - y1 * along) / rho
        row[ALONG + 3 + k] = side * (height * w2 - y2 * along) / rho
        row[ALONG + 6 + k] = side * along


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
        add_generators(row, p, qx, qy, qz, ox, oy, oz, ball[3])
        n += 1
        if how == TOUCHES:
            n = add_circle_curve(curves, n, p, ball, EDGE)
    if j >= 0:
        own = view.spheres[j]
        reach = own[3] + rho
        if (p[0] - own[0]) ** 2 + (p[1] - own[1]) ** 2 + (p[2] - own[2]) ** 2 < reach * reach and n < curves.shape[0]:
            n = add_circle_curve(curves, n, p, own, OWN)
    if view.floor[FLOOR_PRESENT] != 0.0 and abs(p[2]) < rho * math.hypot(e1z, e2z) and n < curves.shape[0]:
        up = 1.0 if (qz if j >= 0 else work.geo[SIDE]) >= 0.0 else -1.0
        row = curves[n]
        row[0], row[1], row[2], row[BOUNDS] = up * p[2], up * rho * e1z, up * rho * e2z, LINE
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
def curve_level(row: Array, a: float, b: float) -> float:
    """Level of a curve at (a, b): negative where the curve's ball, or the far side of its line, hides the disk."""
    return float(row[0] + row[1] * a + row[2] * b + row[3] * a * a + 2.0 * row[4] * a * b + row[5] * b * b)
