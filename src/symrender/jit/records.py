"""Records: rows of memory whose numbers have names, as kernels read and write them.

A subclass of ``Record`` lists its fields with annotations, in the order in which they lie in memory:

    class Wall(Record):
        kind: int                  # 8 bytes, whole
        axis: Three                # three float64
        cos: float                 # one float64
        light: LightPoint          # a record in a record

``table(Wall, n)`` is an array of n of them, all zero, and ``table[i].cos`` a number of one; compiled kernels read it at
an offset known when they are compiled, plain Python through the array, so that both see and change the same memory.
``rows_of(Wall, array)`` lets the rows of a float64 array be read as records without a copy.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from operator import itemgetter
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Final,
    Protocol,
    TypeVar,
    cast,
    get_args,
    get_origin,
    get_type_hints,
    overload,
)

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Two = Annotated[Array, 2]
Three = Annotated[Array, 3]

R = TypeVar("R", bound="Record")
S = TypeVar("S")

LINE: Final = 64
"""Bytes of a line of the cache."""
FEW_LINES: Final = 64
"""Lines of an array that is small enough to lie anywhere."""

if TYPE_CHECKING:
    # NumPy's stubs call its rows final; they are not
    class _Row:
        def __setitem__(self, name: str, value: Any) -> None: ...

else:
    _Row = np.void


class Record(_Row):
    """One row. ``layout`` is the NumPy dtype; a field is an attribute.

    Raises ``TypeError`` where a field is of another kind than float, int, a fixed number of float64 or a record, or is
    named as something NumPy's arrays and rows have already.
    """

    layout: ClassVar[np.dtype[np.void]]

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Its fields, in the order in which they lie in memory."""
        return cls.layout.names or ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        fields = []
        for name, hint in get_type_hints(cls, include_extras=True).items():
            if get_origin(hint) is ClassVar or name == "layout":
                continue
            if hasattr(np.ndarray, name) or hasattr(np.void, name):
                raise TypeError(f"{cls.__name__}.{name}: arrays have an attribute of this name")
            fields.append((name, *_kind(cls, name, hint)))
            setattr(cls, name, _field(name))
        cls.layout = np.dtype((cls, np.dtype(fields, align=True)))


def _kind(owner: type, name: str, hint: Any) -> tuple[Any, ...]:
    if hint is float:
        return ("f8",)
    if hint is int:
        return ("i8",)
    if get_origin(hint) is Annotated:
        return ("f8", get_args(hint)[1])
    if isinstance(hint, type) and issubclass(hint, Record):
        return (hint.layout,)
    raise TypeError(f"{owner.__name__}.{name}: {hint} cannot lie in a record")


def _field(name: str) -> property:
    def put(row: Record, value: Any) -> None:
        row[name] = value

    return property(itemgetter(name), put)


class Table(Protocol[R]):
    """An array of records with one axis; a field's name as index gives the array of that field."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of its axes."""

    def __len__(self) -> int: ...

    @overload
    def __getitem__(self, index: int, /) -> R: ...

    @overload
    def __getitem__(self, index: str, /) -> Array: ...

    def __setitem__(self, index: int, row: R, /) -> None: ...

    def __iter__(self) -> Iterator[R]: ...


class Grid(Protocol[R]):
    """An array of records with two axes."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of its axes."""

    @overload
    def __getitem__(self, index: tuple[int, int], /) -> R: ...

    @overload
    def __getitem__(self, index: int, /) -> Table[R]: ...

    @overload
    def __getitem__(self, index: str, /) -> Array: ...


def in_lines(shape: tuple[int, ...], layout: np.dtype[Any]) -> npt.NDArray[Any]:
    """An array of zeros that begins where a line of the processor's cache does, if it is longer than a few.

    What instructions take of a row of nodes at once is as long as such a line, and across two of them takes longer.
    """
    size = math.prod(shape) * layout.itemsize
    if size < FEW_LINES * LINE:
        return np.zeros(shape, layout)
    room = np.zeros(size + LINE, np.uint8)
    first = -room.ctypes.data % LINE
    return room[first : first + size].view(layout).reshape(shape)


def grid(kind: type[R], rows: int, count: int) -> Grid[R]:
    """``rows`` times ``count`` records of this kind, all zero."""
    return cast("Grid[R]", np.zeros((rows, count), kind.layout))


def table(kind: type[R], count: int) -> Table[R]:
    """``count`` records of this kind, all zero."""
    return cast("Table[R]", in_lines((count,), kind.layout))


def copied(rows: S) -> S:
    """A record or table of its own, of the same numbers."""
    # np.array of a bare record would share its memory
    return cast("S", np.array(rows) if isinstance(rows, np.ndarray) else np.array([rows])[0])


def chosen(rows: Table[R], which: npt.NDArray[np.bool_]) -> Table[R]:
    """The records of a table for which ``which`` is true, copied."""
    return cast("Table[R]", cast("npt.NDArray[np.void]", rows)[which])


def record(kind: type[R]) -> R:
    """One record of this kind, all zero."""
    return table(kind, 1)[0]


def flat(records: Table[R] | R) -> Array:
    """The numbers of records of float64 alone: (n, k) of a table, (k,) of one record; memory is shared."""
    rows = np.asarray(records)
    # only arrays with axes can be looked at as other numbers
    return rows[None].view(np.float64).reshape((*rows.shape, rows.dtype.itemsize // 8))


def column(kind: type[Record], name: str) -> int:
    """Where a field begins in ``flat`` records, counted in numbers; KeyError for what is no field."""
    return int(kind.layout.fields[name][1]) // 8 if kind.layout.fields else 0


def named(kind: type[Record], place: int) -> str:
    """What stands at this place of ``flat`` records, as Python writes it: ``radius`` or ``center[2]``."""
    for name in kind.names():
        first, size = column(kind, name), kind.layout[name].itemsize // 8
        if first <= place < first + size:
            return name if size == 1 else f"{name}[{place - first}]"
    raise KeyError(f"{kind.__name__} has no number {place}")


def columns(kind: type[Record]) -> int:
    """How many numbers a record holds."""
    return kind.layout.itemsize // 8


def joined(kind: type[R], tables: Sequence[Table[R]]) -> Table[R]:
    """One table of the records of several, which may be none."""
    return cast("Table[R]", np.concatenate([table(kind, 0), *tables]))


def one(row: R) -> Table[R]:
    """A table of its own, of this record alone."""
    return cast("Table[R]", np.array([row], type(row).layout))


def stacked(kind: type[R], tables: Sequence[Table[R]], count: int) -> Grid[R]:
    """Tables of ``count`` records each, of which there may be none, as the rows of a grid."""
    return cast("Grid[R]", np.stack(cast("Sequence[Array]", tables)) if tables else grid(kind, 0, count))


def rows_of(kind: type[R], rows: Array) -> Table[R]:
    """The rows of a float64 array (n, k), or one row (k,), as records of k numbers; memory is shared.

    Raises ``ValueError`` where a row has another length than the record or does not lie in one piece.
    """
    rows = rows[None] if rows.ndim == 1 else rows
    size = kind.layout.itemsize
    if rows.dtype != np.float64 or rows.shape[-1] * 8 != size or not rows.flags.c_contiguous:
        raise ValueError(f"rows of {rows.shape[-1]} {rows.dtype} are no {kind.__name__} of {size // 8} numbers")
    return cast("Table[R]", rows.view(kind.layout)[..., 0])
