"""Limits of time are those of a quiet machine, and no more than stretched on a busy one."""

from __future__ import annotations

import threading
import time

import pytest

import busy


def test_a_limit_is_a_limit() -> None:
    assert busy.in_time(0.9, 1.0)
    assert not busy.in_time(1e4, 1.0)


def test_what_comes_soon_is_waited_for() -> None:
    answers = iter([False, False, True])
    assert busy.soon(lambda: next(answers), 0.3)
    begun = time.monotonic()
    assert not busy.soon(lambda: False, 0.05)
    assert time.monotonic() - begun > 0.05


def test_the_stretch_is_how_long_others_keep_us_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(busy, "WORK", 0.02)
    alone = min(busy.stretch() for _ in range(5))
    assert alone >= 1.0
    ended = threading.Event()

    def hold() -> None:
        while not ended.is_set():
            # the lock of the interpreter, as another process would hold the processor
            sum(range(20_000))

    threads = [threading.Thread(target=hold) for _ in range(3)]
    for thread in threads:
        thread.start()
    try:
        time.sleep(0.05)
        assert min(busy.stretch() for _ in range(3)) > 1.5
    finally:
        ended.set()
        for thread in threads:
            thread.join()


def test_processor_time_grows_by_what_the_machine_is_slowed_and_no_more() -> None:
    assert busy.in_processor_time(0.1, 0.2) and not busy.in_processor_time(1e3, 0.2)
    assert 1.0 <= busy.slowed() < 100.0
