"""Lambert's surface: f = reflectance/pi."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined
from symrender.numeric.radiometric.bsdfs.choice import Choice, by_cosine, spread
from symrender.numeric.vectors import Vector


@inlined
def value(reflectance: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel."""
    share = wi[2] / math.pi
    return (reflectance[0] * share, reflectance[1] * share, reflectance[2] * share)


@inlined
def density(wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    return wi[2] / math.pi


@inlined
def choose(a: float, b: float) -> Choice:
    """A direction by two numbers in [0, 1), by cos_i."""
    return spread(by_cosine(a, b))
