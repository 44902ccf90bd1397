"""How tame a lobe is: what node counts are aimed by."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import CONDUCTOR, Lobe
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Three

Array = npt.NDArray[np.float64]

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
    """How far off real directions the density stays tame where all lie at ``theta`` from the axis, or farther off.

    Of a conductor, towards the surface's normal; across it a grazing view makes the lobe narrower, see ``width_about``.
    """
    if lobe.kind == CONDUCTOR:
        gap = max(0.0, theta)
        return math.sqrt(gap * gap + (2.0 * lobe.alpha * lobe.cos_view) ** 2)
    return width(1.0, lobe)


@inlined
def width_about(w0: float, w1: float, w2: float, reach: float, axis: Array, normal: Three, lobe: Lobe) -> float:
    """How far off real directions the density stays tame within ``reach`` of the direction w.

    A conductor's is one of how far the half vector h leans, singular where that is +-i alpha, and h turns |w + w_o|
    times as slowly as w where they turn across one another. A grazing view makes of it a needle: what lies along it is
    as far from the axis as one likes, and as narrow across as at the axis.
    """
    if lobe.kind != CONDUCTOR:
        return width(1.0, lobe)
    c = lobe.cos_view
    n0, n1, n2 = normal[0], normal[1], normal[2]
    s0, s1, s2 = w0 + 2.0 * c * n0 - axis[0], w1 + 2.0 * c * n1 - axis[1], w2 + 2.0 * c * n2 - axis[2]
    size = math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    along = s0 * n0 + s1 * n1 + s2 * n2
    x, y, z = s1 * n2 - s2 * n1, s2 * n0 - s0 * n2, s0 * n1 - s1 * n0
    lean = math.atan2(math.sqrt(x * x + y * y + z * z), along)
    # both lie above the surface, so that their sum is no shorter than the cosine of one
    least = max(size - reach, c)
    lean = max(0.0, lean - reach / least)
    return least * math.sqrt(lean * lean + lobe.alpha * lobe.alpha)


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
