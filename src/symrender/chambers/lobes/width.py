"""How tame a lobe is: what node counts are aimed by."""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.lobes.record import CONDUCTOR, Lobe
from symrender.jit.marks import inlined, jitable

BLUNT: Final = 6.0
"""Exponent below which the end of a power is felt."""
LEAST_POWER: Final = 4.0
"""Lowest power with which nodes approach a blunt rim."""


@inlined
def width(share: float, lobe: Lobe) -> float:
    """How far off a real line the density stays tame, in a coordinate of which an angle is ``share`` times as long.

    A conductor's poles have places and are told by ``poles.py``.
    """
    if lobe.kind == CONDUCTOR:
        return 1.0 / share
    return 1.4 / (math.sqrt(lobe.exponent + 1e-9) * share)


@inlined
def turning_width(reach: float, lobe: Lobe) -> float:
    """How far off real azimuths it does; ``reach`` is the product of the sines of both polar angles."""
    if lobe.kind == CONDUCTOR:
        return 1.0
    return 1.4 / math.sqrt(lobe.exponent * reach + 1e-9)


@inlined
def width_at(theta: float, lobe: Lobe) -> float:
    """How far off real directions the density stays tame where all lie at ``theta`` from the axis, or farther off."""
    if lobe.kind == CONDUCTOR:
        gap = max(0.0, theta)
        return math.sqrt(gap * gap + (2.0 * lobe.alpha * lobe.cos_view) ** 2)
    return width(1.0, lobe)


@inlined
def broken_rim(lobe: Lobe) -> bool:
    """Whether the density ends at the rim, or just beyond it, with a power that is small and not whole.

    Coefficients then fall no faster than that power says: cos^n is 0 in the plane across the axis. Of an exponent below
    1e-12 all that it takes away is less than rounding leaves.
    """
    n = lobe.exponent
    return bool(lobe.rim_cos < 0.1 and 1e-12 < n < BLUNT and n != math.floor(n))


@jitable
def blunt_rim(lobe: Lobe) -> bool:
    """Whether the slope of the density ends with a broken power, or has no bound, at the rim."""
    n = lobe.exponent
    return bool(0.0 < n < 2.0 and n != 1.0 and lobe.rim_cos < 0.1)


@inlined
def rim_power(lobe: Lobe) -> float:
    """The power of u with which nodes approach a blunt rim.

    Where the rim lies in the plane across the axis the density is cos^n theta, theta the angle from it, and its slope
    n cos^(n-1) theta: nodes u^(k/n), k whole, make either smooth there.
    """
    return math.ceil(LEAST_POWER * lobe.exponent) / lobe.exponent


@inlined
def steepening(cosine: float, lobe: Lobe) -> float:
    """1 and the slope of the density over the density, at a cosine to the axis."""
    return 1.0 + lobe.exponent / cosine


@inlined
def fastest_fall(gap: float, lobe: Lobe) -> float:
    """Slope of the density's logarithm in the angle to the axis, at an angle ``gap``."""
    return lobe.exponent * math.tan(gap)
