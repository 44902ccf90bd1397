"""Memory for numbers that move: arrays and records like given ones, with room for a tangent beside every float64."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.call import racked
from symrender.jit.racks import Rack
from symrender.jit.records import R, Table, columns, flat, in_lines, table


def moving_layout(layout: np.dtype[Any]) -> np.dtype[Any]:
    """A dtype with complex128 where ``layout`` has float64, in records too; whole numbers stay."""
    if layout.subdtype is not None:
        base, shape = layout.subdtype
        return np.dtype((moving_layout(base), shape))
    if layout.fields is not None:
        fields = [(name, moving_layout(layout.fields[name][0])) for name in layout.names or ()]
        return np.dtype(fields, align=True)
    return np.dtype(np.complex128) if layout == np.float64 else layout


def moving(value: Any, tangents: Any = None) -> Any:
    """A copy of arrays, records, named tuples or racks of them, whose numbers move by ``tangents``, of the same form.

    Without ``tangents`` they stand still. Whole numbers, truth values and single floats are given back as they are.
    """
    match value:
        case tuple() if hasattr(value, "_fields"):
            moves = tangents if tangents is not None else (None,) * len(value)
            return type(value)(*(moving(item, move) for item, move in zip(value, moves, strict=True)))
        case Rack():
            still = [None] * len(value) if tangents is None else tangents
            # a tuple's own tangents do not tell its type
            return racked(moving(value.like), [moving(*pair) for pair in zip(value, still, strict=True)])
        case np.void():
            return moving(np.asarray(value)[None], None if tangents is None else np.asarray(tangents)[None])[0]
        case np.ndarray():
            if moving_layout(value.dtype) == value.dtype:
                return value
            found = in_lines(value.shape, moving_layout(value.dtype))
            _fill(found, value, tangents)
            return found
    return value


def _fill(target: npt.NDArray[Any], values: npt.NDArray[Any], tangents: npt.NDArray[Any] | None) -> None:
    if values.dtype.fields is None:
        target[...] = values
        if tangents is not None and values.dtype == np.float64:
            target.imag[...] = tangents
        return
    for name in values.dtype.names or ():
        part = None if tangents is None else np.asarray(tangents[name])
        _fill(target[name], np.asarray(values[name]), part)


def parted(rows: Any, kind: type[R]) -> tuple[Table[R], Table[R]]:
    """Values and tangents of a table that ``moving`` made of records of ``kind``, which hold float64 alone."""
    numbers = rows.view(np.complex128).reshape(len(rows), columns(kind))
    values, tangents = table(kind, len(rows)), table(kind, len(rows))
    flat(values)[:], flat(tangents)[:] = numbers.real, numbers.imag
    return values, tangents
