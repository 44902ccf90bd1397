"""A large kernel in parts, a module for each of its long functions, which are compiled apart and kept apart.

Kernels have most of their functions in common: a derivative's calls what the value's calls. A part is a long function
and a copy of every short one that it calls without another long one between; calls from part to part are of long
functions alone. Its text is the same in every kernel, so that its machine code, kept under that text (``shelf.py``), is
compiled once. A small kernel is one module. Strict arithmetic gives the same bits however functions are copied into
each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from symrender.jit.function import Function

LARGE: Final = 25_000
"""Lines of IR from which on a kernel is compiled in parts."""
LONG: Final = 400
"""Lines of IR of a function that is not copied from one part to another. With 400 `truth` and `gradient` run within 2 %
of what two modules take, with 200 and 300 they run 2 to 5 % longer; the fewer, the more kernels share."""


def size_of(function: Function) -> int:
    """Lines of IR of a function."""
    return len(function.lines) + len(function.slots)


def parted(entry: Function, reached: Mapping[str, Function]) -> list[list[tuple[Function, bool]]]:
    """Modules of a kernel: the functions in each, and whether another one has it, so that it is declared alone.

    The first holds the entry. A small kernel is one module.
    """
    functions = list(reached.values())
    if sum(map(size_of, functions)) < LARGE:
        return [[(each, False) for each in functions]]
    long = {each.symbol: each for each in functions if not each.copied and size_of(each) >= LONG}
    return [_part(each, long.keys()) for each in ({entry.symbol: entry} | long).values()]


def _part(function: Function, long: Set[str]) -> list[tuple[Function, bool]]:
    """The function and all that it reaches without passing a long one, and the long ones that these call."""
    foreign: dict[str, Function] = {}
    held, waiting = {function.symbol: function}, [function]
    while waiting:
        for callee in waiting.pop().callees:
            if callee.symbol in held:
                continue
            if callee.symbol in long:
                foreign[callee.symbol] = callee
            else:
                held[callee.symbol] = callee
                waiting.append(callee)
    return [(each, False) for each in held.values()] + [(each, True) for each in foreign.values()]
