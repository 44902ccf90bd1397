"""How the evaluator's kernels are compiled and kept."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from compiled import keeper

_TEXTS: Final = ("compile", "world", "light", "places", "lattice", "chart", "scanline", "sweep", "disk")
_HERE: Final = Path(__file__).resolve().parent

kernel = keeper("adversary", (_HERE / f"{name}.py" for name in _TEXTS), error_model="numpy", nogil=True)
"""Division by zero is infinite, as in NumPy, which spares every division its check."""
