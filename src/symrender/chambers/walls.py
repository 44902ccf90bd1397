"""Walls: the zero sets across which radiance is not smooth, as rows of numbers a kernel can read.

The visible shape carries polar charts. About a sphere (centre C, radius R, seen from P, c = unit(C - P), k = R/|C - P|)
an azimuth phi and the angle of incidence psi at the hit fix, with beta = asin(k sin psi) and gamma = psi - beta,

    direction  w = cos(beta) c + sin(beta) e(phi),      e(phi) = cos(phi) e1 + sin(phi) e2,
    normal     N = cos(gamma) (-c) + sin(gamma) e(phi).

About the floor the pole c is straight down and the inner coordinate is beta itself. Every circle, on the sphere of
directions or on the sphere of normals, is ``a.x = cos(alpha)`` for a unit axis a; with the axis written in the frame
(pole, e1, e2) its crossing with a scan line phi = const solves A cos x + B sin x = cos(alpha), one square root.

A row of the wall table is ``kind, a0, a1, a2, cos(alpha), sin(alpha), tag, shape``; a shadow edge has its own columns
(see ``shadow_row``).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.kernel_cache import jitable

Array = npt.NDArray[np.float64]

DIRECTION: Final = 0
"""A circle of directions: lobe rim, silhouette of an occluder, horizon of the floor chart."""
NORMAL: Final = 1
"""A circle of normals of the visible sphere: terminator, chart line, horizon, the floor's cut, a radical plane."""
SHADOW: Final = 2
"""Shadow edge of a sphere from a light point: a conic on the floor, a quartic on another sphere."""
BALL: Final = 3
"""Where the floor enters a ball: a circle on the floor."""
FLOOR_LINE: Final = 4
"""Straight line on the floor."""
PENUMBRA: Final = 5
"""An edge of what a sphere hides of a disk light; columns as in ``chambers/penumbra_walls.py``."""
GLEAM_EDGE: Final = 6
"""Where a highlight begins: its base, which is clipped at 0, is 0. Columns 8.. hold the light point, the viewer's place
and 1 for Phong's base."""
WALL_COLUMNS: Final = 45

KIND: Final = 0
AXIS: Final = 1
COS: Final = 4
SIN: Final = 5
TAG: Final = 6
SHAPE: Final = 7

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
MET_COLUMN: Final = 22
"""Column that is 1 once a scan line met the wall inside the lobe."""
TANGENT: Final = 8
"""First of three columns of a circle, filled by ``chart_events``: what ``tangent_lines`` says of it."""
LIGHT: Final = 21
"""Column of a shadow edge that names its light point."""

# geo: the numbers of one (point, shape) pair
POINT: Final = 0
POLE: Final = 3
E1: Final = 6
E2: Final = 9
CENTER: Final = 12
RADIUS: Final = 15
RATIO: Final = 16
"""k = R/|C - P|, the sine of the shape's angular radius."""
BETA_MAX: Final = 17
GAMMA_MAX: Final = 18
LOBE_BETA: Final = 19
"""Angle from the pole to the lobe's axis, which lies at phi = 0; then its cosine and sine."""
RIM_COS: Final = 22
RIM_SIN: Final = 23
SURFACE_NORMAL: Final = 24
SIDE: Final = 27
"""+1 where the point is on or above the floor, -1 below it."""
EXPONENT: Final = 28
LOG_NORMALISER: Final = 29
HEIGHT: Final = 30
SHAPE_INDEX: Final = 31
STRIP: Final = 32
"""Half-width of the strip of analyticity used for node counts along a line, then across lines."""
LIMB_TANGENT: Final = 38
"""tan of half the limb's angle at the centre, tan(gamma_max/2)."""
LENS_COS: Final = 40
"""Cosine and sine of the angle, from the visible pole towards the lobe, to the middle of a circle of normals that holds
all of the shape inside the lobe; then the cosine of that circle's radius."""
BRIGHT: Final = 39
"""No radiance of the charted shape differs from the background by more; UNBOUNDED if nobody asked."""
UNBOUNDED: Final = 1e30
FACING: Final = 43
"""A vector, then a number: every direction w of the lobe counts with the number plus the vector times w."""
LEAST: Final = 47
"""No highlight that can hold less than this of a lobe is looked for."""
CLIPPED: Final = 48
"""1 where highlights begin at walls of their own: a line may then see none beside one that does."""
PACE: Final = 49
"""How much faster than values a derivative of the chart may change with what is left out; 1 for values."""
GEO_COLUMNS: Final = 50

COINCIDENT: Final = 1e-11
"""Two circles whose axes and levels differ by less are one wall."""


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


@jitable
def add_circle(
    walls: Array, count: int, kind: int, a0: float, a1: float, a2: float, cosine: float, tag: int, shape: int
) -> int:
    """Append the circle a.x = cosine (unit axis in the chart frame) unless it is there already; new count.

    A full table is told by a count beyond its length; the caller gives the point up as capped.
    """
    sine = math.sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine)))
    for i in range(min(count, walls.shape[0])):
        if walls[i, 0] == kind:
            same = abs(walls[i, 1] - a0) + abs(walls[i, 2] - a1) + abs(walls[i, 3] - a2) + abs(walls[i, 4] - cosine)
            flipped = abs(walls[i, 1] + a0) + abs(walls[i, 2] + a1) + abs(walls[i, 3] + a2) + abs(walls[i, 4] + cosine)
            if min(same, flipped) < 1e-11:
                if walls[i, 6] != tag or walls[i, 7] != shape:
                    walls[i, 6] = SEVERAL
                return count
    if count < walls.shape[0]:
        walls[count, 0] = kind
        walls[count, 1] = a0
        walls[count, 2] = a1
        walls[count, 3] = a2
        walls[count, 4] = cosine
        walls[count, 5] = sine
        walls[count, 6] = tag
        walls[count, 7] = shape
        walls[count, MET_COLUMN] = 0.0
    return count + 1


@jitable
def add_shadow(
    walls: Array,
    count: int,
    geo: Array,
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
    Columns 8.. hold f.(pole, e1, e2) and f.g for two unit vectors f across e, then u.(pole, e1, e2), |u|^2, sin^2(a).
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
    if abs(ex) < 0.6:
        fx, fy, fz = 0.0, ez, -ey
    else:
        fx, fy, fz = -ez, 0.0, ex
    inv = 1.0 / math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx * inv, fy * inv, fz * inv
    hx, hy, hz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    row = walls[count]
    row[0] = SHADOW
    row[6] = SHADOW_EDGE
    row[7] = shape
    row[LIGHT] = light
    row[MET_COLUMN] = 0.0
    for i in range(3):
        px, py, pz = geo[POLE + 3 * i], geo[POLE + 3 * i + 1], geo[POLE + 3 * i + 2]
        row[8 + i] = fx * px + fy * py + fz * pz
        row[12 + i] = hx * px + hy * py + hz * pz
        row[16 + i] = ux * px + uy * py + uz * pz
    row[11] = fx * gx + fy * gy + fz * gz
    row[15] = hx * gx + hy * gy + hz * gz
    row[19] = ux * ux + uy * uy + uz * uz
    row[20] = radius * radius / dist2
    return count + 1
