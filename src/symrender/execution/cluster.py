"""The same units on a cluster, by dask.distributed: processes of this machine, or of many.

What travels is the job (a scene as text, its settings) and a tile; what comes back are the tile's layers. Before any
work, and again with every result, a worker must show that it runs this very code: versions are compared by name, and
one tile rendered there must equal the same tile rendered here, byte for byte. A worker that dies costs the tiles it
held, which go to another. Everything a scheduler sends is unpickled, so it must be trusted: one that is neither on this
machine nor behind TLS is refused.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import ipaddress
import logging
import math
import os
import platform
import re
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import lru_cache
from importlib import metadata
from itertools import islice
from multiprocessing.resource_tracker import _resource_tracker, ensure_running
from queue import Empty, SimpleQueue
from typing import Any, Final
from urllib.parse import urlsplit

from symrender import version
from symrender.errors import OptionError, Unsupported, remedy
from symrender.execution.jobs import Done, Job, Tile, blocks, code_digest, compute
from symrender.execution.shared import SharedTables
from symrender.execution.tiles import Finished, next_of
from symrender.scene.arrays import Array
from symrender.scene.printable import printable

MAX_LOCAL: Final = 1024
"""Most worker processes of ``local:N``."""
RETRIES: Final = 3
"""How often a tile whose workers keep dying is given out again; each time, dask itself tries four workers."""
_PATIENCE: Final = 20.0
_LOOK_EVERY: Final = 5.0
_LONELY: Final = 60.0
_AHEAD: Final = 4
_ENDING: Final = 1.0
_QUIET: Final = 0.05
_WORKERS_A_TILE: Final = 20
_PROBE_SIDE: Final = 8


def identity() -> dict[str, str]:
    """What must be equal on both sides for equal bytes, by name."""
    packages = {name: metadata.version(name) for name in ("numpy", "numba", "llvmlite", "sympy", "distributed")}
    return {
        "symrender": version.VERSION,
        "code": code_digest()[:16],
        "python": ".".join(platform.python_version_tuple()[:2]),
        **packages,
        "machine": platform.machine(),
    }


@contextmanager
def connect(address: str, *, insecure: bool = False) -> Iterator[Cluster]:
    """A cluster to work on: ``local:N`` starts N processes here, ``tcp://`` and ``tls://host:port`` join a scheduler.

    ``local:N`` listens on 127.0.0.1 only, with certificates of its own that nobody else has. ``tls://`` takes its
    certificates from dask's configuration (``distributed.comm.tls``). Raises OptionError for anything else, for a
    scheduler elsewhere without TLS unless ``insecure``, when nobody answers, or when a worker runs other code.
    """
    count = checked(address, insecure=insecure)
    distributed = _library()
    with _local(distributed, count) if count else _remote(distributed, address) as (client, revive):
        workers = client.scheduler_info(n_workers=-1)["workers"]
        if not workers:
            raise OptionError(f"cluster: {address} has no workers")
        _refuse_other_code(client, address)
        cluster = Cluster(client, address, sum(worker["nthreads"] for worker in workers.values()), revive)
        yield cluster
        if not count:
            # a scheduler that was joined goes on
            cluster.tables.forget()


class Cluster:
    """Workers of a dask cluster."""

    def __init__(self, client: Any, address: str, count: int, revive: Callable[[], object] = lambda: None) -> None:
        self.count = count
        self._client, self._address, self._revive = client, address, revive
        self._equal: set[Job] = set()
        self.tables = SharedTables(client)

    def run(self, job: Job, layers: Mapping[str, Array], work: Sequence[Tile], finished: Finished) -> None:
        """Fill ``layers`` with what the workers return.

        Ctrl-C or an error in a kernel gives up what is under way. A tile whose workers die is given to others; after
        ``RETRIES`` times OptionError names it.
        """
        self.tables.share(job)
        self._require_equal_bytes(job)
        coming, tries = iter(work), dict.fromkeys(work, 0)
        running: dict[Any, tuple[Tile, ...]] = {}
        ended: SimpleQueue[Any] = SimpleQueue()
        size = batch_size(self.count, len(work))

        def submit(batch: tuple[Tile, ...]) -> None:
            if batch:
                future = self._client.submit(_units, job, batch, pure=False)
                running[future] = batch
                future.add_done_callback(ended.put)

        try:
            for _ in range(_AHEAD * self.count):
                submit(tuple(islice(coming, size)))
            while running:
                future = self._next(ended)
                batch = running.pop(future)
                units = self._result(future, batch, tries)
                if units is None:
                    # one by one, so that a tile no worker survives is found
                    for tile in batch:
                        submit((tile,))
                    continue
                submit(tuple(islice(coming, size)))
                for done in units:
                    for name, block in blocks(layers, done.tile).items():
                        block[...] = done.blocks[name]
                    finished(done.tile, done.evaluations, done.seconds)
        finally:
            # what nobody waits for any more, the scheduler drops
            running.clear()

    def _next(self, ended: SimpleQueue[Any]) -> Any:
        last_look = workers_seen = time.monotonic()
        while True:
            try:
                # a bounded wait, so that Ctrl-C and a lost scheduler are seen
                return ended.get(timeout=0.1)
            except Empty:
                pass
            now = time.monotonic()
            if self._client.status not in ("running", "connecting"):
                gone = f"cluster: the scheduler at {self._address} is gone; --resume continues the run"
                raise OptionError(gone)
            if now - last_look > _LOOK_EVERY:
                last_look = now
                self._revive()
                if self._client.scheduler_info(n_workers=-1)["workers"]:
                    workers_seen = now
                if now - workers_seen > _LONELY:
                    raise OptionError(f"cluster: no worker is left at {self._address}; --resume continues the run")

    def _result(self, future: Any, batch: tuple[Tile, ...], tries: dict[Tile, int]) -> list[Done] | None:
        """What came back, or None when the tiles must be given out again."""
        from distributed import KilledWorker

        try:
            fingerprint, units = future.result()
        except (KilledWorker, CancelledError) as error:
            for tile in batch:
                tries[tile] += 1
                if tries[tile] > RETRIES:
                    raise OptionError(f"cluster: tile {tile} was lost {tries[tile]} times, its workers died") from error
            return None
        if fingerprint != _fingerprint():
            raise OptionError(f"cluster: a worker at {self._address} that joined later runs other code or versions")
        result: list[Done] = units
        return result

    def _require_equal_bytes(self, job: Job) -> None:
        """Every worker renders one tile this process renders too: libraries and processors can differ unseen."""
        if job in self._equal:
            return
        x, y = job.settings.width // 2, job.settings.height // 2
        tile = (x, y, min(x + _PROBE_SIDE, job.settings.width), min(y + _PROBE_SIDE, job.settings.height))
        here = _probe(job, tile)
        for worker, there in self._client.run(_probe, job, tile).items():
            if there != here:
                raise OptionError(f"cluster: worker {worker} computes other bytes than this machine for {job.kind}")
        self._equal.add(job)


def batch_size(count: int, tiles: int) -> int:
    """Tiles given out at a time to ``count`` workers, so that the scheduler keeps up and every worker has a few turns.

    A scheduler spends milliseconds on a task, whatever its length (``docs/scaling.md``).
    """
    return max(1, min(math.ceil(count / _WORKERS_A_TILE), tiles // (_AHEAD * count)))


def _units(job: Job, batch: tuple[Tile, ...]) -> tuple[str, list[Done]]:
    """What a worker runs; with the result comes what made it."""
    return _fingerprint(), [compute(job, tile) for tile in batch]


def _probe(job: Job, tile: Tile) -> str:
    """Digest of one tile."""
    digest = hashlib.sha256()
    for block in compute(job, tile).blocks.values():
        digest.update(block.tobytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _own_identity() -> dict[str, str]:
    return identity()


def _fingerprint() -> str:
    return repr(sorted(_own_identity().items()))


def _refuse_other_code(client: Any, address: str) -> None:
    try:
        answers = client.run(identity)
    except Exception as error:  # whatever a worker without this package makes of the question
        raise OptionError(f"cluster: the workers at {address} cannot run symrender: {error}") from None
    here = _own_identity()
    for worker, there in answers.items():
        for name, value in here.items():
            if there.get(name) != value:
                raise OptionError(f"cluster: worker {worker} has {name} {there.get(name)}, this machine has {value}")


def checked(address: str, *, insecure: bool) -> int:
    """N of ``local:N``, 0 for a scheduler that may be joined; OptionError for any other address."""
    local = re.fullmatch(r"local:([0-9]{1,5})", address)
    if local:
        count = int(local[1])
        if not 1 <= count <= MAX_LOCAL:
            raise OptionError(f"cluster: local:N takes 1 to {MAX_LOCAL} processes, got {count}")
        return count
    try:
        url = urlsplit(address)
        known = (
            url.scheme in ("tcp", "tls") and url.hostname and url.port and not (url.path or url.query or url.username)
        )
    except ValueError:
        known = False
    if not known:
        shown = printable(address, 60)
        raise OptionError(f"cluster: must be tcp://host:port, tls://host:port or local:N, got {shown!r}")
    if url.scheme == "tcp" and not _is_loopback(str(url.hostname)) and not insecure:
        raise OptionError(
            f"cluster: {printable(address, 60)} is another machine without TLS, and what it sends is run here; "
            "use tls:// or --insecure-cluster"
        )
    return 0


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


@contextmanager
def _local(distributed: Any, count: int) -> Iterator[tuple[Any, Callable[[], object]]]:
    ended = threading.Event()

    class Keeper(distributed.Nanny):  # type: ignore[misc]
        """Begins its worker, and begins it again when it dies, until all is ended."""

        async def instantiate(self) -> Any:
            while ended.is_set():
                await asyncio.sleep(1.0)
            return await super().instantiate()

    options = {
        "n_workers": count,
        "threads_per_worker": 1,
        "processes": True,
        "worker_class": Keeper,
        "host": "127.0.0.1",
        "scheduler_kwargs": {"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        "memory_limit": 0,
        "silence_logs": logging.CRITICAL,
        "security": distributed.Security.temporary(),
    }
    strangers = _children()
    cluster = client = None
    try:
        cluster = _begun_out_of_earshot(distributed, options)
        client = distributed.Client(cluster, set_as_default=False)
        # on a busy machine dask gives up a worker that is slow to come back
        yield client, lambda: cluster.scale(count)
    except BaseException:
        # workers that still compute are not waited for
        ended.set()
        _end_children(strangers)
        raise
    finally:
        with contextlib.suppress(Exception):
            if client is not None:
                client.close(timeout=1)
        with contextlib.suppress(Exception):
            if cluster is not None:
                cluster.close(timeout=1)


def _children() -> set[int]:
    """Living processes begun by this one, other than the tracker of semaphores."""
    import psutil

    found: set[int] = set()
    for process in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess):
            if process.status() != psutil.STATUS_ZOMBIE:
                found.add(process.pid)
    return found - {getattr(_resource_tracker, "_pid", None)}


def _end_children(strangers: set[int]) -> None:
    """End workers that still compute, and those on their way: one that is begun by a process that ends complains."""
    began = quiet_since = time.monotonic()
    while time.monotonic() < min(began + _ENDING, quiet_since + _QUIET):
        for number in _children() - strangers:
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
            quiet_since = time.monotonic()
        time.sleep(0.005)


def _begun_out_of_earshot(distributed: Any, options: Mapping[str, Any]) -> Any:
    """A local cluster whose processes never get SIGINT: a terminal's Ctrl-C goes to all, and this process ends them.

    Threads and processes inherit the signals that their parent blocks.
    """
    begun: SimpleQueue[Any] = SimpleQueue()

    def begin() -> None:
        try:
            _begin_tracker()
            if hasattr(signal, "pthread_sigmask"):
                signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            begun.put(distributed.LocalCluster(**options))
        except BaseException as error:
            begun.put(error)

    threading.Thread(target=begin, daemon=True).start()
    try:
        result = next_of(begun)
        if isinstance(result, BaseException):
            raise result
    except BaseException:
        # half begun it cannot be closed, and would complain at exit
        distributed.SpecCluster._instances.clear()
        raise
    return result


def _begin_tracker() -> None:
    """The process that removes semaphores a killed run leaves, without a word: it would warn of every such run.

    Begun together with a worker, it would unblock the signal for that worker.
    """
    flags = list(sys.warnoptions)
    sys.warnoptions.append("ignore")
    try:
        ensure_running()
    finally:
        sys.warnoptions[:] = flags


@contextmanager
def _remote(distributed: Any, address: str) -> Iterator[tuple[Any, Callable[[], object]]]:
    security = distributed.Security() if address.startswith("tls:") else None
    try:
        client = distributed.Client(address, timeout=_PATIENCE, security=security, set_as_default=False)
    except (OSError, TypeError, ValueError) as error:
        reason = " ".join(str(error).split())[:120]
        raise OptionError(f"cluster: no scheduler answers at {printable(address, 60)}: {reason}") from None
    try:
        yield client, lambda: None
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=1)


def _library() -> Any:
    try:
        import cryptography  # noqa: F401 - distributed needs it for the certificates of a local cluster
        import distributed
    except ImportError:
        raise Unsupported(f"cluster: needs dask.distributed; install it with: {remedy('dist')}") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    return distributed
