"""Work in bounded tiles: progress that is true, cancellation that is prompt, bytes that do not depend on threads.

A tile is small enough that a compiled kernel, which cannot be interrupted, returns within a fraction of a second.
Kernels release the GIL and write disjoint pixels, so threads need no locks and the order of tiles cannot matter.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from symrender.scene.arrays import Array

Tile = tuple[int, int, int, int]
TileKernel = Callable[[int, int, int, int, Mapping[str, Array]], int]
Progress = Callable[[int, int, str], None]
"""``progress(done, total, label)``, called from the thread that renders."""


def tiles(width: int, height: int, side: int) -> Iterator[Tile]:
    """(x0, y0, x1, y1) of every tile of an image, row by row; a tile larger than the image is cut to it."""
    for y in range(0, height, side):
        for x in range(0, width, side):
            yield x, y, min(x + side, width), min(y + side, height)


def thread_count(threads: int) -> int:
    """``threads``, or for 0 the processors this process may use."""
    if threads:
        return threads
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_tiles(
    kernel: TileKernel,
    layers: Mapping[str, Array],
    *,
    width: int,
    height: int,
    side: int,
    threads: int,
    label: str,
    progress: Progress | None = None,
) -> int:
    """Fill ``layers`` tile by tile and return the evaluations made.

    Ctrl-C or an error in a kernel drops the tiles not yet begun and is raised once those under way have ended.
    """
    work = list(tiles(width, height, side))
    stop = threading.Event()

    def one(tile: Tile) -> int:
        return 0 if stop.is_set() else kernel(*tile, layers)

    workers = min(thread_count(threads), len(work))
    evaluations = done = 0
    with ThreadPoolExecutor(workers) as pool:
        waiting: set[Future[int]] = set()
        try:
            waiting = {pool.submit(one, tile) for tile in work}
            while waiting:
                # a bounded wait, so that Ctrl-C is seen even while every worker is inside a kernel
                ended, waiting = wait(waiting, timeout=0.1, return_when=FIRST_COMPLETED)
                for future in ended:
                    evaluations += future.result()
                done += len(ended)
                if progress is not None and ended:
                    progress(done, len(work), label)
        except BaseException:
            stop.set()
            for future in waiting:
                future.cancel()
            raise
    return evaluations
