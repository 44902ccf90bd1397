"""How large a truth fits into the seconds one is ready to wait."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from symrender.execution.jobs import Job, Tile
from symrender.execution.silhouettes import edges
from symrender.execution.tiles import Workers, area
from symrender.scene.arrays import Array
from symrender.settings import Settings

SMALLEST: Final = 32
"""Side of an image below which none is made smaller, pixels."""
_SHARES: Final = tuple(share / 2**k for k in range(6) for share in (1, 3 / 4))
_PLACES: Final = 24
_SIDE: Final = 3
_ROUNDS: Final = 2
_GOLDEN: Final = (0.7548776662466927, 0.5698402909980532)
_ROOM: Final = 1.2
"""What a machine that others use too adds to the best time seen."""


def seconds_each(job: Job, workers: Workers) -> float:
    """Seconds a pixel of ``job`` should take these workers together, from small tiles spread evenly over it."""
    probes = list(dict.fromkeys(_places(job.settings.width, job.settings.height)))
    layers, best = job.empty_layers(), math.inf
    # the first tiles of a thread also make its scratch
    for _ in range(_ROUNDS):
        begun = time.perf_counter()
        workers.run(job, layers, probes, lambda *_: None)
        best = min(best, time.perf_counter() - begun)
    return best / sum(area(tile) for tile in probes)


def fitting(job: Job, workers: Workers, hit_class: Array, seconds: float) -> tuple[Settings, float]:
    """The settings of ``job``, so much smaller that it should take at most ``seconds``, and what it should take.

    Sizes are the one asked, 3/4 of it, 1/2, 3/8, 1/4 and so on.

    ``hit_class`` is that of an image of its size: it says how many pixels are at silhouettes and take several points.
    """
    asked, each = job.settings, _ROOM * seconds_each(job, workers)
    points = asked.silhouettes**2 if asked.silhouettes > 1 else 0
    along = int(edges(hit_class).sum()) * points
    shares = [s for s in _SHARES if s == 1 or s * min(asked.width, asked.height) >= SMALLEST]
    for share in shares:
        settings = replace(asked, width=int(share * asked.width), height=int(share * asked.height))
        expected = each * (settings.width * settings.height + share * along)
        if expected <= seconds:
            break
    return settings, expected


def _places(width: int, height: int) -> Iterator[Tile]:
    # multiples of the plastic number's powers fill a square evenly, however many there are
    for k in range(1, _PLACES + 1):
        x, y = (int(k * g % 1 * side) for g, side in zip(_GOLDEN, (width, height), strict=True))
        yield x, y, min(x + _SIDE, width), min(y + _SIDE, height)
