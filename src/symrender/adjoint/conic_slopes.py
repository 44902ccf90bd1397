"""How the conics of the checkered floor move: the gradients of their levels in everything that can move them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.moves import any_moves
from symrender.adjoint.records import Origin
from symrender.adjoint.sums import clear_columns
from symrender.adjoint.walls import AT_POINT, AXIS, GRID, HORIZON_NORMAL, LIGHTS, RIM, plane_columns
from symrender.adjoint.work import Charted
from symrender.chambers.work import View, Work
from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.quadrature.floor_conics import is_edge
from symrender.scene.records import Floor

Array = npt.NDArray[np.float64]

# what a conic is
_RIM = 0
_HORIZON = 1
_SILHOUETTE = 2
_BALL = 3
_SHADOW = 4
_EDGE = 5


@jitable
def name_conic(n: int, kind: int, shape: int, light: int, origins: Table[Origin]) -> int:
    """Note what conic ``n`` is the outline of; the number of the next one."""
    row = origins[n]
    row.kind, row.shape_index, row.light = kind, shape, light
    return n + 1


@jitable
def name_conics(view: View, work: Work, origins: Table[Origin]) -> None:
    """What each row of ``floor_conics`` is the outline of."""
    for k in range(origins.shape[0]):
        origins[k].moves = 0
    n = name_conic(0, _RIM, 0, 0, origins)
    n = name_conic(n, _HORIZON, 0, 0, origins)
    for k in range(view.sides.shape[0]):
        if is_edge(k, view, work.chart):
            n = name_conic(n, _EDGE, k, 0, origins)
    for i in range(work.counts.occluders):
        k = work.occluders[i]
        n = name_conic(n, _SILHOUETTE, k, 0, origins)
        if abs(view.spheres[k].center[2]) < view.spheres[k].radius:
            n = name_conic(n, _BALL, k, 0, origins)
    for i in range(work.counts.casters):
        if work.casters[i].unseen == 1:
            continue
        n = name_conic(n, _SHADOW, work.casters[i].ball, work.casters[i].light, origins)


@jitable
def moving_conics(count: int, on: Charted, origins: Table[Origin]) -> bool:
    """Note which of the conics move; whether any does."""
    view, moves = on.world, on.moves
    balls = LIGHTS + 6 * view.points.shape[0]
    some = False
    for k in range(count):
        kind, ball = origins[k].kind, balls + 4 * origins[k].shape_index
        if on.nodes:
            moved = True
        elif kind == _RIM:
            moved = any_moves(moves, RIM, RIM + 1)
        elif kind == _HORIZON:
            moved = any_moves(moves, HORIZON_NORMAL, HORIZON_NORMAL + 3)
        elif kind == _EDGE:
            plane = plane_columns(view) + 4 * origins[k].shape_index
            moved = any_moves(moves, plane, plane + 4)
        else:
            moved = any_moves(moves, ball, ball + 4)
        origins[k].moves = 1 if moved else 0
        some = some or moved
    return some


@jitable
def conic_gradient(origin: Origin, x: float, y: float, on: Charted, bar: Array) -> None:
    """Gradient of a conic's level: ``bar`` (3,) in Q at a fixed point P, the rest added to ``own``."""
    kind, shape, light = origin.kind, origin.shape_index, origin.light
    lobe, view, own = on.lobe, on.world, on.tangent.own
    chart = on.work.chart
    h = chart.height
    balls = LIGHTS + 6 * view.points.shape[0]
    r = math.sqrt(x * x + y * y + h * h)
    d = (x, y, -h)
    seen_from = True
    if kind == _RIM:
        cosine = (x * lobe[0] + y * lobe[1] - h * lobe[2]) / r
        for a in range(3):
            bar[a] = (lobe[a] - d[a] / r * cosine) / r
            own[AXIS + a] += d[a] / r
        own[RIM] -= 1.0
    elif kind == _HORIZON:
        for a in range(3):
            bar[a] = chart.normal[a]
            own[HORIZON_NORMAL + a] += d[a]
    elif kind == _SILHOUETTE:
        far2, along = 0.0, 0.0
        for a in range(3):
            o = view.spheres[shape].center[a] - chart.point[a]
            far2 += o * o
            along += o * d[a] / r
        radius = view.spheres[shape].radius
        tangent = math.sqrt(far2 - radius * radius)
        for a in range(3):
            o = view.spheres[shape].center[a] - chart.point[a]
            bar[a] = (o - d[a] / r * along) / r
            step = d[a] / r - o / tangent
            own[balls + 4 * shape + a] += step
            own[AT_POINT + a] -= step
        own[balls + 4 * shape + 3] += radius / tangent
    elif kind == _EDGE:
        seen_from = False
        column = plane_columns(view) + 4 * shape
        for a in range(3):
            bar[a] = view.sides[shape].up[a]
            own[column + a] += d[a] + chart.point[a] if a < 2 else 0.0
        own[column + 3] -= 1.0
    elif kind == _BALL:
        seen_from = False
        for a in range(3):
            o = (d[a] + chart.point[a] if a < 2 else 0.0) - view.spheres[shape].center[a]
            bar[a] = 2.0 * o
            own[balls + 4 * shape + a] -= 2.0 * o
        own[balls + 4 * shape + 3] -= 2.0 * view.spheres[shape].radius
    else:
        seen_from = False
        q, radius = view.points[light], view.spheres[shape].radius
        ux, uy, uz = x + chart.point[0] - q.position[0], y + chart.point[1] - q.position[1], -q.position[2]
        gx, gy, gz = (
            view.spheres[shape].center[0] - q.position[0],
            view.spheres[shape].center[1] - q.position[1],
            view.spheres[shape].center[2] - q.position[2],
        )
        zx, zy, zz = uy * gz - uz * gy, uz * gx - ux * gz, ux * gy - uy * gx
        bar[0] = 2.0 * (radius * radius * ux - (gy * zz - gz * zy))
        bar[1] = 2.0 * (radius * radius * uy - (gz * zx - gx * zz))
        bar[2] = 2.0 * (radius * radius * uz - (gx * zy - gy * zx))
        by_g = (-2.0 * (zy * uz - zz * uy), -2.0 * (zz * ux - zx * uz), -2.0 * (zx * uy - zy * ux))
        for a in range(3):
            own[balls + 4 * shape + a] += by_g[a]
            own[LIGHTS + 6 * light + a] -= bar[a] + by_g[a]
        own[balls + 4 * shape + 3] += 2.0 * radius * (ux * ux + uy * uy + uz * uz)
    if seen_from:
        for a in range(3):
            own[AT_POINT + a] -= bar[a]


@jitable
def ride(weight: float, qx: float, qy: float, bar: Array, floor: Floor, out: Array) -> None:
    """Add what the checker's own motion does to a function of Q with gradient ``bar``."""
    cell = floor.cell
    along = bar[0] * (qx - floor.offset[0]) + bar[1] * (qy - floor.offset[1])
    out[GRID] += weight * along / cell
    out[GRID + 1] += weight * bar[0]
    out[GRID + 2] += weight * bar[1]


@jitable
def level_adjoint(origin: Origin, x: float, y: float, on: Charted, bar: Array) -> None:
    """Gradient of a conic's level at (x, y) from the foot: ``bar`` (3,) in Q, all that moves it in ``own``.

    The place rides with the checker.
    """
    point, own = on.work.chart.point, on.tangent.own
    clear_columns(own)
    conic_gradient(origin, x, y, on, bar)
    ride(1.0, point[0] + x, point[1] + y, bar, on.world.floor, own)
