"""A signal that asks the process to end is obeyed in bounded time, whatever the main thread is doing.

Python tells the main thread of a signal between two of its own instructions. A thread inside LLVM, which may take
seconds for a kernel, or inside a library that swallows the exception, ends late or never. So a second thread hears of
the signal too, from the interpreter's C handler by a pipe, and ends the process when its time is up.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

TIME_TO_END: Final = 0.5
"""Seconds a run has to end by itself once it is asked to; a tile takes at most two fifths of that."""
_ALONE: Final = 0.2
"""Seconds for which the thread that ends the others' children is not interrupted by them."""
_NAMES: Final = ("SIGINT", "SIGTERM", "SIGHUP")


@contextmanager
def ends_in_time(last_words: Callable[[int], None], seconds: float = TIME_TO_END) -> Iterator[None]:
    """Within the block a signal that is handled as a request to end the process ends it ``seconds`` later at most.

    The exit code is then 128 + signal, and ``last_words(signal)`` is called first, from another thread, unless the
    block was left before. Journals and outputs bear this end as they bear SIGKILL; child processes are killed. Once a
    signal has come the watch goes on after the block, for an interpreter that ends also waits for threads. Does nothing
    outside of the main thread, and on Windows.
    """
    if os.name != "posix" or threading.current_thread() is not threading.main_thread():
        yield
        return
    hear, tell = os.pipe()
    os.set_blocking(tell, False)
    before = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    asked, left = threading.Event(), threading.Event()

    def watch() -> None:
        number = _asked(hear)
        if not number:
            os.close(hear)
            return
        asked.set()
        threading.Event().wait(seconds)
        if not left.is_set():
            last_words(number)
        _end_children()
        os._exit(128 + number)

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        left.set()
        if not asked.is_set():
            signal.set_wakeup_fd(before)
            os.close(tell)


def _asked(hear: int) -> int:
    """The first signal that asks for the end; 0 when the block was left without one."""
    numbers = {int(getattr(signal, name)) for name in _NAMES if hasattr(signal, name)}
    while told := os.read(hear, 1):
        if told[0] in numbers:
            return told[0]
    return 0


def _end_children() -> None:
    """Workers and compilers would outlive this process for seconds; what multiprocessing cleans up with may end alone.

    A main thread that waits for a child goes on when that child ends, and an interpreter that ends takes this thread
    with it. So they are stopped first, which nobody hears of and which keeps the kernel's list still, until two
    readings in turn show nobody new; then all are killed before another thread has its turn. Where there is no
    ``/proc`` only what multiprocessing began is known.
    """
    seen: set[int] = set()
    stopped: list[int] = []
    readings_without_new = 0
    while readings_without_new < 2:
        new = _children() - seen
        readings_without_new = 0 if new else readings_without_new + 1
        for child in new:
            with contextlib.suppress(OSError):
                if b"resource_tracker" not in Path(f"/proc/{child}/cmdline").read_bytes():
                    os.kill(child, signal.SIGSTOP)
                    stopped.append(child)
        seen |= new
    sys.setswitchinterval(_ALONE)
    for child in stopped:
        with contextlib.suppress(OSError):
            os.kill(child, signal.SIGKILL)
    multiprocessing = sys.modules.get("multiprocessing")
    with contextlib.suppress(Exception):
        for process in multiprocessing.active_children() if multiprocessing else ():
            process.kill()


def _children() -> set[int]:
    found: set[int] = set()
    for listed in Path("/proc/self/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found.update(int(child) for child in listed.read_text().split())
    return found
