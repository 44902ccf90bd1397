"""Signals as exceptions, raised only where an exception can be heard.

Inside the import system's own code, a callback of a weak reference, a finalizer or a callback of LLVM an exception is
swallowed; the run goes on as if nobody had asked it to end, and a lock of the import system that it leaves behind stops
the next thread that imports something, for ever. A signal that comes there is sent again a moment later. A callback of
LLVM is no rare place: one that comes while a kernel is compiled is first seen there.
"""

from __future__ import annotations

import _thread
import re
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

Handler = Callable[[int, FrameType | None], object]
_A_MOMENT: Final = 0.005
_DEAF_FILES: Final = ("<frozen importlib", "<frozen zipimport")
_DEAF_CALLERS: Final = ("weakref.py", "_weakrefset.py")
_DEAF_NAMES: Final = ("__del__", "_raw_object_cache_notify", "_raw_object_cache_getbuffer")


def heard(handler: Handler) -> Handler:
    """``handler``, called only outside of code that would swallow the exception it raises."""

    def patient(number: int, frame: FrameType | None) -> object:
        if frame is not None and _deaf(frame):
            _thread.start_new_thread(_again, (number,))
            return None
        return handler(number, frame)

    return patient


@contextmanager
def interruptible() -> Iterator[None]:
    """Within the block Ctrl-C raises KeyboardInterrupt where it is heard, if nobody else has taken it over."""
    usual = threading.current_thread() is threading.main_thread()
    if not usual or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, heard(signal.default_int_handler))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _deaf(frame: FrameType) -> bool:
    if frame.f_code.co_filename.startswith(_DEAF_FILES):
        # further down the stack the same files mean a module that is being imported, and that can be cut short
        return True
    caller: FrameType | None = frame
    while caller is not None:
        file = re.split(r"[/\\]", caller.f_code.co_filename)[-1]
        if caller.f_code.co_name in _DEAF_NAMES or file in _DEAF_CALLERS:
            return True
        caller = caller.f_back
    return False


def _again(number: int) -> None:
    time.sleep(_A_MOMENT)
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        # a true signal, which also ends a wait
        signal.pthread_kill(main, number)
    else:
        _thread.interrupt_main(signal.Signals(number))
