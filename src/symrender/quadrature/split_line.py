"""The inner integral of the split rule: one scan line, Gauss on every cell."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.cones import is_touch
from symrender.chambers.labels import HIDDEN, PARTLY
from symrender.chambers.leaf_rows import eye_view_rows, floor_nodes_rows, sphere_nodes_rows
from symrender.chambers.lobes.density import facing_of, facing_share
from symrender.chambers.lobes.rows import densities, lean_line, least_error, tint
from symrender.chambers.lobes.sending import end_power, reflects_wholly
from symrender.chambers.lobes.width import BLUNT, broken_rim
from symrender.chambers.records import NODES, Chart, Piece
from symrender.chambers.senders import sender_of
from symrender.chambers.walls import (
    GLEAM_EDGE,
    PENUMBRA,
    SHADOW,
    TERMINATOR,
    is_rooted,
)
from symrender.chambers.work import PENDING, View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import moves
from symrender.leaves import values
from symrender.quadrature.gauss import FALLS, MAX_ORDER, nodes, order
from symrender.quadrature.glow_nodes import add_glows
from symrender.quadrature.light_nodes import light_nodes
from symrender.quadrature.line_errors import piece_error
from symrender.quadrature.line_poles import cell_log, find_poles
from symrender.quadrature.node_rows import begin_sums, shine, sines, whole_vectors
from symrender.quadrature.paces import left_out
from symrender.quadrature.swept_nodes import weigh_by_speed
from symrender.scene.arrays import CUT, EYE, MARBLE, PHONG

Array = npt.NDArray[np.float64]


CAUTION = 0.7
"""Share of its estimate taken as the log rho of a cell: a line more costs more than a node more on each line, so that
errors along lines are kept below those across them."""
SMALL = 0.05
"""Share of a line's integral below which its pieces need not keep what their step promises.

Under a disk light it is all of it: the rules over the disk err alike on every node, and halves would not help.
"""
FEW = 4
"""Nodes that judge their own rule badly."""
MAX_HALVINGS = 40
"""Most halvings of one cell of a line."""
AT_HORIZON = 0.5 * math.pi * (1.0 - 1e-12)
"""Inner coordinate from which on a piece of the floor ends at its horizon."""
DISK_ENDS = 1
FIRST_TOUCHES = 2
LAST_TOUCHES = 3
BOTH_TOUCH = 4
"""What ``soft`` of a piece says of its ends: a disk light begins there, or what is seen of a sky or a lamp touches."""
SOFT_LOG = 1.5
"""log rho, in the mapped coordinate, of a cell in which a disk light is partly hidden."""


@inlined
def has_disk(view: View) -> bool:
    """Whether a disk light is taken whole."""
    found = False
    for i in range(view.points.shape[0]):
        found = found or view.points[i].radius > 0.0
    return found


@jitable
def kinked(view: View) -> bool:
    """Whether highlights end so bluntly that coefficients fall no faster than their ends say.

    Of a light point these ends are walls, at which whole powers are smooth; of a disk they are none.
    """
    shading = view.shading
    ends = shading.model == PHONG or shading.highlight_view == EYE or shading.terminator != CUT
    if not (shading.ks > 0.0 and shading.shininess < BLUNT and ends):
        return False
    if shading.shininess != math.floor(shading.shininess):
        return True
    return bool(has_disk(view))


@inlined
def ends_bluntly(view: View, chart: Chart) -> bool:
    """The same of the charted shape, where it is of phong's material, or reflects wholly beyond a critical angle.

    Where the angle between a light and P is twice that one, reflectance goes as a root, on a curve that is no circle.
    """
    sender = sender_of(view, chart)
    power = end_power(sender, view.senders)
    return bool(0.0 < power < BLUNT and power != math.floor(power)) or reflects_wholly(sender, view.senders)


@inlined
def faint_horizon(view: View, chart: Chart) -> bool:
    """Whether highlights end at the floor's horizon, where light and viewer are level, with a power that is not whole.

    From ``BLUNT`` on that is not felt.
    """
    s = view.shading.shininess
    return bool(chart.shape_index < 0.0 and view.shading.ks > 0.0 and s < BLUNT and s != math.floor(s))


@inlined
def disk_edge(wall: int, work: Work) -> bool:
    """Whether a wall is one of a disk light: an edge of a penumbra or of a band of terminators."""
    if wall < 0:
        return False
    row = work.walls[wall // 4]
    return bool(row.kind == PENUMBRA or (row.kind == SHADOW and row.tag == TERMINATOR))


@inlined
def nodes_to_end(cell: int, view: View, work: Work) -> int:
    """Fewest nodes of a cell that ends where a highlight does: there it is a power of the distance, told by as many."""
    ends = 0
    for side in range(2):
        wall = work.cell_wall[cell + side]
        if wall >= 0 and work.walls[wall // 4].kind == GLEAM_EDGE:
            power = max(view.shading.shininess, end_power(sender_of(view, work.chart), view.senders))
            ends = 1 + math.ceil(0.5 * power)
    return ends


@inlined
def cell_soft(cell: int, lights: int, view: View, work: Work) -> int:
    """At which ends of a cell light begins like a power of the distance, as a row's ``soft`` says it."""
    if disk_edge(work.cell_wall[cell], work) or disk_edge(work.cell_wall[cell + 1], work):
        for i in range(lights):
            if work.lit[cell, i] >= PARTLY:
                return DISK_ENDS
    one, other = work.cell_wall[cell], work.cell_wall[cell + 1]
    first = is_touch(one, view, work) or (one >= 0 and is_rooted(work.walls[one // 4]))
    last = is_touch(other, view, work) or (other >= 0 and is_rooted(work.walls[other // 4]))
    return BOTH_TOUCH if first and last else FIRST_TOUCHES if first else LAST_TOUCHES if last else 0


@inlined
def half_soft(soft: int, second: bool) -> int:
    """``soft`` of the first or the second half of a piece."""
    if soft <= DISK_ENDS:
        return soft
    end = LAST_TOUCHES if second else FIRST_TOUCHES
    return end if soft in (end, BOTH_TOUCH) else 0


@inlined
def stack_piece(
    top: int, cell: int, start: float, stop: float, halvings: int, wary: int, soft: int, work: Work
) -> int:  # fmt: skip
    """Put off a piece of a cell; the stack's new height. The stack lies behind the pieces at hand."""
    row = work.pieces[NODES + top]
    row.cell, row.start, row.stop, row.halvings, row.wary, row.soft = cell, start, stop, halvings, wary, soft
    return top + 1


@inlined
def stack_halves(top: int, row: Piece, deeper: int, work: Work) -> int:
    """Put off both halves of a piece, the first one on top, halved ``deeper`` times more; the stack's new height."""
    cell, start, stop, wary, soft = row.cell, row.start, row.stop, row.wary, row.soft
    middle, halvings = start + 0.5 * (stop - start), row.halvings + deeper
    top = stack_piece(top, cell, middle, stop, halvings, wary, half_soft(soft, True), work)
    return stack_piece(top, cell, start, middle, halvings, wary, half_soft(soft, False), work)


@inlined
def piece_order(row: Piece, step: int, least: int, view: View, work: Work) -> tuple[int, float]:
    """How many nodes a piece wants at this step, ``least`` where light begins softly, and how far off it is tame."""
    log_rho, fewest = cell_log(row.start, row.stop, work)
    n = max(fewest, nodes_to_end(row.cell, view, work), nodes(step, CAUTION * log_rho))
    if row.wary != 0.0:
        # more than the few that it was not believed of
        n = max(n, order(step, log_rho), max(step, FEW) + 1)
    if row.soft != 0.0:
        n = max(n + (n + 1) // 2, least)
    return n, log_rho


@inlined
def place_nodes(
    m: int, piece: int, n: int, log_rho: float, row: Piece, color: Array, factor: float, work: Work, gauss: Array
) -> None:  # fmt: skip
    """Make ``row`` of the stack the piece at hand of this number, with ``n`` nodes from node ``m`` on."""
    b, at = work.nodes, work.pieces[piece]
    work.pieces[piece] = row
    at.first, at.count, at.log_rho, at.doubt, at.unseen = m, n, log_rho, 0.0, 0.0
    base = n * (n - 1) // 2
    length = row.stop - row.start
    for q in range(n):
        b.inner[m + q] = row.start + length * gauss[0, base + q]
        b.weight[m + q] = gauss[1, base + q] * length
        b.factor[0, m + q] = factor * color[0]
        b.factor[1, m + q] = factor * color[1]
        b.factor[2, m + q] = factor * color[2]
    if row.soft > DISK_ENDS:
        # light that begins with the power 3/2 of the distance from an end is smooth in the root of it
        for q in range(n):
            u = gauss[0, base + q]
            at, slope = u * u, 2.0 * u
            if row.soft == LAST_TOUCHES:
                at, slope = u * (2.0 - u), 2.0 - 2.0 * u
            elif row.soft == BOTH_TOUCH:
                at, slope = at * (3.0 - slope), 6.0 * u * (1.0 - u)
            b.inner[m + q] = row.start + length * at
            b.weight[m + q] = gauss[1, base + q] * (length * slope)
    elif row.soft != 0.0:
        # a loop of its own: in the other sine and cosine would be taken of every node
        for q in range(n):
            # a disk's light ends with the power 3/2 of the distance from a wall
            turn = 0.5 * math.pi * gauss[0, base + q]
            su, cu = math.sin(turn), math.cos(turn)
            b.inner[m + q] = row.start + length * (su * su)
            b.weight[m + q] = gauss[1, base + q] * (length * math.pi * su * cu)


@inlined
def shape_nodes(m: int, c: float, s: float, step: int, view: View, work: Work) -> None:
    """Fill ``m`` nodes of the line (c, s) from ``inner``: places, normals, views, solid angle times density."""
    m = whole_vectors(m)
    chart, b = work.chart, work.nodes
    j = chart.shape_index
    gx, gy, gz = chart.pole[0], chart.pole[1], chart.pole[2]
    e, f = chart.e1, chart.e2
    ex, ey, ez = values.chart_across(c, s, e[0], e[1], e[2], f[0], f[1], f[2])
    flat = facing_of(chart.lobe)[0]
    lift, lean = facing_share(gx, gy, gz, chart.lobe) - flat, facing_share(ex, ey, ez, chart.lobe) - flat
    cbm, sbm = chart.lobe_cos, chart.lobe_sin
    sines(m, b)
    if j >= 0:
        o = chart.center
        sphere_nodes_rows(0, m, ex, ey, ez, gx, gy, gz, o[0], o[1], o[2], chart.radius, chart.ratio, b)
    else:
        o = chart.point
        floor_nodes_rows(0, m, ex, ey, ez, o[0], o[1], o[2], chart.height, b)
    for i in range(m):
        sb, cb = b.sine[i], b.cosine[i]
        d0, d1, d2 = cb - cbm, sb * c - sbm, sb * s
        b.chord[i] = d0 * d0 + d1 * d1 + d2 * d2
        b.weight[i] *= flat + cb * lift + sb * lean
    if view.shading.highlight_view == EYE:
        eye_view_rows(0, m, view.eye[0], view.eye[1], view.eye[2], b)
    else:
        for i in range(m):
            sb, cb = b.sine[i], b.cosine[i]
            b.toward[0, i] = -cb * gx - sb * ex
            b.toward[1, i] = -cb * gy - sb * ey
            b.toward[2, i] = -cb * gz - sb * ez
    lean_line(m, c, s, chart, b, view.conductors)
    densities(m, FALLS[step], b, chart.lobe, view.conductors)
    if moves(c) and chart.swept != 0:
        weigh_by_speed(m, c, s, work)


@inlined
def shade_nodes(m: int, pieces: int, step: int, view: View, work: Work, gauss: Array) -> None:
    """Fill ``radiance`` of the first ``m`` nodes with the radiance less the background."""
    m = whole_vectors(m)
    b, shading = work.nodes, view.shading
    j = work.chart.shape_index
    ambient = 0.0 if j < 0 and work.chart.side < 0.0 else shading.ka
    begin_sums(m, ambient, shading, b)
    shine(m, j, b, view.emitted)
    if j >= 0 and view.spheres[j].texture == MARBLE:
        for i in range(m):
            vein = values.marble(b.normal[0, i], b.normal[1, i], b.normal[2, i], view.spheres[j].ku, view.spheres[j].kv)
            for a in range(3):
                b.factor[a, i] *= vein
    light_nodes(pieces, step, shading.ks, view, work, gauss)
    add_glows(pieces, view, work, view.glows)
    tint(m, work.chart.lobe, b, view.conductors)


@inlined
def weigh_nodes(m: int, work: Work) -> float:
    """Multiply ``radiance`` by ``weight``; ``radix`` gets the largest magnitude of a node; their sum."""
    b = work.nodes
    for i in range(whole_vectors(m)):
        w = b.weight[i]
        red, green, blue = w * b.radiance[0, i], w * b.radiance[1, i], w * b.radiance[2, i]
        b.radiance[0, i], b.radiance[1, i], b.radiance[2, i] = red, green, blue
        b.radix[i] = max(abs(red), abs(green), abs(blue))
    whole = 0.0
    for i in range(m):
        whole += b.radix[i]
    return whole


@inlined
def integrate_cells(phi: float, step: int, view: View, work: Work, gauss: Array, out: Array) -> None:
    """Integral over the scanned line of (radiance - background) times the lobe density, in out[0:3].

    In out[3:6] the integral of its largest magnitude over the channels, a scale for errors, the error of the cells'
    rules, and the largest lobe density met. ``step`` chooses the order of every cell; one whose rule is not as good as
    it promises (a highlight's kink, a vein) is halved.
    """
    chart, b, table = work.chart, work.nodes, work.pieces
    c, s = math.cos(phi), math.sin(phi)
    j = chart.shape_index
    lights = view.points.shape[0]
    kd = view.shading.kd
    least = order(step, SOFT_LOG)
    red, green, blue, size, error, peak = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    promise, blunt, rim = 100.0 * FALLS[step], kinked(view) or ends_bluntly(view, chart), broken_rim(chart.lobe)
    faint, idle = faint_horizon(view, chart), least_error(chart, view.conductors)
    small = 1.0 if has_disk(view) else SMALL
    cell, top = 0, 0
    color = chart.albedo
    find_poles(phi, c, s, view, work)
    while top > 0 or cell < work.counts.cells:
        m, pieces = 0, 0
        while top > 0 or cell < work.counts.cells:
            if top == 0:
                if work.cell_side[cell] != HIDDEN:
                    soft = cell_soft(cell, lights, view, work)
                    top = stack_piece(0, cell, work.cell_from[cell], work.cell_to[cell], 0, 0, soft, work)
                cell += 1
                continue
            row = table[NODES + top - 1]
            n, log_rho = piece_order(row, step, least, view, work)
            if n > MAX_ORDER and top < PENDING and not is_spent(work):
                top = stack_halves(top - 1, row, 0, work)
                continue
            n = min(n, MAX_ORDER)
            if m + n > NODES:
                break
            top -= 1
            if j >= 0:
                factor = kd * (view.spheres[j].dark if work.cell_side[row.cell] == 0 else 1.0)
                shade = view.spheres[j].color
            else:
                factor, shade = kd, color
            place_nodes(m, pieces, n, log_rho, row, shade, factor, work, gauss)
            m += n
            pieces += 1
        if m == 0:
            break
        work.counts.evaluations += m
        shape_nodes(m, c, s, step, view, work)
        if step == 0:
            for i in range(m):
                peak = max(peak, b.power[i])
        shade_nodes(m, pieces, step, view, work, gauss)
        whole = weigh_nodes(m, work)
        for piece in range(pieces):
            row = table[piece]
            n, start, stop = row.count, row.start, row.stop
            at_rim = rim and (start == work.cell_from[0] or stop == work.cell_to[work.counts.cells - 1])
            holds, miss = piece_error(row, b, blunt or at_rim or (faint and stop > AT_HORIZON), gauss)
            miss += left_out(row.unseen, work)
            tame = miss <= promise * (holds + small * (size + whole)) + idle
            if n > 1 and not tame and top + 2 <= PENDING and not is_spent(work):
                # a piece less tame than it looks; so few points judge badly, and are not halved away from
                if n <= max(step, FEW) and row.wary == 0.0:
                    top = stack_piece(top, row.cell, start, stop, row.halvings, 1, row.soft, work)
                    continue
                if n > max(step, FEW) and row.halvings < MAX_HALVINGS:
                    top = stack_halves(top, row, 1, work)
                    continue
            for i in range(row.first, row.first + n):
                red += b.radiance[0, i]
                green += b.radiance[1, i]
                blue += b.radiance[2, i]
            size += holds
            error += miss + left_out(row.doubt, work)
    out[0], out[1], out[2], out[3], out[4], out[5] = red, green, blue, size, error, peak
