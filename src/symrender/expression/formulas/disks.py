"""The disk light: its frame and its points."""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, cos, pi, sin, sqrt
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, span, unit


def facing(position: Vec3, target: Vec3) -> Vec3:
    """w = unit(target - L), the axis a disk faces along."""
    return unit(target - position)


def disk_frame(position: Vec3, target: Vec3, up: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    """(w, e1, e2): the axis a disk faces along and what spans it; ``up`` is y where |w_y| < .9, else x."""
    axis = facing(position, target)
    return axis, *span(axis, up)


def disk_point(center: Vec3, radius: Real, first: Vec3, second: Vec3, u: Real, v: Real) -> Vec3:
    """L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v)."""
    angle = 2 * pi(v) * v
    return center + (first * cos(angle) + second * sin(angle)) * (radius * sqrt(u))


LEAVES: Final = (
    Leaf(disk_frame, ("axis:3", "first:3", "second:3")),
    Leaf(disk_point, ("place:3",), pages=True),
)
