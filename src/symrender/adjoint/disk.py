"""How the light of a disk changes with everything that moves: the derivative of ``quadrature/disk_term.py``.

In coordinates (a, b) of the disk its circle stands still and only the curves that cut it move, so that

    d/dp int_region f da db  =  int_region f_p da db  +  oint f G_p/|grad G| ds,

the second along the arcs of the curves G = 0 that bound what is seen, G > 0 there. Both use the nodes of the value's
own rule. A cosine vanishes on the terminator, whose arcs therefore only count for a highlight that is cut there. As a
function of Q the mean over the disk is once continuously differentiable: the walls that a disk light lays on a shape
carry no jump, and a first derivative has no boundary term from them.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.light_term import BAR_ROWS, offset_gradient
from symrender.adjoint.walls import LIGHTS, plane_columns
from symrender.chambers.labels import PARTLY
from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import LightPoint
from symrender.chambers.rooms import height
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.disk_arcs import ARC, LINEAR, arc_log, arc_point, arc_side, corners, radial_log
from symrender.quadrature.disk_curves import (
    BALL,
    CONE,
    LINE,
    TERMINATOR,
    disk_curves,
    elevation,
)
from symrender.quadrature.disk_term import disk_log, highlight_lean, served
from symrender.quadrature.gauss import DISK_STARTS, disk_level, fitting
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

# rows of a functional (the cosine's mean, the highlight's mean): its gradients ...
PLACE: Final = 0
"""in the disk's centre,"""
AT_Q: Final = 1
"""in the lit point,"""
NORMAL: Final = 2
VIEW: Final = 3
TURN: Final = 4
"""in a turn of the disk's frame,"""
NUMBERS: Final = 5
"""in the disk's radius and in the shininess; in the last column its value."""
BALLS: Final = 6
"""From here on two rows a sphere, in its centre and in its radius, then two a plane, in its normal and its level."""

EDGE_ON_MOVING: Final = 1e-9
"""A disk as edge-on as that has no derivative here: the arcs of its cones are lost to rounding (``EDGE_ON``)."""


class ArcPoint(NamedTuple):
    """A point (a, b) of a curve in the disk, and how fast it runs there."""

    a: float
    b: float
    da: float
    db: float


@jitable
def disk_rows(spheres: int, planes: int) -> int:
    """Rows of scratch that ``disk_gradient`` fills: one light's, two functionals', and a flag."""
    return BAR_ROWS + 2 * (BALLS + 2 * (spheres + planes)) + 1


@inlined
def clear_flag(table: Array | None) -> None:
    """Forget that a disk was not differentiated."""
    if table is None:
        return
    table[table.shape[0] - 1, 0] = 0.0


@inlined
def is_flagged(table: Array | None) -> bool:
    """Whether some disk was not differentiated since the flag was cleared."""
    if table is None:
        return False
    return bool(table[table.shape[0] - 1, 0] != 0.0)


@jitable
def functional(which: int, table: Array) -> int:
    """First row of the cosine's mean (0) or of the highlight's (1)."""
    rows: int = (table.shape[0] - BAR_ROWS - 1) // 2
    return BAR_ROWS + which * rows


@jitable
def move_disk(weight: float, gx: float, gy: float, gz: float, a: float, b: float, p: LightPoint, out: Array) -> None:
    """Add ``weight`` times what gradient g at the disk's point (a, b) says of its centre, radius and frame."""
    rho = p.radius
    dx = a * p.e1[0] + b * p.e2[0]
    dy = a * p.e1[1] + b * p.e2[1]
    dz = a * p.e1[2] + b * p.e2[2]
    out[PLACE, 0] += weight * gx
    out[PLACE, 1] += weight * gy
    out[PLACE, 2] += weight * gz
    out[NUMBERS, 0] += weight * (dx * gx + dy * gy + dz * gz)
    out[TURN, 0] += weight * rho * (dy * gz - dz * gy)
    out[TURN, 1] += weight * rho * (dz * gx - dx * gz)
    out[TURN, 2] += weight * rho * (dx * gy - dy * gx)


@jitable
def disk_node(
    weight: float, a: float, b: float, first: int, last: int, p: LightPoint, q: LitPoint, view: View, table: Array
) -> None:  # fmt: skip
    """Add one node of the disk, at offset y + rho (a e1 + b e2) from Q, to functionals ``first`` .. ``last`` - 1."""
    rho = p.radius
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    sa, sb = rho * a, rho * b
    bar = table[:BAR_ROWS]
    cosine, gleam, by_shininess = offset_gradient(
        yx + sa * p.e1[0] + sb * p.e2[0], yy + sa * p.e1[1] + sb * p.e2[1],
        yz + sa * p.e1[2] + sb * p.e2[2], q, Gleam(view.shading.model == PHONG, view.shading.shininess, last > 1), bar,
    )  # fmt: skip
    for which in range(first, last):
        out = table[functional(which, table) :]
        g, n = bar[2 * which], bar[2 * which + 1]
        move_disk(weight, g[0], g[1], g[2], a, b, p, out)
        for c in range(3):
            out[AT_Q, c] -= weight * g[c]
            out[NORMAL, c] += weight * n[c]
            if which == 1:
                out[VIEW, c] += weight * bar[4, c]
        out[NUMBERS, 2] += weight * (gleam if which == 1 else cosine)
        if which == 1:
            out[NUMBERS, 1] += weight * by_shininess


@jitable
def moving_arc(
    curve: int, weight: float, at: ArcPoint, first: int, last: int, p: LightPoint, q: LitPoint, view: View, work: Work,
    table: Array,
) -> None:  # fmt: skip
    """Add what the motion of a curve sweeps at one of its points; ``weight`` is positive."""
    a, b, da, db = at
    qx, qy, qz, nx, ny, nz, vx, vy, vz = q
    row = work.curves[curve]
    bounds = row.bounds
    rho = p.radius
    yx, yy, yz = (
        p.position[0] + rho * (a * p.e1[0] + b * p.e2[0]) - qx,
        p.position[1] + rho * (a * p.e1[1] + b * p.e2[1]) - qy,
        p.position[2] + rho * (a * p.e1[2] + b * p.e2[2]) - qz,
    )
    cx, cy, cz, radius, ball = 0.0, 0.0, 0.0, 0.0, 0
    y2, inner, power, facing = 0.0, 0.0, 0.0, 1.0
    if bounds == CONE:
        ball = row.ball
        s = view.spheres[ball]
        cx, cy, cz, radius = s.center[0] - qx, s.center[1] - qy, s.center[2] - qz, s.radius
        y2, inner = yx * yx + yy * yy + yz * yz, yx * cx + yy * cy + yz * cz
        power = cx * cx + cy * cy + cz * cz - radius * radius
        gx, gy, gz = 2.0 * (yx * power - inner * cx), 2.0 * (yy * power - inner * cy), 2.0 * (yz * power - inner * cz)
    elif bounds == TERMINATOR:
        gx, gy, gz = nx, ny, nz
    else:
        side = view.sides[row.ball]
        up = side.up
        above = row.k0 * height(side, p.position[0], p.position[1], p.position[2])
        above += row.k1 * (up[0] * p.e1[0] + up[1] * p.e1[1] + up[2] * p.e1[2])
        above += row.k2 * (up[0] * p.e2[0] + up[1] * p.e2[1] + up[2] * p.e2[2])
        facing = 1.0 if above >= 0.0 else -1.0
        gx, gy, gz = facing * up[0], facing * up[1], facing * up[2]
    ga = rho * (gx * p.e1[0] + gy * p.e1[1] + gz * p.e1[2])
    gb = rho * (gx * p.e2[0] + gy * p.e2[1] + gz * p.e2[2])
    slope = math.sqrt(ga * ga + gb * gb)
    if slope == 0.0:
        return
    cosine, gleam = light_term(yx, yy, yz, nx, ny, nz, vx, vy, vz, view.shading.model == PHONG, view.shading.shininess)
    speed = weight * math.sqrt(da * da + db * db) / slope
    for which in range(first, last):
        if bounds == TERMINATOR and which == 0:
            continue
        w = speed * (gleam if which == 1 else cosine)
        out = table[functional(which, table) :]
        move_disk(w, gx, gy, gz, a, b, p, out)
        if bounds == LINE:
            first_row = BALLS + 2 * (view.spheres.shape[0] + row.ball)
            out[first_row, 0] += w * facing * (yx + qx)
            out[first_row, 1] += w * facing * (yy + qy)
            out[first_row, 2] += w * facing * (yz + qz)
            out[first_row + 1, 0] -= w * facing
            continue
        out[AT_Q, 0] -= w * gx
        out[AT_Q, 1] -= w * gy
        out[AT_Q, 2] -= w * gz
        if bounds == TERMINATOR:
            out[NORMAL, 0] += w * yx
            out[NORMAL, 1] += w * yy
            out[NORMAL, 2] += w * yz
            continue
        for c in range(3):
            y = yx if c == 0 else (yy if c == 1 else yz)
            center = cx if c == 0 else (cy if c == 1 else cz)
            by_center = w * 2.0 * (center * y2 - inner * y)
            out[AT_Q, c] -= by_center
            out[BALLS + 2 * ball, c] += by_center
        out[BALLS + 2 * ball + 1, 0] -= w * 2.0 * radius * y2


@jitable
def arc_gradient(
    p: LightPoint, n: int, first: int, last: int, q: LitPoint, step: int, log_rho: float, view: View, work: Work,
    gauss: Array, table: Array,
) -> None:  # fmt: skip
    """Add the part of a disk that none of the first ``n`` curves of ``work.curves`` hides; nodes as in ``arc_term``."""
    if n == 0 and served(step, log_rho):
        rule = disk_level(step, log_rho)
        for k in range(DISK_STARTS[rule], DISK_STARTS[rule + 1]):
            disk_node(gauss[2, k], gauss[0, k], gauss[1, k], first, last, p, q, view, table)
        return
    nodes, inner = fitting(step, arc_log(log_rho)), max(LINEAR, fitting(step, radial_log(log_rho)))
    start, within = nodes * (nodes - 1) // 2, inner * (inner - 1) // 2
    turns = work.turns
    for curve in range(-1, n):
        count, closed = corners(curve, n, work.curves, turns)
        arcs = count if closed else count - 1
        if closed and count == 0:
            turns[0] = 0.0
            arcs = 1
        for arc in range(arcs):
            low = turns[arc]
            high = turns[arc + 1] if arc + 1 < count else turns[0] + 2.0 * math.pi
            if high - low < 1e-14:
                continue
            sense = arc_side(curve, 0.5 * (low + high), n, work.curves)
            if sense == 0.0:
                continue
            pieces = math.ceil((high - low) / ARC) if closed else 1
            length = (high - low) / pieces
            for piece in range(pieces):
                for node in range(nodes):
                    a, b, da, db, _ = arc_point(curve, low + length * (piece + gauss[0, start + node]), work.curves)
                    along = length * gauss[1, start + node] / math.pi
                    weight = sense * along * (a * db - b * da)
                    for r in range(inner):
                        s = gauss[0, within + r]
                        disk_node(weight * s * gauss[1, within + r], s * a, s * b, first, last, p, q, view, table)
                    if curve >= 0:
                        moving_arc(curve, along, ArcPoint(a, b, da, db), first, last, p, q, view, work, table)


@jitable
def disk_gradient(
    i: int, state: int, q: LitPoint, step: int, gleaming: bool, view: View, work: Work, gauss: Array,
    table: Array | None,
) -> tuple[float, float, float]:  # fmt: skip
    """Gradients of both means of ``disk_term`` into ``table``; the means, and the highlight's slope in shininess.

    ``table`` is (``disk_rows``, 3). Without ``gleaming`` only those of the cosine. Where a ball touches the disk
    itself, or it is seen edge-on, nothing is differentiated and the first number of the last row, which the caller
    clears, becomes 1. Without a table all of them are 0.
    """
    if table is None:
        return 0.0, 0.0, 0.0
    flag = table.shape[0] - 1
    for row in range(BAR_ROWS, flag):
        for c in range(3):
            table[row, c] = 0.0
    p = view.points[i]
    phong, shininess = view.shading.model == PHONG, view.shading.shininess
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    lean = highlight_lean(yx, yy, yz, far, q.vx, q.vy, q.vz)
    log_rho = disk_log(far, p.radius, phong, shininess if gleaming else 0.0, lean)
    n, lifted = 0, yx * q.nx + yy * q.ny + yz * q.nz > 0.0
    if state >= PARTLY:
        n, lifted = disk_curves(i, q.x, q.y, q.z, q.nx, q.ny, q.nz, view, work)
    if n < 0:
        return 0.0, 0.0, 0.0
    opened = view.shading.terminator == OPEN
    most = 2 if gleaming else 1
    edge_on = elevation(p, yx, yy, yz) < EDGE_ON_MOVING
    for k in range(n):
        if edge_on or work.curves[k].bounds >= BALL:
            table[flag, 0] = 1.0
            return 0.0, 0.0, 0.0
    banded = n > 0 and work.curves[n - 1].bounds == TERMINATOR
    # highlights do not end at an open terminator
    beyond = gleaming and opened and (banded or not lifted)
    if lifted or banded:
        arc_gradient(p, n, 0, 1 if beyond else most, q, step, log_rho, view, work, gauss, table)
    if beyond:
        unbanded = n - 1 if banded else n
        arc_gradient(p, unbanded, 1, 2, q, step, log_rho, view, work, gauss, table)
    cosine, shine = functional(0, table) + NUMBERS, functional(1, table) + NUMBERS
    return table[cosine, 2], table[shine, 2], table[shine, 1]


@jitable
def monitor(lambert: float, shine: float, table: Array | None) -> float:
    """One number that is as smooth as all gradients in ``table``: the means weighed, in light, balls and place."""
    if table is None:
        return 0.0
    total = 0.0
    for which in range(2):
        first = functional(which, table)
        rows = table[first : first + (table.shape[0] - BAR_ROWS - 1) // 2]
        part = rows[NUMBERS, 0] + rows[PLACE, 0] + 0.7 * rows[PLACE, 1] + 0.4 * rows[PLACE, 2]
        for k in range(BALLS + 1, rows.shape[0], 2):
            part += rows[k, 0]
        total += (shine if which == 1 else lambert) * part
    return total


@jitable
def disk_adjoint(
    i: int, diffuse: float, highlight: float, view: View, work: Work, table: Array | None, node: Array, out: Array
) -> None:  # fmt: skip
    """Add ``diffuse`` x the cosine's gradients and ``highlight`` x the highlight's, of disk ``i`` in ``table``.

    ``node`` (3, 3) takes those in Q, N and the view, the adjoint ``out`` those in the disk and in what hides it.
    """
    if table is None:
        return
    balls = LIGHTS + 6 * view.points.shape[0]
    planes = plane_columns(view)
    column, more = LIGHTS + 6 * i, planes + 4 * view.sides.shape[0] + 4 * i
    for which in range(2):
        weight = highlight if which == 1 else diffuse
        if weight == 0.0:
            continue
        rows = table[functional(which, table) :]
        for c in range(3):
            out[column + c] += weight * rows[PLACE, c]
            node[0, c] += weight * rows[AT_Q, c]
            node[1, c] += weight * rows[NORMAL, c]
            node[2, c] += weight * rows[VIEW, c]
            out[more + 1 + c] += weight * rows[TURN, c]
        out[more] += weight * rows[NUMBERS, 0]
        for k in range(work.counts.casters):
            if work.casters[k].light == i:
                ball = work.casters[k].ball
                for c in range(3):
                    out[balls + 4 * ball + c] += weight * rows[BALLS + 2 * ball, c]
                out[balls + 4 * ball + 3] += weight * rows[BALLS + 2 * ball + 1, 0]
        for k in range(view.sides.shape[0]):
            row = BALLS + 2 * (view.spheres.shape[0] + k)
            for c in range(3):
                out[planes + 4 * k + c] += weight * rows[row, c]
            out[planes + 4 * k + 3] += weight * rows[row + 1, 0]
