"""Formulas of scene files: trees of plain data, which are read and never executed as text.

A tree is a number, a coordinate ``x``, ``y`` or ``z``, or a mapping of one operation to what it is done to:
``{sin: {mul: [6, x]}}``. All operations are smooth, so that a formula has one gradient everywhere, but for a distance,
which has none at its centre.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Final, NamedTuple

from pydantic import BeforeValidator, Field
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_COORDINATE, MAX_FORMULA_DEPTH, MAX_FORMULA_POWER, MAX_OPERANDS, MAX_TERMS
from symrender.scene.nearest import did_you_mean
from symrender.scene.printable import shown
from symrender.scene.values import Held

COORDINATES: Final = ("x", "y", "z")
SUMS: Final = ("add", "mul")
"""Operations of two and more formulas."""
WAVES: Final = ("sin", "cos", "exp")
"""Functions of one formula."""
OPERATIONS: Final = (*SUMS, "sub", *WAVES, "pow", "distance")
_AXES: Final = 3

Number = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, json_schema_extra={"unit": "1"})]
NUMBER: Final = FieldInfo.from_annotation(Number)
"""Any number of a formula as a field."""


class Step(NamedTuple):
    """One operation of a formula written out; ``first`` and ``second`` are earlier steps, by their place.

    ``kind`` is an operation, a coordinate or ``number``, whose value ``number`` is; of ``pow`` that is the exponent.
    ``center`` is that of a ``distance``.
    """

    kind: str
    number: float = 0.0
    first: int = 0
    second: int = 0
    center: tuple[float, ...] = (0.0, 0.0, 0.0)


class Tree:
    """Marks a field that holds a formula."""


def is_formula(info: FieldInfo) -> bool:
    """Whether a field holds a formula."""
    return any(isinstance(mark, Tree) for mark in info.metadata)


def _wrong(message: str, path: tuple[str | int, ...]) -> PydanticCustomError:
    return PydanticCustomError("scene", message, {"path": path})


def _number(value: Any, path: tuple[str | int, ...]) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _wrong(f"must be a number, got {shown(value)}", path)
    if not abs(value) <= MAX_COORDINATE:
        raise _wrong(f"must be finite and at most {MAX_COORDINATE:g} in size, got {shown(value)}", path)
    return float(value)


def _operands(value: Any, path: tuple[str | int, ...], least: int, most: int, what: str) -> list[Any]:
    """A list of so many entries."""
    if not isinstance(value, list | tuple) or not least <= len(value) <= most:
        count = str(least) if least == most else f"{least} to {most}"
        raise _wrong(f"must be a list of {count} {what}, got {shown(value)}", path)
    return list(value)


def _checked(value: Any, path: tuple[str | int, ...], depth: int) -> Any:
    """The tree as numbers, names, tuples and mappings that cannot be changed."""
    if depth > MAX_FORMULA_DEPTH:
        raise _wrong(f"a formula must be at most {MAX_FORMULA_DEPTH} deep", path)
    if isinstance(value, str):
        if value not in COORDINATES:
            raise _wrong(f"must be a number, x, y, z or a mapping of one operation, got {shown(value)}", path)
        return value
    if not isinstance(value, Mapping):
        return _number(value, path)
    if len(value) != 1:
        raise _wrong(f"must be a mapping of one operation, got {len(value)} keys", path)
    (name, given) = next(iter(value.items()))
    below = (*path, name)
    if name not in OPERATIONS:
        guess = did_you_mean(str(name), OPERATIONS) or f", known are {', '.join(OPERATIONS)}"
        raise _wrong(f"unknown operation{guess}", below)
    if name in WAVES:
        return Held({name: _checked(given, below, depth + 1)})
    if name == "pow":
        base, power = _operands(given, below, 2, 2, "entries, a formula and a whole number")
        if type(power) is not int or not 1 <= power <= MAX_FORMULA_POWER:
            raise _wrong(f"must be a whole number from 1 to {MAX_FORMULA_POWER}, got {shown(power)}", (*below, 1))
        return Held(pow=(_checked(base, (*below, 0), depth + 1), power))
    if name == "distance":
        center = _operands(given, below, _AXES, _AXES, "numbers")
        return Held(distance=tuple(_number(each, (*below, k)) for k, each in enumerate(center)))
    parts = _operands(given, below, 2, 2 if name == "sub" else MAX_OPERANDS, "formulas")
    return Held({name: tuple(_checked(each, (*below, k), depth + 1) for k, each in enumerate(parts))})


def _formula(value: Any) -> Any:
    tree = _checked(value, (), 1)
    steps = steps_of(tree)
    if len(steps) > MAX_TERMS:
        raise _wrong(f"a formula may have at most {MAX_TERMS} numbers, coordinates and operations", ())
    if not any(step.kind in (*COORDINATES, "distance") for step in steps):
        raise _wrong("must depend on x, y or z: a constant height turns nothing", ())
    return tree


Formula = Annotated[Any, Tree(), BeforeValidator(_formula)]


def steps_of(tree: Any) -> list[Step]:
    """The tree written out, what is needed before what needs it; the last step is the formula."""
    steps: list[Step] = []

    def put(step: Step) -> int:
        steps.append(step)
        return len(steps) - 1

    def lay(tree: Any) -> int:
        if isinstance(tree, str):
            return put(Step(tree))
        if not isinstance(tree, Mapping):
            return put(Step("number", tree))
        (name, given) = next(iter(tree.items()))
        if name in WAVES:
            return put(Step(name, first=lay(given)))
        if name == "pow":
            return put(Step("pow", float(given[1]), lay(given[0])))
        if name == "distance":
            return put(Step("distance", center=tuple(given)))
        whole = lay(given[0])
        for part in given[1:]:
            whole = put(Step(name, first=whole, second=lay(part)))
        return whole

    lay(tree)
    return steps


def numbers_of(tree: Any) -> Iterator[tuple[str, float]]:
    """(end of its dotted name, value) of every real number of a tree."""
    if isinstance(tree, Mapping):
        for name, part in tree.items():
            for end, value in numbers_of(part):
                yield f".{name}{end}", value
    elif isinstance(tree, tuple):
        for index, part in enumerate(tree):
            for end, value in numbers_of(part):
                yield f"[{index}]{end}", value
    elif isinstance(tree, float) and math.isfinite(tree):
        yield "", tree
