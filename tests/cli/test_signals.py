"""An interrupt is never lost where an exception would be swallowed, and comes at once elsewhere."""

from __future__ import annotations

import ctypes
import signal
import threading
import time
import types
import weakref
from collections.abc import Callable
from typing import Any

import pytest

from busy import in_time
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
    assert in_time(time.monotonic() - begun, 2.0), "and the wait was"


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
    assert in_time(time.monotonic() - begun, 2.0), "and the wait was"


def test_an_interrupt_while_llvm_compiles_is_not_lost() -> None:
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    steps = "".join(f"%x{k} = fmul double %x{k - 1}, %x{k // 2}\n" for k in range(1, 4000))
    module = binding.parse_assembly(f"define double @slow(double %x0) {{\n{steps}ret double %x3999\n}}")
    engine = binding.create_mcjit_compiler(module, binding.Target.from_default_triple().create_target_machine())
    compiled: list[int] = []
    sent: list[float] = []

    def interrupt() -> None:
        time.sleep(0.02)
        assert not compiled, "the signal is for LLVM itself"
        sent.append(time.monotonic())
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    engine.set_object_cache(lambda module, text: compiled.append(len(text)))
    thread = threading.Thread(target=interrupt)
    with pytest.raises(KeyboardInterrupt), interruptible():
        thread.start()
        engine.finalize_object()
        threading.Event().wait(5.0)
    thread.join()
    assert len(compiled) == 1 and len(sent) == 1


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
