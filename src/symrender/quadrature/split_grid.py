"""The checkered floor in a lobe: what the checker adds to a floor of its mean albedo.

The floor chart integrates the mean albedo; the deviation, plus or minus half the contrast, is integrated here on the
floor itself. Every wall (rim, horizon, silhouettes, shadow edges) is a conic. A block of 2^k x 2^k squares that none
crosses is one tensor rule, whatever k: the nodes are Gauss's, the weights are the integrals of their Lagrange
polynomials times the checker's signs, so the rule is exact for a polynomial under the checker and blocks may grow with
their distance. Blocks that a conic crosses are quartered down to single squares, which are cut along lines y = const.

Towards the horizon the squares never end. Their signs cancel: the integrand is weighted by a smooth taper in the
distance from the point's foot, which damps the alternating remainder; what three tapers of different reach disagree by
(two may agree by chance) is its error estimate, to which comes what none of them sees (``grid_tail.py``), and the reach
is doubled until it is small.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.width import width_at
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.leaves.values import floor_phases
from symrender.quadrature.fall_off import light_beyond, most_floor_light
from symrender.quadrature.floor_conics import floor_conics, is_felt, may_cross, touch_conics
from symrender.quadrature.gauss import BLOCK_LEVELS, MIDDLE, step_of
from symrender.quadrature.grid_blocks import block_bound, block_level, block_sign, push_quarters
from symrender.quadrature.grid_tail import remainders_of, tail_of_squares
from symrender.quadrature.paces import felt, left_out
from symrender.quadrature.row_levels import is_metal, levels_span
from symrender.quadrature.rule_errors import block_error, note_parted_lines, taper_change
from symrender.quadrature.split_scratch import SplitWork
from symrender.quadrature.split_square import Ground, Square, cut_square
from symrender.quadrature.square_nodes import add_tapered, floor_nodes, seen
from symrender.quadrature.veins import SMALL_PART, TAME_VEINS, VEINS
from symrender.scene.arrays import CHECKER, MARBLE, STRIPES

Array = npt.NDArray[np.float64]

MAX_BLOCK_ORDER = 12
"""Gauss nodes a side of a block, beyond which it is quartered."""
FIRST_REACH = 18.0
"""Squares from the foot of a point whose lobe holds endless squares, before their error asks for more."""
MOST_REACH = 200.0
MOST_SQUARES = 2.0 ** (BLOCK_LEVELS - 2) - 2.0
"""So many squares on every side are all that a block can hold."""
LEAST_LOG = 1e-3
"""Least log rho that is asked of: a block beside a singular place is quartered all the same."""
LEAVES = 30.0
"""Blocks that share the tolerance; most err far less than their share."""
UNFELT_TOUCH = 1.0
"""Share of what a block may err by below which it is not cut where circles touch."""
SMALLEST = 1e-6
"""Side of the smallest part of a square, in squares."""
SMALLEST_CUT = 0.05
"""The same where walls cross it: they are cut in closed form, and quarters help little."""


@jitable
def grid_reach(
    squares: float, lobe: Array, view: View, work: Work
) -> tuple[bool, float, float, float, float, float]:  # fmt: skip
    """(whole, reach, half-width, x, y, beyond): what of the endless squares is looked at, about (x, y) from the foot.

    ``whole`` says that it is all that the lobe sees; else it lies about the foot and is tapered to ``reach``, at least
    ``squares`` squares, and ``beyond`` bounds the deviation that no block can reach, in units of ``value``.
    """
    chart = work.chart
    h, cell = chart.height, view.floor.cell
    half = math.atan2(chart.lobe.rim_sin, chart.lobe.rim_cos)
    steepest, least = chart.lobe_beta + half, chart.lobe_beta - half
    if steepest < 1.5707:
        wide = 0.5 * h * (math.tan(steepest) - math.tan(least))
        if wide < MOST_REACH * cell:
            # the longer axis of the lobe's ellipse lies towards its axis
            away = 0.5 * h * (math.tan(steepest) + math.tan(least))
            across = math.sqrt(lobe[0] * lobe[0] + lobe[1] * lobe[1])
            scale = away / across if across > 0.0 else 0.0
            return True, math.inf, wide, scale * lobe[0], scale * lobe[1], 0.0
    # the taper must not end before the lobe has well begun
    near = h * math.tan(min(1.5707, max(0.0, least)))
    if chart.normal[2] > 0.0:
        tilt = math.sqrt(chart.normal[0] ** 2 + chart.normal[1] ** 2)
        near = max(near, chart.normal[2] * h / max(tilt, 1e-300))
    # nor before the lobe has grown to what it is at its axis, or at the horizon if that is nearer
    gap = max(0.0, 0.5 * math.pi - chart.lobe_beta) + width_at(max(0.0, chart.lobe_beta - 0.5 * math.pi), chart.lobe)
    grown = h / math.tan(gap) if gap < 0.5 * math.pi else 0.0
    wanted = max(squares * cell, 3.0 * h, 4.0 * near, 4.0 * grown)
    reach = min(wanted, MOST_SQUARES * cell)
    beyond = 0.0
    if reach < max(3.0 * h, 2.0 * near):
        # all of it lies beyond the farther of the two, and below the horizon
        begin = max(reach, near)
        gap = max(math.atan2(begin, h) - chart.lobe_beta, chart.lobe_beta - 0.5 * math.pi)
        beyond = largest_density(4.0 * math.sin(0.5 * max(0.0, gap)) ** 2, chart.lobe) * light_beyond(
            begin, view, chart
        )
        # no more than all of it, nor than the squares at the ends of every stretch of a row that do not cancel
        stretches = 1.0 + work.counts.occluders + work.counts.casters
        far = math.sqrt(h * h + begin * begin)
        beyond *= min(2.0 * math.pi * h / far, 3.0 * stretches * cell * h / (far * far))
    return False, reach, reach, 0.0, 0.0, beyond


@inlined
def smooth_block(
    x0: float, y0: float, side: float, level: int, n: int, step: int, log_rho: float, reach: float, ground: Ground, out:
    Array,
) -> float:  # fmt: skip
    """Integral of a block of 2^level squares a side that no conic crosses, by n x n nodes, in out[0:3].

    ``out[3:9]`` is the same under the two shorter tapers. Returns its error, read off its coefficients.
    """
    lobe, view, work, _, gauss, states = ground
    chart, base, kind = work.chart, n * (n - 1) // 2, view.floor.kind
    veined = kind == MARBLE and side > 0.5 * view.floor.cell
    weighed = level > 0 or veined
    weights = gauss[3 + level] if level > 0 else gauss[1]
    # along stripes no sign changes
    down = gauss[1] if kind == STRIPES else weights
    other, under, odd = weights, down, 0.0
    if veined:
        rows = VEINS + 4 * level
        weights, other, down, under = gauss[rows], gauss[rows + 1], gauss[rows + 2], gauss[rows + 3]
        begin = math.floor((y0 + chart.point[1] - view.floor.offset[1]) / view.floor.cell + 0.5)
        odd = 1.0 if begin % 2 == 0 else -1.0
    work.counts.evaluations += n * n
    b, row = work.nodes, work.pieces[0]
    row.cell, row.first, row.count = 0, 0, n * n
    for i in range(states.shape[0]):
        work.lit[0, i] = int(states[i])
    for q in range(n):
        for e in range(n):
            b.sine[n * q + e] = x0 + side * gauss[0, base + e]
            b.cosine[n * q + e] = y0 + side * gauss[0, base + q]
            b.weight[n * q + e] = side * side
    floor_nodes(n * n, 1, step, reach, kind == MARBLE and not veined, lobe, view, work, gauss)
    whole, size, last_x, before_x, last_y, before_y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    middle_x, middle_y, lower_y = 0.0, 0.0, 0.0
    steep, steep_last, steep_before, steep_middle = 0.0, 0.0, 0.0, 0.0
    for t in range(9):
        out[t] = 0.0
    for q in range(n):
        line, last, before, middle, lower = 0.0, 0.0, 0.0, 0.0, 0.0
        for e in range(n):
            i = n * q + e
            red, green, blue = b.radiance[0, i], b.radiance[1, i], b.radiance[2, i]
            w = down[base + q] * weights[base + e]
            if veined:
                w += odd * under[base + q] * other[base + e]
            add_tapered(red, green, blue, w, b.near[i], b.between[i], out)
            value = gauss[1, base + q] * gauss[1, base + e] * (red + green + blue)
            line += value
            last += value * gauss[2, base + e]
            before += value * gauss[3, base + e]
            middle += value * gauss[MIDDLE, base + e]
            lower += value * gauss[MIDDLE + 1, base + e]
            size += abs(value)
        # veins have both signs
        whole = size if kind == MARBLE else whole + line
        last_x += abs(last)
        before_x += abs(before)
        middle_x += max(abs(middle), abs(lower))
        steep += abs(tangent(line))
        steep_last += abs(tangent(last))
        steep_before += abs(tangent(before))
        steep_middle += max(abs(tangent(middle)), abs(tangent(lower)))
        last_y += line * gauss[2, base + q]
        before_y += line * gauss[3, base + q]
        middle_y += line * gauss[MIDDLE, base + q]
        lower_y += line * gauss[MIDDLE + 1, base + q]
    miss = block_error(
        n, level, weighed, kind, last_x, before_x, middle_x, abs(last_y), abs(before_y),
        max(abs(middle_y), abs(lower_y)), whole, log_rho,
    )  # fmt: skip
    if moves(miss):
        missed = block_error(
            n, level, weighed, kind, steep_last, steep_before, steep_middle, abs(tangent(last_y)),
            abs(tangent(before_y)), max(abs(tangent(middle_y)), abs(tangent(lower_y))), steep, held(log_rho),
        )  # fmt: skip
        return moved(held(miss), missed)
    return miss


@inlined
def block_order(fall: float, level: int, kind: float, log_rho: float) -> int:
    """Nodes a side of a block of 2^level squares whose error is to be exp(-fall) of what it holds."""
    n = max(2, math.ceil(0.5 * fall / log_rho))
    if level > 0 and kind != STRIPES:
        n = max(2 if kind == CHECKER else n, math.ceil((fall - 0.693 * level) / log_rho))
    return n


@inlined
def find_crossing(
    x: float, y: float, half: float, level: int, least: float, ground: Ground, count: int, crossing: Array
) -> int:  # fmt: skip
    """How many of ``count`` conics may cross the block from (x, y) on, and which; of a block of many squares, one.

    Those that are felt less than ``least`` there are no walls.
    """
    view, conics, foot = ground.world, ground.conics, ground.work.chart.point
    found = 0
    for k in range(count):
        if view.glows is not None and not is_felt(conics[k], foot[0] + x + half, foot[1] + y + half, half, least, view):
            continue
        if may_cross(conics[k], x + half, y + half, half) and found < crossing.shape[0]:
            crossing[found] = k
            found += 1
            if level > 0:
                break
    return found


@inlined
def levels_log(x: float, y: float, side: float, log_rho: float, ground: Ground) -> float:
    """The least of ``log_rho`` and that of what levels of a metal leave tame of a block."""
    if not is_metal(ground.world, ground.work.chart):
        return log_rho
    half = 0.5 * side
    ratio = levels_span(held(x) + half, held(y) + half, half, ground.lobe, ground.world, ground.work) / side
    return max(LEAST_LOG, min(log_rho, math.log(ratio + math.sqrt(1.0 + ratio * ratio))))


@jitable
def grid_once(
    aim: float, reach: float, low_x: float, low_y: float, level: int, ground: Ground, count: int, stack: Array, out:
    Array,
) -> tuple[float, float]:  # fmt: skip
    """The deviation over the block of 2^level squares from (low_x, low_y) on, in out[0:9].

    Returns (error estimate, what of it no node was asked of).

    A block whose bound is small is left out, one too near to the point or too wide for the lobe is quartered, and so is
    one whose rule does not come within ``aim``.
    """
    lobe, view, work, states = ground.lobe, ground.world, ground.work, ground.states
    chart = work.chart
    cell, kind = view.floor.cell, view.floor.kind
    light = most_floor_light(view)
    part, crossing, blocks, scratch = stack[0], stack[1], stack[2:160], stack[160:]
    for t in range(9):
        out[t] = 0.0
    blocks[0, 0], blocks[0, 1], blocks[0, 2], blocks[0, 3] = low_x, low_y, cell * 2.0**level, level
    top = 1
    error, unseen = 0.0, 0.0
    while top > 0:
        top -= 1
        x, y, side, level = blocks[top, 0], blocks[top, 1], blocks[top, 2], int(blocks[top, 3])
        half = 0.5 * side
        bound, span, near = block_bound(x, y, side, reach, light, lobe, view, chart)
        bound = held(bound)
        beside = left_out(bound, work)
        if felt(beside, work) <= aim / (1.0 + near / cell):
            error += beside
            unseen += bound
            continue
        ratio = span / side
        work.counts.labour += 1
        if is_spent(work):
            error += beside
            unseen += bound
            continue
        quarter = ratio < 0.8
        miss, lost = beside, 0.0
        for t in range(9):
            part[t] = 0.0
        if not quarter:
            log_rho = math.log(ratio + math.sqrt(1.0 + ratio * ratio))
            crossings = find_crossing(x, y, half, level, UNFELT_TOUCH * aim / bound, ground, count, crossing)
            if kind == MARBLE and (crossings > 0 or side < 0.75 * cell):
                # here veins are taken at nodes, in parts that are small beside them
                ratio = min(ratio, TAME_VEINS * cell / side)
                span, log_rho = ratio * side, math.log(ratio + math.sqrt(1.0 + ratio * ratio))
                quarter = side > SMALL_PART * cell
            fall = math.log(bound / aim)
            step = step_of(fall)
            if not quarter and crossings == 0:
                if not seen(x + half, y + half, lobe, view, work, states):
                    continue
                log_rho = levels_log(x, y, side, log_rho, ground)
                n = block_order(fall, level, kind, log_rho)
                quarter = n > MAX_BLOCK_ORDER
                if not quarter:
                    miss = smooth_block(x, y, side, level, n, step, log_rho, reach, ground, part)
                    # more nodes are cheaper than quarters, which need as many each
                    while felt(miss, work) > aim and n < MAX_BLOCK_ORDER:
                        n = min(MAX_BLOCK_ORDER, n + 2)
                        miss = smooth_block(x, y, side, level, n, step, log_rho, reach, ground, part)
                    quarter = felt(miss, work) > 3.0 * aim
            elif level > 0:
                quarter = True
            elif not quarter:
                square = Square(x, y, side, step, span, reach, aim, bound, crossing, crossings)
                miss, lost = cut_square(square, ground, scratch, part)
                quarter = felt(miss, work) > 10.0 * aim and side > SMALLEST_CUT * cell
        if quarter and side > SMALLEST * cell and top + 4 <= blocks.shape[0]:
            top = push_quarters(x, y, side, level, blocks, top)
            continue
        error += miss
        unseen += bound if quarter else lost
        sign = 1.0 if kind == MARBLE else block_sign(x - low_x, y - low_y, side, view.floor)
        for t in range(9):
            out[t] += sign * part[t]
    return error, unseen


@jitable
def split_grid(
    tol: float, own: int, lobe: Array, view: View, s: SplitWork, most: int, value: Array
) -> tuple[float, float]:  # fmt: skip
    """Add the checker's deviation from its mean albedo to ``value``.

    Returns (error estimate, what of it no node was asked of). ``work`` holds the floor chart of the point. ``value``
    (3,) is in units of half the contrast times kd.
    """
    work, conics, states, stack, remainders = s.work, s.conics, s.states, s.grid_stack, s.remainders
    ground = Ground(lobe, view, work, conics, s.gauss, states)
    chart = work.chart
    cell = view.floor.cell
    jumps = floor_conics(own, lobe, view, work, conics)
    count = touch_conics(jumps, view, work, conics, view.cones)
    if count > conics.shape[0]:
        return math.inf, math.inf
    whole, reach, far, east, north, beyond = grid_reach(FIRST_REACH, lobe, view, work)
    if moves(reach):
        note_parted_lines(conics, count, view, work)
    px, py = chart.point[0] - view.floor.offset[0], chart.point[1] - view.floor.offset[1]
    across, down = floor_phases(px + east, py + north, cell, 0.0, 0.0)
    ci, cj = math.floor(across), math.floor(down)
    out, best = stack[stack.shape[0] - 1], stack[stack.shape[0] - 2]
    aim, found, dark = tol / LEAVES, math.inf, 0.0
    places = stack[:8]
    for _ in range(8):
        level = block_level(far / cell)
        first = 2.0 ** (level - 1)
        error, unseen = grid_once(
            aim, reach, (ci - first) * cell - px, (cj - first) * cell - py, level, ground, count,
            stack[: stack.shape[0] - 2], out,
        )  # fmt: skip
        change, tail = 0.0, 0.0
        if not whole:
            change = taper_change(out)
            tail = tail_of_squares(
                remainders,
                remainders_of(tol, reach, lobe, view, work, conics, count, states, places, remainders),
                px,
                py,
            )
        out_of_budget = 4 * max(work.counts.evaluations, work.counts.labour) > most
        if out_of_budget and felt(change, work) > 0.3 * tol:
            # two tapers that still disagree tell less, and there is no third one
            change *= 4.0
        change += tail
        if felt(error + change, work) < felt(found, work):
            found, dark = error + change, unseen
            for t in range(3):
                best[t] = out[t]
        if felt(error + change, work) + held(beyond) <= tol or out_of_budget:
            break
        if felt(change, work) > 0.3 * tol and reach < MOST_REACH * cell:
            reach = far = min(2.0 * reach, MOST_SQUARES * cell)
        elif felt(error, work) > 0.7 * tol:
            aim *= max(0.05, 0.4 * tol / felt(error, work))
        else:
            break
    # the sign of the lowest square of all; marble has its own
    kind = view.floor.kind
    sign = 1.0 if kind == MARBLE or (ci + (0 if kind == STRIPES else cj)) % 2 == 0 else -1.0
    for t in range(3):
        value[t] += sign * best[t]
    return found + left_out(beyond, work), dark + held(beyond)
