"""A lobe's density, at a direction and at most beyond an angle."""

from __future__ import annotations

import math

from symrender.chambers.lobes.fit import FIT_OVER
from symrender.chambers.lobes.record import CONDUCTOR, Lobe
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values


@jitable
def largest_density(square: float, lobe: Lobe) -> float:
    """No direction at this squared distance from the axis, on the unit sphere, or farther off it has a larger density.

    Of a lobe cos^n it is the density itself, cos^n theta / W.
    """
    if lobe.kind == CONDUCTOR and lobe.beckmann == 1:
        # G is at most G1(o)
        most = values.beckmann_most(square, lobe.alpha) * lobe.outward / (4.0 * math.pi * lobe.cos_view)
        return most * FIT_OVER if lobe.walter == 1 else most
    if lobe.kind == CONDUCTOR:
        return values.ggx_most(square, lobe.alpha, lobe.by_cosine, lobe.by_root)
    return values.lobe_density(square, lobe.exponent, lobe.log_normaliser)


@inlined
def log_peak(lobe: Lobe) -> float:
    """Logarithm of the largest density of all."""
    if lobe.kind == CONDUCTOR:
        return math.log(largest_density(0.0, lobe))
    return -lobe.log_normaliser


@inlined
def log_fall(versine: float, lobe: Lobe) -> float:
    """By how much the logarithm of the density has fallen where 1 - cos theta is ``versine``, at least."""
    if lobe.kind == CONDUCTOR:
        return math.log(max(1e-300, largest_density(2.0 * versine, lobe))) - log_peak(lobe)
    return values.log_power(min(1.0 - 1e-15, versine), lobe.exponent)


@inlined
def density_of(log: float, lobe: Lobe) -> float:
    """The density where the logarithm of cos(theta) is ``log``."""
    return values.power_density(log, lobe.exponent, lobe.log_normaliser)


@inlined
def rim_density(lobe: Lobe) -> float:
    """The density on the rim; a rim in the plane across the axis rounds to either side of it."""
    cosine = lobe.rim_cos
    if lobe.exponent == 0.0:
        return math.exp(-lobe.log_normaliser)
    return density_of(math.log(cosine), lobe) if cosine > 0.0 else 0.0


@inlined
def facing_share(wx: float, wy: float, wz: float, lobe: Lobe) -> float:
    """What a direction counts beside the density: 1, or in BRDF units its cosine to the surface normal."""
    return float(lobe.facing_level + lobe.facing[0] * wx + lobe.facing[1] * wy + lobe.facing[2] * wz)


@inlined
def facing_of(lobe: Lobe) -> tuple[float, float, float, float]:
    """The level and the vector of ``facing_share``, for loops that write rows: read there they would be read again."""
    return lobe.facing_level, lobe.facing[0], lobe.facing[1], lobe.facing[2]
