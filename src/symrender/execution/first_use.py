"""What is compiled before a first picture, said before it is waited for, with the time it takes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from symrender.execution.tiles import Progress
from symrender.jit.told import telling


@contextmanager
def first_use(what: str, progress: Progress | None) -> Iterator[None]:
    """Within the block ``progress`` hears of every kernel that this thread must compile; what is kept says nothing.

    It is told 0 of 0 under a label: for ``what`` it is compiled, its name, and the time that should take, which is what
    it took here last.
    """

    def tell(name: str, seconds: float) -> None:
        if progress is not None:
            progress(0, 0, f"compiling {what} ({name}), once: about {seconds:.0f} s")

    with telling(tell):
        yield
