"""Where outlines pass over into circles: no sign changes there, so that no crossing of two walls tells of it."""

from __future__ import annotations

import math
from typing import NamedTuple

from symrender.chambers.events import CROSSING, add_event, within_lobe
from symrender.chambers.records import Event
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined
from symrender.jit.records import Table


class Plane(NamedTuple):
    """The plane n.x = ``level``."""

    nx: float
    ny: float
    nz: float
    level: float


@inlined
def chart_place_of(qx: float, qy: float, qz: float, work: Work) -> tuple[float, float, float]:
    """(inner coordinate, cos phi, sin phi) of a place of the charted shape; the first is NaN where P cannot see it."""
    chart = work.chart
    dx, dy, dz = qx - chart.point[0], qy - chart.point[1], qz - chart.point[2]
    x = dx * chart.e1[0] + dy * chart.e1[1] + dz * chart.e1[2]
    y = dx * chart.e2[0] + dy * chart.e2[1] + dz * chart.e2[2]
    across = math.sqrt(x * x + y * y)
    c, s = (x / across, y / across) if across > 0.0 else (1.0, 0.0)
    if chart.shape_index < 0.0:
        return math.atan2(across, chart.height), c, s
    gx, gy, gz = qx - chart.center[0], qy - chart.center[1], qz - chart.center[2]
    facing = -(gx * dx + gy * dy + gz * dz)
    # psi is the angle of incidence: its sine is that of the way across, its cosine that of the way along the normal
    along = dx * chart.pole[0] + dy * chart.pole[1] + dz * chart.pole[2]
    far = math.sqrt(across * across + along * along)
    return math.atan2(math.sqrt(max(0.0, (chart.radius * far) ** 2 - facing * facing)), facing), c, s


@inlined
def add_contacts(
    i: int, plane: Plane, vx: float, vy: float, vz: float, view: View, work: Work, events: Table[Event], n: int,
    low: float, high: float,
) -> int:  # fmt: skip
    """Note where ball ``i``, a plane and the tangents to the ball from V meet; new count.

    There the ball's outline as of V, a silhouette or a shadow's edge, passes over into the circle in which the ball
    meets the charted shape: they touch, so that no sign tells of it.
    """
    s = view.spheres[i]
    nx, ny, nz, level = plane
    mx, my, mz = vx - s.center[0], vy - s.center[1], vz - s.center[2]
    e, g = level - (nx * s.center[0] + ny * s.center[1] + nz * s.center[2]), nx * mx + ny * my + nz * mz
    size, square = mx * mx + my * my + mz * mz, s.radius * s.radius
    det = size - g * g
    if not det > 1e-24 * size:
        return n
    b = (square - g * e) / det
    a = e - b * g
    rest = (square - (a * a + 2.0 * a * b * g + b * b * size)) / det
    if not rest > 0.0:
        return n
    t = math.sqrt(rest)
    for _ in range(2):
        qx = s.center[0] + a * nx + b * mx + t * (ny * mz - nz * my)
        qy = s.center[1] + a * ny + b * my + t * (nz * mx - nx * mz)
        qz = s.center[2] + a * nz + b * mz + t * (nx * my - ny * mx)
        x, c, sn = chart_place_of(qx, qy, qz, work)
        if 0.0 < x < 0.5 * math.pi:
            beta = x if work.chart.shape_index < 0.0 else math.asin(work.chart.ratio * math.sin(x))
            phi = math.atan2(sn, c)
            if within_lobe(phi, beta, work.chart):
                n = add_event(events, n, phi, low, high, CROSSING)
        t = -t
    return n


@inlined
def contacts(view: View, work: Work, events: Table[Event], n: int, low: float, high: float) -> int:
    """Note where outlines of balls that meet the charted shape pass over into the circles in which they do."""
    chart = work.chart
    j = chart.shape_index
    for i in range(view.spheres.shape[0]):
        s = view.spheres[i]
        if i == j:
            continue
        nx, ny, nz, level = 0.0, 0.0, 1.0, 0.0
        if j < 0:
            if not abs(s.center[2]) < s.radius:
                continue
        else:
            ux, uy, uz = s.center[0] - chart.center[0], s.center[1] - chart.center[1], s.center[2] - chart.center[2]
            r = chart.radius
            apart = math.sqrt(ux * ux + uy * uy + uz * uz)
            if not abs(s.radius - r) < apart < s.radius + r:
                continue
            nx, ny, nz = ux / apart, uy / apart, uz / apart
            level = nx * chart.center[0] + ny * chart.center[1] + nz * chart.center[2]
            level += (apart * apart + r * r - s.radius * s.radius) / (2.0 * apart)
        plane = Plane(nx, ny, nz, level)
        n = add_contacts(
            i, plane, chart.point[0], chart.point[1], chart.point[2], view, work, events, n, low, high
        )  # fmt: skip
        for l in range(view.points.shape[0]):
            p = view.points[l]
            n = add_contacts(
                i, plane, p.position[0], p.position[1], p.position[2], view, work, events, n, low, high
            )  # fmt: skip
    return n
