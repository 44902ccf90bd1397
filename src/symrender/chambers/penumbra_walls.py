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

from symrender.chambers.penumbra import edge_level
from symrender.chambers.place import floor_shadow_roots, shadow_level, shadow_quartic, surface_point
from symrender.chambers.records import Chart, Wall
from symrender.chambers.roots import quartic_roots
from symrender.chambers.shades import falls_in_sight
from symrender.chambers.walls import (
    GLEAM_EDGE,
    PENUMBRA,
    SHADOW,
    TERMINATOR,
    add_shadow,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values
from symrender.scene.arrays import CUT
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

SAMPLES: Final = 12
"""Pieces of the bracket in which a penumbra's edges are looked for."""
HALF_PI: Final = 0.5 * math.pi


@jitable
def add_band(i: int, sphere: Sphere, view: View, work: Work) -> None:
    """Append the edges of disk ``i``'s band of terminators on the charted sphere, if it crosses the visible cap."""
    chart = work.chart
    p = view.points[i]
    rho, r = p.radius, sphere.radius
    lx, ly, lz = p.position[0] - sphere.center[0], p.position[1] - sphere.center[1], p.position[2] - sphere.center[2]
    far = math.sqrt(lx * lx + ly * ly + lz * lz)
    facing = math.acos(max(-1.0, min(1.0, -(lx * chart.pole[0] + ly * chart.pole[1] + lz * chart.pole[2]) / far)))
    first, last = math.acos(min(1.0, (r + rho) / far)), math.acos(max(-1.0, (r - rho) / far))
    if facing - chart.gamma_max >= last or facing + chart.gamma_max <= first:
        return
    n = work.counts.walls
    work.counts.walls += 1
    if n >= work.walls.shape[0]:
        return
    row = work.walls[n]
    row.kind, row.tag, row.shape_index, row.met, row.parted = SHADOW, TERMINATOR, i, 0, 0
    for a in range(3):
        along = chart.pole if a == 0 else chart.e1 if a == 1 else chart.e2
        x, y, z = along[0], along[1], along[2]
        row.first[a] = rho / r * (p.axis[0] * x + p.axis[1] * y + p.axis[2] * z)
        row.second[a] = (lx * x + ly * y + lz * z) / r
        row.origin[a] = 0.0
    row.first_level, row.second_level, row.origin2, row.sine2 = 0.0, -r, (rho - r) * (rho + r), 1.0


@jitable
def add_edges(i: int, h: int, ox: float, oy: float, oz: float, view: View, work: Work) -> None:
    """Note that ball ``h`` shadows disk ``i`` and append both edges of its penumbra; ``o`` is the chart's origin."""
    work.casters[work.counts.casters].light = i
    work.casters[work.counts.casters].ball = h
    work.casters[work.counts.casters].unseen = 0
    work.counts.casters += 1
    p, s = view.points[i], view.spheres[h]
    # apex of the penumbra of the ball of the disk's radius
    t = p.radius / (p.radius + s.radius)
    ax, ay, az = (
        p.position[0] + t * (s.center[0] - p.position[0]),
        p.position[1] + t * (s.center[1] - p.position[1]),
        p.position[2] + t * (s.center[2] - p.position[2]),
    )
    for inner in range(2):
        n = work.counts.walls
        work.counts.walls = add_shadow(
            work.walls,
            n,
            work.chart,
            ox - ax,
            oy - ay,
            oz - az,
            ox - s.center[0],
            oy - s.center[1],
            oz - s.center[2],
            s.radius,
            h,
            i,
        )
        if n < work.walls.shape[0]:
            row = work.walls[n]
            row.kind, row.inner = PENUMBRA, inner
            row.disk = p
            for a in range(3):
                row.ball_center[a] = s.center[a]
            row.ball_radius = s.radius


@jitable
def disk_on_sphere(i: int, j: int, view: View, work: Work) -> None:
    """Walls of disk ``i`` on the charted sphere ``j``, and the spheres that can hide some of it there."""
    chart = work.chart
    p, sphere = view.points[i], view.spheres[j]
    rho, r = p.radius, sphere.radius
    lx, ly, lz = p.position[0] - sphere.center[0], p.position[1] - sphere.center[1], p.position[2] - sphere.center[2]
    far = math.sqrt(lx * lx + ly * ly + lz * lz)
    if far + rho <= r:
        return
    if far > 0.0:
        add_band(i, sphere, view, work)
        if view.shading.terminator == CUT or view.shading.ks == 0.0:
            # the visible cap may lie wholly behind the terminators
            facing = -(lx * chart.pole[0] + ly * chart.pole[1] + lz * chart.pole[2]) / far
            if math.acos(max(-1.0, min(1.0, facing))) - chart.gamma_max > math.acos(max(-1.0, (r - rho) / far)):
                return
    bx, by, bz, wide = chart.ball[0], chart.ball[1], chart.ball[2], chart.ball_radius
    for h in range(view.spheres.shape[0]):
        if h == j:
            continue
        s = view.spheres[h]
        ex, ey, ez = s.center[0] - p.position[0], s.center[1] - p.position[1], s.center[2] - p.position[2]
        dist = math.sqrt(ex * ex + ey * ey + ez * ez)
        reach = s.radius + rho
        if dist > reach:
            ex, ey, ez = ex / dist, ey / dist, ez / dist
            t = dist * rho / reach
            vx, vy, vz = bx - p.position[0] - t * ex, by - p.position[1] - t * ey, bz - p.position[2] - t * ez
            along = vx * ex + vy * ey + vz * ez
            across = math.sqrt(max(0.0, vx * vx + vy * vy + vz * vz - along * along))
            sine = reach / dist
            if (
                along + wide < dist - t - s.radius
                or across * math.sqrt((1.0 - sine) * (1.0 + sine)) - along * sine > wide
            ):
                continue
        add_edges(i, h, sphere.center[0], sphere.center[1], sphere.center[2], view, work)


@jitable
def disk_on_floor(i: int, lobe: Array, view: View, work: Work) -> None:
    """Walls of disk ``i`` on the floor, and the spheres that can hide some of it there."""
    p = view.points[i]
    top = p.position[2] + p.radius * math.hypot(p.e1[2], p.e2[2])
    if top <= 0.0:
        return
    for h in range(view.spheres.shape[0]):
        s = view.spheres[h]
        if s.center[2] > -s.radius and s.center[2] - s.radius < top and falls_in_sight(i, s, lobe, view, work):
            add_edges(i, h, work.chart.point[0], work.chart.point[1], 0.0, view, work)


@jitable
def penumbra_level(row: Wall, x: float, c: float, s: float, chart: Chart) -> float:
    """Level of a penumbra's edge at inner coordinate ``x`` of the line (c, s).

    Where c is NaN, at the floor point (x, s) from the foot instead: the line y = s of the floor's squares.
    """
    if c != c:
        qx, qy, qz = chart.point[0] + x, chart.point[1] + s, 0.0
    else:
        qx, qy, qz, _, _, _ = surface_point(x, c, s, chart)
    x, y, z = row.ball_center[0], row.ball_center[1], row.ball_center[2]
    return edge_level(qx, qy, qz, row.disk, x, y, z, row.ball_radius, row.inner == 1.0)


@jitable
def highlight_level(row: Wall, x: float, c: float, s: float, chart: Chart) -> float:
    """Level of a ``GLEAM_EDGE`` at inner coordinate ``x`` of the line (c, s): N.(l + v) of unit vectors, or r.v."""
    qx, qy, qz, nx, ny, nz = surface_point(x, c, s, chart)
    lx, ly, lz = row.lit_from[0] - qx, row.lit_from[1] - qy, row.lit_from[2] - qz
    vx, vy, vz = row.seen_from[0] - qx, row.seen_from[1] - qy, row.seen_from[2] - qz
    if row.phong != 0:
        return values.phong_edge_level(lx, ly, lz, vx, vy, vz, nx, ny, nz)
    return values.blinn_edge_level(lx, ly, lz, vx, vy, vz, nx, ny, nz)


@inlined
def edge_value(row: Wall, x: float, c: float, s: float, chart: Chart) -> float:
    """Level of a wall whose roots are searched: a penumbra's edge or a highlight's."""
    if row.kind == GLEAM_EDGE:
        return highlight_level(row, x, c, s, chart)
    return penumbra_level(row, x, c, s, chart)


@jitable
def penumbra_root(row: Wall, a: float, b: float, fa: float, fb: float, c: float, s: float, chart: Chart) -> float:
    """The zero of the level in the bracket (a, b), whose values there differ in sign (Illinois)."""
    for _ in range(60):
        x = (a * fb - b * fa) / (fb - fa)
        f = edge_value(row, x, c, s, chart)
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
def bracket(row: Wall, c: float, s: float, work: Work) -> tuple[float, float]:
    """Part (a, b) of the line inside the double cone about the penumbra of the ball around the disk; a >= b if none."""
    chart = work.chart
    end = HALF_PI * (1.0 - 1e-12)
    if row.sine2 >= 1.0:
        return 0.0, end
    roots = work.quartic
    n = 0
    if chart.shape_index >= 0.0:
        top, k = chart.limb_tangent, chart.ratio
        shadow_quartic(row, chart.radius, c, s, top, work.bernstein)
        n = min(4, quartic_roots(work.bernstein, work.stack, roots))
        for i in range(n):
            t = top * roots[i]
            roots[i] = math.atan2(2.0 * t, (1.0 - t * t) - k * (1.0 + t * t))
    else:
        found, r1, r2 = floor_shadow_roots(row, c, s)
        for i in range(found):
            r = r1 if i == 0 else r2
            if r > 0.0:
                roots[n] = math.atan2(r, chart.height)
                n += 1
    a, b = end, 0.0
    start = 0.0
    for i in range(n + 1):
        stop = roots[i] if i < n else end
        if stop > start and shadow_level(row, 0.5 * (start + stop), c, s, chart) > 0.0:
            a, b = min(a, start), max(b, stop)
        start = stop
    return a, b


@jitable
def edge_search(row: Wall, a: float, b: float, c: float, s: float, chart: Chart, out: Array) -> int:
    """Zeros of a penumbra's or a highlight's edge on a line between a and b, ascending in ``out`` (4,); their number.

    Sign changes between samples, and turning points between samples that lie beyond zero.
    """
    n = 0
    x0 = x1 = f0 = f1 = 0.0
    for k in range(SAMPLES + 1):
        u = math.sin(HALF_PI * k / SAMPLES)
        x2 = a + (b - a) * u * u
        f2 = edge_value(row, x2, c, s, chart)
        if k > 0 and f1 * f2 < 0.0:
            if n < 4:
                out[n] = penumbra_root(row, x1, x2, f1, f2, c, s, chart)
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
                f = edge_value(row, x, c, s, chart)
                if f * fm < 0.0:
                    if n + 1 < 4:
                        out[n] = penumbra_root(row, left, x, fl, f, c, s, chart)
                        out[n + 1] = penumbra_root(row, x, right, f, fr, c, s, chart)
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
    chart = work.chart
    if row.kind == GLEAM_EDGE:
        a, b = 0.0, HALF_PI * (1.0 - 1e-12)
    else:
        a, b = bracket(row, c, s, work)
    if not (a < b and a < high and b > low):
        return 0
    n = edge_search(row, a, b, c, s, chart, out)
    for k in range(n):
        if not low < out[k] < high:
            out[k] = math.nan
    return n
