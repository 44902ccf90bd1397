"""The guarded power of a highlight, in the language of kernels: called by emitted text, never differentiated by it."""

from __future__ import annotations

from typing import Final

from symrender.jit.marks import jitable
from symrender.jit.moving import is_moving

MOST_SQUARED: Final = 4096.0
"""Whole exponents up to this one are taken by squaring, several times quicker than a general power."""
FALLEN: Final = 40.0
"""A power whose logarithm is known to lie below minus this is 0: ln base <= base - 1."""


@jitable
def gleam(base: float, exponent: float) -> float:
    """base^exponent of a cosine at most 1; 0 where it is not positive (1 if the exponent is 0) or below 1e-17."""
    if not base > 0.0:
        return 0.0 if exponent > 0.0 else 1.0
    if exponent * (1.0 - base) > FALLEN:
        return 0.0
    power = int(min(exponent, MOST_SQUARED))
    if power != exponent or is_moving(exponent):
        return float(base**exponent)
    found = 1.0
    while power > 0:
        if power % 2 == 1:
            found *= base
        base *= base
        power //= 2
    return found
