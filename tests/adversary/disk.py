"""Compiled: what a whole disk light brings to a point, line by line across the visible part of the disk.

Along a line of the disk everything that hides is closed form: the cone about a ball is a quadratic, so are the ball's
own surface and the edge of Blinn's highlight; floor, terminator and the edge of Phong's highlight are linear. Between
two of these the integrand is smooth, and the middle says whether anything is seen. Across the lines the places where a
cone or a ball begins and ends are the roots of a discriminant; all else is left to halving.
"""

from __future__ import annotations

import math

import numpy as np

from .compile import kernel
from .light import Vector, base_of, blockers, dot, power
from .world import OPEN, PHONG, SHININESS, Array, World

_X = np.array([
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851, 0.864864423359769072789712788640926,
    0.741531185599394439863864773280788, 0.586087235467691130294144691693306, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0])  # fmt: skip
_K = np.array([
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204, 0.104790010322250183839876322541518,
    0.140653259715525918745189590510238, 0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714])  # fmt: skip
_G = np.array([0.0, 0.129484966168869693270611432679082, 0.0, 0.279705391489276667901467771423780,
               0.0, 0.381830050505118944950369775488975, 0.0, 0.417959183673469387755102040816327])  # fmt: skip
_DEEPEST = 40
_STACK = 64
_MOST = 400


@kernel
def put(values: Array, count: int, a: float, b: float, c: float, low: float, high: float) -> int:
    """Append the roots of a + b t + c t^2 within (low, high); new count."""
    roots = (math.nan, math.nan)
    if c == 0.0:
        if b != 0.0:
            roots = (-a / b, math.nan)
    else:
        room = b * b - 4.0 * a * c
        if room >= 0.0:
            half = -0.5 * (b + math.copysign(math.sqrt(room), b))
            roots = (half / c, a / half if half != 0.0 else math.nan)
    for t in roots:
        if low < t < high and count < values.shape[0]:
            values[count] = t
            count += 1
    return count


@kernel
def times(s: float, a: Vector, b: Vector) -> Vector:
    """a + s b."""
    return (a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2])


@kernel
def breaks_along(
    w: World, shape: int, q: Vector, n: Vector, v: Vector, d: Vector, g: Vector, half: float, at: Array
) -> int:
    """Sorted t in [-half, half], ends included, where the line q + d + t g of the disk meets whatever changes."""
    count = 0
    dd, dg, gg = dot(d, d), dot(d, g), dot(g, g)
    for j in range(w.spheres.shape[0]):
        s = w.spheres[j]
        if s[3] == 0.0:
            continue
        f = (s[0] - q[0], s[1] - q[1], s[2] - q[2])
        df, gf, level = dot(d, f), dot(g, f), dot(f, f) - s[3] * s[3]
        if shape != 1 + j and level > 0.0:
            count = put(
                at, count, df * df - dd * level, 2.0 * (df * gf - dg * level), gf * gf - gg * level, -half, half
            )
        o = (d[0] - f[0], d[1] - f[1], d[2] - f[2])
        count = put(at, count, dot(o, o) - s[3] * s[3], 2.0 * dot(o, g), gg, -half, half)
    count = put(at, count, q[2] + d[2], g[2], 0.0, -half, half)
    dn, gn, vn = dot(d, n), dot(g, n), dot(v, n)
    count = put(at, count, dn, gn, 0.0, -half, half)
    if w.rules[PHONG] != 0.0:
        r = (2.0 * vn * n[0] - v[0], 2.0 * vn * n[1] - v[1], 2.0 * vn * n[2] - v[2])
        count = put(at, count, dot(d, r), dot(g, r), 0.0, -half, half)
    else:
        count = put(
            at, count, dn * dn - vn * vn * dd, 2.0 * (dn * gn - vn * vn * dg), gn * gn - vn * vn * gg, -half, half
        )
    at[count], at[count + 1] = -half, half
    at[: count + 2].sort()
    return count + 2


@kernel
def terms_at(w: World, q: Vector, n: Vector, v: Vector, d: Vector, g: Vector, t: float) -> tuple[float, float]:
    """(N.l cut at 0, s) of the disk's point at t of a line, hidden or not."""
    cosine, base = base_of(w, q, n, v, (q[0] + d[0] + t * g[0], q[1] + d[1] + t * g[1], q[2] + d[2] + t * g[2]))
    gleam = 0.0
    if base > -2.0 and (cosine > 0.0 or w.rules[OPEN] != 0.0):
        gleam = power(max(0.0, base), w.rules[SHININESS])
    return max(0.0, cosine), gleam


@kernel
def piece(
    w: World, q: Vector, n: Vector, v: Vector, d: Vector, g: Vector, foot: float, rise: float, low: float, high: float
) -> tuple[float, float, float]:
    """(sum of N.l, sum of s, doubt) over one piece of a line.

    Its ends are angles about Q's foot where ``rise`` > 0, else places t.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    fine0, fine1, rough0, rough1 = 0.0, 0.0, 0.0, 0.0
    for k in range(15):
        i = k if k < 8 else 14 - k
        x = middle + half * (-_X[i] if k < 7 else _X[i])
        t, weight = x, 1.0
        if rise > 0.0:
            c = math.cos(x)
            t, weight = foot + rise * math.tan(x), rise / (c * c)
        a, b = terms_at(w, q, n, v, d, g, t)
        fine0 += _K[i] * weight * a
        fine1 += _K[i] * weight * b
        rough0 += _G[i] * weight * a
        rough1 += _G[i] * weight * b
    return half * fine0, half * fine1, half * max(abs(fine0 - rough0), abs(fine1 - rough1))


@kernel
def line_sum(
    w: World, shape: int, inside: bool, q: Vector, n: Vector, v: Vector, d: Vector, g: Vector, half: float, tol: float,
    at: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """Integral over t in [-half, half] of what is seen of the line, (N.l, s), and a doubt."""
    count = breaks_along(w, shape, q, n, v, d, g, half, at)
    gg = dot(g, g)
    foot = -dot(d, g) / gg
    near = times(foot, d, g)
    rise = math.sqrt(dot(near, near) / gg)
    if rise < 1e-9 or rise > 1e3:
        rise = 0.0
    sharp = math.sqrt(w.rules[SHININESS] + 1.0)
    total0, total1, doubt = 0.0, 0.0, 0.0
    lows, highs, depths = np.empty(_STACK), np.empty(_STACK), np.empty(_STACK, np.int64)
    for k in range(count - 1):
        if not at[k + 1] > at[k]:
            continue
        t = 0.5 * (at[k] + at[k + 1])
        place = (q[0] + d[0] + t * g[0], q[1] + d[1] + t * g[1], q[2] + d[2] + t * g[2])
        if blockers(w, shape, inside, q, place) != 0:
            continue
        cosine, _ = base_of(w, q, n, v, place)
        if cosine <= 0.0 and w.rules[OPEN] == 0.0:
            continue
        first, last = at[k], at[k + 1]
        turn = (last - first) / max(1e-9, math.hypot(rise, max(0.0, max(first - foot, foot - last))))
        if rise > 0.0:
            first, last = math.atan((first - foot) / rise), math.atan((last - foot) / rise)
            turn = last - first
        many = int(min(200.0, 1.0 + 0.5 * turn * sharp))
        for i in range(many):
            lows[0], highs[0], depths[0] = first + (last - first) * i / many, first + (last - first) * (i + 1) / many, 0
            left = 1
            while left > 0:
                left -= 1
                low, high, deep = lows[left], highs[left], depths[left]
                a, b, e = piece(w, q, n, v, d, g, foot, rise, low, high)
                # differences of 7 and 15 nodes overrate by far what 15 err by
                if e <= tol * (high - low) / (last - first) or deep >= _DEEPEST or left + 2 > _STACK:
                    total0, total1, doubt = total0 + a, total1 + b, doubt + 0.01 * e
                else:
                    middle = 0.5 * (low + high)
                    lows[left], highs[left], depths[left] = low, middle, deep + 1
                    lows[left + 1], highs[left + 1], depths[left + 1] = middle, high, deep + 1
                    left += 2
    return total0, total1, doubt


@kernel
def extents(w: World, shape: int, q: Vector, d: Vector, e: Vector, g: Vector, at: Array, count: int) -> int:
    """Append the lines s in (-1, 1) of the disk at which the cone or the circle of a ball begins or ends."""
    for j in range(w.spheres.shape[0]):
        s = w.spheres[j]
        if s[3] == 0.0:
            continue
        f = (s[0] - q[0], s[1] - q[1], s[2] - q[2])
        level = dot(f, f) - s[3] * s[3]
        df, ef, gf = dot(d, f), dot(e, f), dot(g, f)
        dd, de, dg, ee, gg = dot(d, d), dot(d, e), dot(d, g), dot(e, e), dot(g, g)
        if shape != 1 + j and level > 0.0:
            # c0 + c1 s + c2 t + c11 s^2 + 2 c12 s t + c22 t^2, its discriminant in t
            c0, c1, c2 = df * df - dd * level, 2.0 * (df * ef - de * level), 2.0 * (df * gf - dg * level)
            c11, c12, c22 = ef * ef - ee * level, ef * gf, gf * gf - gg * level
            count = put(
                at, count, c2 * c2 - 4.0 * c22 * c0, 4.0 * (c2 * c12 - c22 * c1), 4.0 * (c12 * c12 - c22 * c11),
                -1.0, 1.0,
            )  # fmt: skip
        o = (d[0] - f[0], d[1] - f[1], d[2] - f[2])
        og, oe = dot(o, g), dot(o, e)
        room = dot(o, o) - s[3] * s[3]
        count = put(at, count, og * og - gg * room, -2.0 * gg * oe, -gg * ee, -1.0, 1.0)
    return count


@kernel
def disk_mean(
    w: World, shape: int, inside: bool, q: Vector, n: Vector, v: Vector, disk: Array, turn: float, tol: float
) -> tuple[float, float, float]:
    """(mean of V max(0, N.l), mean of V s, doubt) over a disk, by lines turned by ``turn``; ``tol`` absolute."""
    c, z = math.cos(turn), math.sin(turn)
    e = (c * disk[3] + z * disk[6], c * disk[4] + z * disk[7], c * disk[5] + z * disk[8])
    g = (c * disk[6] - z * disk[3], c * disk[7] - z * disk[4], c * disk[8] - z * disk[5])
    d = (disk[0] - q[0], disk[1] - q[1], disk[2] - q[2])
    at = np.empty(8 * w.spheres.shape[0] + 16)
    cuts = np.empty(4 * w.spheres.shape[0] + 4)
    count = extents(w, shape, q, d, e, g, cuts, 0)
    # the line through Q's foot, where a disk is near Q
    ge = dot(e, e)
    foot = -dot(d, e) / ge
    if -1.0 < foot < 1.0:
        cuts[count] = foot
        count += 1
    cuts[count], cuts[count + 1] = -1.0, 1.0
    count += 2
    cuts[:count].sort()
    size = math.sqrt(max(1e-300, dot(d, d) / ge))
    angle = min(3.0, 2.0 / size)
    share = math.ceil(min(_MOST, 4.0 + 0.5 * angle * math.sqrt(w.rules[SHININESS] + 1.0)))
    total0, total1, doubt = 0.0, 0.0, 0.0
    lows, highs, depths = np.empty(_STACK), np.empty(_STACK), np.empty(_STACK, np.int64)
    for k in range(count - 1):
        first, last = math.asin(cuts[k]), math.asin(cuts[k + 1])
        if not last > first:
            continue
        many = math.ceil(share * (last - first) / math.pi)
        for i in range(many):
            lows[0], highs[0], depths[0] = i / many, (i + 1) / many, 0
            left = 1
            while left > 0:
                left -= 1
                low, high, deep = lows[left], highs[left], depths[left]
                middle, half = 0.5 * (low + high), 0.5 * (high - low)
                f0, f1, r0, r1, own = 0.0, 0.0, 0.0, 0.0, 0.0
                for m in range(15):
                    h = m if m < 8 else 14 - m
                    x = middle + half * (-_X[h] if m < 7 else _X[h])
                    # both ends of a strip may begin as a root does
                    b = math.sin(0.5 * math.pi * x)
                    theta = first + (last - first) * b * b
                    slope = (last - first) * math.pi * b * math.cos(0.5 * math.pi * x)
                    wide = math.cos(theta)
                    a0, a1, a2 = line_sum(
                        w, shape, inside, q, n, v, times(math.sin(theta), d, e), g, wide, 0.05 * tol, at
                    )
                    weight = slope * wide
                    f0, f1 = f0 + _K[h] * weight * a0, f1 + _K[h] * weight * a1
                    r0, r1 = r0 + _G[h] * weight * a0, r1 + _G[h] * weight * a1
                    own += _K[h] * weight * a2
                change = half * max(abs(f0 - r0), abs(f1 - r1))
                if change <= tol * (high - low) or deep >= _DEEPEST or left + 2 > _STACK:
                    total0, total1 = total0 + half * f0, total1 + half * f1
                    doubt += half * own + 0.1 * change
                else:
                    lows[left], highs[left], depths[left] = low, middle, deep + 1
                    lows[left + 1], highs[left + 1], depths[left + 1] = middle, high, deep + 1
                    left += 2
    return total0 / math.pi, total1 / math.pi, doubt / math.pi
