"""An interrupt is never lost where an exception would be swallowed, and comes at once elsewhere."""

from __future__ import annotations

import ctypes
import math
import signal
import threading
import time
import types
import weakref
from collections.abc import Callable
from typing import Any

import pytest

from symrender.cli._signals import interruptible


def function_of(file: str, name: str, done: list[int]) -> Callable[..., Any]:
    """A function that seems to stand in ``file``, raises SIGINT, and goes on."""
    held: dict[str, Any] = {"signal": signal, "done": done}
    text = f"def {name}(*_):\n    signal.raise_signal(signal.SIGINT)\n    done.append(1)\n"
    exec(compile(text, file, "exec"), held)  # noqa: S102
    made: Callable[..., Any] = held[name]
    return made


@pytest.mark.parametrize(
    ("file", "name"),
    [("<frozen importlib._bootstrap>", "cb"), ("/usr/lib/python3/weakref.py", "remove"), ("any.py", "__del__")],
)
def test_an_interrupt_in_a_callback_comes_a_moment_later(file: str, name: str) -> None:
    done: list[int] = []

    class Kept:
        pass

    kept = Kept()
    watched = weakref.ref(kept, function_of(file, name, done))
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), interruptible():
        del kept
        assert done == [1] and watched() is None, "the callback was not cut short"
        threading.Event().wait(5.0)
    assert time.monotonic() - begun < 2.0, "and the wait was"


def test_an_interrupt_in_a_callback_of_llvm_comes_a_moment_later() -> None:
    done: list[int] = []
    below = function_of("any.py", "hook", done)
    notify = function_of("executionengine.py", "_raw_object_cache_notify", [])
    held: dict[str, Any] = notify.__globals__
    held["signal"] = types.SimpleNamespace(raise_signal=lambda number: below(), SIGINT=signal.SIGINT)
    called_by_c = ctypes.CFUNCTYPE(None)(notify)
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), interruptible():
        called_by_c()
        assert done == [1], "what the callback called was not cut short"
        threading.Event().wait(5.0)
    assert time.monotonic() - begun < 2.0, "and the wait was"


def test_a_kernel_that_is_compiled_does_not_swallow_an_interrupt() -> None:
    from numba import njit

    calls = "".join(f"    if x > {k}: x = {k} + sin(x) * cos(x * {k})\n" for k in range(400))
    held: dict[str, Any] = {"sin": math.sin, "cos": math.cos}
    exec(f"def slow(x):\n{calls}    return x\n", held)  # noqa: S102
    compiling = njit("float64(float64)")
    timer = threading.Timer(0.4, lambda: signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT))
    with pytest.raises(KeyboardInterrupt), interruptible():
        timer.start()
        for _ in range(20):
            compiling(held["slow"])


def test_an_interrupt_elsewhere_comes_at_once() -> None:
    done: list[int] = []
    with pytest.raises(KeyboardInterrupt), interruptible():
        function_of("any.py", "work", done)()
    assert done == []


def test_handlers_of_others_are_left_alone() -> None:
    before = signal.getsignal(signal.SIGINT)
    with interruptible():
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before
    mine: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: mine.append(number))
    try:
        with interruptible():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert mine == [signal.SIGINT]
    seen: list[object] = []

    def elsewhere() -> None:
        with interruptible():
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert seen == [before]
