"""Limits of time are those of a quiet machine, and no more than stretched on a busy one."""

from __future__ import annotations

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


class Clocks:
    """The clocks of a thread that has the processor for a share of the time."""

    def __init__(self, share: float) -> None:
        self.share = share
        self.wall = 0.0

    def perf_counter(self) -> float:
        return self.wall

    def thread_time(self) -> float:
        self.wall += 0.001
        return self.share * self.wall


@pytest.mark.parametrize("share", [1.0, 0.5, 0.1])
def test_the_stretch_is_how_long_others_keep_us_waiting(monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    monkeypatch.setattr(busy, "time", Clocks(share))
    assert busy.stretch() == pytest.approx(1.0 / share, rel=0.05)


def test_a_limit_is_stretched_where_others_keep_us_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(busy, "time", Clocks(0.25))
    assert busy.in_time(3.5, 1.0)
    assert not busy.in_time(4.5, 1.0)


def test_processor_time_grows_by_what_the_machine_is_slowed_and_no_more() -> None:
    assert busy.in_processor_time(0.1, 0.2) and not busy.in_processor_time(1e3, 0.2)
    assert 1.0 <= busy.slowed() < 100.0
