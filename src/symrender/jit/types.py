"""The types a kernel's values may have, and the LLVM parts each is held in.

A value is flat: an array is its address, its lengths and, unless rows follow each other without a gap, its strides; a
tuple is the parts of its items. Only what has a place of its own in memory (a named tuple given to the kernel, a
record) is an address.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import NoneType
from typing import Any, Final

import numpy as np

from symrender.jit.racks import Rack
from symrender.jit.refused import Refused


@dataclass(frozen=True)
class Scalar:
    """A number or truth value in a register."""

    name: str
    llvm: str


F8: Final = Scalar("float64", "double")
M8: Final = Scalar("moving64", "double")
"""A float64 that moves with a parameter: its value, then its tangent."""
LANES: Final = 4
W8: Final = Scalar("moving64x4", "double")
"""A float64 that moves with four parameters at once: its value, then a vector of its tangents."""
V8: Final = Scalar("tangents64x4", f"<{LANES} x double>")
"""The four tangents alone."""
MOVING: Final = (M8, W8)
I8: Final = Scalar("int64", "i64")
U8: Final = Scalar("uint64", "i64")
B1: Final = Scalar("bool", "i1")
_RANK: Final = {B1: 0, I8: 1, F8: 2, M8: 3, W8: 4, V8: 5}
SEVERAL: Final = np.dtype([("value", np.float64), ("tangents", np.float64, (LANES,))])
"""How memory holds numbers of type ``W8``."""


@dataclass(frozen=True)
class Element:
    """A number as memory holds it; ``scalar`` is what it becomes when it is read."""

    name: str
    llvm: str
    size: int
    scalar: Scalar


_ELEMENTS: Final = {
    "<f8": Element("float64", "double", 8, F8),
    "<c16": Element("moving64", "[2 x double]", 16, M8),
    "<i8": Element("int64", "i64", 8, I8),
    "<u8": Element("uint64", "i64", 8, U8),
    "<i4": Element("int32", "i32", 4, I8),
    "|i1": Element("int8", "i8", 1, I8),
    "|u1": Element("uint8", "i8", 1, I8),
    "|b1": Element("bool", "i8", 1, B1),
}
_SEVERAL: Final = Element("moving64x4", f"[{1 + LANES} x double]", 8 + 8 * LANES, W8)


@dataclass(frozen=True)
class Record:
    """One element of a structured array: its size and its fields (name, offset, what lies there)."""

    size: int
    fields: tuple[tuple[str, int, Element | Record | Block], ...]

    def field(self, name: str) -> tuple[int, Element | Record | Block] | None:
        """Offset and kind of a field, None where there is none of that name."""
        return next(((offset, kind) for key, offset, kind in self.fields if key == name), None)


@dataclass(frozen=True)
class Block:
    """A field that is an array of fixed lengths."""

    element: Element | Record
    shape: tuple[int, ...]


@dataclass(frozen=True)
class Array:
    """An array; ``contiguous`` says that its elements follow each other without gaps, last index fastest."""

    element: Element | Record
    ndim: int
    contiguous: bool


@dataclass(frozen=True)
class Tuple:
    """A tuple of known types; ``names`` are its fields if it is a named one."""

    items: tuple[Type, ...]
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Bundle:
    """A named tuple given to the kernel: it stays where the caller put it and is handed on as one address."""

    items: tuple[Type, ...]
    names: tuple[str, ...]


@dataclass(frozen=True)
class Racked:
    """Named tuples of one type that the caller holds side by side (``racks.py``): an address and how many."""

    item: Bundle


@dataclass(frozen=True)
class Nothing:
    """None."""


@dataclass(frozen=True, eq=False)
class Static:
    """What exists while translating only: a module, a function, a class, a text."""

    value: Any


Type = Scalar | Array | Tuple | Bundle | Racked | Record | Nothing | Static
NOTHING: Final = Nothing()


@dataclass(frozen=True)
class Value:
    """A value: its type and its LLVM operands, one for each of ``parts_of(type)``."""

    type: Type
    parts: tuple[str, ...] = ()


def moves_in(type: Type | Element | Block) -> bool:
    """Whether a number with a tangent lies in what is of this type."""
    match type:
        case Scalar():
            return type in MOVING
        case Element(scalar=scalar):
            return scalar in MOVING
        case Array(element=element) | Block(element=element):
            return moves_in(element)
        case Record(fields=fields):
            return any(moves_in(kind) for _, _, kind in fields)
        case Tuple(items=items) | Bundle(items=items):
            return any(map(moves_in, items))
        case Racked(item=item):
            return moves_in(item)
    return False


def parts_of(type: Type) -> tuple[str, ...]:
    """LLVM types of the parts of a value."""
    match type:
        case Scalar():
            return (type.llvm, *((V8.llvm if type == W8 else type.llvm,) if type in MOVING else ()))
        case Array():
            return ("ptr", *("i64",) * (type.ndim if type.contiguous else 2 * type.ndim))
        case Tuple():
            return tuple(part for item in type.items for part in parts_of(item))
        case Bundle() | Record():
            return ("ptr",)
        case Racked():
            return ("ptr", "i64")
    return ()


def slopes_of(type: Type) -> Scalar:
    """Type of the tangents of numbers of a type that moves, or of ``V8`` itself."""
    return F8 if type == M8 else V8


def size_of(element: Element | Record) -> int:
    """Bytes of one element of an array."""
    return element.size


def join(a: Type, b: Type) -> Type:
    """The type that holds values of both; raises ``Refused`` where there is none."""
    if a == b:
        return a
    match a, b:
        case Scalar(), Scalar() if a in _RANK and b in _RANK and not (V8 in (a, b) and (a in MOVING or b in MOVING)):
            return a if _RANK[a] >= _RANK[b] else b
        case Array(), Array() if a.element == b.element and a.ndim == b.ndim:
            return Array(a.element, a.ndim, False)
        case Tuple(), Tuple() if len(a.items) == len(b.items):
            return Tuple(tuple(map(join, a.items, b.items)), a.names if a.names == b.names else ())
    raise Refused(f"one name or result is both {shown(a)} and {shown(b)}")


def shown(type: Type) -> str:
    """The type in words."""
    match type:
        case Scalar(name=name):
            return name
        case Array():
            kind = type.element.name if isinstance(type.element, Element) else "record"
            return f"array({kind}, {type.ndim} axes{'' if type.contiguous else ', strided'})"
        case Tuple():
            return f"tuple({', '.join(map(shown, type.items))})"
        case Bundle():
            return f"named tuple({', '.join(type.names)})"
        case Racked(item=item):
            return f"rack of {shown(item)}"
        case Record():
            return f"record({', '.join(name for name, _, _ in type.fields)})"
        case Nothing():
            return "None"
    return f"{type.value!r}"


def element_of(dtype: np.dtype[Any]) -> Element | Record:
    """What one element of an array of ``dtype`` is."""
    if dtype == SEVERAL:
        return _SEVERAL
    if dtype.fields is not None:
        fields = []
        for name in dtype.names or ():
            kind, offset = dtype.fields[name][:2]
            fields.append((name, int(offset), _field_of(kind)))
        return Record(dtype.itemsize, tuple(fields))
    if dtype.str in _ELEMENTS:
        return _ELEMENTS[dtype.str]
    raise Refused(f"arrays of {dtype} are outside the subset")


def _field_of(dtype: np.dtype[Any]) -> Element | Record | Block:
    if dtype.subdtype is not None:
        base, shape = dtype.subdtype
        return Block(element_of(base), tuple(int(n) for n in shape))
    return element_of(dtype)


def type_of(value: Any) -> Type:
    """Type of an argument given from Python."""
    if isinstance(value, np.bool_ | bool):
        return B1
    if isinstance(value, np.uint64):
        return U8
    if isinstance(value, np.signedinteger | int):
        return I8
    match value:
        case float():
            return F8
        case complex():
            return M8
        case np.ndarray():
            if not value.flags.aligned:
                raise Refused("an array is not aligned")
            return Array(element_of(value.dtype), value.ndim, bool(value.flags.c_contiguous))
        case np.void():
            record = element_of(value.dtype)
            if isinstance(record, Record):
                return record
        case tuple():
            items = tuple(map(type_of, value))
            names = getattr(type(value), "_fields", None)
            return Tuple(items) if names is None else Bundle(items, tuple(names))
        case Rack():
            item = type_of(value.like)
            if isinstance(item, Bundle):
                return Racked(item)
        case NoneType():
            return NOTHING
    raise Refused(f"arguments of type {type(value).__name__} are outside the subset")


def slots_of(type: Type) -> int:
    """Number of eight-byte slots in which an argument of this type is handed to the kernel."""
    match type:
        case Bundle():
            return sum(map(slots_of, type.items))
        case _:
            return len(parts_of(type)) if not isinstance(type, Tuple) else sum(map(slots_of, type.items))


def elements_in(shape: tuple[int, ...]) -> int:
    """Number of elements of a field of this shape."""
    return math.prod(shape)


def result_named(type: Type) -> Any:
    """A kernel's result type as JSON holds it."""
    match type:
        case Nothing():
            return None
        case Scalar(name=name):
            return name
        case Tuple(items=items):
            return [result_named(item) for item in items]
    raise Refused("a kernel gives back numbers and tuples of them only")


def result_of(named: Any) -> Type:
    """The type that ``result_named`` wrote down."""
    if named is None:
        return NOTHING
    if isinstance(named, list):
        return Tuple(tuple(map(result_of, named)))
    return {each.name: each for each in (F8, M8, I8, U8, B1)}[named]
