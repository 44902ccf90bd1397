"""Where on a floor's chart a wall lies: the azimuths and angles outside of which no line meets it, nor another wall.

Many spheres lay many walls on a floor. Most lines meet few of them and most pairs are nowhere near each other, which
four numbers a wall tell at once.
"""

from __future__ import annotations

import math

from symrender.chambers.listed import ROUNDED_UP, SLACK, shadow_disc
from symrender.chambers.records import Wall
from symrender.chambers.walls import BALL, DIRECTION, HIGHLIGHT, PENUMBRA, SHADOW
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable

EVERYWHERE = 4.0
"""More than half a turn."""


@inlined
def reach_disc(row: Wall, u: float, v: float, radius: float, height: float) -> None:
    """Note that a wall lies in a disc of the floor, about (u, v) from the foot in the chart's frame."""
    far = math.hypot(u, v)
    radius = ROUNDED_UP * radius + SLACK * far
    if radius < far:
        row.middle, row.opening = math.atan2(v, u), math.asin(radius / far) + SLACK
    row.nearest = math.atan2(far - radius, height) - SLACK
    row.farthest = math.atan2(far + radius, height) + SLACK


@jitable
def note_reach(view: View, work: Work) -> None:
    """Note where the chart's walls lie; on a sphere, and where no bound is at hand, everywhere."""
    chart = work.chart
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        row.middle, row.opening, row.nearest, row.farthest = 0.0, EVERYWHERE, -EVERYWHERE, EVERYWHERE
        if chart.shape_index >= 0:
            continue
        if row.kind == DIRECTION and row.cos > 0.0:
            across = math.hypot(row.axis[1], row.axis[2])
            away, wide = math.atan2(across, row.axis[0]), math.atan2(row.sin, row.cos)
            if ROUNDED_UP * row.sin < across:
                row.middle = math.atan2(row.axis[2], row.axis[1])
                row.opening = math.asin(ROUNDED_UP * row.sin / across) + SLACK
            row.nearest, row.farthest = away - wide - SLACK, away + wide + SLACK
        elif row.kind in (SHADOW, PENUMBRA) and row.tag != HIGHLIGHT:
            x, y, radius = shadow_disc(view.points[row.light], view.spheres[row.shape_index])
            if radius < math.inf:
                x, y = x - chart.point[0], y - chart.point[1]
                u, v = x * chart.e1[0] + y * chart.e1[1], x * chart.e2[0] + y * chart.e2[1]
                reach_disc(row, u, v, radius, chart.height)
        elif row.kind == BALL:
            square = row.foot[0] * row.foot[0] + row.foot[1] * row.foot[1] - row.power
            reach_disc(row, row.foot[0], row.foot[1], math.sqrt(max(0.0, square)), chart.height)


@inlined
def passes(row: Wall, phi: float) -> bool:
    """Whether the line of azimuth ``phi`` may meet the wall."""
    away = phi - row.middle
    away -= 2.0 * math.pi * math.floor(away * (0.5 / math.pi) + 0.5)
    return abs(away) <= row.opening


@inlined
def are_apart(one: Wall, other: Wall) -> bool:
    """Whether two walls can nowhere meet."""
    if one.nearest > other.farthest or other.nearest > one.farthest:
        return True
    away = one.middle - other.middle
    away -= 2.0 * math.pi * math.floor(away * (0.5 / math.pi) + 0.5)
    return abs(away) > one.opening + other.opening
