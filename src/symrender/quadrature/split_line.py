"""The inner integral of the split rule: one scan line, Gauss on every cell."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, GLINT, HIDDEN, PARTLY
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
from symrender.chambers.work import CELLS, EVALUATIONS, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, MIDDLE, nodes, order
from symrender.quadrature.light_term import light_term, marble_factor
from symrender.scene.arrays import EYE, MARBLE, PHONG

Array = npt.NDArray[np.float64]

MAX_HALVINGS = 40
"""Most halvings of one cell of a line."""
BLUNT = 2.0
"""Shininess below which the end of a highlight is felt."""
SOFT_LOG = 1.5
"""log rho, in the mapped coordinate, of a cell in which a disk light is partly hidden."""


@jitable
def lobe_density(squared_chord: float, geo: Array) -> float:
    """cos^n theta / W at a direction whose distance from m has this square: 1 - cos theta without cancellation."""
    c = -0.5 * squared_chord
    if c <= -1.0:
        return 0.0
    return math.exp(geo[EXPONENT] * math.log1p(c) - geo[LOG_NORMALISER])


@jitable
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
    known = 4.0 * size * math.exp(-2.0 * n * log_rho)
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
    """Whether highlights end so bluntly that coefficients fall no faster than their ends say: these have no walls."""
    return bool(view.shading[2] > 0.0 and view.shading[3] < BLUNT)


@jitable
def cell_log(length: float, distance: float, ex: float, ey: float, points: Array, geo: Array) -> float:
    """log rho of the Bernstein ellipse of a cell through the edge of the strip where its integrand is tame."""
    if geo[SHAPE_INDEX] < 0.0:
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
        x = 2.0 * geo[STRIP] / length
        log_rho = math.log(x + math.sqrt(1.0 + x * x))
        if best < math.inf:
            log_rho = min(log_rho, math.log(best + math.sqrt(max(1e-12, best * best - 1.0))))
        return log_rho
    near = geo[STRIP + 2]
    h = min(geo[STRIP], math.sqrt(near * near + distance * distance))
    x = 2.0 * h / length
    return math.log(x + math.sqrt(1.0 + x * x))


@jitable
def cell_order(
    length: float, distance: float, step: int, ex: float, ey: float, points: Array, geo: Array
) -> int:  # fmt: skip
    """Gauss nodes of a cell where two successive steps are compared; above ``MAX_ORDER`` it must be cut."""
    return order(step, cell_log(length, distance, ex, ey, points, geo))


@jitable
def disk_edge(wall: int, work: Work) -> bool:
    """Whether a wall is one of a disk light: an edge of a penumbra or of a band of terminators."""
    if wall < 0:
        return False
    row = work.walls[wall // 4]
    return bool(row[KIND] == PENUMBRA or (row[KIND] == SHADOW and row[TAG] == TERMINATOR))


@jitable
def integrate_cells(
    phi: float, step: int, view: View, work: Work, gauss: Array, out: Array
) -> None:  # fmt: skip
    """Integral over the scanned line of (radiance - background) times the lobe density.

    Then the integral of its largest magnitude over the channels, a scale for errors, the error of the cells'
    rules, and the largest lobe density met; ``out`` is (6,). A cell whose rule is not as good as its step promises (a
    highlight's kink, a vein) is halved.

    ``step`` chooses the order of every cell.
    """
    geo = work.geo
    c, s = math.cos(phi), math.sin(phi)
    j = int(geo[SHAPE_INDEX])
    k = geo[RATIO]
    ex, ey, ez = (
        c * geo[E1] + s * geo[E2],
        c * geo[E1 + 1] + s * geo[E2 + 1],
        c * geo[E1 + 2] + s * geo[E2 + 2],
    )
    cbm, sbm = geo[LOBE_BETA + 1], geo[LOBE_BETA + 2]
    flat = geo[FACING + 3]
    lift = facing_share(geo[POLE], geo[POLE + 1], geo[POLE + 2], geo) - flat
    lean = facing_share(ex, ey, ez, geo) - flat
    shading = view.shading
    phong = shading[4] == PHONG
    from_eye = shading[5] == EYE
    shininess = shading[3]
    lights = view.points.shape[0]
    ambient = 0.0 if j < 0 and geo[SIDE] < 0.0 else shading[0]
    marble = j >= 0 and view.spheres[j, 7] == MARBLE
    least = order(step, SOFT_LOG)
    r, g, b, size, error, peak = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    promise, blunt = 100.0 * math.exp(-LEVELS[step]), kinked(view)
    for cell in range(work.counts[CELLS]):
        side = work.cell_side[cell]
        if side == HIDDEN:
            continue
        if j >= 0:
            factor = 1.0 if side == 1 else view.spheres[j, 10]
            ar, ag, ab = view.spheres[j, 4] * factor, view.spheres[j, 5] * factor, view.spheres[j, 6] * factor
        else:
            ar, ag, ab = geo[STRIP + 3], geo[STRIP + 4], geo[STRIP + 5]
        start, stop = work.cell_from[cell], work.cell_to[cell]
        soft = False
        if disk_edge(work.cell_wall[cell], work) or disk_edge(work.cell_wall[cell + 1], work):
            for i in range(lights):
                soft = soft or work.lit[cell, i] >= PARTLY
        a, end = start, stop
        halvings, wary = 0, False
        while a < stop:
            log_rho = cell_log(end - a, 0.5 * math.pi - end, ex, ey, view.points, geo)
            n = order(step, log_rho) if wary else nodes(step, log_rho)
            if soft:
                n = max(n + (n + 1) // 2, least)
            while n > MAX_ORDER:
                end = a + 0.5 * (end - a)
                log_rho = cell_log(end - a, 0.5 * math.pi - end, ex, ey, view.points, geo)
                n = order(step, log_rho) if wary else nodes(step, log_rho)
                if soft:
                    n = max(n + (n + 1) // 2, least)
            base = n * (n - 1) // 2
            length = end - a
            work.counts[EVALUATIONS] += n
            last, before, whole, r0, g0, b0 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            middle, lower = 0.0, 0.0
            for q in range(n):
                u, along = gauss[0, base + q], length
                if soft:
                    # a disk's light ends with the power 3/2 of the distance from a wall
                    su, cu = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
                    u, along = su * su, length * math.pi * su * cu
                x = a + length * u
                sx, cx = math.sin(x), math.cos(x)
                if j >= 0:
                    sb = k * sx
                    cb = math.sqrt(1.0 - sb * sb)
                    cg, sg = cx * cb + sx * sb, sx * cb - cx * sb
                    nx, ny, nz = sg * ex - cg * geo[POLE], sg * ey - cg * geo[POLE + 1], sg * ez - cg * geo[POLE + 2]
                    qx, qy, qz = (
                        geo[CENTER] + geo[RADIUS] * nx,
                        geo[CENTER + 1] + geo[RADIUS] * ny,
                        geo[CENTER + 2] + geo[RADIUS] * nz,
                    )
                    measure = k * k * sx * cx / cb
                else:
                    sb, cb = sx, cx
                    rr = geo[HEIGHT] * sx / cx
                    nx, ny, nz = 0.0, 0.0, 1.0
                    qx, qy, qz = geo[POINT] + rr * ex, geo[POINT + 1] + rr * ey, 0.0
                    measure = sx
                d0, d1, d2 = cb - cbm, sb * c - sbm, sb * s
                density = lobe_density(d0 * d0 + d1 * d1 + d2 * d2, geo)
                peak = max(peak, density)
                weight = gauss[1, base + q] * along * measure * density * (flat + cb * lift + sb * lean)
                if from_eye:
                    vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
                    inv = 1.0 / math.sqrt(max(vx * vx + vy * vy + vz * vz, 1e-300))
                    vx, vy, vz = vx * inv, vy * inv, vz * inv
                else:
                    vx = -cb * geo[POLE] - sb * ex
                    vy = -cb * geo[POLE + 1] - sb * ey
                    vz = -cb * geo[POLE + 2] - sb * ez
                dr, dg, db, hr, hg, hb = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for i in range(lights):
                    state = work.lit[cell, i]
                    if state == DARK:
                        continue
                    p = view.points[i]
                    if p[DISK_RADIUS] > 0.0:
                        cosine, gleam = disk_term(i, state, qx, qy, qz, nx, ny, nz, vx, vy, vz, step, view, work, gauss)
                    else:
                        cosine, gleam = light_term(
                            p[0] - qx, p[1] - qy, p[2] - qz, nx, ny, nz, vx, vy, vz, phong, shininess
                        )
                    if state != GLINT:
                        dr += p[3] * cosine
                        dg += p[4] * cosine
                        db += p[5] * cosine
                    hr += p[3] * gleam
                    hg += p[4] * gleam
                    hb += p[5] * gleam
                vein = marble_factor(nx, ny, nz, view.spheres[j, 8], view.spheres[j, 9]) if marble else 1.0
                fr = ar * vein * shading[1] * dr + ambient * shading[7] + shading[2] * hr - shading[10]
                fg = ag * vein * shading[1] * dg + ambient * shading[8] + shading[2] * hg - shading[11]
                fb = ab * vein * shading[1] * db + ambient * shading[9] + shading[2] * hb - shading[12]
                r0 += weight * fr
                g0 += weight * fg
                b0 += weight * fb
                whole += weight * max(abs(fr), abs(fg), abs(fb))
                mixture = weight * (fr + fg + fb)
                last += mixture * gauss[2, base + q]
                before += mixture * gauss[3, base + q]
                middle += mixture * gauss[MIDDLE, base + q]
                lower += mixture * gauss[MIDDLE + 1, base + q]
            middle = max(abs(middle), abs(lower))
            miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, log_rho)
            if blunt and n > 1:
                miss = max(miss, 0.5 * abs(last), 0.25 * abs(before))
            if n > 1 and miss > promise * (size + whole) and halvings < MAX_HALVINGS:
                # a cell less tame than it looks; so few points judge badly, and are not halved away from
                if n > max(step, 4):
                    halvings += 1
                    end = a + 0.5 * (end - a)
                    continue
                if not wary:
                    wary = True
                    continue
            r += r0
            g += g0
            b += b0
            size += whole
            error += miss
            a, end = end, stop
    out[0], out[1], out[2], out[3], out[4], out[5] = r, g, b, size, error, peak
