"""The kernel of an image of means over pixels, block by block."""

from __future__ import annotations

from symrender.radiometric.pixels.cells import BLOCK, Eye, block_of, window_cell
from symrender.radiometric.pixels.pixel import block_walls, stated_mean
from symrender.radiometric.pixels.records import Ints, Queue, Room
from symrender.radiometric.pixels.worst import worst_mean
from symrender.radiometric.vectors import Array


def fill_pixels(
    eye: Eye, window: Array, width: int, height: int, reach: float, x0: int, y0: int, x1: int, y1: int, room: Room,
    candidates: Ints, queue: Queue | None, tol: float, budget: int, emitted: Array, direct: Array, error: Array,
) -> int:  # fmt: skip
    """Fill the means of columns x0:x1 of rows y0:y1; returns the evaluations. Many arguments because a kernel's are.

    The support of a pixel's filter reaches ``reach`` pixels from its middle to every side. Blocks lie
    at multiples of ``BLOCK`` of the image, so that no tile changes a byte.
    """
    spent = 0.0
    for top in range(y0 - y0 % BLOCK, y1, BLOCK):
        for left in range(x0 - x0 % BLOCK, x1, BLOCK):
            beyond = reach - 0.5
            block = block_of(window, width, height, reach, left // BLOCK, top // BLOCK, tol)
            count = block_walls(eye, block, room, candidates)
            for j in range(max(top, y0), min(top + BLOCK, y1)):
                for i in range(max(left, x0), min(left + BLOCK, x1)):
                    whole = window_cell(
                        window, width, height, i - beyond, j - beyond, i + 1 + beyond, j + 1 + beyond, tol
                    )
                    if queue is not None:
                        spent += worst_mean(eye, whole, queue, room, candidates, count, tol, budget)
                    else:
                        spent += stated_mean(eye, whole, room, candidates, count, tol, budget)
                    error[j - y0, i - x0] = room.best[6]
                    for c in range(3):
                        emitted[j - y0, i - x0, c] = room.best[c]
                        direct[j - y0, i - x0, c] = room.best[3 + c]
    return int(spent)
