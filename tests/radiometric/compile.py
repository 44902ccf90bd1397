"""How the kernels of this folder's judges are compiled and kept."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from tests.compiled import keeper

_TEXTS: Final = ("compile", "lattice", "rough_lattice", "seen_lattice", "nested", "nested_bounce")
_HERE: Final = Path(__file__).resolve().parent

kernel = keeper("symrender-judges", (_HERE / f"{name}.py" for name in _TEXTS))
