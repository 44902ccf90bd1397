"""Compile what most tests run before the first of them begins: ``make test`` calls this.

A kernel is compiled on one processor, and two workers that need the same one at the same time both compile it. So each
is compiled once, as many at a time as there are workers, and kept where every process finds it.
"""

from __future__ import annotations

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "wheels"))
from uses import USES

PROGRAM = Path(__file__).resolve().parents[1] / "wheels" / "first_uses.py"


def compile_use(use: str) -> None:
    """Run one of the first uses in a process of its own."""
    subprocess.run([sys.executable, str(PROGRAM), use], check=True)


def main(workers: int) -> None:
    begun = time.perf_counter()
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(compile_use, USES))
    print(f"kernels compiled or found in {time.perf_counter() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
