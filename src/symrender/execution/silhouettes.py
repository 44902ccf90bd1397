"""Smooth silhouettes: a pixel beside another shape is the mean over K x K points of it, the same for every pipeline.

One ray through its centre gives such a pixel to one shape or the other, a staircase. Which pixels these are is read
from the hit classes at the centres, and their points are the pixel centres of an image K times as large, so each
kernel needs nothing new, and two images of one scene are still compared like with like.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.execution.jobs import Job, Tile
from symrender.execution.tiles import Progress, Workers, spread
from symrender.scene.arrays import Array

_LONGEST: Final = 16
_LARGEST_OF: Final = ("status", "chambers", "crossings")
_KEPT: Final = ("hit_class",)


def edges(hit_class: Array) -> npt.NDArray[np.bool_]:
    """Pixels (h, w) one of whose four neighbours meets another shape."""
    found = np.zeros(hit_class.shape, dtype=np.bool_)
    across, down = hit_class[:, 1:] != hit_class[:, :-1], hit_class[1:] != hit_class[:-1]
    found[:, 1:] |= across
    found[:, :-1] |= across
    found[1:] |= down
    found[:-1] |= down
    return found


def smooth(job: Job, layers: dict[str, Array], workers: Workers, progress: Progress | None = None) -> int:
    """Replace the pixels at edges of the finished ``layers`` of ``job``; returns the evaluations that took.

    Radiance, its parts and its error become means, of which the error still bounds the worst channel; status,
    chambers and crossings the largest, evaluations the sum; the hit class stays that of the centre.
    """
    k = job.settings.silhouettes
    chosen = edges(layers["hit_class"])
    larger = replace(job.settings, width=k * job.settings.width, height=k * job.settings.height, silhouettes=1)
    fine = replace(job, settings=larger)
    points = fine.empty_layers()
    work = [(k * x0, k * y, k * x1, k * (y + 1)) for y, x0, x1 in _runs(chosen)]
    spent = done = 0

    def finished(_: Tile, evaluations: int, __: float) -> None:
        nonlocal spent, done
        spent += evaluations
        done += 1
        if progress is not None:
            progress(done, len(work), f"{job.kind}, silhouettes")

    workers.run(fine, points, spread(work, k), finished)
    _gather(layers, points, chosen, k)
    return spent


def _runs(chosen: npt.NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """(row, first column, end) of every run of chosen pixels, none longer than ``_LONGEST``."""
    for y, row in enumerate(chosen):
        steps = np.flatnonzero(np.diff(np.concatenate(([False], row, [False])).astype(np.int8)))
        for x0, x1 in steps.reshape(-1, 2).tolist():
            for begin in range(x0, x1, _LONGEST):
                yield y, begin, min(begin + _LONGEST, x1)


def _gather(layers: Mapping[str, Array], points: Mapping[str, Array], chosen: npt.NDArray[np.bool_], k: int) -> None:
    rows, columns = np.nonzero(chosen)
    for name, layer in layers.items():
        if name in _KEPT:
            continue
        parts = [points[name][k * rows + i, k * columns + j] for i in range(k) for j in range(k)]
        stack = np.stack(parts)
        if name in _LARGEST_OF:
            layer[rows, columns] = stack.max(axis=0)
        else:
            layer[rows, columns] = stack.sum(axis=0) / (1 if name == "evaluations" else k * k)
