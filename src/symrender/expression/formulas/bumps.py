"""Bumps: heights with their gradients, and the normal that a gradient turns.

J. Blinn, "Simulation of wrinkled surfaces", SIGGRAPH 1978, doi:10.1145/800248.507101. The surface P + h N has tangents
T + (T.grad h) N where those of P are T, if N is taken not to turn on the way; what is at right angles to all of them is
N less the part of grad h along the surface, whatever the coordinates are.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, cos, exp, length, sin
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, dot, norm2, unit


def turned_normal(normal: Vec3, slope: Vec3) -> Vec3:
    """unit(N - grad h) with the part of the gradient along the surface: the normal of a bump."""
    return unit(normal - (slope - normal * dot(slope, normal)))


def sum_of_heights(left: Real, left_slope: Vec3, right: Real, right_slope: Vec3) -> tuple[Real, Vec3]:
    """a + b and its gradient."""
    return left + right, left_slope + right_slope


def difference_of_heights(left: Real, left_slope: Vec3, right: Real, right_slope: Vec3) -> tuple[Real, Vec3]:
    """a - b and its gradient."""
    return left - right, left_slope - right_slope


def product_of_heights(left: Real, left_slope: Vec3, right: Real, right_slope: Vec3) -> tuple[Real, Vec3]:
    """a b and its gradient."""
    return left * right, left_slope * right + right_slope * left


def sine_of_height(inner: Real, slope: Vec3) -> tuple[Real, Vec3]:
    """sin a and its gradient."""
    return sin(inner), slope * cos(inner)


def cosine_of_height(inner: Real, slope: Vec3) -> tuple[Real, Vec3]:
    """cos a and its gradient."""
    return cos(inner), -(slope * sin(inner))


def exponential_of_height(inner: Real, slope: Vec3) -> tuple[Real, Vec3]:
    """exp a and its gradient."""
    grown = exp(inner)
    return grown, slope * grown


def power_of_height(inner: Real, slope: Vec3, below: Real, exponent: Real) -> tuple[Real, Vec3]:
    """a^n and its gradient, ``below`` being a^(n - 1)."""
    return below * inner, slope * (exponent * below)


def distance_height(place: Vec3, center: Vec3) -> tuple[Real, Vec3]:
    """Distance from a centre and its gradient, which is 0 there."""
    offset = place - center
    far = length(norm2(offset))
    return far, offset / far


LEAVES: Final = (
    Leaf(turned_normal, ("turned:3",)),
    Leaf(sum_of_heights, ("height", "slope:3")),
    Leaf(difference_of_heights, ("height", "slope:3")),
    Leaf(product_of_heights, ("height", "slope:3")),
    Leaf(sine_of_height, ("height", "slope:3")),
    Leaf(cosine_of_height, ("height", "slope:3")),
    Leaf(exponential_of_height, ("height", "slope:3")),
    Leaf(power_of_height, ("height", "slope:3")),
    Leaf(distance_height, ("height", "slope:3")),
)
