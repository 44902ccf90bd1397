"""Named tuples of one type, side by side in memory, which kernels take by number.

A named tuple that a kernel is given is handed on as one address. One that is put together inside a kernel is all its
parts, dozens of numbers at every call, and a type of its own, for which everything it is handed to is compiled again.
``racked`` (``jit/call.py``) lays out beforehand what a kernel has to choose from. How many there are a kernel asks
elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

T = TypeVar("T", bound=tuple[Any, ...])


@dataclass(frozen=True, eq=False)
class Rack(Generic[T]):
    """Its ``items``; ``like`` one more of their type, that of an empty rack too.

    ``memory`` (items, slots) is what kernels read: addresses and lengths of the arrays of every item.
    """

    like: T
    items: tuple[T, ...]
    key: tuple[Any, ...]
    memory: npt.NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.items)

    def __getitem__(self, index: int) -> T:
        return self.items[index]

    def __iter__(self) -> Iterator[T]:
        return iter(self.items)


def unracked(value: Any) -> Any:
    """An argument with tuples in place of racks, as Numba knows them; of an empty one ``like``, to tell the type."""
    if isinstance(value, Rack):
        return value.items or (value.like,)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*map(unracked, value))
    return value
