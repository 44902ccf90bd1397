"""A function as a kernel: translated with all it calls to LLVM IR and compiled by llvmlite (``docs/kernels.md``).

The machine code is kept on disk, privately, under a key made of everything it was made of. Kernels are serial, release
the GIL and keep strict IEEE arithmetic: the flags that drop NaN are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any

from symrender.jit.kernel import Kernel


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
