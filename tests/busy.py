"""Seconds of this machine as it is now: where other processes run too, everything takes longer by the same factor."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

WORK: Final = 0.1
"""Processor seconds by which the factor is measured."""
ALONE: Final = 0.0065
"""Those that ``slowed`` takes on the machine that limits were set on, with nothing else to do."""


def stretch() -> float:
    """Wall seconds over processor seconds of a computation, measured now; 1 on a machine with nothing else to do."""
    begun, used = time.perf_counter(), time.thread_time()
    while time.thread_time() - used < WORK:
        pass
    return max(1.0, (time.perf_counter() - begun) / (time.thread_time() - used))


def in_time(seconds: float, limit: float) -> bool:
    """Whether ``seconds`` are below ``limit``, which is stretched only where they are not.

    On a quiet machine this is ``seconds < limit``.
    """
    return seconds < limit or seconds < limit * stretch()


def slowed() -> float:
    """Processor seconds of a computation now over what it takes where nothing else runs, at least 1.

    Two processes that share the parts of one processor halve what each of its seconds does.
    """
    best = float("inf")
    for _ in range(9):
        begun = time.process_time()
        sums: dict[int, int] = {}
        for k in range(40_000):
            sums[k % 997] = sums.get(k % 991, 0) + k
        best = min(best, time.process_time() - begun)
    return max(1.0, best / ALONE)


def in_processor_time(seconds: float, limit: float) -> bool:
    """Whether processor seconds are below ``limit``, which grows only where they are not, and the machine is slow."""
    return seconds < limit or seconds < limit * slowed()


def soon(holds: Callable[[], bool], limit: float) -> bool:
    """Whether a condition comes to hold within ``limit`` seconds of this machine; it is asked every hundredth."""
    begun = time.monotonic()
    while not holds():
        if not in_time(time.monotonic() - begun, limit):
            return False
        time.sleep(0.01)
    return True
