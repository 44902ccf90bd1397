"""Walter's rational fit to Smith's G1 of Beckmann's normals, over the exact one, and where it jumps."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves.radiometric import beckmann_masking, walter_masking
from symrender.leaves.values import joint_masking

FIT_OVER: Final = 1.01
"""No G of the fit is larger than the exact one by more than this factor."""
JUMP: Final = 1.6
"""The fit is 1 from where 1/(alpha tan theta) is so large, and is not on the other side."""
LEAST: Final = 1e-12
"""Cosine below which both are taken to be as there: what they are of is 0."""


@jitable
def fit_over_exact(inward: float, outward: float, alpha: float, correlated: float) -> float:
    """G of the fit over the exact one, of the cosines of both directions."""
    i, o = max(inward, LEAST), max(outward, LEAST)
    i, o = min(i, 1.0), min(o, 1.0)
    by_fit, exact = walter_masking(o, alpha), beckmann_masking(o, alpha)
    over = joint_masking(walter_masking(i, alpha), by_fit, correlated) * by_fit
    return over / (joint_masking(beckmann_masking(i, alpha), exact, correlated) * exact)


@jitable
def jump_cosine(alpha: float) -> float:
    """Cosine at which the fit jumps."""
    slope = JUMP * alpha
    return slope / math.sqrt(1.0 + slope * slope)
