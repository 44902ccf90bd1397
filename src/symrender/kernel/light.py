"""The function of the program that places the points a disk light is replaced by."""

from __future__ import annotations

import sympy as sp

from symrender.expression.formulas.disks import disk_point, facing
from symrender.expression.vectors import Vec3, span, vec3
from symrender.kernel.block import Block, real
from symrender.kernel.program import Function


def light_point() -> Function:
    """The point of a disk light that belongs to (u, v) of the unit square."""
    center, target, radius, u, v = vec3("c"), vec3("t"), real("rho"), real("u"), real("v")
    block = Block()
    axis = block.let_vector("w", facing(center, target))
    upright, sideways = (Vec3(*map(sp.Integer, axis)) for axis in ((0, 1, 0), (1, 0, 0)))
    with block.when(sp.Abs(axis.y) < sp.Rational(9, 10)):
        _leave(block, center, radius, u, v, span(axis, upright))
    _leave(block, center, radius, u, v, span(axis, sideways))
    parameters = (*center.parts, *target.parts, radius, u, v)
    return Function("light_point", parameters, block.statements, "(x, y, z) on a disk light facing t")


def _leave(block: Block, center: Vec3, radius: sp.Expr, u: sp.Expr, v: sp.Expr, sides: tuple[Vec3, Vec3]) -> None:
    point = block.let_vector("p", disk_point(center, radius, *sides, u, v))
    block.leave(*point.parts)
