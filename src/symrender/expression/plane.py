"""A plane by a point of it, its unit normal and the unit direction its texture's x runs in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symrender.expression.vectors import Vec3, cross, dot, unit

if TYPE_CHECKING:
    import sympy as sp


def upward(normal: Vec3) -> Vec3:
    """Unit normal."""
    return unit(normal)


def northward(up: Vec3, along: Vec3) -> Vec3:
    """The unit direction y runs in, across the normal and the direction given for x."""
    return unit(cross(up, along))


def eastward(up: Vec3, north: Vec3) -> Vec3:
    """The unit direction x runs in."""
    return cross(north, up)


def height(p: Vec3, point: Vec3, up: Vec3) -> sp.Expr:
    """Distance of p from the plane, negative behind it."""
    return dot(p - point, up)


def reach(above: sp.Expr, fall: sp.Expr) -> sp.Expr:
    """Distance at which a ray from the height ``above`` that rises by ``fall`` a unit meets the plane."""
    return -above / fall


def coordinates(q: Vec3, point: Vec3, east: Vec3, up: Vec3) -> tuple[sp.Expr, sp.Expr]:
    """(x, y) of a point of the plane: its offset along east and along north = up x east."""
    offset = q - point
    return dot(offset, east), dot(offset, cross(up, east))


def place(x: sp.Expr, y: sp.Expr, point: Vec3, east: Vec3, up: Vec3) -> Vec3:
    """The point of the plane whose coordinates are (x, y)."""
    return point + east * x + cross(up, east) * y
