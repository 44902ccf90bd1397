"""A square of the checkered floor that walls cross, cut along lines y = const."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.labels import HIDDEN, LIT, PARTLY, is_hidden, light_state
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.walls import HEIGHT, POINT, RIM_COS
from symrender.chambers.work import EVALUATIONS, View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.floor_conics import TANGENT, conic_roots, square_cuts
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, MIDDLE, nodes
from symrender.quadrature.split_line import SOFT_LOG, facing_share, lobe_density, tail_error
from symrender.quadrature.split_panel import azimuth

Array = npt.NDArray[np.float64]

MAX_HALVINGS = 5
"""How often a strip of a square is halved at most."""
MORE_LEVELS = 3
"""How many levels finer than asked, each of two lines and a node more, a strip may become before it is halved."""
MAX_STRIPS = 200
"""Strips evaluated in a square; beyond, those that miss stand as they are."""
MAX_LINES = 16
"""Lines beyond which a strip is halved."""
BRANCHES = 16
"""Most roots of one conic on a line."""


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
                lx, ly = view.points[i, 0] - geo[POINT] - x, view.points[i, 1] - geo[POINT + 1] - y
                rise = view.points[i, 2]
                cosine = rise / math.sqrt(max(lx * lx + ly * ly + rise * rise, 1e-300))
            for a in range(3):
                out[a] += weight * cosine * view.points[i, 3 + a]


@jitable
def taper(distance: float, reach: float) -> float:
    """1 near the foot, 0 beyond ``reach``, up to 1e-8; entire, but for a step of 1e-12."""
    return 1.0 if distance <= 0.1 * reach else 0.5 * math.erfc((distance / reach - 0.6) / 0.1)


@jitable
def row_pieces(
    y: float, x0: float, x1: float, crossing: Array, crossings: int, conics: Array, work: Work
) -> tuple[int, int]:  # fmt: skip
    """Pieces of the line y = const between x0 and x1; their number and the signature of their order.

    ``work.root_x`` gets their ends, one more than pieces, ``work.root_id`` the wall at the lower end of each.
    """
    ends, ids = work.root_x, work.root_id
    n = 1
    ends[0], ids[0] = x0, -1
    for i in range(crossings):
        found = conic_roots(conics[int(crossing[i])], y, x0, x1, work)
        for j in range(found):
            x = work.quartic[j]
            if x0 < x < x1 and n < ends.shape[0] - 1:
                p = n
                while p > 0 and ends[p - 1] > x:
                    ends[p], ids[p] = ends[p - 1], ids[p - 1]
                    p -= 1
                ends[p], ids[p] = x, BRANCHES * i + j
                n += 1
    ends[n] = x1
    signature = n
    for i in range(1, n):
        signature = (signature * 1000003) ^ ids[i]
    return n, signature


@jitable
def change_of_rows(
    low: float, high: float, x0: float, x1: float, crossing: Array, crossings: int, conics: Array, work: Work
) -> float:  # fmt: skip
    """The y between ``low`` and ``high``, whose rows differ in structure, where the structure of ``low`` ends."""
    _, before = row_pieces(low, x0, x1, crossing, crossings, conics, work)
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high or high - low < 1e-13 * (abs(low) + abs(high) + x1 - x0):
            return middle
        _, found = row_pieces(middle, x0, x1, crossing, crossings, conics, work)
        if found == before:
            low = middle
        else:
            high = middle


@jitable
def strip_integral(
    x0: float, x1: float, a: float, b: float, kind_a: float, kind_b: float, n: int, more: int, signature: int,
    crossing: Array, crossings: int, step: int, span: float, reach: float, lobe: Array, view: View, work: Work,
    conics: Array, gauss: Array, states: Array, point: Array, out: Array,
) -> float:  # fmt: skip
    """Integral over x0..x1 times a..b with ``n`` lines of equal structure, each cut at the conics, in out[0:3].

    Pieces get ``more`` nodes than ``step`` asks. ``out[3:6]`` is the same under the shorter taper, ``out[6]`` the error
    estimate. Returns the y of a line of another structure than ``signature``, or NaN.
    """
    base = n * (n - 1) // 2
    for t in range(7):
        out[t] = 0.0
    lit, side = work.lit, work.cell_side
    last, before, size, inner = 0.0, 0.0, 0.0, 0.0
    middle, lower = 0.0, 0.0
    for q in range(n):
        y, slope = azimuth(gauss[0, base + q], a, b, kind_a, kind_b)
        slope *= gauss[1, base + q]
        pieces, found = row_pieces(y, x0, x1, crossing, crossings, conics, work)
        if found != signature:
            return y
        line = 0.0
        for piece in range(pieces):
            left, width = work.root_x[piece], work.root_x[piece + 1] - work.root_x[piece]
            if q == 0:
                # labels are those of the whole strip
                side[piece] = 1 if seen(left + 0.5 * width, y, lobe, view, work, states) else HIDDEN
                if side[piece] != HIDDEN:
                    for i in range(states.shape[0]):
                        lit[piece, i] = int(states[i])
            if side[piece] == HIDDEN or width < 1e-14:
                continue
            soft = False
            for i in range(states.shape[0]):
                states[i] = lit[piece, i]
                soft = soft or states[i] >= PARTLY
            x = span / width
            log_rho = math.log(x + math.sqrt(1.0 + x * x))
            nx = nodes(step, log_rho) + more
            if soft:
                nx = max(nx + (nx + 1) // 2, nodes(step, SOFT_LOG))
            nx = min(nx, MAX_ORDER)
            start = nx * (nx - 1) // 2
            work.counts[EVALUATIONS] += nx
            whole, top, second, half, under = 0.0, 0.0, 0.0, 0.0, 0.0
            for e in range(nx):
                u, along = gauss[0, start + e], width
                if soft:
                    s, c = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
                    u, along = s * s, width * math.pi * s * c
                x = left + width * u
                integrand(x, y, step, lobe, view, work, gauss, states, point)
                distance = math.sqrt(x * x + y * y)
                far, near = taper(distance, reach), taper(distance, 0.7 * reach)
                w = slope * along * gauss[1, start + e]
                for t in range(3):
                    out[t] += w * far * point[t]
                    out[3 + t] += w * near * point[t]
                value = w * far * (point[0] + point[1] + point[2])
                whole += value
                top += value * gauss[2, start + e]
                second += value * gauss[3, start + e]
                half += value * gauss[MIDDLE, start + e]
                under += value * gauss[MIDDLE + 1, start + e]
            line += whole
            inner += tail_error(nx, top, second, max(abs(half), abs(under)), abs(whole), log_rho)
        size += abs(line)
        last += line * gauss[2, base + q]
        before += line * gauss[3, base + q]
        middle += line * gauss[MIDDLE, base + q]
        lower += line * gauss[MIDDLE + 1, base + q]
    middle = max(abs(middle), abs(lower))
    x = span / (b - a)
    out[6] = inner + 2.0 * tail_error(n, last, before, middle, size, math.log(x + math.sqrt(1.0 + x * x)))
    return math.nan


@jitable
def cut_square(
    x0: float, y0: float, size: float, step: int, span: float, reach: float, room: float, bound: float, lobe: Array,
    view: View, work: Work, conics: Array, crossing: Array, crossings: int, gauss: Array, states: Array, scratch: Array,
    out: Array,
) -> float:  # fmt: skip
    """Add the integral of a square some conics cross to ``out`` (6,); its error estimate. The second half of ``out`` is
    under the shorter taper; ``bound`` is what the square can hold.

    Lines start at the conics' tangencies, at their passages through the square's sides and
    where two conics meet, which is where the order of their roots changes; strips that miss ``room`` are halved.
    ``span`` is the length over which the integrand is tame.
    """
    x1, y1 = x0 + size, y0 + size
    cuts, kinds, point, part = scratch[0], scratch[1], scratch[2], scratch[3]
    stack = scratch[4:]
    n = square_cuts(x0, x1, y0, y1, crossing, crossings, conics, cuts, kinds)
    top = 0
    for i in range(n - 1):
        if cuts[i + 1] - cuts[i] > 1e-13 * size and top < stack.shape[0]:
            row = stack[top]
            row[0], row[1], row[4], row[5] = cuts[i], cuts[i + 1], 0.0, step
            row[2] = ROOT if kinds[i] == TANGENT else SMOOTH
            row[3] = ROOT if kinds[i + 1] == TANGENT else SMOOTH
            top += 1
    error = 0.0
    strips = 0
    while top > 0:
        top -= 1
        strips += 1
        row = stack[top]
        a, b, kind_a, kind_b, depth, level = row[0], row[1], row[2], row[3], row[4], int(row[5])
        room_left = top + 2 < stack.shape[0]
        inset = 1e-9 * (b - a)
        pieces, signature = row_pieces(a + inset, x0, x1, crossing, crossings, conics, work)
        _, other = row_pieces(b - inset, x0, x1, crossing, crossings, conics, work)
        x = 0.7 * span / (b - a)
        more = level - step
        lines = min(MAX_ORDER, max(3 + 2 * more, nodes(level, math.log(x + math.sqrt(1.0 + x * x)))))
        foreign = b - inset
        if other == signature:
            foreign = strip_integral(
                x0, x1, a, b, kind_a, kind_b, lines, more, signature, crossing, crossings, level, span, reach, lobe,
                view, work, conics, gauss, states, point, part,
            )  # fmt: skip
        if foreign == foreign:
            if b - a < 1e-9 * size or not room_left or strips > MAX_STRIPS:
                # too thin to matter, or walls that rounding moves about: all it can hold is its error
                error += bound * (b - a) / size
                continue
            cut = change_of_rows(a + inset, foreign, x0, x1, crossing, crossings, conics, work)
            beyond, _ = row_pieces(b - inset, x0, x1, crossing, crossings, conics, work)
            # two conics that meet change places; an edge of a penumbra may open a piece like a square root
            kind = SMOOTH if beyond == pieces else ROOT
        elif part[6] <= room or not room_left or strips > MAX_STRIPS:
            for t in range(6):
                out[t] += part[t]
            error += part[6]
            continue
        elif level < min(step + MORE_LEVELS, len(LEVELS) - 1) and lines < MAX_LINES:
            row[5] = level + 1
            top += 1
            continue
        elif depth < MAX_HALVINGS:
            cut, kind, depth, level = 0.5 * (a + b), SMOOTH, depth + 1.0, step
        else:
            for t in range(6):
                out[t] += part[t]
            error += part[6]
            continue
        low, high = stack[top], stack[top + 1]
        low[0], low[1], low[2], low[3], low[4], low[5] = a, cut, kind_a, kind, depth, level
        high[0], high[1], high[2], high[3], high[4], high[5] = cut, b, kind, kind_b, depth, level
        top += 2
    return error
