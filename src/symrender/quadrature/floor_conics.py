"""The walls of the checkered floor as conics about the point's foot, and where they cut a square of it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.caps import Cone
from symrender.chambers.lobes.fit import jump_cosine
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.penumbra_walls import edge_search
from symrender.chambers.records import DISTANT, Chart, Wall
from symrender.chambers.rooms import height
from symrender.chambers.roots import quadratic_roots
from symrender.chambers.walls import (
    CONTACT,
    PENUMBRA,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.quadrature.records import Conic

Array = npt.NDArray[np.float64]

ROUND = -1
TOUCHES = -2
"""``soft`` of the circle in which a ball meets the floor, and, less the number of the smaller ball, of a conic where
circles touch: light begins there like a power of the distance."""
PASSAGE = 0.0
"""Kind of a cut where a conic passes a side of the square."""
TANGENT = 1.0
"""Kind of a cut where a conic touches the line y = const: pieces of lines open there like a square root."""


@jitable
def add_cone(
    conics: Table[Conic], count: int, ax: float, ay: float, az: float, sine2: float, fx: float, fy: float, height: float
) -> int:
    """Append the floor conic of the cone about unit axis ``a`` with apex (fx, fy, height).

    It is sin^2 |w|^2 - |w x a|^2 with w = (x - fx, y - fy, -height).
    """
    if count >= conics.shape[0]:
        return count + 1
    row = conics[count]
    row.soft = 0
    row.xx, row.xy, row.yy, row.x, row.y, row.free = values.cone_conic(ax, ay, az, sine2, fx, fy, height)
    return count + 1


@jitable
def add_line(conics: Table[Conic], n: int, ax: float, ay: float, az: float, h: float) -> int:
    """Append the line in which the plane through the point across ``a`` meets the floor, ``h`` below; new count."""
    if n < conics.shape[0]:
        row = conics[n]
        row.soft = 0
        row.xx, row.xy, row.yy, row.x, row.y, row.free = values.plane_conic(ax, ay, az, h)
    return n + 1


@inlined
def is_edge(k: int, view: View, chart: Chart) -> bool:
    """Whether plane ``k`` meets the charted one in an edge of its own; that of P's plane is the horizon."""
    up = view.sides[k].up
    return bool(k != chart.plane and k != chart.home and (up[0] != 0.0 or up[1] != 0.0))


@jitable
def cone_conics(n: int, paired: bool, cones: Table[Cone] | None, px: float, py: float, conics: Table[Conic]) -> int:
    """Append those of the cones of spots, or ``paired`` those about two spheres; new count."""
    if cones is None:
        return n
    for c in range(cones.shape[0]):
        at, ball = cones[c].apex.position, cones[c].ball
        if (cones[c].one >= 0.0) != paired:
            continue
        ex, ey, ez = ball.center[0] - at[0], ball.center[1] - at[1], ball.center[2] - at[2]
        x, y = at[0] - px, at[1] - py
        if cones[c].apex.fall == DISTANT:
            far = math.sqrt(ex * ex + ey * ey + ez * ez)
            x, y = ball.center[0] - px, ball.center[1] - py
            n = add_cylinder(conics, n, ex / far, ey / far, ez / far, ball.radius, x, y, ball.center[2])
            continue
        if 1.0 - ball.radius * ball.radius > CONTACT:
            n = add_cone(conics, n, ex, ey, ez, ball.radius * ball.radius, x, y, at[2])
            continue
        # an angle of 90 degrees: a plane
        if n < conics.shape[0]:
            row = conics[n]
            row.xx, row.xy, row.yy, row.x, row.y, row.soft = 0.0, 0.0, 0.0, 0.5 * ex, 0.5 * ey, 0
            row.free = -(ex * x + ey * y + ez * at[2])
        n += 1
    return n


@jitable
def add_cylinder(
    conics: Table[Conic], n: int, ax: float, ay: float, az: float, radius: float, x: float, y: float, z: float
) -> int:  # fmt: skip
    """Append the cylinder of this radius along unit ``a`` about (x, y, z): a cone of angle 0 with its radius added."""
    n = add_cone(conics, n, ax, ay, az, 0.0, x, y, z)
    if n <= conics.shape[0]:
        conics[n - 1].free += radius * radius
    return n


@inlined
def touch_conics(n: int, view: View, work: Work, conics: Table[Conic], cones: Table[Cone] | None) -> int:
    """Append where what is seen of a sky or a lamp touches: cones about two spheres, spheres at other planes."""
    chart = work.chart
    if cones is None:
        return n
    if view.glows is None:
        return n
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    first = n
    n = cone_conics(n, True, cones, px, py, conics)
    for c in range(cones.shape[0]):
        # cones of pairs are appended in their order
        one, other = int(cones[c].one), int(cones[c].other)
        if one >= 0:
            if first < conics.shape[0]:
                smaller = one if view.spheres[one].radius < view.spheres[other].radius else other
                conics[first].soft = TOUCHES - smaller
            first += 1
    for i in range(view.spheres.shape[0]):
        s = view.spheres[i]
        for k in range(view.sides.shape[0]):
            up = view.sides[k].up
            if k == chart.plane or math.hypot(up[0], up[1]) == 0.0:
                continue
            above = height(view.sides[k], px, py, pz) - pz * up[2]
            level = height(view.sides[k], s.center[0], s.center[1], s.center[2])
            for side in range(2):
                if n < conics.shape[0]:
                    row = conics[n]
                    row.xx, row.xy, row.yy, row.x, row.y = 0.0, 0.0, 0.0, 0.5 * up[0], 0.5 * up[1]
                    row.soft = TOUCHES - i
                    row.free = above - level + (s.radius if side == 0 else -s.radius)
                n += 1
    return n


@inlined
def shadow_conics(n: int, view: View, work: Work, conics: Table[Conic]) -> int:
    """Append the edges of shadows that P sees some of, and the cones about penumbrae; new count."""
    px, py = work.chart.point[0], work.chart.point[1]
    for i in range(work.counts.casters):
        if work.casters[i].unseen == 1:
            continue
        light, k = work.casters[i].light, work.casters[i].ball
        lx, ly, lz = (
            view.points[light].position[0] - px,
            view.points[light].position[1] - py,
            view.points[light].position[2],
        )
        ex, ey, ez = (
            view.spheres[k].center[0] - px - lx,
            view.spheres[k].center[1] - py - ly,
            view.spheres[k].center[2] - lz,
        )
        far2 = ex * ex + ey * ey + ez * ez
        far = math.sqrt(far2)
        if view.points[light].fall == DISTANT:
            # the cylinder behind the ball
            s = view.spheres[k]
            n = add_cylinder(
                conics, n, ex / far, ey / far, ez / far, s.radius, s.center[0] - px, s.center[1] - py, s.center[2]
            )
            continue
        rho = view.points[light].radius
        reach = view.spheres[k].radius + rho
        t = rho / reach
        if rho == 0.0 and abs(far2 - reach * reach) < CONTACT * far2:
            # a light on the ball itself: the plane that touches there
            if n < conics.shape[0]:
                row = conics[n]
                row.xx, row.xy, row.yy, row.x, row.y, row.soft = 0.0, 0.0, 0.0, 0.5 * ex / far, 0.5 * ey / far, 0
                row.free = -(ex * lx + ey * ly + ez * lz) / far
            n += 1
            continue
        n = add_cone(
            conics, n, ex / far, ey / far, ez / far, reach * reach / far2, lx + t * ex, ly + t * ey, lz + t * ez
        )
        if rho > 0.0 and n <= conics.shape[0]:
            for wall in range(min(work.counts.walls, work.walls.shape[0])):
                edge = work.walls[wall]
                if edge.kind == PENUMBRA and edge.light == light and edge.shape_index == k and edge.inner == 0.0:
                    conics[n - 1].soft = 1 + wall
    return n


@inlined
def floor_conics(own: int, lobe: Array, view: View, work: Work, conics: Table[Conic]) -> int:
    """All conics of the floor chart about the point's foot across which light jumps; their number."""
    chart = work.chart
    h = chart.height
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    n = 0
    if chart.lobe.rim_cos > 0.0:
        n = add_cone(conics, 0, lobe[0], lobe[1], lobe[2], chart.lobe.rim_sin**2, 0.0, 0.0, h)
    elif chart.lobe.rim_cos == 0.0:
        # the cone is a plane, of which its quadratic is the square
        n = add_line(conics, 0, lobe[0], lobe[1], lobe[2], h)
    n = add_line(conics, n, chart.normal[0], chart.normal[1], chart.normal[2], h)
    for k in range(view.sides.shape[0]):
        if is_edge(k, view, chart):
            up = view.sides[k].up
            above = height(view.sides[k], px, py, pz)
            n = add_line(conics, n, -pz * up[0], -pz * up[1], above - pz * up[2], h)
    for i in range(work.counts.occluders):
        k = work.occluders[i]
        sx, sy, sz, r = (
            view.spheres[k].center[0] - px,
            view.spheres[k].center[1] - py,
            view.spheres[k].center[2],
            view.spheres[k].radius,
        )
        far2 = sx * sx + sy * sy + (sz - pz) ** 2
        far = math.sqrt(far2)
        n = add_cone(conics, n, sx / far, sy / far, (sz - pz) / far, r * r / far2, 0.0, 0.0, h)
        if abs(sz) < r and n < conics.shape[0]:
            row = conics[n]
            row.xx, row.xy, row.yy, row.x, row.y, row.soft = 1.0, 0.0, 1.0, -sx, -sy, ROUND
            row.free = sx * sx + sy * sy - (r - sz) * (r + sz)
            n += 1
    if view.conductors is not None and chart.lobe.kind == CONDUCTOR and chart.lobe.walter == 1:
        up, cosine = chart.normal, jump_cosine(chart.lobe.alpha)
        n = add_cone(conics, n, up[0], up[1], up[2], (1.0 - cosine) * (1.0 + cosine), 0.0, 0.0, h)
    if view.cones is not None:
        n = cone_conics(n, False, view.cones, px, py, conics)
    return shadow_conics(n, view, work, conics)


@jitable
def is_felt(row: Conic, x: float, y: float, half: float, least: float, view: View) -> bool:
    """Whether what touches at a conic is more than a share ``least`` of what is seen from the square about (x, y)."""
    if row.soft > TOUCHES:
        return True
    ball = view.spheres[TOUCHES - int(row.soft)]
    dx, dy, dz = ball.center[0] - x, ball.center[1] - y, ball.center[2]
    far = math.sqrt(dx * dx + dy * dy + dz * dz) - 1.4143 * half
    return bool(far <= 0.0 or ball.radius * ball.radius > least * far * far)


@jitable
def may_cross(row: Conic, x: float, y: float, half: float) -> bool:
    """Whether the conic can vanish, or a disk be partly hidden, in the square of half-width ``half`` about (x, y)."""
    value = values.conic_level(row.xx, row.xy, row.yy, row.x, row.y, row.free, x, y)
    gx = 2.0 * (row.xx * x + row.xy * y + row.x)
    gy = 2.0 * (row.xy * x + row.yy * y + row.y)
    reach = (abs(gx) + abs(gy)) * half + (abs(row.xx) + 2.0 * abs(row.xy) + abs(row.yy)) * half * half
    return bool(abs(value) <= reach or (row.soft > 0.0 and value > 0.0))


@inlined
def conic_roots(row: Conic, y: float, x0: float, x1: float, walls: Table[Wall], chart: Chart, edges: Array) -> int:
    """Where the line y = const meets a conic, or the edges of a penumbra inside its cone, into ``edges``.

    Returns how many; those of a conic may lie beyond x0..x1.
    """
    if row.soft > 0.0:
        outer = row.soft - 1
        found = edge_search(walls[outer], x0, x1, math.nan, y, chart, edges)
        found += edge_search(walls[outer + 1], x0, x1, math.nan, y, chart, edges[found:])
        return found
    found, edges[0], edges[1] = quadratic_roots(row.xx, row.xy * y + row.x, row.yy * y * y + 2.0 * row.y * y + row.free)
    return found


@inlined
def touched_lines(row: Conic) -> tuple[int, float, float]:
    """How many lines y = const a conic touches, and which."""
    return quadratic_roots(
        row.xy * row.xy - row.xx * row.yy, row.xy * row.x - row.xx * row.y, row.x * row.x - row.xx * row.free
    )  # fmt: skip


@jitable
def square_cuts(
    x0: float, x1: float, y0: float, y1: float, crossing: Array, crossings: int, conics: Table[Conic], cuts: Array,
    kinds: Array,
) -> int:  # fmt: skip
    """Ascending y of [y0, y1], both ends included, at which conics touch y = const or pass x = x0 or x1; how many.

    Passages of curves steeper than a diagonal stand still where numbers move.
    ``crossing`` lists the rows of ``conics`` concerned; ``kinds`` gets ``PASSAGE`` or ``TANGENT``.
    """
    n = 2
    cuts[0], cuts[1] = y0, y1
    kinds[0] = kinds[1] = PASSAGE
    for i in range(crossings):
        row = conics[int(crossing[i])]
        for which in range(3):
            x = x1 if which == 1 else x0
            if which < 2:
                found, r1, r2 = quadratic_roots(row.yy, row.xy * x + row.y, row.xx * x * x + 2.0 * row.x * x + row.free)
            else:
                found, r1, r2 = touched_lines(row)
            for j in range(found):
                y = r1 if j == 0 else r2
                if not y0 < y < y1 or n >= cuts.shape[0]:
                    continue
                if which < 2 and abs(row.xy * x + row.yy * y + row.y) < abs(row.xx * x + row.xy * y + row.x):
                    # a steep curve's passage moves faster than anything on its two sides, which fit together
                    y = held(y)
                if which == 2:
                    # a conic touches its tangent at the middle of its two roots
                    middle = -(row.xy * y + row.x)
                    if not (min(x0 * row.xx, x1 * row.xx) <= middle <= max(x0 * row.xx, x1 * row.xx)):
                        continue
                p = n
                while p > 0 and cuts[p - 1] > y:
                    cuts[p], kinds[p] = cuts[p - 1], kinds[p - 1]
                    p -= 1
                cuts[p], kinds[p] = y, PASSAGE if which < 2 else TANGENT
                n += 1
    return n
