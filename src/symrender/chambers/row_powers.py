"""Powers of a row of nodes, in passes that become vector instructions."""

from __future__ import annotations

from typing import Final

from symrender.chambers.records import NODES, Nodes
from symrender.jit.marks import inlined, jitable
from symrender.leaves.gleams import MOST_SQUARED

VECTOR: Final = 8
"""Nodes that one instruction takes at once, where processors have such wide ones."""


@inlined
def square_up(at: int, count: int, whole: int, b: Nodes) -> None:
    """``power`` = ``radix``^whole of ``count`` nodes from ``at`` on, two binary digits a turn."""
    for k in range(count):
        b.power[at + k] = 1.0
    while whole > 0:
        digits = whole % 4
        whole //= 4
        if digits == 1:
            for k in range(count):
                b.power[at + k] *= b.radix[at + k]
        elif digits == 2:
            for k in range(count):
                b.power[at + k] *= b.radix[at + k] * b.radix[at + k]
        elif digits == 3:
            for k in range(count):
                x = b.radix[at + k]
                b.power[at + k] *= x * (x * x)
        if whole > 0:
            for k in range(count):
                square = b.radix[at + k] * b.radix[at + k]
                b.radix[at + k] = square * square


@jitable
def powers(start: int, stop: int, b: Nodes, exponent: float) -> None:
    """``power`` = ``radix``^exponent of bases in [0, 1]; whole exponents to 4096 by squaring. ``radix`` is used up."""
    stop = min(stop, NODES)
    whole = int(min(exponent, MOST_SQUARED))
    if whole != exponent:
        for i in range(start, stop):
            b.power[i] = b.radix[i] ** exponent
        return
    # vector by vector, so that one stays in its register for all digits; what no whole vector covers follows
    at = start
    while at + VECTOR <= stop:
        square_up(at, VECTOR, whole, b)
        at += VECTOR
    for i in range(at, stop):
        square_up(i, 1, whole, b)
