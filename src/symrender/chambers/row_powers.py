"""Powers of a row of nodes, in passes that become vector instructions."""

from __future__ import annotations

from symrender.chambers.records import NODES, Nodes
from symrender.jit.marks import jitable
from symrender.jit.moving import is_moving
from symrender.leaves.gleams import MOST_SQUARED


@jitable
def powers(start: int, stop: int, b: Nodes, exponent: float) -> None:
    """``power`` = ``radix``^exponent of bases in [0, 1]; whole exponents to 4096 by squaring. ``radix`` is used up.

    An exponent that moves is no whole number a moment later.
    """
    stop = min(stop, NODES)
    whole = int(min(exponent, MOST_SQUARED))
    if whole != exponent or is_moving(exponent):
        for i in range(start, stop):
            b.power[i] = b.radix[i] ** exponent
        return
    for i in range(start, stop):
        b.power[i] = 1.0
    # two binary digits a turn
    while whole > 0:
        digits = whole % 4
        whole //= 4
        if digits == 1:
            for i in range(start, stop):
                b.power[i] *= b.radix[i]
        elif digits == 2:
            for i in range(start, stop):
                b.power[i] *= b.radix[i] * b.radix[i]
        elif digits == 3:
            for i in range(start, stop):
                x = b.radix[i]
                b.power[i] *= x * (x * x)
        if whole > 0:
            for i in range(start, stop):
                square = b.radix[i] * b.radix[i]
                b.radix[i] = square * square
