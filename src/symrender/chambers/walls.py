"""Walls: the zero sets across which radiance is not smooth, as records a kernel can read.

The visible shape carries polar charts. About a sphere (centre C, radius R, seen from P, c = unit(C - P), k = R/|C - P|)
an azimuth phi and the angle of incidence psi at the hit fix, with beta = asin(k sin psi) and gamma = psi - beta,

    direction  w = cos(beta) c + sin(beta) e(phi),      e(phi) = cos(phi) e1 + sin(phi) e2,
    normal     N = cos(gamma) (-c) + sin(gamma) e(phi).

About the floor the pole c is straight down and the inner coordinate is beta itself. Every circle, on the sphere of
directions or on the sphere of normals, is ``a.x = cos(alpha)`` for a unit axis a; with the axis written in the frame
(pole, e1, e2) its crossing with a scan line phi = const solves A cos x + B sin x = cos(alpha), one square root.

A wall is a record, see ``Wall`` in ``chambers/records.py``.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Chart, Wall
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moves, rising, tangent
from symrender.jit.records import Table

Array = npt.NDArray[np.float64]

DIRECTION: Final = 0
"""A circle of directions: lobe rim, silhouette of an occluder, horizon of the floor chart."""
NORMAL: Final = 1
"""A circle of normals of the visible sphere: terminator, chart line, horizon, the floor's cut, a radical plane."""
SHADOW: Final = 2
"""Shadow edge of a sphere from a light point: a conic on the floor, a quartic on another sphere."""
BALL: Final = 3
"""Where the floor enters a ball: a circle on the floor."""
PENUMBRA: Final = 5
"""An edge of what a sphere hides of a disk light."""
GLEAM_EDGE: Final = 6
"""Where a highlight begins: its base, which is clipped at 0, is 0."""


# tags: which condition a wall belongs to
RIM: Final = 0
HORIZON: Final = 1
SILHOUETTE: Final = 2
TERMINATOR: Final = 3
TEXTURE_EDGE: Final = 4
SHADOW_EDGE: Final = 5
FLOOR_CUT: Final = 6
HIGHLIGHT: Final = 7
SEVERAL: Final = 8
"""Coinciding walls of different conditions, kept as one."""

RIM_ROW: Final = 0
LIMB_ROW: Final = 1
"""Rows of ``Work.circles``: the lobe's rim as a circle of directions, the limb as one of normals."""

# chart: the numbers of one (point, shape) pair
UNBOUNDED: Final = 1e30

CRITICAL: Final = -3
"""In place of a shape: the circle of directions at which a conductor of k = 0 begins to reflect all, like a root."""

PARTED: Final = 1e-9
"""Share of their speeds by which walls that coincide must differ in it to move apart."""
CONTACT: Final = 1e-13
"""A light whose squared distance from a ball's centre differs from the squared radius by less, relative to it, stands
on the ball: what the ball hides of it ends at a plane, and no more at the two branches of a double cone."""

TOUCH: Final = 1e-7
"""A circle of a smaller sine is taken for a place where two shapes touch."""
COINCIDENT: Final = 1e-11
"""Two circles whose axes and levels differ by less are one wall."""


@inlined
def is_rooted(row: Wall) -> bool:
    """Whether what is integrated is a root of the distance from a wall beside it."""
    return bool(row.kind == DIRECTION and row.shape_index == CRITICAL)


@jitable
def tangent_lines(a1: float, a2: float, sine: float) -> tuple[float, float, float]:
    """Scan lines that a circle touches: (azimuth of its axis, offset, depth).

    They have the azimuths axis +- offset and axis +- (pi - offset), give or take i depth; a depth of inf means none.
    """
    rho = math.sqrt(a1 * a1 + a2 * a2)
    if rho == 0.0:
        return 0.0, 0.0, math.inf
    ratio, middle = sine / rho, math.atan2(a2, a1)
    if abs(ratio - 1.0) < 1e-12:
        # a circle through the pole lies along a scan line: an end of panels, where no root branches
        return middle, math.asin(min(1.0, ratio)), math.inf
    if ratio >= 1.0:
        return middle, 0.5 * math.pi, math.log(ratio + math.sqrt(ratio * ratio - 1.0))
    return middle, math.asin(ratio), 0.0


@inlined
def part_ways(row: Wall, a0: float, a1: float, a2: float, cosine: float, sign: float) -> int:
    """Whether a circle that coincides with that of ``row``, of the opposite axis where ``sign`` is -1, moves off it.

    A bit a tangent.
    """
    apart, size = 0.0, abs(tangent(row.cos)) + abs(tangent(cosine))
    apart += abs(tangent(row.cos) - sign * tangent(cosine))
    for i in range(3):
        other = a0 if i == 0 else a1 if i == 1 else a2
        apart += abs(tangent(row.axis[i]) - sign * tangent(other))
        size += abs(tangent(row.axis[i])) + abs(tangent(other))
    return rising(apart - PARTED * size)


@jitable
def add_circle(
    walls: Table[Wall], count: int, kind: int, a0: float, a1: float, a2: float, cosine: float, tag: int, shape: int
) -> int:
    """Append the circle a.x = cosine (unit axis in the chart frame) unless it is there already; new count.

    A full table is told by a count beyond its length; the caller gives the point up as capped.
    """
    sine = math.sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine)))
    if moves(cosine) and sine < TOUCH:
        # a shape that touches a plane: what the circle bounds is seen at the limb alone
        cosine, sine = held(cosine), held(sine)
    for i in range(min(count, walls.shape[0])):
        if walls[i].kind == kind:
            same = (
                abs(walls[i].axis[0] - a0)
                + abs(walls[i].axis[1] - a1)
                + abs(walls[i].axis[2] - a2)
                + abs(walls[i].cos - cosine)
            )
            flipped = (
                abs(walls[i].axis[0] + a0)
                + abs(walls[i].axis[1] + a1)
                + abs(walls[i].axis[2] + a2)
                + abs(walls[i].cos + cosine)
            )
            if min(same, flipped) < 1e-11:
                if walls[i].tag != tag or walls[i].shape_index != shape:
                    walls[i].tag = SEVERAL
                if moves(cosine):
                    walls[i].parted |= part_ways(walls[i], a0, a1, a2, cosine, 1.0 if same <= flipped else -1.0)
                return count
    if count < walls.shape[0]:
        walls[count].kind = kind
        walls[count].axis[0] = a0
        walls[count].axis[1] = a1
        walls[count].axis[2] = a2
        walls[count].cos = cosine
        walls[count].sin = sine
        walls[count].tag = tag
        walls[count].shape_index = shape
        walls[count].met = walls[count].parted = 0
    return count + 1


@jitable
def add_contact(
    walls: Table[Wall], count: int, chart: Chart, ux: float, uy: float, uz: float, ex: float, ey: float, ez: float,
    shape: int, light: int,
) -> int:  # fmt: skip
    """Append the plane e.(x - L) = 0, behind which a light on a ball's surface is hidden by it; new count.

    ``u`` as of ``add_shadow``, ``e`` the unit direction from the light to the ball's centre. On a sphere the plane cuts
    a circle of normals, on the floor a line, which P sees along a great circle.
    """
    p, f, g = chart.pole, chart.e1, chart.e2
    level = ex * ux + ey * uy + ez * uz
    a0 = ex * p[0] + ey * p[1] + ez * p[2]
    a1 = ex * f[0] + ey * f[1] + ez * f[2]
    a2 = ex * g[0] + ey * g[1] + ez * g[2]
    found = count
    if chart.shape_index >= 0.0:
        if abs(level) < chart.radius:
            found = add_circle(walls, count, NORMAL, -a0, a1, a2, -level / chart.radius, SHADOW_EDGE, shape)
    else:
        h = chart.height
        size = math.sqrt(level * level + h * h * (a1 * a1 + a2 * a2))
        if size > 0.0:
            found = add_circle(
                walls, count, DIRECTION, level / size, h * a1 / size, h * a2 / size, 0.0, SHADOW_EDGE, shape
            )
    if count < found <= walls.shape[0]:
        walls[count].light = light
    return found


@jitable
def add_shadow(
    walls: Table[Wall],
    count: int,
    chart: Chart,
    ux: float,
    uy: float,
    uz: float,
    gx: float,
    gy: float,
    gz: float,
    radius: float,
    shape: int,
    light: int,
) -> int:
    """Append the shadow edge of one sphere from one light point, as seen on the charted shape; new count.

    ``u`` is the chart's origin (sphere centre, or foot of P on the floor) minus the light point, ``g`` the same origin
    minus the occluder's centre. With e = unit(occluder - light) and sin(a) = radius/distance the edge is
    sin^2(a) |x - L|^2 = |(x - C_k) x e|^2: both sides are free of cancellation for small and for distant occluders.
    ``first`` and ``second`` hold f.(pole, e1, e2) and their levels f.g for two unit vectors f across e, ``origin``
    u.(pole, e1, e2).
    """
    if count >= walls.shape[0]:
        return count + 1
    ex, ey, ez = ux - gx, uy - gy, uz - gz
    dist2 = ex * ex + ey * ey + ez * ez
    if dist2 == 0.0:
        # a light at the occluder's centre: any axis, for there is no edge
        ex, dist2 = 1e-100, 1e-200
    inv = 1.0 / math.sqrt(dist2)
    ex, ey, ez = ex * inv, ey * inv, ez * inv
    if abs(dist2 - radius * radius) < CONTACT * dist2:
        return add_contact(walls, count, chart, ux, uy, uz, ex, ey, ez, shape, light)
    if abs(ex) < 0.6:
        fx, fy, fz = 0.0, ez, -ey
    else:
        fx, fy, fz = -ez, 0.0, ex
    inv = 1.0 / math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx * inv, fy * inv, fz * inv
    hx, hy, hz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    row = walls[count]
    row.kind = SHADOW
    row.tag = SHADOW_EDGE
    row.shape_index = shape
    row.light = light
    row.met = row.parted = 0
    for i in range(3):
        along = chart.pole if i == 0 else chart.e1 if i == 1 else chart.e2
        px, py, pz = along[0], along[1], along[2]
        row.first[i] = fx * px + fy * py + fz * pz
        row.second[i] = hx * px + hy * py + hz * pz
        row.origin[i] = ux * px + uy * py + uz * pz
    row.first_level = fx * gx + fy * gy + fz * gz
    row.second_level = hx * gx + hy * gy + hz * gz
    row.origin2 = ux * ux + uy * uy + uz * uz
    row.sine2 = radius * radius / dist2
    return count + 1
