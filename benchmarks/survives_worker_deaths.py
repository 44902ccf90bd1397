"""Workers of a cluster killed at random moments change no byte: their tiles are rendered by others.

A local cluster of two processes renders one image again and again; in every round a worker is killed (SIGKILL) at a
random time, until sixty have died.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import random
import signal
import threading
import time
from collections.abc import Mapping

from measure import Report, arguments

from symrender.execution.cluster import Cluster, connect
from symrender.execution.jobs import Job, Tile
from symrender.execution.tiles import Threads, Workers, tiles
from symrender.scene.arrays import Array
from symrender.scene.load import load
from symrender.settings import Settings


def rendered(workers: Workers, job: Job) -> str:
    """Digest of the image."""
    layers, counted = job.empty_layers(), 0

    def finished(tile: Tile, evaluations: int, seconds: float) -> None:
        nonlocal counted
        counted += 1

    work = list(tiles(job.settings.width, job.settings.height, 16))
    workers.run(job, layers, work, finished)
    assert counted == len(work)
    return digest(layers)


def digest(layers: Mapping[str, Array]) -> str:
    return hashlib.sha256(b"".join(layers[name].tobytes() for name in sorted(layers))).hexdigest()


class Killer(threading.Thread):
    """Kills a random worker after a random time, while an image is rendered."""

    def __init__(self, cluster: Cluster, delay: float, choice: random.Random) -> None:
        super().__init__(daemon=True)
        self.victim = 0
        self._cluster, self._delay, self._choice = cluster, delay, choice

    def run(self) -> None:
        """Wait, then kill."""
        time.sleep(self._delay)
        with contextlib.suppress(Exception):
            victims = list(self._cluster._client.run(os.getpid).values())
            self.victim = self._choice.choice(victims)
            os.kill(self.victim, signal.SIGKILL)


def main() -> None:
    options = arguments(__doc__)
    kills, choice = (6 if options.quick else 60), random.Random(20250608)
    report = Report("survives_worker_deaths", f"{kills} workers of local:2 killed; gloss, 96 x 96, 48 x 48 directions.")
    job = Job.of("numeric", load("gloss"), Settings(width=96, height=96, lobe=48))
    expected = rendered(Threads(2), job)
    dead: set[int] = set()
    wrong = rounds = 0
    with connect("local:2") as cluster:
        rendered(cluster, job)
        begun = time.perf_counter()
        rendered(cluster, job)
        seconds = time.perf_counter() - begun
        while len(dead) < kills and rounds < 3 * kills:
            killer = Killer(cluster, choice.uniform(0.0, seconds), choice)
            killer.start()
            wrong += rendered(cluster, job) != expected
            killer.join()
            rounds += 1
            dead |= {killer.victim} - {0}
    report.say(f"{rounds} images of {seconds:.1f} s each on two workers; {len(dead)} workers died.")
    report.claim_number("missing deaths", kills - len(dead), 0)
    report.claim_number("images with another hash", wrong, 0)
    report.leave()


if __name__ == "__main__":
    main()
