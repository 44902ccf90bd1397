"""Two workers take half the time of one, threads or processes; what a thousand would do follows from measured costs.

Measured: the wall time of twenty seconds of tiles on 1 and 2 threads and 1 and 2 processes of a local cluster; the
processor time a task costs the scheduler and client, and a worker; and, with the product's own code, clusters of
artificial workers that sleep in place of computing, whose efficiency is compared with what the costs predict.
With ``--write`` what is printed also goes between the marks of ``docs/scaling.md``. Ten minutes on two idle processors.
"""

from __future__ import annotations

import asyncio
import contextlib
import io
import logging
import multiprocessing
import os
import platform
import sys
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report, arguments, median

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from slow_kind import slow_job
from symrender.execution import cluster as cluster_module
from symrender.execution.cluster import Cluster, batch_size, connect
from symrender.execution.jobs import Done, Job, Tile
from symrender.execution.tiles import Threads, Workers, tiles
from symrender.scene.load import load
from symrender.settings import Settings

TILE = 2.0
"""Seconds an artificial worker sleeps over a tile."""
TURNS = 4
CORES = 1000
DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "scaling.md"
MARKS = ("<!-- scales_to_many_workers -->\n", "<!-- /scales_to_many_workers -->\n")


def wall(workers: Workers, job: Job, side: int) -> tuple[float, float]:
    """Wall seconds of an image, and the sum of the seconds of its tiles."""
    layers, spent = job.empty_layers(), []
    work = list(tiles(job.settings.width, job.settings.height, side))
    begun = time.perf_counter()
    workers.run(job, layers, work, lambda tile, evaluations, seconds: spent.append(seconds))
    assert len(spent) == len(work)
    return time.perf_counter() - begun, sum(spent)


def alone(job: Job, side: int, part: int) -> float:
    """Wall seconds of every other tile on one thread of this process."""
    work = list(tiles(job.settings.width, job.settings.height, side))[part::2]
    begun = time.perf_counter()
    Threads(1).run(job, job.empty_layers(), work, lambda *_: None)
    return time.perf_counter() - begun


def real(report: Report, *, quick: bool) -> None:
    """Threads and processes that compute, beside two processes that know nothing of each other."""
    job = Job.of("numeric", load("gloss"), Settings(width=256, height=256, lobe=12 if quick else 56))
    side, rounds = 16, (1 if quick else 3)
    first = Job.of("numeric", load("gloss"), Settings(width=16, height=16, lobe=2))
    rows: dict[str, list[tuple[float, float, float]]] = {"unrelated processes": [], "threads": [], "processes": []}
    spawn = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(2, mp_context=spawn) as pool,
        connect("local:1") as single,
        connect("local:2") as double,
    ):
        for workers in (single, double, Threads(1)):
            wall(workers, first, 2)
        list(pool.map(alone, [first] * 4, [2] * 4, [0, 1, 0, 1]))
        for _ in range(rounds):
            one, _ = wall(Threads(1), job, side)
            begun = time.perf_counter()
            inside = sum(pool.map(alone, [job] * 2, [side] * 2, [0, 1]))
            rows["unrelated processes"].append((one, time.perf_counter() - begun, inside))
            rows["threads"].append((one, *wall(Threads(2), job, side)))
            one, _ = wall(single, job, side)
            rows["processes"].append((one, *wall(double, job, side)))
    table = []
    for name, timed in rows.items():
        gain = median([one / two / 2 for one, two, _ in timed])
        share = median([inside / two / 2 for _, two, inside in timed])
        one, two = (median([row[k] for row in timed]) for k in (0, 1))
        table.append((name, one, two, gain, gain / table[0][3] if table else 1.0, share))
    head = ("two workers", "one, s", "two, s", "efficiency", "of what two unrelated processes get", "time inside tiles")
    report.table(head, table)
    report.say(f"Load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors; other work makes these worse.")
    for row in table[1:]:
        report.claim_time(f"efficiency of two {row[0]}", float(row[3]), 0.9, float("inf"))
        report.claim_time(f"efficiency of two {row[0]}, of what the machine gives", float(row[4]), 0.9, float("inf"))
        report.claim_time(f"share of the time inside tiles, two {row[0]}", float(row[5]), 0.9, float("inf"))


def local(workers: int, threads: int, *, processes: bool) -> Any:
    """A plain local cluster of dask, without the product's checks."""
    import distributed

    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=threads,
        processes=processes,
        protocol="tcp",
        host="127.0.0.1",
        silence_logs=logging.CRITICAL,
        memory_limit=0,
        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
    )


def noop(job: Job, batch: object, size: int) -> bytes:
    """A task that computes nothing and returns ``size`` bytes."""
    return b"x" * size


def costs(report: Report, *, quick: bool) -> float:
    """Processor milliseconds of a task, by the bytes it returns; the slope a byte and the constant are reported."""
    import distributed

    count, rows = (100 if quick else 500), []
    with (
        closing(local(1, 1, processes=True)) as cluster,
        closing(distributed.Client(cluster, set_as_default=False)) as c,
    ):
        c.submit(noop, slow_job(), (), 0).result()
        for size in (0, 80_000, 320_000):
            there = sum(c.run(time.process_time).values())
            here = time.process_time()
            c.gather([c.submit(noop, slow_job(), (k,), size, pure=False) for k in range(count)])
            central = 1e3 * (time.process_time() - here) / count
            worker = 1e3 * (sum(c.run(time.process_time).values()) - there) / count
            rows.append((size, central, worker))
    report.table(("bytes returned", "scheduler and client, CPU ms a task", "worker, CPU ms a task"), rows)
    a_tile = (rows[2][1] - rows[0][1]) / 320_000 * 80
    report.say(f"That is {rows[0][1]:.2f} ms a task and {1e3 * a_tile:.2f} us a pixel of 80 bytes.")
    return rows[0][1]


def thousand(report: Report, each: float) -> None:
    """What the costs allow a thousand workers, by how long a tile takes: ``each`` is ms a task at the centre."""
    held = batch_size(CORES, 10**9)
    rows = []
    for tile in (0.05, 0.1, 0.2, 0.5):
        task = held * tile
        busy = CORES / task * each / 1e3
        rows.append((f"{tile:g} s", task, CORES / task, busy, min(1.0, 1 / busy)))
    report.say(f"{CORES} workers, {held} tiles a task, {each:.2f} ms of the scheduler and the client a task:")
    head = ("a tile takes", "a task takes, s", "tasks a second", "scheduler and client busy", "efficiency at most")
    report.table(head, rows)


async def sleeping_units(job: Job, batch: tuple[Tile, ...]) -> tuple[str, list[Done]]:
    """What an artificial worker runs in place of ``cluster._units``: a nap, then tiles of zeros."""
    await asyncio.sleep(job.settings.seed / 1000 * len(batch))
    zeros = np.zeros((batch[0][3] - batch[0][1], batch[0][2] - batch[0][0], 3))
    return cluster_module._fingerprint(), [
        Done(tile, {"radiance": zeros, "hit_class": zeros[..., 0]}, 0, 0.0) for tile in batch
    ]


def share() -> float:
    """Part of a processor this process is given when it asks for one whole, with whatever else runs now."""
    wall_begun, begun = time.perf_counter(), time.process_time()
    while time.perf_counter() < wall_begun + 1.0:
        pass
    return (time.process_time() - begun) / (time.perf_counter() - wall_begun)


def artificial(report: Report, counts: tuple[int, ...]) -> None:
    """Workers that sleep; one process plays them, the scheduler and the client."""
    import distributed

    cluster_module._units = sleeping_units  # type: ignore[assignment]
    rows = []
    for count in counts:
        threads = min(100, count)
        cluster = local(count // threads, threads, processes=False)
        with closing(cluster), closing(distributed.Client(cluster, set_as_default=False)) as client:
            side, wanted = 4, TURNS * count * min(5, batch_size(count, 10**9))
            columns = min(wanted, 2000)
            job = slow_job(side * columns, side * (wanted // columns), milliseconds=0)
            work = list(tiles(job.settings.width, job.settings.height, side))
            workers = Cluster(client, "artificial", count)
            workers._equal.add(job)
            begun = time.process_time()
            workers.run(job, job.empty_layers(), work[: 4 * count], lambda *_: None)
            each = (time.process_time() - begun) / (4 * count)
            size = batch_size(count, len(work))
            slept = slow_job(job.settings.width, job.settings.height, milliseconds=int(1e3 * TILE / size))
            workers._equal.add(slept)
            given, begun = share(), time.process_time()
            seconds, _ = wall_of(workers, slept, work)
            spent = (time.process_time() - begun) * size / len(work)
            given = (given + share()) / 2
            ideal = TILE / size * len(work) / count
            # a task keeps its worker for TILE, and this one process, which has a part of a processor, for its cost
            predicted = 1 / max(1.0, count * each / TILE / given)
            rows.append((count, len(work), size, 1e3 * each, 1e3 * spent, given, seconds, ideal / seconds, predicted))
    head = (
        "workers",
        "tiles",
        "tiles a task",
        "CPU ms a task, all in one process",
        "the same, in this run",
        "part of a processor given",
        "wall, s",
        "efficiency",
    )
    report.table((*head, "predicted at most"), rows)
    for row in rows:
        report.claim_time(f"efficiency over prediction, {row[0]} workers", row[7] / row[8], 0.7, 1.05)


def wall_of(workers: Workers, job: Job, work: list[Any]) -> tuple[float, int]:
    """Wall seconds of ``work``."""
    layers, done = job.empty_layers(), []
    begun = time.perf_counter()
    workers.run(job, layers, work, lambda tile, *_: done.append(tile))
    assert len(done) == len(work)
    return time.perf_counter() - begun, len(done)


class Heard(io.StringIO):
    """What is printed, kept and shown."""

    def write(self, text: str) -> int:
        """Keep and show."""
        sys.__stdout__.write(text)  # type: ignore[union-attr]
        return super().write(text)


def main() -> None:
    options = arguments(__doc__, flags={"--write": "also into docs/scaling.md"})
    warnings.simplefilter("ignore")
    with contextlib.redirect_stdout(Heard()) as heard:
        report = Report("scales_to_many_workers", "Threads, processes, and artificial workers up to a thousand.")
        each = costs(report, quick=options.quick)
        real(report, quick=options.quick)
        thousand(report, each)
        artificial(report, (10, 100) if options.quick else (10, 100, 300, 1000))
        report.say(f"{os.cpu_count()} processors, {platform.machine()}, Python {platform.python_version()}.")
    if options.write:
        begin, end = MARKS
        before, _, rest = DOCUMENT.read_text(encoding="utf-8").partition(begin)
        figures = heard.getvalue().partition("\n\n")[2].partition("\n\n")[2].strip()
        DOCUMENT.write_text(f"{before}{begin}\n{figures}\n\n{end}{rest.partition(end)[2]}", encoding="utf-8")
    report.leave()


if __name__ == "__main__":
    main()
