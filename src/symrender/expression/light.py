"""The disk light: its frame and its points."""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3, cross, unit


def facing(position: Vec3, target: Vec3) -> Vec3:
    """w = unit(target - L), the axis the disk faces along."""
    return unit(target - position)


def disk_frame(axis: Vec3, up: Vec3) -> tuple[Vec3, Vec3]:
    """(e1, e2) spanning the disk: e1 = unit(w x up), e2 = w x e1.

    ``up`` is (0, 1, 0) where |w_y| < .9, else (1, 0, 0).
    """
    e1 = unit(cross(axis, up))
    return e1, cross(axis, e1)


def disk_point(center: Vec3, radius: sp.Expr, e1: Vec3, e2: Vec3, u: sp.Expr, v: sp.Expr) -> Vec3:
    """L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v)."""
    angle = 2 * sp.pi * v
    return center + (e1 * sp.cos(angle) + e2 * sp.sin(angle)) * (radius * sp.sqrt(u))
