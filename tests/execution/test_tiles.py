"""Tiles: every pixel once, the same bytes however the work is cut, progress that ends, failures that stop."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from busy import in_time
from symrender.execution import tiles as under_test
from symrender.execution.jobs import Job, Tile, TileKernel
from symrender.execution.tiles import LARGEST, Threads, measured_side, spread, thread_count, tiles
from symrender.render import render
from symrender.scene.arrays import Array
from symrender.scene.load import load
from symrender.settings import Settings

SIZE = 40


@settings(max_examples=100, derandomize=True, deadline=None)
@given(st.integers(1, 60), st.integers(1, 60), st.integers(1, 80))
def test_tiles_cover_every_pixel_once(width: int, height: int, side: int) -> None:
    seen = np.zeros((height, width), dtype=int)
    for x0, y0, x1, y1 in tiles(width, height, side):
        assert 0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height and x1 - x0 <= side and y1 - y0 <= side
        seen[y0:y1, x0:x1] += 1
    assert (seen == 1).all()


def _bytes(threads: int, tile: int, size: int | tuple[int, int] = SIZE) -> list[bytes]:
    pair = render("gloss", size=size, lobe=3, threads=threads, tile=tile)
    images = [image for image in (pair.numeric, pair.symbolic) if image is not None]
    assert len(images) == 2
    assert all(image.layers["gloss"].max() > 0.1 for image in images)
    return [image.layers[name].tobytes() for image in images for name in sorted(image.layers)]


def test_bytes_do_not_depend_on_threads_or_tiles() -> None:
    whole = _bytes(1, SIZE)
    for threads in (1, 2, 3, 7):
        for tile in (7, 64, SIZE, 0):
            assert _bytes(threads, tile) == whole, (threads, tile)


def test_bytes_of_single_pixels() -> None:
    assert _bytes(2, 1, (13, 9)) == _bytes(1, 64, (13, 9))


def _job(seed: int = 1, size: int = SIZE) -> Job:
    return Job.of("symbolic", load("gloss"), Settings(width=size, height=size, seed=seed))


@pytest.fixture
def with_kernel(monkeypatch: pytest.MonkeyPatch) -> Callable[[TileKernel], None]:
    """Replace the kernel that threads run."""
    return lambda kernel: monkeypatch.setattr(under_test, "prepared", lambda _: kernel)


def _work(side: int) -> list[Tile]:
    return list(tiles(SIZE, SIZE, side))


def test_every_tile_is_reported_once_with_its_evaluations(with_kernel: Callable[[TileKernel], None]) -> None:
    names: set[str] = set()
    together = threading.Barrier(3)

    def kernel(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        name = threading.current_thread().name
        if name not in names:
            names.add(name)
            together.wait(60)
        layers["hit_class"][y0:y1, x0:x1] += 1
        return (x1 - x0) * (y1 - y0)

    with_kernel(kernel)
    layers = _job().empty_layers()
    reports: list[tuple[Tile, int, float]] = []
    Threads(3).run(_job(), layers, _work(7), lambda *report: reports.append(report))
    assert sorted(tile for tile, _, _ in reports) == sorted(_work(7))
    assert sum(spent for _, spent, _ in reports) == SIZE * SIZE
    assert all(seconds > 0 for _, _, seconds in reports)
    assert (layers["hit_class"] == 1).all()
    assert len(names) == 3 and threading.current_thread().name not in names


@pytest.mark.parametrize("threads", [1, 3])
def test_an_error_in_a_kernel_stops_the_others(threads: int, with_kernel: Callable[[TileKernel], None]) -> None:
    begun: list[Tile] = []

    def kernel(*arguments: Any) -> int:
        begun.append(arguments[:4])
        if len(begun) == 5:
            raise ArithmeticError("the fifth tile")
        time.sleep(0.01)
        return 1

    with_kernel(kernel)
    work = _work(1)
    finished: list[Tile] = []
    with pytest.raises(ArithmeticError, match="the fifth tile"):
        Threads(threads).run(_job(), _job().empty_layers(), work, lambda tile, *_: finished.append(tile))
    assert len(work) == 1600
    assert 4 - threads < len(finished) and len(begun) < 5 + 4 * threads
    assert not [t for t in threading.enumerate() if t.name.startswith("ThreadPoolExecutor")]


def test_an_error_in_the_callback_stops_too(with_kernel: Callable[[TileKernel], None]) -> None:
    begun: list[int] = []

    def kernel(*_: Any) -> int:
        begun.append(1)
        time.sleep(0.005)
        return 1

    def finished(*_: Any) -> None:
        raise RuntimeError("no more")

    with_kernel(kernel)
    with pytest.raises(RuntimeError, match="no more"):
        Threads(2).run(_job(), _job().empty_layers(), _work(1), finished)
    assert 1 <= len(begun) < 50


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot send itself Ctrl-C there")
def test_interrupt_is_prompt(with_kernel: Callable[[TileKernel], None]) -> None:
    """1600 tiles of .05 s on two threads are 40 s of work; Ctrl-C ends them within a tile and a look at the queue."""

    def kernel(*_: Any) -> int:
        time.sleep(0.05)
        return 1

    with_kernel(kernel)
    sent: list[float] = []

    def interrupt() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.3, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        Threads(2).run(_job(), _job().empty_layers(), _work(1), lambda *_: None)
    assert sent and in_time(time.perf_counter() - sent[0], 1.0)


@pytest.mark.parametrize(("cost", "low", "high"), [(0.0, 8, LARGEST), (2e-3, 1, 8), (1.0, 1, 1)])
def test_measured_side_is_bounded_by_the_cost_of_a_pixel(
    cost: float, low: int, high: int, with_kernel: Callable[[TileKernel], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Clock:
        count = 2

        def run(self, job: Job, layers: Mapping[str, Array], work: Any, finished: Any) -> None:
            for tile in work:
                finished(tile, 1, cost * under_test.area(tile))

    job = Job.of("symbolic", load("gloss"), Settings(width=512, height=512))
    side = measured_side(Clock(), job, {})
    assert low <= side <= high
    assert cost * side * side <= max(under_test.LONGEST, cost)


@pytest.mark.parametrize("filter", ["centre", "box"])
def test_what_is_timed_is_a_small_part_of_the_image(filter: str) -> None:
    class Clock:
        count = 2

        def run(self, job: Job, layers: Mapping[str, Array], work: Any, finished: Any) -> None:
            for tile in work:
                timed.append(under_test.area(tile))
                finished(tile, 1, 1e-6 * under_test.area(tile))

    shares = {}
    for size in (
        (1, 1),
        (3, 3),
        (4, 4),
        (8, 8),
        (12, 9),
        (16, 16),
        (24, 24),
        (40, 30),
        (64, 64),
        (100, 70),
        (256, 256),
    ):
        timed: list[int] = []
        job = Job.of("truth", load("gloss"), Settings(width=size[0], height=size[1], filter=filter))
        assert 1 <= measured_side(Clock(), job, {}) <= LARGEST
        shares[size] = sum(timed) / (size[0] * size[1])
    assert shares[256, 256] > 0.0 and max(shares.values()) < 0.4
    assert max(share for size, share in shares.items() if min(size) >= 8) < 0.17


@pytest.mark.parametrize("dearest", [0.001, 0.5])
def test_what_takes_long_is_timed_once(dearest: float) -> None:
    timed: list[tuple[int, int]] = []

    class Clock:
        count = 2

        def run(self, job: Job, layers: Mapping[str, Array], work: Any, finished: Any) -> None:
            for tile in work:
                timed.append(tile[:2])
                finished(tile, 1, dearest if len(set(timed)) == 1 else 0.1 * dearest)

    measured_side(Clock(), Job.of("truth", load("gloss"), Settings(width=256, height=256)), {})
    assert len(set(timed)) == 9
    assert timed.count(timed[0]) == (3 if dearest < 0.01 else 1)


def test_thread_count() -> None:
    assert thread_count(5) == 5
    assert 1 <= thread_count(0) <= (os.cpu_count() or 1)


@pytest.mark.parametrize("tile", [7, 64])
def test_progress_reaches_its_total_on_the_calling_thread(tile: int) -> None:
    seen: list[tuple[int, int, str, str]] = []
    render(
        "gloss",
        size=SIZE,
        lobe=1,
        tile=tile,
        threads=2,
        progress=lambda done, total, label: seen.append((done, total, label, threading.current_thread().name)),
    )
    for label in ("numeric", "symbolic"):
        steps = [(done, total) for done, total, name, _ in seen if name == label]
        total = len(list(tiles(SIZE, SIZE, tile)))
        assert steps == [(k + 1, total) for k in range(total)]
    assert {name for *_, name in seen} == {threading.current_thread().name}


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.integers(1, 90), st.integers(1, 90), st.integers(1, 20))
def test_spread_tiles_are_the_same_tiles(width: int, height: int, side: int) -> None:
    work = list(tiles(width, height, side))
    assert sorted(spread(work, side)) == sorted(work)
    assert spread(work[::-1], side) == spread(work, side), "an order of their own"


def test_from_a_tenth_on_what_is_done_foretells_the_rest() -> None:
    # dear tiles below a horizon, dearest in one corner: rows from the top would foretell ten times too little
    def cost(tile: Tile) -> float:
        x, y = tile[0] / 256, tile[1] / 256
        return 0.02 if y < 0.5 else 1 + 6 * (x > 0.5 and y > 0.75)

    order = spread(list(tiles(256, 256, 22)), 22)
    spent = np.cumsum([cost(tile) for tile in order])
    done = np.arange(1, len(order) + 1)
    late = done >= 0.1 * len(order)
    foretold = spent / done * len(order)
    assert len(order) == 144 and (np.maximum(foretold / spent[-1], spent[-1] / foretold)[late] < 1.5).all()
    rows = np.cumsum([cost(tile) for tile in tiles(256, 256, 22)])
    assert (rows / done * len(order))[late].min() < 0.2 * rows[-1], "the order is what does it"
