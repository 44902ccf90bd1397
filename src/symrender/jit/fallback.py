"""Numba, for what the translator refuses and as a judge of what it makes."""

from __future__ import annotations

import hashlib
import logging
import pickle
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from symrender.jit.entries import cache_directory, read_entry, write_entry
from symrender.jit.marks import known_to_numba


def dispatcher(function: Callable[..., Any], sources: Sequence[str], options: dict[str, Any]) -> Any:
    """Numba's dispatcher of ``function``, cached on disk under a key that holds the texts ``sources``."""
    import numba

    known_to_numba()
    settings: dict[str, Any] = {"nogil": True, "error_model": "numpy"} | options
    made = numba.njit(**settings)(function)
    directory, _ = cache_directory()
    if directory is not None:
        name = f"{function.__module__}.{function.__qualname__}"
        made._cache = _store(directory, (name, repr(sorted(settings.items(), key=repr)), *sources))
    return made


def _store(directory: Path, parts: Sequence[str]) -> Any:
    """Numba cache object that keeps one file per signature under names derived from ``parts``."""
    import llvmlite
    import numba
    from numba.core import caching, compiler, config, serialize

    class Store(caching._Cache):  # type: ignore[misc]
        def __init__(self) -> None:
            self.on = True

        @property
        def cache_path(self) -> str:
            return str(directory)

        def path(self, signature: Any, codegen: Any) -> Path:
            versions = (sys.version, np.__version__, numba.__version__, llvmlite.__version__)
            machine = (codegen.magic_tuple(), str(config.OPT), config.BOUNDSCHECK)
            key = hashlib.sha256(repr((versions, machine, str(signature), tuple(parts))).encode())
            return directory / f"{key.hexdigest()}.kernel"

        def load_overload(self, sig: Any, target_context: Any) -> Any:
            target_context.refresh()
            if not self.on:
                return None
            content = read_entry(self.path(sig, target_context.codegen()))
            if content is None:
                return None
            try:
                return compiler.CompileResult._rebuild(target_context, *pickle.loads(content))  # noqa: S301 - own file
            except Exception as error:  # whatever an unusable entry does, compiling again is right
                logging.getLogger("symrender").info("kernel cache: entry not usable: %r", error)
                return None

        def save_overload(self, sig: Any, data: Any) -> None:
            if not self.on or data.library.has_dynamic_globals or any(not lifted.can_cache for lifted in data.lifted):
                return
            write_entry(self.path(sig, data.codegen), serialize.dumps(data._reduce()))

        def enable(self) -> None:
            self.on = True

        def disable(self) -> None:
            self.on = False

        def flush(self) -> None:
            """Nothing is kept in memory."""

    return Store()
