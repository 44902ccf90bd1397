"""Clusters: the same bytes, no stranger listened to, no other code accepted, a death costs only its tiles."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from execution.workers import children
from slow_kind import slow_job
from symrender.errors import OptionError, SymrenderError, Unsupported
from symrender.execution import cluster as module
from symrender.execution.cluster import Cluster, checked, connect, identity
from symrender.execution.jobs import Done, Job, Tile, blocks, prepared
from symrender.execution.tiles import Threads, tiles
from symrender.scene.load import load
from symrender.settings import Settings

JOB = Job.of("numeric", load("gloss"), Settings(width=48, height=40, lobe=6))


def rendered(workers: Any, job: Job = JOB, side: int = 9) -> dict[str, bytes]:
    layers, counted = job.empty_layers(), []
    work = list(tiles(job.settings.width, job.settings.height, side))
    workers.run(job, layers, work, lambda tile, *_: counted.append(tile))
    assert sorted(counted) == sorted(work)
    return {name: layer.tobytes() for name, layer in layers.items()}


@pytest.fixture(scope="module")
def reference() -> dict[str, bytes]:
    result = rendered(Threads(1))
    assert np.frombuffer(result["gloss"]).mean() > 0.01
    return result


def test_bytes_of_a_cluster_are_those_of_threads(local: Cluster, reference: dict[str, bytes]) -> None:
    assert local.count == 2
    assert rendered(local) == reference
    assert rendered(local, side=48) == reference


def test_local_clusters_listen_on_this_machine_only(local: Cluster) -> None:
    addresses = [local._client.scheduler.address, *local._client.scheduler_info(n_workers=-1)["workers"]]
    assert len(addresses) == 3
    assert all(address.startswith("tls://127.0.0.1:") for address in addresses)
    ports = listening({os.getpid(), *local._client.run(os.getpid).values(), *children()})
    assert len(ports) >= 5 and {host for host, _ in ports} == {"0100007F"}, ports


def listening(processes: set[int]) -> set[tuple[str, str]]:
    """(address, port) in hexadecimal of every socket these processes accept connections on."""
    if not Path("/proc/net/tcp").exists():
        pytest.skip("needs /proc")
    sockets = set()
    for process in processes:
        for handle in Path(f"/proc/{process}/fd").iterdir():
            with contextlib.suppress(OSError):
                sockets.add(str(handle.readlink()))
    rows = [line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]]
    open_ = [row[1].split(":") for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in sockets]
    return {(host, port) for host, port in open_}


def test_a_worker_that_dies_costs_its_tiles_only(local: Cluster, reference: dict[str, bytes]) -> None:
    job = Job.of("numeric", load("gloss"), Settings(width=64, height=64, lobe=40))
    expected, killed, done = rendered(Threads(2), job, 8), [], 0
    layers = job.empty_layers()

    def finished(tile: Tile, evaluations: int, seconds: float) -> None:
        nonlocal done
        done += 1
        if done in (3, 30):
            victim = next(iter(local._client.run(os.getpid).values()))
            os.kill(victim, signal.SIGKILL)
            killed.append(victim)

    local.run(job, layers, list(tiles(64, 64, 8)), finished)
    assert len(set(killed)) == 2 and done == 64
    assert {name: layer.tobytes() for name, layer in layers.items()} == expected


def test_workers_all_gone_come_back(
    local: Cluster, reference: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dask forgets a worker that stays away too long; here both are told to go for good."""
    monkeypatch.setattr(module, "_LOOK_EVERY", 0.5)
    workers = list(local._client.scheduler_info(n_workers=-1)["workers"])
    local._client.retire_workers(workers=workers, close_workers=True, remove=True)
    assert rendered(local) == reference


def test_no_worker_left_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(module, "_LOOK_EVERY", 0.1)
    monkeypatch.setattr(module, "_LONELY", 0.5)
    silent = FakeClient(lambda job, batch: None)
    silent.submit = lambda *_, **__: Silent(None)  # type: ignore[method-assign]
    with pytest.raises(OptionError, match="no worker is left at x; --resume"):
        rendered(Cluster(silent, "x", 2), slow_job(), 5)


@pytest.mark.parametrize("name", ["symrender", "code", "numpy", "python"])
def test_workers_of_another_version_are_refused_by_name(
    local: Cluster, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    here = identity() | {name: "0.0.1"}
    monkeypatch.setattr(module, "_own_identity", lambda: here)
    with pytest.raises(OptionError, match=rf"has {name} \S+, this machine has 0.0.1"):
        module._refuse_other_code(local._client, "local:2")


def test_workers_that_compute_other_bytes_are_refused(local: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    job = Job.of("numeric", load("gloss"), Settings(width=33, height=33))
    real = module.compute

    def last_bit(job: Job, tile: Tile) -> Done:
        done = real(job, tile)
        changed = {name: np.nextafter(block, np.inf) for name, block in done.blocks.items()}
        return Done(tile, changed, done.evaluations, done.seconds)

    monkeypatch.setattr(module, "compute", last_bit)
    with pytest.raises(OptionError, match="computes other bytes than this machine for numeric"):
        rendered(local, job)


class FakeFuture:
    def __init__(self, outcome: Any) -> None:
        self.outcome = outcome

    def add_done_callback(self, call: Callable[[Any], None]) -> None:
        threading.Thread(target=call, args=(self,)).start()

    def result(self) -> Any:
        if isinstance(self.outcome, BaseException):
            raise self.outcome
        return self.outcome


class Silent(FakeFuture):
    """Never done."""

    def add_done_callback(self, call: Callable[[Any], None]) -> None:
        pass


class FakeClient:
    """A client whose every submission has the outcome given."""

    def __init__(self, outcome: Callable[[Job, tuple[Tile, ...]], Any]) -> None:
        self.outcome, self.status = outcome, "running"
        self.given: list[tuple[Tile, ...]] = []

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        return {"workers": {}}

    def run(self, function: Callable[..., Any], *values: Any) -> dict[str, Any]:
        return {"worker": function(*values)}

    def submit(self, function: Any, job: Job, batch: tuple[Tile, ...], pure: bool) -> FakeFuture:
        self.given.append(batch)
        return FakeFuture(self.outcome(job, batch))


def test_a_tile_that_kills_every_worker_is_named() -> None:
    pytest.importorskip("distributed")
    lost: list[tuple[Tile, ...]] = []

    def outcome(job: Job, batch: tuple[Tile, ...]) -> Any:
        if (5, 5, 6, 6) in batch:
            lost.append(batch)
            return CancelledError("gone")
        return module._units(job, batch)

    for count, size in ((2, 1), (25, 2)):
        lost.clear()
        with pytest.raises(OptionError, match=r"tile \(5, 5, 6, 6\) was lost 4 times"):
            rendered(Cluster(FakeClient(outcome), "tcp://127.0.0.1:1", count), slow_job(), 1)
        assert [len(batch) for batch in lost] == [size, 1, 1, 1] and len(lost) == 1 + module.RETRIES


def test_batches_hold_every_tile_once_and_end_together() -> None:
    pytest.importorskip("distributed")
    client = FakeClient(module._units)
    expected = rendered(Threads(1), slow_job(), 1)
    assert rendered(Cluster(client, "tcp://127.0.0.1:1", 25), slow_job(), 1) == expected
    given = [tile for batch in client.given for tile in batch]
    assert sorted(given) == sorted(tiles(24, 18, 1)) and {len(batch) for batch in client.given} == {2}
    for count, total, size in ((1, 10, 1), (2, 10_000, 1), (40, 10_000, 2), (1000, 1_000_000, 50), (1000, 3000, 1)):
        assert module.batch_size(count, total) == size


def test_a_late_worker_with_other_code_and_a_lost_scheduler() -> None:
    pytest.importorskip("distributed")
    late = FakeClient(lambda job, batch: ("other", []))
    with pytest.raises(OptionError, match="joined later runs other code"):
        rendered(Cluster(late, "tcp://127.0.0.1:1", 2), slow_job(), 5)

    gone = FakeClient(lambda job, batch: None)
    gone.submit = lambda *_, **__: Silent(None)  # type: ignore[method-assign]
    gone.status = "closed"
    with pytest.raises(OptionError, match=r"the scheduler at tcp://127\.0\.0\.1:1 is gone; --resume"):
        rendered(Cluster(gone, "tcp://127.0.0.1:1", 2), slow_job(), 5)


def test_an_error_of_a_kernel_is_raised_here() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(ZeroDivisionError):
        rendered(Cluster(FakeClient(lambda job, batch: ZeroDivisionError()), "x", 2), slow_job(), 5)


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("", "must be tcp://host:port"),
        ("local", "must be tcp://host:port"),
        ("local:0", "takes 1 to 1024 processes"),
        ("local:99999", "takes 1 to 1024 processes"),
        ("local:-1", "must be tcp://host:port"),
        ("ucx://127.0.0.1:8786", "must be tcp://host:port"),
        ("inproc://127.0.0.1/1", "must be tcp://host:port"),
        ("tcp://127.0.0.1", "must be tcp://host:port"),
        ("tcp://127.0.0.1:99999", "must be tcp://host:port"),
        ("tcp://:8786", "must be tcp://host:port"),
        ("tcp://user@127.0.0.1:8786", "must be tcp://host:port"),
        ("tcp://127.0.0.1:8786/x", "must be tcp://host:port"),
        ("tcp://[::1:8786", "must be tcp://host:port"),
        ("tcp://10.0.0.7:8786", "another machine without TLS"),
        ("tcp://0.0.0.0:8786", "another machine without TLS"),
        ("tcp://cluster.example:8786", "another machine without TLS"),
        ("tcp://localhost.example:8786", "another machine without TLS"),
        ("tcp://127.0.0.1.example:8786", "another machine without TLS"),
    ],
)
def test_addresses_that_are_refused(address: str, message: str) -> None:
    with pytest.raises(OptionError, match=message) as caught:
        checked(address, insecure=False)
    assert caught.value.exit_code == 2
    if "TLS" in message:
        assert checked(address, insecure=True) == 0


def test_addresses_that_are_accepted() -> None:
    assert checked("local:3", insecure=False) == 3
    for address in ("tcp://127.0.0.1:8786", "tcp://localhost:1", "tcp://[::1]:8786", "tls://10.0.0.7:8786"):
        assert checked(address, insecure=False) == 0


def test_nobody_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(module, "_PATIENCE", 0.3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with (
            pytest.raises(OptionError, match="no scheduler answers at tcp"),
            connect("tcp://127.0.0.1:9"),
        ):
            pass


def test_without_the_library_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for missing in ("distributed", "cryptography"):
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, missing, None)
            with pytest.raises(Unsupported, match=rf"pip install .*'{missing}>="), connect("local:1"):
                pass
    assert issubclass(Unsupported, SymrenderError)


def test_the_unit_says_what_made_it() -> None:
    fingerprint, (done,) = module._units(slow_job(), ((0, 0, 3, 2),))
    assert fingerprint == module._fingerprint() and "numba" in fingerprint
    layers = slow_job().empty_layers()
    prepared(slow_job())(0, 0, 24, 18, layers)
    assert done.blocks["radiance"].tobytes() == blocks(layers, (0, 0, 3, 2))["radiance"].tobytes()
