"""Where on a shape the light that arrives is not smooth though all of it arrives: cones of spots, caps that touch.

A spot changes at the cones of its two angles. Of a sky, or of a sphere that emits, a place sees what caps leave: the
horizon, planes, spheres. What arrives is smooth but where two of these circles touch, and all ways in which they can
are three: of two spheres, on a cone tangent to both, from without or from within (a cylinder where they are equal); of
a sphere and the horizon of the place, a circle of normals; of a sphere and a plane, another plane. Beyond such a touch
what is seen grows with the power 3/2 of the distance. Where three circles meet in one direction, what arrives has a
jump in its second derivative, which is left to the coefficients.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.caps import Cone
from symrender.chambers.chart import add_direction, add_normal
from symrender.chambers.reach import note_reach
from symrender.chambers.records import DISTANT, LightPoint, Wall
from symrender.chambers.rooms import height
from symrender.chambers.walls import GLEAM_EDGE, HIGHLIGHT, SHADOW, add_shadow
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table, joined, table
from symrender.scene.arrays import AFAR
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

NOT_FELT: Final = 1e-9
"""Sine of an angle of a spot that is taken to be no cone, but a line."""
PARALLEL: Final = 1e-9
"""Sine of the angle below which the cone about two spheres is a cylinder."""


def scene_cones(spheres: Table[Sphere], points: Table[LightPoint], glowing: bool) -> Table[Cone]:
    """All cones of a scene: those of spots, and where it is ``glowing`` those tangent to two of its spheres."""
    rows = [*_spot_cones(points), *(_pair_cones(spheres) if glowing else ())]
    return joined(Cone, rows)


def _spot_cones(points: Table[LightPoint]) -> Iterator[Table[Cone]]:
    for point in points:
        for degrees in (point.beam, point.cutoff) if point.spot else ():
            sine = math.sin(math.radians(float(degrees)))
            if sine > NOT_FELT:
                yield _cone(np.array(point.position), np.array(point.axis), sine, -1, -1)


def _pair_cones(spheres: Table[Sphere]) -> Iterator[Table[Cone]]:
    for i, first in enumerate(spheres):
        for k in range(i):
            way = np.array(spheres[k].center) - first.center
            apart, r, s = float(np.sqrt(way @ way)), float(first.radius), float(spheres[k].radius)
            for other in (s, -s):
                sine = (r - other) / apart if apart > 0.0 else math.inf
                if abs(sine) > 1.0:
                    continue
                if abs(sine) < PARALLEL:
                    yield _cylinder(np.array(first.center), way / apart, r, i, k)
                else:
                    # spheres about places of the axis grow from the apex on with the distance from it
                    apex = np.array(first.center) + way * (r / (r - other))
                    yield _cone(apex, way / apart, abs(sine), i, k)


def _cone(apex: Array, axis: Array, sine: float, one: int, other: int) -> Table[Cone]:
    rows = table(Cone, 1)
    row = rows[0]
    row.apex.position[:], row.one, row.other = apex, one, other
    row.ball.center[:], row.twin.center[:] = apex + axis, apex - axis
    row.ball.radius = row.twin.radius = sine
    return rows


def _cylinder(center: Array, axis: Array, radius: float, one: int, other: int) -> Table[Cone]:
    rows = table(Cone, 1)
    row = rows[0]
    row.apex.position[:], row.apex.fall, row.one, row.other = AFAR * axis, DISTANT, one, other
    for ball in (row.ball, row.twin):
        ball.center[:], ball.radius = center, radius
    return rows


@inlined
def is_cone(row: Wall) -> bool:
    """Whether a wall is that of a ``Cone``, whose number is its ``light``."""
    return bool(row.kind == SHADOW and row.tag == HIGHLIGHT)


@inlined
def is_touch(wall: int, view: View, work: Work) -> bool:
    """Whether a wall is one beyond which what is seen of a sky or a lamp grows with the power 3/2 of the distance."""
    found = False
    if view.glows is not None and wall >= 0:
        row = work.walls[wall // 4]
        found = row.tag == HIGHLIGHT and row.kind != GLEAM_EDGE
    return found


@jitable
def put_cones(view: View, work: Work) -> None:
    """Append to the walls of a chart all that this module is about."""
    if view.cones is None:
        return
    chart, walls = work.chart, work.walls
    sphere = chart.shape_index >= 0
    if not sphere and chart.side < 0.0:
        return
    for c in range(view.cones.shape[0]):
        cone = view.cones[c]
        if sphere and (cone.one == chart.shape_index or cone.other == chart.shape_index):
            continue
        at, ball = cone.apex.position, cone.ball.center
        if sphere:
            x, y, z = chart.center[0], chart.center[1], chart.center[2]
        else:
            x, y, z = chart.point[0], chart.point[1], 0.0
        before = work.counts.walls
        work.counts.walls = add_shadow(
            walls, before, chart, x - at[0], y - at[1], z - at[2], x - ball[0], y - ball[1], z - ball[2],
            cone.ball.radius, -1, c,
        )  # fmt: skip
        if before < work.counts.walls <= walls.shape[0]:
            walls[before].tag, walls[before].light = HIGHLIGHT, c
    if view.glows is not None:
        put_touches(view, work)
    note_reach(view, work)


@jitable
def put_touches(view: View, work: Work) -> None:
    """Append where spheres touch the horizons of places of the chart, and where they touch planes seen from there."""
    chart, walls, counts = work.chart, work.walls, work.counts
    j, radius = chart.shape_index, chart.radius
    for i in range(view.spheres.shape[0]):
        if i == j:
            continue
        s = view.spheres[i]
        x, y, z = s.center[0] - chart.center[0], s.center[1] - chart.center[1], s.center[2] - chart.center[2]
        far = math.sqrt(x * x + y * y + z * z)
        for side in range(2):
            r = s.radius if side == 0 else -s.radius
            if j >= 0 and far > 0.0:
                add_normal(walls, counts, chart, x / far, y / far, z / far, (radius + r) / far, HIGHLIGHT, -1)
            for k in range(view.sides.shape[0]):
                if k == chart.plane:
                    continue
                up = view.sides[k].up
                level = height(view.sides[k], s.center[0], s.center[1], s.center[2]) + r
                if j >= 0:
                    here = height(view.sides[k], chart.center[0], chart.center[1], chart.center[2])
                    add_normal(walls, counts, chart, up[0], up[1], up[2], (level - here) / radius, HIGHLIGHT, -1)
                    continue
                # the line of that height over plane k lies in a plane through P
                pz = chart.point[2]
                above = height(view.sides[k], chart.point[0], chart.point[1], pz) - level
                a, b, c = -pz * up[0], -pz * up[1], above - pz * up[2]
                if math.hypot(a, b) > 0.0:
                    size = math.sqrt(a * a + b * b + c * c)
                    add_direction(walls, counts, chart, a / size, b / size, c / size, 0.0, HIGHLIGHT, -1)
