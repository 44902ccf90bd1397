"""The adjoint of one scan line: what everything in the scene does to the line's integral.

On a line the cells' ends are roots x_w of walls, so

    d/dp of the sum over cells of int F dx  =  sum of int F_p dx  +  sum over walls of (F below - F above) dx_w/dp,

with F = radiance x solid angle x lobe density analytic on every closed cell: no delta, and the same Gauss rule. Nodes
and walls both only know their gradients in Q, N, w and in the scene's numbers; ``pull_back`` turns them into columns
of the adjoint, three rows (one a channel) for any number of parameters.

``disk`` is the scratch of ``disk_gradient``, or None in a scene without exact disks: kernels are compiled for either.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_adjoint, disk_gradient, monitor
from symrender.adjoint.light_term import BAR_ROWS, offset_gradient
from symrender.adjoint.lobe import add_own, log_density_at, pull
from symrender.adjoint.walls import (
    AMBIENT,
    AXIS,
    BACKGROUND,
    BRIGHT,
    CHART,
    CUT_BY,
    EYE,
    FACING,
    FREQUENCY,
    HIT,
    LIGHTS,
    ONE_SIDED,
    PLACE_ROWS,
    SHADING,
    TOWARD,
    along_line,
    chart_place,
    condition_of,
    on_a_parallel,
    pull_back,
    rim_gradient,
    wall_gradient,
)
from symrender.adjoint.walls import DARK as DARK_COLUMN
from symrender.chambers.labels import BEYOND_SEAM, GLINT, HIDDEN, PARTLY
from symrender.chambers.labels import DARK as UNLIT
from symrender.chambers.line import LIMB, POLE_END, RIM_HIGH, RIM_LOW
from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.lobes.density import density_of, rim_density
from symrender.chambers.lobes.width import blunt_rim, rim_power, steepening
from symrender.chambers.records import Chart
from symrender.chambers.walls import FLOOR_CUT, HORIZON, TEXTURE_EDGE
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.leaves.slopes import marble_slopes
from symrender.leaves.values import marble
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import FALLS, MAX_ORDER, MIDDLE, order
from symrender.quadrature.light_term import light_term
from symrender.quadrature.line_poles import cell_order, find_poles
from symrender.quadrature.split_line import SOFT_LOG, disk_edge, tail_error
from symrender.scene.arrays import EYE as FROM_EYE
from symrender.scene.arrays import MARBLE, PHONG

Array = npt.NDArray[np.float64]

# scratch: a place, then for each channel gradients in Q, N and the view direction, then those of one light or wall,
# then the view direction and two rows of radiances
NODE = PLACE_ROWS
BAR = NODE + 9
VIEW_ROW = BAR + BAR_ROWS
RADIANCE = VIEW_ROW + 1
HERE_ROWS = RADIANCE + 2

ON_SEAM = 1e-9
"""y of a normal within which it is taken to lie on the seam of a texture."""
MAX_HALVINGS = 16
"""Most halvings of one cell of a line whose light is less smooth than the walls tell."""
# how nodes are placed in a piece of a cell
_EVEN = 0
_SOFT = 1
"""Denser at both ends, like the sine's square."""
_RIM_FIRST = 2
_RIM_LAST = 3
"""Like a power of the distance from the blunt rim at its first, or last, end."""
NEAR_RIM = 1e-4
"""Share of a piece, from the rim on, in which the cosine is not read off directions: rounding there is all of it."""


@jitable
def log_density(here: Array, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """``log_density_at`` the direction of a place."""
    chord = 0.0
    for a in range(3):
        chord += (here[TOWARD, a] - lobe[a]) ** 2
    return log_density_at(0.5 * chord, chart.lobe)


@inlined
def set_view(here: Array, view: View, chart: Chart) -> float:
    """Direction a highlight at this place is seen along, into its row; the distance to the eye, 0 if the ray's own."""
    if view.shading.highlight_view != FROM_EYE:
        for a in range(3):
            here[VIEW_ROW, a] = -here[TOWARD, a]
        return 0.0
    far2 = 0.0
    for a in range(3):
        here[VIEW_ROW, a] = view.eye[a] - chart.point[a] - here[HIT, a]
        far2 += here[VIEW_ROW, a] ** 2
    far = math.sqrt(max(far2, 1e-300))
    for a in range(3):
        here[VIEW_ROW, a] /= far
    return far


@inlined
def radiance(
    side: int, lit: npt.NDArray[np.uint8], step: int, here: Array, view: View, work: Work, gauss: Array,
    disk: Array | None, out: Array
) -> None:  # fmt: skip
    """Radiance minus background of a place as of the cell (side, lit); ``out`` (3,). Zero where it is hidden."""
    chart = work.chart
    out[0] = out[1] = out[2] = 0.0
    if side == HIDDEN:
        return
    j = chart.shape_index
    shading = view.shading
    factor = 1.0
    if j >= 0:
        factor = 1.0 if side == 1 else view.spheres[j].dark
        if view.spheres[j].texture == MARBLE:
            n = here[FACING]
            # on the seam the side tells, and not how the normal is rounded
            ny = n[1] if abs(n[1]) > ON_SEAM else math.copysign(n[1], -1.0 if side == BEYOND_SEAM else 1.0)
            factor = marble(n[0], ny, n[2], view.spheres[j].ku, view.spheres[j].kv)
    ambient = 0.0 if j < 0 and chart.side < 0.0 else shading.ka
    for i in range(view.points.shape[0]):
        if lit[i] == UNLIT:
            continue
        p, n, v = view.points[i], here[FACING], here[VIEW_ROW]
        qx, qy, qz = chart.point[0] + here[HIT, 0], chart.point[1] + here[HIT, 1], chart.point[2] + here[HIT, 2]
        cosine, gleam = light_term(
            p.position[0] - qx,
            p.position[1] - qy,
            p.position[2] - qz,
            n[0],
            n[1],
            n[2],
            v[0],
            v[1],
            v[2],
            shading.model == PHONG,
            shading.shininess,
        )
        if disk is not None and p.radius > 0.0:
            place = LitPoint(qx, qy, qz, n[0], n[1], n[2], v[0], v[1], v[2])
            cosine, gleam = disk_term(i, int(lit[i]), place, step, shading.ks != 0.0, view, work, gauss)
        for a in range(3):
            albedo = factor * (view.spheres[j].color[a] if j >= 0 else chart.albedo[a])
            diffuse = albedo * shading.kd * cosine if lit[i] != GLINT else 0.0
            out[a] += view.points[i].color[a] * (diffuse + shading.ks * gleam)
    for a in range(3):
        out[a] += ambient * shading.ambient[a] - shading.background[a]


@inlined
def node_adjoint(
    weight: float, slope_k: float, cosine: float, log: float, cell: int, step: int, lobe: Array, view: View,
    work: Work, gauss: Array, disk: Array | None, here: Array, adjoint: Array,
) -> float:  # fmt: skip
    """Add one node of a line, of ``weight`` (its density and solid angle included), to the adjoint (4, columns).

    Returns a number that is as smooth along the line as the radiance and the gradients of the disks' light.
    """
    told = 0.0
    chart, shading = work.chart, view.shading
    j = chart.shape_index
    side = work.cell_side[cell]
    marble = j >= 0 and view.spheres[j].texture == MARBLE
    factor, by_nx, by_ny, by_nz, by_ku, by_kv = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if marble:
        n = here[FACING]
        factor, by_nx, by_ny, by_nz, by_ku, by_kv = marble_slopes(
            n[0], n[1], n[2], view.spheres[j].ku, view.spheres[j].kv
        )
    elif j >= 0 and side != 1:
        factor = view.spheres[j].dark
    ka = 0.0 if j < 0 and chart.side < 0.0 else shading.ka
    far = set_view(here, view, chart)
    for row in range(9):
        for a in range(3):
            here[NODE + row, a] = 0.0
    for a in range(3):
        here[RADIANCE, a] = here[RADIANCE + 1, a] = 0.0
    qx, qy, qz = chart.point[0] + here[HIT, 0], chart.point[1] + here[HIT, 1], chart.point[2] + here[HIT, 2]
    facing, seen_along = here[FACING], here[VIEW_ROW]
    place = LitPoint(
        qx, qy, qz, facing[0], facing[1], facing[2], seen_along[0], seen_along[1], seen_along[2]
    )  # fmt: skip
    for i in range(view.points.shape[0]):
        state = work.lit[cell, i]
        if state == UNLIT:
            continue
        column = LIGHTS + 6 * i
        point = view.points[i]
        is_disk = point.radius > 0.0
        shown = 0.0 if state == GLINT else 1.0
        bar = here[BAR : BAR + BAR_ROWS]
        bare, gleam, by_shininess = 0.0, 0.0, 0.0
        # a branch of its own, so that the code of disks is only compiled where there are some
        if disk is not None and is_disk:
            bare, gleam, by_shininess = disk_gradient(i, int(state), place, step, True, view, work, gauss, disk)
            strength = weight * (point.color[0] + point.color[1] + point.color[2])
            told += monitor(strength * shading.kd * factor, strength * shading.ks, disk)
        if not is_disk:
            asked = Gleam(shading.model == PHONG, shading.shininess, True)
            bare, gleam, by_shininess = offset_gradient(
                point.position[0] - qx, point.position[1] - qy, point.position[2] - qz, place, asked, bar
            )  # fmt: skip
        lit = shown * bare
        for a in range(3):
            color = point.color[a]
            albedo = factor * (view.spheres[j].color[a] if j >= 0 else chart.albedo[a])
            out = adjoint[a]
            here[RADIANCE, a] += color * lit
            here[RADIANCE + 1, a] += color * gleam
            out[column + 3 + a] += weight * (albedo * shading.kd * lit + shading.ks * gleam)
            out[SHADING + 3] += weight * shading.ks * color * by_shininess
            diffuse = weight * color * shading.kd * albedo * shown
            highlight = weight * color * shading.ks
            node = here[NODE + 3 * a : NODE + 3 * a + 3]
            if disk is not None and is_disk:
                disk_adjoint(i, diffuse, highlight, view, work, disk, node, out)
            if is_disk:
                continue
            for b in range(3):
                share = diffuse * bar[0, b] + highlight * bar[2, b]
                out[column + b] += share
                node[0, b] -= share
                node[1, b] += diffuse * bar[1, b] + highlight * bar[3, b]
                node[2, b] += highlight * bar[4, b]
    for a in range(3):
        out = adjoint[a]
        color = view.spheres[j].color[a] if j >= 0 else chart.albedo[a]
        diffuse, gleams = here[RADIANCE, a], here[RADIANCE + 1, a]
        reflected = shading.kd * diffuse
        total = weight * (
            factor * color * reflected + ka * shading.ambient[a] + shading.ks * gleams - shading.background[a]
        )
        told += total
        if ka != 0.0 or j >= 0 or chart.side > 0.0:
            out[SHADING] += weight * shading.ambient[a]
        out[SHADING + 1] += weight * factor * color * diffuse
        out[SHADING + 2] += weight * gleams
        out[AMBIENT + a] += weight * ka
        out[BACKGROUND + a] -= weight
        if j >= 0:
            out[BRIGHT + a] += weight * factor * reflected
            if marble:
                share = weight * color * reflected
                here[NODE + 3 * a + 1, 0] += share * by_nx
                here[NODE + 3 * a + 1, 1] += share * by_ny
                here[NODE + 3 * a + 1, 2] += share * by_nz
                out[FREQUENCY] += share * by_ku
                out[FREQUENCY + 1] += share * by_kv
            elif side != 1:
                out[DARK_COLUMN] += weight * color * reflected
        else:
            out[BRIGHT + a] += 0.5 * weight * reflected
            out[DARK_COLUMN + a] += 0.5 * weight * reflected
        drawn = pull(total, cosine, chart.lobe)
        node = here[NODE + 3 * a : NODE + 3 * a + 3]
        if far > 0.0:
            along = 0.0
            for b in range(3):
                along += node[2, b] * here[VIEW_ROW, b]
            for b in range(3):
                turn = (node[2, b] - along * here[VIEW_ROW, b]) / far
                out[EYE + b] += turn
                node[0, b] -= turn
                node[2, b] = 0.0
        for b in range(3):
            node[2, b] = drawn * lobe[b] - node[2, b]
            out[AXIS + b] += drawn * here[TOWARD, b]
        add_own(total, log, out)
        out[CHART] += total * slope_k
        pull_back(1.0, node, here, j < 0, out)
    return told


@jitable
def wall_adjoint(
    i: int, tag: int, scale: float, jump: Array, lobe: Array, view: View, work: Work, here: Array, own: Array,
    adjoint: Array, first: int, last: int,
) -> None:  # fmt: skip
    """Add scale x jump_c x (how wall ``i``, as of condition ``tag``, moves along the line) to rows first..last - 1."""
    bar = here[BAR : BAR + 3]
    for k in range(own.shape[0]):
        own[k] = 0.0
    if i < 0:
        rim_gradient(here, work, lobe, bar, own)
    else:
        wall_gradient(i, tag, here, view, work, bar, own)
    slope = along_line(bar, here)
    if slope == 0.0:
        return
    pull_back(1.0, bar, here, work.chart.shape_index < 0.0, own)
    for c in range(first, last):
        weight = -scale * jump[c % 3] / slope
        if weight != 0.0:
            for k in range(own.shape[0]):
                adjoint[c, k] += weight * own[k]


@inlined
def walls_adjoint(
    c: float, s: float, weight: float, step: int, lobe: Array, view: View, work: Work, gauss: Array,
    disk: Array | None, here: Array, own: Array, moving: Array, adjoint: Array,
) -> None:  # fmt: skip
    """Add the moving ends of all cells of the scanned line (c, s); ``moving`` is that of ``what_moves``."""
    chart = work.chart
    cells = work.counts.cells
    above, below = here[RADIANCE], here[RADIANCE + 1]
    for cell in range(cells + 1):
        wall = work.cell_wall[cell]
        if wall in (POLE_END, LIMB):
            # at the pole and at the limb the solid angle vanishes, and neither moves
            continue
        if moving[wall // 4 if wall >= 0 else moving.shape[0] - 1] == 0.0:
            continue
        if disk_edge(wall, work):
            # nothing jumps where a disk begins or ends to be hidden
            continue
        side_above = work.cell_side[cell] if cell < cells else HIDDEN
        side_below = work.cell_side[cell - 1] if cell > 0 else HIDDEN
        if side_above == HIDDEN and side_below == HIDDEN:
            continue
        x = work.cell_from[cell] if cell < cells else work.cell_to[cells - 1]
        if not x > 0.0:
            continue
        measure, _ = chart_place(x, c, s, chart, here)
        density = rim_density(chart.lobe) if wall < 0 else log_density(here, lobe, chart)[2]
        set_view(here, view, chart)
        work.counts.evaluations += 2
        radiance(side_above, work.lit[min(cell, cells - 1)], step, here, view, work, gauss, disk, above)
        radiance(side_below, work.lit[max(cell - 1, 0)], step, here, view, work, gauss, disk, below)
        for a in range(3):
            above[a] = below[a] - above[a]
        if above[0] == 0.0 and above[1] == 0.0 and above[2] == 0.0:
            continue
        scale = weight * measure * density
        if wall < 0:
            wall_adjoint(-1, 0, scale, above, lobe, view, work, here, own, adjoint, 0, 3)
            continue
        hidden = side_above == HIDDEN or side_below == HIDDEN
        tag = condition_of(wall // 4, here, hidden, view, work)
        if tag < 0:
            # several conditions meet here and none is known to be the one that moves
            for column in range(adjoint.shape[1]):
                adjoint[ONE_SIDED, column] = 1.0
            continue
        wall_adjoint(wall // 4, tag, scale, above, lobe, view, work, here, own, adjoint, 0, 3)
        j = chart.shape_index
        merged = work.walls[wall // 4].tag > FLOOR_CUT
        if j >= 0 and merged and (tag == HORIZON or tag >= CUT_BY) and on_a_parallel(here, view.spheres[j]):
            # a field of another colour lies just beyond: from the other side the derivative is another one
            wall_adjoint(wall // 4, tag, scale, above, lobe, view, work, here, own, adjoint, 3, 4)
            # the row's axis is that of the parallel too
            wall_adjoint(wall // 4, TEXTURE_EDGE, -scale, above, lobe, view, work, here, own, adjoint, 3, 4)


@inlined
def soft_cell(cell: int, view: View, work: Work) -> bool:
    """Whether a cell's integrand ends with a broken power: at a wall of a disk light, or beside a blunt lobe's rim."""
    if blunt_rim(work.chart.lobe) and (is_rim(work.cell_wall[cell]) or is_rim(work.cell_wall[cell + 1])):
        return True
    if disk_edge(work.cell_wall[cell], work) or disk_edge(work.cell_wall[cell + 1], work):
        for i in range(view.points.shape[0]):
            if work.lit[cell, i] >= PARTLY:
                return True
    return False


@inlined
def is_rim(wall: int) -> bool:
    """Whether the end of a cell lies on the lobe's rim."""
    return bool(wall in (RIM_LOW, RIM_HIGH))


@inlined
def piece_map(a: float, end: float, cell: int, soft: bool, work: Work) -> int:
    """How nodes are placed in the piece a..end of a cell; -1 where the rim is at both ends and it must be cut."""
    if blunt_rim(work.chart.lobe) and work.chart.lobe.rim_cos == 0.0:
        first = a == work.cell_from[cell] and is_rim(work.cell_wall[cell])
        last = end == work.cell_to[cell] and is_rim(work.cell_wall[cell + 1])
        if first and last:
            return -1
        if first:
            return _RIM_FIRST
        if last:
            return _RIM_LAST
    return _SOFT if soft else _EVEN


@inlined
def cosine_at(x: float, c: float, s: float, lobe: Array, chart: Chart, here: Array) -> float:
    """cos(theta) of a place of a scan line, also beyond the rim."""
    chart_place(x, c, s, chart, here)
    return float(here[TOWARD, 0] * lobe[0] + here[TOWARD, 1] * lobe[1] + here[TOWARD, 2] * lobe[2])


@jitable
def piece_adjoint(
    a: float, end: float, n: int, c: float, s: float, weight: float, placed: int, cell: int, step: int, lobe: Array,
    view: View, work: Work, gauss: Array, disk: Array | None, here: Array, adjoint: Array,
) -> tuple[float, float]:  # fmt: skip
    """Add a piece of a cell by ``n`` nodes, ``placed`` as of ``piece_map``.

    Of what ``node_adjoint`` tells, the size and the rule's error are returned.
    """
    chart = work.chart
    base = n * (n - 1) // 2
    work.counts.evaluations += n
    whole, last, before, middle, lower = 0.0, 0.0, 0.0, 0.0, 0.0
    length = end - a
    rise, bend, power = 0.0, 0.0, 1.0
    if placed in (_RIM_FIRST, _RIM_LAST):
        # the cosine is rise t + bend t^2 at a share t of the piece off the rim
        power = rim_power(chart.lobe)
        near, half = NEAR_RIM * length, 0.5 * NEAR_RIM * length
        if placed == _RIM_FIRST:
            one, two = cosine_at(a + near, c, s, lobe, chart, here), cosine_at(a + half, c, s, lobe, chart, here)
        else:
            one, two = cosine_at(end - near, c, s, lobe, chart, here), cosine_at(end - half, c, s, lobe, chart, here)
        rise = (4.0 * two - one) / NEAR_RIM
        bend = 2.0 * (one - 2.0 * two) / (NEAR_RIM * NEAR_RIM)
    for q in range(n):
        u, along = gauss[0, base + q], length
        off = 1.0
        if placed == _SOFT:
            # the slope of a disk's light ends with the square root of the distance from a wall
            su, cu = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
            u, along = su * su, along * math.pi * su * cu
        elif placed == _RIM_FIRST:
            off = u**power
            u, along = off, along * power * off / u
        elif placed == _RIM_LAST:
            off = (1.0 - u) ** power
            u, along = 1.0 - off, along * power * off / (1.0 - u)
        measure, slope_k = chart_place(a + length * u, c, s, chart, here)
        cosine, log, density = log_density(here, lobe, chart)
        if off < NEAR_RIM and rise > 0.0:
            cosine = max(1e-300, off * (rise + off * bend))
            log = math.log(cosine)
            density = density_of(log, chart.lobe)
        if density == 0.0:
            continue
        w = weight * gauss[1, base + q] * along * measure * density
        told = node_adjoint(w, slope_k, cosine, log, cell, step, lobe, view, work, gauss, disk, here, adjoint)
        if power != 1.0:
            # as smooth as the density's slope
            told *= steepening(cosine, chart.lobe)
        whole += abs(told)
        last += told * gauss[2, base + q]
        before += told * gauss[3, base + q]
        middle += told * gauss[MIDDLE, base + q]
        lower += told * gauss[MIDDLE + 1, base + q]
    middle = max(abs(middle), abs(lower))
    miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, 0.0)
    if placed != _EVEN and n > 2 and blunt_rim(chart.lobe):
        miss = max(miss, 0.5 * abs(last), 0.25 * abs(before))
    return whole, miss


@inlined
def piece_order(a: float, end: float, step: int, soft: bool, work: Work) -> int:
    """Gauss nodes of a piece of a cell; above ``MAX_ORDER`` it must be cut."""
    n: int = cell_order(a, end, step, work)
    return max(n + (n + 1) // 2, order(step, SOFT_LOG)) if soft else n


@inlined
def line_adjoint(
    phi: float, weight: float, step: int, lobe: Array, view: View, work: Work, gauss: Array, disk: Array | None,
    here: Array, own: Array, nodes: bool, moving: Array, adjoint: Array,
) -> tuple[float, float]:  # fmt: skip
    """Add ``weight`` times the scanned line's integral, differentiated, to ``adjoint``; ``step`` chooses the orders.

    The nodes are those of ``integrate_cells``. ``adjoint`` is (4, columns): a row a channel and ``ONE_SIDED``.
    ``nodes`` and ``moving``, of ``what_moves``, tell what need not be visited. Returned are the size of what
    ``node_adjoint`` tells, and the error of the rules along the line in the same units.
    """
    c, s = math.cos(phi), math.sin(phi)
    walls_adjoint(c, s, weight, step, lobe, view, work, gauss, disk, here, own, moving, adjoint)
    size, missed = 0.0, 0.0
    if not nodes:
        return size, missed
    promise = 100.0 * FALLS[step]
    find_poles(phi, c, s, view, work)
    for cell in range(work.counts.cells):
        if work.cell_side[cell] == HIDDEN:
            continue
        a, stop = work.cell_from[cell], work.cell_to[cell]
        soft = soft_cell(cell, view, work)
        end = stop
        halvings = 0
        while a < stop:
            placed = piece_map(a, end, cell, soft, work)
            if placed < 0:
                end = a + 0.5 * (end - a)
                placed = piece_map(a, end, cell, soft, work)
            n = piece_order(a, end, step, soft, work)
            while n > MAX_ORDER and not is_spent(work):
                end = a + 0.5 * (end - a)
                placed = piece_map(a, end, cell, soft, work)
                n = piece_order(a, end, step, soft, work)
            n = min(n, MAX_ORDER)
            whole, miss = piece_adjoint(
                a, end, n, c, s, weight, placed, cell, step, lobe, view, work, gauss, disk, here, adjoint
            )  # fmt: skip
            if n > 4 and halvings < MAX_HALVINGS and miss > promise * (size + whole) and not is_spent(work):
                # less tame than it looks, as where a ball leaves the part of a disk above the terminator: taken back
                piece_adjoint(
                    a, end, n, c, s, -weight, placed, cell, step, lobe, view, work, gauss, disk, here, adjoint
                )  # fmt: skip
                halvings += 1
                end = a + 0.5 * (end - a)
                continue
            size += whole
            missed += miss
            a, end = end, stop
    return size, missed
