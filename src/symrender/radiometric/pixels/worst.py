"""The mean over a pixel, or over all that a place sees, worst cell first: where cells may be more than can be paid.

Where a bump has more waves than a budget follows, cells in the order of their places leave all to the last ones. Here
whatever is not resolved is known at once as what it may be off by at most, and the cell that may be off by most is
quartered next, until all of them together are within the tolerance.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.radiometric.pixels.cells import BOX, Cell, Eye, Lobe, cell_at
from symrender.radiometric.pixels.highlights import hidden_light
from symrender.radiometric.pixels.lobes import window_of
from symrender.radiometric.pixels.pixel import begin, coarse_cell, known_walls, one_cell
from symrender.radiometric.pixels.records import WINDOWS, Ints, Queue, Room
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.textures import put_lines
from symrender.radiometric.vectors import Vector

_SHARE: Final = 0.8
"""Part of the tolerance that cells are asked for as they are large, each window its part."""
_STRICTER: Final = 0.2
_RUNS: Final = 3
_PART: Final = 0.0003
"""Part of the tolerance that any cell may take: of what waits all is known that a rule says of it."""


@jitable
def swap(queue: Queue, a: int, b: int) -> None:
    """Exchange two entries."""
    for c in range(queue.numbers.shape[1]):
        queue.numbers[a, c], queue.numbers[b, c] = queue.numbers[b, c], queue.numbers[a, c]
    for c in range(queue.names.shape[1]):
        queue.names[a, c], queue.names[b, c] = queue.names[b, c], queue.names[a, c]


@jitable
def put_last(queue: Queue) -> None:
    """Let the entry behind the last one into the queue: a heap whose first has the largest error."""
    k = int(queue.waiting[0])
    queue.waiting[0] = k + 1
    while k > 0 and queue.numbers[(k - 1) // 2, 6] < queue.numbers[k, 6]:
        swap(queue, (k - 1) // 2, k)
        k = (k - 1) // 2


@jitable
def take_first(queue: Queue) -> int:
    """Move the first entry behind the last one, where it is no part of the queue any more; returns where it is."""
    last = int(queue.waiting[0]) - 1
    queue.waiting[0] = last
    swap(queue, 0, last)
    k = 0
    while 2 * k + 1 < last:
        child = 2 * k + 1
        if child + 1 < last and queue.numbers[child + 1, 6] > queue.numbers[child, 6]:
            child += 1
        if queue.numbers[child, 6] <= queue.numbers[k, 6]:
            break
        swap(queue, k, child)
        k = child
    return last


@jitable
def attend(
    eye: Eye, whole: Cell, queue: Queue, room: Room, candidates: Ints, count: int, face: int, level: int, path: int,
    tol: float, budget: int,
) -> None:  # fmt: skip
    """Add a cell of a window to ``room.best``, or to the queue if it is to be quartered and there is room."""
    total, rest = room.total, path
    for k in range(level, 0, -1):
        room.path[k] = rest % 4
        rest //= 4
    for c in range(7):
        total[c] = 0.0
    at = cell_at(whole, room, level, tol)
    allowed = tol * (0.5 * at.area + _PART)
    cell = Cell(at.v, at.vx, at.vy, level, at.area, allowed, at.x, at.y, at.half)
    limit = put_reach(eye, cell, room)
    fits = begin(eye, cell, room, candidates, count, limit)
    if room.trial is not None:
        room.trial[6] = math.inf
    done = one_cell(eye, cell, room, limit, fits, budget)
    k = int(queue.waiting[0])
    if not done:
        many = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit) < 0
        coarse_cell(eye, cell, room, limit, many, hidden_light(eye, cell, room, limit))
        if room.trial is not None and room.trial[6] < total[6]:
            for c in range(7):
                total[c] = room.trial[c]
        if k + 4 < queue.numbers.shape[0]:
            for c in range(7):
                queue.numbers[k, c] = total[c]
            queue.names[k, 0], queue.names[k, 1], queue.names[k, 2] = face, level, path
            queue.off[0] += total[6]
            put_last(queue)
            return
    for c in range(7):
        room.best[c] += total[c]


@jitable
def retract(queue: Queue) -> int:
    """Take the worst cell out of the queue; returns where its entry is."""
    k = take_first(queue)
    queue.off[0] -= queue.numbers[k, 6]
    return k


@jitable
def goes_on(queue: Queue, room: Room, tol: float, budget: int) -> bool:
    """Whether a cell is to be quartered."""
    return bool(queue.waiting[0] > 0 and room.best[6] + queue.off[0] > tol and room.total[7] < budget)


@jitable
def add_waiting(queue: Queue, room: Room) -> None:
    """Add the cells that wait to the mean."""
    for k in range(int(queue.waiting[0])):
        for c in range(7):
            room.best[c] += queue.numbers[k, c]


@jitable
def clear_mean(queue: Queue, room: Room) -> None:
    """Begin a mean."""
    queue.waiting[0], queue.off[0] = 0, 0.0
    for c in range(7):
        room.best[c] = 0.0
    for c in range(3):
        room.span[0, c], room.span[1, c] = math.inf, -math.inf


@jitable
def worst_mean(
    eye: Eye, whole: Cell, queue: Queue, room: Room, candidates: Ints, count: int, tol: float, budget: int
) -> float:  # fmt: skip
    """Leave the mean of a pixel in ``room.best``, to ``tol`` if the budget lasts; returns the evaluations."""
    share = _SHARE
    room.total[7] = 0.0
    for _ in range(_RUNS):
        clear_mean(queue, room)
        attend(eye, whole, queue, room, candidates, count, 0, 0, 0, share * tol, budget)
        while goes_on(queue, room, tol, budget):
            k = retract(queue)
            level, path = int(queue.names[k, 1]), int(queue.names[k, 2])
            for quarter in range(4):
                name = 4 * path + quarter
                attend(eye, whole, queue, room, candidates, count, 0, level + 1, name, share * tol, budget)
        add_waiting(queue, room)
        if room.best[6] <= tol or room.total[7] >= budget or queue.waiting[0] > 0:
            break
        share *= _STRICTER
    return float(room.total[7])


@jitable
def window_eye(eye: Eye, face: int, facing: Vector, first: Vector, second: Vector, lobe: Lobe) -> tuple[Eye, Cell]:
    """The eye that a place is in one of its windows, and the window."""
    v, vx, vy, area = window_of(face, facing, first, second)
    seen = Lobe(lobe.own, lobe.sight, lobe.facing, lobe.turned, lobe.view, lobe.albedo, area)
    return (
        Eye(eye.world, eye.mean, eye.place, eye.walls, eye.families, 0.0, True, BOX, None, None, seen, False),
        Cell(v, vx, vy, 0, 1.0, 0.0, 0.0, 0.0, 1.0),
    )  # fmt: skip


@jitable
def worst_sum(
    eye: Eye, lobe: Lobe, first: Vector, second: Vector, known: int, queue: Queue, room: Room, tol: float, budget: int
) -> float:  # fmt: skip
    """Leave what a place reflects of the light that shapes send it in ``room.best``; returns the evaluations.

    The windows' sides go along two unit directions across the normal; of the walls the first ``known`` are listed.
    """
    share = _SHARE / WINDOWS
    room.total[7] = 0.0
    for face in range(WINDOWS):
        seen, whole = window_eye(eye, face, lobe.facing, first, second, lobe)
        queue.listed[face] = known_walls(seen, whole, room, queue.candidates[face], known)
    for _ in range(_RUNS):
        clear_mean(queue, room)
        for face in range(WINDOWS):
            seen, whole = window_eye(eye, face, lobe.facing, first, second, lobe)
            count = int(queue.listed[face])
            attend(seen, whole, queue, room, queue.candidates[face], count, face, 0, 0, share * tol, budget)
        while goes_on(queue, room, tol, budget):
            k = retract(queue)
            face, level, path = int(queue.names[k, 0]), int(queue.names[k, 1]), int(queue.names[k, 2])
            seen, whole = window_eye(eye, face, lobe.facing, first, second, lobe)
            count = int(queue.listed[face])
            for quarter in range(4):
                name, listed = 4 * path + quarter, queue.candidates[face]
                attend(seen, whole, queue, room, listed, count, face, level + 1, name, share * tol, budget)
        add_waiting(queue, room)
        if room.best[6] <= tol or room.total[7] >= budget or queue.waiting[0] > 0:
            break
        share *= _STRICTER
    return float(room.total[7])
