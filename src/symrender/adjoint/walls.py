"""How walls move: the gradient of a wall's level in everything that can move it.

A chart maps (x, phi) to a hit Q, its normal N and a direction w. Three things move that map: the point P it starts
from, the turn omega of its frame, and its own two numbers (k and R of a sphere's chart, the height of the floor's).
Any function G of Q, N, w and of the scene then has

    dG = Q' . (dP + omega x (Q - P) + Q_k dk + Q_R dR) + N' . (omega x N + N_k dk) + w' . (omega x w + w_k dk) + ...

with Q', N', w' its partial gradients. ``chart_place`` gives the places and their slopes, ``pull_back`` adds these
products to the adjoint, and ``wall_gradient`` gives Q', N', w' of the level of one wall, so that on a scan line
dx = -dG / (G_x). No formula here needs the frame's own formula: the frame may turn as it likes.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.adjoint.records import Place
from symrender.chambers.records import Chart, Wall
from symrender.chambers.rooms import height
from symrender.chambers.walls import (
    BALL,
    FLOOR_CUT,
    HORIZON,
    NORMAL,
    SEVERAL,
    SHADOW,
    SHADOW_EDGE,
    SILHOUETTE,
    TERMINATOR,
    TEXTURE_EDGE,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.leaves import slopes, tangents, values
from symrender.scene.arrays import CHECKER
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

# columns of an adjoint: what the derivative of a value in each of these is
AT_POINT: Final = 0
TURN: Final = 3
CHART: Final = 6
"""k = R/|C - P| of a sphere's chart, |P_z| of a plane's."""
CHART_RADIUS: Final = 7
AXIS: Final = 8
"""The lobe's axis m."""
EXPONENT: Final = 11
LOG_NORMALISER: Final = 12
RIM: Final = 13
"""Cosine of the lobe's half-angle."""
HORIZON_NORMAL: Final = 14
SHADING: Final = 17
"""ka, kd, ks, shininess."""
AMBIENT: Final = 21
BACKGROUND: Final = 24
BRIGHT: Final = 27
"""Albedo of the shape, or of the floor's bright fields."""
DARK: Final = 30
"""Albedo of the floor's dark fields; in its first column the dark factor of a sphere's texture."""
FREQUENCY: Final = 33
EYE: Final = 35
GRID: Final = 38
"""Cell and offset of the floor's checker."""
LIGHTS: Final = 41
"""From here six columns a light point (place, colour), then four a sphere (centre, radius), then four a plane (normal,
level), then, if there is an exact disk, four a light point (radius of the disk, turn of its frame)."""

# rows of ``Place.at`` and of gradients in a place
HIT: Final = 0
"""Q - P."""
FACING: Final = 1
"""N."""
TOWARD: Final = 2
"""w."""

CUT_BY: Final = SEVERAL + 1
"""Condition of what plane 0 cuts off; those of the other planes follow."""

ONE_SIDED: Final = 3
"""Row of the adjoint that holds by how much derivatives from the two sides differ."""


@jitable
def adjoint_columns(lights: int, spheres: int, planes: int, disks: bool) -> int:
    """Columns of an adjoint; ``disks``: whether a light point may carry an exact disk."""
    return LIGHTS + (10 if disks else 6) * lights + 4 * (spheres + planes)


@inlined
def plane_columns(view: View) -> int:
    """First column of the planes."""
    return LIGHTS + 6 * view.points.shape[0] + 4 * view.spheres.shape[0]


@jitable
def chart_place(x: float, c: float, s: float, chart: Chart, here: Place) -> tuple[float, float]:
    """Fill ``here`` at inner coordinate ``x`` of the line (c, s).

    Returns the solid angle per dx dphi and its logarithm's slope in k. The pole itself is no place of a chart: x > 0.
    """
    e, f, p = chart.e1, chart.e2, chart.pole
    ex, ey, ez = values.chart_across(c, s, e[0], e[1], e[2], f[0], f[1], f[2])
    if chart.shape_index < 0.0:
        (
            here.at[HIT, 0], here.at[HIT, 1], here.at[HIT, 2],
            here.at[TOWARD, 0], here.at[TOWARD, 1], here.at[TOWARD, 2], measure,
            here.by_x[HIT, 0], here.by_x[HIT, 1], here.by_x[HIT, 2],
            here.by_x[TOWARD, 0], here.by_x[TOWARD, 1], here.by_x[TOWARD, 2], _,
            here.by_chart[HIT, 0], here.by_chart[HIT, 1], _, _, _, _, _,
        ) = tangents.floor_sight_tangents(x, ex, ey, ez, p[0], p[1], p[2], chart.height)  # fmt: skip
        # P rises, Q stays on the plane
        here.by_chart[HIT, 2] = 0.0
        for a in range(3):
            here.at[FACING, a] = here.by_x[FACING, a] = here.by_chart[FACING, a] = 0.0
            here.by_chart[TOWARD, a] = here.by_radius[a] = 0.0
        here.at[FACING, 2] = 1.0
        return measure, 0.0
    (
        here.at[HIT, 0], here.at[HIT, 1], here.at[HIT, 2], here.at[FACING, 0], here.at[FACING, 1], here.at[FACING, 2],
        here.at[TOWARD, 0], here.at[TOWARD, 1], here.at[TOWARD, 2], measure,
        here.by_x[HIT, 0], here.by_x[HIT, 1], here.by_x[HIT, 2],
        here.by_x[FACING, 0], here.by_x[FACING, 1], here.by_x[FACING, 2],
        here.by_x[TOWARD, 0], here.by_x[TOWARD, 1], here.by_x[TOWARD, 2],
        here.by_chart[HIT, 0], here.by_chart[HIT, 1], here.by_chart[HIT, 2],
        here.by_chart[FACING, 0], here.by_chart[FACING, 1], here.by_chart[FACING, 2],
        here.by_chart[TOWARD, 0], here.by_chart[TOWARD, 1], here.by_chart[TOWARD, 2],
        here.by_radius[0], here.by_radius[1], here.by_radius[2], slope,
    ) = values.sphere_motion(
        math.sin(x), math.cos(x), ex, ey, ez, p[0], p[1], p[2], chart.radius, chart.ratio
    )  # fmt: skip
    return measure, slope


@jitable
def pull_back(weight: float, bar: Array, here: Place, floor: bool, out: Array) -> None:
    """Add to the adjoint ``out`` what moves P, the frame and the chart do to a function of gradients ``bar`` (3, 3)."""
    chart = 0.0
    for row in range(3):
        for a in range(3):
            chart += bar[row, a] * here.by_chart[row, a]
    out[CHART] += weight * chart
    if floor:
        out[AT_POINT] += weight * bar[HIT, 0]
        out[AT_POINT + 1] += weight * bar[HIT, 1]
        return
    radius = 0.0
    for a in range(3):
        out[AT_POINT + a] += weight * bar[HIT, a]
        radius += bar[HIT, a] * here.by_radius[a]
    out[CHART_RADIUS] += weight * radius
    tx, ty, tz = 0.0, 0.0, 0.0
    for row in range(3):
        tx += here.at[row, 1] * bar[row, 2] - here.at[row, 2] * bar[row, 1]
        ty += here.at[row, 2] * bar[row, 0] - here.at[row, 0] * bar[row, 2]
        tz += here.at[row, 0] * bar[row, 1] - here.at[row, 1] * bar[row, 0]
    out[TURN] += weight * tx
    out[TURN + 1] += weight * ty
    out[TURN + 2] += weight * tz


@jitable
def along_line(bar: Array, here: Place) -> float:
    """Slope along the scan line of a function of gradients ``bar``."""
    slope = 0.0
    for row in range(3):
        for a in range(3):
            slope += bar[row, a] * here.by_x[row, a]
    return slope


@inlined
def add_three(out: Array, at: int, x: float, y: float, z: float) -> None:
    """Add a vector to three columns."""
    out[at] += x
    out[at + 1] += y
    out[at + 2] += z


@inlined
def rim_gradient(here: Place, work: Work, lobe: Array, bar: Array, own: Array) -> None:
    """Gradients of w.m - cos(theta_max): ``bar`` in Q, N, w, the rest added to the zeroed columns ``own``."""
    for a in range(3):
        bar[HIT, a] = bar[FACING, a] = 0.0
        bar[TOWARD, a] = lobe[a]
        own[AXIS + a] += here.at[TOWARD, a]
    own[RIM] -= 1.0


@jitable
def wall_gradient(
    i: int, tag: int, here: Place, view: View, work: Work, bar: Array, own: Array
) -> None:  # fmt: skip
    """Gradients of the level of wall ``i`` as of condition ``tag``: ``bar`` in Q, N, w, the rest added to ``own``.

    Levels are those of the conditions themselves, not the table's rows, and their scale is their own.
    """
    chart, row = work.chart, work.walls[i]
    kind, shape = row.kind, row.shape_index
    balls = LIGHTS + 6 * view.points.shape[0]
    for line in range(3):
        for a in range(3):
            bar[line, a] = 0.0
    if tag == HORIZON:
        sphere = kind == NORMAL
        for a in range(3):
            n = chart.normal[a]
            bar[HIT if sphere else TOWARD, a] = n
            own[HORIZON_NORMAL + a] += here.at[HIT if sphere else TOWARD, a]
            if sphere:
                own[AT_POINT + a] -= n
    elif tag == SILHOUETTE and kind not in (NORMAL, BALL):
        w, o, p = here.at[TOWARD], view.spheres[shape].center, chart.point
        _, bar[TOWARD, 0], bar[TOWARD, 1], bar[TOWARD, 2], cx, cy, cz, by_radius, px, py, pz = (
            slopes.silhouette_level_slopes(
                w[0], w[1], w[2], o[0], o[1], o[2], view.spheres[shape].radius, p[0], p[1], p[2]
            )
        )
        add_three(own, balls + 4 * shape, cx, cy, cz)
        own[balls + 4 * shape + 3] += by_radius
        add_three(own, AT_POINT, px, py, pz)
    elif tag == SILHOUETTE:
        q, o, p = here.at[HIT], view.spheres[shape].center, chart.point
        _, bar[HIT, 0], bar[HIT, 1], bar[HIT, 2], cx, cy, cz, by_radius = slopes.ball_level_slopes(
            q[0] + p[0], q[1] + p[1], q[2] + p[2], o[0], o[1], o[2], view.spheres[shape].radius
        )
        add_three(own, balls + 4 * shape, cx, cy, cz)
        own[balls + 4 * shape + 3] += by_radius
    elif tag == TERMINATOR:
        j = chart.shape_index
        n, o, p = here.at[FACING], chart.center, view.points[shape].position
        _, bar[FACING, 0], bar[FACING, 1], bar[FACING, 2], lx, ly, lz, cx, cy, cz, by_radius = (
            slopes.terminator_level_slopes(n[0], n[1], n[2], p[0], p[1], p[2], o[0], o[1], o[2], chart.radius)
        )
        add_three(own, LIGHTS + 6 * shape, lx, ly, lz)
        add_three(own, balls + 4 * j, cx, cy, cz)
        own[balls + 4 * j + 3] += by_radius
    elif tag == TEXTURE_EDGE:
        _texture_gradient(row, here, view.spheres[chart.shape_index], chart, bar, own)
    elif kind == SHADOW:
        _shadow_gradient(row, here, view, work, bar, own)
    elif tag == SHADOW_EDGE:
        _contact_gradient(row, here, view, work, bar, own)
    else:
        # where Q is on a plane
        side, column = tag - CUT_BY, plane_columns(view) + 4 * (tag - CUT_BY)
        for a in range(3):
            bar[HIT, a] = view.sides[side].up[a]
            own[column + a] += here.at[HIT, a] + chart.point[a]
        own[column + 3] -= 1.0


@jitable
def _shadow_gradient(row: Wall, here: Place, view: View, work: Work, bar: Array, own: Array) -> None:
    """``wall_gradient`` of ``shadow_level``."""
    chart, light, shape = work.chart, row.light, row.shape_index
    balls = LIGHTS + 6 * view.points.shape[0]
    q, o, p, l = here.at[HIT], view.spheres[shape].center, chart.point, view.points[light].position
    _, bar[HIT, 0], bar[HIT, 1], bar[HIT, 2], lx, ly, lz, cx, cy, cz, by_radius = slopes.shadow_level_slopes(
        q[0] + p[0], q[1] + p[1], q[2] + p[2], l[0], l[1], l[2], o[0], o[1], o[2], view.spheres[shape].radius
    )
    add_three(own, LIGHTS + 6 * light, lx, ly, lz)
    add_three(own, balls + 4 * shape, cx, cy, cz)
    own[balls + 4 * shape + 3] += by_radius


@jitable
def _contact_gradient(row: Wall, here: Place, view: View, work: Work, bar: Array, own: Array) -> None:
    """``wall_gradient`` of the plane behind which a ball hides a light on its surface, where light and ball keep so."""
    light, shape, p = row.light, row.shape_index, here.at[HIT]
    balls = LIGHTS + 6 * view.points.shape[0]
    for a in range(3):
        bar[HIT, a] = view.spheres[shape].center[a] - view.points[light].position[a]
        u = p[a] + work.chart.point[a] - view.points[light].position[a]
        own[balls + 4 * shape + a] += u
        own[LIGHTS + 6 * light + a] -= bar[HIT, a] + u


@jitable
def edge_number(row: Wall, here: Place, sphere: Sphere, chart: Chart) -> tuple[bool, float]:
    """Whether a texture edge is a parallel, and its number, whole on an edge but for a meridian that is the seam."""
    up = -row.axis[0] * chart.pole[2] + row.axis[1] * chart.e1[2] + row.axis[2] * chart.e2[2]
    n = here.at[FACING]
    across, down = values.texture_phases(n[0], n[1], n[2], sphere.ku, sphere.kv)
    parallel = abs(up) > 0.5
    return parallel, down if parallel else across


@jitable
def _texture_gradient(row: Wall, here: Place, sphere: Sphere, chart: Chart, bar: Array, own: Array) -> None:
    parallel, number = edge_number(row, here, sphere, chart)
    whole = math.floor(number + 0.5)
    n = here.at[FACING]
    if parallel:
        _, bar[FACING, 0], bar[FACING, 1], bar[FACING, 2], by_count = slopes.parallel_level_slopes(
            n[0], n[1], n[2], whole, sphere.kv
        )
        own[FREQUENCY + 1] += by_count
        return
    _, bar[FACING, 0], bar[FACING, 1], bar[FACING, 2], by_count = slopes.meridian_level_slopes(
        n[0], n[1], n[2], number, sphere.ku
    )
    # the seam does not move: where a whole number of fields ends there, that holds as the number falls
    if abs(number - whole) < 1e-6 * (1.0 + whole) and whole < (1.0 - 1e-9) * sphere.ku:
        own[FREQUENCY] += by_count


@jitable
def on_a_parallel(here: Place, sphere: Sphere) -> bool:
    """Whether a parallel of a checker passes through this place."""
    if sphere.texture != CHECKER:
        return False
    n = here.at[FACING]
    _, number = values.texture_phases(n[0], n[1], n[2], sphere.ku, sphere.kv)
    return bool(abs(number - math.floor(number + 0.5)) < 1e-9 * (1.0 + number))


@inlined
def condition_of(i: int, here: Place, hidden: bool, view: View, work: Work) -> int:
    """The condition a wall stands for; of coinciding ones, the one that changes what is seen, -1 if none is known.

    ``hidden`` says that one side of the wall is not seen.
    """
    chart, row = work.chart, work.walls[i]
    tag: int = row.tag
    if tag == FLOOR_CUT:
        return CUT_BY + row.shape_index
    if tag < FLOOR_CUT:
        return tag
    if hidden:
        level, size = 0.0, 0.0
        for a in range(3):
            level += chart.normal[a] * here.at[HIT, a]
            size += here.at[HIT, a] ** 2
        if abs(level) < 1e-9 * math.sqrt(size):
            return HORIZON
        x, y, z = here.at[HIT, 0] + chart.point[0], here.at[HIT, 1] + chart.point[1], here.at[HIT, 2] + chart.point[2]
        for k in range(view.sides.shape[0]):
            if k != chart.plane and abs(height(view.sides[k], x, y, z)) < 1e-9 * math.sqrt(size):
                return CUT_BY + k
        return -1
    shape = row.shape_index
    if shape >= 0 and row.kind == NORMAL:
        return TERMINATOR
    return -1
