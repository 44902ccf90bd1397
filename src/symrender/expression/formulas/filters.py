"""What places of a filter's support weigh along one axis: x is the distance from its middle, 1 at its end.

Each has the mean 1 over the support, so that the weight of a place is the product of both axes'.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.expression.elementary import Real, exp, ratio
from symrender.expression.leaf import Leaf

_END: Final = math.exp(-8.0)
_MEAN: Final = math.sqrt(math.pi / 32.0) * math.erf(math.sqrt(8.0)) - _END


def tent_profile(x: Real) -> Real:
    """2 (1 - x)"""
    return 2 * (1 - x)


def gaussian_profile(x: Real) -> Real:
    """(exp(-8 x^2) - exp(-8))/m, of mean 1: a Gaussian whose support ends at four of its widths, where it is 0."""
    return (exp(-8 * x * x) - _END) / _MEAN


def mitchell_middle(x: Real) -> Real:
    """Mitchell and Netravali's cubic of B = C = 1/3 up to half its support: (7 t^3 - 12 t^2 + 16/3) 4/6, t = 2 x."""
    t = 2 * x
    return (7 * t * t * t - 12 * t * t + ratio(16, 3, x)) * ratio(2, 3, x)


def mitchell_rim(x: Real) -> Real:
    """The same beyond: (-7/3 t^3 + 12 t^2 - 20 t + 32/3) 4/6, t = 2 x."""
    t = 2 * x
    return (ratio(-7, 3, x) * t * t * t + 12 * t * t - 20 * t + ratio(32, 3, x)) * ratio(2, 3, x)


LEAVES: Final = (
    Leaf(tent_profile, ("share",)),
    Leaf(gaussian_profile, ("share",)),
    Leaf(mitchell_middle, ("share",)),
    Leaf(mitchell_rim, ("share",)),
)
