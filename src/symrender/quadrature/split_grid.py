"""The checkered floor in a lobe: what the checker adds to a floor of its mean albedo, square by square.

The floor chart integrates the mean albedo; the deviation, plus or minus half the contrast, is integrated here on the
floor itself, where the squares are the cells. Every other wall (rim, horizon, silhouettes, shadow edges) is a conic;
a square that none crosses gets a product Gauss rule, the others are cut along lines y = const. How fine depends on what
a square can hold at most, so that far ones cost a point or nothing.

Towards the horizon the squares never end. Their signs cancel: ring r about the point's foot is weighted by a smooth
taper that falls from 1 to 0 over the outer half of the rings, which damps the alternating remainder; what two tapers
of different reach disagree by is its error estimate, and rings are added until it is small.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import LIT, PARTLY, is_hidden, light_state
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.penumbra_walls import INNER, edge_search
from symrender.chambers.roots import quadratic_roots
from symrender.chambers.walls import (
    EXPONENT,
    HEIGHT,
    KIND,
    LIGHT,
    LOBE_BETA,
    PENUMBRA,
    POINT,
    RIM_COS,
    RIM_SIN,
    SHAPE,
    SURFACE_NORMAL,
)
from symrender.chambers.work import CASTERS, EVALUATIONS, OCCLUDERS, WALLS, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, order
from symrender.quadrature.light_term import light_term
from symrender.quadrature.split_line import SOFT_LOG, facing_share, lobe_density, tail_error
from symrender.scene.arrays import FLOOR_CELL, FLOOR_OFFSET

Array = npt.NDArray[np.float64]

CONIC_COLUMNS = 7
SOFT = 6
"""Column of the cone about a disk's penumbra: 1 + the index of its outer edge in the wall table; 0 of other conics."""
RINGS = 64
MAX_TILE_ORDER = 12
"""Gauss nodes a side of a square, beyond which it is quartered."""
FIRST_REACH = 15
"""Rings about the foot of a point whose lobe holds endless squares, before their error asks for more."""


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
def floor_conics(own: int, lobe: Array, view: View, work: Work, conics: Array) -> int:
    """All conics of the floor chart about the point's foot; their number."""
    geo = work.geo
    h = geo[HEIGHT]
    px, py, pz = geo[POINT], geo[POINT + 1], geo[POINT + 2]
    n = add_cone(conics, 0, lobe[0], lobe[1], lobe[2], geo[RIM_SIN] ** 2, 0.0, 0.0, h)
    row = conics[n]
    row[0] = row[1] = row[2] = row[SOFT] = 0.0
    row[3], row[4] = 0.5 * geo[SURFACE_NORMAL], 0.5 * geo[SURFACE_NORMAL + 1]
    row[5] = -h * geo[SURFACE_NORMAL + 2]
    n += 1
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


@jitable
def seen(x: float, y: float, lobe: Array, view: View, work: Work, states: Array) -> bool:
    """Whether the floor point (x, y) from the foot is in the lobe and seen; ``states`` of its lights, 0 unlit."""
    geo = work.geo
    h = geo[HEIGHT]
    dot = x * lobe[0] + y * lobe[1] - h * lobe[2]
    if not dot > geo[RIM_COS] * math.sqrt(x * x + y * y + h * h):
        return False
    qx, qy = geo[POINT] + x, geo[POINT + 1] + y
    if is_hidden(qx, qy, 0.0, view, work):
        return False
    for i in range(view.points.shape[0]):
        state = light_state(i, qx, qy, 0.0, 0.0, 0.0, 1.0, view, work)
        states[i] = state if state >= LIT else 0.0
    return True


@jitable
def integrand(
    x: float, y: float, step: int, lobe: Array, view: View, work: Work, gauss: Array, states: Array, out: Array
) -> None:  # fmt: skip
    """Lobe density times solid angle per area times sum of colour N.l over lit points, at a floor point; out (3,)."""
    geo = work.geo
    h = geo[HEIGHT]
    inv = 1.0 / math.sqrt(x * x + y * y + h * h)
    dx, dy, dz = x * inv - lobe[0], y * inv - lobe[1], -h * inv - lobe[2]
    weight = lobe_density(dx * dx + dy * dy + dz * dz, geo) * h * inv * inv * inv
    weight *= facing_share(x * inv, y * inv, -h * inv, geo)
    out[0] = out[1] = out[2] = 0.0
    for i in range(view.points.shape[0]):
        if states[i] != 0.0:
            if view.points[i, DISK_RADIUS] > 0.0:
                cosine, _ = disk_term(
                    i, int(states[i]), geo[POINT] + x, geo[POINT + 1] + y, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, step,
                    view, work, gauss,
                )  # fmt: skip
            else:
                cosine, _ = light_term(
                    view.points[i, 0] - geo[POINT] - x, view.points[i, 1] - geo[POINT + 1] - y, view.points[i, 2],
                    0.0, 0.0, 1.0, 0.0, 0.0, 1.0, False, 0.0,
                )  # fmt: skip
            for a in range(3):
                out[a] += weight * cosine * view.points[i, 3 + a]


@jitable
def strip_integral(
    x0: float, x1: float, a: float, b: float, n: int, crossing: Array, crossings: int, nx: int, step: int, lobe: Array,
    view: View, work: Work, conics: Array, gauss: Array, roots: Array, states: Array, point: Array, out: Array,
) -> None:  # fmt: skip
    """Integral over x0..x1 times a..b with ``n`` lines (square-root map at both ends), each cut at the conics."""
    base = n * (n - 1) // 2
    inner = nx * (nx - 1) // 2
    for q in range(n):
        u = gauss[0, base + q]
        s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
        y = a + (b - a) * s * s
        slope = gauss[1, base + q] * (b - a) * math.pi * s * c
        k = 1
        roots[0] = x0
        for i in range(crossings):
            row = conics[int(crossing[i])]
            edges = work.quartic
            if row[SOFT] > 0.0:
                # both edges of the penumbra lie inside the cone
                outer = int(row[SOFT]) - 1
                found = edge_search(work.walls[outer], x0, x1, math.nan, y, work.geo, edges)
                found += edge_search(work.walls[outer + 1], x0, x1, math.nan, y, work.geo, edges[found:])
            else:
                found, edges[0], edges[1] = quadratic_roots(
                    row[0], row[1] * y + row[3], row[2] * y * y + 2.0 * row[4] * y + row[5]
                )
            for j in range(found):
                x = edges[j]
                if x0 < x < x1 and k < roots.shape[0] - 1:
                    p = k
                    while p > 0 and roots[p - 1] > x:
                        roots[p] = roots[p - 1]
                        p -= 1
                    roots[p] = x
                    k += 1
        roots[k] = x1
        for piece in range(k):
            left, width = roots[piece], roots[piece + 1] - roots[piece]
            if width < 1e-14 or not seen(left + 0.5 * width, y, lobe, view, work, states):
                continue
            work.counts[EVALUATIONS] += nx
            soft = False
            for i in range(states.shape[0]):
                soft = soft or states[i] >= PARTLY
            for e in range(nx):
                u, along = gauss[0, inner + e], width
                if soft:
                    s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
                    u, along = s * s, width * math.pi * s * c
                integrand(left + width * u, y, step, lobe, view, work, gauss, states, point)
                w = slope * along * gauss[1, inner + e]
                for t in range(3):
                    out[t] += w * point[t]


@jitable
def cut_square(
    x0: float, y0: float, size: float, step: int, log_rho: float, share: float, lobe: Array, view: View, work: Work,
    conics: Array, crossing: Array, crossings: int, gauss: Array, roots: Array, states: Array, point: Array,
    stack: Array, out: Array,
) -> float:  # fmt: skip
    """Integral of a square some conics cross, added to ``out``; its error estimate.

    Lines start at the conics' tangencies and at their passages through the square's sides; strips whose two orders
    disagree (two conics meet inside) are halved.
    """
    x1, y1 = x0 + size, y0 + size
    k = 2
    roots[0], roots[1] = y0, y1
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
                if y0 < y < y1 and k < roots.shape[0]:
                    p = k
                    while p > 0 and roots[p - 1] > y:
                        roots[p] = roots[p - 1]
                        p -= 1
                    roots[p] = y
                    k += 1
    top = 0
    for i in range(k - 1):
        if roots[i + 1] - roots[i] > 1e-13 * size and top < stack.shape[0]:
            stack[top, 0], stack[top, 1], stack[top, 2] = roots[i], roots[i + 1], 0.0
            top += 1
    error = 0.0
    coarse, fine = stack[stack.shape[0] - 1], stack[stack.shape[0] - 2]
    nx = min(MAX_ORDER, order(step, log_rho))
    for i in range(crossings):
        if conics[int(crossing[i]), SOFT] > 0.0:
            nx = max(nx, min(MAX_ORDER, order(step, SOFT_LOG)))
    while top > 0:
        top -= 1
        a, b, depth = stack[top, 0], stack[top, 1], stack[top, 2]
        n = min(MAX_ORDER - 3, max(3, order(step, log_rho * 0.7)))
        coarse[0] = coarse[1] = coarse[2] = fine[0] = fine[1] = fine[2] = 0.0
        strip_integral(
            x0,
            x1,
            a,
            b,
            n,
            crossing,
            crossings,
            nx,
            step,
            lobe,
            view,
            work,
            conics,
            gauss,
            roots,
            states,
            point,
            coarse,
        )
        strip_integral(
            x0,
            x1,
            a,
            b,
            n + 2,
            crossing,
            crossings,
            nx,
            step,
            lobe,
            view,
            work,
            conics,
            gauss,
            roots,
            states,
            point,
            fine,
        )
        change = max(abs(fine[0] - coarse[0]), abs(fine[1] - coarse[1]), abs(fine[2] - coarse[2]))
        if change > share and depth < 8.0 and top + 4 < stack.shape[0]:
            m = 0.5 * (a + b)
            stack[top, 0], stack[top, 1], stack[top, 2] = a, m, depth + 1.0
            stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = m, b, depth + 1.0
            top += 2
            continue
        for t in range(3):
            out[t] += fine[t]
        error += change
    return error


@jitable
def smooth_tile(
    x0: float, y0: float, size: float, n: int, step: int, lobe: Array, view: View, work: Work, gauss: Array,
    states: Array, point: Array, out: Array,
) -> float:  # fmt: skip
    """Integral of a square no conic crosses by n x n Gauss nodes, in ``out``; its error, read off its coefficients."""
    base = n * (n - 1) // 2
    work.counts[EVALUATIONS] += n * n
    whole, last_x, before_x, last_y, before_y = 0.0, 0.0, 0.0, 0.0, 0.0
    out[0] = out[1] = out[2] = 0.0
    for q in range(n):
        y = y0 + size * gauss[0, base + q]
        row, last, before = 0.0, 0.0, 0.0
        for e in range(n):
            integrand(x0 + size * gauss[0, base + e], y, step, lobe, view, work, gauss, states, point)
            w = gauss[1, base + q] * gauss[1, base + e] * size * size
            for t in range(3):
                out[t] += w * point[t]
            value = w * (point[0] + point[1] + point[2])
            row += value
            last += value * gauss[2, base + e]
            before += value * gauss[3, base + e]
        whole += row
        last_x += abs(last)
        before_x += abs(before)
        last_y += row * gauss[2, base + q]
        before_y += row * gauss[3, base + q]
    return float(tail_error(n, last_x, before_x, whole) + tail_error(n, last_y, before_y, whole))


@jitable
def add_tile(
    x0: float, y0: float, size: float, share: float, ease: float, lobe: Array, view: View, work: Work, conics: Array,
    count: int, gauss: Array, roots: Array, states: Array, stack: Array, out: Array,
) -> float:  # fmt: skip
    """Add the integral of one square to ``out``; its error estimate.

    Squares that a conic crosses are few and may err ``ease`` times as much.
    A square whose bound is within ``share`` is left out, one too near to the point or too wide for the lobe is
    quartered, and so is one whose rule does not keep its promise.
    """
    geo = work.geo
    h = geo[HEIGHT]
    rim = math.atan2(geo[RIM_SIN], geo[RIM_COS])
    width = min(0.6, 1.4 / math.sqrt(geo[EXPONENT] + 1e-9))
    light = 0.0
    for i in range(view.points.shape[0]):
        light += max(view.points[i, 3], view.points[i, 4], view.points[i, 5])
    point, part, crossing = stack[0], stack[1], stack[2]
    tiles = stack[3:64]
    tiles[0, 0], tiles[0, 1], tiles[0, 2], tiles[0, 3] = x0, y0, size, share
    top = 1
    error = 0.0
    while top > 0:
        top -= 1
        x, y, side, aim = tiles[top, 0], tiles[top, 1], tiles[top, 2], tiles[top, 3]
        half = 0.5 * side
        xc, yc = x + half, y + half
        away = math.sqrt(xc * xc + yc * yc)
        d = math.sqrt(away * away + h * h)
        near = max(0.0, away - 1.4143 * half)
        near = math.sqrt(near * near + h * h)
        # no part of the square comes nearer to the lobe's axis than this
        reach = 1.4143 * half / d
        dot = (xc * lobe[0] + yc * lobe[1] - h * lobe[2]) / d
        theta = math.acos(max(-1.0, min(1.0, dot))) - (math.asin(reach) if reach < 1.0 else math.pi)
        if theta > rim:
            continue
        chord = 2.0 * math.sin(0.5 * max(0.0, theta))
        bound = lobe_density(chord * chord, geo) * h * side * side / (near * near * near) * light
        if bound <= aim:
            error += bound
            continue
        ratio = 2.0 * near * width / side
        quarter = ratio < 0.8
        part[0] = part[1] = part[2] = 0.0
        miss = bound
        if not quarter:
            log_rho = math.log(ratio + math.sqrt(1.0 + ratio * ratio))
            crossings = 0
            for k in range(count):
                if may_cross(conics[k], xc, yc, half) and crossings < crossing.shape[0]:
                    crossing[crossings] = k
                    crossings += 1
            room = aim * ease if crossings > 0 else aim
            if bound <= room:
                error += bound
                continue
            level = math.log(bound / room)
            step = 0
            while step + 1 < len(LEVELS) and LEVELS[step] < level:
                step += 1
            if crossings == 0:
                if not seen(xc, yc, lobe, view, work, states):
                    continue
                n = max(1, math.ceil(0.5 * level / log_rho))
                quarter = n > MAX_TILE_ORDER
                if not quarter:
                    miss = smooth_tile(x, y, side, n, step, lobe, view, work, gauss, states, point, part)
                    if n == 1:
                        miss = 2.0 * bound * math.exp(-2.0 * log_rho)
                    # more nodes are cheaper than quarters, which need as many each
                    while miss > 3.0 * aim and n < MAX_TILE_ORDER:
                        n = min(MAX_TILE_ORDER, n + 3)
                        miss = smooth_tile(x, y, side, n, step, lobe, view, work, gauss, states, point, part)
                    quarter = miss > 3.0 * aim
            else:
                miss = cut_square(
                    x, y, side, step, log_rho, room, lobe, view, work, conics, crossing, crossings, gauss, roots,
                    states, point, stack[64:], part,
                )  # fmt: skip
                quarter = miss > 10.0 * room and side > 1e-3 * size
        if quarter and side > 1e-9 * size and top + 4 <= tiles.shape[0]:
            for a in range(2):
                for b in range(2):
                    tiles[top, 0], tiles[top, 1] = x + a * half, y + b * half
                    tiles[top, 2], tiles[top, 3] = half, 0.4 * aim
                    top += 1
            continue
        error += miss
        for t in range(3):
            out[t] += part[t]
    return error


@jitable
def taper(ring: int, reach: float) -> float:
    """1 up to half of ``reach``, then a C-infinity fall to 0 at ``reach``."""
    x = 2.0 * ring / reach - 1.0
    if x <= 0.0:
        return 1.0
    if x >= 1.0:
        return 0.0
    a, b = math.exp(-1.0 / x), math.exp(-1.0 / (1.0 - x))
    return b / (a + b)


@jitable
def split_grid(
    tol: float, own: int, lobe: Array, view: View, work: Work, conics: Array, gauss: Array, rings: Array,
    roots: Array, states: Array, stack: Array, max_evaluations: int, value: Array,
) -> float:  # fmt: skip
    """Add the checker's deviation from its mean albedo to ``value``; returns the error estimate.

    ``work`` holds the floor chart of the point. ``value`` (3,) is in units of half the contrast times kd.
    """
    geo = work.geo
    h = geo[HEIGHT]
    size = view.floor[FLOOR_CELL]
    count = floor_conics(own, lobe, view, work, conics)
    if count > conics.shape[0]:
        return math.inf
    # how far from the foot the lobe reaches
    steepest = geo[LOBE_BETA] + math.atan2(geo[RIM_SIN], geo[RIM_COS])
    reach = h * math.tan(steepest) if steepest < 1.5707 else math.inf
    px, py = geo[POINT] - view.floor[FLOOR_OFFSET], geo[POINT + 1] - view.floor[FLOOR_OFFSET + 1]
    ci, cj = math.floor(px / size), math.floor(py / size)
    whole = reach / size + 1.0 < rings.shape[0]
    for r in range(rings.shape[0]):
        for t in range(4):
            rings[r, t] = 0.0
    out = roots[roots.shape[0] - 3 :]
    error, change = 0.0, 0.0
    first, last = 0, int(reach / size) + 1 if whole else FIRST_REACH
    while True:
        for ring in range(first, last + 1):
            share = 0.15 * tol / ((last + 1) * max(1, 8 * ring))
            for i in range(-ring, ring + 1):
                jump = 1 if abs(i) == ring else max(1, 2 * ring)
                for j in range(-ring, ring + 1, jump):
                    if work.counts[EVALUATIONS] > max_evaluations:
                        # from here on every square is its bound
                        share = math.inf
                    sign = 1.0 if (ci + cj + i + j) % 2 == 0 else -1.0
                    out[0] = out[1] = out[2] = 0.0
                    error += add_tile(
                        (ci + i) * size - px, (cj + j) * size - py, size, share, max(1.0, ring), lobe, view, work,
                        conics, count, gauss, roots[: roots.shape[0] - 3], states, stack, out,
                    )  # fmt: skip
                    for t in range(3):
                        rings[ring, t] += sign * out[t]
        if whole:
            break
        change = 0.0
        for t in range(3):
            total, shorter = 0.0, 0.0
            for ring in range(last + 1):
                total += rings[ring, t] * taper(ring, last + 1)
                shorter += rings[ring, t] * taper(ring, 0.7 * (last + 1))
            change = max(change, abs(total - shorter))
        if change < 0.1 * tol or last + 1 >= rings.shape[0]:
            break
        first, last = last + 1, min(2 * last + 1, rings.shape[0] - 1)
    for t in range(3):
        for ring in range(last + 1):
            value[t] += rings[ring, t] * (1.0 if whole else taper(ring, last + 1))
    return error + 3.0 * change
