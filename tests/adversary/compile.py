"""How the evaluator's kernels are compiled, and kept on disk under a digest of all their texts."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])

_TEXTS: Final = ("compile", "world", "light", "places", "lattice", "chart", "scanline", "sweep", "disk")


def _folder() -> str:
    here = Path(__file__).resolve().parent
    digest = hashlib.sha256()
    for name in _TEXTS:
        if (here / f"{name}.py").exists():
            digest.update((here / f"{name}.py").read_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return str(base / "adversary" / digest.hexdigest()[:16])


_FOLDER: Final = _folder()


def kernel(function: F) -> F:
    """Compiled on first use; division by zero is infinite, as in NumPy, which spares every division its check."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = _FOLDER
    try:
        # Numba knows a stale entry by the function's own file only; the folder's name knows the others
        made: F = numba.njit(error_model="numpy", nogil=True, cache=True)(function)
    finally:
        numba.config.CACHE_DIR = before
    return made
