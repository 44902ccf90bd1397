"""What walls cut off, asked of every node of a lattice on a sphere: occlusion, texture, terminators and shadows.

The conditions are those of ``chambers/labels.py`` as arithmetic without branches, over rows of ``Work.nodes``, so that
loops over nodes become vector instructions; shapes and lights that cannot matter at all are left out beforehand.
Textures that are no product of planes are asked node by node.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.labels import texture_side
from symrender.chambers.listed import casts, shadow_in_view
from symrender.chambers.work import View, Work
from symrender.jit.marks import jitable
from symrender.leaves.values import marble
from symrender.scene.arrays import CHECKER, CUT, MARBLE, STRIPES

BATCH: Final = 128
"""Nodes evaluated together."""
PLANES: Final = 40
"""Most texture planes whose product tells a side; with more the side is asked of every node."""


@jitable
def hide_nodes(m: int, j: int, own: int, view: View, work: Work) -> None:
    """``weight`` 0 where another sphere is in front of sphere ``j``."""
    m = min(m, BATCH)
    chart, b = work.chart, work.nodes
    px, py, pz, k = chart.point[0], chart.point[1], chart.point[2], chart.ratio
    for h in range(view.spheres.shape[0]):
        if h in (j, own):
            continue
        ox, oy, oz = view.spheres[h].center[0] - px, view.spheres[h].center[1] - py, view.spheres[h].center[2] - pz
        d2 = ox * ox + oy * oy + oz * oz
        dist, r2 = math.sqrt(d2), view.spheres[h].radius ** 2
        k2 = min(1.0, view.spheres[h].radius / dist)
        # the two discs are apart: the cosine of the sum of their radii
        both = math.sqrt((1.0 - k) * (1.0 + k) * (1.0 - k2) * (1.0 + k2)) - k * k2
        if ox * chart.pole[0] + oy * chart.pole[1] + oz * chart.pole[2] <= dist * both:
            continue
        for i in range(m):
            lx, ly, lz = b.place[0, i] - px, b.place[1, i] - py, b.place[2, i] - pz
            l2, dot = lx * lx + ly * ly + lz * lz, lx * ox + ly * oy + lz * oz
            ex, ey, ez = lx - ox, ly - oy, lz - oz
            clear = 0.0 if dot * dot > l2 * (d2 - r2) else 1.0
            clear = clear if dot > 0.0 else 1.0
            clear = clear if dot < l2 else 1.0
            b.weight[i] *= clear if ex * ex + ey * ey + ez * ez >= r2 else 0.0


@jitable
def wall_off_nodes(m: int, view: View, work: Work) -> None:
    """``weight`` 0 beyond the planes of P's room."""
    m = min(m, BATCH)
    b = work.nodes
    for k in range(view.sides.shape[0]):
        side, room = view.sides[k], work.room[k]
        ux, uy, uz, level = room * side.up[0], room * side.up[1], room * side.up[2], room * side.level
        for i in range(m):
            above = ux * b.place[0, i] + uy * b.place[1, i] + uz * b.place[2, i] - level
            b.weight[i] *= 1.0 if above >= 0.0 else 0.0


@jitable
def tint_nodes(m: int, j: int, view: View, work: Work) -> None:
    """``factor`` of the nodes: kd times the albedo."""
    m = min(m, BATCH)
    b, sphere = work.nodes, view.spheres[j]
    kind, ku, kv, dark = int(sphere.texture), sphere.ku, sphere.kv, sphere.dark
    for i in range(m):
        b.inner[i] = 1.0
    if kind == MARBLE:
        for i in range(m):
            b.inner[i] = marble(b.normal[0, i], b.normal[1, i], b.normal[2, i], ku, kv)
    elif kind in (CHECKER, STRIPES):
        down = kv if kind == CHECKER else 1.0
        planes = ku % 2.0 == 0.0 and ku > 0.0 and down % 1.0 == 0.0 and down > 0.0 and 0.5 * ku + down <= PLANES
        if planes:
            # the sides of meridians and parallels, turned from one to the next
            c, s = -1.0, 0.0
            c1, s1 = math.cos(2.0 * math.pi / ku), math.sin(2.0 * math.pi / ku)
            for _ in range(int(0.5 * ku)):
                for i in range(m):
                    b.inner[i] *= c * b.normal[1, i] - s * b.normal[0, i]
                c, s = c * c1 - s * s1, s * c1 + c * s1
            c1, s1 = math.cos(math.pi / down), math.sin(math.pi / down)
            c, s = c1, s1
            for _ in range(int(down) - 1):
                for i in range(m):
                    b.inner[i] *= b.normal[2, i] - c
                c, s = c * c1 - s * s1, s * c1 + c * s1
            # the field that begins at -pi and at the upper pole is bright
            sign = 1.0 if int(0.5 * ku) % 2 == 1 else -1.0
            for i in range(m):
                b.inner[i] = 1.0 if sign * b.inner[i] >= 0.0 else dark
        else:
            for i in range(m):
                bright = texture_side(view.spheres, j, b.normal[0, i], b.normal[1, i], b.normal[2, i])
                b.inner[i] = 1.0 if bright == 1 else dark
    red, green, blue = (
        view.shading.kd * sphere.color[0],
        view.shading.kd * sphere.color[1],
        view.shading.kd * sphere.color[2],
    )
    for i in range(m):
        f = b.inner[i]
        b.factor[0, i], b.factor[1, i], b.factor[2, i] = f * red, f * green, f * blue


@jitable
def mark_nodes(m: int, l: int, j: int, view: View, work: Work) -> bool:
    """Fill ``clear`` and ``shining`` of light ``l`` on sphere ``j``; False where no node that P may see is lit."""
    m = min(m, BATCH)
    chart, b = work.chart, work.nodes
    x, y, z = view.points[l].position[0], view.points[l].position[1], view.points[l].position[2]
    for side in range(view.sides.shape[0]):
        if view.over[side, l] * work.room[side] < 0.0:
            return False
    sphere = view.spheres[j]
    lx, ly, lz = x - sphere.center[0], y - sphere.center[1], z - sphere.center[2]
    far, k = math.sqrt(lx * lx + ly * ly + lz * lz), chart.ratio
    if lx * lx + ly * ly + lz * lz < sphere.radius * sphere.radius:
        return False
    open_light = view.shading.terminator != CUT and view.shading.ks > 0.0
    if not open_light:
        # the caps of normals that P sees, N.p >= k, and that the light does are apart
        facing = -(lx * chart.pole[0] + ly * chart.pole[1] + lz * chart.pole[2]) / far
        lit = min(1.0, sphere.radius / far)
        if facing <= k * lit - math.sqrt((1.0 - k) * (1.0 + k) * (1.0 - lit) * (1.0 + lit)):
            return False
    for i in range(m):
        ax, ay, az = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
        dot = ax * b.normal[0, i] + ay * b.normal[1, i] + az * b.normal[2, i]
        b.clear[i] = 1.0 if dot > 0.0 else 0.0
        b.shining[i] = 1.0
    if not open_light:
        for i in range(m):
            b.shining[i] = b.clear[i]
    for h in range(view.spheres.shape[0]):
        if h == j:
            continue
        caster = view.spheres[h]
        cx, cy, cz, r2 = caster.center[0], caster.center[1], caster.center[2], caster.radius * caster.radius
        if (cx - x) ** 2 + (cy - y) ** 2 + (cz - z) ** 2 < r2:
            return False
        if not (
            casts(x, y, z, caster, sphere.center[0], sphere.center[1], sphere.center[2], sphere.radius)
            and shadow_in_view(-lx, -ly, -lz, caster, sphere, open_light, chart)
        ):
            continue
        for i in range(m):
            qx, qy, qz = b.place[0, i], b.place[1, i], b.place[2, i]
            ax, ay, az = x - qx, y - qy, z - qz
            fx, fy, fz = cx - qx, cy - qy, cz - qz
            a2, dot = ax * ax + ay * ay + az * az, ax * fx + ay * fy + az * fz
            clear = 0.0 if dot * dot > a2 * (fx * fx + fy * fy + fz * fz - r2) else 1.0
            clear = clear if dot > 0.0 else 1.0
            clear = clear if dot < a2 else 1.0
            b.clear[i] *= clear
            b.shining[i] *= clear
    return True
