"""One scan line of a chart: its walls in order, and the cells between them with their labels."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, HIDDEN, is_hidden, light_state, texture_side
from symrender.chambers.penumbra_walls import edge_value, penumbra_roots
from symrender.chambers.place import floor_shadow_roots, shadow_level, shadow_quartic, surface_point
from symrender.chambers.reach import passes
from symrender.chambers.records import Chart, Wall
from symrender.chambers.roots import circle_roots, quadratic_roots, quartic_roots
from symrender.chambers.walls import (
    BALL,
    DIRECTION,
    FLOOR_CUT,
    HIGHLIGHT,
    NORMAL,
    PARTED,
    PENUMBRA,
    SEVERAL,
    SHADOW,
    SHADOW_EDGE,
    SILHOUETTE,
    TERMINATOR,
    TEXTURE_EDGE,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import moves, rising, tangent
from symrender.leaves.values import floor_reach

Array = npt.NDArray[np.float64]

POLE_END = -1
RIM_LOW = -2
RIM_HIGH = -3
LIMB = -4
NOTHING = -1
THIN = 1e-14
"""A stretch of a line shorter than this has no label."""
NEAR = 1e-11
"""Length of a stretch of a line below which the walls at its ends are taken to coincide where they move."""
WIDE = 1e-6
"""Distance between a panel's lines from which on walls that all but coincide on one of them do not just cross there."""
HALF_PI = 0.5 * math.pi


@jitable
def wall_level(i: int, x: float, c: float, s: float, work: Work) -> float:
    """Signed level of wall ``i`` at inner coordinate ``x`` of the line (c, s): zero on the wall."""
    chart = work.chart
    row = work.walls[i]
    kind = row.kind
    if kind >= PENUMBRA:
        return edge_value(row, x, c, s, chart)
    if chart.shape_index >= 0.0:
        sb = chart.ratio * math.sin(x)
        if kind == DIRECTION:
            return float(row.axis[0] * math.sqrt(1.0 - sb * sb) + (row.axis[1] * c + row.axis[2] * s) * sb - row.cos)
        g = x - math.asin(sb)
        if kind == NORMAL:
            return float(row.axis[0] * math.cos(g) + (row.axis[1] * c + row.axis[2] * s) * math.sin(g) - row.cos)
        return shadow_level(row, x, c, s, chart)
    if kind == DIRECTION:
        return float(row.axis[0] * math.cos(x) + (row.axis[1] * c + row.axis[2] * s) * math.sin(x) - row.cos)
    if kind == SHADOW:
        return shadow_level(row, x, c, s, chart)
    r = floor_reach(x, chart.height)
    return float(r * (r - 2.0 * (row.foot[0] * c + row.foot[1] * s)) + row.power)


@inlined
def rim_sines(c: float, s: float, chart: Chart) -> tuple[float, float, int, int]:
    """Part of the line inside the lobe as sines of inner coordinates (low, high), and what bounds it.

    low > high if there is none.
    """
    k = chart.ratio
    if chart.lobe.rim_cos < 0.0:
        return 0.0, 1.0, POLE_END, LIMB
    found, c1, s1, c2, s2 = circle_roots(
        chart.lobe_cos, chart.lobe_sin, 0.0, chart.lobe.rim_cos, chart.lobe.rim_sin, c, s
    )
    # the lobe is at most a half space: the line leaves it at most pi beyond where it enters
    if not found or (s1 > 0.0 and (c1 <= 0.0 or s1 >= k)) or (s1 <= 0.0 and s2 <= 0.0 and not (c1 > 0.0 and c2 < 0.0)):
        return 1.0, 0.0, RIM_LOW, RIM_HIGH
    low, high, first, last = 0.0, 1.0, POLE_END, LIMB
    if s1 > 0.0:
        low, first = s1 / k, RIM_LOW
    if c2 > 0.0 and s2 < k:
        high, last = s2 / k, RIM_HIGH
    return low, high, first, last


@jitable
def rim_interval(c: float, s: float, chart: Chart) -> tuple[float, float, int, int]:
    """Part of the line inside the lobe as inner coordinates (low, high) and what bounds it; low > high if none."""
    low, high, first, last = rim_sines(c, s, chart)
    return math.asin(low), math.asin(high), first, last


@inlined
def wall_roots(i: int, c: float, s: float, low: float, high: float, work: Work, out: Array) -> int:
    """Inner coordinates of wall ``i`` on the line, strictly between low and high, ascending per branch; ``out`` (4,).

    A root of branch b is stored in out[b]; absent branches are NaN. Returns the number of branches.
    """
    chart = work.chart
    row = work.walls[i]
    kind = row.kind
    out[0] = out[1] = out[2] = out[3] = math.nan
    sphere = chart.shape_index >= 0.0
    k = chart.ratio
    if kind in (NORMAL, DIRECTION):
        found, c1, s1, c2, s2 = circle_roots(row.axis[0], row.axis[1], row.axis[2], row.cos, row.sin, c, s)
        if not found:
            return 0
        for b in range(2):
            cx = c1 if b == 0 else c2
            sx = s1 if b == 0 else s2
            if sx <= 0.0:
                continue
            if kind == NORMAL:
                if cx <= k:
                    continue
                x = math.atan2(sx, cx - k)
            elif sphere:
                if cx <= 0.0 or sx >= k:
                    continue
                x = math.asin(sx / k)
            else:
                if cx <= 0.0:
                    continue
                x = math.atan2(sx, cx)
            if low < x < high:
                out[b] = x
        return 2
    if kind >= PENUMBRA:
        return penumbra_roots(i, c, s, low, high, work, out)
    if kind == SHADOW and sphere:
        top = chart.limb_tangent
        shadow_quartic(row, chart.radius, c, s, top, work.bernstein)
        n = quartic_roots(work.bernstein, work.stack, work.quartic)
        for b in range(min(n, 4)):
            t = top * work.quartic[b]
            # cos and sin of gamma over 1 + t^2
            x = math.atan2(2.0 * t, (1.0 - t * t) - k * (1.0 + t * t))
            if low < x < high:
                out[b] = x
        return min(n, 4)
    if kind == SHADOW:
        n, r1, r2 = floor_shadow_roots(row, c, s)
    else:
        n, r1, r2 = quadratic_roots(1.0, -(row.foot[0] * c + row.foot[1] * s), row.power)
    for b in range(n):
        r = r1 if b == 0 else r2
        if r > 0.0:
            x = math.atan2(r, chart.height)
            if low < x < high:
                out[b] = x
    return n


@inlined
def move_apart(start: float, end: float) -> int:
    """Whether two walls that all but coincide on a line move apart, a bit a tangent."""
    return rising(abs(tangent(end) - tangent(start)) - PARTED * (abs(tangent(end)) + abs(tangent(start))))


@inlined
def touch_by_themselves(one: Wall, other: Wall) -> bool:
    """Whether two walls touch whatever moves: where a ball meets the shape, and what it hides or shades of the shape.

    They do not cross there, and what one of them leaves the other takes up.
    """
    met = (one.tag == SILHOUETTE and one.kind in (BALL, NORMAL)) or (
        other.tag == SILHOUETTE and other.kind in (BALL, NORMAL)
    )
    both = one.tag in (SILHOUETTE, SHADOW_EDGE) and other.tag in (SILHOUETTE, SHADOW_EDGE)
    return bool(met and both and one.shape_index == other.shape_index)


@jitable
def note_parted(cells: int, work: Work) -> None:
    """Note whether a cell that is seen ends on a wall that another one parts from."""
    for i in range(cells + 1):
        wall = work.cell_wall[i]
        seen = (i < cells and work.cell_side[i] != HIDDEN) or (i > 0 and work.cell_side[i - 1] != HIDDEN)
        if wall >= 0 and seen and work.walls[wall // 4].parted != 0:
            work.counts.parted |= work.walls[wall // 4].parted


@inlined
def line_roots(
    phi: float, c: float, s: float, low: float, high: float, low_s: float, high_s: float, work: Work, scratch: Array
) -> int:  # fmt: skip
    """Fill ``root_x`` and ``root_id`` with where walls meet the line, ascending, between two ends; how many they are.

    ``low_s`` and ``high_s`` are the sines of the ends ``low`` and ``high``; ``scratch`` is (4,).
    """
    low_c, high_c = math.sqrt((1.0 - low_s) * (1.0 + low_s)), math.sqrt((1.0 - high_s) * (1.0 + high_s))
    n = 0
    walls, root_x, root_id = work.walls, work.root_x, work.root_id
    ratio = work.chart.ratio
    for i in range(min(work.counts.walls, walls.shape[0])):
        if not passes(walls[i], phi):
            continue
        if walls[i].kind == NORMAL:
            found, c1, s1, c2, s2 = circle_roots(
                walls[i].axis[0], walls[i].axis[1], walls[i].axis[2], walls[i].cos, walls[i].sin, c, s
            )
            if not found:
                continue
            branches = 2
            for b in range(2):
                cx = (c1 if b == 0 else c2) - ratio
                sx = s1 if b == 0 else s2
                # (cx, sx) points along psi: inside (low, high) by two cross products, no inverse function
                scratch[b] = math.nan
                if cx > 0.0 and sx > 0.0 and sx * low_c - cx * low_s > 0.0 and cx * high_s - sx * high_c > 0.0:
                    scratch[b] = math.atan2(sx, cx)
        else:
            branches = wall_roots(i, c, s, low, high, work, scratch)
        for b in range(branches):
            x = scratch[b]
            if x == x and n < root_x.shape[0]:
                k = n
                while k > 0 and root_x[k - 1] > x:
                    root_x[k] = root_x[k - 1]
                    root_id[k] = root_id[k - 1]
                    k -= 1
                root_x[k] = x
                root_id[k] = 4 * i + b
                n += 1
    return n


@inlined
def label_stretch(
    middle: float, c: float, s: float, changed: int, which: int, cells: int, side: int, view: View, work: Work
) -> tuple[int, bool]:  # fmt: skip
    """Fill ``lit`` of cell ``cells`` as of a stretch's ``middle``; its side, and whether all is as in the cell before.

    Of the last label, of this ``side``, only what the wall passed may have ``changed`` is asked again: of a terminator
    or of a shadow's edge what light ``which`` does.
    """
    j, lights, lit = work.chart.shape_index, view.points.shape[0], work.lit
    same = True
    qx, qy, qz, nx, ny, nz = surface_point(middle, c, s, work.chart)
    before = side
    if changed == HIGHLIGHT and cells > 0:
        # what is felt of a light changes here, not what it is
        same = False
        for l in range(lights):
            lit[cells, l] = lit[cells - 1, l]
            if view.points[l].spot != 0.0:
                # but where it is the cone of a spot
                lit[cells, l] = light_state(l, qx, qy, qz, nx, ny, nz, view, work)
    elif changed == TEXTURE_EDGE:
        side = texture_side(view.spheres, j, nx, ny, nz)
        same = side == before
    elif changed in (TERMINATOR, SHADOW_EDGE):
        state = light_state(which, qx, qy, qz, nx, ny, nz, view, work)
        same = state == lit[cells - 1, which]
        if not same:
            for l in range(lights):
                lit[cells, l] = lit[cells - 1, l]
            lit[cells, which] = state
    else:
        if is_hidden(qx, qy, qz, view, work):
            side = HIDDEN
            for l in range(lights):
                lit[cells, l] = DARK
        else:
            side = 1 if j < 0 else texture_side(view.spheres, j, nx, ny, nz)
            for l in range(lights):
                lit[cells, l] = light_state(l, qx, qy, qz, nx, ny, nz, view, work)
        same = cells > 0 and side == before
        if same:
            for l in range(lights):
                if lit[cells, l] != lit[cells - 1, l]:
                    same = False
                    break
    if not same and changed == TEXTURE_EDGE:
        for l in range(lights):
            lit[cells, l] = lit[cells - 1, l]
    return side, same


@inlined
def line_signature(last: int, view: View, work: Work) -> int:
    """A number of the scanned line's walls and labels in their order, ended by ``last``; 0 where none of it is seen."""
    cells, lights, lit = work.counts.cells, view.points.shape[0], work.lit
    seen = False
    signature = 1469598103934665603
    for i in range(cells):
        signature = (signature ^ (work.cell_wall[i] + 8)) * 1099511628211
        signature = (signature ^ (work.cell_side[i] + 2)) * 1099511628211
        if work.cell_side[i] != HIDDEN:
            seen = True
            for l in range(lights):
                signature = (signature ^ lit[i, l]) * 1099511628211
    signature = (signature ^ (last + 8)) * 1099511628211
    if not seen:
        return 0
    return signature


@jitable
def scan_line(phi: float, view: View, work: Work, scratch: Array) -> int:
    """Cells of the line phi = const inside the lobe; returns the line's signature, equal for equal structure.

    Fills ``cell_from``, ``cell_to``, ``cell_wall`` (the wall below each cell; one more entry closes the last),
    ``cell_side`` and ``lit``; ``counts[CELLS]`` is their number. Neighbours with the same label are one cell.
    ``scratch`` is (4,).
    """
    work.counts.labour += 1
    c, s = math.cos(phi), math.sin(phi)
    low_s, high_s, first, last = rim_sines(c, s, work.chart)
    work.counts.cells = 0
    if not low_s < high_s:
        return 0
    low, high = math.asin(low_s), math.asin(high_s)
    n = line_roots(phi, c, s, low, high, low_s, high_s, work, scratch)
    cells = 0
    start, wall = low, first
    changed = SEVERAL
    which = 0
    side = HIDDEN
    for i in range(n + 1):
        end = high if i == n else work.root_x[i]
        if moves(start) and i < n and end - start < NEAR and work.chart.apart > WIDE:
            row = work.walls[work.root_id[i] // 4]
            if i == 0 or not touch_by_themselves(work.walls[wall // 4], row):
                row.parted |= move_apart(start, end)
        if end - start > THIN:
            same = True
            if side == HIDDEN and changed < SEVERAL and changed > SILHOUETTE and changed != FLOOR_CUT:
                changed = NOTHING
            if changed != NOTHING:
                side, same = label_stretch(0.5 * (start + end), c, s, changed, which, cells, side, view, work)
            if same and cells > 0:
                work.cell_to[cells - 1] = end
            else:
                work.cell_from[cells] = start
                work.cell_to[cells] = end
                work.cell_wall[cells] = wall
                work.cell_side[cells] = side
                cells += 1
            changed = NOTHING
        start = end
        if i == n:
            break
        wall = work.root_id[i]
        tag = work.walls[wall // 4].tag
        now = work.walls[wall // 4].light if tag == SHADOW_EDGE else work.walls[wall // 4].shape_index
        if changed == NOTHING or (changed == tag and which == now):
            changed, which = tag, now
        else:
            changed = SEVERAL
    work.cell_wall[cells] = last
    work.counts.cells = cells
    if moves(start):
        note_parted(cells, work)
    return line_signature(last, view, work)
