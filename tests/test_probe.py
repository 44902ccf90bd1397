"""Probes in batches: as many threads as one likes change no bit, every point is the one asked for, errors come back."""

from __future__ import annotations

import math
import signal
import sys
import threading
import time

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.probe import probe
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.scene.load import load

SCENE = load("gloss")
POINTS = [(0.9 + 0.05 * math.cos(k), -0.6 + 0.04 * k) for k in range(21)]
"""Two whole batches and a part of a third."""


def test_threads_and_batches_change_no_bit() -> None:
    one = probe(SCENE, POINTS, tol=1e-6, threads=1, wrt=["spheres.B.center"])
    three = probe(SCENE, POINTS, tol=1e-6, threads=3, wrt=["spheres.B.center"])
    assert one.gloss.shape == (21, 3) and len(one.gradient) == 3
    assert len({tuple(row) for row in one.gloss.tolist()}) == 21, "no two points are alike"
    for name in ("gloss", "error", "evaluations", "status", "chambers", "crossings"):
        assert np.array_equal(getattr(one, name), getattr(three, name)), name
    for name in ("gradient", "gradient_error", "gradient_status"):
        assert all(np.array_equal(getattr(one, name)[key], getattr(three, name)[key]) for key in one.gradient)
    for k in (0, 7, 8, 20):
        alone = probe(SCENE, [POINTS[k]], tol=1e-6, wrt=["spheres.B.center"])
        assert np.array_equal(alone.gloss[0], one.gloss[k]) and alone.error[0] == one.error[k]
        assert all(np.array_equal(alone.gradient[key][0], one.gradient[key][k]) for key in one.gradient)
    assert max(np.abs(values).max() for values in one.gradient.values()) > 0.01


def test_one_batch_is_asked_once_and_several_are_tried_on_nothing_first(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def counted(arrays: object, points: np.ndarray, *rest: object) -> SplitResult:
        asked.append(len(points))
        return gloss_points(arrays, points, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(sys.modules[probe.__module__], "gloss_points", counted)
    for count, parts in ((1, [1]), (8, [8]), (9, [0, 1, 8]), (20, [0, 4, 8, 8])):
        asked.clear()
        assert probe(SCENE, POINTS[:count], tol=1e-2).gloss.shape == (count, 3)
        assert asked[0] == parts[0] and sorted(asked) == parts


def test_an_interrupt_comes_between_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[int] = []

    def slow(arrays: object, points: np.ndarray, *rest: object) -> SplitResult:  # type: ignore[type-arg]
        time.sleep(0.05 * (len(points) > 0))
        done.append(len(points))
        return gloss_points(arrays, points, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(sys.modules[probe.__module__], "gloss_points", slow)
    main = threading.main_thread().ident or 0
    timer = threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        probe(SCENE, POINTS * 40, tol=1e-2, threads=2)
    assert 0 < sum(done) < 21 * 40


def test_a_number_of_threads_that_cannot_be() -> None:
    with pytest.raises(OptionError, match="threads: must be a whole number"):
        probe(SCENE, POINTS[:1], threads=-1)
