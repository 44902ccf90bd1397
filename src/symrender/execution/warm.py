"""First use: both kernels of a pair are compiled at once, and the first picture waits for its own only.

A kernel is translated and compiled on one processor. Where neither of two is in the kernel cache yet, the second is
compiled by a process of its own while this one compiles the first and renders with it.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from symrender.execution.jobs import KINDS, Job, code_digest, compute
from symrender.execution.tiles import Progress
from symrender.jit.beside import beside
from symrender.jit.entries import cache_directory, read_entry, write_entry
from symrender.jit.shelf import package_shelves
from symrender.settings import Settings

_SIDE = 4
"""Pixels a side of the picture that compiles all of a kernel: it sees a floor and spheres with lobes."""


@contextmanager
def second_beside(jobs: Sequence[Job], progress: Progress | None = None) -> Iterator[Callable[[], None]]:
    """Within the block, another process compiles the kernel of the second job; call what is yielded to wait for it.

    Only where neither the package nor the cache holds kernels and a processor is free; else there is nothing to wait
    for.
    ``progress`` hears of the wait, as 0 of 0.
    """
    marks = [mark for job in jobs if (mark := _compiled_mark(job.kind)) is not None]
    missing = [mark for mark in marks if read_entry(mark) is None]
    wanted = len(missing) == 2 and not package_shelves()
    words = (jobs[1].kind, jobs[1].settings.disk) if wanted else ()
    with beside(wanted, "symrender.execution.warm", *words) as process:

        def wait() -> None:
            if process is None:
                return
            if process.poll() is None and progress is not None:
                progress(0, 0, f"compiling {jobs[1].kind}, once, in a process of its own")
            process.wait()

        yield wait
    for mark in missing:
        write_entry(mark, b"")


def compile_kind(kind: str, disk: str) -> None:
    """Compile all an image of ``kind`` needs, into the cache, by making a tiny one."""
    from symrender.scene.load import load_any

    both = Settings(width=_SIDE, height=_SIDE, lobe=1, disk=disk, tol=1e-2)
    settings = both if KINDS[kind].side == "numeric" else replace(both, numeric="none")
    scene = load_any("metal" if KINDS[kind].radiometric else "chapter8")
    compute(Job.of(kind, scene, settings), (0, 0, _SIDE, _SIDE))


def _compiled_mark(kind: str) -> Path | None:
    """Cache entry that says an image of ``kind`` was made beside another by this very code; None without a cache."""
    directory, _ = cache_directory()
    if directory is None:
        return None
    return directory / f"{hashlib.sha256(f'{sys.version} {code_digest()} {kind}'.encode()).hexdigest()}.compiled"


if __name__ == "__main__":
    compile_kind(*sys.argv[1:])
