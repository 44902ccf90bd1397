"""Compile an emitted program with Numba, and keep both the text and the machine code.

The text depends on no scene, so it is derived once and read back afterwards: a later process renders without
importing SymPy at all.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from symrender.jit.beside import beside
from symrender.jit.compiled import compiled
from symrender.jit.entries import cache_directory, read_entry, write_entry
from symrender.jit.generated import load_module
from symrender.jit.marks import jitable
from symrender.jit.shelf import PACKAGE_FOLDER
from symrender.jit.shipped import folders_to_fill

_PACKAGE = Path(__file__).resolve().parent.parent
_SOURCES = (
    "expression/*.py",
    "kernel/*.py",
    "targets/*.py",
    "scene/arrays.py",
    "scene/records.py",
    "jit/records.py",
    "limits.py",
)


PROGRAMS: Final[Mapping[str, tuple[str, str]]] = {
    "image": ("symrender.kernel.assemble", "image_program"),
    "seen": ("symrender.kernel.seen", "seen_program"),
}
"""What makes the program of every text: a module and its function."""


@cache
def emitted(name: str) -> str:
    """Text of the program ``name``: what came with the package or was kept, if made by this very code, or made now."""
    stored = _stored(name)
    if stored is None:
        from symrender.targets.numba import emit

        module, function = PROGRAMS[name]
        text = emit(getattr(importlib.import_module(module), function)())
        kept = _kept(name)
        if kept is not None:
            write_entry(kept, text.encode())
    else:
        text = stored.decode()
    for folder in folders_to_fill():
        write_entry(folder / _entry(name, ""), text.encode())
    return text


@contextmanager
def emitting(name: str) -> Iterator[None]:
    """Within the block a process of its own makes a text that nobody has kept, where a processor is free for it.

    Kernels may be compiled meanwhile, which takes longer. A process that fails leaves the text to ``emitted``.
    """
    wanted = _stored(name) is None and _kept(name) is not None
    with beside(wanted, "symrender.runtimes.numba", name) as process:
        yield
        if process is not None:
            process.wait()


def _stored(name: str) -> bytes | None:
    """A text that came with the package or was kept."""
    shipped = read_entry(PACKAGE_FOLDER / _entry(name, ""), private=False)
    if shipped is not None:
        return shipped
    kept = _kept(name)
    return None if kept is None else read_entry(kept)


def _kept(name: str) -> Path | None:
    """Where a text is kept, None without a cache."""
    directory, _ = cache_directory()
    return None if directory is None else directory / _entry(name, _sympy())


@cache
def _sympy() -> str:
    """The version of the SymPy installed, which is looked for in all folders of packages."""
    return metadata.version("sympy")


@cache
def _entry(name: str, sympy: str) -> str:
    """File name of a text: a digest of all it was made of; a text of the package's serves whatever SymPy is there."""
    digest = hashlib.sha256(f"{name} {sympy}".encode())
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return f"{digest.hexdigest()}.text"


@cache
def kernel(text: str, name: str) -> Any:
    """Function ``name`` of an emitted module, compiled; everything it calls is compiled with it."""
    module = load_module(text)
    for called in module.CALLED:
        function = getattr(module, called)
        if inspect.isfunction(function):
            jitable(function, inline=called in module.INLINE)
    return compiled(getattr(module, name), sources=[text], _nrt=False)


def plain(text: str) -> ModuleType:
    """The emitted module as it is, for what runs once an image."""
    return load_module(text)


def image_text() -> str:
    """Text of the image program, from the cache or emitted now."""
    return emitted("image")


if __name__ == "__main__":
    emitted(sys.argv[1])
