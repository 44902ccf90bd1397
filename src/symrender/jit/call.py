"""Calling machine code: arguments into eight-byte slots, the result out of them."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from symrender.jit.program import Site
from symrender.jit.racks import Rack, T
from symrender.jit.refused import Refused
from symrender.jit.types import B1, F8, M8, U8, Bundle, Nothing, Scalar, Tuple, Type, parts_of, type_of


class Loaded:
    """Machine code of a kernel for arguments of given types."""

    def __init__(
        self, entry: Callable[[int], int], types: tuple[Type, ...], result: Type, sites: tuple[Site, ...] = ()
    ) -> None:
        self.entry, self.types, self.result, self.sites = entry, types, result, sites
        codes = [code for type in types for code in _codes(type)]
        self._given = struct.Struct(f"={''.join(codes)}")
        self._slots = len(codes) + len(parts_of(result))

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel for arguments of its types."""
        given: list[Any] = []
        for argument in arguments:
            flatten(argument, [], given)
        return self.run(given)

    def run(self, given: list[Any]) -> Any:
        """Run the kernel for flat arguments; a check that fails raises IndexError with file and line."""
        block = np.zeros(self._slots, np.int64)
        self._given.pack_into(block.data, 0, *given)
        failed = self.entry(block.ctypes.data)
        if failed:
            site = self.sites[failed - 1]
            raise IndexError(f"{site.file}:{site.line}: {site.reason}")
        return _result(self.result, block[self._slots - len(parts_of(self.result)) :])[0]


def _codes(type: Type) -> list[str]:
    match type:
        case Scalar() if type == M8:
            return ["d", "d"]
        case Scalar():
            return ["d" if type == F8 else "Q" if type == U8 else "q"]
        case Tuple(items=items) | Bundle(items=items):
            return [code for item in items for code in _codes(item)]
    return ["q"] * len(parts_of(type))


def flatten(value: Any, key: list[Any], given: list[Any]) -> None:
    """Append what fills an argument's slots to ``given``, and to ``key`` what tells its type apart from others.

    This runs at every call, for every array of a named tuple: it asks no more than it must.
    """
    kind = type(value)
    if kind is np.ndarray:
        flags = value.flags
        key += (value.dtype, value.ndim, flags.c_contiguous, flags.aligned)
        # of an array of records the interface would describe every field
        plain = value.dtype.names is None
        given.append(value.__array_interface__["data"][0] if plain else value.ctypes.data)
        given.extend(value.shape)
        if not flags.c_contiguous:
            given.extend(value.strides)
    elif isinstance(value, tuple):
        key += (kind, len(value))
        for item in value:
            flatten(item, key, given)
    elif isinstance(value, np.void):
        key.append(value.dtype)
        # an array of its bytes tells the address ten times faster than the record does
        given.append(np.frombuffer(value, np.uint8).__array_interface__["data"][0])
    elif kind is Rack:
        key += (kind, value.key)
        given += (value.memory.ctypes.data, len(value))
    elif isinstance(value, complex):
        key.append(kind)
        given += (value.real, value.imag)
    else:
        key.append(kind)
        if value is not None:
            given.append(int(value) if kind is bool or kind is np.bool_ else value)


def racked(like: T, items: Sequence[T]) -> Rack[T]:
    """A rack of these named tuples, all of the type of ``like``, which no one changes while it is in use.

    Raises ``TypeError`` where one is of another type: arrays of other numbers, of more axes or with gaps.
    """
    key: list[Any] = []
    flatten(like, key, [])
    packed = struct.Struct(f"={''.join(_codes(type_of(like)))}")
    memory = np.zeros((len(items), packed.size // 8), np.int64)
    for row, item in zip(memory, items, strict=True):
        own: list[Any] = []
        given: list[Any] = []
        flatten(item, own, given)
        if own != key:
            raise TypeError(f"a {type(item).__name__} of another type than the first in its rack")
        packed.pack_into(row.data, 0, *given)
    return Rack(like, tuple(items), tuple(key), memory)


def _result(type: Type, slots: Any) -> tuple[Any, Any]:
    """Python's value of a result, and the slots after it."""
    match type:
        case Nothing():
            return None, slots
        case Scalar():
            if type == F8:
                return float(slots[:1].view(np.float64)[0]), slots[1:]
            if type == M8:
                return complex(*slots[:2].view(np.float64)), slots[2:]
            if type == U8:
                return np.uint64(slots[:1].view(np.uint64)[0]), slots[1:]
            return (bool(slots[0]) if type == B1 else int(slots[0])), slots[1:]
        case Tuple(items=items):
            found = []
            for item in items:
                value, slots = _result(item, slots)
                found.append(value)
            return tuple(found), slots
    raise Refused("a kernel gives back numbers and tuples of them only")
