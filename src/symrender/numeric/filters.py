"""Where in a pixel's filter a ray passes, drawn at random, and what it then weighs."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.settings import Filter

CENTRE: Final = 0
BOX: Final = 1
TENT: Final = 2
GAUSSIAN: Final = 3
MITCHELL: Final = 4
FILTERS: Final[dict[Filter, int]] = {
    "centre": CENTRE,
    "box": BOX,
    "tent": TENT,
    "gaussian": GAUSSIAN,
    "mitchell": MITCHELL,
}
_THIRD: Final = 1.0 / 3.0
_WIDTHS: Final = 4.0
"""Standard deviations from the middle of a Gaussian to where it is cut and lowered to nothing."""


@jitable
def mitchell(x: float) -> float:
    """Mitchell and Netravali's cubic of B = C = 1/3 at a distance of at most 2."""
    b = c = _THIRD
    if x < 1.0:
        return ((12.0 - 9.0 * b - 6.0 * c) * x**3 + (12.0 * b + 6.0 * c - 18.0) * x**2 + 6.0 - 2.0 * b) / 6.0
    return ((-b - 6.0 * c) * x**3 + (6.0 * b + 30.0 * c) * x**2 - (12.0 * b + 48.0 * c) * x + 8.0 * b + 24.0 * c) / 6.0


@jitable
def tap(kind: int, reach: float, share: float) -> tuple[float, float]:
    """(distance from the middle of a pixel along an axis, weight) of a random share of [0, 1); weights average 1."""
    if kind == CENTRE:
        return 0.0, 1.0
    if kind == TENT:
        low = share < 0.5
        side = math.sqrt(2.0 * share) - 1.0 if low else 1.0 - math.sqrt(2.0 - 2.0 * share)
        return reach * side, 1.0
    x = reach * (2.0 * share - 1.0)
    if kind == BOX:
        return x, 1.0
    if kind == MITCHELL:
        # its own half width is 2
        return x, 4.0 * mitchell(abs(x) * 2.0 / reach)
    sigma = reach / _WIDTHS
    floor = math.exp(-0.5 * _WIDTHS * _WIDTHS)
    bell = sigma * math.sqrt(2.0 * math.pi) * math.erf(_WIDTHS / math.sqrt(2.0))
    return x, (math.exp(-0.5 * (x / sigma) ** 2) - floor) * 2.0 * reach / (bell - 2.0 * reach * floor)
