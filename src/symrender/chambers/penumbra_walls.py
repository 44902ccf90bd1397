"""The walls a disk light lays on a visible shape: where its penumbrae begin and end, and its band of terminators.

Across each of them the light that reaches a point is once continuously differentiable: its share of the disk starts
with the power 3/2 of the distance from the wall. The terminators N.(x - Q) = 0 of the points x of the disk fill the
band (N.(L - Q))^2 < rho^2 (1 - (N.w)^2), whose two edges on a sphere are one quartic along a scan line, like a shadow
edge. The edges of a penumbra have no such form: their level is min F or max F (``chambers/penumbra.py``),
bracketed inside the cone of the ball about the disk.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_AXIS, DISK_E1, DISK_E2, DISK_RADIUS, LIGHT_POINT_COLUMNS, edge_level
from symrender.chambers.place import floor_shadow_roots, shadow_level, shadow_quartic, surface_point
from symrender.chambers.roots import quartic_roots
from symrender.chambers.walls import (
    GAMMA_MAX,
    GLEAM_EDGE,
    HEIGHT,
    KIND,
    LIMB_TANGENT,
    MET_COLUMN,
    PENUMBRA,
    POINT,
    POLE,
    RADIUS,
    RATIO,
    SHADOW,
    SHAPE_INDEX,
    TERMINATOR,
    add_shadow,
)
from symrender.chambers.work import CASTERS, WALLS, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.scene.arrays import CUT

Array = npt.NDArray[np.float64]

INNER: Final = 23
"""Column of a penumbra's edge: 1 for the inner edge."""
DISK_ROW: Final = 24
"""First column of the light's row in a penumbra's edge; then the ball's centre and radius."""
BALL_ROW: Final = DISK_ROW + LIGHT_POINT_COLUMNS
SAMPLES: Final = 12
"""Pieces of the bracket in which a penumbra's edges are looked for."""
HALF_PI: Final = 0.5 * math.pi


@jitable
def add_band(i: int, sphere: Array, view: View, work: Work) -> None:
    """Append the edges of disk ``i``'s band of terminators on the charted sphere, if it crosses the visible cap."""
    geo = work.geo
    p = view.points[i]
    rho, r = p[DISK_RADIUS], sphere[3]
    lx, ly, lz = p[0] - sphere[0], p[1] - sphere[1], p[2] - sphere[2]
    far = math.sqrt(lx * lx + ly * ly + lz * lz)
    facing = math.acos(max(-1.0, min(1.0, -(lx * geo[POLE] + ly * geo[POLE + 1] + lz * geo[POLE + 2]) / far)))
    first, last = math.acos(min(1.0, (r + rho) / far)), math.acos(max(-1.0, (r - rho) / far))
    if facing - geo[GAMMA_MAX] >= last or facing + geo[GAMMA_MAX] <= first:
        return
    n = work.counts[WALLS]
    work.counts[WALLS] += 1
    if n >= work.walls.shape[0]:
        return
    row = work.walls[n]
    row[KIND], row[6], row[7], row[MET_COLUMN] = SHADOW, TERMINATOR, i, 0.0
    for a in range(3):
        x, y, z = geo[POLE + 3 * a], geo[POLE + 3 * a + 1], geo[POLE + 3 * a + 2]
        row[8 + a] = rho / r * (p[DISK_AXIS] * x + p[DISK_AXIS + 1] * y + p[DISK_AXIS + 2] * z)
        row[12 + a] = (lx * x + ly * y + lz * z) / r
        row[16 + a] = 0.0
    row[11], row[15], row[19], row[20] = 0.0, -r, (rho - r) * (rho + r), 1.0


@jitable
def add_edges(i: int, h: int, ox: float, oy: float, oz: float, view: View, work: Work) -> None:
    """Note ball ``h`` as a caster of disk ``i`` and append both edges of its penumbra; ``o`` is the chart's origin."""
    work.casters[work.counts[CASTERS], 0] = i
    work.casters[work.counts[CASTERS], 1] = h
    work.counts[CASTERS] += 1
    p, s = view.points[i], view.spheres[h]
    # apex of the penumbra of the ball of the disk's radius
    t = p[DISK_RADIUS] / (p[DISK_RADIUS] + s[3])
    ax, ay, az = p[0] + t * (s[0] - p[0]), p[1] + t * (s[1] - p[1]), p[2] + t * (s[2] - p[2])
    for inner in range(2):
        n = work.counts[WALLS]
        work.counts[WALLS] = add_shadow(
            work.walls, n, work.geo, ox - ax, oy - ay, oz - az, ox - s[0], oy - s[1], oz - s[2], s[3], h, i
        )
        if n < work.walls.shape[0]:
            row = work.walls[n]
            row[KIND], row[INNER] = PENUMBRA, inner
            for a in range(LIGHT_POINT_COLUMNS):
                row[DISK_ROW + a] = p[a]
            for a in range(4):
                row[BALL_ROW + a] = s[a]


@jitable
def disk_on_sphere(i: int, j: int, view: View, work: Work) -> None:
    """Walls of disk ``i`` on the charted sphere ``j``, and the spheres that can hide some of it there."""
    geo = work.geo
    p, sphere = view.points[i], view.spheres[j]
    rho, r, k = p[DISK_RADIUS], sphere[3], geo[RATIO]
    lx, ly, lz = p[0] - sphere[0], p[1] - sphere[1], p[2] - sphere[2]
    far = math.sqrt(lx * lx + ly * ly + lz * lz)
    if far + rho <= r:
        return
    if far > 0.0:
        add_band(i, sphere, view, work)
        if view.shading[6] == CUT or view.shading[2] == 0.0:
            # the visible cap may lie wholly behind the terminators
            facing = -(lx * geo[POLE] + ly * geo[POLE + 1] + lz * geo[POLE + 2]) / far
            if math.acos(max(-1.0, min(1.0, facing))) - geo[GAMMA_MAX] > math.acos(max(-1.0, (r - rho) / far)):
                return
    # a ball about the visible cap
    bx, by, bz = sphere[0] - k * r * geo[POLE], sphere[1] - k * r * geo[POLE + 1], sphere[2] - k * r * geo[POLE + 2]
    wide = r * math.sin(geo[GAMMA_MAX])
    for h in range(view.spheres.shape[0]):
        if h == j:
            continue
        s = view.spheres[h]
        ex, ey, ez = s[0] - p[0], s[1] - p[1], s[2] - p[2]
        dist = math.sqrt(ex * ex + ey * ey + ez * ez)
        reach = s[3] + rho
        if dist > reach:
            ex, ey, ez = ex / dist, ey / dist, ez / dist
            t = dist * rho / reach
            vx, vy, vz = bx - p[0] - t * ex, by - p[1] - t * ey, bz - p[2] - t * ez
            along = vx * ex + vy * ey + vz * ez
            across = math.sqrt(max(0.0, vx * vx + vy * vy + vz * vz - along * along))
            sine = reach / dist
            if along + wide < dist - t - s[3] or across * math.sqrt((1.0 - sine) * (1.0 + sine)) - along * sine > wide:
                continue
        add_edges(i, h, sphere[0], sphere[1], sphere[2], view, work)


@jitable
def disk_on_floor(i: int, view: View, work: Work) -> None:
    """Walls of disk ``i`` on the floor, and the spheres that can hide some of it there."""
    p = view.points[i]
    top = p[2] + p[DISK_RADIUS] * math.hypot(p[DISK_E1 + 2], p[DISK_E2 + 2])
    if top <= 0.0:
        return
    for h in range(view.spheres.shape[0]):
        s = view.spheres[h]
        if s[2] > -s[3] and s[2] - s[3] < top:
            add_edges(i, h, work.geo[POINT], work.geo[POINT + 1], 0.0, view, work)


@jitable
def penumbra_level(row: Array, x: float, c: float, s: float, geo: Array) -> float:
    """Level of a penumbra's edge at inner coordinate ``x`` of the line (c, s).

    Where c is NaN, at the floor point (x, s) from the foot instead: the line y = s of the floor's squares.
    """
    if c != c:
        qx, qy, qz = geo[POINT] + x, geo[POINT + 1] + s, 0.0
    else:
        qx, qy, qz, _, _, _ = surface_point(x, c, s, geo)
    b = BALL_ROW
    return edge_level(qx, qy, qz, row[DISK_ROW:b], row[b], row[b + 1], row[b + 2], row[b + 3], row[INNER] == 1.0)


@jitable
def highlight_level(row: Array, x: float, c: float, s: float, geo: Array) -> float:
    """Level of a ``GLEAM_EDGE`` at inner coordinate ``x`` of the line (c, s): N.(l + v) of unit vectors, or r.v."""
    qx, qy, qz, nx, ny, nz = surface_point(x, c, s, geo)
    lx, ly, lz, vx, vy, vz = row[8] - qx, row[9] - qy, row[10] - qz, row[11] - qx, row[12] - qy, row[13] - qz
    far_l = 1.0 / math.sqrt(max(1e-300, lx * lx + ly * ly + lz * lz))
    far_v = 1.0 / math.sqrt(max(1e-300, vx * vx + vy * vy + vz * vz))
    nl, nv = (nx * lx + ny * ly + nz * lz) * far_l, (nx * vx + ny * vy + nz * vz) * far_v
    if row[14] != 0.0:
        return float(2.0 * nl * nv - (lx * vx + ly * vy + lz * vz) * far_l * far_v)
    return float(nl + nv)


@inlined
def edge_value(row: Array, x: float, c: float, s: float, geo: Array) -> float:
    """Level of a wall whose roots are searched: a penumbra's edge or a highlight's."""
    if row[KIND] == GLEAM_EDGE:
        return highlight_level(row, x, c, s, geo)
    return penumbra_level(row, x, c, s, geo)


@jitable
def penumbra_root(row: Array, a: float, b: float, fa: float, fb: float, c: float, s: float, geo: Array) -> float:
    """The zero of the level in the bracket (a, b), whose values there differ in sign (Illinois)."""
    for _ in range(60):
        x = (a * fb - b * fa) / (fb - fa)
        f = edge_value(row, x, c, s, geo)
        step = abs(x - b)
        if f * fb < 0.0:
            a, fa = b, fb
        else:
            fa *= 0.5
        b, fb = x, f
        if f == 0.0 or step < 1e-13 or abs(b - a) < 1e-13:
            break
    return b


@jitable
def bracket(row: Array, c: float, s: float, work: Work) -> tuple[float, float]:
    """Part (a, b) of the line inside the double cone about the penumbra of the ball around the disk; a >= b if none."""
    geo = work.geo
    end = HALF_PI * (1.0 - 1e-12)
    if row[20] >= 1.0:
        return 0.0, end
    roots = work.quartic
    n = 0
    if geo[SHAPE_INDEX] >= 0.0:
        top, k = geo[LIMB_TANGENT], geo[RATIO]
        shadow_quartic(row, geo[RADIUS], c, s, top, work.bernstein)
        n = min(4, quartic_roots(work.bernstein, work.stack, roots))
        for i in range(n):
            t = top * roots[i]
            roots[i] = math.atan2(2.0 * t, (1.0 - t * t) - k * (1.0 + t * t))
    else:
        found, r1, r2 = floor_shadow_roots(row, c, s)
        for i in range(found):
            r = r1 if i == 0 else r2
            if r > 0.0:
                roots[n] = math.atan2(r, geo[HEIGHT])
                n += 1
    a, b = end, 0.0
    start = 0.0
    for i in range(n + 1):
        stop = roots[i] if i < n else end
        if stop > start and shadow_level(row, 0.5 * (start + stop), c, s, geo) > 0.0:
            a, b = min(a, start), max(b, stop)
        start = stop
    return a, b


@jitable
def edge_search(row: Array, a: float, b: float, c: float, s: float, geo: Array, out: Array) -> int:
    """Zeros of a penumbra's or a highlight's edge on a line between a and b, ascending in ``out`` (4,); their number.

    Sign changes between samples, and turning points between samples that lie beyond zero.
    """
    n = 0
    x0 = x1 = f0 = f1 = 0.0
    for k in range(SAMPLES + 1):
        u = math.sin(HALF_PI * k / SAMPLES)
        x2 = a + (b - a) * u * u
        f2 = edge_value(row, x2, c, s, geo)
        if k > 0 and f1 * f2 < 0.0:
            if n < 4:
                out[n] = penumbra_root(row, x1, x2, f1, f2, c, s, geo)
                n += 1
        elif k > 1 and f0 * f1 > 0.0 and abs(f1) < abs(f0) and abs(f1) <= abs(f2):
            # the level turns back short of zero: its turning point may lie beyond
            left, middle, right, fl, fm, fr = x0, x1, x2, f0, f1, f2
            for _ in range(12):
                p, q = (middle - left) * (fm - fr), (middle - right) * (fm - fl)
                if p == q:
                    break
                x = middle - 0.5 * ((middle - left) * p - (middle - right) * q) / (p - q)
                if not left < x < right or abs(x - middle) < 1e-9:
                    break
                f = edge_value(row, x, c, s, geo)
                if f * fm < 0.0:
                    if n + 1 < 4:
                        out[n] = penumbra_root(row, left, x, fl, f, c, s, geo)
                        out[n + 1] = penumbra_root(row, x, right, f, fr, c, s, geo)
                        n += 2
                    break
                if abs(f) < abs(fm):
                    if x < middle:
                        right, fr = middle, fm
                    else:
                        left, fl = middle, fm
                    middle, fm = x, f
                elif x < middle:
                    left, fl = x, f
                else:
                    right, fr = x, f
                if abs(fm) > 0.5 * min(abs(fl), abs(fr)) and right - left < 1e-6:
                    break
        x0, f0, x1, f1 = x1, f1, x2, f2
    return n


@jitable
def penumbra_roots(i: int, c: float, s: float, low: float, high: float, work: Work, out: Array) -> int:
    """Inner coordinates of edge ``i`` strictly between low and high in ``out`` (4,), NaN else; number of branches.

    A branch keeps its number along the whole line, so that it can be followed from one line to the next.
    """
    row = work.walls[i]
    geo = work.geo
    if row[KIND] == GLEAM_EDGE:
        a, b = 0.0, HALF_PI * (1.0 - 1e-12)
    else:
        a, b = bracket(row, c, s, work)
    if not (a < b and a < high and b > low):
        return 0
    n = edge_search(row, a, b, c, s, geo, out)
    for k in range(n):
        if not low < out[k] < high:
            out[k] = math.nan
    return n
