"""The adjoint of one node of the checkered floor, which rides with its square."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.conic_slopes import ride
from symrender.adjoint.disk import disk_adjoint, disk_gradient
from symrender.adjoint.lobe import add_own, log_density_at, pull
from symrender.adjoint.sums import clear
from symrender.adjoint.walls import AT_POINT, AXIS, BRIGHT, DARK, GRID, LIGHTS, SHADING
from symrender.adjoint.work import Charted, GridWork
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import Chart
from symrender.jit.marks import inlined, jitable
from symrender.leaves import slopes, values
from symrender.quadrature.disk_term import disk_term

Array = npt.NDArray[np.float64]


@jitable
def grid_density(x: float, y: float, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """Lobe density times solid angle per floor area, cos(theta) and its logarithm, at (x, y) from the foot."""
    wx, wy, wz, measure = values.floor_seen(x, y, chart.height)
    square = values.lobe_chord(wx, wy, wz, lobe[0], lobe[1], lobe[2])
    cosine, log, density = log_density_at(0.5 * square, chart.lobe)
    return density * measure, cosine, log


@inlined
def lit_sum(x: float, y: float, step: int, states: Array, on: Charted, out: Array) -> None:
    """Sum over the lit lights of colour times cosine; ``out`` (3,)."""
    view, work = on.world, on.work
    chart = work.chart
    out[0] = out[1] = out[2] = 0.0
    for i in range(view.points.shape[0]):
        if states[i] == 0.0:
            continue
        p = view.points[i]
        qx, qy = chart.point[0] + x, chart.point[1] + y
        lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2]
        cosine = values.lambert(lx, ly, lz, 0.0, 0.0, 1.0)
        if on.disk is not None and p.radius > 0.0:
            place = LitPoint(qx, qy, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
            cosine, _ = disk_term(i, int(states[i]), place, step, False, view, work, on.gauss)
        for a in range(3):
            out[a] += p.color[a] * cosine


@inlined
def lit_adjoint(
    i: int, qx: float, qy: float, w: float, step: int, on: Charted, grid: GridWork, adjoint: Array
) -> None:  # fmt: skip
    """Add what light ``i`` gives a floor node of weight ``w`` to the adjoint, to ``here`` and to ``pulls``."""
    view, half, total, pulls = on.world, grid.half, grid.here, grid.pulls
    p = view.points[i]
    if on.disk is not None and p.radius > 0.0:
        q = LitPoint(qx, qy, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
        mean, _, _ = disk_gradient(i, int(grid.above[i]), q, step, False, view, on.work, on.gauss, on.disk)
        for a in range(3):
            total[a] += p.color[a] * mean
            adjoint[a, LIGHTS + 6 * i + 3 + a] += w * half[a] * mean
            clear(grid.node)
            disk_adjoint(i, w * half[a] * p.color[a], 0.0, view, on.work, on.disk, grid.node, adjoint[a])
            pulls[a, 0] += grid.node[0, 0]
            pulls[a, 1] += grid.node[0, 1]
        return
    lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2]
    cos_l, gx, gy, gz, _, _, _ = slopes.lambert_slopes(lx, ly, lz, 0.0, 0.0, 1.0)
    for a in range(3):
        total[a] += p.color[a] * cos_l
        share = w * half[a] * p.color[a]
        pulls[a, 0] -= share * gx
        pulls[a, 1] -= share * gy
    if on.lights:
        column = LIGHTS + 6 * i
        for a in range(3):
            share = w * half[a] * p.color[a]
            adjoint[a, column] += share * gx
            adjoint[a, column + 1] += share * gy
            adjoint[a, column + 2] += share * gz
            adjoint[a, column + 3 + a] += w * half[a] * cos_l


@inlined
def grid_node(
    x: float, y: float, weight: float, step: int, on: Charted, grid: GridWork, adjoint: Array
) -> None:  # fmt: skip
    """Add one floor node, lit as ``above`` tells, to the adjoint; ``weight`` has the sign of its square."""
    lobe, floor, shading = on.lobe, on.world.floor, on.world.shading
    half, total, bar, pulls = grid.half, grid.here, grid.bar, grid.pulls
    chart = on.work.chart
    h = chart.height
    density, cosine, log = grid_density(x, y, lobe, chart)
    if density == 0.0:
        return
    w = weight * density
    total[0] = total[1] = total[2] = 0.0
    clear(pulls)
    qx, qy = chart.point[0] + x, chart.point[1] + y
    for i in range(on.world.points.shape[0]):
        if grid.above[i] != 0.0:
            lit_adjoint(i, qx, qy, w, step, on, grid, adjoint)
    near = 1.0 / math.sqrt(x * x + y * y + h * h)
    ux, uy, uz = x * near, y * near, -h * near
    # by d = Q - P: through the density, and through |d_z| / r^3
    steep = pull(1.0, cosine, chart.lobe)
    fall = steep * cosine + 3.0
    dx, dy = (steep * lobe[0] - fall * ux) * near, (steep * lobe[1] - fall * uy) * near
    dz = (steep * lobe[2] - fall * uz) * near - 1.0 / h
    for a in range(3):
        out = adjoint[a]
        value = w * total[a]
        g = value * half[a]
        out[SHADING + 1] += 0.5 * value * (floor.bright[a] - floor.dark[a])
        out[BRIGHT + a] += 0.5 * value * shading.kd
        out[DARK + a] -= 0.5 * value * shading.kd
        drawn = g * steep
        bx, by, bz = g * dx, g * dy, g * dz
        out[AT_POINT] -= bx
        out[AT_POINT + 1] -= by
        out[AT_POINT + 2] -= bz
        out[AXIS] += drawn * ux
        out[AXIS + 1] += drawn * uy
        out[AXIS + 2] += drawn * uz
        add_own(g, log, out)
        bar[0], bar[1], bar[2] = bx + pulls[a, 0], by + pulls[a, 1], 0.0
        ride(1.0, qx, qy, bar, floor, out)
        out[GRID] += 2.0 * g / floor.cell
