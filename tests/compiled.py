"""Kernels of tests: compiled by Numba on first use, and kept on disk under a digest of all texts they are made of."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])


def keeper(name: str, texts: Iterable[Path], **options: Any) -> Callable[[F], F]:
    """A decorator for the kernels of ``texts``, which may call each other; ``options`` are Numba's."""
    digest = hashlib.sha256()
    for path in texts:
        digest.update(path.read_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = str(base / name / digest.hexdigest()[:16])

    def kernel(function: F) -> F:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = folder
        try:
            # Numba knows a stale entry by the function's own file only; the folder's name knows the others
            made: F = numba.njit(cache=True, **options)(function)
        finally:
            numba.config.CACHE_DIR = before
        return made

    return kernel
