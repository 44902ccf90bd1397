"""In a process of its own: run one of the first uses and keep every kernel it compiles, for levels of processors."""

from __future__ import annotations

import sys
from pathlib import Path

from symrender.jit.shipped import shipping

sys.path.insert(0, str(Path(__file__).resolve().parent))
from first_uses import FIRST_USES


def main(folder: str, use: str, *levels: str) -> None:
    """Fill ``folder`` with what ``use`` compiles."""
    with shipping(Path(folder), levels):
        FIRST_USES[use]()


if __name__ == "__main__":
    main(*sys.argv[1:])
