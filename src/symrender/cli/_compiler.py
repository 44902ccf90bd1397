"""Load Numba as a command needs it."""

from __future__ import annotations

import importlib
import sys


def load_compiler() -> None:
    """Import Numba without SciPy, which it loads, where installed, for linear algebra inside kernels.

    No kernel of ours has any, and the import takes a fifth of a small render. Only a command may do this: it has its
    process to itself.
    """
    if "numba" in sys.modules or "scipy.linalg" in sys.modules:
        return
    sys.modules["scipy.linalg"] = None  # type: ignore[assignment]
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        del sys.modules["scipy.linalg"]
