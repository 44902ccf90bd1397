"""What walls cut off, asked of every node of a lattice on a sphere: occlusion, texture, terminators and shadows.

The conditions are those of ``chambers/labels.py`` as arithmetic without branches, over rows of ``Work.nodes``, so that
loops over nodes become vector instructions; shapes and lights that cannot matter at all are left out beforehand.
Textures that are no product of planes are asked node by node.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.chart import casts, shadow_in_view
from symrender.chambers.labels import texture_side
from symrender.chambers.walls import POINT, POLE, RATIO, SIDE
from symrender.chambers.work import NODES, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.light_term import marble_factor
from symrender.quadrature.node_rows import CLEAR, FACTOR, INNER, NORMAL, PLACE, SHINING, WEIGHT
from symrender.scene.arrays import CHECKER, CUT, FLOOR_PRESENT, MARBLE, STRIPES

BATCH: Final = 128
"""Nodes evaluated together."""
PLANES: Final = 40
"""Most texture planes whose product tells a side; with more the side is asked of every node."""


@jitable
def hide_nodes(m: int, j: int, own: int, view: View, work: Work) -> None:
    """WEIGHT 0 where another sphere is in front of sphere ``j``."""
    m = min(m, BATCH)
    geo, b = work.geo, work.nodes
    px, py, pz, k = geo[POINT], geo[POINT + 1], geo[POINT + 2], geo[RATIO]
    for h in range(view.spheres.shape[0]):
        if h in (j, own):
            continue
        ox, oy, oz = view.spheres[h, 0] - px, view.spheres[h, 1] - py, view.spheres[h, 2] - pz
        d2 = ox * ox + oy * oy + oz * oz
        dist, r2 = math.sqrt(d2), view.spheres[h, 3] ** 2
        k2 = min(1.0, view.spheres[h, 3] / dist)
        # the two discs are apart: the cosine of the sum of their radii
        both = math.sqrt((1.0 - k) * (1.0 + k) * (1.0 - k2) * (1.0 + k2)) - k * k2
        if ox * geo[POLE] + oy * geo[POLE + 1] + oz * geo[POLE + 2] <= dist * both:
            continue
        for i in range(m):
            lx, ly, lz = b[PLACE + i] - px, b[PLACE + NODES + i] - py, b[PLACE + 2 * NODES + i] - pz
            l2, dot = lx * lx + ly * ly + lz * lz, lx * ox + ly * oy + lz * oz
            ex, ey, ez = lx - ox, ly - oy, lz - oz
            clear = 0.0 if dot * dot > l2 * (d2 - r2) else 1.0
            clear = clear if dot > 0.0 else 1.0
            clear = clear if dot < l2 else 1.0
            b[WEIGHT + i] *= clear if ex * ex + ey * ey + ez * ez >= r2 else 0.0


@jitable
def tint_nodes(m: int, j: int, view: View, work: Work) -> None:
    """FACTOR of the nodes: kd times the albedo."""
    m = min(m, BATCH)
    b, sphere = work.nodes, view.spheres[j]
    kind, ku, kv, dark = int(sphere[7]), sphere[8], sphere[9], sphere[10]
    for i in range(m):
        b[INNER + i] = 1.0
    if kind == MARBLE:
        for i in range(m):
            b[INNER + i] = marble_factor(b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i], ku, kv)
    elif kind in (CHECKER, STRIPES):
        down = kv if kind == CHECKER else 1.0
        planes = ku % 2.0 == 0.0 and ku > 0.0 and down % 1.0 == 0.0 and down > 0.0 and 0.5 * ku + down <= PLANES
        if planes:
            # the sides of meridians and parallels, turned from one to the next
            c, s = -1.0, 0.0
            c1, s1 = math.cos(2.0 * math.pi / ku), math.sin(2.0 * math.pi / ku)
            for _ in range(int(0.5 * ku)):
                for i in range(m):
                    b[INNER + i] *= c * b[NORMAL + NODES + i] - s * b[NORMAL + i]
                c, s = c * c1 - s * s1, s * c1 + c * s1
            c1, s1 = math.cos(math.pi / down), math.sin(math.pi / down)
            c, s = c1, s1
            for _ in range(int(down) - 1):
                for i in range(m):
                    b[INNER + i] *= b[NORMAL + 2 * NODES + i] - c
                c, s = c * c1 - s * s1, s * c1 + c * s1
            # the field that begins at -pi and at the upper pole is bright
            sign = 1.0 if int(0.5 * ku) % 2 == 1 else -1.0
            for i in range(m):
                b[INNER + i] = 1.0 if sign * b[INNER + i] >= 0.0 else dark
        else:
            for i in range(m):
                bright = texture_side(view.spheres, j, b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i])
                b[INNER + i] = 1.0 if bright == 1 else dark
    red, green, blue = view.shading[1] * sphere[4], view.shading[1] * sphere[5], view.shading[1] * sphere[6]
    for i in range(m):
        f = b[INNER + i]
        b[FACTOR + i], b[FACTOR + NODES + i], b[FACTOR + 2 * NODES + i] = f * red, f * green, f * blue


@jitable
def mark_nodes(m: int, l: int, j: int, view: View, work: Work) -> bool:
    """Fill CLEAR and SHINING of light point ``l`` on sphere ``j``; False where no node that P may see is met by it."""
    m = min(m, BATCH)
    geo, b = work.geo, work.nodes
    x, y, z = view.points[l, 0], view.points[l, 1], view.points[l, 2]
    if view.floor[FLOOR_PRESENT] != 0.0 and geo[SIDE] * z < 0.0:
        return False
    sphere = view.spheres[j]
    lx, ly, lz = x - sphere[0], y - sphere[1], z - sphere[2]
    far, k = math.sqrt(lx * lx + ly * ly + lz * lz), geo[RATIO]
    if lx * lx + ly * ly + lz * lz < sphere[3] * sphere[3]:
        return False
    open_light = view.shading[6] != CUT and view.shading[2] > 0.0
    if not open_light:
        # the caps of normals that P sees, N.p >= k, and that the light does are apart
        facing = -(lx * geo[POLE] + ly * geo[POLE + 1] + lz * geo[POLE + 2]) / far
        lit = min(1.0, sphere[3] / far)
        if facing <= k * lit - math.sqrt((1.0 - k) * (1.0 + k) * (1.0 - lit) * (1.0 + lit)):
            return False
    for i in range(m):
        ax, ay, az = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
        dot = ax * b[NORMAL + i] + ay * b[NORMAL + NODES + i] + az * b[NORMAL + 2 * NODES + i]
        b[CLEAR + i] = 1.0 if dot > 0.0 else 0.0
        b[SHINING + i] = 1.0
    if not open_light:
        for i in range(m):
            b[SHINING + i] = b[CLEAR + i]
    for h in range(view.spheres.shape[0]):
        if h == j:
            continue
        caster = view.spheres[h]
        cx, cy, cz, r2 = caster[0], caster[1], caster[2], caster[3] * caster[3]
        if (cx - x) ** 2 + (cy - y) ** 2 + (cz - z) ** 2 < r2:
            return False
        if not (casts(x, y, z, caster, sphere) and shadow_in_view(-lx, -ly, -lz, caster, sphere, open_light, geo)):
            continue
        for i in range(m):
            qx, qy, qz = b[PLACE + i], b[PLACE + NODES + i], b[PLACE + 2 * NODES + i]
            ax, ay, az = x - qx, y - qy, z - qz
            fx, fy, fz = cx - qx, cy - qy, cz - qz
            a2, dot = ax * ax + ay * ay + az * az, ax * fx + ay * fy + az * fz
            clear = 0.0 if dot * dot > a2 * (fx * fx + fy * fy + fz * fz - r2) else 1.0
            clear = clear if dot > 0.0 else 1.0
            clear = clear if dot < a2 else 1.0
            b[CLEAR + i] *= clear
            b[SHINING + i] *= clear
    return True
