"""Who is told that a kernel is about to be compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Tell = Callable[[str, float], None]
"""Called with the name of a kernel and the seconds its compilation should take, before it begins."""

_tell: ContextVar[Tell | None] = ContextVar("_tell", default=None)


@contextmanager
def telling(tell: Tell) -> Iterator[None]:
    """Within the block ``tell`` hears of every kernel that this thread compiles."""
    token = _tell.set(tell)
    try:
        yield
    finally:
        _tell.reset(token)


def about_to_compile(name: str, seconds: float) -> None:
    """Tell whoever listens."""
    tell = _tell.get()
    if tell is not None:
        tell(name, seconds)
