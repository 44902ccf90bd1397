"""The chart of one visible shape from one point: frame, walls, what hides it, what casts shadows on it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import line_range
from symrender.chambers.listed import ROUNDED_UP, casts, is_at, shadow_in_view
from symrender.chambers.penumbra_walls import disk_on_floor, disk_on_sphere
from symrender.chambers.reach import note_reach
from symrender.chambers.records import Chart, Counts, Wall
from symrender.chambers.rooms import height
from symrender.chambers.shades import falls_in_sight, rays_unseen, thin_out
from symrender.chambers.unseen import silhouette_unseen
from symrender.chambers.walls import (
    BALL,
    DIRECTION,
    FLOOR_CUT,
    GLEAM_EDGE,
    HIGHLIGHT,
    HORIZON,
    NORMAL,
    SILHOUETTE,
    TERMINATOR,
    TEXTURE_EDGE,
    UNBOUNDED,
    add_circle,
    add_shadow,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.scene.arrays import CHECKER, CUT, EYE, MARBLE, PHONG, STRIPES
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

FELT_END = 10.0
"""Shininess from which on the end of a highlight, a zero of that order, is not felt."""


@jitable
def set_frame(chart: Chart, mx: float, my: float, mz: float) -> None:
    """Complete the frame about chart's pole so that the lobe's axis m lies at phi = 0, and note its polar angle."""
    cx, cy, cz = chart.pole[0], chart.pole[1], chart.pole[2]
    dot = cx * mx + cy * my + cz * mz
    # m - (m.c) c by two cross products keeps its direction for nearly parallel m and c
    ax, ay, az = cy * mz - cz * my, cz * mx - cx * mz, cx * my - cy * mx
    length = math.sqrt(ax * ax + ay * ay + az * az)
    chart.lobe_beta = math.atan2(length, dot)
    chart.lobe_cos = math.cos(chart.lobe_beta)
    chart.lobe_sin = math.sin(chart.lobe_beta)
    if length > 1e-14:
        fx, fy, fz = ax / length, ay / length, az / length
        # of nearly parallel m and c the product's own rounding leans towards c
        lean = fx * cx + fy * cy + fz * cz
        fx, fy, fz = fx - lean * cx, fy - lean * cy, fz - lean * cz
        lean = 1.0 / math.sqrt(fx * fx + fy * fy + fz * fz)
        fx, fy, fz = fx * lean, fy * lean, fz * lean
    elif abs(cx) < 0.6:
        h = math.sqrt(cy * cy + cz * cz)
        fx, fy, fz = 0.0, cz / h, -cy / h
    else:
        h = math.sqrt(cx * cx + cz * cz)
        fx, fy, fz = -cz / h, 0.0, cx / h
    chart.e2[0], chart.e2[1], chart.e2[2] = fx, fy, fz
    chart.e1[0], chart.e1[1], chart.e1[2] = fy * cz - fz * cy, fz * cx - fx * cz, fx * cy - fy * cx


@jitable
def set_lens(chart: Chart) -> None:
    """Note a circle of normals that holds all of the charted sphere's visible part inside the lobe, and its ball."""
    narrow_lens(chart)
    c, s, level, r = chart.lens_cos, chart.lens_sin, chart.lens_level, chart.radius
    for a in range(3):
        chart.ball[a] = chart.center[a] + r * level * (s * chart.e1[a] - c * chart.pole[a])
    chart.ball_radius = ROUNDED_UP * r * math.sqrt(max(0.0, (1.0 - level) * (1.0 + level)))


@inlined
def narrow_lens(chart: Chart) -> None:
    """Find that circle: the visible cap's own, unless the lobe's part of it is narrower."""
    k = chart.ratio
    chart.lens_cos, chart.lens_sin, chart.lens_level = 1.0, 0.0, k
    low, high = line_range(chart)
    nearest = chart.lobe_beta - math.atan2(chart.lobe.rim_sin, chart.lobe.rim_cos)
    if nearest <= 0.0 or not low < high or high > 1.5:
        return
    first = math.asin(min(1.0, math.sin(nearest) / k)) - nearest
    last = chart.gamma_max
    middle = 0.5 * (first + last)
    c, s, turn = math.cos(middle), math.sin(middle), math.cos(high)
    widest = min(math.cos(last - middle), c * k + s * math.sin(last) * turn)
    widest = min(widest, c * math.cos(first) + s * math.sin(first) * turn)
    if widest > k:
        chart.lens_cos, chart.lens_sin, chart.lens_level = c, s, widest - 1e-9


@jitable
def add_normal(
    walls: Table[Wall], counts: Counts, chart: Chart, ax: float, ay: float, az: float, level: float, tag: int, shape:
    int
) -> None:  # fmt: skip
    """Append the circle a.N = level on the charted sphere, if it can cross its visible part inside the lobe."""
    if not abs(level) < 1.0:
        return
    # component along the visible pole -c
    a0 = -(ax * chart.pole[0] + ay * chart.pole[1] + az * chart.pole[2])
    a1 = ax * chart.e1[0] + ay * chart.e1[1] + az * chart.e1[2]
    # the circle passes the lens where their axes are as far apart as the level asks, give or take the lens's radius
    apart = a0 * chart.lens_cos + a1 * chart.lens_sin
    across = math.sqrt(max(0.0, (1.0 - apart) * (1.0 + apart)) * (1.0 - level) * (1.0 + level))
    if apart * level + across < chart.lens_level:
        return
    a2 = ax * chart.e2[0] + ay * chart.e2[1] + az * chart.e2[2]
    counts.walls = add_circle(walls, counts.walls, NORMAL, a0, a1, a2, level, tag, shape)


@jitable
def add_direction(
    walls: Table[Wall], counts: Counts, chart: Chart, ax: float, ay: float, az: float, cosine: float, tag: int, shape:
    int
) -> None:  # fmt: skip
    """Append the circle w.a = cosine on the sphere of directions."""
    a0 = ax * chart.pole[0] + ay * chart.pole[1] + az * chart.pole[2]
    a1 = ax * chart.e1[0] + ay * chart.e1[1] + az * chart.e1[2]
    a2 = ax * chart.e2[0] + ay * chart.e2[1] + az * chart.e2[2]
    counts.walls = add_circle(walls, counts.walls, DIRECTION, a0, a1, a2, cosine, tag, shape)


@inlined
def add_gleam_edge(i: int, blinn: bool, view: View, work: Work) -> None:
    """Append where the highlight of light point ``i`` begins if that is felt; ``blinn``: whether Blinn's has an end."""
    shading = view.shading
    phong = shading.model == PHONG
    if not (phong or blinn) or not shading.ks > 0.0 or not 0.0 < shading.shininess < FELT_END:
        return
    n = work.counts.walls
    work.counts.walls += 1
    if n >= work.walls.shape[0]:
        return
    row = work.walls[n]
    row.kind, row.tag, row.shape_index, row.met, row.parted = GLEAM_EDGE, HIGHLIGHT, i, 0, 0
    for a in range(3):
        row.lit_from[a] = view.points[i].position[a]
        row.seen_from[a] = view.eye[a] if shading.highlight_view == EYE else work.chart.point[a]
    row.phong = 1 if phong else 0
    work.chart.clipped = 1


@inlined
def texture_walls(sphere: Sphere, work: Work, shape: int) -> None:
    """Meridians and parallels where a checker or stripes change sign, and the seam where the chart closes."""
    kind = int(sphere.texture)
    if kind != CHECKER and kind != STRIPES and kind != MARBLE:
        return
    walls, counts, chart = work.walls, work.counts, work.chart
    ku, kv = sphere.ku, sphere.kv
    if kind == MARBLE:
        if ku != math.floor(ku):
            add_normal(walls, counts, chart, 0.0, 1.0, 0.0, 0.0, TEXTURE_EDGE, shape)
        return
    if ku > 0.0:
        for i in range(math.floor(ku) + 1):
            if work.counts.walls > work.walls.shape[0]:
                return
            a = 2.0 * math.pi * i / ku - math.pi
            add_normal(walls, counts, chart, -math.sin(a), math.cos(a), 0.0, 0.0, TEXTURE_EDGE, shape)
    if kind == CHECKER:
        i = 1
        while i < kv:
            if work.counts.walls > work.walls.shape[0]:
                return
            add_normal(walls, counts, chart, 0.0, 0.0, 1.0, math.cos(math.pi * i / kv), TEXTURE_EDGE, shape)
            i += 1


@inlined
def spheres_in_front(j: int, own: int, view: View, work: Work) -> None:
    """List the spheres that may hide some of the charted one, ``j``, and append their silhouettes and crossings."""
    walls, counts, chart, sphere = work.walls, work.counts, work.chart, view.spheres[j]
    r, px, py, pz = sphere.radius, chart.point[0], chart.point[1], chart.point[2]
    dx, dy, dz = sphere.center[0] - px, sphere.center[1] - py, sphere.center[2] - pz
    dist = math.sqrt(dx * dx + dy * dy + dz * dz)
    power = (dist - r) * (dist + r)
    for b in range(work.counts.balls):
        i = work.balls[b]
        if i in (j, own):
            continue
        s = view.spheres[i]
        ox, oy, oz = s.center[0] - px, s.center[1] - py, s.center[2] - pz
        d2 = math.sqrt(ox * ox + oy * oy + oz * oz)
        ux, uy, uz = s.center[0] - sphere.center[0], s.center[1] - sphere.center[1], s.center[2] - sphere.center[2]
        apart = math.sqrt(ux * ux + uy * uy + uz * uz)
        crossing = apart < s.radius + r
        if not crossing and (d2 - s.radius) * (d2 + s.radius) > power:
            continue
        if not casts(px, py, pz, s, chart.ball[0], chart.ball[1], chart.ball[2], chart.ball_radius):
            continue
        k2 = min(1.0, s.radius / d2)
        work.occluders[work.counts.occluders] = i
        work.counts.occluders += 1
        add_direction(
            walls, counts, chart, ox / d2, oy / d2, oz / d2, math.sqrt((1.0 - k2) * (1.0 + k2)), SILHOUETTE, i
        )  # fmt: skip
        if crossing and apart > 0.0:
            level = (apart * apart + r * r - s.radius * s.radius) / (2.0 * apart * r)
            add_normal(walls, counts, chart, ux / apart, uy / apart, uz / apart, level, SILHOUETTE, i)


@inlined
def sphere_lights(j: int, view: View, work: Work) -> None:
    """Append what the lights lay on the charted sphere, ``j``: terminators, highlights' ends, shadows and penumbrae."""
    walls, counts, chart, sphere = work.walls, work.counts, work.chart, view.spheres[j]
    r = sphere.radius
    glint = view.shading.terminator != CUT and view.shading.ks > 0.0
    for i in range(view.points.shape[0]):
        if view.points[i].radius > 0.0:
            disk_on_sphere(i, j, view, work)
            continue
        lx, ly, lz = (
            view.points[i].position[0] - sphere.center[0],
            view.points[i].position[1] - sphere.center[1],
            view.points[i].position[2] - sphere.center[2],
        )
        far = math.sqrt(lx * lx + ly * ly + lz * lz)
        if lx * lx + ly * ly + lz * lz < r * r:
            continue
        if work.counts.walls > work.walls.shape[0]:
            break
        add_normal(walls, counts, chart, lx / far, ly / far, lz / far, r / far, TERMINATOR, i)
        add_gleam_edge(i, glint or view.shading.highlight_view == EYE, view, work)
        if not glint:
            # the visible cap may lie wholly behind the terminator
            facing = -(lx * chart.pole[0] + ly * chart.pole[1] + lz * chart.pole[2]) / far
            if math.acos(max(-1.0, min(1.0, facing))) - chart.gamma_max > math.acos(min(1.0, r / far)):
                continue
        first = work.counts.casters
        for h in range(0 if is_at(view.points[i], chart) else view.spheres.shape[0]):
            s = view.spheres[h]
            if h != j and casts(
                view.points[i].position[0], view.points[i].position[1], view.points[i].position[2], s, chart.ball[0],
                chart.ball[1], chart.ball[2], chart.ball_radius,
            ) and shadow_in_view(-lx, -ly, -lz, s, sphere, glint, chart):  # fmt: skip
                caster = work.casters[work.counts.casters]
                caster.light, caster.ball, caster.unseen = i, h, 0
                work.counts.casters += 1
        for c in range(first, work.counts.casters):
            s = view.spheres[work.casters[c].ball]
            if not rays_unseen(c, first, view, work):
                work.counts.walls = add_shadow(
                    work.walls, work.counts.walls, chart, -lx, -ly, -lz, sphere.center[0] - s.center[0],
                    sphere.center[1] - s.center[1], sphere.center[2] - s.center[2], s.radius, work.casters[c].ball, i,
                )  # fmt: skip


@jitable
def sphere_chart(j: int, own: int, lobe: Array, view: View, work: Work) -> None:
    """Fill ``work`` for sphere ``j`` seen from the chart's point; ``lobe`` the mirror direction; ``own`` P's sphere.

    P must be outside every sphere but its own.
    """
    walls, counts, chart = work.walls, work.counts, work.chart
    sphere = view.spheres[j]
    r = sphere.radius
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    dx, dy, dz = sphere.center[0] - px, sphere.center[1] - py, sphere.center[2] - pz
    dist = math.sqrt(dx * dx + dy * dy + dz * dz)
    k = min(r / dist, 1.0 - 1e-15)
    chart.pole[0], chart.pole[1], chart.pole[2] = dx / dist, dy / dist, dz / dist
    chart.center[0], chart.center[1], chart.center[2] = sphere.center[0], sphere.center[1], sphere.center[2]
    chart.radius, chart.ratio, chart.shape_index, chart.plane = r, k, j, -1
    chart.beta_max, chart.gamma_max = math.asin(k), math.acos(k)
    chart.bright = UNBOUNDED
    chart.clipped = 0
    chart.limb_tangent = math.sqrt((1.0 - k) / (1.0 + k))
    set_frame(chart, lobe[0], lobe[1], lobe[2])
    set_lens(chart)
    work.counts.walls = work.counts.occluders = work.counts.casters = 0

    # the plane through P that bounds what its surface can see cuts the sphere in a circle
    nx, ny, nz = chart.normal[0], chart.normal[1], chart.normal[2]
    add_normal(walls, counts, chart, nx, ny, nz, -(nx * dx + ny * dy + nz * dz) / r, HORIZON, -1)
    for side in range(view.sides.shape[0]):
        up = view.sides[side].up
        above = height(view.sides[side], sphere.center[0], sphere.center[1], sphere.center[2])
        add_normal(walls, counts, chart, up[0], up[1], up[2], -above / r, FLOOR_CUT, side)

    spheres_in_front(j, own, view, work)
    texture_walls(sphere, work, j)

    sphere_lights(j, view, work)
    note_reach(view, work)


@jitable
def floor_chart(plane: int, own: int, lobe: Array, view: View, work: Work) -> None:
    """Fill ``work`` for a plane seen from the chart's point, which is off it: polar about the nadir.

    ``view``, the chart's point and normal and ``lobe`` are in the plane's coordinates (``Frames.views``).
    """
    walls, counts, chart = work.walls, work.counts, work.chart
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    chart.side = work.room[plane]
    chart.pole[0], chart.pole[1], chart.pole[2] = 0.0, 0.0, -chart.side
    chart.radius, chart.ratio, chart.shape_index, chart.plane = 0.0, 1.0, -1, plane
    chart.beta_max = chart.gamma_max = 0.5 * math.pi
    chart.height = abs(pz)
    chart.bright = UNBOUNDED
    chart.clipped = 0
    set_frame(chart, lobe[0], lobe[1], lobe[2])
    work.counts.walls = work.counts.occluders = work.counts.casters = 0
    add_direction(
        walls, counts, chart, chart.normal[0], chart.normal[1], chart.normal[2], 0.0, HORIZON, -1
    )  # fmt: skip
    for side in range(view.sides.shape[0]):
        # the edge in which another plane meets this one lies in a plane through P; that of P's own is the horizon
        up = view.sides[side].up
        above = height(view.sides[side], px, py, pz)
        across = math.hypot(pz * up[0], pz * up[1])
        if side not in (plane, chart.home) and across > 0.0:
            x, y, z = -pz * up[0], -pz * up[1], above - pz * up[2]
            size = math.hypot(across, z)
            add_direction(walls, counts, chart, x / size, y / size, z / size, 0.0, FLOOR_CUT, side)
    for b in range(work.counts.balls):
        s = view.spheres[work.balls[b]]
        if chart.side * s.center[2] > -s.radius:
            work.occluders[work.counts.occluders] = work.balls[b]
            work.counts.occluders += 1
    for o in range(work.counts.occluders):
        i = work.occluders[o]
        s = view.spheres[i]
        ox, oy, oz = s.center[0] - px, s.center[1] - py, s.center[2] - pz
        far = math.sqrt(ox * ox + oy * oy + oz * oz)
        k = min(1.0, s.radius / far)
        if not silhouette_unseen(ox / far, oy / far, oz / far, k, lobe, view, work):
            add_direction(
                walls, counts, chart, ox / far, oy / far, oz / far, math.sqrt((1.0 - k) * (1.0 + k)), SILHOUETTE, i
            )  # fmt: skip
        if abs(s.center[2]) < s.radius and work.counts.walls < work.walls.shape[0]:
            row = work.walls[work.counts.walls]
            row.kind, row.tag, row.shape_index, row.met, row.parted = BALL, SILHOUETTE, i, 0, 0
            row.foot[0] = ox * chart.e1[0] + oy * chart.e1[1]
            row.foot[1] = ox * chart.e2[0] + oy * chart.e2[1]
            row.power = ox * ox + oy * oy - (s.radius - s.center[2]) * (s.radius + s.center[2])
            work.counts.walls += 1
    if chart.side >= 0.0:
        floor_lights(lobe, view, work)
    note_reach(view, work)


@inlined
def floor_lights(lobe: Array, view: View, work: Work) -> None:
    """Append what the lights lay on the floor: highlights' ends, shadows and penumbrae, and what casts them."""
    walls, chart = work.walls, work.chart
    px, py = chart.point[0], chart.point[1]
    for i in range(view.points.shape[0]):
        if view.points[i].radius > 0.0:
            disk_on_floor(i, lobe, view, work)
            continue
        if view.points[i].position[2] <= 0.0:
            continue
        add_gleam_edge(i, view.shading.highlight_view == EYE and view.eye[2] <= 0.0, view, work)
        ux, uy, uz = px - view.points[i].position[0], py - view.points[i].position[1], -view.points[i].position[2]
        first = work.counts.casters
        for h in range(0 if is_at(view.points[i], chart) else view.spheres.shape[0]):
            s = view.spheres[h]
            if s.center[2] <= -s.radius or s.center[2] - s.radius >= view.points[i].position[2]:
                continue
            if falls_in_sight(i, s, lobe, view, work):
                caster = work.casters[work.counts.casters]
                caster.light, caster.ball, caster.unseen = i, h, 0
                work.counts.casters += 1
        thin_out(first, lobe, view, work)
        for c in range(first, work.counts.casters):
            if work.casters[c].unseen == 1:
                continue
            h = work.casters[c].ball
            s = view.spheres[h]
            work.counts.walls = add_shadow(
                walls, work.counts.walls, chart, ux, uy, uz, px - s.center[0], py - s.center[1], -s.center[2], s.radius,
                h, i,
            )  # fmt: skip
