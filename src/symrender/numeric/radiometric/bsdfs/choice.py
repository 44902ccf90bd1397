"""What a choice of a direction is, and the directions that several materials choose."""

from __future__ import annotations

import math
from typing import NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.numeric.vectors import Vector


class Choice(NamedTuple):
    """A direction ``wi``, chosen by chance.

    Where ``sharp`` it is one of few that a smooth surface has, and ``weight`` is its share of the light over the
    probability of its choice. Else value and density of the direction tell both.
    """

    wi: Vector
    sharp: bool
    weight: Vector


@inlined
def spread(wi: Vector) -> Choice:
    """A direction out of a continuum."""
    return Choice(wi, False, (0.0, 0.0, 0.0))


@inlined
def mirrored(w: Vector) -> Vector:
    """The mirror direction."""
    return (-w[0], -w[1], w[2])


@jitable
def by_cosine(a: float, b: float) -> Vector:
    """A direction by two numbers in [0, 1), with density cos/pi."""
    turn, r = 2.0 * math.pi * b, math.sqrt(a)
    return (r * math.cos(turn), r * math.sin(turn), math.sqrt(1.0 - a))
