"""A plane by a point of it, its unit normal and the unit direction its texture's x runs in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symrender.expression.vectors import Vec3, cross, dot, unit

if TYPE_CHECKING:
    import sympy as sp


def axes(normal: Vec3, along: Vec3) -> tuple[Vec3, Vec3]:
    """(up, east), orthonormal: up along the normal, east = n x up with n = unit(up x a) the direction y runs in."""
    up = unit(normal)
    return up, cross(unit(cross(up, along)), up)


def height(p: Vec3, point: Vec3, up: Vec3) -> sp.Expr:
    """Distance of p from the plane, negative behind it."""
    return dot(p - point, up)


def reach(above: sp.Expr, fall: sp.Expr) -> sp.Expr:
    """Distance at which a ray from the height ``above`` that rises by ``fall`` a unit meets the plane."""
    return -above / fall


def coordinates(q: Vec3, point: Vec3, east: Vec3, up: Vec3) -> tuple[sp.Expr, sp.Expr]:
    """(x, y) of a point of the plane: its offset along east and along up x east."""
    offset = q - point
    return dot(offset, east), dot(offset, cross(up, east))
