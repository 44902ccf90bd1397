"""Tables beside an image: written once, read only by whom they belong to, resumed, and shared by a cluster."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.radiometric.flats import rectangle, world
from tests.radiosity.rooms import MATERIALS, closed

import symrender as sr
from symrender.errors import OptionError, OutputError
from symrender.execution import tables as module
from symrender.execution.cluster import Cluster
from symrender.execution.fill import Crew, Means
from symrender.execution.jobs import Job, prepared
from symrender.execution.tables import all_given, tables_needed, take_all
from symrender.execution.tiles import tiles
from symrender.gradient import gradient_job
from symrender.radiosity import work
from symrender.runtimes import tables
from symrender.settings import Settings

SETTINGS = Settings(width=8, height=6, tol=0.5, threads=1)


def scene(**changes: Any) -> Any:
    """Bare walls and a rug under a point light."""
    key = {"type": "point", "name": "key", "position": [0.7, 0.3, 0.8], "intensity": [0.1, 0.08, 0.05]}
    rug = rectangle("rug", [0.1, 0.1, 0.2], [0.3, 0, 0], [0, 0.3, 0], "grey")
    made = world(*closed(), rug, lights=[key], materials=MATERIALS, bounces="all")
    made["camera"] = {"type": "look_at", "eye": [0.5, 0.02, 0.5], "target": [0.5, 1, 0.4]}
    return sr.load(made).replace(changes) if changes else sr.load(made)


def job_of(settings: Settings = SETTINGS, **changes: Any) -> Job:
    return Job.of("radiometric", scene(**changes), settings)


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is had, and rows are kept soon."""
    monkeypatch.setattr(work, "PIECE", 512)
    forget()


def forget() -> None:
    tables._tables.clear()
    prepared.cache_clear()


def filled(job: Job, folder: Path | None, start: Any = "new", patience: float = 0.0) -> dict[str, bytes]:
    """The layers of an image made as a new process would make it, its files in a folder."""
    forget()
    means = Means(1, 4, journal=None if folder is None else folder / "truth.journal", start=start, patience=patience)
    with Crew(means, (job,)) as crew:
        layers, _ = crew.fill(job)
        crew.succeeded()
    assert layers["indirect"].min() > 1e-4
    return {name: layer.tobytes() for name, layer in layers.items()}


def no_table_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> Any:
        raise AssertionError("a table is made")

    monkeypatch.setattr(tables, "sendings", refuse)


def test_a_table_is_stored_and_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither the camera nor the size is part of it."""
    whole = filled(job_of(), None)
    other = job_of(Settings(width=5, height=5, tol=0.5), **{"camera.eye": [0.3, 0.1, 0.7], "camera.fov": 60})
    away = filled(other, None)
    assert filled(job_of(), tmp_path) == whole
    assert [path.name for path in tmp_path.iterdir()] == ["truth.table"]
    no_table_is_made(monkeypatch)
    assert filled(job_of(), tmp_path) == whole
    assert filled(other, tmp_path) == away


def test_a_quick_table_leaves_nothing(tmp_path: Path) -> None:
    filled(job_of(), tmp_path, patience=60.0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "changes",
    [{"shapes.rug.corner.z": 0.25}, {"lights.key.intensity": [0.1, 0.08, 0.06]}, {"materials.grey.reflectance": 0.41}],
)
def test_the_table_of_another_scene_is_replaced(changes: dict[str, Any], tmp_path: Path) -> None:
    first, second = filled(job_of(), tmp_path), filled(job_of(**changes), None)
    before = (tmp_path / "truth.table").read_bytes()
    assert first != second
    assert filled(job_of(**changes), tmp_path) == second
    after = (tmp_path / "truth.table").read_bytes()
    assert after != before and not take_all(tables_needed(job_of()), after)
    forget()
    assert take_all(tables_needed(job_of(**changes)), after) == 1


def test_the_table_of_another_tolerance_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    finer = job_of(Settings(width=8, height=6, tol=0.2, threads=1))
    alone = filled(finer, None)
    assert filled(job_of(), tmp_path) != alone
    assert filled(finer, tmp_path) == alone
    no_table_is_made(monkeypatch)
    assert filled(finer, tmp_path) == alone
    with pytest.raises(AssertionError, match="a table is made"):
        filled(job_of(), tmp_path)


@pytest.mark.parametrize("field", ["version", "code", "numpy", "machine"])
def test_the_table_of_other_code_is_not_read(field: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filled(job_of(), tmp_path)
    here = module.maker()
    monkeypatch.setattr(module, "maker", lambda: here | {field: "another"})
    no_table_is_made(monkeypatch)
    with pytest.raises(AssertionError, match="a table is made"):
        filled(job_of(), tmp_path)


def test_a_damaged_table_is_made_again(tmp_path: Path) -> None:
    whole = filled(job_of(), tmp_path)
    path = tmp_path / "truth.table"
    data = path.read_bytes()
    for k, damage in enumerate((data[:-1], data[: len(data) // 2], data[:20], data[:-9] + bytes(9), b"")):
        path.write_bytes(damage)
        assert filled(job_of(), tmp_path) == whole, k
        assert path.read_bytes() == data, "it is whole again"
    middle = len(data) // 2
    path.write_bytes(data[:middle] + bytes([data[middle] ^ 4]) + data[middle + 1 :])
    assert filled(job_of(), tmp_path) == whole and path.read_bytes() == data


def test_what_is_no_table_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "truth.table"
    path.write_text("dear to somebody")
    with pytest.raises(OptionError, match=r"truth.table: is not a table of symrender; move it away"):
        filled(job_of(), tmp_path)
    assert path.read_text() == "dear to somebody"
    path.unlink()
    path.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OutputError, match="symbolic link"):
        filled(job_of(), tmp_path)


def test_restart_makes_it_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filled(job_of(), tmp_path)
    no_table_is_made(monkeypatch)
    with pytest.raises(AssertionError, match="a table is made"):
        filled(job_of(), tmp_path, "restart")


KILLED = """
import os, signal, sys
from pathlib import Path
sys.path[:0] = {paths!r}
from symrender.execution.journal import Journal
from tests.execution import test_tables as test
from symrender.radiosity import work
work.PIECE = 512
keep, count = Journal.keep, 0
def slow(self, name, values):
    global count
    keep(self, name, values)
    count += 1
    if count == {most}:
        os.kill(os.getpid(), signal.SIGKILL)
Journal.keep = slow
test.filled(test.job_of(), Path({folder!r}))
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_run_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was worked out before the end is not worked out again, and the image is the same bit for bit."""
    most, whole = 20, filled(job_of(), None)
    code = KILLED.format(paths=sys.path, most=most, folder=str(tmp_path))
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["truth.journal"]
    with pytest.raises(OptionError, match="an interrupted run left 20 pieces; --resume continues it"):
        filled(job_of(), tmp_path)
    found = []
    before = work.Work.filled

    def counted(self: Any, width: int, fill: Any, common: Any, each: Any) -> Any:
        def heard(part: slice, rows: Any) -> None:
            found.append(part)
            fill(part, rows)

        return before(self, width, heard, common, each)

    monkeypatch.setattr(work.Work, "filled", counted)
    filled(job_of(), None)
    every = len(found)
    found.clear()
    assert filled(job_of(), tmp_path, "resume") == whole
    assert 0 < len(found) <= every - most
    assert [path.name for path in tmp_path.iterdir()] == ["truth.table"]


def test_damaged_rows_are_worked_out_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = filled(job_of(), None)

    def left(most: int) -> bytes:
        """The journal of a run that ends after so many kept rows."""
        from symrender.execution.journal import Journal

        count, keep = 0, Journal.keep

        def ending(self: Journal, name: str, values: Any) -> None:
            nonlocal count
            keep(self, name, values)
            count += 1
            if count == most:
                raise KeyboardInterrupt

        with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
            patch.setattr(Journal, "keep", ending)
            filled(job_of(), tmp_path, "restart")
        return (tmp_path / "truth.journal").read_bytes()

    data = left(12)
    draw = np.random.default_rng(5)
    for _ in range(6):
        torn = bytearray(data)
        for at in draw.integers(400, len(torn), 40):
            torn[at] ^= 1 << int(draw.integers(8))
        (tmp_path / "truth.journal").write_bytes(bytes(torn))
        assert filled(job_of(), tmp_path, "resume") == whole
        (tmp_path / "truth.table").unlink()


def test_a_gradient_has_a_table_for_each_parameter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["lights.key.intensity[0]", "lights.key.intensity[1]"]
    job = gradient_job(scene(), names, SETTINGS)

    def slopes() -> dict[str, bytes]:
        forget()
        with Crew(Means(1, 4, journal=tmp_path / "truth.journal", patience=0.0), (job,)) as crew:
            layers, _ = crew.fill(job)
            crew.succeeded()
        assert all(layers[f"indirect:{name}"].max() > 1e-3 for name in names)
        return {name: layer.tobytes() for name, layer in layers.items()}

    first = slopes()
    assert len(tables._tables) == len(tables_needed(job)) == 2
    no_table_is_made(monkeypatch)
    assert slopes() == first


def had(job: Job) -> bool:
    """Whether a worker has all tables of a job."""
    return all(tables.is_had(need) for need in tables_needed(job))


def make_none() -> None:
    """From now on a worker that makes a table fails."""

    def refuse(*_: Any) -> Any:
        raise AssertionError("a worker makes a table")

    tables.sendings = refuse


def test_workers_share_the_table_of_who_asks(local: Cluster) -> None:
    job = job_of()
    whole = filled(job, None)
    local._client.run(make_none)
    assert not any(local._client.run(had, job).values())
    layers = job.empty_layers()
    work_ = list(tiles(8, 6, 4))
    local.run(job, layers, work_, lambda *_: None)
    assert {name: layer.tobytes() for name, layer in layers.items()} == whole
    assert all(local._client.run(had, job).values())
    # one that comes later has it, too, before it is asked for anything
    victim = next(iter(local._client.run(os.getpid).values()))
    os.kill(victim, signal.SIGKILL)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        workers = local._client.run(os.getpid, on_error="ignore") or {}
        if len(workers) == 2 and victim not in workers.values():
            break
        time.sleep(0.1)
    assert len(workers) == 2 and victim not in workers.values()
    assert all(local._client.run(had, job).values())
    local.tables.forget()


def test_bytes_of_tables_are_those_of_all(tmp_path: Path) -> None:
    """Tables that are many in one file are told apart by what they are of."""
    jobs = [job_of(), job_of(**{"shapes.rug.corner.z": 0.25})]
    needed = [tables_needed(job)[0] for job in jobs]
    for need in needed:
        tables.table_of(need)
    data = all_given(tuple(needed))
    forget()
    assert take_all(tuple(reversed(needed)), data) == 2
    assert all(tables._tables[need.key] is tables.table_of(need) for need in needed)
    forget()
    assert take_all((needed[1],), data) == 1 and not tables.is_had(needed[0])
