"""A mirror's view of the scene: the radiance along one direction, by the same nodes and labels as lobes.

It is what a lobe without width sees, and what a lobe narrower than any arithmetic is measured by.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.labels import light_state, texture_side
from symrender.chambers.place import surface_point
from symrender.chambers.walls import (
    EXPONENT,
    FACING,
    LOBE_BETA,
    LOG_NORMALISER,
    POINT,
    RATIO,
    STRIP,
    SURFACE_NORMAL,
)
from symrender.chambers.work import CHAMBERS, EVALUATIONS, NODES, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.node_rows import SUM
from symrender.quadrature.split_line import HALVINGS, SOFT, START, STOP, WARY, place_nodes, shade_nodes, shape_nodes
from symrender.scene.arrays import (
    BRDF_NORMALISED,
    CHECKER,
    FLOOR_BRIGHT,
    FLOOR_CELL,
    FLOOR_DARK,
    FLOOR_KIND,
    FLOOR_OFFSET,
    FLOOR_PRESENT,
    UNITS,
)

Array = npt.NDArray[np.float64]

NARROWEST = 1e-6
"""Half-angle below which a lobe is a mirror up to what a lobe of this half-angle differs from one."""
FINEST = len(LEVELS) - 1
COARSER = FINEST - 2
"""Steps of the rules over disk lights, of which the finer counts and the coarser tells its error."""


@jitable
def first_hit(own: int, lobe: Array, view: View, geo: Array) -> int:
    """What the direction ``lobe`` from geo's point meets first: a sphere's index, -1 for the floor, -2 for nothing.

    ``own`` is the sphere the point lies on, -1 if that is the floor.
    """
    nearest, found = math.inf, -2
    for j in range(view.spheres.shape[0]):
        if j == own:
            continue
        s = view.spheres[j]
        fx, fy, fz = geo[POINT] - s[0], geo[POINT + 1] - s[1], geo[POINT + 2] - s[2]
        b = -(fx * lobe[0] + fy * lobe[1] + fz * lobe[2])
        if b <= 0.0:
            continue
        ax, ay, az = fx + b * lobe[0], fy + b * lobe[1], fz + b * lobe[2]
        square = s[3] * s[3] - (ax * ax + ay * ay + az * az)
        if square < 0.0:
            continue
        # the nearer root as c/q, without cancellation
        t = (fx * fx + fy * fy + fz * fz - s[3] * s[3]) / (b + math.sqrt(square))
        if 0.0 < t < nearest:
            nearest, found = t, j
    if view.floor[FLOOR_PRESENT] != 0.0 and own >= 0 and geo[POINT + 2] * lobe[2] < 0.0:
        t = -geo[POINT + 2] / lobe[2]
        if t < nearest:
            found = -1
    return found


@inlined
def floor_albedo(x: float, y: float, view: View, out: Array) -> None:
    """Albedo of the floor at (x, y) into ``out``."""
    bright = True
    if view.floor[FLOOR_KIND] == CHECKER:
        cell = view.floor[FLOOR_CELL]
        east, north = x - view.floor[FLOOR_OFFSET], y - view.floor[FLOOR_OFFSET + 1]
        bright = (math.floor(east / cell) + math.floor(north / cell)) % 2 == 0
    for a in range(3):
        out[a] = view.floor[FLOOR_BRIGHT + a] if bright else view.floor[FLOOR_DARK + a]


@jitable
def mirror_radiance(own: int, lobe: Array, view: View, work: Work, gauss: Array, step: int, value: Array) -> None:
    """Radiance along ``lobe`` from geo's point into ``value`` (3,), times its cosine to the normal in BRDF units.

    The rules over disk lights are those of ``step``.
    """
    geo, shading = work.geo, view.shading
    weight = 1.0
    if shading[UNITS] == BRDF_NORMALISED:
        weight = lobe[0] * geo[SURFACE_NORMAL] + lobe[1] * geo[SURFACE_NORMAL + 1] + lobe[2] * geo[SURFACE_NORMAL + 2]
    for a in range(3):
        value[a] = weight * shading[10 + a]
    j = first_hit(own, lobe, view, geo)
    if j == -2 or (j == -1 and geo[POINT + 2] == 0.0):
        return
    geo[EXPONENT] = geo[LOG_NORMALISER] = 0.0
    geo[FACING] = geo[FACING + 1] = geo[FACING + 2] = 0.0
    geo[FACING + 3] = 1.0
    color = geo[STRIP + 3 : STRIP + 6]
    if j >= 0:
        sphere_chart(j, own, lobe, view, work)
        # the sine of incidence; at the limb rounding may take it beyond 1
        x = math.asin(min(1.0, geo[LOBE_BETA + 2] / geo[RATIO]))
    else:
        floor_chart(own, lobe, view, work)
        x = geo[LOBE_BETA]
    qx, qy, qz, nx, ny, nz = surface_point(x, 1.0, 0.0, geo)
    work.cell_side[0] = 1
    factor = shading[1]
    if j >= 0:
        work.cell_side[0] = texture_side(view.spheres, j, nx, ny, nz)
        if work.cell_side[0] == 0:
            factor *= view.spheres[j, 10]
        for a in range(3):
            color[a] = view.spheres[j, 4 + a]
    else:
        floor_albedo(qx, qy, view, color)
    for l in range(view.points.shape[0]):
        work.lit[0, l] = light_state(l, qx, qy, qz, nx, ny, nz, view, work)
    row = work.pieces[NODES]
    row[0], row[START], row[STOP], row[HALVINGS], row[WARY], row[SOFT] = 0.0, x, x, 0.0, 0.0, 0.0
    place_nodes(0, 0, 1, 1.0, row, color, factor, work, gauss)
    work.counts[EVALUATIONS] += 1
    work.counts[CHAMBERS] += 1
    shape_nodes(1, 1.0, 0.0, step, view, work)
    shade_nodes(1, 1, step, view, work, gauss)
    for a in range(3):
        value[a] += weight * work.nodes[SUM + a * NODES]


@jitable
def mirror_value(own: int, lobe: Array, view: View, work: Work, gauss: Array, coarse: Array, value: Array) -> float:
    """``mirror_radiance`` by the finest rules into ``value``; how far coarser ones, into ``coarse``, are off."""
    mirror_radiance(own, lobe, view, work, gauss, COARSER, coarse)
    mirror_radiance(own, lobe, view, work, gauss, FINEST, value)
    return largest_gap(coarse, value)


@inlined
def largest_gap(a: Array, b: Array) -> float:
    """Largest difference of two colours."""
    return float(max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2])))
