"""Where conics on the floor run along a wave's crests, where two of them meet, and the lines that they tend to."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.roots import quadratic_roots, quartic_roots
from symrender.chambers.work import Work
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.records import Conic

Array = npt.NDArray[np.float64]


@inlined
def point_of_wave(row: Conic, p: float, q: float) -> tuple[int, float, float, float, float]:
    """Where the conic's normal is along (p, q): up to two places (count, x, y, x, y) from the foot."""
    a, b, c = q * row.xx - p * row.xy, q * row.xy - p * row.yy, q * row.x - p * row.y
    square = a * a + b * b
    if square == 0.0:
        return 0, 0.0, 0.0, 0.0, 0.0
    # the points of this line, base + t along, at which the conic's level is 0
    bx, by = -a * c / square, -b * c / square
    inv = 1.0 / math.sqrt(square)
    ux, uy = -b * inv, a * inv
    n, s, t = quadratic_roots(
        row.xx * ux * ux + 2.0 * row.xy * ux * uy + row.yy * uy * uy,
        (row.xx * bx + row.xy * by + row.x) * ux + (row.xy * bx + row.yy * by + row.y) * uy,
        row.xx * bx * bx + 2.0 * row.xy * bx * by + row.yy * by * by + 2.0 * (row.x * bx + row.y * by) + row.free,
    )
    return n, bx + s * ux, by + s * uy, bx + t * ux, by + t * uy


@inlined
def meetings(one: Conic, other: Conic, far: float, work: Work, places: Array) -> int:
    """Places (x, y) within ``far`` of the foot where two conics meet, as rows of ``places`` (8, 2); their number.

    The resultant of the two as quadratics in x is a quartic in y.
    """
    p, r = work.bernstein, work.quartic
    # a x^2 + 2 (b0 + b1 y) x + c0 + c1 y + c2 y^2, y = far s
    a, b0, b1 = one.xx, one.x, one.xy * far
    c0, c1, c2 = one.free, 2.0 * one.y * far, one.yy * far * far
    d, e0, e1 = other.xx, other.x, other.xy * far
    f0, f1, f2 = other.free, 2.0 * other.y * far, other.yy * far * far
    u0, u1, u2 = a * f0 - d * c0, a * f1 - d * c1, a * f2 - d * c2
    v0, v1 = a * e0 - d * b0, a * e1 - d * b1
    w0, w1 = b0 * f0 - e0 * c0, b0 * f1 + b1 * f0 - e0 * c1 - e1 * c0
    w2, w3 = b0 * f2 + b1 * f1 - e0 * c2 - e1 * c1, b1 * f2 - e1 * c2
    m0 = u0 * u0 - 4.0 * v0 * w0
    m1 = 2.0 * u0 * u1 - 4.0 * (v0 * w1 + v1 * w0)
    m2 = u1 * u1 + 2.0 * u0 * u2 - 4.0 * (v0 * w2 + v1 * w1)
    m3 = 2.0 * u1 * u2 - 4.0 * (v0 * w3 + v1 * w2)
    m4 = u2 * u2 - 4.0 * v1 * w3
    if a == 0.0 and d == 0.0:
        # neither has a square of x: both are of first degree in it
        m0, m1, m2, m3, m4 = w0, w1, w2, w3, 0.0
    # s = 2 t - 1, then Bernstein's coefficients on [0, 1]
    q0 = m0 - m1 + m2 - m3 + m4
    q1 = 2.0 * (m1 - 2.0 * m2 + 3.0 * m3 - 4.0 * m4)
    q2 = 4.0 * (m2 - 3.0 * m3 + 6.0 * m4)
    q3 = 8.0 * (m3 - 4.0 * m4)
    q4 = 16.0 * m4
    p[0] = q0
    p[1] = q0 + q1 / 4.0
    p[2] = q0 + q1 / 2.0 + q2 / 6.0
    p[3] = q0 + 0.75 * q1 + 0.5 * q2 + 0.25 * q3
    p[4] = q0 + q1 + q2 + q3 + q4
    count = 0
    for k in range(min(4, quartic_roots(p, work.stack, r))):
        s = 2.0 * r[k] - 1.0
        v, u = v0 + v1 * s, u0 + (u1 + u2 * s) * s
        n, x1, x2 = 1, 0.0, 0.0
        if a == 0.0 and d == 0.0:
            n, x1, x2 = quadratic_roots(a, b0 + b1 * s, c0 + (c1 + c2 * s) * s)
        elif v != 0.0:
            x1 = -0.5 * u / v
        else:
            # both have the same sum of roots here, as two that are mirror images in a column have
            n, x1, x2 = quadratic_roots(a, b0 + b1 * s, c0 + (c1 + c2 * s) * s)
        for i in range(n):
            x = x1 if i == 0 else x2
            if abs(x) <= far and count < places.shape[0]:
                places[count, 0], places[count, 1] = x, far * s
                count += 1
    return count


@jitable
def wall_direction(row: Conic, x: float, y: float) -> tuple[float, float]:
    """Unit vector along the conic at a place on it; (1, 0) at a singular one."""
    gx, gy = row.xx * x + row.xy * y + row.x, row.xy * x + row.yy * y + row.y
    steep = math.sqrt(gx * gx + gy * gy)
    if steep == 0.0:
        return 1.0, 0.0
    return -gy / steep, gx / steep


@inlined
def straight_parts(row: Conic) -> tuple[int, float, float, float, float, float, float]:
    """(count, x, y of its middle, directions of the one and the other straight line that a conic tends to far out)."""
    if row.xx == 0.0 and row.xy == 0.0 and row.yy == 0.0:
        square = row.x * row.x + row.y * row.y
        if square == 0.0:
            return 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        inv, at = 1.0 / math.sqrt(square), -0.5 * row.free / square
        return 1, at * row.x, at * row.y, -row.y * inv, row.x * inv, 0.0, 0.0
    determinant = row.xx * row.yy - row.xy * row.xy
    if not determinant < 0.0:
        return 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x = (row.xy * row.y - row.yy * row.x) / determinant
    y = (row.xy * row.x - row.xx * row.y) / determinant
    root = math.sqrt(-determinant)
    ax, ay, bx, by = -row.xy + root, row.xx, -row.xy - root, row.xx
    if abs(row.yy) > abs(row.xx):
        ax, ay, bx, by = row.yy, -row.xy + root, row.yy, -row.xy - root
    one, other = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    return 2, x, y, ax / one, ay / one, bx / other, by / other
