"""Program: straight-line SymPy assignments, counted loops, guards and calls; nothing else.

Every value is a scalar: a real (float64, or float32 on a GPU) or a whole number. Arrays are only read and written
by element. Names come from the code that lowers a formula, never from a scene.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import sympy as sp

from symrender.expression.vectors import Vec3
from symrender.jit.records import Record, column


@dataclass(frozen=True)
class Let:
    """``name = value``; a name may be assigned again, which is how accumulators are written."""

    name: sp.Symbol
    value: sp.Basic


@dataclass(frozen=True)
class Store:
    """``array[index] = value``"""

    element: sp.Indexed
    value: sp.Expr


@dataclass(frozen=True)
class Loop:
    """``body`` for index = first, ..., count - 1."""

    index: sp.Symbol
    first: sp.Expr
    count: sp.Expr
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class When:
    """``body`` where the condition holds, ``otherwise`` where it does not."""

    condition: sp.Basic
    body: tuple[Statement, ...]
    otherwise: tuple[Statement, ...] = ()


@dataclass(frozen=True)
class Next:
    """Go on with the next turn of the innermost loop."""


@dataclass(frozen=True)
class Return:
    """Leave the function with these values."""

    values: tuple[sp.Basic, ...]


@dataclass(frozen=True)
class Call:
    """``targets = function(arguments)``; an argument is an expression or an array."""

    targets: tuple[sp.Symbol, ...]
    function: str
    arguments: tuple[sp.Basic, ...]


Statement = Let | Store | Loop | When | Next | Return | Call


class length(sp.Function):
    """Number of rows of an array."""

    nargs = 1
    is_integer = True


@dataclass(frozen=True)
class Array:
    """An array parameter and its number of axes; ``a[i, j]`` is an element."""

    name: str
    axes: int

    def __getitem__(self, index: sp.Expr | int | tuple[sp.Expr | int, ...]) -> sp.Indexed:
        position = index if isinstance(index, tuple) else (index,)
        if len(position) != self.axes:
            raise IndexError(f"{self.name} has {self.axes} axes, got {len(position)} indices")
        return sp.IndexedBase(self.name, real=True)[position]

    @property
    def length(self) -> sp.Expr:
        """Number of rows."""
        return length(self.symbol)

    @property
    def symbol(self) -> sp.Symbol:
        """The array itself, as an argument of a call."""
        return sp.Symbol(self.name)


@dataclass(frozen=True)
class Records(Array):
    """A table of records (two axes), or one record (one axis), of float64 fields.

    An element is held by the number of its place in the record; languages that know records print the field's name.
    """

    record: type[Record]

    def field(self, name: str, row: sp.Expr | int | None = None, part: sp.Expr | int = 0) -> sp.Indexed:
        """A number of a field: ``part`` of a vector, of this ``row`` of a table."""
        place = column(self.record, name) + part
        return self[place] if row is None else self[row, place]

    def vector(self, name: str, row: sp.Expr | int | None = None) -> Vec3:
        """A field of three numbers."""
        return Vec3(*(self.field(name, row, k) for k in range(3)))


Parameter: TypeAlias = sp.Symbol | Array


@dataclass(frozen=True)
class Function:
    """A named function; a parameter is a real or whole symbol or an array; ``doc`` says what it returns.

    ``inline`` asks a compiler to copy it into its callers: it is on the path of every hit.
    """

    name: str
    parameters: tuple[Parameter, ...]
    body: tuple[Statement, ...]
    doc: str
    inline: bool = False


@dataclass(frozen=True)
class Program:
    """Functions in the order of definition; ``entries`` are the ones called from outside."""

    functions: tuple[Function, ...]
    entries: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        defined: set[str] = set()
        for function in self.functions:
            for called in _calls(function.body):
                if called not in defined:
                    raise ValueError(f"{function.name} calls {called}, which is not defined before it")
            defined.add(function.name)
        missing = set(self.entries) - defined
        if missing:
            raise ValueError(f"no function for the entries {sorted(missing)}")

    @property
    def called(self) -> tuple[str, ...]:
        """Names of the functions other functions call, in the order of definition."""
        found = {name for function in self.functions for name in _calls(function.body)}
        return tuple(function.name for function in self.functions if function.name in found)

    def part(self, entry: str) -> Program:
        """``entry`` and what it needs, in the order of definition."""
        needed, kept = {entry}, []
        for function in reversed(self.functions):
            if function.name in needed:
                kept.append(function)
                needed.update(_calls(function.body))
        return Program(tuple(reversed(kept)), (entry,))


def _calls(body: tuple[Statement, ...]) -> list[str]:
    names: list[str] = []
    for statement in body:
        match statement:
            case Call(function=name):
                names.append(name)
            case Loop(body=inner):
                names += _calls(inner)
            case When(body=inner, otherwise=other):
                names += _calls(inner) + _calls(other)
    return names
