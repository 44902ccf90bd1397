"""Walls as curves of a cell: polynomials in x and y from -1 to 1, degree 4 at most, bounded by their coefficients."""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pixels.records import CONIC, LINE, REST, RIM, TERMS, Wall
from symrender.radiometric.vectors import Array, Vector, dot, vector

SLACK: Final = 1e-13
"""What a curve may lie beside where its coefficients, of which the largest is 1 in a pixel, say."""
BESIDE: Final = 1e-8
"""The same of one that is scaled to its cell: what lies on an edge of cells is listed on both sides of it."""


def _turn() -> Array:
    """(4, TERMS, TERMS): factors of t^i s^j from those of x^i y^j, x, y = t, s; s, t; t + s, t - s; s + t, s - t."""
    found = np.zeros((4, TERMS, TERMS))
    ways = ((1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 1.0, 0.0), (1.0, 1.0, 1.0, -1.0), (1.0, 1.0, -1.0, 1.0))
    for mode, (xt, xs, yt, ys) in enumerate(ways):
        for i in range(5):
            for j in range(5 - i):
                powers = np.ones(1)
                # rows are powers of t where the degree is i + j
                for a, b in [(xt, xs)] * i + [(yt, ys)] * j:
                    powers = np.convolve(powers, [b, a])
                for k, factor in enumerate(powers):
                    found[mode, 5 * k + i + j - k, 5 * i + j] += factor
    return found


TURN: Final = _turn()


@jitable
def times(a: Array, b: Array, out: Array) -> None:
    """The product of two curves, without what of it is of a degree above 4."""
    for k in range(TERMS):
        out[k] = 0.0
    for i in range(5):
        for j in range(5 - i):
            f = a[5 * i + j]
            if f != 0.0:
                for k in range(5 - i - j):
                    for m in range(5 - i - j - k):
                        out[5 * (i + k) + j + m] += f * b[5 * k + m]


@jitable
def put_linear(n: Vector, level: float, v: Vector, vx: Vector, vy: Vector, out: Array) -> None:
    """n.v + level of v + x vx + y vy."""
    for k in range(TERMS):
        out[k] = 0.0
    out[0], out[5], out[1] = dot(n, v) + level, dot(n, vx), dot(n, vy)


@jitable
def put_square(v: Vector, vx: Vector, vy: Vector, out: Array) -> None:
    """v.v of v + x vx + y vy."""
    for k in range(TERMS):
        out[k] = 0.0
    out[0], out[5], out[1] = dot(v, v), 2.0 * dot(v, vx), 2.0 * dot(v, vy)
    out[10], out[6], out[2] = dot(vx, vx), 2.0 * dot(vx, vy), dot(vy, vy)


@jitable
def put_form(form: Array, v: Vector, vx: Vector, vy: Vector, out: Array) -> None:
    """v.M v of v + x vx + y vy."""
    xx, yy, zz, xy, xz, yz = form[0], form[1], form[2], form[3], form[4], form[5]
    for k in range(TERMS):
        out[k] = 0.0
    out[0] = leaves.form_product(xx, yy, zz, xy, xz, yz, *v, *v)
    out[5] = 2.0 * leaves.form_product(xx, yy, zz, xy, xz, yz, *v, *vx)
    out[1] = 2.0 * leaves.form_product(xx, yy, zz, xy, xz, yz, *v, *vy)
    out[10] = leaves.form_product(xx, yy, zz, xy, xz, yz, *vx, *vx)
    out[6] = 2.0 * leaves.form_product(xx, yy, zz, xy, xz, yz, *vx, *vy)
    out[2] = leaves.form_product(xx, yy, zz, xy, xz, yz, *vy, *vy)


@jitable
def put_quartic(wall: Wall, v: Vector, vx: Vector, vy: Vector, work: Array, out: Array) -> None:
    """The resultant in t of |t v - C|^2 = R^2 and q(t v) = 0: (k0 A - c V)^2 + 4 (b V + m A)(m c + b k0).

    V = v.v, m = C.v, k0 = |C|^2 - R^2; A = v.A v, b = b.v and c of the quadric. It has the far side of the sphere too.
    """
    square, axis, form, linear = work[0], work[1], work[2], work[3]
    put_square(v, vx, vy, square)
    center = vector(wall.center)
    power = leaves.sphere_power(*center, wall.radius)
    put_linear(center, 0.0, v, vx, vy, axis)
    put_form(wall.form, v, vx, vy, form)
    put_linear(vector(wall.linear), 0.0, v, vx, vy, linear)
    first, second, third = work[4], work[5], work[6]
    for k in range(TERMS):
        first[k] = power * form[k] - wall.rest * square[k]
        third[k] = 4.0 * (wall.rest * axis[k] + power * linear[k])
    times(first, first, out)
    times(linear, square, first)
    times(axis, form, second)
    for k in range(TERMS):
        first[k] += second[k]
    times(first, third, second)
    for k in range(TERMS):
        out[k] += second[k]


@jitable
def put_level(wall: Wall, v: Vector, vx: Vector, vy: Vector, work: Array, out: Array) -> None:
    """The level of a wall on rays v + x vx + y vy."""
    if wall.kind == LINE:
        put_linear(vector(wall.normal), 0.0, v, vx, vy, out)
    elif wall.kind == CONIC:
        put_form(wall.form, v, vx, vy, out)
    elif wall.kind == RIM:
        # x^2 + y^2 - 1 of the whole lens, of whose cells curves are listed once
        for k in range(TERMS):
            out[k] = 0.0
        out[0], out[10], out[2] = -1.0, 1.0, 1.0
    else:
        put_quartic(wall, v, vx, vy, work, out)


@jitable
def put_curve(wall: Wall, v: Vector, vx: Vector, vy: Vector, work: Array, out: Array) -> bool:
    """The curve of a wall on rays v + x vx + y vy, its largest coefficient 1; False where it is no curve."""
    put_level(wall, v, vx, vy, work, out)
    most = 0.0
    for k in range(TERMS):
        most = max(most, abs(out[k]))
    if not 0.0 < most < 1e300:
        return False
    for k in range(TERMS):
        out[k] /= most
    return True


@jitable
def spread(curve: Array) -> float:
    """By how much a curve's level may differ from that in the middle of its cell."""
    rest = 0.0
    for k in range(1, TERMS):
        rest += abs(curve[k])
    return rest


@jitable
def misses(curve: Array, slack: float) -> bool:
    """Whether a curve is proved not to enter its cell, nor to come nearer than about ``slack`` of its size."""
    rest = slack
    for k in range(1, TERMS):
        rest += abs(curve[k])
    return bool(abs(curve[0]) > rest)


@jitable
def put_quarter(curve: Array, quarter: int, out: Array) -> None:
    """The curve in the coordinates of a quarter of its cell: x = (x' +- 1)/2, y likewise."""
    sx, sy = 1.0 if quarter % 2 == 1 else -1.0, 1.0 if quarter >= 2 else -1.0
    scale = 1.0
    for i in range(5):
        share = scale
        for j in range(5 - i):
            out[5 * i + j] = curve[5 * i + j] * share
            share *= 0.5
        scale *= 0.5
    # Taylor's expansion by Horner's scheme, a variable at a time
    for j in range(4):
        for start in range(4 - j):
            for i in range(3 - j, start - 1, -1):
                out[5 * i + j] += sx * out[5 * i + 5 + j]
    for i in range(4):
        for start in range(4 - i):
            for j in range(3 - i, start - 1, -1):
                out[5 * i + j] += sy * out[5 * i + j + 1]


@jitable
def put_turned(curve: Array, mode: int, out: Array) -> None:
    """The curve in the coordinates t, along a line, and s, across, of a way to cut its cell (``TURN``)."""
    for k in range(TERMS):
        out[k] = 0.0
    for i in range(5):
        for j in range(5 - i):
            f = curve[5 * i + j]
            if f != 0.0:
                for k in range(i + j + 1):
                    out[5 * k + i + j - k] += f * TURN[mode, 5 * k + i + j - k, 5 * i + j]
    out[REST] = curve[REST]


@jitable
def slope_bounds(curve: Array) -> tuple[float, float, float, float]:
    """(least, largest) slope in t, then in s, over the cell."""
    tm, tr, sm, sr = curve[5], 0.0, curve[1], 0.0
    for i in range(5):
        for j in range(5 - i):
            size = abs(curve[5 * i + j])
            if i > 0 and i + j > 1:
                tr += i * size
            if j > 0 and i + j > 1:
                sr += j * size
    return tm - tr, tm + tr, sm - sr, sm + sr


@inlined
def along(curve: Array, s: float) -> tuple[float, float, float, float, float]:
    """Coefficients in t of a curve on the line s."""
    c = curve
    return (
        c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))),
        c[5] + s * (c[6] + s * (c[7] + s * c[8])),
        c[10] + s * (c[11] + s * c[12]),
        c[15] + s * c[16],
        c[20],
    )


@jitable
def crossing(curve: Array, s: float, low: float, high: float, rises: bool) -> tuple[int, float, float]:
    """Where a curve, monotone in t, crosses the line s between ``low`` and ``high``.

    (-1, low, level there) where it passes before ``low``, (1, high, level there) behind ``high``, else (0, t, 0).
    """
    a, b, c, d, e = along(curve, s)
    sign = 1.0 if rises else -1.0
    first = sign * (a + low * (b + low * (c + low * (d + low * e))))
    if first >= 0.0:
        return -1, low, first
    last = sign * (a + high * (b + high * (c + high * (d + high * e))))
    if last <= 0.0:
        return 1, high, last
    t = low + (high - low) * first / (first - last)
    for _ in range(60):
        level = sign * (a + t * (b + t * (c + t * (d + t * e))))
        if level < 0.0:
            low = t
        else:
            high = t
        slope = sign * (b + t * (2.0 * c + t * (3.0 * d + t * 4.0 * e)))
        step = t - level / slope if slope > 0.0 else 0.5 * (low + high)
        if not low <= step <= high:
            step = 0.5 * (low + high)
        if abs(step - t) <= 1e-16:
            return 0, step, 0.0
        t = step
    return 0, t, 0.0
