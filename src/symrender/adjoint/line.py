"""The adjoint of one scan line: what everything in the scene does to the line's integral.

On a line the cells' ends are roots x_w of walls, so

    d/dp of the sum over cells of int F dx  =  sum of int F_p dx  +  sum over walls of (F below - F above) dx_w/dp,

with F = radiance x solid angle x lobe density analytic on every closed cell: no delta, and the same Gauss rule. The
nodes of the first sum are those of ``node.py``, the walls of the second those of ``ends.py``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.ends import walls_adjoint
from symrender.adjoint.node import Node, log_density, node_adjoint
from symrender.adjoint.walls import TOWARD, chart_place
from symrender.adjoint.work import Charted
from symrender.chambers.labels import HIDDEN, PARTLY
from symrender.chambers.line import RIM_HIGH, RIM_LOW
from symrender.chambers.lobes.density import density_of
from symrender.chambers.lobes.width import blunt_rim, rim_power, steepening
from symrender.chambers.work import View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.gauss import FALLS, MAX_ORDER, MIDDLE, order
from symrender.quadrature.line_errors import tail_error
from symrender.quadrature.line_poles import cell_order, find_poles
from symrender.quadrature.split_line import SOFT_LOG, disk_edge

Array = npt.NDArray[np.float64]

MAX_HALVINGS = 16
"""Most halvings of one cell of a line whose light is less smooth than the walls tell."""
# how nodes are placed in a piece of a cell
_EVEN = 0
_SOFT = 1
"""Denser at both ends, like the sine's square."""
_RIM_FIRST = 2
_RIM_LAST = 3
"""Like a power of the distance from the blunt rim at its first, or last, end."""
NEAR_RIM = 1e-4
"""Share of a piece, from the rim on, in which the cosine is not read off directions: rounding there is all of it."""


class Piece(NamedTuple):
    """A piece start..stop of a cell of the line (c, s), and how its nodes are placed, as of ``piece_map``."""

    start: float
    stop: float
    c: float
    s: float
    cell: int
    placed: int


class OffRim(NamedTuple):
    """Off the blunt rim at one end of a piece, at a share t of it, the cosine is rise t + bend t^2.

    Nodes lie at the ``power`` of Gauss's; 1 where there is no such end.
    """

    rise: float
    bend: float
    power: float


@inlined
def soft_cell(cell: int, view: View, work: Work) -> bool:
    """Whether a cell's integrand ends with a broken power: at a wall of a disk light, or beside a blunt lobe's rim."""
    if blunt_rim(work.chart.lobe) and (is_rim(work.cell_wall[cell]) or is_rim(work.cell_wall[cell + 1])):
        return True
    if disk_edge(work.cell_wall[cell], work) or disk_edge(work.cell_wall[cell + 1], work):
        for i in range(view.points.shape[0]):
            if work.lit[cell, i] >= PARTLY:
                return True
    return False


@inlined
def is_rim(wall: int) -> bool:
    """Whether the end of a cell lies on the lobe's rim."""
    return bool(wall in (RIM_LOW, RIM_HIGH))


@inlined
def piece_map(a: float, end: float, cell: int, soft: bool, work: Work) -> int:
    """How nodes are placed in the piece a..end of a cell; -1 where the rim is at both ends and it must be cut."""
    if blunt_rim(work.chart.lobe) and work.chart.lobe.rim_cos == 0.0:
        first = a == work.cell_from[cell] and is_rim(work.cell_wall[cell])
        last = end == work.cell_to[cell] and is_rim(work.cell_wall[cell + 1])
        if first and last:
            return -1
        if first:
            return _RIM_FIRST
        if last:
            return _RIM_LAST
    return _SOFT if soft else _EVEN


@inlined
def cosine_at(x: float, piece: Piece, on: Charted) -> float:
    """cos(theta) of a place of a scan line, also beyond the rim."""
    lobe, toward = on.lobe, on.tangent.here.at[TOWARD]
    chart_place(x, piece.c, piece.s, on.work.chart, on.tangent.here)
    return float(toward[0] * lobe[0] + toward[1] * lobe[1] + toward[2] * lobe[2])


@inlined
def off_rim(piece: Piece, on: Charted) -> OffRim:
    """How the cosine grows off a blunt rim at an end of a piece."""
    if piece.placed not in (_RIM_FIRST, _RIM_LAST):
        return OffRim(0.0, 0.0, 1.0)
    length = piece.stop - piece.start
    near, half = NEAR_RIM * length, 0.5 * NEAR_RIM * length
    if piece.placed == _RIM_FIRST:
        one, two = cosine_at(piece.start + near, piece, on), cosine_at(piece.start + half, piece, on)
    else:
        one, two = cosine_at(piece.stop - near, piece, on), cosine_at(piece.stop - half, piece, on)
    rise, bend = (4.0 * two - one) / NEAR_RIM, 2.0 * (one - 2.0 * two) / (NEAR_RIM * NEAR_RIM)
    return OffRim(rise, bend, rim_power(on.work.chart.lobe))


@inlined
def placed_node(u: float, length: float, placed: int, power: float) -> tuple[float, float, float]:
    """Where in a piece of this ``length`` Gauss's node ``u`` lies, the map's slope, and its share off a blunt rim."""
    if placed == _SOFT:
        # the slope of a disk's light ends with the square root of the distance from a wall
        su, cu = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
        return su * su, length * math.pi * su * cu, 1.0
    if placed == _RIM_FIRST:
        off = u**power
        return off, length * power * off / u, off
    if placed == _RIM_LAST:
        off = (1.0 - u) ** power
        return 1.0 - off, length * power * off / (1.0 - u), off
    return u, length, 1.0


@jitable
def piece_adjoint(
    piece: Piece, n: int, weight: float, step: int, on: Charted, adjoint: Array
) -> tuple[float, float]:  # fmt: skip
    """Add a piece of a cell by ``n`` nodes. Of what ``node_adjoint`` tells, the size and the rule's error."""
    gauss, here, chart = on.gauss, on.tangent.here, on.work.chart
    base = n * (n - 1) // 2
    on.work.counts.evaluations += n
    whole, last, before, middle, lower = 0.0, 0.0, 0.0, 0.0, 0.0
    length, rim = piece.stop - piece.start, off_rim(piece, on)
    for q in range(n):
        u, along, off = placed_node(gauss[0, base + q], length, piece.placed, rim.power)
        measure, slope_k = chart_place(piece.start + length * u, piece.c, piece.s, chart, here)
        cosine, log, density = log_density(here, on.lobe, chart)
        if off < NEAR_RIM and rim.rise > 0.0:
            cosine = max(1e-300, off * (rim.rise + off * rim.bend))
            log = math.log(cosine)
            density = density_of(log, chart.lobe)
        if density == 0.0:
            continue
        w = weight * gauss[1, base + q] * along * measure * density
        told = node_adjoint(Node(w, slope_k, cosine, log, piece.cell, step), on, adjoint)
        if rim.power != 1.0:
            # as smooth as the density's slope
            told *= steepening(cosine, chart.lobe)
        whole += abs(told)
        last += told * gauss[2, base + q]
        before += told * gauss[3, base + q]
        middle += told * gauss[MIDDLE, base + q]
        lower += told * gauss[MIDDLE + 1, base + q]
    middle = max(abs(middle), abs(lower))
    miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, 0.0)
    if piece.placed != _EVEN and n > 2 and blunt_rim(chart.lobe):
        miss = max(miss, 0.5 * abs(last), 0.25 * abs(before))
    return whole, miss


@inlined
def piece_order(a: float, end: float, step: int, soft: bool, work: Work) -> int:
    """Gauss nodes of a piece of a cell; above ``MAX_ORDER`` it must be cut."""
    n: int = cell_order(a, end, step, work)
    return max(n + (n + 1) // 2, order(step, SOFT_LOG)) if soft else n


@inlined
def line_adjoint(
    phi: float, weight: float, step: int, on: Charted, adjoint: Array
) -> tuple[float, float]:  # fmt: skip
    """Add ``weight`` times the scanned line's integral, differentiated, to ``adjoint``; ``step`` chooses the orders.

    The nodes are those of ``integrate_cells``. ``adjoint`` is (4, columns): a row a channel and ``ONE_SIDED``. Returned
    are the size of what ``node_adjoint`` tells, and the error of the rules along the line in the same units.
    """
    view, work = on.view, on.work
    c, s = math.cos(phi), math.sin(phi)
    walls_adjoint(c, s, weight, step, on, adjoint)
    size, missed = 0.0, 0.0
    if not on.nodes:
        return size, missed
    promise = 100.0 * FALLS[step]
    find_poles(phi, c, s, view, work)
    for cell in range(work.counts.cells):
        if work.cell_side[cell] == HIDDEN:
            continue
        a, stop = work.cell_from[cell], work.cell_to[cell]
        soft = soft_cell(cell, view, work)
        end = stop
        halvings = 0
        while a < stop:
            placed = piece_map(a, end, cell, soft, work)
            if placed < 0:
                end = a + 0.5 * (end - a)
                placed = piece_map(a, end, cell, soft, work)
            n = piece_order(a, end, step, soft, work)
            while n > MAX_ORDER and not is_spent(work):
                end = a + 0.5 * (end - a)
                placed = piece_map(a, end, cell, soft, work)
                n = piece_order(a, end, step, soft, work)
            n = min(n, MAX_ORDER)
            piece = Piece(a, end, c, s, cell, placed)
            whole, miss = piece_adjoint(piece, n, weight, step, on, adjoint)
            if n > 4 and halvings < MAX_HALVINGS and miss > promise * (size + whole) and not is_spent(work):
                # less tame than it looks, as where a ball leaves the part of a disk above the terminator: taken back
                piece_adjoint(piece, n, -weight, step, on, adjoint)
                halvings += 1
                end = a + 0.5 * (end - a)
                continue
            size += whole
            missed += miss
            a, end = end, stop
    return size, missed
