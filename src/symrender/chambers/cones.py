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
from typing import Final

import numpy as np

from symrender.chambers.caps import Cone
from symrender.chambers.chart import add_direction, add_normal
from symrender.chambers.reach import note_reach
from symrender.chambers.records import DISTANT, LightPoint, Wall
from symrender.chambers.rooms import height
from symrender.chambers.walls import GLEAM_EDGE, HIGHLIGHT, SHADOW, add_shadow
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table, chosen, table
from symrender.scene.arrays import AFAR
from symrender.scene.records import Sphere

NOT_FELT: Final = 1e-9
"""Sine of an angle of a spot that is taken to be no cone, but a line."""
DEGREE: Final = math.pi / 180.0
PARALLEL: Final = 1e-9
"""Sine of the angle below which the cone about two spheres is a cylinder."""


def scene_cones(spheres: Table[Sphere], points: Table[LightPoint], glowing: bool) -> Table[Cone]:
    """All cones of a scene: those of spots, and where it is ``glowing`` those tangent to two of its spheres."""
    rows = table(Cone, most_cones(spheres, points))
    count = lay_cones(spheres, points, glowing, rows)
    return chosen(rows, np.arange(len(rows)) < count)


def most_cones(spheres: Table[Sphere], points: Table[LightPoint]) -> int:
    """As many cones as so many spheres and points can have."""
    return 2 * len(points) + len(spheres) * (len(spheres) - 1)


@jitable
def lay_cones(spheres: Table[Sphere], points: Table[LightPoint], glowing: bool, rows: Table[Cone]) -> int:
    """Fill ``rows`` with the cones of a scene; returns how many there are."""
    count = 0
    for l in range(points.shape[0]):
        spot = points[l]
        for side in range(2 if spot.spot != 0.0 else 0):
            sine = math.sin(DEGREE * (spot.beam if side == 0 else spot.cutoff))
            if sine > NOT_FELT:
                p, a = spot.position, spot.axis
                count = put_cone(rows, count, p[0], p[1], p[2], a[0], a[1], a[2], sine, -1, -1)
    for i in range(spheres.shape[0] if glowing else 0):
        c, r = spheres[i].center, spheres[i].radius
        for k in range(i):
            x, y, z = spheres[k].center[0] - c[0], spheres[k].center[1] - c[1], spheres[k].center[2] - c[2]
            apart = math.sqrt(x * x + y * y + z * z)
            for side in range(2 if apart > 0.0 else 0):
                other = spheres[k].radius if side == 0 else -spheres[k].radius
                sine = (r - other) / apart
                if abs(sine) > 1.0:
                    continue
                u, v, w = x / apart, y / apart, z / apart
                if abs(sine) < PARALLEL:
                    put_cylinder(rows, count, c[0], c[1], c[2], u, v, w, r, i, k)
                    count += 1
                    continue
                # spheres about places of the axis grow from the apex on with the distance from it
                along = r / (r - other)
                ax, ay, az = c[0] + x * along, c[1] + y * along, c[2] + z * along
                count = put_cone(rows, count, ax, ay, az, u, v, w, abs(sine), i, k)
    return count


@jitable
def put_cone(
    rows: Table[Cone], count: int, px: float, py: float, pz: float, ax: float, ay: float, az: float, sine: float,
    one: int, other: int,
) -> int:  # fmt: skip
    """Add the cone about an axis from an apex; a kernel takes numbers, so they are many."""
    row = rows[count]
    row.apex.position[0], row.apex.position[1], row.apex.position[2] = px, py, pz
    row.apex.fall, row.one, row.other = 0.0, 1.0 * one, 1.0 * other
    row.ball.center[0], row.ball.center[1], row.ball.center[2] = px + ax, py + ay, pz + az
    row.twin.center[0], row.twin.center[1], row.twin.center[2] = px - ax, py - ay, pz - az
    row.ball.radius = row.twin.radius = sine
    return count + 1


@jitable
def put_cylinder(
    rows: Table[Cone], count: int, px: float, py: float, pz: float, ax: float, ay: float, az: float, radius: float,
    one: int, other: int,
) -> None:  # fmt: skip
    """The same of a cylinder about an axis through a centre."""
    row = rows[count]
    row.apex.position[0], row.apex.position[1], row.apex.position[2] = AFAR * ax, AFAR * ay, AFAR * az
    row.apex.fall, row.one, row.other = DISTANT, 1.0 * one, 1.0 * other
    row.ball.center[0], row.ball.center[1], row.ball.center[2] = px, py, pz
    row.twin.center[0], row.twin.center[1], row.twin.center[2] = px, py, pz
    row.ball.radius = row.twin.radius = radius


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
    if view.cones is None or (work.chart.shape_index < 0 and work.chart.side < 0.0):
        return
    put_edges(work, view.cones)
    if view.glows is not None:
        put_touches(view, work)
    note_reach(view, work)


@jitable
def put_edges(work: Work, cones: Table[Cone] | None) -> None:
    """Append where a chart meets the cones."""
    if cones is None:
        return
    chart, walls = work.chart, work.walls
    sphere = chart.shape_index >= 0
    for c in range(cones.shape[0]):
        cone = cones[c]
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


@jitable
def put_touches(view: View, work: Work) -> None:
    """Append where spheres touch the horizons of places of the chart, and where they touch planes seen from there.

    Of a sphere, too, where three horizons meet in one direction, its own and those of two planes: N.(u x v) = 0.
    """
    chart, walls, counts = work.chart, work.walls, work.counts
    j, radius = chart.shape_index, chart.radius
    for k in range(view.sides.shape[0] if j >= 0 else 0):
        u = view.sides[k].up
        for l in range(k):
            v = view.sides[l].up
            x, y, z = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
            size = math.sqrt(x * x + y * y + z * z)
            if size > 0.0:
                add_normal(walls, counts, chart, x / size, y / size, z / size, 0.0, HIGHLIGHT, -1)
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
