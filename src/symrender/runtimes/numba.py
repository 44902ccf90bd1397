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


@cache
def emitted(recipe: Callable[[], str], name: str) -> str:
    """Text named ``name`` that ``recipe`` emits: what came with the package or was kept, if made by this very code."""
    shipped = read_entry(PACKAGE_FOLDER / _entry(name, ""), private=False)
    if shipped is not None:
        return shipped.decode()
    directory, _ = cache_directory()
    kept = None if directory is None else directory / _entry(name, metadata.version("sympy"))
    stored = None if kept is None else read_entry(kept)
    text = recipe() if stored is None else stored.decode()
    if kept is not None and stored is None:
        write_entry(kept, text.encode())
    for folder in folders_to_fill():
        write_entry(folder / _entry(name, ""), text.encode())
    return text


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
    return emitted(_emit_image, "image")


def _emit_image() -> str:
    from symrender.kernel.assemble import image_program
    from symrender.targets.numba import emit

    return emit(image_program())
