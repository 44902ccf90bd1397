"""How the mean of a pixel moves: what its nodes see changes, and walls sweep over what they part.

d/dtheta of the integral along a line is the integral of the slope plus, at each wall, the difference of radiance on
both sides times how fast the wall crosses the line. Lines themselves stay where they are: where walls cross each other
or leave a cell the integral along a line is continuous, so that ends of panels add nothing. Radiance at a wall is
extrapolated from the nodes of the piece beside it, in the variable in which it is smooth there; which nodes these are
is all that is listed here, for what they see may be dear.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.radiometric.pixels.cells import Cell, Eye, weight_of
from symrender.radiometric.pixels.curves import put_level
from symrender.radiometric.pixels.records import Family, Ints, Room, Wall
from symrender.radiometric.pixels.rules import GAUSS, cutting_mode, half_width, in_order, locate, mapped, put_panels
from symrender.radiometric.vectors import Array, Vector, dot, vector

_THIN: Final = 1e-11
"""A piece between walls that coincide."""
_EDGE: Final = 2e-10
"""How near a wall is to the edge of a cell that is said to lie on it: near enough for ``begin`` to list it for the cell
on its other side too."""
_OUTSIDE: Final = 0.1
"""How far beside a cell a wall on its edge is looked at from, over the piece inside."""

# what a row of ``Sweep.edges`` is
PARTED: Final = 0
TWIN: Final = 1
"""A wall that coincides with the one of the row before, between the same pieces."""
BORDER: Final = 2
"""On the border of the pixel, where means have two derivatives: once more, for the half that these differ by."""
UNRESOLVED: Final = 3
"""Of a cell that is not resolved: two rows, for its two sides, with nothing on either."""


class Sweep(NamedTuple):
    """What a pixel's derivative is summed from: rows of each, and how many there are."""

    nodes: Array
    """(n, 3): place x, y in the pixel, and its weight."""
    edges: Array
    """(n, 6): place, direction in which t grows, what a unit of t weighs, PARTED or another kind."""
    walls: Ints
    """(n, 5): the wall of each edge, or -1 less the family, and the number, of a line of a texture; then the first node
    of the piece before, the first of the piece behind, and how many each has; one is -1 where there is no such piece.
    """
    counts: Ints
    """(3,): nodes, edges, and 1 where there was no room for all."""


@inlined
def place_of(mode: int, t: float, s: float) -> tuple[float, float]:
    """(x, y) of a place in a cell that is cut this way."""
    x = t if mode == 0 else (s if mode == 1 else t + s)
    y = s if mode == 0 else (t if mode == 1 else (t - s if mode == 2 else s - t))
    return x, y


@jitable
def put_node(sweep: Sweep, x: float, y: float, weight: float) -> None:
    """Add a node."""
    k = int(sweep.counts[0])
    if k >= sweep.nodes.shape[0]:
        sweep.counts[2] = 1
        return
    row = sweep.nodes[k]
    row[0], row[1], row[2] = x, y, weight
    sweep.counts[0] = k + 1


@jitable
def put_edge(
    eye: Eye, room: Room, sweep: Sweep, level: int, own: int, curve: int, x: float, y: float, tx: float, ty: float,
    weight: float, kind: int,
) -> int:  # fmt: skip
    """Add a wall that crosses a line; returns its row, in which what it parts is still to be written, -1 if none."""
    k = int(sweep.counts[1])
    if k >= sweep.edges.shape[0]:
        sweep.counts[2] = 1
        return -1
    row = sweep.edges[k]
    row[0], row[1], row[2], row[3] = x, y, tx, ty
    row[4] = weight * weight_of(eye.domain, x, y)
    row[5] = float(kind)
    if curve < own:
        sweep.walls[k, 0], sweep.walls[k, 1] = room.which[level, curve], 0
    else:
        sweep.walls[k, 0], sweep.walls[k, 1] = -1 - room.numbers[curve - own, 0], room.numbers[curve - own, 1]
    sweep.walls[k, 2], sweep.walls[k, 3], sweep.walls[k, 4] = -1, -1, 0
    sweep.counts[1] = k + 1
    return k


@jitable
def put_parted(
    eye: Eye, cell: Cell, room: Room, sweep: Sweep, weight: float, own: int, curve: int, mode: int, t: float, s: float,
    kind: int, before: int, behind: int, order: int,
) -> None:  # fmt: skip
    """Add a wall that crosses a line at t, between the pieces whose nodes begin at ``before`` and ``behind``; many
    arguments because a cell's cut has them."""
    half = cell.half
    x, y = place_of(mode, t, s)
    ox, oy = place_of(mode, 0.0, 0.0)
    dx, dy = place_of(mode, 1.0, 0.0)
    k = put_edge(
        eye, room, sweep, cell.level, own, curve, cell.x + half * x, cell.y + half * y, half * (dx - ox),
        half * (dy - oy), weight, kind,
    )  # fmt: skip
    if k >= 0:
        sweep.walls[k, 2], sweep.walls[k, 3], sweep.walls[k, 4] = before, behind, order


@jitable
def put_beside(
    eye: Eye, cell: Cell, room: Room, sweep: Sweep, weight: float, own: int, count: int, curve: int, mode: int,
    t: float, s: float, inner: int, order: int, length: float,
) -> None:  # fmt: skip
    """Add a wall on the end t of a line, where the piece inside has its nodes from ``inner`` on and is ``length`` long.

    Cells on both sides of it count a half. What lies beside the cell is looked at by nodes without weight; where that
    is beside the pixel the mean has two derivatives, and the wall is listed once more. Many arguments because a cell's
    cut has them.
    """
    half, outer = cell.half, int(sweep.counts[0])
    for i in range(order):
        u = GAUSS[0, order, i]
        beyond = _OUTSIDE * length * (u * u if t > 0.0 else -(1.0 - u) * (1.0 - u))
        x, y = place_of(mode, t + beyond, s)
        put_node(sweep, cell.x + half * x, cell.y + half * y, 0.0)
    before, behind = inner if t > 0.0 else outer, outer if t > 0.0 else inner
    put_parted(eye, cell, room, sweep, 0.5 * weight, own, curve, mode, t, s, PARTED, before, behind, order)
    for k in range(count):
        if k != curve and abs(room.places[1, k] - t) <= _EDGE:
            put_parted(eye, cell, room, sweep, 0.5 * weight, own, k, mode, t, s, TWIN, before, behind, order)
    x, y = place_of(mode, t, s)
    if max(abs(cell.x + half * x), abs(cell.y + half * y)) >= 1.0 - 1e-8:
        for k in range(count):
            if abs(room.places[1, k] - t) <= _EDGE:
                put_parted(eye, cell, room, sweep, 0.5 * weight, own, k, mode, t, s, BORDER, before, behind, order)


@jitable
def on_edges(room: Room, count: int, wide: float) -> tuple[int, int]:
    """The curves that lie on both ends of the line that was located, -1 where there is none; they do not cross it."""
    first, last = -1, -1
    for k in range(count):
        place = room.places[1, k]
        if abs(place + wide) <= _EDGE:
            first, room.states[1, k] = k, -1
        elif abs(place - wide) <= _EDGE:
            last, room.states[1, k] = k, 1
    return first, last


@jitable
def sweep_line(
    eye: Eye, cell: Cell, room: Room, sweep: Sweep, weight: float, order: int, own: int, count: int, mode: int,
    s: float,
) -> None:  # fmt: skip
    """Add the nodes of a line and the walls that cross it; many arguments because a cell's cut has them."""
    wide, half, cx, cy = half_width(mode, s), cell.half, cell.x, cell.y
    locate(room, count, mode, s, 1)
    wall, ending = on_edges(room, count, wide)
    found = in_order(room, count)
    hard, ends = (wall < 0 or room.soft[wall] == 0.0), (ending < 0 or room.soft[ending] == 0.0)
    start, at, before, length, group = -wide, -wide, -1, 0.0, 0
    for piece in range(found + 1):
        last = piece == found
        stop = wide if last else min(max(room.places[3, piece], start), wide)
        free = ends if last else room.soft[room.states[3, piece]] == 0.0
        if stop - start > _THIN:
            first = int(sweep.counts[0])
            for i in range(order):
                place, slope = mapped(GAUSS[0, order, i], not hard, not free)
                x, y = place_of(mode, start + (stop - start) * place, s)
                share = weight * (stop - start) * slope * GAUSS[1, order, i]
                share *= weight_of(eye.domain, cx + half * x, cy + half * y)
                put_node(sweep, cx + half * x, cy + half * y, share)
            if wall >= 0 and before >= 0:
                put_parted(eye, cell, room, sweep, weight, own, wall, mode, at, s, PARTED, before, first, order)
                for k in range(group + 1, piece):
                    twin = int(room.states[3, k])
                    put_parted(eye, cell, room, sweep, weight, own, twin, mode, at, s, TWIN, before, first, order)
            elif wall >= 0:
                put_beside(eye, cell, room, sweep, weight, own, count, wall, mode, -wide, s, first, order, stop - start)
            wall, before, length = -1, first, stop - start
        if not last and start >= -wide:
            if wall < 0:
                wall, at, group = int(room.states[3, piece]), room.places[3, piece], piece
            if stop - start > _THIN or piece == 0:
                hard = free
            else:
                hard = hard and free
        start = stop
    if ending >= 0 and before >= 0:
        put_beside(eye, cell, room, sweep, weight, own, count, ending, mode, wide, s, before, order, length)


@jitable
def sweep_lines(
    eye: Eye, cell: Cell, room: Room, sweep: Sweep, order: int, own: int, lines: int
) -> bool:  # fmt: skip
    """Add a cell that is integrated line by line, by a rule: ``own`` curves and ``lines`` of textures cut it.

    False where they are monotone along no lines, and then nothing is added.
    """
    count, soft = own + lines, False
    for k in range(count):
        room.soft[k] = eye.walls[int(room.which[cell.level, k])].soft if k < own else 0.0
        # slopes beside a limb are as one over a root: where its piece shrinks to nothing their sum is as a root
        soft = soft or room.soft[k] != 0.0
    mode = cutting_mode(room, own, lines, cell.level)
    if mode < 0:
        return False
    panels, _ = put_panels(room, count, mode)
    scale = cell.area * (0.25 if mode < 2 else 0.5)
    for panel in range(panels):
        start, stop = room.panels[panel], room.panels[panel + 1]
        for i in range(order):
            place, slope = mapped(GAUSS[0, order, i], soft, soft)
            weight = scale * (stop - start) * slope * GAUSS[1, order, i]
            s = start + (stop - start) * place
            sweep_line(eye, cell, room, sweep, weight, order, own, count, mode, s)
    return True


@jitable
def sweep_smooth(eye: Eye, cell: Cell, sweep: Sweep, order: int) -> None:
    """Add the nodes of a cell without walls, by a rule."""
    half, cx, cy = cell.half, cell.x, cell.y
    for i in range(order):
        for j in range(order):
            x, y = 2.0 * GAUSS[0, order, i] - 1.0, 2.0 * GAUSS[0, order, j] - 1.0
            weight = cell.area * GAUSS[1, order, i] * GAUSS[1, order, j]
            weight *= weight_of(eye.domain, cx + half * x, cy + half * y)
            put_node(sweep, cx + half * x, cy + half * y, weight)


@jitable
def edge_level(
    walls: Table[Wall], families: Table[Family], which: int, number: int, v: Vector, step: Vector, work: Array,
    out: Array,
) -> float:  # fmt: skip
    """The level of a wall, or of a line of a texture, at a ray; its slope along ``step`` is left in ``out[5]``."""
    still = (0.0, 0.0, 0.0)
    if which >= 0:
        put_level(walls[which], v, step, still, work, out)
        return dot((out[0], 0.0, 0.0), (1.0, 0.0, 0.0))
    family = families[-1 - which]
    n, u = vector(family.numerator), vector(family.denominator)
    line = (n[0] - number * u[0], n[1] - number * u[1], n[2] - number * u[2])
    out[5] = line[0] * step[0] + line[1] * step[1] + line[2] * step[2]
    return dot(line, v)


def fill_levels(
    walls: Table[Wall], families: Table[Family], which: Array, rays: Array, steps: Array, work: Array, out: Array,
    levels: Array, slopes: Array,
) -> None:  # fmt: skip
    """The level of the wall of each row of ``which`` at its ray, and its slope along its step."""
    for k in range(rays.shape[0]):
        v = (rays[k, 0], rays[k, 1], rays[k, 2])
        step = (steps[k, 0], steps[k, 1], steps[k, 2])
        wall, number = int(which[k, 0]), int(which[k, 1])
        levels[k] = edge_level(walls, families, wall, number, v, step, work, out)
        slopes[k] = out[5]
