"""Rooms: planes cut space into convex parts, and a point sees no further than the one it lies in.

A room is convex, so no plane lies between two of its points: a plane hides a light from a lit point exactly where the
two are on different sides of it. A plane is a ``Side`` of the view, its normal and its level; ``Work.room`` says on
which side of each the point P lies. Points of a charted plane are compared with the other planes only.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Chart, Side
from symrender.chambers.work import Frames, View, Work
from symrender.jit.marks import inlined, jitable
from symrender.scene.frames import LEVEL

Array = npt.NDArray[np.float64]


@inlined
def height(side: Side, x: float, y: float, z: float) -> float:
    """Distance of a point from a plane, negative behind it."""
    return float(side.up[0] * x + side.up[1] * y + side.up[2] * z - side.level)


@jitable
def enter_room(view: View, work: Work) -> None:
    """Note on which side of every plane the chart's point lies: in front 1, behind -1 and in the plane 0.

    A point of a plane is in front of it.
    """
    chart = work.chart
    for k in range(view.sides.shape[0]):
        above = height(view.sides[k], chart.point[0], chart.point[1], chart.point[2])
        work.room[k] = 1.0 if above > 0.0 or k == chart.home else (-1.0 if above < 0.0 else 0.0)


@inlined
def in_a_plane(view: View, work: Work) -> bool:
    """Whether P lies in a plane that it is no point of, and so in no room."""
    found = False
    for k in range(view.sides.shape[0]):
        found = found or work.room[k] == 0.0
    return found


@inlined
def is_walled_off(qx: float, qy: float, qz: float, view: View, work: Work) -> bool:
    """Whether Q lies in another room than P, as far as planes other than the charted one tell."""
    for k in range(view.sides.shape[0]):
        if k != work.chart.plane and height(view.sides[k], qx, qy, qz) * work.room[k] < 0.0:
            return True
    return False


@inlined
def planes_hide(i: int, qx: float, qy: float, qz: float, view: View, work: Work) -> bool:
    """Whether a plane hides light ``i`` from Q.

    A charted plane is lit on its upper side, by what is above it. Elsewhere a point is lit by what is not on the other
    side of a plane, and what lies in the plane is on neither.
    """
    for k in range(view.sides.shape[0]):
        over = view.over[k, i]
        if k == work.chart.plane:
            if over <= 0 or work.room[k] < 0.0:
                return True
        elif over * height(view.sides[k], qx, qy, qz) < 0.0:
            return True
    return False


@inlined
def disk_over(i: int, k: int, view: View) -> tuple[float, float]:
    """Height of the centre of disk ``i`` over plane ``k``, and how far its rim rises above and falls below it.

    Both are 0 of a disk that lies in the plane.
    """
    p, up = view.points[i], view.sides[k].up
    e, f = p.e1, p.e2
    first = e[0] * up[0] + e[1] * up[1] + e[2] * up[2]
    second = f[0] * up[0] + f[1] * up[1] + f[2] * up[2]
    rise = math.hypot(first, second)
    above = 0.0
    if view.over[k, i] != 0:
        above = height(view.sides[k], p.position[0], p.position[1], p.position[2])
    return above, p.radius * rise if rise > LEVEL else 0.0


@inlined
def turn(v: Array, k: int, frames: Frames, out: Array) -> None:
    """A direction in the coordinates of plane ``k``."""
    frame = frames.axes[k]
    x, y, z = v[0], v[1], v[2]
    out[0] = x * frame.east[0] + y * frame.east[1] + z * frame.east[2]
    out[1] = x * frame.north[0] + y * frame.north[1] + z * frame.north[2]
    out[2] = x * frame.up[0] + y * frame.up[1] + z * frame.up[2]


@inlined
def carry(p: Array, k: int, frames: Frames, out: Array) -> None:
    """A point in the coordinates of plane ``k``."""
    frame = frames.axes[k]
    x, y, z = p[0] - frame.origin[0], p[1] - frame.origin[1], p[2] - frame.origin[2]
    out[0] = x * frame.east[0] + y * frame.east[1] + z * frame.east[2]
    out[1] = x * frame.north[0] + y * frame.north[1] + z * frame.north[2]
    out[2] = x * frame.up[0] + y * frame.up[1] + z * frame.up[2]


@inlined
def has_front(chart: Chart, work: Work) -> bool:
    """Whether P is on the side that the charted plane shows."""
    return bool(work.room[chart.plane] > 0.0)
