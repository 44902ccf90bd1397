"""Compile an emitted program with Numba, and keep both the text and the machine code.

The text depends on no scene, so it is derived once and read back afterwards: a later process renders without
importing SymPy at all.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Sequence
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from symrender import kernel_cache

_PACKAGE = Path(__file__).resolve().parent.parent
_SOURCES = ("expression/*.py", "kernel/*.py", "targets/*.py", "scene/arrays.py", "limits.py")


@functools.cache
def emitted(recipe: Callable[[], str], name: str) -> str:
    """Text named ``name`` that ``recipe`` emits, from the cache directory where an entry of this very code exists."""
    directory, _ = kernel_cache.cache_directory()
    if directory is None:
        return recipe()
    digest = hashlib.sha256(f"{name} {metadata.version('sympy')}".encode())
    for pattern in _SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    entry = directory / f"{digest.hexdigest()}.text"
    stored = kernel_cache.read_entry(entry)
    if stored is not None:
        return stored.decode()
    text = recipe()
    kernel_cache.write_entry(entry, text.encode())
    return text


def load(text: str, compiled: Sequence[str], plain: Sequence[str] = ()) -> dict[str, Any]:
    """Functions of an emitted module: ``compiled`` ones as Numba dispatchers, ``plain`` ones as they are."""
    module = kernel_cache.load_module(text)
    for name in _functions(module):
        function = getattr(module, name)
        if name not in compiled and not hasattr(function, "_symrender_marked"):
            kernel_cache.jitable(function, inline=name in module.INLINE)._symrender_marked = True
    kernels = {name: kernel_cache.compiled(getattr(module, name), sources=[text]) for name in compiled}
    return kernels | {name: getattr(module, name) for name in plain}


def _functions(module: ModuleType) -> list[str]:
    return [name for name, value in vars(module).items() if callable(value) and not name.startswith("_")]


def _image_text() -> str:
    from symrender.kernel.assemble import image_program
    from symrender.targets.numba import emit

    return emit(image_program())


@functools.cache
def image_kernels() -> dict[str, Any]:
    """``tile`` and ``trace`` compiled, ``camera_axes`` and ``light_point`` plain: see ``kernel/assemble.py``."""
    return load(emitted(_image_text, "image"), ("tile", "trace"), ("camera_axes", "light_point"))
