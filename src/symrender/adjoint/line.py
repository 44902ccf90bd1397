"""The adjoint of one scan line: what everything in the scene does to the line's integral.

On a line the cells' ends are roots x_w of walls, so

    d/dp of the sum over cells of int F dx  =  sum of int F_p dx  +  sum over walls of (F below - F above) dx_w/dp,

with F = radiance x solid angle x lobe density analytic on every closed cell: no delta, and the same Gauss rule. The
nodes of the first sum are those of ``line_nodes.py``, in rows; the walls of the second those of ``ends.py``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.ends import walls_adjoint
from symrender.adjoint.light_rows import light_rows
from symrender.adjoint.line_nodes import (
    begin_rows,
    channel_columns,
    forget_rows,
    place_rows,
    surface_rows,
    tint_rows,
    view_rows,
)
from symrender.adjoint.lobe import log_density_at, pull
from symrender.adjoint.records import Moved
from symrender.adjoint.walls import TOWARD, chart_place
from symrender.adjoint.work import Charted
from symrender.chambers.labels import HIDDEN, PARTLY
from symrender.chambers.line import RIM_HIGH, RIM_LOW
from symrender.chambers.lobes.density import density_of
from symrender.chambers.lobes.width import blunt_rim, rim_power, steepening
from symrender.chambers.records import NODES, Nodes, Piece
from symrender.chambers.work import PENDING, View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.gauss import FALLS, MAX_ORDER, MIDDLE, order
from symrender.quadrature.line_errors import tail_error
from symrender.quadrature.line_poles import cell_order, find_poles
from symrender.quadrature.node_rows import whole_vectors
from symrender.quadrature.split_line import SOFT_LOG, disk_edge, stack_halves, stack_piece

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


class OffRim(NamedTuple):
    """Off the blunt rim at one end of a piece, at a share t of it, the cosine is rise t + bend t^2."""

    rise: float
    bend: float


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
def piece_map(row: Piece, work: Work) -> int:
    """How nodes are placed in a piece of a cell; -1 where the rim is at both ends and it must be cut."""
    if blunt_rim(work.chart.lobe) and work.chart.lobe.rim_cos == 0.0:
        first = row.start == work.cell_from[row.cell] and is_rim(work.cell_wall[row.cell])
        last = row.stop == work.cell_to[row.cell] and is_rim(work.cell_wall[row.cell + 1])
        if first and last:
            return -1
        if first:
            return _RIM_FIRST
        if last:
            return _RIM_LAST
    return _SOFT if row.soft != 0 else _EVEN


@inlined
def cosine_at(x: float, c: float, s: float, on: Charted) -> float:
    """cos(theta) of a place of the scan line (c, s), also beyond the rim."""
    lobe, toward = on.lobe, on.tangent.here.at[TOWARD]
    chart_place(x, c, s, on.work.chart, on.tangent.here)
    return float(toward[0] * lobe[0] + toward[1] * lobe[1] + toward[2] * lobe[2])


@inlined
def off_rim(row: Piece, placed: int, c: float, s: float, on: Charted) -> OffRim:
    """How the cosine grows off a blunt rim at an end of a piece of the scan line (c, s)."""
    length = row.stop - row.start
    near, half = NEAR_RIM * length, 0.5 * NEAR_RIM * length
    if placed == _RIM_FIRST:
        one, two = cosine_at(row.start + near, c, s, on), cosine_at(row.start + half, c, s, on)
    else:
        one, two = cosine_at(row.stop - near, c, s, on), cosine_at(row.stop - half, c, s, on)
    return OffRim((4.0 * two - one) / NEAR_RIM, 2.0 * (one - 2.0 * two) / (NEAR_RIM * NEAR_RIM))


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


@inlined
def piece_order(row: Piece, step: int, work: Work) -> int:
    """Gauss nodes of a piece of a cell; above ``MAX_ORDER`` it must be cut."""
    n: int = cell_order(row.start, row.stop, step, work)
    return max(n + (n + 1) // 2, order(step, SOFT_LOG)) if row.soft != 0 else n


@inlined
def stack_cell(cell: int, view: View, work: Work) -> int:
    """Put off a cell, in halves where the blunt rim is at both its ends; the height of the stack, empty before."""
    soft = 1 if soft_cell(cell, view, work) else 0
    top = stack_piece(0, cell, work.cell_from[cell], work.cell_to[cell], 0, 0, soft, work)
    row = work.pieces[NODES]
    return top if piece_map(row, work) >= 0 else stack_halves(0, row, 0, work)


@jitable
def place_nodes(m: int, piece: int, n: int, weight: float, top: int, on: Charted) -> None:
    """Make row ``top`` of the stack the piece at hand of this number, with ``n`` nodes from node ``m`` on."""
    work, gauss, r = on.work, on.gauss, on.tangent.nodes
    row = work.pieces[piece]
    work.pieces[piece] = work.pieces[NODES + top]
    row.first, row.count = m, n
    placed = piece_map(row, work)
    power = rim_power(work.chart.lobe) if placed in (_RIM_FIRST, _RIM_LAST) else 1.0
    base, length = n * (n - 1) // 2, row.stop - row.start
    for q in range(n):
        at, along, off = placed_node(gauss[0, base + q], length, placed, power)
        work.nodes.inner[m + q] = row.start + length * at
        r.weight[m + q] = weight * gauss[1, base + q] * along
        r.off[m + q] = off


@inlined
def pad_nodes(m: int, b: Nodes, r: Moved) -> None:
    """Make what follows ``m`` nodes in the last whole vector copies of the last one that count for nothing."""
    for q in range(m, whole_vectors(m)):
        b.inner[q], r.weight[q], r.off[q] = b.inner[m - 1], 0.0, 1.0


@jitable
def density_rows(m: int, pieces: int, c: float, s: float, on: Charted) -> None:
    """Multiply the nodes' weights by the lobe's density; how far off its axis they are, and how fast it falls there."""
    work, b, r = on.work, on.work.nodes, on.tangent.nodes
    lobe = work.chart.lobe
    for i in range(whole_vectors(m)):
        r.cosine[i], r.log[i], b.power[i] = log_density_at(0.5 * b.chord[i], lobe)
    if blunt_rim(lobe):
        for piece in range(pieces):
            row = work.pieces[piece]
            placed = piece_map(row, work)
            if placed in (_RIM_FIRST, _RIM_LAST):
                rim = off_rim(row, placed, c, s, on)
                for q in range(row.first, row.first + row.count):
                    off = r.off[q]
                    if off < NEAR_RIM and rim.rise > 0.0:
                        r.cosine[q] = max(1e-300, off * (rim.rise + off * rim.bend))
                        r.log[q] = math.log(r.cosine[q])
                        b.power[q] = density_of(r.log[q], lobe)
    for i in range(whole_vectors(m)):
        r.weight[i] *= b.power[i]
        r.steep[i] = pull(1.0, r.cosine[i], lobe)


@inlined
def piece_miss(row: Piece, on: Charted) -> tuple[float, float]:
    """Of what the nodes of a piece tell, the size and the rule's error."""
    gauss, r, lobe = on.gauss, on.tangent.nodes, on.work.chart.lobe
    n, placed = row.count, piece_map(row, on.work)
    base = n * (n - 1) // 2
    at_rim = placed in (_RIM_FIRST, _RIM_LAST) and rim_power(lobe) != 1.0
    whole, last, before, middle, lower = 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(n):
        told = r.told[row.first + q]
        if at_rim and told != 0.0:
            # as smooth as the density's slope
            told *= steepening(r.cosine[row.first + q], lobe)
        whole += abs(told)
        last += told * gauss[2, base + q]
        before += told * gauss[3, base + q]
        middle += told * gauss[MIDDLE, base + q]
        lower += told * gauss[MIDDLE + 1, base + q]
    middle = max(abs(middle), abs(lower))
    miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, 0.0)
    if placed != _EVEN and n > 2 and blunt_rim(lobe):
        miss = max(miss, 0.5 * abs(last), 0.25 * abs(before))
    return whole, miss


@inlined
def take_back(m: int, pieces: int, step: int, on: Charted, adjoint: Array) -> None:
    """Take back what the nodes of pieces that are ``wary`` have given the lights' own columns, and forget them."""
    work, r = on.work, on.tangent.nodes
    for i in range(whole_vectors(m)):
        r.told[i], r.weight[i] = r.weight[i], 0.0
    for piece in range(pieces):
        row = work.pieces[piece]
        if row.wary != 0:
            for q in range(row.first, row.first + row.count):
                r.weight[q], r.told[q] = -r.told[q], 0.0
    light_rows(m, pieces, step, False, on, adjoint)
    for piece in range(pieces):
        row = work.pieces[piece]
        if row.wary != 0:
            forget_rows(row.first, row.first + row.count, r)
    for i in range(whole_vectors(m)):
        r.weight[i] = r.told[i]


@inlined
def judge(pieces: int, top: int, size: float, step: int, on: Charted) -> tuple[int, float, float]:
    """Put off the halves of pieces that are less tame than they look, and mark these ``wary``.

    Returned are the height of the stack, and size and error of the pieces that are believed, after others of ``size``.
    """
    work, promise, whole, missed = on.work, 100.0 * FALLS[step], 0.0, 0.0
    for piece in range(pieces):
        row = work.pieces[piece]
        held, miss = piece_miss(row, on)
        spare = row.count > 4 and row.halvings < MAX_HALVINGS and top + 2 <= PENDING and not is_spent(work)
        if spare and miss > promise * (size + whole + held):
            # as where a ball leaves the part of a disk above the terminator
            top = stack_halves(top, row, 1, work)
            row.wary = 1
            continue
        whole += held
        missed += miss
    return top, whole, missed


@inlined
def line_adjoint(
    phi: float, weight: float, step: int, on: Charted, adjoint: Array
) -> tuple[float, float]:  # fmt: skip
    """Add ``weight`` times the scanned line's integral, differentiated, to ``adjoint``; ``step`` chooses the orders.

    The nodes are those of ``integrate_cells``. ``adjoint`` is (4, columns): a row a channel and ``ONE_SIDED``. Returned
    are the size of what its nodes tell, and the error of the rules along the line in the same units.
    """
    view, work, b, r = on.world, on.work, on.work.nodes, on.tangent.nodes
    chart = work.chart
    c, s = math.cos(phi), math.sin(phi)
    walls_adjoint(c, s, weight, step, on, adjoint)
    size, missed = 0.0, 0.0
    if not on.nodes:
        return size, missed
    ka = 0.0 if chart.shape_index < 0 and chart.side < 0.0 else view.shading.ka
    find_poles(phi, c, s, view, work)
    cell, top = 0, 0
    while top > 0 or cell < work.counts.cells:
        m, pieces = 0, 0
        while top > 0 or cell < work.counts.cells:
            if top == 0:
                if work.cell_side[cell] != HIDDEN:
                    top = stack_cell(cell, view, work)
                cell += 1
                continue
            n = piece_order(work.pieces[NODES + top - 1], step, work)
            if n > MAX_ORDER and top < PENDING and not is_spent(work):
                top = stack_halves(top - 1, work.pieces[NODES + top - 1], 0, work)
                continue
            n = min(n, MAX_ORDER)
            if m + n > NODES:
                break
            top -= 1
            place_nodes(m, pieces, n, weight, top, on)
            m += n
            pieces += 1
        if m == 0:
            break
        work.counts.evaluations += m
        pad_nodes(m, b, r)
        rows = whole_vectors(m)
        place_rows(rows, c, s, chart, on.lobe, b, r)
        view_rows(rows, on)
        density_rows(m, pieces, c, s, on)
        for piece in range(pieces):
            tint_rows(work.pieces[piece], on)
        begin_rows(rows, r)
        light_rows(m, pieces, step, True, on, adjoint)
        for a in range(3):
            surface_rows(rows, a, ka, on)
        top, held, miss = judge(pieces, top, size, step, on)
        for piece in range(pieces):
            if work.pieces[piece].wary != 0:
                take_back(m, pieces, step, on, adjoint)
                break
        size, missed = size + held, missed + miss
        for a in range(3):
            channel_columns(rows, a, ka, on, adjoint)
    return size, missed
