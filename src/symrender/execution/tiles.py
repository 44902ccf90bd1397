"""Work in bounded tiles: progress that is true, cancellation that is prompt, bytes that do not depend on threads.

A tile is small enough that a compiled kernel, which cannot be interrupted, returns within a fraction of a second.
Kernels release the GIL and write disjoint pixels, so threads need no locks and the order of tiles cannot matter.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from queue import Empty, SimpleQueue
from typing import Final, Protocol, TypeVar

from symrender.execution.jobs import Job, Tile, TileKernel, prepared
from symrender.jit.beside import processors
from symrender.scene.arrays import Array

Progress = Callable[[int, int, str], None]
"""``progress(done, total, label)``, called from the thread that renders; 0 of 0 while something is compiled."""
Finished = Callable[[Tile, int, float], None]
"""``finished(tile, evaluations, seconds)``, called from the thread that renders once a tile stands in the layers.

The seconds are those of a processor.
"""

LONGEST: Final = 0.2
"""Seconds of a processor a tile should take at most."""
LARGEST: Final = 128
"""Largest side of a tile whose side was measured, pixels."""
_PLASTIC: Final = (0.7548776662466927, 0.5698402909980532)
SQUARE: Final = 8
"""Side of the largest squares of pixels that a filter does at once, whatever part of them a tile has."""
_PROBES = ((16 * 16, 1, (2, 4)), (32 * 32, 1, (1, 3, 5)), (128 * 128, 2, (1, 3, 5)), (math.inf, 4, (1, 3, 5)))
"""Of images of fewer pixels, side and places, sixths of the image, of tiles that are timed: a small part of it."""
_FEW = 8 * 9 * SQUARE * SQUARE
"""Pixels of an image of which nine squares are an eighth: of smaller ones none is timed."""
_ROUNDS = 3
_TOLD = 0.01
"""Seconds of a tile of which once is enough."""
_SHARE = 64
_T = TypeVar("_T")


class Workers(Protocol):
    """Whoever runs units: threads here, or processes of a cluster."""

    @property
    def count(self) -> int:
        """Units run at a time."""

    def run(self, job: Job, layers: Mapping[str, Array], work: Sequence[Tile], finished: Finished) -> None:
        """Fill ``layers`` tile by tile; ``finished`` is called once for every tile of ``work``, in any order."""


def tiles(width: int, height: int, side: int) -> Iterator[Tile]:
    """(x0, y0, x1, y1) of every tile of an image, row by row; a tile larger than the image is cut to it."""
    for y in range(0, height, side):
        for x in range(0, width, side):
            yield x, y, min(x + side, width), min(y + side, height)


def spread(work: Sequence[Tile], side: int) -> list[Tile]:
    """The tiles of an image of tiles of ``side``, so ordered that whatever is done is spread evenly over it.

    So the share that is done foretells the time of the rest, and an unfinished picture shows all of the image: tiles
    in the order of x a + y b modulo 1, with a and b powers of the plastic number, fill a plane evenly from the first.
    """
    a, b = _PLASTIC
    return sorted(work, key=lambda tile: (tile[0] // side * a + tile[1] // side * b) % 1)


def thread_count(threads: int) -> int:
    """``threads``, or for 0 the processors this process may use."""
    return threads or processors()


def measured_side(workers: Workers, job: Job, layers: Mapping[str, Array]) -> int:
    """Side whose dearest tile should take half of ``LONGEST``, from small tiles spread over the image.

    They are thrown away: only the dearest of them is timed again, where it is soon done, and nothing is where it would
    take longer than what it could save, in images of nine pixels or, of pixels that squares tell, of few squares.
    Never so large that a worker would have fewer than sixty-four tiles, for the first ones to foretell the time of the
    rest and the last ones to end together, unless they are of some pixels only. Of pixels that squares tell a multiple
    of ``SQUARE``, two of them where pixels are cheap: what a tile's pixels wait for together costs each of them less.
    """
    width, height = job.settings.width, job.settings.height
    squares = job.settings.filter == "box"
    if squares and width * height < _FEW:
        return SQUARE
    if width * height <= 9:
        return 1
    step, (_, probe, places) = 1, next(each for each in _PROBES if width * height < each[0])
    if squares:
        step = probe = SQUARE
    probes = [
        (x, y, min(x + probe, width), min(y + probe, height))
        for y in sorted({height * k // 6 // step * step for k in places})
        for x in sorted({width * k // 6 // step * step for k in places})
    ]
    best: dict[Tile, float] = {}

    def finished(tile: Tile, _: int, seconds: float) -> None:
        best[tile] = min(seconds / area(tile), best.get(tile, math.inf))

    workers.run(job, layers, probes, finished)
    # the best of a few, for a busy machine slows a tile down but never speeds it up
    for _ in range(0 if squares else _ROUNDS - 1):
        dearest = max(best, key=lambda tile: best[tile])
        if best[dearest] * area(dearest) > _TOLD:
            break
        workers.run(job, layers, [dearest], finished)
    affordable = math.isqrt(int(LONGEST / 2 / max(*best.values(), 1e-9)))
    shared = math.isqrt(width * height // (_SHARE * workers.count))
    side = max(1, min(affordable, max(shared, 2 * SQUARE if squares else SQUARE), LARGEST))
    # a part of a square costs as much as all of it
    return -(-side // SQUARE) * SQUARE if squares else side


def area(tile: Tile) -> int:
    """Pixels of a tile."""
    return (tile[2] - tile[0]) * (tile[3] - tile[1])


class Threads:
    """Threads of this process."""

    def __init__(self, threads: int = 0) -> None:
        self.count = thread_count(threads)

    def run(self, job: Job, layers: Mapping[str, Array], work: Sequence[Tile], finished: Finished) -> None:
        """Fill ``layers`` in place.

        Ctrl-C or an error in a kernel drops the tiles not yet begun and is raised once those under way have ended.
        """
        run_threads(prepared(job), layers, work, self.count, finished)


def run_threads(
    kernel: TileKernel, layers: Mapping[str, Array], work: Sequence[Tile], threads: int, finished: Finished
) -> None:
    """Run ``kernel`` over ``work`` on threads that each take the next tile."""
    coming, lock, stop = iter(work), threading.Lock(), threading.Event()
    results: SimpleQueue[tuple[Tile, int, float] | BaseException] = SimpleQueue()

    def labour() -> None:
        while not stop.is_set():
            with lock:
                tile = next(coming, None)
            if tile is None:
                return
            # of its processor: beside other work tiles would else be taken for dear ones, and made too small
            begun = time.thread_time()
            try:
                evaluations = kernel(*tile, layers)
            except BaseException as error:
                stop.set()
                results.put(error)
                return
            results.put((tile, evaluations, time.thread_time() - begun))

    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in range(min(threads, len(work))):
                pool.submit(labour)
            for _ in work:
                result = next_of(results)
                if isinstance(result, BaseException):
                    raise result
                finished(*result)
        finally:
            stop.set()


def next_of(results: SimpleQueue[_T]) -> _T:
    """What the queue gives next, waited for in bounded steps so that Ctrl-C is seen."""
    while True:
        try:
            return results.get(timeout=0.1)
        except Empty:
            continue
