"""A large kernel in two modules, which two processors compile side by side.

Optimising takes longer than in proportion to what there is: two halves take three quarters of the time of the whole
one after the other, and half as long side by side. A module has some of the long functions, and a copy of every short
one that they call without another long one between; calls from one module to the other are of long functions alone.
Strict arithmetic gives the same bits however functions are copied into each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from symrender.jit.function import Function

PARTS: Final = 2
LARGE: Final = 25_000
"""Lines of IR from which on a kernel is compiled in parts."""
LONG: Final = 300
"""Lines of IR of a function that is not copied from one module to the other."""


def size_of(function: Function) -> int:
    """Lines of IR of a function."""
    return len(function.lines) + len(function.slots)


def parted(entry: Function, reached: Mapping[str, Function]) -> list[list[tuple[Function, bool]]]:
    """Modules of a kernel: the functions in each, and whether the other one has it, so that it is declared alone.

    The first holds the entry. A small kernel is one module.
    """
    functions = list(reached.values())
    if sum(map(size_of, functions)) < LARGE:
        return [[(each, False) for each in functions]]
    long = {each.symbol for each in functions if not each.copied and size_of(each) >= LONG} | {entry.symbol}
    needed = {each.symbol: _short(each, long) for each in functions if each.symbol in long}
    held: list[dict[str, Function]] = [{} for _ in range(PARTS)]
    own: list[set[str]] = [set() for _ in range(PARTS)]

    def growth(part: int, symbols: Iterable[str]) -> int:
        return sum(size_of(reached[symbol]) for symbol in symbols if symbol not in held[part])

    def weight(symbol: str) -> int:
        return sum(size_of(reached[each]) for each in needed[symbol])

    for symbol in sorted(long, key=lambda symbol: (symbol != entry.symbol, -weight(symbol), symbol)):
        loads = [sum(map(size_of, held[part].values())) + growth(part, needed[symbol]) for part in range(PARTS)]
        part = loads.index(min(loads))
        own[part].add(symbol)
        held[part] |= {each: reached[each] for each in needed[symbol]}
    modules = []
    for part in range(PARTS):
        called = {callee.symbol: callee for each in held[part].values() for callee in each.callees}
        foreign = [callee for symbol, callee in called.items() if symbol in long and symbol not in own[part]]
        modules.append([(each, False) for each in held[part].values()] + [(each, True) for each in foreign])
    return modules


def _short(function: Function, long: set[str]) -> list[str]:
    """The function and all that it reaches without passing a long one."""
    found, waiting = {function.symbol: None}, [function]
    while waiting:
        for callee in waiting.pop().callees:
            if callee.symbol not in long and callee.symbol not in found:
                found[callee.symbol] = None
                waiting.append(callee)
    return list(found)
