"""The chart of one visible shape from one point: frame, walls, occluders, shadow casters."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import line_range
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.penumbra_walls import disk_on_floor, disk_on_sphere
from symrender.chambers.walls import (
    BALL,
    BETA_MAX,
    BRIGHT,
    CENTER,
    CLIPPED,
    DIRECTION,
    E1,
    E2,
    FLOOR_CUT,
    GAMMA_MAX,
    GLEAM_EDGE,
    HEIGHT,
    HIGHLIGHT,
    HORIZON,
    KIND,
    LENS_COS,
    LIMB_TANGENT,
    LOBE_BETA,
    MET_COLUMN,
    NORMAL,
    POINT,
    POLE,
    RADIUS,
    RATIO,
    RIM_COS,
    RIM_SIN,
    SHAPE,
    SHAPE_INDEX,
    SIDE,
    SILHOUETTE,
    SURFACE_NORMAL,
    TAG,
    TERMINATOR,
    TEXTURE_EDGE,
    UNBOUNDED,
    add_circle,
    add_shadow,
)
from symrender.chambers.work import CASTERS, OCCLUDERS, WALLS, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.scene.arrays import CHECKER, CUT, EYE, FLOOR_PRESENT, MARBLE, PHONG, STRIPES

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

FELT_END = 10.0
"""Shininess from which on the end of a highlight, a zero of that order, is not felt."""


@jitable
def set_frame(geo: Array, mx: float, my: float, mz: float) -> None:
    """Complete the frame about geo's pole so that the lobe's axis m lies at phi = 0, and note its polar angle."""
    cx, cy, cz = geo[POLE], geo[POLE + 1], geo[POLE + 2]
    dot = cx * mx + cy * my + cz * mz
    # m - (m.c) c by two cross products keeps its direction for nearly parallel m and c
    ax, ay, az = cy * mz - cz * my, cz * mx - cx * mz, cx * my - cy * mx
    length = math.sqrt(ax * ax + ay * ay + az * az)
    geo[LOBE_BETA] = math.atan2(length, dot)
    geo[LOBE_BETA + 1] = math.cos(geo[LOBE_BETA])
    geo[LOBE_BETA + 2] = math.sin(geo[LOBE_BETA])
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
    geo[E2], geo[E2 + 1], geo[E2 + 2] = fx, fy, fz
    geo[E1], geo[E1 + 1], geo[E1 + 2] = fy * cz - fz * cy, fz * cx - fx * cz, fx * cy - fy * cx


@jitable
def set_lens(geo: Array) -> None:
    """Note a circle of normals that holds all of the charted sphere's visible part inside the lobe."""
    k = geo[RATIO]
    geo[LENS_COS], geo[LENS_COS + 1], geo[LENS_COS + 2] = 1.0, 0.0, k
    low, high = line_range(geo)
    nearest = geo[LOBE_BETA] - math.atan2(geo[RIM_SIN], geo[RIM_COS])
    if nearest <= 0.0 or not low < high or high > 1.5:
        return
    first = math.asin(min(1.0, math.sin(nearest) / k)) - nearest
    last = geo[GAMMA_MAX]
    middle = 0.5 * (first + last)
    c, s, turn = math.cos(middle), math.sin(middle), math.cos(high)
    widest = min(math.cos(last - middle), c * k + s * math.sin(last) * turn)
    widest = min(widest, c * math.cos(first) + s * math.sin(first) * turn)
    if widest > k:
        geo[LENS_COS], geo[LENS_COS + 1], geo[LENS_COS + 2] = c, s, widest - 1e-9


@jitable
def add_normal(
    walls: Array, counts: Ints, geo: Array, ax: float, ay: float, az: float, level: float, tag: int, shape: int
) -> None:  # fmt: skip
    """Append the circle a.N = level on the charted sphere, if it can cross its visible part inside the lobe."""
    if not abs(level) < 1.0:
        return
    # component along the visible pole -c
    a0 = -(ax * geo[POLE] + ay * geo[POLE + 1] + az * geo[POLE + 2])
    a1 = ax * geo[E1] + ay * geo[E1 + 1] + az * geo[E1 + 2]
    # the circle passes the lens where their axes are as far apart as the level asks, give or take the lens's radius
    apart = a0 * geo[LENS_COS] + a1 * geo[LENS_COS + 1]
    across = math.sqrt(max(0.0, (1.0 - apart) * (1.0 + apart)) * (1.0 - level) * (1.0 + level))
    if apart * level + across < geo[LENS_COS + 2]:
        return
    a2 = ax * geo[E2] + ay * geo[E2 + 1] + az * geo[E2 + 2]
    counts[WALLS] = add_circle(walls, counts[WALLS], NORMAL, a0, a1, a2, level, tag, shape)


@jitable
def add_direction(
    walls: Array, counts: Ints, geo: Array, ax: float, ay: float, az: float, cosine: float, tag: int, shape: int
) -> None:  # fmt: skip
    """Append the circle w.a = cosine on the sphere of directions."""
    a0 = ax * geo[POLE] + ay * geo[POLE + 1] + az * geo[POLE + 2]
    a1 = ax * geo[E1] + ay * geo[E1 + 1] + az * geo[E1 + 2]
    a2 = ax * geo[E2] + ay * geo[E2 + 1] + az * geo[E2 + 2]
    counts[WALLS] = add_circle(walls, counts[WALLS], DIRECTION, a0, a1, a2, cosine, tag, shape)


@inlined
def add_gleam_edge(i: int, blinn: bool, view: View, work: Work) -> None:
    """Append where the highlight of light point ``i`` begins if that is felt; ``blinn``: whether Blinn's has an end."""
    shading = view.shading
    phong = shading[4] == PHONG
    if not (phong or blinn) or not shading[2] > 0.0 or not 0.0 < shading[3] < FELT_END:
        return
    n = work.counts[WALLS]
    work.counts[WALLS] += 1
    if n >= work.walls.shape[0]:
        return
    row = work.walls[n]
    row[KIND], row[TAG], row[SHAPE], row[MET_COLUMN] = GLEAM_EDGE, HIGHLIGHT, i, 0.0
    for a in range(3):
        row[8 + a] = view.points[i, a]
        row[11 + a] = view.eye[a] if shading[5] == EYE else work.geo[POINT + a]
    row[14] = 1.0 if phong else 0.0
    work.geo[CLIPPED] = 1.0


@inlined
def texture_walls(sphere: Array, work: Work, shape: int) -> None:
    """Meridians and parallels where a checker or stripes change sign, and the seam where the chart closes."""
    kind = int(sphere[7])
    if kind != CHECKER and kind != STRIPES and kind != MARBLE:
        return
    walls, counts, geo = work.walls, work.counts, work.geo
    ku, kv = sphere[8], sphere[9]
    if kind == MARBLE:
        if ku != math.floor(ku):
            add_normal(walls, counts, geo, 0.0, 1.0, 0.0, 0.0, TEXTURE_EDGE, shape)
        return
    if ku > 0.0:
        for i in range(math.floor(ku) + 1):
            if work.counts[WALLS] > work.walls.shape[0]:
                return
            a = 2.0 * math.pi * i / ku - math.pi
            add_normal(walls, counts, geo, -math.sin(a), math.cos(a), 0.0, 0.0, TEXTURE_EDGE, shape)
    if kind == CHECKER:
        i = 1
        while i < kv:
            if work.counts[WALLS] > work.walls.shape[0]:
                return
            add_normal(walls, counts, geo, 0.0, 0.0, 1.0, math.cos(math.pi * i / kv), TEXTURE_EDGE, shape)
            i += 1


@jitable
def sphere_chart(j: int, own: int, lobe: Array, view: View, work: Work) -> None:
    """Fill ``work`` for sphere ``j`` seen from geo's point; ``lobe`` the mirror direction; ``own`` P's sphere.

    P must be outside every sphere but its own.
    """
    walls, counts, geo = work.walls, work.counts, work.geo
    sphere = view.spheres[j]
    r = sphere[3]
    px, py, pz = geo[POINT], geo[POINT + 1], geo[POINT + 2]
    dx, dy, dz = sphere[0] - px, sphere[1] - py, sphere[2] - pz
    dist = math.sqrt(dx * dx + dy * dy + dz * dz)
    k = min(r / dist, 1.0 - 1e-15)
    geo[POLE], geo[POLE + 1], geo[POLE + 2] = dx / dist, dy / dist, dz / dist
    geo[CENTER], geo[CENTER + 1], geo[CENTER + 2] = sphere[0], sphere[1], sphere[2]
    geo[RADIUS], geo[RATIO], geo[SHAPE_INDEX] = r, k, j
    geo[BETA_MAX], geo[GAMMA_MAX] = math.asin(k), math.acos(k)
    geo[BRIGHT] = UNBOUNDED
    geo[CLIPPED] = 0.0
    geo[LIMB_TANGENT] = math.sqrt((1.0 - k) / (1.0 + k))
    set_frame(geo, lobe[0], lobe[1], lobe[2])
    set_lens(geo)
    work.counts[WALLS] = work.counts[OCCLUDERS] = work.counts[CASTERS] = 0

    # the plane through P that bounds what its surface can see cuts the sphere in a circle
    nx, ny, nz = geo[SURFACE_NORMAL], geo[SURFACE_NORMAL + 1], geo[SURFACE_NORMAL + 2]
    add_normal(walls, counts, geo, nx, ny, nz, -(nx * dx + ny * dy + nz * dz) / r, HORIZON, -1)
    floor = view.floor[FLOOR_PRESENT] != 0.0
    if floor:
        add_normal(walls, counts, geo, 0.0, 0.0, 1.0, -sphere[2] / r, FLOOR_CUT, -1)

    # spheres in front
    power = (dist - r) * (dist + r)
    for i in range(view.spheres.shape[0]):
        if i in (j, own):
            continue
        s = view.spheres[i]
        ox, oy, oz = s[0] - px, s[1] - py, s[2] - pz
        d2 = math.sqrt(ox * ox + oy * oy + oz * oz)
        ux, uy, uz = s[0] - sphere[0], s[1] - sphere[1], s[2] - sphere[2]
        apart = math.sqrt(ux * ux + uy * uy + uz * uz)
        crossing = apart < s[3] + r
        if not crossing and (d2 - s[3]) * (d2 + s[3]) > power:
            continue
        k2 = min(1.0, s[3] / d2)
        cosine = (ox * dx + oy * dy + oz * dz) / (d2 * dist)
        if math.acos(max(-1.0, min(1.0, cosine))) >= geo[BETA_MAX] + math.asin(k2):
            continue
        work.occluders[work.counts[OCCLUDERS]] = i
        work.counts[OCCLUDERS] += 1
        add_direction(
            walls, counts, geo, ox / d2, oy / d2, oz / d2, math.sqrt((1.0 - k2) * (1.0 + k2)), SILHOUETTE, i
        )  # fmt: skip
        if crossing and apart > 0.0:
            level = (apart * apart + r * r - s[3] * s[3]) / (2.0 * apart * r)
            add_normal(walls, counts, geo, ux / apart, uy / apart, uz / apart, level, SILHOUETTE, i)

    texture_walls(sphere, work, j)

    glint = view.shading[6] != CUT and view.shading[2] > 0.0
    for i in range(view.points.shape[0]):
        if view.points[i, DISK_RADIUS] > 0.0:
            disk_on_sphere(i, j, view, work)
            continue
        lx, ly, lz = view.points[i, 0] - sphere[0], view.points[i, 1] - sphere[1], view.points[i, 2] - sphere[2]
        far = math.sqrt(lx * lx + ly * ly + lz * lz)
        if lx * lx + ly * ly + lz * lz < r * r:
            continue
        if work.counts[WALLS] > work.walls.shape[0]:
            break
        add_normal(walls, counts, geo, lx / far, ly / far, lz / far, r / far, TERMINATOR, i)
        add_gleam_edge(i, glint or view.shading[5] == EYE, view, work)
        if not glint:
            # the visible cap may lie wholly behind the terminator
            facing = -(lx * geo[POLE] + ly * geo[POLE + 1] + lz * geo[POLE + 2]) / far
            if math.acos(max(-1.0, min(1.0, facing))) - geo[GAMMA_MAX] > math.acos(min(1.0, r / far)):
                continue
        for h in range(view.spheres.shape[0]):
            if h == j:
                continue
            s = view.spheres[h]
            if casts(view.points[i, 0], view.points[i, 1], view.points[i, 2], s, sphere) and shadow_in_view(
                -lx, -ly, -lz, s, sphere, glint, geo
            ):
                work.casters[work.counts[CASTERS], 0] = i
                work.casters[work.counts[CASTERS], 1] = h
                work.counts[CASTERS] += 1
                work.counts[WALLS] = add_shadow(
                    work.walls, work.counts[WALLS], geo, -lx, -ly, -lz,
                    sphere[0] - s[0], sphere[1] - s[1], sphere[2] - s[2], s[3], h, i,
                )  # fmt: skip


@jitable
def floor_chart(own: int, lobe: Array, view: View, work: Work) -> None:
    """Fill ``work`` for the floor seen from geo's point, which is off the floor: polar about the nadir."""
    walls, counts, geo = work.walls, work.counts, work.geo
    px, py, pz = geo[POINT], geo[POINT + 1], geo[POINT + 2]
    geo[POLE], geo[POLE + 1], geo[POLE + 2] = 0.0, 0.0, -geo[SIDE]
    geo[RADIUS], geo[RATIO], geo[SHAPE_INDEX] = 0.0, 1.0, -1.0
    geo[BETA_MAX] = geo[GAMMA_MAX] = 0.5 * math.pi
    geo[HEIGHT] = abs(pz)
    geo[BRIGHT] = UNBOUNDED
    geo[CLIPPED] = 0.0
    set_frame(geo, lobe[0], lobe[1], lobe[2])
    work.counts[WALLS] = work.counts[OCCLUDERS] = work.counts[CASTERS] = 0
    add_direction(
        walls, counts, geo, geo[SURFACE_NORMAL], geo[SURFACE_NORMAL + 1], geo[SURFACE_NORMAL + 2], 0.0, HORIZON, -1
    )  # fmt: skip
    for i in range(view.spheres.shape[0]):
        s = view.spheres[i]
        if i == own or geo[SIDE] * s[2] <= -s[3]:
            continue
        ox, oy, oz = s[0] - px, s[1] - py, s[2] - pz
        far = math.sqrt(ox * ox + oy * oy + oz * oz)
        k = min(1.0, s[3] / far)
        work.occluders[work.counts[OCCLUDERS]] = i
        work.counts[OCCLUDERS] += 1
        add_direction(
            walls, counts, geo, ox / far, oy / far, oz / far, math.sqrt((1.0 - k) * (1.0 + k)), SILHOUETTE, i
        )  # fmt: skip
        if abs(s[2]) < s[3] and work.counts[WALLS] < work.walls.shape[0]:
            row = work.walls[work.counts[WALLS]]
            row[0], row[6], row[7], row[MET_COLUMN] = BALL, SILHOUETTE, i, 0.0
            row[1] = ox * geo[E1] + oy * geo[E1 + 1]
            row[2] = ox * geo[E2] + oy * geo[E2 + 1]
            row[3] = ox * ox + oy * oy - (s[3] - s[2]) * (s[3] + s[2])
            work.counts[WALLS] += 1
    if geo[SIDE] < 0.0:
        return
    for i in range(view.points.shape[0]):
        if view.points[i, DISK_RADIUS] > 0.0:
            disk_on_floor(i, view, work)
            continue
        if view.points[i, 2] <= 0.0:
            continue
        add_gleam_edge(i, view.shading[5] == EYE and view.eye[2] <= 0.0, view, work)
        ux, uy, uz = px - view.points[i, 0], py - view.points[i, 1], -view.points[i, 2]
        for h in range(view.spheres.shape[0]):
            s = view.spheres[h]
            if s[2] <= -s[3] or s[2] - s[3] >= view.points[i, 2]:
                continue
            work.casters[work.counts[CASTERS], 0] = i
            work.casters[work.counts[CASTERS], 1] = h
            work.counts[CASTERS] += 1
            work.counts[WALLS] = add_shadow(
                work.walls, work.counts[WALLS], geo, ux, uy, uz, px - s[0], py - s[1], -s[2], s[3], h, i
            )


@jitable
def casts(lx: float, ly: float, lz: float, caster: Array, receiver: Array) -> bool:
    """Whether a sphere can shadow some point of another one from the light point l."""
    ax, ay, az = caster[0] - lx, caster[1] - ly, caster[2] - lz
    bx, by, bz = receiver[0] - lx, receiver[1] - ly, receiver[2] - lz
    a, b = math.sqrt(ax * ax + ay * ay + az * az), math.sqrt(bx * bx + by * by + bz * bz)
    if a <= caster[3] or b <= receiver[3]:
        return True
    if a - caster[3] > b + receiver[3]:
        return False
    # less than asin(p) + asin(q) apart, by the cosine of that sum
    p, q = caster[3] / a, receiver[3] / b
    apart = math.sqrt((1.0 - p) * (1.0 + p) * (1.0 - q) * (1.0 + q)) - p * q
    return bool(ax * bx + ay * by + az * bz > a * b * apart)


@jitable
def shadow_in_view(
    ux: float, uy: float, uz: float, caster: Array, receiver: Array, behind: bool, geo: Array
) -> bool:  # fmt: skip
    """Whether a shadow on the charted sphere can reach its visible cap N.p >= k; ``u`` is its centre minus the light.

    With e the shadow's axis and a its half-angle, the part of N across e lies within tan(a) (|u| + R)/R of where the
    axis passes. Where the surface faces the light N.e is at most sin(a); ``behind`` asks for shadows beyond the
    terminator too, where it has no bound.
    """
    gx, gy, gz = receiver[0] - caster[0], receiver[1] - caster[1], receiver[2] - caster[2]
    ex, ey, ez = ux - gx, uy - gy, uz - gz
    dist = math.sqrt(ex * ex + ey * ey + ez * ez)
    if dist <= caster[3]:
        return True
    ex, ey, ez = ex / dist, ey / dist, ez / dist
    r = receiver[3]
    tangent = caster[3] / math.sqrt((dist - caster[3]) * (dist + caster[3]))
    reach = tangent * (math.sqrt(ux * ux + uy * uy + uz * uz) + r) / r
    along = gx * ex + gy * ey + gz * ez
    # the axis relative to the receiver's centre, across e
    hx, hy, hz = -(gx - along * ex) / r, -(gy - along * ey) / r, -(gz - along * ez) / r
    px, py, pz = -geo[POLE], -geo[POLE + 1], -geo[POLE + 2]
    facing = -(ex * px + ey * py + ez * pz)
    h = math.sqrt(hx * hx + hy * hy + hz * hz)
    low, high = min(1.0, max(0.0, h - reach)), min(1.0, h + reach)
    longest, shortest = math.sqrt((1.0 - low) * (1.0 + low)), math.sqrt((1.0 - high) * (1.0 + high))
    along_axis = 1.0 if behind else caster[3] / dist
    # -N.e lies in [shortest, longest] or, away from the light, in [-along_axis, -shortest]
    if facing > 0.0:
        depth = facing * longest
    elif shortest <= along_axis:
        depth = -facing * min(along_axis, longest)
    else:
        depth = facing * shortest
    across = reach * math.sqrt(max(0.0, 1.0 - facing * facing))
    return bool(hx * px + hy * py + hz * pz + across + depth > geo[RATIO])
