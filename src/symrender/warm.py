"""First use: both kernels of a pair are compiled at once, and the first picture waits for its own only.

Numba compiles under one lock, so two kernels take twice as long in one process. Where neither is in the kernel cache
yet, the second is compiled by a process of its own while this one compiles the first and renders with it.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from symrender import kernel_cache
from symrender.first_use import compiled_mark
from symrender.settings import Settings
from symrender.tiles import thread_count
from symrender.units import KINDS, Job, compute

_SIDE = 4
"""Pixels a side of the picture that compiles all of a kernel: it sees a floor and spheres with lobes."""


@contextmanager
def second_beside(jobs: Sequence[Job]) -> Iterator[Callable[[], object]]:
    """Within the block, another process compiles the kernel of the second job; call what is yielded to wait for it.

    Only where the cache holds the kernels of neither job and a processor is free; else there is nothing to wait for.
    """
    marks = [mark for job in jobs if (mark := compiled_mark(job.kind)) is not None]
    missing = [mark for mark in marks if kernel_cache.read_entry(mark) is None]
    if len(missing) == 2 and thread_count(0) > 1:
        words = [sys.executable, "-m", "symrender.warm", jobs[1].kind, jobs[1].settings.disk]
        quiet = subprocess.DEVNULL
        process = subprocess.Popen(words, stdin=quiet, stdout=quiet, stderr=quiet)
        try:
            yield process.wait
        finally:
            process.kill()
            process.wait()
    else:
        yield lambda: None


def compile_kind(kind: str, disk: str) -> None:
    """Compile all an image of ``kind`` needs, into the cache, by making a tiny one."""
    from symrender.scene.load import load

    both = Settings(width=_SIDE, height=_SIDE, lobe=1, disk=disk, tol=1e-2)
    settings = both if KINDS[kind].side == "numeric" else replace(both, numeric="none")
    compute(Job.of(kind, load("chapter8"), settings), (0, 0, _SIDE, _SIDE))


if __name__ == "__main__":
    compile_kind(*sys.argv[1:])
