"""A mirror's view of the scene: the radiance along one direction, by the same nodes and labels as lobes.

It is what a lobe without width sees, and what a lobe narrower than any arithmetic is measured by.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.labels import light_state, texture_side
from symrender.chambers.lobes.setup import mirror_setup
from symrender.chambers.place import surface_point
from symrender.chambers.records import NODES, Chart
from symrender.chambers.rooms import height
from symrender.chambers.work import Frames, View, Work
from symrender.jit.marks import inlined, jitable
from symrender.leaves.values import floor_phases
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.split_line import place_nodes, shade_nodes, shape_nodes
from symrender.quadrature.split_setup import stand_in_frame
from symrender.scene.arrays import BRDF_NORMALISED, SOLID, STRIPES

Array = npt.NDArray[np.float64]

NARROWEST = 1e-6
"""Half-angle below which a lobe is a mirror up to what a lobe of this half-angle differs from one."""
FINEST = len(LEVELS) - 1
COARSER = FINEST - 2
"""Steps of the rules over disk lights, of which the finer counts and the coarser tells its error."""


@jitable
def first_hit(own: int, lobe: Array, view: View, chart: Chart) -> int:
    """What the direction ``lobe`` meets first from P: a sphere's index, of plane k -2 - k, and -1 for nothing.

    ``own`` is the sphere the point lies on, any other number if there is none.
    """
    nearest, found = math.inf, -1
    for j in range(view.spheres.shape[0]):
        if j == own:
            continue
        s = view.spheres[j]
        fx, fy, fz = chart.point[0] - s.center[0], chart.point[1] - s.center[1], chart.point[2] - s.center[2]
        b = -(fx * lobe[0] + fy * lobe[1] + fz * lobe[2])
        if b <= 0.0:
            continue
        ax, ay, az = fx + b * lobe[0], fy + b * lobe[1], fz + b * lobe[2]
        square = s.radius * s.radius - (ax * ax + ay * ay + az * az)
        if square < 0.0:
            continue
        # the nearer root as c/q, without cancellation
        t = (fx * fx + fy * fy + fz * fz - s.radius * s.radius) / (b + math.sqrt(square))
        if 0.0 < t < nearest:
            nearest, found = t, j
    for k in range(view.sides.shape[0]):
        up = view.sides[k].up
        above = height(view.sides[k], chart.point[0], chart.point[1], chart.point[2])
        rate = up[0] * lobe[0] + up[1] * lobe[1] + up[2] * lobe[2]
        if k != chart.home and above * rate < 0.0 and -above / rate < nearest:
            nearest, found = -above / rate, -2 - k
    return found


@inlined
def floor_albedo(x: float, y: float, view: View, out: Array) -> None:
    """Albedo of the floor at (x, y) into ``out``."""
    bright = True
    if view.floor.kind != SOLID:
        east, north = floor_phases(x, y, view.floor.cell, view.floor.offset[0], view.floor.offset[1])
        bright = (math.floor(east) + (0 if view.floor.kind == STRIPES else math.floor(north))) % 2 == 0
    for a in range(3):
        out[a] = view.floor.bright[a] if bright else view.floor.dark[a]


@jitable
def mirror_radiance(
    own: int, lobe: Array, view: View, frames: Frames, work: Work, gauss: Array, step: int, room: Array, value: Array
) -> None:  # fmt: skip
    """Radiance along ``lobe`` from the chart's point into ``value`` (3,), times its cosine to the normal in BRDF units.

    The rules over disk lights are those of ``step``. ``room`` (9,) is scratch.
    """
    chart, shading = work.chart, view.shading
    weight = 1.0
    if shading.units == BRDF_NORMALISED:
        weight = lobe[0] * chart.normal[0] + lobe[1] * chart.normal[1] + lobe[2] * chart.normal[2]
    for a in range(3):
        value[a] = weight * shading.background[a]
    j = first_hit(own, lobe, view, chart)
    if j == -1:
        return
    mirror_setup(chart.lobe)
    if j >= 0:
        sphere_chart(j, own, lobe, view, work)
        # the sine of incidence; at the limb rounding may take it beyond 1
        hit_radiance(math.asin(min(1.0, chart.lobe_sin / chart.ratio)), weight, step, view, work, gauss, value)
        return
    k = -2 - j
    for a in range(3):
        room[a], room[3 + a] = chart.point[a], chart.normal[a]
    stand_in_frame(k, room[0:3], room[3:6], lobe, frames, work, room[6:9])
    framed = frames.views[k]
    floor_chart(k, own, room[6:9], framed, work)
    hit_radiance(chart.lobe_beta, weight, step, framed, work, gauss, value)
    for a in range(3):
        chart.point[a], chart.normal[a] = room[a], room[3 + a]


@jitable
def hit_radiance(x: float, weight: float, step: int, view: View, work: Work, gauss: Array, value: Array) -> None:
    """Add to ``value`` what the charted shape has more than the background at inner coordinate x, towards the lobe."""
    chart, shading = work.chart, view.shading
    j, color = chart.shape_index, chart.albedo
    qx, qy, qz, nx, ny, nz = surface_point(x, 1.0, 0.0, chart)
    work.cell_side[0] = 1
    factor = shading.kd
    if j >= 0:
        work.cell_side[0] = texture_side(view.spheres, j, nx, ny, nz)
        if work.cell_side[0] == 0:
            factor *= view.spheres[j].dark
        for a in range(3):
            color[a] = view.spheres[j].color[a]
    else:
        floor_albedo(qx, qy, view, color)
    for l in range(view.points.shape[0]):
        work.lit[0, l] = light_state(l, qx, qy, qz, nx, ny, nz, view, work)
    row = work.pieces[NODES]
    row.cell, row.start, row.stop, row.halvings, row.wary, row.soft = 0, x, x, 0, 0, 0
    place_nodes(0, 0, 1, 1.0, row, color, factor, work, gauss)
    work.counts.evaluations += 1
    work.counts.chambers += 1
    shape_nodes(1, 1.0, 0.0, step, view, work)
    shade_nodes(1, 1, step, view, work, gauss)
    first = 0
    for a in range(3):
        value[a] += weight * work.nodes.radiance[a, first]


@jitable
def mirror_value(
    own: int, lobe: Array, view: View, frames: Frames, work: Work, gauss: Array, room: Array, coarse: Array, value:
    Array
) -> float:  # fmt: skip
    """``mirror_radiance`` by the finest rules into ``value``; how far coarser ones, into ``coarse``, are off."""
    mirror_radiance(own, lobe, view, frames, work, gauss, COARSER, room, coarse)
    mirror_radiance(own, lobe, view, frames, work, gauss, FINEST, room, value)
    return largest_gap(coarse, value)


@inlined
def largest_gap(a: Array, b: Array) -> float:
    """Largest difference of two colours."""
    return float(max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2])))
