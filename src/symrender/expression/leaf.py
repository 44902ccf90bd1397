"""Leaf: a smooth formula, written once as a function of numbers, and the forms it is lowered to.

The function takes scalars and vectors and returns one number or several. Its argument names are those of the records'
fields; a vector ``normal`` stands for ``normal_x, normal_y, normal_z``. What a leaf is lowered to is said
where it is listed; ``docs/leaves.md`` says what each form is for.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from symrender.expression.vectors import Vec3

Formula = Callable[..., Any]


@dataclass(frozen=True)
class Rows:
    """A loop over quadrature nodes: arguments that are rows, and what becomes of each result.

    ``loads``: argument to row of its first component. ``stores``: result to (row, mode), mode ``set`` or ``scale``.
    Other arguments are the same for all nodes.
    """

    loads: tuple[tuple[str, str], ...]
    stores: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Leaf:
    """One formula. ``results`` are its results' names, in order, a vector's with ``:3``.

    ``pages``: whether pages have it too, as JavaScript and GLSL.
    """

    formula: Formula
    results: tuple[str, ...]
    rows: Rows | None = None
    pages: bool = False

    @property
    def name(self) -> str:
        """The formula's own name, and that of what is emitted."""
        return self.formula.__name__

    @property
    def doc(self) -> str:
        """What it returns, in one line."""
        text = inspect.getdoc(self.formula) or ""
        return text.split("\n")[0]

    @property
    def arguments(self) -> tuple[str, ...]:
        """Its arguments' names."""
        return tuple(inspect.signature(self.formula).parameters)

    def is_vector(self, argument: str) -> bool:
        """Whether an argument stands for three numbers."""
        return inspect.signature(self.formula).parameters[argument].annotation in (Vec3, "Vec3")

    def parts(self, argument: str) -> tuple[str, ...]:
        """The scalars an argument stands for."""
        return tuple(f"{argument}_{axis}" for axis in "xyz") if self.is_vector(argument) else (argument,)

    @property
    def scalars(self) -> tuple[str, ...]:
        """The scalars all arguments stand for, in order."""
        return tuple(part for argument in self.arguments for part in self.parts(argument))

    @property
    def result_names(self) -> tuple[str, ...]:
        """The scalars the results stand for, in order."""
        names: list[str] = []
        for result in self.results:
            name, colon, _ = result.partition(":")
            names += [f"{name}_{axis}" for axis in "xyz"] if colon else [name]
        return tuple(names)

    def __call__(self, *numbers: Any) -> tuple[Any, ...]:
        """The results, as scalars, at the scalars of the arguments."""
        given, packed = iter(numbers), []
        for argument in self.arguments:
            values = [next(given) for _ in self.parts(argument)]
            packed.append(Vec3(*values) if self.is_vector(argument) else values[0])
        return flat(self.formula(*packed))


def flat(value: Any) -> tuple[Any, ...]:
    """The scalars of a number, a vector or a tuple of both."""
    if isinstance(value, Vec3):
        return value.parts
    if isinstance(value, tuple):
        return tuple(part for item in value for part in flat(item))
    return (value,)
