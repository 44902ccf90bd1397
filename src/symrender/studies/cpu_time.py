"""Time of a kernel: processor seconds of one thread, medians of interleaved runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from statistics import median
from typing import Final

from symrender.execution.jobs import TileKernel
from symrender.execution.tiles import tiles
from symrender.scene.arrays import Array

PATIENCE: Final = 3.0
"""A run longer than this many seconds is not repeated."""
_SIDE = 16


def filled(kernel: TileKernel, layers: Mapping[str, Array], width: int, height: int) -> tuple[int, float]:
    """Fill the whole image tile by tile in this thread; evaluations made, and processor seconds spent in the kernel.

    Tiles keep each call short, so that an interruption is heard between two of them.
    """
    evaluations, seconds = 0, 0.0
    for tile in tiles(width, height, _SIDE):
        begun = time.thread_time()
        evaluations += kernel(*tile, layers)
        seconds += time.thread_time() - begun
    return evaluations, seconds


def interleaved(runs: Sequence[Callable[[], float]], repeats: int) -> list[tuple[float, int]]:
    """Median seconds of every run, and how often it ran; one of each in turn, ``repeats`` rounds.

    Interleaving spreads what else the machine does over all of them. A run beyond ``PATIENCE`` runs once.
    """
    taken: list[list[float]] = [[] for _ in runs]
    for _ in range(repeats):
        for run, times in zip(runs, taken, strict=True):
            if not times or times[0] <= PATIENCE:
                times.append(run())
    return [(median(times), len(times)) for times in taken]
