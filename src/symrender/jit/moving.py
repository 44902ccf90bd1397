"""What a kernel may ask of numbers that move with a parameter, and what it says of them.

A kernel given complex arrays where it has float64 ones carries a tangent beside every number: the real part is the
value, the imaginary part its derivative along a move (``tangents.py``). Given arrays of ``types.SEVERAL`` it carries
four, of four moves at once; what is made of their tangents alone has four numbers then, and a function that is handed
such is called for each of the four. Decisions are those of the values. The first six functions here are translated as
they stand where numbers do not move, and cost nothing then.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined

Array = npt.NDArray[np.float64]


@inlined
def moves(x: float) -> bool:
    """Whether ``x`` has a tangent; known while translating, so that what stands under it is left out if not."""
    return False


@inlined
def held(x: float) -> float:
    """The value of ``x`` alone."""
    return x


@inlined
def tangent(x: float) -> float:
    """The tangent of ``x``, itself a number that stands still; 0 where it has none."""
    return 0.0


@inlined
def moved(x: float, slope: float) -> float:
    """The value of ``x`` with the value of ``slope`` as its tangent; stands under ``moves`` only."""
    return x


@inlined
def most(slope: float) -> float:
    """The largest of the four where ``slope`` is made of four tangents."""
    return slope


@inlined
def rising(slope: float) -> int:
    """Which of the four are above 0, as bits, where ``slope`` is made of four tangents; else 1 if it is."""
    return 1 if slope > 0.0 else 0


@inlined
def is_moving(x: float) -> bool:
    """Whether ``x`` has a tangent that is not 0."""
    return moves(x) and most(abs(tangent(x))) > 0.0


@inlined
def at_most(x: float) -> float:
    """Size of the value of ``x``, and of its tangent where it has one: what bounds light by it bounds both."""
    return abs(held(x)) + most(abs(tangent(x)))


@inlined
def brightest(color: Array) -> float:
    """The largest ``at_most`` of a colour's channels."""
    return max(at_most(color[0]), at_most(color[1]), at_most(color[2]))
