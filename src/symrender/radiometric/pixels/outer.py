"""Means over time, and over both pixel and lens: an outer rule over means that are cut at their walls already.

What an inner mean does is a continuous function of the outer places: where the inner domain is wider than the outer
nodes are apart, on the same surface, nothing passes between two nodes unseen. So outer boxes are no larger than that to
begin with, and then halved until rules agree; what the inner means state is added. Where walls that enter the inner
domain differ between nodes of a box its rules are trusted less. Only a single ray over time jumps: its events are found
first.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.radiometric.direct import along_ray
from symrender.radiometric.pixels.cells import Cell, ray_of, weight_of, window_cell
from symrender.radiometric.pixels.exposed import (
    LENS,
    Box,
    Exposed,
    Waiting,
    lens_at,
    pixel_at,
    plan,
)
from symrender.radiometric.pixels.instants import place_at, put_events, put_instant
from symrender.radiometric.pixels.records import Ints, Room
from symrender.radiometric.pixels.rules import GAUSS
from symrender.radiometric.vectors import Array, vector


def _closed() -> Array:
    """(2, n, n): nodes and weights on [0, 1] of the middle, and of Lobatto's rules, which have nodes at both ends."""
    found = np.zeros((2, 6, 6))
    found[0, 1, 0], found[1, 1, 0] = 0.5, 1.0
    for n in range(2, 6):
        last = np.polynomial.legendre.Legendre.basis(n - 1)
        x = np.concatenate([[-1.0], np.sort(last.deriv().roots().real), [1.0]])
        found[0, n, :n], found[1, n, :n] = 0.5 * (x + 1.0), 1.0 / (n * (n - 1) * last(x) ** 2)
    return found


CLOSED: Final = _closed()
BOXES: Final = 2048
"""Most boxes of a pixel."""
_FEW: Final = 2
"""Parts of an axis where those that are due are too many."""
_PART: Final = 0.002
"""Part of the tolerance that any box may take before a rule of a higher order is tried."""
_NODES: Final = 27
_INNER: Final = 0.2
"""Part of the tolerance that inner means take."""
_SHARE: Final = 8
"""Inner means that the budget is to last for, at least."""
_LEAST: Final = 2000
"""Evaluations of an inner mean, at least."""
_DOUBT: Final = 0.02
_HOPE: Final = 1000.0
"""Times what a box may take that a rule of 3 nodes an axis may miss for one of more to be tried."""
_FIRST: Final = 4.0
"""What the difference of two rules is taken times."""
_PARTED: Final = 0.5
"""Part of the difference before that it is trusted to fall by, at most, where nodes have different walls: the mean has
a kink there, and two rules may agree by chance."""


@inlined
def axis_nodes(box: Box, axis: int, order: int) -> int:
    """Nodes along an axis of a box: one where it has no extent."""
    return order if box.high[axis] > box.low[axis] else 1


@jitable
def size_of(box: Box) -> float:
    """The share of all that a box is."""
    size = 1.0
    for k in range(3):
        if box.high[k] > box.low[k]:
            size *= box.high[k] - box.low[k]
    return size


@jitable
def box_rule(
    ex: Exposed, inner: int, i: int, j: int, box: Box, order: int, row: int, room: Room, candidates: Ints,
    waiting: Waiting, tol: float, budget: int,
) -> tuple[float, float, bool]:  # fmt: skip
    """(what inner means state, evaluations, whether all nodes have the same walls) of a box; its light to ``sums``."""
    stated, spent, first, same = 0.0, 0.0, -1, True
    sums = waiting.sums
    for c in range(6):
        sums[row, c] = 0.0
    low, high = vector(box.low), vector(box.high)
    n0, n1, n2 = axis_nodes(box, 0, order), axis_nodes(box, 1, order), axis_nodes(box, 2, order)
    share = size_of(box)
    for a in range(n0):
        t = low[0] + (high[0] - low[0]) * CLOSED[0, n0, a]
        if ex.moves:
            put_instant(ex.still, ex.motion, t, ex.eye.world, ex.eye.mean)
        for b in range(n1):
            y = low[1] + (high[1] - low[1]) * CLOSED[0, n1, b]
            for d in range(n2):
                z = low[2] + (high[2] - low[2]) * CLOSED[0, n2, d]
                weight = share * CLOSED[1, n0, a] * CLOSED[1, n1, b] * CLOSED[1, n2, d]
                if inner == LENS:
                    if n1 > 1 or (order == 1 and high[1] > low[1]):
                        weight *= 1.0 * weight_of(ex.filter, 2.0 * y - 1.0, 2.0 * z - 1.0)
                    used, mark = lens_at(ex, i, j, 2.0 * y - 1.0, 2.0 * z - 1.0, t, room, candidates, tol, budget)
                else:
                    turn, radius = 2.0 * math.pi * z, y
                    if n1 > 1 or (order == 1 and high[1] > low[1]):
                        weight *= 2.0 * radius
                    x1, x2 = radius * math.cos(turn), radius * math.sin(turn)
                    used, mark = pixel_at(ex, i, j, x1, x2, t, room, candidates, tol, budget)
                spent += used
                whole, best = 0.0, room.best
                for c in range(6):
                    sums[row, c] += weight * best[c]
                    whole += best[c]
                stated += abs(weight) * best[6]
                for c in range(3):
                    waiting.span[0] = min(waiting.span[0], room.span[0, c])
                    waiting.span[1] = max(waiting.span[1], room.span[1, c])
                k = (a * n1 + b) * n2 + d
                if k < _NODES:
                    waiting.light[k] = whole
                same = same and (first < 0 or mark == first)
                first = mark
    return stated, spent, same


@jitable
def differ(waiting: Waiting, first: int, second: int) -> float:
    """Largest difference of radiance between two rules."""
    most, sums = 0.0, waiting.sums
    for c in range(3):
        most = max(most, abs(sums[first, c] + sums[first, 3 + c] - sums[second, c] - sums[second, 3 + c]))
    return most


@jitable
def most_bent(box: Box, waiting: Waiting) -> int:
    """The axis along which light bends most between the 3 nodes of an axis."""
    n0, n1, n2 = axis_nodes(box, 0, 3), axis_nodes(box, 1, 3), axis_nodes(box, 2, 3)
    best, most, light = 0, -1.0, waiting.light
    for axis in range(3):
        n = n0 if axis == 0 else (n1 if axis == 1 else n2)
        if n == 1:
            continue
        stride = n1 * n2 if axis == 0 else (n2 if axis == 1 else 1)
        bent = 0.0
        for k in range(n0 * n1 * n2):
            if (k // stride) % 3 == 0:
                f, g, h = light[k], light[k + stride], light[k + 2 * stride]
                bent += abs(f - 2.0 * g + h) + 0.1 * abs(h - f)
        if bent > most:
            best, most = axis, bent
    return best


@jitable
def begin_boxes(waiting: Waiting, dims: tuple[int, int, int]) -> int:
    """Write the first boxes, so many along every axis, 0 where it has no extent; returns how many."""
    count = 0
    for a in range(max(1, dims[0])):
        for b in range(max(1, dims[1])):
            for d in range(max(1, dims[2])):
                box = waiting.boxes[count]
                for axis in range(3):
                    k = a if axis == 0 else (b if axis == 1 else d)
                    parts = dims[0] if axis == 0 else (dims[1] if axis == 1 else dims[2])
                    # the middle of pixel and lens, and the opening of the shutter
                    still = 0.0 if axis == 0 else 0.5
                    box.low[axis] = k / parts if parts > 0 else still
                    box.high[axis] = (k + 1) / parts if parts > 0 else still
                count += 1
    return count


@jitable
def look_at_box(
    ex: Exposed, inner: int, i: int, j: int, box: Box, room: Room, candidates: Ints, waiting: Waiting, tol: float,
    budget: int,
) -> float:  # fmt: skip
    """Write light, error and the axis to halve of a box, inner means of ``budget`` each; returns the evaluations."""
    inside, rest = _INNER * tol, max(_LEAST, budget)
    _, used, _ = box_rule(ex, inner, i, j, box, 1, 0, room, candidates, waiting, inside, rest)
    _, more, first = box_rule(ex, inner, i, j, box, 2, 1, room, candidates, waiting, inside, rest)
    stated, most, second = box_rule(ex, inner, i, j, box, 3, 2, room, candidates, waiting, inside, rest)
    row, doubt = 2, _DOUBT if first and second else _PARTED
    before, error = differ(waiting, 0, 1), differ(waiting, 1, 2)
    error = max(_FIRST * error, doubt * before)
    box.axis = most_bent(box, waiting)
    spent, allowed = used + more + most, tol * (0.5 * size_of(box) + _PART)
    whole = axis_nodes(box, 0, 2) * axis_nodes(box, 1, 2) * axis_nodes(box, 2, 2) == 8
    if allowed < error < _HOPE * allowed:
        last, order = differ(waiting, 1, 2), 4 if whole else 5
        stated, used, third = box_rule(ex, inner, i, j, box, order, 0, room, candidates, waiting, inside, rest)
        spent += used
        row, doubt = 0, doubt if third else _PARTED
        error = max(_FIRST * differ(waiting, 0, 2), doubt * last)
    box.error, box.inside = error, stated
    for c in range(6):
        box.light[c] = waiting.sums[row, c]
    return spent


@inlined
def swing(ex: Exposed, waiting: Waiting) -> float:
    """What radiance may differ by where nothing has looked."""
    return float(max(ex.eye.bright, waiting.span[1] - waiting.span[0]))


@jitable
def over_boxes(
    ex: Exposed, inner: int, i: int, j: int, dims: tuple[int, int, int], room: Room, candidates: Ints,
    waiting: Waiting, tol: float, budget: int,
) -> float:  # fmt: skip
    """Leave the mean over all boxes in ``waiting.best``: that of the largest error is halved while they state too much.

    Returns the evaluations.
    """
    best, boxes, spent = waiting.best, waiting.boxes, 0.0
    waiting.span[0], waiting.span[1] = math.inf, -math.inf
    count = begin_boxes(waiting, dims)
    for k in range(count):
        # all of it is looked at, if at the end a little
        rest = budget // _SHARE if spent <= budget else 0
        spent += look_at_box(ex, inner, i, j, boxes[k], room, candidates, waiting, tol, rest)
    while True:
        for c in range(7):
            best[c] = 0.0
        worst, outside = 0, 0.0
        for k in range(count):
            for c in range(6):
                best[c] += boxes[k].light[c]
            best[6] += boxes[k].error + boxes[k].inside
            outside += boxes[k].error
            if boxes[k].error > boxes[worst].error:
                worst = k
        # what inner means state is no less in halves
        stuck = best[6] - outside > max(tol, outside)
        if best[6] <= tol or stuck or count >= BOXES or spent > budget:
            return spent
        one, other, axis = boxes[worst], boxes[count], int(boxes[worst].axis)
        for k in range(3):
            other.low[k], other.high[k] = one.low[k], one.high[k]
        one.high[axis] = 0.5 * (one.low[axis] + one.high[axis])
        other.low[axis] = one.high[axis]
        count += 1
        spent += look_at_box(ex, inner, i, j, one, room, candidates, waiting, tol, budget // _SHARE)
        spent += look_at_box(ex, inner, i, j, other, room, candidates, waiting, tol, budget // _SHARE)


@jitable
def exposed_mean(
    ex: Exposed, i: int, j: int, pixels: bool, room: Room, candidates: Ints, waiting: Waiting, tol: float, budget: int
) -> float:  # fmt: skip
    """Leave the mean of a pixel over time, lens and, if ``pixels``, its own area in ``waiting.best``.

    Returns the evaluations.
    """
    inner, seconds, across, turns, enough = plan(ex, i, j, pixels, room)
    enough = enough and max(1, seconds) * max(1, across) * max(1, turns) <= BOXES // 2
    if not enough:
        seconds, across, turns = min(seconds, _FEW), min(across, _FEW), min(turns, _FEW)
    best = waiting.best
    spent = over_boxes(ex, inner, i, j, (seconds, across, turns), room, candidates, waiting, tol, budget)
    if not enough:
        best[6] += swing(ex, waiting)
    return spent


@jitable
def stretch_rule(
    ex: Exposed, cell: Cell, start: float, stop: float, order: int, row: int, room: Room, waiting: Waiting
) -> None:  # fmt: skip
    """Integrate the light of a ray over a stretch of time."""
    sums, span = waiting.sums, waiting.span
    for c in range(6):
        sums[row, c] = 0.0
    for k in range(order):
        t = start + (stop - start) * GAUSS[0, order, k]
        put_instant(ex.still, ex.motion, t, ex.eye.world, ex.eye.mean)
        _, d = ray_of(ex.eye, cell.v)
        _, emitted, direct = along_ray(ex.eye.world, place_at(ex.eye.place, ex.motion, t), d, room.sky)
        weight = (stop - start) * GAUSS[1, order, k]
        for c in range(3):
            sums[row, c] += weight * emitted[c]
            sums[row, 3 + c] += weight * direct[c]
            span[0], span[1] = min(span[0], emitted[c] + direct[c]), max(span[1], emitted[c] + direct[c])


@jitable
def ray_over_time(ex: Exposed, i: int, j: int, room: Room, waiting: Waiting, tol: float, budget: int) -> float:
    """Leave the mean over time of a pixel's centre in ``waiting.best``; returns the evaluations.

    Stretches between events are halved until rules agree; radiance beside a silhouette goes as a root of time.
    """
    best, sums, spent = waiting.best, waiting.sums, 0.0
    for c in range(7):
        best[c] = 0.0
    waiting.span[0], waiting.span[1] = math.inf, -math.inf
    cell = window_cell(ex.lens.window, ex.width, ex.height, i + 0.5, j + 0.5, i + 0.5, j + 0.5, tol)
    count = put_events(ex.still, ex.motion, ex.eye, cell.v, room, waiting.watch)
    unknown = count == 0
    if unknown:
        waiting.watch.panels[0], waiting.watch.panels[1], count = 0.0, 1.0, 1
    for panel in range(count):
        start, end = waiting.watch.panels[panel], waiting.watch.panels[panel + 1]
        stop = end
        while start < end:
            allowed = tol * (0.7 * (stop - start) + 0.03 / count)
            for k in range(3):
                stretch_rule(ex, cell, start, stop, k + 1 if k < 2 else 4, k, room, waiting)
            before, error = differ(waiting, 0, 1), differ(waiting, 1, 2)
            error, row = max(error, _DOUBT * before), 2
            spent += 7.0
            if error > allowed and error < 100.0 * allowed:
                last = differ(waiting, 1, 2)
                stretch_rule(ex, cell, start, stop, 8, 0, room, waiting)
                spent += 8.0
                error, row = max(differ(waiting, 0, 2), _DOUBT * last), 0
            if error > allowed and spent < budget and stop - start > 1e-9:
                stop = 0.5 * (start + stop)
                continue
            for c in range(6):
                best[c] += sums[row, c]
            best[6] += error
            start, stop = stop, end
    if unknown:
        best[6] += swing(ex, waiting)
    return spent


def fill_exposed(
    ex: Exposed, pixels: bool, x0: int, y0: int, x1: int, y1: int, room: Room, candidates: Ints, waiting: Waiting,
    tol: float, budget: int, emitted: Array, direct: Array, error: Array,
) -> int:  # fmt: skip
    """Fill the means of columns x0:x1 of rows y0:y1, of the rays through centres unless ``pixels``.

    Returns the evaluations. Many arguments because a kernel's are.
    """
    spent = 0.0
    for j in range(y0, y1):
        for i in range(x0, x1):
            if pixels or ex.lens.aperture > 0.0:
                spent += exposed_mean(ex, i, j, pixels, room, candidates, waiting, tol, budget)
            else:
                spent += ray_over_time(ex, i, j, room, waiting, tol, budget)
            error[j - y0, i - x0] = waiting.best[6]
            for c in range(3):
                emitted[j - y0, i - x0, c] = waiting.best[c]
                direct[j - y0, i - x0, c] = waiting.best[3 + c]
    return int(spent)
