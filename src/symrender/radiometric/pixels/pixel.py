"""The mean of radiance over a pixel: quarters of it, and of these, until what each states is small enough.

A cell that no curve enters is smooth and takes a tensor rule; one whose curves are monotone along lines of some
direction is integrated line by line; any other is halved, until its area times the span of radiance is small enough to
be stated as its error. So nothing rests on a list of events: a curve that is not proved to miss a cell, to be monotone
in it or to be too small to matter is looked at more closely. The file is long because every way to integrate a cell
states its errors by the same constants.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.radiometric.pixels.cells import (
    BOX,
    DISK,
    GAUSSIAN,
    Cell,
    Eye,
    cell_at,
    kinks,
    outside,
)
from symrender.radiometric.pixels.curves import BESIDE, SLACK, misses, put_curve, put_quarter
from symrender.radiometric.pixels.highlights import hidden_light
from symrender.radiometric.pixels.lobes import light_bound, lobe_bends, weight_bound
from symrender.radiometric.pixels.records import (
    LEVELS,
    MARKS,
    MOST_CUTS,
    ROOM,
    Ints,
    Room,
)
from symrender.radiometric.pixels.rules import clear, cut_rule, cutting_mode, gap, put_panels, round_rule, tensor_rule
from symrender.radiometric.pixels.sharp import too_sharp
from symrender.radiometric.pixels.sight import may_show, put_reach
from symrender.radiometric.pixels.textures import brightest, fields, mean_error, put_lines
from symrender.radiometric.pixels.turned import put_turned_wall, waves

_TEXTURE_LEVELS: Final = 5
"""Halvings towards a horizon at which a texture shrinks without end."""
_FIELD_COST: Final = 100.0
"""Evaluations a field takes, about."""
_RUNS: Final = 8
"""Most runs of a pixel."""
_FIRST: Final = 60_000
"""Evaluations of its first run, at least."""
_STRICTER: Final = 0.2
_LOOSER: Final = 32.0
_DOUBT: Final = 0.02
"""Part of the difference of the two rules before that the difference of two rules is trusted to fall by, at most."""
_CHANCE: Final = 0.1
"""Part of the difference between the first two rules that their successor is off by, at least: rules of so few nodes
agree by chance once in a few hundred cells."""
_HOPE: Final = 1000.0
"""Times what a cell may take that a rule of 5 x 5 nodes may miss for one of 8 x 8 to be tried: of a Gaussian, which no
polynomial of low degree is."""
_MISSED: Final = 0.5
"""Part of what a cell may take that nodes may miss for rules to be tried."""
_LITTLE: Final = 0.005
"""``_DOUBT`` of rules between walls, which are far apart in order."""


@jitable
def keep(eye: Eye, cell: Cell, room: Room, limit: float) -> bool:
    """Pass on the curves of the level above that may be seen in a cell; False where room runs out."""
    found, level, held = 0, cell.level, -1
    above, here = room.curves[level - 1], room.curves[level]
    for k in range(int(room.counts[level - 1])):
        wall = eye.walls[int(room.which[level - 1, k])]
        if not (may_show(room, wall.own, limit) and may_show(room, wall.other, limit)):
            continue
        turned, held = put_turned_wall(eye, cell, room, wall, held, here[found])
        if not turned:
            put_quarter(above[k], int(room.path[level]), here[found])
        if misses(here[found], SLACK):
            continue
        room.which[level, found] = room.which[level - 1, k]
        found += 1
    room.counts[level] = found
    return found < ROOM


@jitable
def begin(eye: Eye, cell: Cell, room: Room, candidates: Ints, count: int, limit: float) -> bool:
    """List the curves of a cell among candidate walls; False where there is no room for all."""
    found, level, held = 0, cell.level, -1
    for k in range(count):
        wall = eye.walls[int(candidates[k])]
        if not (may_show(room, wall.own, limit) and may_show(room, wall.other, limit)):
            continue
        if found == ROOM:
            return False
        turned, held = put_turned_wall(eye, cell, room, wall, held, room.curves[level, found])
        if not (turned or put_curve(wall, cell.v, cell.vx, cell.vy, room.work, room.curves[level, found])):
            continue
        if misses(room.curves[level, found], BESIDE):
            continue
        room.which[level, found] = candidates[k]
        found += 1
    room.counts[level] = found
    return True


@jitable
def take(room: Room, row: int, error: float) -> None:
    """Add a cell to the pixel: a row of sums and what it may be off by, to which that of its nodes is added."""
    for c in range(6):
        room.total[c] += room.sums[row, c]
    room.total[6] += error + room.sums[row, 6]
    room.total[8] += room.sums[row, 6]


@jitable
def note(room: Room, row: int, error: float) -> None:
    """Keep a row of sums as what is known of a cell that does not meet what it may take, if it is the best so far."""
    if room.trial is None:
        return
    if error + room.sums[row, 6] < room.trial[6]:
        for c in range(6):
            room.trial[c] = room.sums[row, c]
        room.trial[6] = error + room.sums[row, 6]


@inlined
def spread(eye: Eye, cell: Cell, room: Room, limit: float) -> float:
    """What radiance may differ by where nodes have not looked: as it was met to differ, or ``bright``.

    Of a lobe, and where there are bumps, it is no more than lights may cause in the cell.
    """
    if eye.lobe is not None:
        return light_bound(eye, cell, room, limit)
    span = room.span
    met = max(span[1, 0] - span[0, 0], max(span[1, 1] - span[0, 1], span[1, 2] - span[0, 2]))
    most = float(max(met, eye.bright))
    if room.models is None:
        return most
    return min(most, light_bound(eye, cell, room, limit))


@jitable
def smooth_cell(eye: Eye, cell: Cell, room: Room, missed: float) -> bool:
    """Integrate a cell without curves, of which nodes may miss so much; False where it is to be halved."""
    world = eye.world
    tensor_rule(eye, world, cell, 1, 0, room)
    tensor_rule(eye, world, cell, 2, 1, room)
    tensor_rule(eye, world, cell, 3, 2, room)
    before, error = gap(room, 0, 1), gap(room, 1, 2)
    error = max(error, _CHANCE * before) + missed
    if error <= cell.allowed:
        take(room, 2, error)
        return True
    note(room, 2, error)
    if room.trial is not None and error > _HOPE * cell.allowed:
        return False
    before = gap(room, 1, 2)
    tensor_rule(eye, world, cell, 5, 1, room)
    error = max(gap(room, 1, 2), _DOUBT * before) + missed
    if error <= cell.allowed:
        take(room, 1, error)
        return True
    note(room, 1, error)
    if eye.domain == GAUSSIAN and error <= _HOPE * cell.allowed:
        before = gap(room, 1, 2)
        tensor_rule(eye, world, cell, 8, 2, room)
        error = max(gap(room, 1, 2), _DOUBT * before) + missed
        if error <= cell.allowed:
            take(room, 2, error)
            return True
    return False


@jitable
def round_cell(eye: Eye, cell: Cell, room: Room, missed: float) -> bool:
    """Integrate a lens that its rim alone cuts, of which nodes may miss so much; False where it is to be halved."""
    before = math.inf
    round_rule(eye, cell, 2, 0, room)
    for trial in range(3):
        round_rule(eye, cell, 3 if trial == 0 else (5 if trial == 1 else 8), 1, room)
        error = gap(room, 0, 1)
        error = missed + (max(error, _DOUBT * before) if trial > 0 else 2.0 * error)
        if error <= cell.allowed:
            take(room, 1, error)
            return True
        before = gap(room, 0, 1)
        for c in range(6):
            room.sums[0, c] = room.sums[1, c]
    return False


@jitable
def cut_cell(
    eye: Eye, cell: Cell, room: Room, limit: float, own: int, lines: int, blurred: bool, beside: float, budget: int,
    hidden: float,
) -> bool:  # fmt: skip
    """Integrate a cell line by line, if its curves are monotone along some; False where it is to be halved.

    ``blurred`` takes textures of planes as their means, ``beside`` is what they may be off by over the brightest light.
    Of a radiance of ``hidden`` nodes may see nothing.
    """
    mode = cutting_mode(room, own, lines, cell.level)
    if mode < 0:
        return False
    count = own + lines
    for k in range(count):
        room.soft[k] = eye.walls[int(room.which[cell.level, k])].soft if k < own else 0.0
    panels, risk = put_panels(room, count, mode)
    heavy = weight_bound(eye, cell)
    # the cell's own area is 4, t and s cover half of it where x, y = t + s, t - s
    missed = cell.area * (risk * (0.25 if mode < 2 else 0.5) * spread(eye, cell, room, limit) + hidden) * heavy
    hopeless = missed > cell.allowed
    if panels == 0 or (hopeless and room.trial is None):
        return False
    world = eye.mean if blurred else eye.world
    cut_rule(eye, world, cell, 1, 1, count, mode, panels, room)
    cut_rule(eye, world, cell, 2, 0, count, mode, panels, room)
    before = gap(room, 0, 1)
    for trial in range(4):
        order = 3 if trial == 0 else (5 if trial == 1 else (8 if trial == 2 else 12))
        # drawn to the ends of panels where a piece beside a limb shrinks to nothing, from a third rule on
        way = mode if trial < 2 else mode + 4
        cut_rule(eye, world, cell, order, 1, count, way, panels, room)
        error = gap(room, 0, 1)
        # the first pair of rules is trusted less, and may agree by chance
        error = max(error, _LITTLE * before) if trial > 0 else max(8.0 * error, _CHANCE * before)
        whole = error + missed + cell.area * beside * 1.5 * brightest(room.span) * heavy
        if whole <= cell.allowed or (blurred and error + missed <= cell.allowed):
            take(room, 1, whole)
            return True
        note(room, 1, whole)
        if room.total[7] > budget:
            return False
        if room.trial is not None and (hopeless or error > _HOPE * cell.allowed):
            return False
        if error > (50.0 if trial == 1 else 300.0) * cell.allowed and trial > 0 and cell.level < 6:
            return False
        before = gap(room, 0, 1)
        for c in range(6):
            room.sums[0, c] = room.sums[1, c]
    return False


@jitable
def coarse_cell(eye: Eye, cell: Cell, room: Room, limit: float, blurred: bool, hidden: float) -> None:
    """Integrate a cell as if it were smooth and state its area times what radiance may differ by in it."""
    world = eye.mean if blurred else eye.world
    tensor_rule(eye, world, cell, 2, 0, room)
    swing = max(spread(eye, cell, room, limit), hidden) + (brightest(room.span) if blurred else 0.0)
    error = cell.area * swing * weight_bound(eye, cell)
    take(room, 0, error)


@jitable
def blurred_cell(eye: Eye, cell: Cell, room: Room, limit: float, ends: bool, budget: int, hidden: float) -> int:
    """Integrate a cell of many fields with its texture's mean: 1 where that is done, 0 to halve it, -1 to end there."""
    own = int(room.counts[cell.level])
    # a weight that changes along a line counts as a break more
    breaks = own if eye.domain == BOX else own + 1
    beside = mean_error(eye.families, cell.v, cell.vx, cell.vy, room, limit, breaks)
    held = fields(eye.families, cell.v, cell.vx, cell.vy, room, limit)
    hopeless = held * _FIELD_COST > budget - room.total[7]
    off = cell.area * beside * 1.5 * brightest(room.span) * weight_bound(eye, cell)
    if off <= cell.allowed or (hopeless and cell.level >= _TEXTURE_LEVELS) or ends:
        spent = room.total[7] > budget
        if not spent and cut_cell(eye, cell, room, limit, own, 0, True, beside, budget, hidden):
            return 1
        if spent or (hopeless and cell.level >= _TEXTURE_LEVELS + 4):
            return -1
    return 0


@jitable
def one_cell(eye: Eye, cell: Cell, room: Room, limit: float, fits: bool, budget: int) -> bool:
    """Integrate a cell, or say that it is to be halved."""
    if outside(eye.domain, cell):
        clear(room, 2)
        take(room, 2, 0.0)
        return True
    if cell.level < kinks(eye.domain):
        return False
    ends = cell.level >= LEVELS or room.total[7] > budget
    own = int(room.counts[cell.level])
    lines = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
    many = lines < 0
    hidden = hidden_light(eye, cell, room, limit)
    missed = cell.area * hidden * weight_bound(eye, cell) if hidden > 0.0 else 0.0
    sharp = missed > _MISSED * cell.allowed or too_sharp(eye, cell)
    if eye.lobe is not None:
        # of its light there is a bound, whatever nodes miss
        fits, sharp = fits and not sharp and not lobe_bends(eye, cell), False
    if room.models is not None:
        swing = cell.area * spread(eye, cell, room, limit) * weight_bound(eye, cell)
        fits = fits and not waves(eye, cell, room, room.models, limit, cell.allowed / max(swing, cell.allowed))
    if not ends and fits and not many and not sharp:
        if own + lines == 0:
            return smooth_cell(eye, cell, room, missed)
        if own + lines == 1 and cell.level == 0 and eye.domain == DISK and round_cell(eye, cell, room, missed):
            return True
        if own + lines <= MOST_CUTS and cut_cell(eye, cell, room, limit, own, lines, False, 0.0, budget, hidden):
            return True
    if many and fits and not sharp:
        done = blurred_cell(eye, cell, room, limit, ends, budget, hidden)
        if done > 0:
            return True
        ends = ends or done < 0
    swing = max(spread(eye, cell, room, limit), hidden) + (brightest(room.span) if many else 0.0)
    if ends or (not sharp and cell.area * swing * weight_bound(eye, cell) <= cell.allowed):
        coarse_cell(eye, cell, room, limit, many, hidden)
        return True
    return False


@jitable
def pixel_mean(eye: Eye, whole: Cell, room: Room, candidates: Ints, count: int, tol: float, budget: int) -> None:
    """Leave the mean of a pixel in ``room.total``, each cell to its part of ``tol``."""
    for c in range(9):
        room.total[c] = 0.0
    for c in range(3):
        room.span[0, c], room.span[1, c] = math.inf, -math.inf
    # every cell's first look at what radiance spans
    tensor_rule(eye, eye.world, whole, 3, 0, room)
    clear(room, 0)
    level = 0
    while level >= 0:
        cell = cell_at(whole, room, level, tol)
        limit = put_reach(eye, cell, room)
        if level == 0:
            fits = begin(eye, cell, room, candidates, count, limit)
        else:
            fits = keep(eye, cell, room, limit)
        if not one_cell(eye, cell, room, limit, fits, budget):
            level += 1
            room.path[level] = 0
            continue
        while level > 0 and room.path[level] == 3:
            level -= 1
        if level == 0:
            break
        room.path[level] += 1


@jitable
def known_walls(eye: Eye, block: Cell, room: Room, candidates: Ints, first: int) -> int:
    """List those of the ``first`` walls that may pass through a block of pixels; returns how many."""
    found, held, curve = 0, -1, room.work[7]
    for k in range(first):
        wall = eye.walls[k]
        known, held = put_turned_wall(eye, block, room, wall, held, curve)
        if (known or put_curve(wall, block.v, block.vx, block.vy, room.work, curve)) and not misses(curve, BESIDE):
            candidates[found] = k
            found += 1
    return found


@jitable
def block_walls(eye: Eye, block: Cell, room: Room, candidates: Ints) -> int:
    """List the walls that may pass through a block of pixels; returns how many."""
    return known_walls(eye, block, room, candidates, eye.walls.shape[0])


@jitable
def stated_mean(eye: Eye, whole: Cell, room: Room, candidates: Ints, count: int, tol: float, budget: int) -> float:
    """Leave the mean of a pixel in ``room.best``, to ``tol`` if the budget lasts; returns the evaluations.

    A run whose cells' errors add up to more is made again with less for each. Where its budget ends a run, looser
    ones are made until one ends by itself, then stricter ones while what they are to take is left.
    """
    best, share, spent, tightens, loose = room.best, 1.0, 0.0, False, False
    put_reach(eye, whole, room)
    held = fields(eye.families, whole.v, whole.vx, whole.vy, room, math.inf)
    # where fields are too many to be cut at, a first run need not find it out at length
    limit = budget // 4 if held * _FIELD_COST <= budget // 4 else min(budget // 8, max(_FIRST, budget // 64))
    best[6] = math.inf
    for _ in range(_RUNS):
        pixel_mean(eye, whole, room, candidates, count, share * tol, limit)
        used = room.total[7]
        spent += used
        if room.total[6] < best[6]:
            for c in range(7):
                best[c] = room.total[c]
        # no stricter run brings down what roundings do
        if best[6] <= tol or (used > limit and tightens) or spent >= budget or room.total[8] > tol:
            break
        if used > limit:
            loose = True
            share *= _LOOSER
        elif not loose:
            share *= _STRICTER
        else:
            # a stricter run takes about as many times more, where fields are what it is spent on
            limit, tightens = budget // 4, True
            if used * _LOOSER > limit:
                break
            share /= _LOOSER
        limit = min(limit, int(budget - spent))
    return spent


@jitable
def walls_in(eye: Eye, whole: Cell, room: Room) -> int:
    """A number that tells which walls and lines of textures enter the whole, after its mean was made."""
    found = 0
    for k in range(int(room.counts[0])):
        found = (found * 1009 + int(room.which[0, k]) + 1) % MARKS
    limit = put_reach(eye, whole, room)
    lines = put_lines(eye.families, whole.v, whole.vx, whole.vy, room, limit)
    for k in range(lines):
        found = (found * 1009 + 31 * int(room.numbers[k, 0]) + int(room.numbers[k, 1]) % 100003 + 1) % MARKS
    return found * 4 + (1 if lines < 0 else 2)
