"""Calling machine code: arguments into eight-byte slots, the result out of them."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

import numpy as np

from symrender.jit.program import Site
from symrender.jit.refused import Refused
from symrender.jit.types import B1, F8, U8, Array, Bundle, Nothing, Scalar, Tuple, Type, parts_of


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
        """Run the kernel; with checks, an index beyond an axis raises IndexError with file and line."""
        given: list[Any] = []
        for type, argument in zip(self.types, arguments, strict=True):
            _flatten(type, argument, given)
        block = np.zeros(self._slots, np.int64)
        self._given.pack_into(block.data, 0, *given)
        failed = self.entry(block.ctypes.data)
        if failed:
            site = self.sites[failed - 1]
            raise IndexError(f"{site.file}:{site.line}: {site.reason}")
        return _result(self.result, block[self._slots - len(parts_of(self.result)) :])[0]


def _codes(type: Type) -> list[str]:
    match type:
        case Scalar():
            return ["d" if type == F8 else "Q" if type == U8 else "q"]
        case Tuple(items=items) | Bundle(items=items):
            return [code for item in items for code in _codes(item)]
    return ["q"] * len(parts_of(type))


def _flatten(type: Type, value: Any, given: list[Any]) -> None:
    match type:
        case Scalar():
            given.append(value)
        case Array():
            given.append(value.__array_interface__["data"][0])
            given.extend(value.shape)
            if not type.contiguous:
                given.extend(value.strides)
        case Tuple(items=items) | Bundle(items=items):
            for item, part in zip(items, value, strict=True):
                _flatten(item, part, given)


def _result(type: Type, slots: Any) -> tuple[Any, Any]:
    """Python's value of a result, and the slots after it."""
    match type:
        case Nothing():
            return None, slots
        case Scalar():
            if type == F8:
                return float(slots[:1].view(np.float64)[0]), slots[1:]
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
