"""What derivatives of pixels are summed from: nodes and walls of the parts of their means."""

from __future__ import annotations

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.radiometric.pixels.cells import BLOCK, Cell, Eye, block_of, cell_at, heaviest
from symrender.radiometric.pixels.moving import UNRESOLVED, Sweep, put_edge, sweep_lines, sweep_smooth
from symrender.radiometric.pixels.parts import put_path, whole_of
from symrender.radiometric.pixels.pixel import begin, block_walls
from symrender.radiometric.pixels.records import CUT, SMOOTH, Ints, Part, Room
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.textures import put_lines
from symrender.radiometric.vectors import Array


@jitable
def sweep_coarse(eye: Eye, cell: Cell, room: Room, sweep: Sweep, own: int, lines: int) -> None:
    """Add the walls of a cell of which nothing is known, along both of its sides; its weight is the largest."""
    for curve in range(own + lines):
        for across in range(2):
            tx, ty = (cell.half, 0.0) if across == 0 else (0.0, cell.half)
            k = put_edge(eye, room, sweep, cell.level, own, curve, cell.x, cell.y, tx, ty, 0.0, UNRESOLVED)
            if k >= 0:
                sweep.edges[k, 4] = heaviest(eye.domain, cell)


@inlined
def same(part: Part, other: Part) -> bool:
    """Whether two parts are one."""
    return (
        part.column == other.column and part.row == other.row and part.level == other.level and part.path == other.path
    )


def sweep_parts(
    eye: Eye, window: Array, width: int, height: int, reach: float, parts: Table[Part], orders: Ints, room: Room,
    candidates: Ints, sweep: Sweep, ends: Ints,
) -> None:  # fmt: skip
    """List nodes and edges of a rule of an order for each of some parts (``parts.py``).

    Those of part n end before ``ends[n, 0]`` and ``ends[n, 1]``; ``ends[n, 2]`` is 1 where walls are not known, and
    then nothing is. Of a part that is not resolved the walls are listed alone. Many arguments because a kernel's are.
    """
    sweep.counts[0], sweep.counts[1], sweep.counts[2] = 0, 0, 0
    left, top, count, held, known = -1, -1, 0, 0, False
    for n in range(parts.shape[0]):
        part, order = parts[n], int(orders[n])
        i, j, level = int(part.column), int(part.row), int(part.level)
        whole = whole_of(window, width, height, reach, i, j)
        put_path(room, level, int(part.path))
        cell = cell_at(whole, room, level, 0.0)
        ends[n, 2] = 0
        if part.kind == SMOOTH:
            # lines that are too many to be cut at sweep as much as a few do: no mean of the texture tells
            ends[n, 2] = 0 if part.fields == 0.0 else 1
            if part.fields == 0.0:
                sweep_smooth(eye, cell, sweep, order)
            known = False
        else:
            if i // BLOCK != left or j // BLOCK != top:
                left, top = i // BLOCK, j // BLOCK
                count = block_walls(eye, block_of(window, width, height, reach, left, top, 0.0), room, candidates)
            if n == 0 or not (known and same(part, parts[n - 1])):
                limit = put_reach(eye, cell, room)
                known = begin(eye, cell, room, candidates, count, limit)
                held = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
            own = int(room.counts[level])
            if not known or held < 0:
                ends[n, 2] = 1
            elif part.kind == CUT:
                ends[n, 2] = 0 if sweep_lines(eye, cell, room, sweep, order, own, held) else 1
            else:
                sweep_smooth(eye, cell, sweep, order)
                sweep_coarse(eye, cell, room, sweep, own, held)
        ends[n, 0], ends[n, 1] = sweep.counts[0], sweep.counts[1]
