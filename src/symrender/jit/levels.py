"""Levels of x86-64 processors, as its psABI names them: what machine code that comes with the package is made for."""

from __future__ import annotations

import functools
import platform
import sys
from typing import Final

_V2: Final = frozenset({"cx16", "popcnt", "sahf", "sse3", "ssse3", "sse4.1", "sse4.2"})
_V3: Final = _V2 | {"avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave"}
_V4: Final = _V3 | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}

LEVELS: Final = {"x86-64-v4": _V4, "x86-64-v3": _V3, "x86-64-v2": _V2}
"""LLVM's name of each level and the features a processor of it has, the best first."""


@functools.lru_cache(maxsize=1)
def levels_here() -> tuple[str, ...]:
    """Levels whose code this processor can run, the best first; none where it is not x86-64 under Linux.

    The features are what the processor and the system allow, not what the processor's name promises.
    """
    if not sys.platform.startswith("linux") or platform.machine() not in ("x86_64", "AMD64"):
        return ()
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    return tuple(level for level, needed in LEVELS.items() if all(features.get(each) for each in needed))
