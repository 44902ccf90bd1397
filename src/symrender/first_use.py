"""What is compiled before a first picture, said before it is waited for, with the time it takes."""

from __future__ import annotations

import hashlib
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from symrender import kernel_cache
from symrender.tiles import Progress
from symrender.units import code_digest

USUAL: Final = {"numeric": 10.0, "symbolic": 10.0, "truth": 25.0, "gradient": 40.0}
"""Seconds a kind of image takes to compile where none was compiled before, on two processors of 2023."""


@contextmanager
def first_use(kind: str, progress: Progress | None, *, whole: bool = True) -> Iterator[None]:
    """Within the block the kernels of ``kind`` are made ready: ``progress`` hears of it if they must be compiled.

    It is told 0 of 0 under a label that says how long that should take: as long as it took here last, or ``USUAL``.
    Without ``whole`` the block only waits for the rest of a compilation, whose time says nothing.
    """
    mark = compiled_mark(kind)
    if mark is None or kernel_cache.read_entry(mark) is not None:
        yield
        return
    if progress is not None:
        progress(0, 0, f"compiling {kind} kernels, once: about {expected_seconds(kind):.0f} s")
    begun = time.monotonic()
    yield
    if whole:
        kernel_cache.write_entry(_last(mark.parent, kind), f"{time.monotonic() - begun:.3f}".encode())
    kernel_cache.write_entry(mark, b"")


def compiled_mark(kind: str) -> Path | None:
    """Cache entry that says the kernels of ``kind``, of this very code, have been compiled; None without a cache."""
    directory, _ = kernel_cache.cache_directory()
    if directory is None:
        return None
    return directory / f"{hashlib.sha256(f'{sys.version} {code_digest()} {kind}'.encode()).hexdigest()}.compiled"


def expected_seconds(kind: str) -> float:
    """Seconds the kernels of ``kind`` should take to compile."""
    directory, _ = kernel_cache.cache_directory()
    kept = None if directory is None else kernel_cache.read_entry(_last(directory, kind))
    try:
        return float(kept) if kept is not None else USUAL.get(kind, 15.0)
    except ValueError:
        return USUAL.get(kind, 15.0)


def _last(directory: Path, kind: str) -> Path:
    return directory / f"{kind}.seconds"
