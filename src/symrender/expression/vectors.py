"""Vectors of numbers of any kind: SymPy expressions, floats, nodes of a tape, balls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symrender.expression.elementary import sqrt

if TYPE_CHECKING:
    import sympy as sp


@dataclass(slots=True, unsafe_hash=True)
class Vec3:
    """Three numbers, never changed; the arithmetic of ordinary space. Not frozen: that would triple its cost."""

    x: sp.Expr
    y: sp.Expr
    z: sp.Expr

    @property
    def parts(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The components as a tuple."""
        return self.x, self.y, self.z

    def __add__(self, other: Vec3) -> Vec3:
        return Vec3(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Vec3) -> Vec3:
        return Vec3(self.x - other.x, self.y - other.y, self.z - other.z)

    def __neg__(self) -> Vec3:
        return Vec3(-self.x, -self.y, -self.z)

    def __mul__(self, factor: sp.Expr | int) -> Vec3:
        return Vec3(self.x * factor, self.y * factor, self.z * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: sp.Expr | int) -> Vec3:
        return Vec3(self.x / divisor, self.y / divisor, self.z / divisor)


def vec3(name: str) -> Vec3:
    """Three real symbols ``name_x``, ``name_y``, ``name_z``."""
    import sympy as sp

    return Vec3(*(sp.Symbol(f"{name}_{axis}", real=True) for axis in "xyz"))


def dot(a: Vec3, b: Vec3) -> sp.Expr:
    """a . b"""
    return a.x * b.x + a.y * b.y + a.z * b.z


def cross(a: Vec3, b: Vec3) -> Vec3:
    """a x b"""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def norm2(a: Vec3) -> sp.Expr:
    """|a|^2"""
    return dot(a, a)


def unit(a: Vec3) -> Vec3:
    """a / |a|"""
    return a / sqrt(norm2(a))


def span(axis: Vec3, up: Vec3) -> tuple[Vec3, Vec3]:
    """(e1, e2) completing a unit axis: e1 = unit(w x up), e2 = w x e1; ``up`` is y where |w_y| < .9, else x."""
    first = unit(cross(axis, up))
    return first, cross(axis, first)


def renormalising(a: Vec3) -> sp.Expr:
    """(15 - 10 s + 3 s^2)/8 with s = |a|^2, 1/sqrt(s) to second order about 1: it makes a nearly unit vector unit."""
    s = norm2(a)
    return (15 - s * (10 - 3 * s)) / 8
