"""The mean of the floor checker over what a pixel covers of the floor.

The checker's sign is s(a) s(b) in cell coordinates, s the square wave that is +1 on [0, 1) and -1 on [1, 2). Its
antiderivative S(a) = int_0^a s is the triangle wave, so the mean over an interval is a difference of two values of
S, and the mean over a polygon a sum over its edges.
"""

from __future__ import annotations

import sympy as sp


def square_wave(a: sp.Expr) -> sp.Expr:
    """s(a) = 1 - 2 (floor(a) mod 2)"""
    return 1 - 2 * sp.Mod(sp.floor(a), 2)


def triangle_wave(a: sp.Expr) -> sp.Expr:
    """S(a) = int_0^a s = 1 - 2 |a/2 - floor(a/2) - 1/2|, between 0 and 1."""
    return 1 - 2 * sp.Abs(a / 2 - sp.floor(a / 2) - sp.Rational(1, 2))


def interval_mean(center: sp.Expr, width: sp.Expr) -> sp.Expr:
    """Mean of s over an interval: (S(p + w/2) - S(p - w/2))/w."""
    return (triangle_wave(center + width / 2) - triangle_wave(center - width / 2)) / width


def edge_integral(a: sp.Expr, b0: sp.Expr, b1: sp.Expr, across: sp.Expr) -> sp.Expr:
    """-int s(a) S(b) da along a piece of edge that no checker line meets: s(a) fixed, S linear, so the mean is exact.

    Summed over the boundary of a polygon, counter-clockwise, it is the integral of s(a) s(b) over the polygon.
    """
    return -square_wave(a) * (triangle_wave(b0) + triangle_wave(b1)) / 2 * across
