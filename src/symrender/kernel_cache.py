"""Kernels: which functions they may call, how one is compiled, and modules made of generated text.

A kernel and all it calls are translated to LLVM IR and compiled by llvmlite (``symrender.jit``, ``docs/kernels.md``);
the machine code is kept on disk, privately, under a key made of everything it was made of. Kernels are serial, release
the GIL and keep strict IEEE arithmetic: the flags that drop NaN are refused.
"""

from __future__ import annotations

import hashlib
import importlib.abc
import importlib.util
import linecache
import sys
from collections.abc import Callable, Sequence
from types import FunctionType, ModuleType
from typing import Any

from symrender.jit.kernel import Kernel
from symrender.jit.marks import inlined, jitable

__all__ = ["compiled", "inlined", "jitable", "load_module"]


def compiled(function: Callable[..., Any], *, sources: Sequence[str] | None = None, **options: Any) -> Kernel:
    """``function`` as a kernel: compiled for the types of the arguments it is called with, cached on disk.

    ``function`` must not be a closure. ``options`` are Numba's, of which only ``fastmath={"contract"}`` and those that
    change no value are accepted; a kernel that asks for contraction is left to Numba, and so is what the translator
    refuses. ``sources`` are the texts that decide Numba's result; by default those of all modules that are imported.
    """
    if function.__closure__:
        raise ValueError(f"{function.__qualname__}: a closure cannot be cached, pass its values as arguments")
    if (options.get("fastmath") or None) not in (None, {"contract"}):
        raise ValueError(f"{function.__qualname__}: fastmath other than contraction drops NaN")
    assert isinstance(function, FunctionType)
    return Kernel(function, sources, options)


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


class _Text(importlib.abc.InspectLoader):
    """Loader of a module whose source is a string."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file

    def get_source(self, fullname: str) -> str:
        return self.text

    def get_code(self, fullname: str) -> Any:
        return compile(self.text, self.file, "exec", dont_inherit=True)
