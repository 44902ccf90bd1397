"""What the split rule and its derivative set up alike before they integrate a point."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.levels import ASKANCE, LEVELS, level_at_limb, level_in_itself, lobe_level
from symrender.chambers.lobes.poles import on_horizon, pole_across, pole_on_horizon
from symrender.chambers.lobes.width import turning_width, width
from symrender.chambers.records import INVERSE_SQUARE
from symrender.chambers.rooms import carry, enter_room, turn
from symrender.chambers.roots import square_root
from symrender.chambers.walls import DIRECTION
from symrender.chambers.work import Frames, View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.cores import beside_sphere, core_count, over_floor
from symrender.scene.arrays import EYE, MARBLE, SOLID
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

MET: Final = 0
"""The error estimate is within the tolerance."""
CAPPED: Final = 1
"""The evaluations or the panels ran out first; the error estimate says how far it got."""
NEAR_TANGENT: Final = 2
"""A piece too thin to be cut further stayed unresolved; the error estimate bounds it."""
UNSUPPORTED: Final = 3
"""The point lies inside another sphere; no value is given and the error is infinite."""
EVENT: Final = 4
"""The structure changes at this very place: walls that coincide part, and the derivative is that of one side."""
FEW: Final = 4
"""Integrals to come up to which each takes half of the tolerance that is left."""
LAST: Final = 0.9
"""What the last one may take: a part of it is for what is left out, and for roundings."""
GRAZING: Final = 1.2
"""Secant of an angle: circles that come no nearer to the floor's horizon do not sweep over what is far away."""
MEETING_STEPS: Final = 2
"""Steps to where a circle meets a light off the real azimuths; each gains two digits where the point is low."""
FARTHEST: Final = 2.0
"""Depth from which on a singularity beside azimuths is not felt."""
MOST_SHARE: Final = 0.999
"""Largest share of what chooses no node counts."""


@jitable
def place_point(
    point: Array, normal: Array, incoming: Array, home: int, lobe: Array, view: View, work: Work
) -> None:  # fmt: skip
    """Write the point, its normal and its plane ``home`` into the chart, its room and the axis of its lobe.

    A point that lies in a plane it is no point of is on neither side of it: no ray from there meets the plane, and it
    sees what is behind.
    """
    chart = work.chart
    d = incoming[0] * normal[0] + incoming[1] * normal[1] + incoming[2] * normal[2]
    size = 0.0
    for a in range(3):
        chart.point[a] = point[a]
        chart.normal[a] = normal[a]
        lobe[a] = incoming[a] - 2.0 * d * normal[a]
        size += lobe[a] * lobe[a]
    for a in range(3):
        lobe[a] /= math.sqrt(size)
    chart.home = home
    enter_room(view, work)
    chart.pace, chart.swept = 1.0, 0


@inlined
def stand_in_frame(k: int, point: Array, normal: Array, lobe: Array, frames: Frames, work: Work, axis: Array) -> None:
    """Write the point and its normal into the chart, and the lobe's axis into ``axis``, all as plane ``k`` has them."""
    carry(point, k, frames, work.chart.point)
    turn(normal, k, frames, work.chart.normal)
    turn(lobe, k, frames, axis)


@jitable
def inside_another(point: Array, own: int, spheres: Table[Sphere]) -> bool:
    """Whether the point lies inside a sphere that is not ``own``."""
    for j in range(spheres.shape[0]):
        x, y, z = point[0] - spheres[j].center[0], point[1] - spheres[j].center[1], point[2] - spheres[j].center[2]
        if j != own and x * x + y * y + z * z <= spheres[j].radius ** 2:
            return True
    return False


@jitable
def charts_to_come(sky: float, view: View, frames: Frames, work: Work) -> int:
    """How many integrals a point is the sum of: one a sphere that it sees, one or two a plane that it may see."""
    charts = work.counts.balls
    for k in range(view.sides.shape[0]):
        if k != work.chart.home and (work.room[k] > 0.0 or (work.room[k] < 0.0 and sky > 0.0)):
            charts += 1 if work.room[k] < 0.0 or frames.views[k].floor.kind == SOLID else 2
    return charts


@inlined
def spare_share(charts: int) -> float:
    """What the next of so many integrals may take of the tolerance that is left.

    Rules are rarely as bad as they may be, so that a third of what is given is spent: of many integrals each gets twice
    an equal share, of few half of what is left, and the last one nearly all of it.
    """
    return 0.5 if 1 < charts <= FEW else min(LAST, 2.0 / max(1, charts))


@inlined
def sphere_strips(j: int, view: View, work: Work) -> None:
    """How far off the real line the integrand of charted sphere ``j`` stays tame."""
    chart = work.chart
    work.counts.spots = 0
    k = chart.ratio
    chart.strip_along = min(0.3, width(k, chart.lobe))
    reach = math.sin(chart.lobe_beta) * math.sin(min(chart.lobe_beta, chart.beta_max))
    chart.strip_across = min(0.5, turning_width(reach, chart.lobe))
    chart.strip_vein = math.inf
    if view.spheres[j].texture == MARBLE:
        chart.strip_vein = 3.0 / (view.spheres[j].ku + 6.6 * view.spheres[j].kv)
        chart.strip_along = min(chart.strip_along, chart.strip_vein)
        chart.strip_across = min(chart.strip_across, chart.strip_vein)
    chart.strip_limb = 0.9 * math.acosh(1.0 / k)
    add_pole(view, work)
    radius = view.spheres[j].radius
    for i in range(core_count(view)):
        x, y, z, level = beside_sphere(i, j, view)
        if level > 0.0:
            # N.(L - C) = level at azimuths +- i acosh(sqrt(a^2 - b^2)/c), at the nearest
            level *= 2.0 * radius
            along = -2.0 * radius * (x * chart.pole[0] + y * chart.pole[1] + z * chart.pole[2])
            u = x * chart.e1[0] + y * chart.e1[1] + z * chart.e1[2]
            v = x * chart.e2[0] + y * chart.e2[1] + z * chart.e2[2]
            across = 2.0 * radius * math.hypot(u, v)
            if across > 0.0:
                ratio = math.sqrt(max(0.0, (level - along) * (level + along))) / across
                add_spot_at(math.atan2(v, u), math.acosh(max(1.0, ratio)), 1.0, work)


@inlined
def add_pole(view: View, work: Work) -> None:
    """Note where the lobe's own density makes the integral over lines singular."""
    phi, depth = pole_across(work.chart, view.conductors)
    if depth < math.inf:
        add_spot_at(phi, depth, 1.0, work)
    phi, depth = pole_on_horizon(work.chart, view.conductors)
    if depth < math.inf:
        add_spot_at(phi, depth, 1.0, work)
    for i in range(LEVELS):
        of_view, x, y = lobe_level(i, work.chart, view.conductors)
        if x == math.inf:
            continue
        if i == ASKANCE:
            phi, depth = on_horizon(x, work.chart)
            if depth < FARTHEST:
                add_spot_at(phi, depth, 1.0, work)
        middle, offset, depth = level_at_limb(of_view, x, y, work.chart)
        if depth < FARTHEST:
            add_spot_at(middle + offset, depth, 1.0, work)
            add_spot_at(middle - offset, depth, 1.0, work)
        middle, offset, depth = level_in_itself(of_view, x, y, work.chart)
        if depth < FARTHEST:
            for turn in (offset, -offset, math.pi - offset, offset - math.pi):
                add_spot_at(middle + turn, depth, 1.0, work)


@inlined
def add_spot(x: float, y: float, depth: float, work: Work) -> None:
    """Note that the floor's integrand is tame only so far off the real azimuths towards (x, y) from the foot."""
    chart = work.chart
    if x * x + y * y > 0.0:
        add_spot_at(math.atan2(x * chart.e2[0] + y * chart.e2[1], x * chart.e1[0] + y * chart.e1[1]), depth, 1.0, work)


@inlined
def add_spot_at(phi: float, depth: float, share: float, work: Work) -> None:
    """Note that the chart's integrand is tame only so far off the real azimuth ``phi``."""
    k = work.counts.spots
    if k < work.spots.shape[0]:
        work.counts.spots += 1
    else:
        # the one that is felt least gives way
        for i in range(work.spots.shape[0]):
            if k == work.spots.shape[0] or work.spots[i].depth > work.spots[k].depth:
                k = i
        if work.spots[k].depth <= depth:
            return
    work.spots[k].azimuth = phi
    work.spots[k].depth = depth
    work.spots[k].share = share


@inlined
def floor_spots(view: View, work: Work) -> None:
    """Azimuths at which a light is near the floor.

    A light at height z over a place rho from the foot is at distance 0 of floor points of azimuth
    phi +- i asinh(z / rho), at the nearest. On the line in which
    the point's own horizon meets the floor distances vanish at azimuths of their own, atan((t +- i d) / p).
    """
    chart = work.chart
    nx, ny = chart.normal[0], chart.normal[1]
    tilt = math.sqrt(nx * nx + ny * ny)
    for i in range(core_count(view)):
        x, y, z, square = over_floor(i, view)
        if square < 0.0:
            continue
        x, y, z = x - chart.point[0], y - chart.point[1], math.sqrt((z - math.sqrt(square)) * (z + math.sqrt(square)))
        rho = math.sqrt(x * x + y * y)
        slope = z / max(rho, 1e-9 * z) if z > 0.0 else 0.0
        add_spot(x, y, math.log(slope + math.sqrt(1.0 + slope * slope)), work)
        if tilt > 1e-9 and chart.normal[2] != 0.0:
            p = chart.normal[2] * chart.height / tilt
            across = (nx * x + ny * y) / tilt - p
            u, v = (nx * y - ny * x) / (tilt * p), math.sqrt(across * across + z * z) / abs(p)
            phi = math.atan2(ny, nx) + 0.5 * math.atan2(2.0 * u, 1.0 - u * u - v * v) + (math.pi if p < 0.0 else 0.0)
            depth = 0.25 * math.log((u * u + (v + 1.0) ** 2) / max(u * u + (v - 1.0) ** 2, 1e-300))
            add_spot(math.cos(phi), math.sin(phi), depth, work)


@inlined
def wide_spots(a0: float, a1: float, a2: float, cosine: float, view: View, work: Work) -> None:
    """Note where a circle of directions that passes or grazes the floor's horizon meets a light or the eye.

    Where cells end on the circle the line integral is singular at an azimuth where the circle's place on the floor is
    at distance 0 of the light. With w = h/r, r the place's distance from the foot, and the light in front by ``along``
    and off by ``off``, that is w = h (along +- i off)/|L|^2 and

        cos(phi - phi_0) = (cosine sqrt(1 + w^2) - a0 w)/rho:

    hard by where the circle meets the horizon if the point is low, and off the real line if the circle grazes it. The
    root that opens there is of a share sqrt(2) |w|/sqrt(Im w times the line's length) of the line, at most.
    """
    chart, rho = work.chart, math.hypot(a1, a2)
    if not abs(cosine) < GRAZING * rho:
        return
    middle = math.atan2(a2, a1)
    c, s = math.cos(middle), math.sin(middle)
    ex, ey = c * chart.e1[0] + s * chart.e2[0], c * chart.e1[1] + s * chart.e2[1]
    fx, fy = c * chart.e2[0] - s * chart.e1[0], c * chart.e2[1] - s * chart.e1[1]
    length = min(1.0, 2.0 * chart.lobe.rim_sin) if chart.lobe.rim_cos >= 0.0 else 1.0
    count = core_count(view)
    for i in range(count + 1):
        whole, square = False, 0.0
        if i < count:
            x, y, z, square = over_floor(i, view)
            whole = i >= view.points.shape[0] or view.points[i].fall == INVERSE_SQUARE
        elif view.shading.highlight_view == EYE and view.shading.ks > 0.0:
            x, y, z = view.eye[0], view.eye[1], view.eye[2]
        else:
            continue
        x, y = x - chart.point[0], y - chart.point[1]
        far2 = x * x + y * y + z * z - square
        if square < 0.0 or not z > 0.0 or far2 <= 0.0:
            continue
        front, aside = x * ex + y * ey, x * fx + y * fy
        for side in range(2):
            re, im = cosine / rho, 0.0
            wr, wi, sr = 0.0, 0.0, 0.0
            for _ in range(MEETING_STEPS):
                sr, si = square_root(1.0 - re * re + im * im, -2.0 * re * im)
                if side == 1:
                    sr, si = -sr, -si
                along, aslant = front * re + aside * sr, front * im + aside * si
                off, sunk = square_root(far2 - along * along + aslant * aslant, -2.0 * along * aslant)
                wr, wi = chart.height * (along - sunk) / far2, chart.height * (aslant + off) / far2
                ur, ui = square_root(1.0 + wr * wr - wi * wi, 2.0 * wr * wi)
                re, im = (cosine * ur - a0 * wr) / rho, (cosine * ui - a0 * wi) / rho
            sr, _ = square_root(1.0 - re * re + im * im, -2.0 * re * im)
            one, other = math.sqrt((re + 1.0) ** 2 + im * im), math.sqrt((re - 1.0) ** 2 + im * im)
            away = math.acos(max(-1.0, min(1.0, 0.5 * (one - other))))
            away = -away if (sr < 0.0) != (side == 1) else away
            deep = max(1.0, 0.5 * (one + other))
            share = math.sqrt(2.0 * (wr * wr + wi * wi) / max(1e-300, abs(wi) * length))
            if whole:
                share = 1.0
            add_spot_at(middle + away, math.log(deep + math.sqrt(deep * deep - 1.0)), min(MOST_SHARE, share), work)


@inlined
def floor_strips(view: View, work: Work) -> None:
    """The same of the floor's chart; then its mean albedo."""
    chart = work.chart
    work.counts.spots = 0
    floor_spots(view, work)
    add_pole(view, work)
    wide_spots(chart.lobe_cos, chart.lobe_sin, 0.0, chart.lobe.rim_cos, view, work)
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        if row.kind == DIRECTION:
            wide_spots(row.axis[0], row.axis[1], row.axis[2], row.cos, view, work)
    chart.strip_along = min(0.3, width(1.0, chart.lobe))
    chart.strip_vein = math.inf
    chart.strip_across = min(0.5, turning_width(math.sin(chart.lobe_beta), chart.lobe))
    for a in range(3):
        chart.albedo[a] = 0.5 * (view.floor.bright[a] + view.floor.dark[a])
