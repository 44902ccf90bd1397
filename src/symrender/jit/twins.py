"""Memory for numbers that move: arrays and records like given ones, with room for a tangent beside every float64."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.call import racked
from symrender.jit.racks import Rack
from symrender.jit.records import R, Table, columns, flat, in_lines, table
from symrender.jit.types import SEVERAL

ONE: Final = np.dtype(np.complex128)
"""How memory holds numbers with one tangent: as its imaginary part."""


def moving_layout(layout: np.dtype[Any], number: np.dtype[Any] = ONE) -> np.dtype[Any]:
    """A dtype with complex128, or ``SEVERAL``, where ``layout`` has float64, in records too; whole numbers stay."""
    if layout.subdtype is not None:
        base, shape = layout.subdtype
        return np.dtype((moving_layout(base, number), shape))
    if layout.fields is not None:
        fields = [(name, moving_layout(layout.fields[name][0], number)) for name in layout.names or ()]
        return np.dtype(fields, align=True)
    return number if layout == np.float64 else layout


def moving(value: Any, tangents: Any = None) -> Any:
    """A copy of arrays, records, named tuples or racks of them, whose numbers move by ``tangents``, of the same form.

    Without ``tangents`` they stand still. Whole numbers, truth values and single floats are given back as they are.
    """
    return _moving(value, (tangents,), ONE)


def moving_by(value: Any, tangents: Sequence[Any]) -> Any:
    """The same of up to four ``tangents`` at once, in arrays of ``SEVERAL``."""
    return _moving(value, tuple(tangents), SEVERAL)


def _moving(value: Any, moves: tuple[Any, ...], number: np.dtype[Any]) -> Any:
    match value:
        case tuple() if hasattr(value, "_fields"):
            parts = [tuple(None if move is None else move[k] for move in moves) for k in range(len(value))]
            return type(value)(*(_moving(item, part, number) for item, part in zip(value, parts, strict=True)))
        case Rack():
            parts = [tuple(None if move is None else move[k] for move in moves) for k in range(len(value))]
            # a tuple's own tangents do not tell its type
            items = [_moving(item, part, number) for item, part in zip(value, parts, strict=True)]
            return racked(_moving(value.like, (), number), items)
        case np.void():
            rows = tuple(None if move is None else np.asarray(move)[None] for move in moves)
            return _moving(np.asarray(value)[None], rows, number)[0]
        case np.ndarray():
            if moving_layout(value.dtype, number) == value.dtype:
                return value
            found = in_lines(value.shape, moving_layout(value.dtype, number))
            _fill(found, value, moves)
            return found
    return value


def _fill(target: npt.NDArray[Any], values: npt.NDArray[Any], moves: tuple[Any, ...]) -> None:
    if values.dtype.fields is not None:
        for name in values.dtype.names or ():
            parts = tuple(None if move is None else np.asarray(move[name]) for move in moves)
            _fill(target[name], np.asarray(values[name]), parts)
        return
    several = target.dtype == SEVERAL
    if several:
        target["value"] = values
    else:
        target[...] = values
    for k, move in enumerate(moves):
        if move is not None and several:
            target["tangents"][..., k] = move
        elif move is not None and values.dtype == np.float64:
            target.imag[...] = move


def parted(rows: Any, kind: type[R]) -> tuple[Table[R], Table[R]]:
    """Values and tangents of a table that ``moving`` made of records of ``kind``, which hold float64 alone."""
    numbers = rows.view(np.complex128).reshape(len(rows), columns(kind))
    values, tangents = table(kind, len(rows)), table(kind, len(rows))
    flat(values)[:], flat(tangents)[:] = numbers.real, numbers.imag
    return values, tangents
