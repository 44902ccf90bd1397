"""Compile an emitted program with Numba, and keep both the text and the machine code.

The text depends on no scene, so it is derived once and read back afterwards: a later process renders without
importing SymPy at all.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from functools import cache
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from symrender import kernel_cache
from symrender.jit.entries import cache_directory, read_entry, write_entry

_PACKAGE = Path(__file__).resolve().parent.parent
_SOURCES = (
    "expression/*.py",
    "kernel/*.py",
    "targets/*.py",
    "scene/arrays.py",
    "scene/records.py",
    "records.py",
    "limits.py",
)


@cache
def emitted(recipe: Callable[[], str], name: str) -> str:
    """Text named ``name`` that ``recipe`` emits, from the cache directory where an entry of this very code exists."""
    directory, _ = cache_directory()
    if directory is None:
        return recipe()
    digest = hashlib.sha256(f"{name} {metadata.version('sympy')}".encode())
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    entry = directory / f"{digest.hexdigest()}.text"
    stored = read_entry(entry)
    if stored is not None:
        return stored.decode()
    text = recipe()
    write_entry(entry, text.encode())
    return text


@cache
def kernel(text: str, name: str) -> Any:
    """Function ``name`` of an emitted module, compiled; everything it calls is compiled with it."""
    module = kernel_cache.load_module(text)
    for called in module.CALLED:
        function = getattr(module, called)
        if inspect.isfunction(function):
            kernel_cache.jitable(function, inline=called in module.INLINE)
    return kernel_cache.compiled(getattr(module, name), sources=[text], _nrt=False)


def plain(text: str) -> ModuleType:
    """The emitted module as it is, for what runs once an image."""
    return kernel_cache.load_module(text)


def image_text() -> str:
    """Text of the image program, from the cache or emitted now."""
    return emitted(_emit_image, "image")


def _emit_image() -> str:
    from symrender.kernel.assemble import image_program
    from symrender.targets.numba import emit

    return emit(image_program())
