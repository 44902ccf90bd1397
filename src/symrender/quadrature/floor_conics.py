"""The walls of the checkered floor as conics about the point's foot, and where they cut a square of it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.penumbra_walls import INNER, edge_search
from symrender.chambers.roots import quadratic_roots
from symrender.chambers.walls import (
    HEIGHT,
    KIND,
    LIGHT,
    PENUMBRA,
    POINT,
    RIM_COS,
    RIM_SIN,
    SHAPE,
    SURFACE_NORMAL,
)
from symrender.chambers.work import CASTERS, OCCLUDERS, WALLS, View, Work
from symrender.kernel_cache import inlined, jitable

Array = npt.NDArray[np.float64]

CONIC_COLUMNS = 7
SOFT = 6
"""Column of the cone about a disk's penumbra: 1 + the index of its outer edge in the wall table; 0 of other conics."""
PASSAGE = 0.0
"""Kind of a cut where a conic passes a side of the square."""
TANGENT = 1.0
"""Kind of a cut where a conic touches the line y = const: pieces of lines open there like a square root."""


@jitable
def add_cone(
    conics: Array, count: int, ax: float, ay: float, az: float, sine2: float, fx: float, fy: float, height: float
) -> int:
    """Append the floor conic of the cone about unit axis ``a`` with apex (fx, fy, height); columns A B C D E F.

    A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F = sin^2 |w|^2 - |w x a|^2 with w = (x - fx, y - fy, -height).
    """
    if count >= conics.shape[0]:
        return count + 1
    k = sine2 - 1.0
    row = conics[count]
    row[SOFT] = 0.0
    row[0] = k + ax * ax
    row[1] = ax * ay
    row[2] = k + ay * ay
    row[3] = -ax * az * height - (row[0] * fx + row[1] * fy)
    row[4] = -ay * az * height - (row[1] * fx + row[2] * fy)
    at_apex = height * height * (k + az * az)
    row[5] = (
        at_apex + row[0] * fx * fx + 2.0 * row[1] * fx * fy + row[2] * fy * fy + 2.0 * height * az * (ax * fx + ay * fy)
    )
    return count + 1


@jitable
def add_line(conics: Array, n: int, ax: float, ay: float, az: float, h: float) -> int:
    """Append the line in which the plane through the point across ``a`` meets the floor, ``h`` below; new count."""
    if n < conics.shape[0]:
        row = conics[n]
        row[0] = row[1] = row[2] = row[SOFT] = 0.0
        row[3], row[4], row[5] = 0.5 * ax, 0.5 * ay, -h * az
    return n + 1


@inlined
def floor_conics(own: int, lobe: Array, view: View, work: Work, conics: Array) -> int:
    """All conics of the floor chart about the point's foot; their number."""
    geo = work.geo
    h = geo[HEIGHT]
    px, py, pz = geo[POINT], geo[POINT + 1], geo[POINT + 2]
    if geo[RIM_COS] > 0.0:
        n = add_cone(conics, 0, lobe[0], lobe[1], lobe[2], geo[RIM_SIN] ** 2, 0.0, 0.0, h)
    else:
        # the cone is a plane, of which its quadratic is the square
        n = add_line(conics, 0, lobe[0], lobe[1], lobe[2], h)
    n = add_line(conics, n, geo[SURFACE_NORMAL], geo[SURFACE_NORMAL + 1], geo[SURFACE_NORMAL + 2], h)
    for i in range(work.counts[OCCLUDERS]):
        k = work.occluders[i]
        sx, sy, sz, r = view.spheres[k, 0] - px, view.spheres[k, 1] - py, view.spheres[k, 2], view.spheres[k, 3]
        far2 = sx * sx + sy * sy + (sz - pz) ** 2
        far = math.sqrt(far2)
        n = add_cone(conics, n, sx / far, sy / far, (sz - pz) / far, r * r / far2, 0.0, 0.0, h)
        if abs(sz) < r and n < conics.shape[0]:
            row = conics[n]
            row[0], row[1], row[2], row[3], row[4], row[SOFT] = 1.0, 0.0, 1.0, -sx, -sy, 0.0
            row[5] = sx * sx + sy * sy - (r - sz) * (r + sz)
            n += 1
    for i in range(work.counts[CASTERS]):
        light, k = work.casters[i, 0], work.casters[i, 1]
        lx, ly, lz = view.points[light, 0] - px, view.points[light, 1] - py, view.points[light, 2]
        ex, ey, ez = view.spheres[k, 0] - px - lx, view.spheres[k, 1] - py - ly, view.spheres[k, 2] - lz
        far2 = ex * ex + ey * ey + ez * ez
        far = math.sqrt(far2)
        rho = view.points[light, DISK_RADIUS]
        reach = view.spheres[k, 3] + rho
        t = rho / reach
        n = add_cone(
            conics, n, ex / far, ey / far, ez / far, reach * reach / far2, lx + t * ex, ly + t * ey, lz + t * ez
        )
        if rho > 0.0 and n <= conics.shape[0]:
            for wall in range(work.counts[WALLS]):
                row = work.walls[wall]
                if row[KIND] == PENUMBRA and row[LIGHT] == light and row[SHAPE] == k and row[INNER] == 0.0:
                    conics[n - 1, SOFT] = 1.0 + wall
    return n


@jitable
def may_cross(row: Array, x: float, y: float, half: float) -> bool:
    """Whether the conic can vanish, or a disk be partly hidden, in the square of half-width ``half`` about (x, y)."""
    value = row[0] * x * x + 2.0 * row[1] * x * y + row[2] * y * y + 2.0 * (row[3] * x + row[4] * y) + row[5]
    gx = 2.0 * (row[0] * x + row[1] * y + row[3])
    gy = 2.0 * (row[1] * x + row[2] * y + row[4])
    reach = (abs(gx) + abs(gy)) * half + (abs(row[0]) + 2.0 * abs(row[1]) + abs(row[2])) * half * half
    return bool(abs(value) <= reach or (row[SOFT] > 0.0 and value > 0.0))


@inlined
def conic_roots(row: Array, y: float, x0: float, x1: float, walls: Array, geo: Array, edges: Array) -> int:
    """Where the line y = const meets a conic, or the edges of a penumbra inside its cone, into ``edges``.

    Returns how many; those of a conic may lie beyond x0..x1.
    """
    if row[SOFT] > 0.0:
        outer = int(row[SOFT]) - 1
        found = edge_search(walls[outer], x0, x1, math.nan, y, geo, edges)
        found += edge_search(walls[outer + 1], x0, x1, math.nan, y, geo, edges[found:])
        return found
    found, edges[0], edges[1] = quadratic_roots(row[0], row[1] * y + row[3], row[2] * y * y + 2.0 * row[4] * y + row[5])
    return found


@jitable
def square_cuts(
    x0: float, x1: float, y0: float, y1: float, crossing: Array, crossings: int, conics: Array, cuts: Array,
    kinds: Array,
) -> int:  # fmt: skip
    """Ascending y of [y0, y1], both ends included, at which conics touch y = const or pass x = x0 or x1; how many.

    ``crossing`` lists the rows of ``conics`` concerned; ``kinds`` gets ``PASSAGE`` or ``TANGENT``.
    """
    n = 2
    cuts[0], cuts[1] = y0, y1
    kinds[0] = kinds[1] = PASSAGE
    for i in range(crossings):
        row = conics[int(crossing[i])]
        for which in range(3):
            if which < 2:
                x = x0 if which == 0 else x1
                found, r1, r2 = quadratic_roots(row[2], row[1] * x + row[4], row[0] * x * x + 2.0 * row[3] * x + row[5])
            else:
                found, r1, r2 = quadratic_roots(
                    row[1] * row[1] - row[0] * row[2], row[1] * row[3] - row[0] * row[4],
                    row[3] * row[3] - row[0] * row[5],
                )  # fmt: skip
            for j in range(found):
                y = r1 if j == 0 else r2
                if not y0 < y < y1 or n >= cuts.shape[0]:
                    continue
                if which == 2:
                    # a conic touches its tangent at the middle of its two roots
                    middle = -(row[1] * y + row[3])
                    if not (min(x0 * row[0], x1 * row[0]) <= middle <= max(x0 * row[0], x1 * row[0])):
                        continue
                p = n
                while p > 0 and cuts[p - 1] > y:
                    cuts[p], kinds[p] = cuts[p - 1], kinds[p - 1]
                    p -= 1
                cuts[p], kinds[p] = y, PASSAGE if which < 2 else TANGENT
                n += 1
    return n
