"""Squares of pixels that no curve enters: what they show is one polynomial, from fewer nodes than pixels need alone."""

from __future__ import annotations

from symrender.jit.marks import jitable
from symrender.radiometric.pixels.cells import Cell, Eye, window_cell
from symrender.radiometric.pixels.parts import followed
from symrender.radiometric.pixels.pixel import begin, block_walls
from symrender.radiometric.pixels.records import Ints, Room
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.textures import put_lines
from symrender.radiometric.vectors import Array


@jitable
def is_smooth(eye: Eye, cell: Cell, room: Room, candidates: Ints, steps: float) -> bool:
    """Whether no curve enters a cell and what nodes see turns no further in it than they follow."""
    count = block_walls(eye, cell, room, candidates)
    limit = put_reach(eye, cell, room)
    if not begin(eye, cell, room, candidates, count, limit) or room.counts[cell.level] != 0:
        return False
    if put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit) != 0:
        return False
    return followed(eye, cell, room, limit, steps)


def smooth_blocks(
    eye: Eye, window: Array, width: int, height: int, corners: Ints, side: int, steps: float, room: Room,
    candidates: Ints, found: Ints,
) -> None:  # fmt: skip
    """Write 1 for each square of ``side`` pixels, named by its column and row, that is smooth, else 0."""
    for n in range(corners.shape[0]):
        x, y = float(corners[n, 0]), float(corners[n, 1])
        cell = window_cell(window, width, height, x, y, x + side, y + side, 0.0)
        found[n] = 1 if is_smooth(eye, cell, room, candidates, steps) else 0
