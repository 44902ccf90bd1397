"""What is compiled before a first picture, said before it is waited for, with the time it takes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from symrender.jit.told import telling
from symrender.tiles import Progress


@contextmanager
def first_use(progress: Progress | None) -> Iterator[None]:
    """Within the block ``progress`` hears of every kernel that this thread must compile; what is kept says nothing.

    It is told 0 of 0 under a label that names the kernel and the time it should take: as long as it took here last.
    """

    def tell(name: str, seconds: float) -> None:
        if progress is not None:
            progress(0, 0, f"compiling {name}, once: about {seconds:.0f} s")

    with telling(tell):
        yield
