"""The derivative of the checkered floor in a lobe: squares carried along, conics moving across them.

The squares are fixed to the checker, not to the point, so nothing of the chessboard moves unless its cell or offset
does; then the nodes ride with it, Q = offset + cell (i, j), and areas grow by (cell)^2. All other walls are conics,
and their roots on a line y = const move by the implicit function theorem as on a scan line. Lines are integrated
between the y at which the walls met along them change, found by bisection where no closed form gives them.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_adjoint, disk_gradient
from symrender.adjoint.line import NODE
from symrender.adjoint.lobe import add_own, log_density_at, pull, steepness
from symrender.adjoint.moves import any_moves
from symrender.adjoint.panel import contract
from symrender.adjoint.walls import (
    AT_POINT,
    AXIS,
    BRIGHT,
    DARK,
    GRID,
    HORIZON_NORMAL,
    LIGHTS,
    RIM,
    SHADING,
    plane_columns,
)
from symrender.chambers.labels import PARTLY
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import Chart
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.fall_off import most_floor_light
from symrender.quadrature.floor_conics import conic_roots, floor_conics, is_edge, may_cross, square_cuts
from symrender.quadrature.gauss import MAX_ORDER, order, step_of
from symrender.quadrature.grid_blocks import block_bound, block_level, block_sign, push_quarters
from symrender.quadrature.grid_tail import REST, remainders_of
from symrender.quadrature.records import Conic, Remainder
from symrender.quadrature.split_grid import LEAVES, MAX_BLOCK_ORDER, SMALLEST, grid_reach
from symrender.quadrature.split_line import SOFT_LOG
from symrender.quadrature.split_square import seen, taper
from symrender.scene.records import Floor

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

REPLAY_REACH = 12.0
"""Squares from the foot of a point whose lobe holds endless squares, at first."""
MOST_REPLAY_REACH = 500.0
"""The farthest reach; one more doubling than values need shows that they changed no more."""
# what a conic is
_RIM = 0
_HORIZON = 1
_SILHOUETTE = 2
_BALL = 3
_SHADOW = 4
_EDGE = 5

# rows of the scratch table (GRID_ROWS, 256): roots and their conics, states below and above a root, signatures
_ROOTS = 0
_WHICH = 1
_BELOW = 2
_ABOVE = 3
_CROSSING = 4
_CUTS = 5
_KINDS = 6
_STACK = 7
_BLOCKS = 40
GRID_ROWS = 200


@inlined
def contrast_of(view: View) -> float:
    """Half the contrast of the chessboard times kd: the largest channel."""
    most = 0.0
    for a in range(3):
        most = max(most, abs(view.floor.bright[a] - view.floor.dark[a]))
    return 0.5 * abs(view.shading.kd) * most


@jitable
def name_conics(view: View, work: Work, what: Ints) -> None:
    """What each row of ``floor_conics`` is: (kind, sphere or plane, light, 0)."""
    for k in range(what.shape[0]):
        what[k, 3] = 0
    what[0, 0], what[1, 0] = _RIM, _HORIZON
    n = 2
    for k in range(view.sides.shape[0]):
        if is_edge(k, view, work.chart):
            what[n, 0], what[n, 1] = _EDGE, k
            n += 1
    for i in range(work.counts.occluders):
        k = work.occluders[i]
        what[n, 0], what[n, 1] = _SILHOUETTE, k
        n += 1
        if abs(view.spheres[k].center[2]) < view.spheres[k].radius:
            what[n, 0], what[n, 1] = _BALL, k
            n += 1
    for i in range(work.counts.casters):
        what[n, 0], what[n, 1], what[n, 2] = _SHADOW, work.casters[i].ball, work.casters[i].light
        n += 1


@jitable
def moving_conics(count: int, nodes: bool, moves: Array, view: View, what: Ints) -> bool:
    """Note in the last column of ``what`` which conics move; whether any does. ``nodes`` is that of ``what_moves``."""
    balls = LIGHTS + 6 * view.points.shape[0]
    some = False
    for k in range(count):
        kind, ball = what[k, 0], balls + 4 * what[k, 1]
        if nodes:
            moved = True
        elif kind == _RIM:
            moved = any_moves(moves, RIM, RIM + 1)
        elif kind == _HORIZON:
            moved = any_moves(moves, HORIZON_NORMAL, HORIZON_NORMAL + 3)
        elif kind == _EDGE:
            plane = plane_columns(view) + 4 * what[k, 1]
            moved = any_moves(moves, plane, plane + 4)
        else:
            moved = any_moves(moves, ball, ball + 4)
        what[k, 3] = 1 if moved else 0
        some = some or moved
    return some


@jitable
def conic_gradient(
    kind: int, shape: int, light: int, x: float, y: float, lobe: Array, view: View, work: Work, bar: Array, own: Array
) -> None:
    """Gradient of a conic's level: ``bar`` (3,) in Q at a fixed point P, the rest added to ``own``."""
    chart = work.chart
    h = chart.height
    balls = LIGHTS + 6 * view.points.shape[0]
    r = math.sqrt(x * x + y * y + h * h)
    d = (x, y, -h)
    seen_from = True
    if kind == _RIM:
        cosine = (x * lobe[0] + y * lobe[1] - h * lobe[2]) / r
        for a in range(3):
            bar[a] = (lobe[a] - d[a] / r * cosine) / r
            own[AXIS + a] += d[a] / r
        own[RIM] -= 1.0
    elif kind == _HORIZON:
        for a in range(3):
            bar[a] = chart.normal[a]
            own[HORIZON_NORMAL + a] += d[a]
    elif kind == _SILHOUETTE:
        far2, along = 0.0, 0.0
        for a in range(3):
            o = view.spheres[shape].center[a] - chart.point[a]
            far2 += o * o
            along += o * d[a] / r
        radius = view.spheres[shape].radius
        tangent = math.sqrt(far2 - radius * radius)
        for a in range(3):
            o = view.spheres[shape].center[a] - chart.point[a]
            bar[a] = (o - d[a] / r * along) / r
            step = d[a] / r - o / tangent
            own[balls + 4 * shape + a] += step
            own[AT_POINT + a] -= step
        own[balls + 4 * shape + 3] += radius / tangent
    elif kind == _EDGE:
        seen_from = False
        column = plane_columns(view) + 4 * shape
        for a in range(3):
            bar[a] = view.sides[shape].up[a]
            own[column + a] += d[a] + chart.point[a] if a < 2 else 0.0
        own[column + 3] -= 1.0
    elif kind == _BALL:
        seen_from = False
        for a in range(3):
            o = (d[a] + chart.point[a] if a < 2 else 0.0) - view.spheres[shape].center[a]
            bar[a] = 2.0 * o
            own[balls + 4 * shape + a] -= 2.0 * o
        own[balls + 4 * shape + 3] -= 2.0 * view.spheres[shape].radius
    else:
        seen_from = False
        q, radius = view.points[light], view.spheres[shape].radius
        ux, uy, uz = x + chart.point[0] - q.position[0], y + chart.point[1] - q.position[1], -q.position[2]
        gx, gy, gz = (
            view.spheres[shape].center[0] - q.position[0],
            view.spheres[shape].center[1] - q.position[1],
            view.spheres[shape].center[2] - q.position[2],
        )
        zx, zy, zz = uy * gz - uz * gy, uz * gx - ux * gz, ux * gy - uy * gx
        bar[0] = 2.0 * (radius * radius * ux - (gy * zz - gz * zy))
        bar[1] = 2.0 * (radius * radius * uy - (gz * zx - gx * zz))
        bar[2] = 2.0 * (radius * radius * uz - (gx * zy - gy * zx))
        by_g = (-2.0 * (zy * uz - zz * uy), -2.0 * (zz * ux - zx * uz), -2.0 * (zx * uy - zy * ux))
        for a in range(3):
            own[balls + 4 * shape + a] += by_g[a]
            own[LIGHTS + 6 * light + a] -= bar[a] + by_g[a]
        own[balls + 4 * shape + 3] += 2.0 * radius * (ux * ux + uy * uy + uz * uz)
    if seen_from:
        for a in range(3):
            own[AT_POINT + a] -= bar[a]


@jitable
def ride(weight: float, qx: float, qy: float, bar: Array, floor: Floor, out: Array) -> None:
    """Add what the chessboard's own motion does to a function of Q with gradient ``bar``."""
    cell = floor.cell
    along = bar[0] * (qx - floor.offset[0]) + bar[1] * (qy - floor.offset[1])
    out[GRID] += weight * along / cell
    out[GRID + 1] += weight * bar[0]
    out[GRID + 2] += weight * bar[1]


@jitable
def grid_density(x: float, y: float, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """Lobe density times solid angle per floor area, cos(theta) and its logarithm, at (x, y) from the foot."""
    h = chart.height
    inv = 1.0 / math.sqrt(x * x + y * y + h * h)
    dx, dy, dz = x * inv - lobe[0], y * inv - lobe[1], -h * inv - lobe[2]
    cosine, log, density = log_density_at(0.5 * (dx * dx + dy * dy + dz * dz), chart.lobe)
    return density * h * inv * inv * inv, cosine, log


@inlined
def lit_sum(
    x: float, y: float, step: int, states: Array, view: View, work: Work, gauss: Array, disk: Array | None, out: Array
) -> None:  # fmt: skip
    """Sum over the lit lights of colour times cosine; ``out`` (3,)."""
    chart = work.chart
    out[0] = out[1] = out[2] = 0.0
    for i in range(view.points.shape[0]):
        if states[i] == 0.0:
            continue
        p = view.points[i]
        qx, qy = chart.point[0] + x, chart.point[1] + y
        lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2]
        cosine = lz / math.sqrt(lx * lx + ly * ly + lz * lz)
        if disk is not None and p.radius > 0.0:
            place = LitPoint(qx, qy, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
            cosine, _ = disk_term(i, int(states[i]), place, step, False, view, work, gauss)
        for a in range(3):
            out[a] += p.color[a] * cosine


@inlined
def grid_node(
    x: float, y: float, weight: float, step: int, states: Array, lobe: Array, view: View, work: Work, gauss: Array,
    disk: Array | None, half: Array, here: Array, adjoint: Array,
) -> None:  # fmt: skip
    """Add one floor node to the adjoint; ``half`` (3,) is half the contrast times kd, ``weight`` has the sign."""
    chart, floor, shading = work.chart, view.floor, view.shading
    h = chart.height
    density, cosine, log = grid_density(x, y, lobe, chart)
    if density == 0.0:
        return
    w = weight * density
    total, bar = here[0], here[1]
    total[0] = total[1] = total[2] = 0.0
    for a in range(3):
        for b in range(3):
            here[2 + a, b] = 0.0
    qx, qy = chart.point[0] + x, chart.point[1] + y
    for i in range(view.points.shape[0]):
        if states[i] == 0.0:
            continue
        p = view.points[i]
        if disk is not None and p.radius > 0.0:
            place = LitPoint(qx, qy, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
            mean, _, _ = disk_gradient(i, int(states[i]), place, step, False, view, work, gauss, disk)
            for a in range(3):
                total[a] += p.color[a] * mean
                adjoint[a, LIGHTS + 6 * i + 3 + a] += w * half[a] * mean
                node = here[NODE : NODE + 3]
                for b in range(3):
                    node[b, 0] = node[b, 1] = node[b, 2] = 0.0
                disk_adjoint(i, w * half[a] * p.color[a], 0.0, view, work, disk, node, adjoint[a])
                here[2 + a, 0] += node[0, 0]
                here[2 + a, 1] += node[0, 1]
            continue
        lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2]
        inv = 1.0 / math.sqrt(lx * lx + ly * ly + lz * lz)
        cos_l = lz * inv
        gx, gy, gz = -cos_l * lx * inv * inv, -cos_l * ly * inv * inv, (1.0 - cos_l * cos_l) * inv
        column = LIGHTS + 6 * i
        for a in range(3):
            total[a] += p.color[a] * cos_l
            share = w * half[a] * p.color[a]
            adjoint[a, column] += share * gx
            adjoint[a, column + 1] += share * gy
            adjoint[a, column + 2] += share * gz
            adjoint[a, column + 3 + a] += w * half[a] * cos_l
            here[2 + a, 0] -= share * gx
            here[2 + a, 1] -= share * gy
    r = math.sqrt(x * x + y * y + h * h)
    ux, uy, uz = x / r, y / r, -h / r
    for a in range(3):
        out = adjoint[a]
        value = w * total[a]
        g = value * half[a]
        out[SHADING + 1] += 0.5 * value * (floor.bright[a] - floor.dark[a])
        out[BRIGHT + a] += 0.5 * value * shading.kd
        out[DARK + a] -= 0.5 * value * shading.kd
        drawn = pull(g, cosine, chart.lobe)
        # by d = Q - P: through the density, and through |d_z| / r^3
        bx = drawn * (lobe[0] - ux * cosine) / r - 3.0 * g * ux / r
        by = drawn * (lobe[1] - uy * cosine) / r - 3.0 * g * uy / r
        bz = drawn * (lobe[2] - uz * cosine) / r - 3.0 * g * uz / r - g / h
        out[AT_POINT] -= bx
        out[AT_POINT + 1] -= by
        out[AT_POINT + 2] -= bz
        out[AXIS] += drawn * ux
        out[AXIS + 1] += drawn * uy
        out[AXIS + 2] += drawn * uz
        add_own(g, log, out)
        bar[0], bar[1], bar[2] = bx + here[2 + a, 0], by + here[2 + a, 1], 0.0
        ride(1.0, qx, qy, bar, floor, out)
        out[GRID] += 2.0 * g / floor.cell


@inlined
def row_roots(y: float, x0: float, x1: float, crossings: int, work: Work, conics: Table[Conic], table: Array) -> int:
    """Roots of the crossing conics on a line of a square, in order, into ``table``; their number."""
    roots, which, crossing = table[_ROOTS], table[_WHICH], table[_CROSSING]
    k = 0
    for i in range(crossings):
        c = int(crossing[i])
        found = conic_roots(conics[c], y, x0, x1, work.walls, work.chart, work.quartic)
        for j in range(found):
            x = work.quartic[j]
            if x0 < x < x1 and k < roots.shape[0] - 1:
                p = k
                while p > 0 and roots[p - 1] > x:
                    roots[p], which[p] = roots[p - 1], which[p - 1]
                    p -= 1
                roots[p], which[p] = x, c
                k += 1
    return k


@jitable
def scan_row(
    y: float,
    x0: float,
    x1: float,
    crossings: int,
    lobe: Array,
    view: View,
    work: Work,
    conics: Table[Conic],
    table: Array,
) -> tuple[int, int]:
    """As ``row_roots``, and a signature of the line's structure."""
    k = row_roots(y, x0, x1, crossings, work, conics, table)
    roots, which = table[_ROOTS], table[_WHICH]
    below, above = table[_BELOW], table[_ABOVE]
    signature = 1469598103934665603
    left = x0
    for i in range(k + 1):
        right = x1 if i == k else roots[i]
        if right - left > 1e-14:
            lit = seen(left + 0.5 * (right - left), y, lobe, view, work, above)
            changed = i == 0
            for l in range(view.points.shape[0]):
                state = 1.0 + above[l] if lit else 0.0
                if state != below[l]:
                    changed = True
                below[l] = state
            if view.points.shape[0] == 0:
                changed = True
            if changed:
                signature = (signature ^ (17 + (int(which[i - 1]) if i > 0 else -1))) * 1099511628211
                for l in range(view.points.shape[0]):
                    signature = (signature ^ (3 + int(below[l]))) * 1099511628211
        left = right
    return k, signature


@inlined
def row_adjoint(
    y: float, weight: float, x0: float, x1: float, roots_found: int, nx: int, step: int, span: float, reach: float,
    lobe: Array, view: View, work: Work, conics: Table[Conic], what: Ints, gauss: Array, disk: Array | None, table:
    Array, half: Array, here: Array, own: Array, nodes: bool, adjoint: Array,
) -> None:  # fmt: skip
    """Add weight times the scanned line's integral, differentiated, to the adjoint."""
    chart = work.chart
    roots, which, below, above = table[_ROOTS], table[_WHICH], table[_BELOW], table[_ABOVE]
    left = x0
    was_lit = False
    for i in range(roots_found + 1):
        right = x1 if i == roots_found else roots[i]
        if right - left < 1e-14:
            continue
        lit = seen(left + 0.5 * (right - left), y, lobe, view, work, above)
        moves = i > 0 and what[int(which[i - 1]), 3] != 0
        if moves and (lit or was_lit) and conics[int(which[i - 1])].soft <= 0.0:
            # the root between this piece and the last one moves; nothing jumps at a penumbra's edge
            density, _, _ = grid_density(left, y, lobe, chart)
            lit_sum(left, y, step, above, view, work, gauss, disk, here[0])
            lit_sum(left, y, step, below, view, work, gauss, disk, here[1])
            jump = here[2]
            some = False
            for a in range(3):
                jump[a] = half[a] * ((here[1, a] if was_lit else 0.0) - (here[0, a] if lit else 0.0))
                some = some or jump[a] != 0.0
            if some:
                at = int(which[i - 1])
                for k in range(own.shape[0]):
                    own[k] = 0.0
                bar = here[3]
                conic_gradient(what[at, 0], what[at, 1], what[at, 2], left, y, lobe, view, work, bar, own)
                if bar[0] != 0.0:
                    scale = -weight * taper(math.hypot(left, y), reach) * density / bar[0]
                    ride(1.0, chart.point[0] + left, chart.point[1] + y, bar, view.floor, own)
                    for a in range(3):
                        for k in range(own.shape[0]):
                            adjoint[a, k] += scale * jump[a] * own[k]
        if lit and nodes:
            width = right - left
            soft = False
            for l in range(view.points.shape[0]):
                soft = soft or above[l] >= PARTLY
            n = nx
            if not soft:
                ratio = span / width
                n = min(nx, order(step, math.log(ratio + math.sqrt(1.0 + ratio * ratio))))
            work.counts.evaluations += n
            inner = n * (n - 1) // 2
            for e in range(n):
                u, along = gauss[0, inner + e], width
                if soft:
                    s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
                    u, along = s * s, width * math.pi * s * c
                x = left + width * u
                w = weight * taper(math.hypot(x, y), reach) * along * gauss[1, inner + e]
                grid_node(x, y, w, step, above, lobe, view, work, gauss, disk, half, here, adjoint)
        for l in range(view.points.shape[0]):
            below[l] = above[l]
        was_lit = lit
        left = right


@jitable
def cut_strips(
    a: float, b: float, x0: float, x1: float, crossings: int, lobe: Array, view: View, work: Work, conics: Table[Conic],
    table: Array, top: int,
) -> int:  # fmt: skip
    """Cut a..b where the structure of its lines changes and stack the strips (from, to, depth); new height."""
    stack = table[_STACK]
    inset = 1e-9 * (b - a)
    start = a
    left = a + inset
    _, before = scan_row(left, x0, x1, crossings, lobe, view, work, conics, table)
    for i in range(1, 5):
        right = b - inset if i == 4 else a + (b - a) * i / 4.0
        _, after = scan_row(right, x0, x1, crossings, lobe, view, work, conics, table)
        tries = 0
        while after != before and tries < 6:
            tries += 1
            low, high = left, right
            while high - low > 1e-15 * (1.0 + abs(low)):
                middle = 0.5 * (low + high)
                if middle in (low, high):
                    break
                _, found = scan_row(middle, x0, x1, crossings, lobe, view, work, conics, table)
                if found == before:
                    low = middle
                else:
                    high = middle
            if 3 * top + 5 < stack.shape[0]:
                stack[3 * top], stack[3 * top + 1], stack[3 * top + 2] = start, high, 0.0
                top += 1
            start = high
            left = high + inset
            if not left < right:
                before = after
                break
            _, before = scan_row(left, x0, x1, crossings, lobe, view, work, conics, table)
        left, before = right, after
    if 3 * top + 5 < stack.shape[0] and start < b:
        stack[3 * top], stack[3 * top + 1], stack[3 * top + 2] = start, b, 0.0
        top += 1
    return top


@jitable
def strip_adjoint(
    a: float, b: float, n: int, sign: float, x0: float, x1: float, crossings: int, nx: int, step: int, span: float,
    reach: float, lobe: Array, view: View, work: Work, conics: Table[Conic], what: Ints, gauss: Array, disk: Array |
    None, table: Array, half: Array, here: Array, own: Array, nodes: bool, adjoint: Array,
) -> None:  # fmt: skip
    """The adjoint of a strip by ``n`` lines, with a square-root map at both ends."""
    for row in range(adjoint.shape[0]):
        for k in range(adjoint.shape[1]):
            adjoint[row, k] = 0.0
    base = n * (n - 1) // 2
    for q in range(n):
        u = gauss[0, base + q]
        s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
        y = a + (b - a) * s * s
        slope = sign * gauss[1, base + q] * (b - a) * math.pi * s * c
        k = row_roots(y, x0, x1, crossings, work, conics, table)
        row_adjoint(
            y, slope, x0, x1, k, nx, step, span, reach, lobe, view, work, conics, what, gauss, disk, table, half, here,
            own, nodes, adjoint,
        )  # fmt: skip


@jitable
def square_adjoint(
    x0: float, y0: float, size: float, sign: float, step: int, log_rho: float, reach: float, share: float, crossings:
    int, lobe: Array, view: View, work: Work, conics: Table[Conic], what: Ints, gauss: Array, disk: Array | None, table:
    Array, half: Array, here: Array, own: Array, nodes: bool, adjoint: Array, moves: Array, low: Array, high: Array,
    out: Array,
) -> float:  # fmt: skip
    """Add the derivatives of a square that some conics cross to ``out`` (parameters, 4); their error estimate."""
    x1, y1 = x0 + size, y0 + size
    cuts, crossing, stack = table[_CUTS], table[_CROSSING], table[_STACK]
    k = square_cuts(x0, x1, y0, y1, crossing, crossings, conics, cuts, table[_KINDS])
    top = 0
    for i in range(k - 1):
        if cuts[i + 1] - cuts[i] > 1e-13 * size:
            top = cut_strips(cuts[i], cuts[i + 1], x0, x1, crossings, lobe, view, work, conics, table, top)
    error = 0.0
    # the length over which the integrand is tame
    span = size * math.sinh(log_rho)
    nx = min(MAX_ORDER, order(step, log_rho))
    for i in range(crossings):
        if conics[int(crossing[i])].soft > 0.0:
            nx = max(nx, min(MAX_ORDER, order(step, SOFT_LOG)))
    while top > 0:
        top -= 1
        a, b, depth = stack[3 * top], stack[3 * top + 1], stack[3 * top + 2]
        n = min(MAX_ORDER - 2, max(3, order(step, log_rho * 0.7)))
        for p in range(moves.shape[0]):
            for c in range(4):
                low[p, c] = high[p, c] = 0.0
        strip_adjoint(
            a, b, n, sign, x0, x1, crossings, nx, step, span, reach, lobe, view, work, conics, what, gauss, disk, table,
            half, here, own, nodes, adjoint,
        )  # fmt: skip
        contract(adjoint, moves, low, 1.0)
        strip_adjoint(
            a, b, n + 2, sign, x0, x1, crossings, nx, step, span, reach, lobe, view, work, conics, what, gauss, disk,
            table, half, here, own, nodes, adjoint,
        )  # fmt: skip
        contract(adjoint, moves, high, 1.0)
        change = 0.0
        for p in range(moves.shape[0]):
            for c in range(3):
                change = max(change, abs(high[p, c] - low[p, c]))
        if change > share and depth < 10.0 and 3 * top + 8 < stack.shape[0]:
            m = 0.5 * (a + b)
            stack[3 * top], stack[3 * top + 1], stack[3 * top + 2] = a, m, depth + 1.0
            stack[3 * top + 3], stack[3 * top + 4], stack[3 * top + 5] = m, b, depth + 1.0
            top += 2
            continue
        for p in range(moves.shape[0]):
            for c in range(3):
                out[p, c] += high[p, c]
        error += change
    return error


@jitable
def replay_once(
    tol: float, reach: float, low_x: float, low_y: float, level: int, lowest: float, count: int, lobe: Array, view:
    View, work: Work, conics: Table[Conic], what: Ints, gauss: Array, disk: Array | None, table: Array, here: Array,
    own: Array, nodes: bool, adjoint: Array, moves: Array, low: Array, high: Array, square: Array, out: Array,
    max_evaluations: int,
) -> float:  # fmt: skip
    """The derivatives under one taper, ``out`` (parameters, 4); their error estimate.

    The blocks are those of ``split_grid``; how fine a block's rule must be is judged by what the block can hold.
    """
    chart, floor = work.chart, view.floor
    cell = floor.cell
    half, contrast = table[_STACK + 1], contrast_of(view)
    for a in range(3):
        half[a] = 0.5 * view.shading.kd * (floor.bright[a] - floor.dark[a])
    states, blocks = table[_ABOVE], table[_BLOCKS:]
    light = most_floor_light(view)
    aim = 0.1 * tol / max(contrast, 1e-300) / LEAVES
    error = 0.0
    for p in range(moves.shape[0]):
        for c in range(4):
            out[p, c] = 0.0
    blocks[0, 0], blocks[0, 1], blocks[0, 2], blocks[0, 3] = low_x, low_y, cell * 2.0**level, level
    top = 1
    while top > 0:
        top -= 1
        x0, y0, side, level = blocks[top, 0], blocks[top, 1], blocks[top, 2], int(blocks[top, 3])
        bound, span, near = block_bound(x0, y0, side, reach, light, lobe, view, chart)
        work.counts.labour += 1
        ran_out = max(work.counts.evaluations, work.counts.labour) > max_evaluations
        if bound <= 0.01 * aim / (1.0 + near / cell) or ran_out:
            # a derivative may be larger than what is differentiated, by the inverse of its lengths
            error += 100.0 * contrast * bound
            continue
        middle = 0.5 * side
        if not nodes:
            moved = False
            for k in range(count):
                moved = moved or (what[k, 3] != 0 and may_cross(conics[k], x0 + middle, y0 + middle, middle))
            if not moved:
                continue
        ratio = span / side
        quarter = ratio < 0.8
        sign = lowest * block_sign(x0 - low_x, y0 - low_y, side, view.floor)
        for p in range(moves.shape[0]):
            for c in range(4):
                square[p, c] = 0.0
        if not quarter:
            log_rho = math.log(ratio + math.sqrt(1.0 + ratio * ratio))
            crossings = 0
            for k in range(count):
                if may_cross(conics[k], x0 + middle, y0 + middle, middle) and crossings < table.shape[1]:
                    table[_CROSSING, crossings] = k
                    crossings += 1
                    if level > 0:
                        break
            fall = max(1.0, math.log(bound / aim))
            step = step_of(fall)
            if crossings == 0:
                if not seen(x0 + middle, y0 + middle, lobe, view, work, states):
                    continue
                n = 1 + max(2, math.ceil((0.5 * fall if level == 0 else fall - 0.693 * level) / log_rho))
                quarter = n > MAX_BLOCK_ORDER
                if not quarter:
                    base = n * (n - 1) // 2
                    weights = gauss[1] if level == 0 else gauss[3 + level]
                    work.counts.evaluations += n * n
                    for row in range(4):
                        for k in range(adjoint.shape[1]):
                            adjoint[row, k] = 0.0
                    for q in range(n):
                        y = y0 + side * gauss[0, base + q]
                        for e in range(n):
                            x = x0 + side * gauss[0, base + e]
                            w = sign * weights[base + q] * weights[base + e] * side * side
                            w *= taper(math.hypot(x, y), reach)
                            grid_node(x, y, w, step, states, lobe, view, work, gauss, disk, half, here, adjoint)
                    contract(adjoint, moves, square, 1.0)
                    most = 0.0
                    for p in range(moves.shape[0]):
                        for c in range(3):
                            most = max(most, abs(square[p, c]))
                    if level == 0:
                        error += most * math.exp(-2.0 * (n - 1) * log_rho)
                    else:
                        error += 10.0 * contrast * bound * 2.0**-level * math.exp(-n * log_rho)
            elif level > 0:
                quarter = True
            else:
                error += square_adjoint(
                    x0, y0, side, sign, step, log_rho, reach, 0.5 * tol / LEAVES, crossings, lobe, view, work, conics,
                    what, gauss, disk, table, half, here, own, nodes, adjoint, moves, low, high, square,
                )  # fmt: skip
        if quarter:
            if side < SMALLEST * cell or top + 4 > blocks.shape[0]:
                error += 100.0 * contrast * bound
                continue
            top = push_quarters(x0, y0, side, level, blocks, top)
            continue
        for p in range(moves.shape[0]):
            for c in range(4):
                out[p, c] += square[p, c]
    return error


@jitable
def tail_slopes(
    rows: Table[Remainder], n: int, nodes: bool, lobe: Array, view: View, work: Work, conics: Table[Conic], what: Ints,
    bar: Array, own: Array, moves: Array,
) -> float:  # fmt: skip
    """Estimate of what ``n`` places beyond the taper leave of the derivatives: the largest of all parameters.

    What a place holds changes by ``swing`` for every unit by which a wall moves across the checker there.
    """
    largest, contrast = 0.0, contrast_of(view)
    for p in range(moves.shape[0]):
        tint, other = 0.0, 0.0
        for k in range(moves.shape[1]):
            if BRIGHT <= k < DARK + 3:
                tint = max(tint, abs(moves[p, k]))
            else:
                other = max(other, abs(moves[p, k]))
        total = 0.0
        for k in range(n):
            row = rows[k]
            # of the two colours the value is linear
            total += 0.5 * abs(view.shading.kd) * tint * row.left / max(contrast, 1e-300)
            if nodes and other > 0.0:
                # slopes in places and exponents are larger than what they are of
                total += row.left * steepness(10.0, work.chart.lobe)
            for end in range(2):
                at = row.wall if end == 0 else row.other
                if at < 0 or what[at, 3] == 0:
                    continue
                for c in range(own.shape[0]):
                    own[c] = 0.0
                conic_gradient(what[at, 0], what[at, 1], what[at, 2], row.x, row.y, lobe, view, work, bar, own)
                ride(1.0, work.chart.point[0] + row.x, work.chart.point[1] + row.y, bar, view.floor, own)
                moved = 0.0
                for c in range(own.shape[0]):
                    moved += own[c] * moves[p, c]
                total += row.swing * abs(moved) / max(math.sqrt(bar[0] * bar[0] + bar[1] * bar[1]), 1e-300)
        largest = max(largest, total)
    return REST * contrast * largest


@jitable
def replay_grid(
    tol: float, own_shape: int, lobe: Array, view: View, work: Work, conics: Table[Conic], remainders: Table[Remainder],
    what: Ints, gauss: Array, disk: Array | None, table: Array, here: Array, own: Array, nodes: bool, adjoint: Array,
    moves: Array, low: Array, high: Array, square: Array, shorter: Array, longer: Array, value: Array, max_evaluations:
    int,
) -> float:  # fmt: skip
    """Add the derivatives of what the checker adds to a floor of mean albedo to ``value``; their error estimate.

    ``work`` holds the floor chart of the point, ``nodes`` is that of ``what_moves``. Where the squares are endless the
    taper's reach is doubled until the derivatives no longer change, and what no taper has seen is small: walls that
    move far out fall off more slowly than the value does.
    """
    chart, floor = work.chart, view.floor
    cell = floor.cell
    count = floor_conics(own_shape, lobe, view, work, conics)
    if count > conics.shape[0]:
        return math.inf
    name_conics(view, work, what)
    if not moving_conics(count, nodes, moves, view, what) and not nodes:
        return 0.0
    px, py = chart.point[0] - floor.offset[0], chart.point[1] - floor.offset[1]
    whole, reach, far, east, north, beyond = grid_reach(REPLAY_REACH, lobe, view, work)
    ci, cj = math.floor((px + east) / cell), math.floor((py + north) / cell)
    lowest = 1.0 if (ci + cj) % 2 == 0 else -1.0
    passes, before = 0, math.inf
    while True:
        level = block_level(far / cell)
        first = 2.0 ** (level - 1)
        error = replay_once(
            tol, reach, (ci - first) * cell - px, (cj - first) * cell - py, level, lowest, count, lobe, view, work,
            conics, what, gauss, disk, table, here, own, nodes, adjoint, moves, low, high, square, longer,
            max_evaluations,
        )  # fmt: skip
        change = 0.0 if whole else math.inf
        if passes > 0:
            change = 0.0
            for p in range(moves.shape[0]):
                for c in range(3):
                    change = max(change, 3.0 * abs(longer[p, c] - shorter[p, c]))
        if not whole:
            n = remainders_of(
                0.1 * min(1.0, cell) * tol / max(contrast_of(view), 1e-300), reach, lobe, view, work, conics, count,
                table[_ABOVE], table[_BLOCKS : _BLOCKS + 8], remainders,
            )  # fmt: skip
            change += tail_slopes(remainders, n, nodes, lobe, view, work, conics, what, here[0], own, moves)
        ran_out = max(work.counts.evaluations, work.counts.labour) > max_evaluations
        if ran_out and error + change > before:
            # what the last reach gave stands
            error, change = before, 0.0
            for p in range(moves.shape[0]):
                for c in range(4):
                    longer[p, c] = shorter[p, c]
            break
        if whole or ran_out or error + change <= tol:
            break
        if passes > 0 and (1.5 * far > MOST_REPLAY_REACH * cell or error >= change):
            break
        for p in range(moves.shape[0]):
            for c in range(4):
                shorter[p, c] = longer[p, c]
        passes, before = passes + 1, error + change
        reach = far = min(2.0 * reach, max(reach, MOST_REPLAY_REACH * cell))
    for p in range(moves.shape[0]):
        for c in range(4):
            value[p, c] += longer[p, c]
    # slopes in places and exponents are larger than what they are of
    return float(error + change + beyond * steepness(10.0, chart.lobe))
