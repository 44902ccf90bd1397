"""The lobe cos^n theta about the mirror direction: density, normaliser, mass; narrow lobes without cancellation.

theta is told by its versine 1 - cos theta = |w - m|^2/2, which keeps its digits where cos theta rounds to 1, and by
log cos theta = log1p(-versine). A rim at pi/2 is a lobe without a rim: log cos is then -inf, told by ``NO_RIM``.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, exp, expm1, log, log1p, pi, ratio, sin, where_positive
from symrender.expression.leaf import Leaf, Rows
from symrender.expression.vectors import Vec3, dot, norm2

NO_RIM: Final = -1e300
"""Logarithm of the cosine of a rim in the plane across the axis: its exponential is 0 and no product of it is NaN."""
QUARTER: Final = 1.5707963267948966
"""From here on a rim lies in the plane across the axis."""


def mirror_direction(incoming: Vec3, normal: Vec3) -> Vec3:
    """m = D - 2 (D.N) N"""
    return incoming - normal * (2 * dot(incoming, normal))


def lobe_chord(direction: Vec3, axis: Vec3) -> Real:
    """|w - m|^2 = 2 (1 - cos theta) of unit vectors."""
    return norm2(direction - axis)


def log_power(depth: Real, exponent: Real) -> Real:
    """log cos^n theta of depth = 1 - cos theta."""
    return exponent * log1p(-depth)


def power_density(log_cosine: Real, exponent: Real, log_normaliser: Real) -> Real:
    """cos^n theta / W of log cos theta."""
    return exp(exponent * log_cosine - log_normaliser)


def lobe_density(square: Real, exponent: Real, log_normaliser: Real) -> Real:
    """cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m."""
    depth = ratio(1, 2, square) * square
    return where_positive(1 - depth, lambda: power_density(log1p(-depth), exponent, log_normaliser), 0.0)


def cosine_power(cosine: Real, exponent: Real) -> Real:
    """cos^n theta = exp(n log cos theta) of a positive cosine: for balls, where it is analytic."""
    return exp(exponent * log(cosine))


def log_cosine(angle: Real) -> Real:
    """log cos t = log1p(-2 sin^2(t/2)), which keeps its digits at small angles."""
    half = sin(ratio(1, 2, angle) * angle)
    return log1p(-2 * half * half)


def angle_power(angle: Real, exponent: Real) -> Real:
    """cos^n t of an angle less than pi/2, whose digits it keeps however small it is."""
    return exp(exponent * log_cosine(angle))


def log_rim(theta_max: Real) -> Real:
    """log cos theta_max; ``NO_RIM`` where the rim lies in the plane across the axis."""
    return where_positive(QUARTER - theta_max, lambda: log_cosine(theta_max), NO_RIM)


def log_left(taken: Real) -> Real:
    """log(1 - t), of a cosine that has fallen by the share t; ``NO_RIM`` where nothing is left."""
    return where_positive(1 - taken, lambda: log1p(-taken), NO_RIM)


def lobe_mass(log_cosine: Real, exponent: Real) -> Real:
    """1 - cos^(n+1) theta, the share of the rimless lobe within theta, of log cos theta."""
    return -expm1((exponent + 1) * log_cosine)


def normaliser(log_cosine: Real, exponent: Real) -> Real:
    """W = int_cone cos^n theta dw = 2 pi (1 - cos^(n+1) theta_max)/(n + 1), of log cos theta_max."""
    u = exponent + 1
    return 2 * pi(u) * -expm1(u * log_cosine) / u


def log_normaliser(log_cosine: Real, exponent: Real) -> Real:
    """log W, by which a density is divided in its exponent."""
    return log(normaliser(log_cosine, exponent))


def ring_share(log_low: Real, log_high: Real, log_cosine: Real, exponent: Real) -> Real:
    """Share of a ring: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1, of logarithms of cosines."""
    u = exponent + 1
    return exp(u * log_low) * -expm1(u * (log_high - log_low)) / -expm1(u * log_cosine)


def brdf_scale(log_cosine: Real, exponent: Real) -> Real:
    """W (n + 2)/(2 pi): what a lobe average is multiplied by to become the BRDF's integral."""
    return (exponent + 2) / (exponent + 1) * lobe_mass(log_cosine, exponent)


def brdf_normaliser(exponent: Real) -> Real:
    """2 pi/(n+2) = int cos^(n+1) theta dw over the hemisphere: the normaliser in BRDF units."""
    return 2 * pi(exponent) / (exponent + 2)


LEAVES: Final = (
    Leaf(mirror_direction, ("axis:3",), pages=True),
    Leaf(lobe_chord, ("square",), pages=True),
    Leaf(log_power, ("level",), pages=True),
    Leaf(lobe_density, ("density",), pages=True,
         rows=Rows((("square", "chord"),), (("density", "power", "set"), ("density", "weight", "scale")))),
    Leaf(power_density, ("density",)),
    Leaf(cosine_power, ("power",)),
    Leaf(angle_power, ("power",)),
    Leaf(log_rim, ("log_cosine",), pages=True),
    Leaf(log_left, ("log_cosine",)),
    Leaf(lobe_mass, ("mass",), pages=True),
    Leaf(normaliser, ("whole",)),
    Leaf(log_normaliser, ("log_normaliser",), pages=True),
    Leaf(ring_share, ("share",), pages=True),
    Leaf(brdf_scale, ("scale",)),
    Leaf(brdf_normaliser, ("normaliser",)),
)  # fmt: skip
