"""Making what comes with the package: every kernel that is compiled meanwhile, for levels of processors too."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from symrender.jit.machine import machine_code
from symrender.jit.program import Translation
from symrender.jit.shelf import Shelf
from symrender.jit.types import Type

_WANTED: list[Shelf] = []


@contextmanager
def shipping(folder: Path, levels: Sequence[str]) -> Iterator[None]:
    """Within the block, what any thread compiles for this processor is also compiled for ``levels``, into ``folder``.

    What is found in a cache is not compiled, hence not shipped: begin with an empty one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    shelves = [Shelf(folder, level, private=False) for level in levels]
    _WANTED.extend(shelves)
    try:
        yield
    finally:
        for shelf in shelves:
            _WANTED.remove(shelf)


def folders_to_fill() -> set[Path]:
    """Folders that are being filled: none but while a wheel is made."""
    return {shelf.folder for shelf in _WANTED}


def ship(kernel: tuple[str, str], types: tuple[Type, ...], made: Translation) -> None:
    """Keep a translation on the shelves that are being filled, if any."""
    for shelf in _WANTED:
        begun = time.perf_counter()
        code = machine_code(made.modules, shelf.machine)
        shelf.put(shelf.lists(kernel, types, False), made, code, time.perf_counter() - begun)
