"""Crews: whatever the threads, the tiles and the interruptions, one image comes out."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from slow_kind import slow_job
from symrender.errors import OptionError
from symrender.execution import jobs
from symrender.execution import tiles as tiles_module
from symrender.execution.fill import Crew, Means
from symrender.execution.jobs import Job, Tile, blocks, compute
from symrender.execution.tiles import LARGEST, LONGEST, Threads, measured_side, run_threads, tiles
from symrender.scene.arrays import Array


class Stop(Exception):
    pass


def stop_after(count: int) -> Callable[[int, int, str], None]:
    def progress(done: int, total: int, label: str) -> None:
        if done == count:
            raise Stop

    return progress


def layers_of(job: Job, means: Means) -> dict[str, bytes]:
    with Crew(means, (job,)) as crew:
        layers, timing = crew.fill(job)
        crew.succeeded()
    assert timing.evaluations >= layers["hit_class"].size * 3
    return {name: layer.tobytes() for name, layer in layers.items()}


def test_tiles_cover_every_pixel_once() -> None:
    for width, height, side in ((1, 1, 64), (17, 5, 4), (5, 17, 1), (64, 64, 64), (65, 63, 16)):
        seen = np.zeros((height, width))
        for x0, y0, x1, y1 in tiles(width, height, side):
            assert 0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height
            seen[y0:y1, x0:x1] += 1
        assert (seen == 1).all()


def test_threads_and_tiles_change_no_byte() -> None:
    job = slow_job()
    reference = layers_of(job, Means(1, 1000))
    assert np.frombuffer(reference["radiance"]).std() > 0.5
    for threads in (1, 2, 3, 7, 16):
        for tile in (0, 1, 5, 16):
            assert layers_of(job, Means(threads, tile)) == reference


def test_a_unit_is_the_tile_of_the_whole() -> None:
    job = slow_job()
    layers, tile = job.empty_layers(), (3, 2, 11, 9)
    jobs.prepared(job)(0, 0, 24, 18, layers)
    done = compute(job, tile)
    assert done.tile == tile and done.evaluations == 8 * 7 * 3
    for name, block in blocks(layers, tile).items():
        assert done.blocks[name].tobytes() == block.tobytes() and done.blocks[name].flags.c_contiguous


def test_what_decides_the_bytes_and_what_does_not() -> None:
    job = slow_job()
    same = slow_job(threads=3, tile=9, max_pixels=10_000)
    assert job.fields() == same.fields()
    for change in ({"width": 25}, {"lobe": 5}, {"milliseconds": 1}, {"tol": 0.5}, {"disk": "3x3"}):
        other = slow_job(**change)  # type: ignore[arg-type]
        assert sum(other.fields()[name] != value for name, value in job.fields().items()) == 1


@pytest.mark.parametrize("count", [1, 7, 19, 20])
def test_a_run_stopped_anywhere_goes_on(tmp_path: Path, count: int) -> None:
    job, journal = slow_job(), tmp_path / "j"
    reference = layers_of(job, Means(2, 5))
    with pytest.raises(Stop), Crew(Means(2, 5, journal=journal, patience=0.0), (job,), stop_after(count)) as crew:
        crew.fill(job)
    with pytest.raises(OptionError, match="--resume"), Crew(Means(journal=journal), (job,)):
        pass
    rendered: list[Tile] = []
    told: list[tuple[int, int, str]] = []
    means = Means(1, 7, journal=journal, start="resume", patience=0.0)
    with Crew(means, (job,), lambda *values: told.append(values)) as crew:
        run = crew._workers.run

        def counted(job: Job, layers: dict[str, Array], work: list[Tile], finished: object) -> None:
            rendered.extend(work)
            run(job, layers, work, finished)  # type: ignore[arg-type]

        crew._workers.run = counted  # type: ignore[method-assign,assignment]
        layers, timing = crew.fill(job)
        assert {name: layer.tobytes() for name, layer in layers.items()} == reference
        assert timing.evaluations == 24 * 18 * 3
        crew.succeeded()
    assert len(rendered) <= 20 - count, "what the journal holds is not rendered again, on the tiles it was cut in"
    assert told[0][0] >= count and told[-1] == (20, 20, "slow")
    assert not journal.exists()


def test_a_damaged_journal_costs_its_tiles_only(tmp_path: Path) -> None:
    job, journal = slow_job(), tmp_path / "j"
    reference = layers_of(job, Means(2, 5))
    with pytest.raises(Stop), Crew(Means(1, 5, journal=journal, patience=0.0), (job,), stop_after(15)) as crew:
        crew.fill(job)
    whole = journal.read_bytes()
    for k in range(60):
        data = bytearray(whole)
        data[(k * 7919) % len(data)] ^= 1 << k % 8
        journal.write_bytes(data)
        assert layers_of(job, Means(1, 5, journal=journal, start="resume")) == reference


def test_tiles_of_a_fraction_of_a_second() -> None:
    def kernel_of(seconds_a_pixel: float) -> Callable[..., int]:
        def run(job: Job, layers: object, work: list[Tile], finished: Callable[[Tile, int, float], None]) -> None:
            for tile in work:
                # dear at the right, as an image is; one probe in three is disturbed
                dear = 1.0 if tile[0] > job.settings.width // 2 else 0.1
                finished(tile, 0, seconds_a_pixel * dear * tiles_module.area(tile))

        return run

    for seconds, size, most in ((1e-7, 4096, LARGEST), (1e-4, 4096, 31), (2e-3, 512, 7), (0.5, 64, 1), (1e-7, 64, 8)):
        workers = Threads(2)
        workers.run = kernel_of(seconds)  # type: ignore[method-assign,assignment]
        job = slow_job(size, size)
        side = measured_side(workers, job, {})
        assert side == most
        assert side == 1 or side * side * seconds <= LONGEST
    for width, height in ((1, 1), (1, 4096), (3, 2)):
        assert (
            1 <= measured_side(Threads(2), slow_job(width, height), slow_job(width, height).empty_layers()) <= LARGEST
        )


def test_an_error_in_a_kernel_drops_what_has_not_begun() -> None:
    begun: list[Tile] = []

    def kernel(*values: object) -> int:
        begun.append(values[:4])  # type: ignore[arg-type]
        if len(begun) == 3:
            raise ZeroDivisionError
        time.sleep(0.01)
        return 1

    with pytest.raises(ZeroDivisionError):
        run_threads(kernel, {}, list(tiles(100, 100, 10)), 2, lambda *_: None)
    assert 3 <= len(begun) <= 8
    assert not [t for t in threading.enumerate() if "ThreadPool" in t.name]


def test_many_tiles_cost_little_each() -> None:
    work = list(tiles(200, 200, 1))
    done: list[Tile] = []
    begun = time.process_time()
    run_threads(lambda *_: 1, {}, work, 2, lambda tile, *_: done.append(tile))
    each = (time.process_time() - begun) / len(work)
    assert sorted(done) == sorted(work) and len(work) == 40_000
    assert each < 2e-4
