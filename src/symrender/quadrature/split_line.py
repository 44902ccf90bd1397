"""The inner integral of the split rule: one scan line, Gauss on every cell."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.highlights import piece_strip
from symrender.chambers.labels import HIDDEN, PARTLY
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.walls import (
    CENTER,
    E1,
    E2,
    EXPONENT,
    FACING,
    HEIGHT,
    KIND,
    LOBE_BETA,
    LOG_NORMALISER,
    PENUMBRA,
    POINT,
    POLE,
    RADIUS,
    RATIO,
    SHADOW,
    SHAPE_INDEX,
    SIDE,
    STRIP,
    TAG,
    TERMINATOR,
)
from symrender.chambers.work import CELLS, EVALUATIONS, NODES, PENDING, View, Work, is_spent
from symrender.kernel_cache import inlined, jitable
from symrender.quadrature.gauss import FALLS, MAX_ORDER, MIDDLE, nodes, order
from symrender.quadrature.light_nodes import light_nodes
from symrender.quadrature.light_term import marble_factor
from symrender.quadrature.node_rows import (
    BASE,
    CELL,
    CHORD,
    COSINE,
    COUNT,
    FACTOR,
    FIRST,
    INNER,
    LOG_RHO,
    NORMAL,
    PLACE,
    POWER,
    SINE,
    SUM,
    VIEW,
    WEIGHT,
    begin_sums,
    densities,
    sines,
    views_to,
    whole_vectors,
)
from symrender.scene.arrays import CUT, EYE, MARBLE, PHONG

Array = npt.NDArray[np.float64]

# further columns of the pieces of a line
START = 4
STOP = 5
HALVINGS = 6
WARY = 7
"""1 where the rule is at least that which successive steps compare."""
SOFT = 8
"""1 where a disk light ends at one of the cell's walls."""

CAUTION = 0.7
"""Share of its estimate taken as the log rho of a cell: a line more costs more than a node more on each line, so that
errors along lines are kept below those across them."""
SMALL = 0.05
"""Share of a line's integral below which its pieces need not keep what their step promises.

Under a disk light it is all of it: the rules over the disk err alike on every node, and halves would not help.
"""
MAX_HALVINGS = 40
"""Most halvings of one cell of a line."""
BLUNT = 6.0
"""Shininess below which the end of a highlight is felt, where it has one among what is lit and seen."""
NEAR_LIGHT = 2.0
"""Squared distance of a light from a sphere's centre, over the squared radius, beyond which its distance is tame."""
SOFT_LOG = 1.5
"""log rho, in the mapped coordinate, of a cell in which a disk light is partly hidden."""


@jitable
def lobe_density(squared_chord: float, geo: Array) -> float:
    """cos^n theta / W at a direction whose distance from m has this square: 1 - cos theta without cancellation."""
    c = -0.5 * squared_chord
    if c <= -1.0:
        return 0.0
    return math.exp(geo[EXPONENT] * math.log1p(c) - geo[LOG_NORMALISER])


@inlined
def facing_share(wx: float, wy: float, wz: float, geo: Array) -> float:
    """What a direction counts beside the lobe's density: 1, or in BRDF units its cosine to the surface normal."""
    return float(geo[FACING + 3] + geo[FACING] * wx + geo[FACING + 1] * wy + geo[FACING + 2] * wz)


@jitable
def tail_error(n: int, last: float, before: float, middle: float, size: float, log_rho: float) -> float:
    """Error of an n-point Gauss rule whose integrand, of mean magnitude ``size``, has these last two coefficients.

    Coefficients of an analytic integrand fall like rho^-k and the rule's error like rho^-2n: the last ones tell rho,
    and the error size (top/size)^(2n/(n - 1)), of which the exponent is rounded down. A narrow feature makes them
    fall fast at first and slowly then: from six points on they must have fallen from the ``middle`` ones, too, half as
    far. One or two points tell too little; there ``log_rho``, of the nearest singularity known, has its say.
    """
    if size == 0.0:
        return 0.0
    known = 4.0 * size * math.exp(-2.0 * n * log_rho) if n <= 2 else 0.0
    if n == 1:
        return min(size, known)
    top = max(abs(last), 0.5 * abs(before))
    ratio = min(1.0, top / size)
    if n == 2:
        return max(top * ratio * ratio, min(top + known, known))
    if n < 6:
        return top * ratio * math.sqrt(ratio) if n == 3 else top * ratio * math.sqrt(math.sqrt(ratio))
    late = min(1.0, top / middle) if middle > 0.0 else 1.0
    return top * max(ratio, late * late)


@jitable
def kinked(view: View) -> bool:
    """Whether highlights end so bluntly that coefficients fall no faster than their ends say.

    Of a light point these ends are walls, at which whole powers are smooth; of a disk they are none.
    """
    shading = view.shading
    ends = shading[4] == PHONG or shading[5] == EYE or shading[6] != CUT
    if not (shading[2] > 0.0 and shading[3] < BLUNT and ends):
        return False
    if shading[3] != math.floor(shading[3]):
        return True
    disks = False
    for i in range(view.points.shape[0]):
        disks = disks or view.points[i, DISK_RADIUS] > 0.0
    return disks


@inlined
def cell_log(
    start: float, stop: float, phi: float, c: float, s: float, view: View, work: Work
) -> float:  # fmt: skip
    """log rho of the Bernstein ellipse of a cell through the edge of the strip where its integrand is tame."""
    geo, points = work.geo, view.points
    length, distance = stop - start, 0.5 * math.pi - stop
    strip = min(geo[STRIP], piece_strip(phi, start, stop, c, s, view, work))
    if geo[SHAPE_INDEX] < 0.0:
        ex, ey = c * geo[E1] + s * geo[E2], c * geo[E1 + 1] + s * geo[E2 + 1]
        # a light at (r0, zeta) from the line is a singularity at atan((r0 + i zeta)/h) of the inner coordinate
        best = math.inf
        height = geo[HEIGHT]
        for i in range(points.shape[0]):
            ox, oy, oz = points[i, 0] - geo[POINT], points[i, 1] - geo[POINT + 1], points[i, 2]
            along = ox * ex + oy * ey
            across2 = max(0.0, ox * ox + oy * oy - along * along) + oz * oz
            r2 = along * along + across2
            x = math.atan2(along, height)
            y = math.sqrt(across2) * height / (height * height + r2)
            low, high = 0.5 * math.pi - distance - length - x, 0.5 * math.pi - distance - x
            best = min(best, (math.sqrt(low * low + y * y) + math.sqrt(high * high + y * y)) / length)
            # beyond the horizon the line comes back from behind, where the light may be near
            low, high = low - math.pi, high - math.pi
            best = min(best, (math.sqrt(low * low + y * y) + math.sqrt(high * high + y * y)) / length)
        x = 2.0 * strip / length
        log_rho = math.log(x + math.sqrt(1.0 + x * x))
        if best < math.inf:
            log_rho = min(log_rho, math.log(best + math.sqrt(max(1e-12, best * best - 1.0))))
        return log_rho
    near = geo[STRIP + 2]
    x = 2.0 * min(strip, math.sqrt(near * near + distance * distance)) / length
    log_rho = math.log(x + math.sqrt(1.0 + x * x))
    j, k = int(geo[SHAPE_INDEX]), geo[RATIO]
    for i in range(points.shape[0]):
        lx, ly, lz = points[i, 0] - geo[CENTER], points[i, 1] - geo[CENTER + 1], points[i, 2] - geo[CENTER + 2]
        far2, radius = lx * lx + ly * ly + lz * lz, view.spheres[j, 3]
        if not radius * radius < far2 < NEAR_LIGHT * radius * radius:
            continue
        # |Q - L|^2 = 0 at the angle gamma +- i depth at the centre
        along = -(lx * geo[POLE] + ly * geo[POLE + 1] + lz * geo[POLE + 2])
        across = lx * (c * geo[E1] + s * geo[E2]) + ly * (c * geo[E1 + 1] + s * geo[E2 + 1])
        across += lz * (c * geo[E1 + 2] + s * geo[E2 + 2])
        size = math.sqrt(along * along + across * across)
        if size == 0.0:
            continue
        ratio = max(1.0, (radius * radius + far2) / (2.0 * radius * size))
        cg, sg = along / size, across / size
        scale = max(1e-9, 1.0 - 2.0 * k * cg + k * k)
        x = math.atan2(sg, cg - k)
        y = math.log(ratio + math.sqrt(ratio * ratio - 1.0)) * abs(1.0 - k * cg) / scale
        low, high = start - x, stop - x
        best = (math.sqrt(low * low + y * y) + math.sqrt(high * high + y * y)) / length
        log_rho = min(log_rho, math.log(best + math.sqrt(max(1e-12, best * best - 1.0))))
    return log_rho


@jitable
def cell_order(
    start: float, stop: float, step: int, phi: float, c: float, s: float, view: View, work: Work
) -> int:  # fmt: skip
    """Gauss nodes of a cell where two successive steps are compared; above ``MAX_ORDER`` it must be cut."""
    return order(step, cell_log(start, stop, phi, c, s, view, work))


@inlined
def disk_edge(wall: int, work: Work) -> bool:
    """Whether a wall is one of a disk light: an edge of a penumbra or of a band of terminators."""
    if wall < 0:
        return False
    row = work.walls[wall // 4]
    return bool(row[KIND] == PENUMBRA or (row[KIND] == SHADOW and row[TAG] == TERMINATOR))


@inlined
def stack_piece(
    top: int, cell: int, start: float, stop: float, halvings: float, wary: float, soft: float, work: Work
) -> int:  # fmt: skip
    """Put off a piece of a cell; the stack's new height. The stack lies behind the pieces at hand."""
    row = work.pieces[NODES + top]
    row[CELL], row[START], row[STOP], row[HALVINGS], row[WARY], row[SOFT] = cell, start, stop, halvings, wary, soft
    return top + 1


@inlined
def place_nodes(
    m: int, piece: int, n: int, log_rho: float, row: Array, color: Array, factor: float, work: Work, gauss: Array
) -> None:  # fmt: skip
    """Make ``row`` of the stack the piece at hand of this number, with ``n`` nodes from node ``m`` on."""
    b, at = work.nodes, work.pieces[piece]
    for t in range(at.shape[0]):
        at[t] = row[t]
    at[FIRST], at[COUNT], at[LOG_RHO] = m, n, log_rho
    base = n * (n - 1) // 2
    length = row[STOP] - row[START]
    for q in range(n):
        u, along = gauss[0, base + q], length
        if row[SOFT] != 0.0:
            # a disk's light ends with the power 3/2 of the distance from a wall
            su, cu = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
            u, along = su * su, length * math.pi * su * cu
        b[INNER + m + q] = row[START] + length * u
        b[WEIGHT + m + q] = gauss[1, base + q] * along
        b[FACTOR + m + q] = factor * color[0]
        b[FACTOR + NODES + m + q] = factor * color[1]
        b[FACTOR + 2 * NODES + m + q] = factor * color[2]


@inlined
def shape_nodes(m: int, c: float, s: float, step: int, view: View, work: Work) -> None:
    """Fill the first ``m`` nodes of the line (c, s) from INNER: points, normals, views, solid angle times density."""
    m = whole_vectors(m)
    geo, b = work.geo, work.nodes
    j, k = int(geo[SHAPE_INDEX]), geo[RATIO]
    gx, gy, gz = geo[POLE], geo[POLE + 1], geo[POLE + 2]
    ex, ey, ez = c * geo[E1] + s * geo[E2], c * geo[E1 + 1] + s * geo[E2 + 1], c * geo[E1 + 2] + s * geo[E2 + 2]
    flat = geo[FACING + 3]
    lift, lean = facing_share(gx, gy, gz, geo) - flat, facing_share(ex, ey, ez, geo) - flat
    cbm, sbm = geo[LOBE_BETA + 1], geo[LOBE_BETA + 2]
    px, py, pz, radius = geo[CENTER], geo[CENTER + 1], geo[CENTER + 2], geo[RADIUS]
    sines(m, b)
    if j >= 0:
        for i in range(m):
            sx, cx = b[SINE + i], b[COSINE + i]
            sb = k * sx
            cb = math.sqrt(1.0 - sb * sb)
            cg, sg = cx * cb + sx * sb, sx * cb - cx * sb
            nx, ny, nz = sg * ex - cg * gx, sg * ey - cg * gy, sg * ez - cg * gz
            b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i] = nx, ny, nz
            b[PLACE + i] = px + radius * nx
            b[PLACE + NODES + i] = py + radius * ny
            b[PLACE + 2 * NODES + i] = pz + radius * nz
            b[WEIGHT + i] *= k * k * sx * cx / cb
            b[SINE + i], b[COSINE + i] = sb, cb
    else:
        px, py, height = geo[POINT], geo[POINT + 1], geo[HEIGHT]
        for i in range(m):
            sx, cx = b[SINE + i], b[COSINE + i]
            far = height * sx / cx
            b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i] = 0.0, 0.0, 1.0
            b[PLACE + i] = px + far * ex
            b[PLACE + NODES + i] = py + far * ey
            b[PLACE + 2 * NODES + i] = 0.0
            b[WEIGHT + i] *= sx
    for i in range(m):
        sb, cb = b[SINE + i], b[COSINE + i]
        d0, d1, d2 = cb - cbm, sb * c - sbm, sb * s
        b[CHORD + i] = d0 * d0 + d1 * d1 + d2 * d2
        b[WEIGHT + i] *= flat + cb * lift + sb * lean
    if view.shading[5] == EYE:
        views_to(m, view.eye, b)
    else:
        for i in range(m):
            sb, cb = b[SINE + i], b[COSINE + i]
            b[VIEW + i] = -cb * gx - sb * ex
            b[VIEW + NODES + i] = -cb * gy - sb * ey
            b[VIEW + 2 * NODES + i] = -cb * gz - sb * ez
    densities(m, step, b, geo)


@inlined
def shade_nodes(m: int, pieces: int, step: int, view: View, work: Work, gauss: Array) -> None:
    """Fill SUM of the first ``m`` nodes with the radiance less the background."""
    m = whole_vectors(m)
    b, shading = work.nodes, view.shading
    j = int(work.geo[SHAPE_INDEX])
    ambient = 0.0 if j < 0 and work.geo[SIDE] < 0.0 else shading[0]
    begin_sums(m, ambient, shading, b)
    if j >= 0 and view.spheres[j, 7] == MARBLE:
        for i in range(m):
            vein = marble_factor(
                b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i], view.spheres[j, 8], view.spheres[j, 9]
            )
            for a in range(3):
                b[FACTOR + a * NODES + i] *= vein
    light_nodes(m, pieces, step, shading[2], view, work, gauss)


@inlined
def weigh_nodes(m: int, work: Work) -> float:
    """Multiply SUM by WEIGHT; POWER gets the sum over the channels, BASE their largest magnitude. The sum of BASE."""
    b = work.nodes
    for i in range(whole_vectors(m)):
        w = b[WEIGHT + i]
        red, green, blue = w * b[SUM + i], w * b[SUM + NODES + i], w * b[SUM + 2 * NODES + i]
        b[SUM + i], b[SUM + NODES + i], b[SUM + 2 * NODES + i] = red, green, blue
        b[POWER + i] = red + green + blue
        b[BASE + i] = max(abs(red), abs(green), abs(blue))
    whole = 0.0
    for i in range(m):
        whole += b[BASE + i]
    return whole


@inlined
def piece_error(row: Array, b: Array, blunt: bool, gauss: Array) -> tuple[float, float]:
    """Integral of the largest magnitude over a piece, and the error of its rule by its Legendre coefficients."""
    n, first = int(row[COUNT]), int(row[FIRST])
    base = n * (n - 1) // 2
    whole, last, before, middle, lower = 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(n):
        mixture = b[POWER + first + q]
        whole += b[BASE + first + q]
        last += mixture * gauss[2, base + q]
        before += mixture * gauss[3, base + q]
    if n >= 6:
        for q in range(n):
            mixture = b[POWER + first + q]
            middle += mixture * gauss[MIDDLE, base + q]
            lower += mixture * gauss[MIDDLE + 1, base + q]
    middle = max(abs(middle), abs(lower))
    miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, row[LOG_RHO])
    if blunt and n > 1:
        miss = max(miss, 0.5 * abs(last), 0.25 * abs(before))
    return whole, miss


@inlined
def integrate_cells(
    phi: float, step: int, view: View, work: Work, gauss: Array, out: Array
) -> None:  # fmt: skip
    """Integral over the scanned line of (radiance - background) times the lobe density.

    Then the integral of its largest magnitude over the channels, a scale for errors, the error of the cells'
    rules, and the largest lobe density met; ``out`` is (6,). A cell whose rule is not as good as its step promises (a
    highlight's kink, a vein) is halved.

    ``step`` chooses the order of every cell.
    """
    geo, b, table = work.geo, work.nodes, work.pieces
    c, s = math.cos(phi), math.sin(phi)
    j = int(geo[SHAPE_INDEX])
    lights = view.points.shape[0]
    kd = view.shading[1]
    least = order(step, SOFT_LOG)
    red, green, blue, size, error, peak = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    promise, blunt, small = 100.0 * FALLS[step], kinked(view), SMALL
    for i in range(lights):
        if view.points[i, DISK_RADIUS] > 0.0:
            small = 1.0
    cell, top = 0, 0
    color = geo[STRIP + 3 : STRIP + 6]
    while top > 0 or cell < work.counts[CELLS]:
        m, pieces = 0, 0
        while top > 0 or cell < work.counts[CELLS]:
            if top == 0:
                if work.cell_side[cell] != HIDDEN:
                    soft = 0.0
                    if disk_edge(work.cell_wall[cell], work) or disk_edge(work.cell_wall[cell + 1], work):
                        for i in range(lights):
                            if work.lit[cell, i] >= PARTLY:
                                soft = 1.0
                    top = stack_piece(0, cell, work.cell_from[cell], work.cell_to[cell], 0.0, 0.0, soft, work)
                cell += 1
                continue
            row = table[NODES + top - 1]
            start, stop = row[START], row[STOP]
            log_rho = cell_log(start, stop, phi, c, s, view, work)
            n = order(step, log_rho) if row[WARY] != 0.0 else nodes(step, CAUTION * log_rho)
            if row[SOFT] != 0.0:
                n = max(n + (n + 1) // 2, least)
            if n > MAX_ORDER and top < PENDING and not is_spent(work):
                middle = start + 0.5 * (stop - start)
                row[START] = middle
                top = stack_piece(top, int(row[CELL]), start, middle, row[HALVINGS], row[WARY], row[SOFT], work)
                continue
            n = min(n, MAX_ORDER)
            if m + n > NODES:
                break
            top -= 1
            if j >= 0:
                factor = kd * (1.0 if work.cell_side[int(row[CELL])] == 1 else view.spheres[j, 10])
                shade = view.spheres[j, 4:7]
            else:
                factor, shade = kd, color
            place_nodes(m, pieces, n, log_rho, row, shade, factor, work, gauss)
            m += n
            pieces += 1
        if m == 0:
            break
        work.counts[EVALUATIONS] += m
        shape_nodes(m, c, s, step, view, work)
        if step == 0:
            for i in range(m):
                peak = max(peak, b[POWER + i])
        shade_nodes(m, pieces, step, view, work, gauss)
        whole = weigh_nodes(m, work)
        for piece in range(pieces):
            row = table[piece]
            n, start, stop = int(row[COUNT]), row[START], row[STOP]
            held, miss = piece_error(row, b, blunt, gauss)
            tame = miss <= promise * (held + small * (size + whole))
            if n > 1 and not tame and top + 2 <= PENDING and not is_spent(work):
                # a piece less tame than it looks; so few points judge badly, and are not halved away from
                if n <= max(step, 4) and row[WARY] == 0.0:
                    top = stack_piece(top, int(row[CELL]), start, stop, row[HALVINGS], 1.0, row[SOFT], work)
                    continue
                if n > max(step, 4) and row[HALVINGS] < MAX_HALVINGS:
                    middle, deeper = start + 0.5 * (stop - start), row[HALVINGS] + 1.0
                    top = stack_piece(top, int(row[CELL]), middle, stop, deeper, row[WARY], row[SOFT], work)
                    top = stack_piece(top, int(row[CELL]), start, middle, deeper, row[WARY], row[SOFT], work)
                    continue
            for i in range(int(row[FIRST]), int(row[FIRST]) + n):
                red += b[SUM + i]
                green += b[SUM + NODES + i]
                blue += b[SUM + 2 * NODES + i]
            size += held
            error += miss
    out[0], out[1], out[2], out[3], out[4], out[5] = red, green, blue, size, error, peak
