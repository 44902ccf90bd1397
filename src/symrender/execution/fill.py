"""Fill the layers of one image: what the journal holds is taken over, the workers render the rest."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

from symrender.execution.first_use import first_use
from symrender.execution.jobs import KINDS, Job, Tile, blocks, prepared
from symrender.execution.journal import PATIENCE, Entry, Journal, Start
from symrender.execution.notebook import in_notebook, notebook_preview, notebook_progress
from symrender.execution.preview import Watch
from symrender.execution.silhouettes import smooth
from symrender.execution.tiles import Progress, Threads, Workers, measured_side, spread, tiles
from symrender.ledger.ledger import Timing
from symrender.scene.arrays import Array


@dataclass(frozen=True)
class Means:
    """How the work is carried out; changes no byte of an image.

    ``threads`` 0 takes the processors at hand; ``tile`` is the side of a tile, 0 measures one that takes a fraction of
    a second. ``cluster`` is ``tcp://host:port``, ``tls://host:port`` or ``local:N`` (extra ``dist``), "" for threads;
    ``insecure_cluster`` lets a scheduler be used that is neither on this machine nor encrypted. ``journal`` is the
    file that keeps finished tiles until ``Crew.succeeded``, None for no journal; ``start`` says what becomes of one
    an interrupted run left; ``patience`` is how many seconds a run lasts before its journal is written.
    """

    threads: int = 0
    tile: int = 0
    cluster: str = ""
    insecure_cluster: bool = False
    journal: Path | None = None
    start: Start = "new"
    patience: float = PATIENCE


class Crew:
    """Workers and a journal, open for the jobs of one run; use it in a ``with`` statement.

    ``workers`` are used if given, and outlive it; else those ``means`` describes are hired for the run. In a notebook
    the cell shows progress and the unfinished picture unless ``progress`` or ``preview`` say otherwise.
    """

    def __init__(
        self,
        means: Means,
        jobs: tuple[Job, ...],
        progress: Progress | None = None,
        workers: Workers | None = None,
        preview: Watch | None = None,
    ) -> None:
        self._means, self._jobs, self._given = means, jobs, workers
        shown = progress is None and in_notebook()
        self.progress = notebook_progress() if shown else progress
        self._preview = notebook_preview() if shown and preview is None else preview
        self._stack = ExitStack()
        self._journal: Journal | None = None

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            if self._means.journal is not None:
                self._journal = stack.enter_context(
                    Journal(self._means.journal, _fields(self._jobs), self._means.start, self._means.patience)
                )
            self._workers = self._given or stack.enter_context(workers_of(self._means))
            self._stack = stack.pop_all()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._stack.__exit__(kind, error, at)

    @property
    def workers(self) -> Workers:
        """Who does the work, while the crew is open."""
        return self._workers

    def fill(self, job: Job) -> tuple[dict[str, Array], Timing]:
        """The layers of the image ``job`` describes, and what they cost, earlier sessions included."""
        layers = job.empty_layers()
        left = self._take_over(job, layers)
        with first_use(job.kind, self.progress):
            self._have_tables(job)
            prepared(job)
        side = left.side or self._means.tile or measured_side(self._workers, job, layers)
        all_tiles = spread(list(tiles(job.settings.width, job.settings.height, side)), side)
        work = [tile for tile in all_tiles if tile not in left.tiles]
        standing = [tile for tile in all_tiles if tile in left.tiles]
        open_tiles = dict.fromkeys(work)
        evaluations, done = left.evaluations, len(standing)
        begun = time.perf_counter()

        def finished(tile: Tile, spent: int, _: float) -> None:
            nonlocal evaluations, done
            evaluations += spent
            done += 1
            standing.append(tile)
            del open_tiles[tile]
            if self._journal is not None:
                age = left.seconds + time.perf_counter() - begun
                self._journal.append(Entry(job.kind, tile, side, spent, age, blocks(layers, tile)))
            if self.progress is not None:
                self.progress(done, len(all_tiles), job.kind)
            if self._preview is not None:
                self._preview(job.kind, layers, standing, list(open_tiles))

        if done and self.progress is not None:
            self.progress(done, len(all_tiles), job.kind)
        self._workers.run(job, layers, work, finished)
        if job.settings.silhouettes > 1:
            evaluations += smooth(job, layers, self._workers, self.progress)
        return layers, Timing(left.seconds + time.perf_counter() - begun, evaluations)

    def succeeded(self) -> None:
        """The output stands: delete the journal."""
        if self._journal is not None:
            self._journal.remove()

    def _have_tables(self, job: Job) -> None:
        """The tables of an image lie beside its journal; what makes them is imported where a kind of image has any."""
        if not KINDS[job.kind].tabled:
            return
        from symrender.execution.tables import have_tables

        means, journal = self._means, self._means.journal
        path = None if journal is None else journal.with_suffix(".table")
        fresh = means.start == "restart"
        have_tables(job, path, self._journal, fresh=fresh, patience=means.patience, progress=self.progress)

    def _take_over(self, job: Job, layers: dict[str, Array]) -> _Left:
        """Copy into ``layers`` what the journal holds of them."""
        left = _Left()
        for entry in self._journal.entries() if self._journal is not None else ():
            here = blocks(layers, entry.tile)
            fits = {name: block.shape for name, block in entry.blocks.items()} == {n: b.shape for n, b in here.items()}
            if entry.image != job.kind or not fits or entry.tile in left.tiles:
                continue
            for name, block in here.items():
                block[...] = entry.blocks[name]
            left.tiles.add(entry.tile)
            left.side = entry.side
            left.evaluations += entry.evaluations
            left.seconds = max(left.seconds, entry.seconds)
        return left


@dataclass
class _Left:
    """What an earlier process left of an image."""

    tiles: set[Tile] = field(default_factory=set)
    side: int = 0
    evaluations: int = 0
    seconds: float = 0.0


def _fields(jobs: tuple[Job, ...]) -> dict[str, str]:
    """What decides the bytes of all the images of a run."""
    return {"images": " ".join(sorted(job.kind for job in jobs))} | jobs[0].fields()


def workers_of(means: Means) -> AbstractContextManager[Workers]:
    """The workers ``means`` describes, for as long as the context lasts."""
    if not means.cluster:
        return nullcontext(Threads(means.threads))
    from symrender.execution.cluster import connect

    return connect(means.cluster, insecure=means.insecure_cluster)
