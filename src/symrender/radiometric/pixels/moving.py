"""How the mean of a pixel moves: what its nodes see changes, and walls sweep over what they part.

d/dtheta of the integral along a line is the integral of the slope plus, at each wall, the difference of radiance on
both sides times how fast the wall crosses the line. Lines themselves stay where they are: where walls cross each other
or leave a cell the integral along a line is continuous, so that ends of panels add nothing. Radiance at a wall is
extrapolated from the nodes of the piece beside it, in the variable in which it is smooth there.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.radiometric.pixels.cells import BOX, Cell, Eye, cell_at, heaviest, weight_of
from symrender.radiometric.pixels.curves import put_level
from symrender.radiometric.pixels.pixel import begin, pixel_mean
from symrender.radiometric.pixels.records import COARSE, CUT, LOGGED, SMOOTH, Family, Ints, Room, Wall
from symrender.radiometric.pixels.rules import (
    GAUSS,
    add_light,
    clear,
    cutting_mode,
    half_width,
    in_order,
    locate,
    mapped,
    put_panels,
)
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.textures import put_lines
from symrender.radiometric.vectors import Array, Vector, dot, vector

_THIN: Final = 1e-11
"""A piece between walls that coincide."""


class Sweep(NamedTuple):
    """What a pixel's derivative is summed from, by two rules: rows of each, and how many there are."""

    nodes: Array
    """(n, 4): place x, y in the pixel, then weights in the finer and in the coarser rule."""
    edges: Array
    """(n, 13): place, the direction in which t grows, then what is swept a unit of t, emitted and direct light, of
    the finer rule and, where that is zero, of the coarser; 0 or 1 as it is the coarser's."""
    walls: Ints
    """(n, 2): the wall of each edge, or -1 less the family, and the number, of a line of a texture."""
    counts: Ints
    """(3,): nodes, edges, and 1 where there was no room for all."""
    ends: Array
    """(2, 6): light at the end of the piece before, and at the beginning of this."""


@inlined
def place_of(mode: int, t: float, s: float) -> tuple[float, float]:
    """(x, y) of a place in a cell that is cut this way."""
    x = t if mode == 0 else (s if mode == 1 else t + s)
    y = s if mode == 0 else (t if mode == 1 else (t - s if mode == 2 else s - t))
    return x, y


@jitable
def put_node(sweep: Sweep, x: float, y: float, weight: float, coarser: bool) -> None:
    """Add a node."""
    k = int(sweep.counts[0])
    if k >= sweep.nodes.shape[0]:
        sweep.counts[2] = 1
        return
    row = sweep.nodes[k]
    row[0], row[1], row[2], row[3] = x, y, 0.0 if coarser else weight, weight if coarser else 0.0
    sweep.counts[0] = k + 1


@jitable
def put_edge(
    eye: Eye, room: Room, sweep: Sweep, level: int, own: int, curve: int, x: float, y: float, tx: float, ty: float,
    weight: float, coarser: bool,
) -> None:  # fmt: skip
    """Add what a wall sweeps: the light before it less that behind it, weighted."""
    k = int(sweep.counts[1])
    if k >= sweep.edges.shape[0]:
        sweep.counts[2] = 1
        return
    row = sweep.edges[k]
    row[0], row[1], row[2], row[3] = x, y, tx, ty
    for c in range(6):
        row[4 + c] = weight * weight_of(eye.domain, x, y) * (sweep.ends[0, c] - sweep.ends[1, c])
    row[10] = 1.0 if coarser else 0.0
    if curve < own:
        sweep.walls[k, 0], sweep.walls[k, 1] = room.which[level, curve], 0
    else:
        sweep.walls[k, 0], sweep.walls[k, 1] = -1 - room.numbers[curve - own, 0], room.numbers[curve - own, 1]
    sweep.counts[1] = k + 1


@jitable
def end_weight(order: int, node: int, end: float) -> float:
    """Weight of a Gauss node of [0, 1] in the value of the polynomial through all at an end."""
    found = 1.0
    for k in range(order):
        if k != node:
            found *= (end - GAUSS[0, order, k]) / (GAUSS[0, order, node] - GAUSS[0, order, k])
    return found


@jitable
def sweep_line(
    eye: Eye, cell: Cell, half: float, cx: float, cy: float, room: Room, sweep: Sweep, weight: float, order: int,
    own: int, count: int, mode: int, s: float, coarser: bool,
) -> None:  # fmt: skip
    """Add the nodes of a line and what the walls that cross it sweep; many arguments because a cell's cut has them."""
    wide, ends = half_width(mode, s), sweep.ends
    # weights of places are known exactly, so that radiance alone is extrapolated to walls
    plain = Eye(
        eye.world, eye.mean, eye.place, eye.walls, eye.families, eye.bright, eye.peak, eye.delicate, BOX, eye.nodes
    )
    locate(room, count, mode, s, 1)
    found = in_order(room, count)
    ox, oy = place_of(mode, 0.0, 0.0)
    dx, dy = place_of(mode, 1.0, 0.0)
    start, hard, wall, at = -wide, True, -1, 0.0
    for piece in range(found + 1):
        last = piece == found
        stop = wide if last else min(max(room.places[3, piece], start), wide)
        free = last or room.soft[room.states[3, piece]] == 0.0
        if stop - start > _THIN:
            for c in range(6):
                ends[1, c], room.sums[1, c] = 0.0, 0.0
            for i in range(order):
                u = GAUSS[0, order, i]
                place, slope = mapped(u, not hard, not free)
                x, y = place_of(mode, start + (stop - start) * place, s)
                clear(room, 0)
                add_light(plain, eye.world, cell, x, y, 1.0, 0, room)
                share = weight * (stop - start) * slope * GAUSS[1, order, i]
                share *= weight_of(eye.domain, cx + half * x, cy + half * y)
                put_node(sweep, cx + half * x, cy + half * y, share, coarser)
                for c in range(6):
                    ends[1, c] += end_weight(order, i, 0.0) * room.sums[0, c]
                    room.sums[1, c] += end_weight(order, i, 1.0) * room.sums[0, c]
            if wall >= 0:
                x, y = place_of(mode, at, s)
                put_edge(
                    eye, room, sweep, cell.level, own, wall, cx + half * x, cy + half * y, half * (dx - ox),
                    half * (dy - oy), weight, coarser,
                )  # fmt: skip
            for c in range(6):
                ends[0, c] = room.sums[1, c]
            # of walls that coincide the last before a piece is the one that is taken to move
            wall = -1
        if not last and start >= -wide:
            if wall < 0:
                wall, at = int(room.states[3, piece]), room.places[3, piece]
            if stop - start > _THIN or piece == 0:
                hard = free
            else:
                hard = hard and free
        start = stop


@jitable
def sweep_cut(
    eye: Eye, cell: Cell, half: float, cx: float, cy: float, room: Room, sweep: Sweep, order: int, way: int,
    limit: float,
) -> None:  # fmt: skip
    """Add a cell that is integrated line by line, by the rule it was taken with and by the one before."""
    own = int(room.counts[cell.level])
    lines = put_lines(eye.families, cell.v, cell.vx, cell.vy, room, limit)
    mode = cutting_mode(room, own, lines, cell.level) if lines >= 0 else -1
    if mode < 0:
        sweep.counts[2] = 1
        return
    count, soft = own + lines, False
    for k in range(count):
        room.soft[k] = eye.walls[int(room.which[cell.level, k])].soft if k < own else 0.0
        soft = soft or (way >= 4 and room.soft[k] != 0.0)
    panels, _ = put_panels(room, count, mode)
    scale = cell.area * (0.25 if mode < 2 else 0.5)
    for rule in range(2):
        nodes = order if rule == 0 else (8 if order == 12 else (5 if order == 8 else (3 if order == 5 else 2)))
        for panel in range(panels):
            start, stop = room.panels[panel], room.panels[panel + 1]
            for i in range(nodes):
                place, slope = mapped(GAUSS[0, nodes, i], soft, soft)
                weight = scale * (stop - start) * slope * GAUSS[1, nodes, i]
                s = start + (stop - start) * place
                sweep_line(eye, cell, half, cx, cy, room, sweep, weight, nodes, own, count, mode, s, rule == 1)


@jitable
def sweep_smooth(eye: Eye, cell: Cell, half: float, cx: float, cy: float, sweep: Sweep, order: int) -> None:
    """Add the nodes of a cell without walls, by the rule it was taken with and by the one before."""
    for rule in range(2):
        nodes = order if rule == 0 else (5 if order == 8 else (3 if order == 5 else 2))
        for i in range(nodes):
            for j in range(nodes):
                x, y = 2.0 * GAUSS[0, nodes, i] - 1.0, 2.0 * GAUSS[0, nodes, j] - 1.0
                weight = cell.area * GAUSS[1, nodes, i] * GAUSS[1, nodes, j]
                weight *= weight_of(eye.domain, cx + half * x, cy + half * y)
                put_node(sweep, cx + half * x, cy + half * y, weight, rule == 1)


def sweep_pixel(
    eye: Eye, whole: Cell, room: Room, candidates: Ints, count: int, tol: float, budget: int, sweep: Sweep
) -> float:  # fmt: skip
    """List what the derivative of a pixel is summed from; returns the length of sides of cells that are not resolved.

    ``room.total`` is left as by ``pixel_mean``.
    """
    pixel_mean(eye, whole, room, candidates, count, tol, budget)
    sweep.counts[0], sweep.counts[1], sweep.counts[2] = 0, 0, 0
    held = int(room.log[LOGGED, 0])
    coarse = 0.0
    if held >= LOGGED - 1:
        sweep.counts[2] = 1
        return coarse
    for index in range(held):
        log = room.log[index]
        level, path = int(log[0]), int(log[1])
        for k in range(level, 0, -1):
            room.path[k] = path % 4
            path = path // 4
        cell = cell_at(whole, room, level, tol)
        half, cx, cy = 1.0, 0.0, 0.0
        for k in range(1, level + 1):
            half *= 0.5
            cx += half if room.path[k] % 2 == 1 else -half
            cy += half if room.path[k] >= 2 else -half
        if log[2] == COARSE or log[4] < 0:
            coarse += half * heaviest(eye.domain, cell)
        if log[2] == SMOOTH:
            sweep_smooth(eye, cell, half, cx, cy, sweep, int(log[3]))
        elif log[2] == CUT and log[4] >= 0:
            limit = put_reach(eye, cell, room)
            if begin(eye, cell, room, candidates, count, limit):
                sweep_cut(eye, cell, half, cx, cy, room, sweep, int(log[3]), int(log[4]), limit)
            else:
                sweep.counts[2] = 1
        else:
            sweep_smooth(eye, cell, half, cx, cy, sweep, 3)
    return coarse


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
