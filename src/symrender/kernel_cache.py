"""Compiled kernels kept on disk, privately.

A compiled kernel is native code in a pickle, so whoever can write the cache can run code as its reader, and a stale
entry silently returns yesterday's numbers. Hence:

- the directory is ``$SYMRENDER_CACHE``, else ``$XDG_CACHE_HOME/symrender``, else ``~/.cache/symrender``; it must belong
  to this user and be writable by nobody else, otherwise kernels are compiled in memory and one warning is logged;
- an entry's name is the SHA-256 of everything that decides the machine code: the source texts, the signature, the
  compiler options, the versions of Python, NumPy, Numba and llvmlite, the processor and its features;
- an entry starts with the SHA-256 of its content, checked before it is unpickled; an entry that is truncated, altered,
  foreign or unreadable is ignored, and the kernel is compiled again and rewritten.

Kernels are serial, release the GIL and keep strict IEEE arithmetic: the flags that drop NaN are refused.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.abc
import importlib.util
import linecache
import logging
import os
import pickle
import stat
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

import numpy as np

F = TypeVar("F", bound=Callable[..., Any])

_DIGEST_BYTES = 32


def jitable(function: F, *, inline: bool = False) -> F:
    """Mark a plain function as callable from kernels; it stays callable from Python, for tests.

    ``inline`` copies its machine code into every caller. Imports Numba, so modules that use it are imported only when
    something is rendered.
    """
    from numba.extending import register_jitable

    marked: F = register_jitable(forceinline=inline)(function)
    return marked


def inlined(function: F) -> F:
    """``jitable`` with ``inline``: for a function whose arguments (a scene's arrays) cost more to pass than to use."""
    return jitable(function, inline=True)


def compiled(function: Callable[..., Any], *, sources: Sequence[str], **options: Any) -> Any:
    """Numba dispatcher of ``function``: serial, ``nogil``, ``error_model="numpy"``, strict, cached on disk.

    ``sources`` are the texts of every module whose code or constants the kernel uses (its own included): they are the
    only freshness test there is. ``function`` must not be a closure. ``options`` go to ``numba.njit``; of ``fastmath``
    only ``{"contract"}`` is accepted.
    """
    import numba

    if function.__closure__:
        raise ValueError(f"{function.__qualname__}: a closure cannot be cached, pass its values as arguments")
    if (options.get("fastmath") or None) not in (None, {"contract"}):
        raise ValueError(f"{function.__qualname__}: fastmath other than contraction drops NaN")
    settings: dict[str, Any] = {"nogil": True, "error_model": "numpy"} | options
    dispatcher = numba.njit(**settings)(function)
    directory, _ = cache_directory()
    if directory is not None:
        name = f"{function.__module__}.{function.__qualname__}"
        dispatcher._cache = _store(directory, (name, repr(sorted(settings.items(), key=repr)), *sources))
    return dispatcher


def load_module(text: str) -> ModuleType:
    """Module made of generated source ``text``, named after its SHA-256; the same text gives the same module.

    The text is executed as it is: it must come from an emitter, never from a scene. Functions in it can be given to
    ``compiled`` with ``sources=[text]``; tracebacks show its lines.
    """
    name = f"symrender_generated_{hashlib.sha256(text.encode()).hexdigest()[:32]}"
    if name not in sys.modules:
        file = f"<{name}>"
        spec = importlib.util.spec_from_loader(name, _Text(text, file), origin=file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
        sys.modules.setdefault(name, module)
    return sys.modules[name]


def cache_directory() -> tuple[Path | None, str]:
    """Directory in use and "", or None and why there is none."""
    chosen = os.environ.get("SYMRENDER_CACHE")
    if chosen:
        return _private_directory(Path(chosen))
    return _private_directory(Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache", "symrender"))


@functools.lru_cache(maxsize=16)
def _private_directory(directory: Path) -> tuple[Path | None, str]:
    """Create or check one directory; remembered, so that its warning is logged once."""
    try:
        directory = directory.expanduser()
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = directory.lstat()
        if not stat.S_ISDIR(found.st_mode):
            reason = "is not a directory"
        elif not _ours(found):
            reason = "belongs to another user, or others may write to it"
        else:
            directory.chmod(0o700)
            tempfile.TemporaryFile(dir=directory).close()
            return directory, ""
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        reason = str(error)
    message = f"kernel cache {directory}: {reason}; kernels are compiled in memory (set SYMRENDER_CACHE)"
    logging.getLogger("symrender").warning(message)
    return None, message


def _ours(found: os.stat_result) -> bool:
    if not hasattr(os, "getuid"):
        return True
    return found.st_uid == os.getuid() and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


class _Text(importlib.abc.InspectLoader):
    """Loader of a module whose source is a string."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file

    def get_source(self, fullname: str) -> str:
        return self.text

    def get_code(self, fullname: str) -> Any:
        return compile(self.text, self.file, "exec", dont_inherit=True)


def read_entry(path: Path) -> bytes | None:
    """Content of an entry that is ours and whole, else None."""
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0))
    except OSError:
        return None
    with os.fdopen(handle, "rb") as file:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode) or not _ours(found):
            return None
        try:
            data = file.read()
        except OSError:
            return None
    content = data[_DIGEST_BYTES:]
    return content if hashlib.sha256(content).digest() == data[:_DIGEST_BYTES] else None


def write_entry(path: Path, content: bytes) -> None:
    """Write an entry whole or not at all; a failure only costs a compilation later."""
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".entry-")
        temporary = Path(name)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        logging.getLogger("symrender").info("kernel cache: %s not written: %s", path, error)


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
