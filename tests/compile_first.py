"""Compile what most tests run before the first of them begins: ``make test`` calls this.

A kernel is compiled on one processor, and two workers that need the same one at the same time both compile it. So each
is compiled once, as many at a time as there are workers, and kept where every process finds it.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Final

import symrender as sr

_TINY: Final = {"size": 4, "threads": 1}


def pair() -> None:
    sr.render("chapter8", lobe=1, **_TINY)


def chambers() -> None:
    for disk in ("2x2", "exact"):
        sr.truth("chapter8", tol=1e-2, disk=disk, **_TINY)


def slopes() -> None:
    for disk in ("2x2", "exact"):
        sr.gradient("chapter8", ["spheres.B.radius"], tol=1e-1, disk=disk, **_TINY)


def lattices() -> None:
    sr.truth("chapter8", tol=1e-2, counts=False, **_TINY)


EACH: Final[tuple[Callable[[], None], ...]] = (slopes, pair, chambers, lattices)
"""The longest first."""


def main(workers: int) -> None:
    begun = time.perf_counter()
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(work) for work in EACH]):
            done.result()
    print(f"kernels compiled or found in {time.perf_counter() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
