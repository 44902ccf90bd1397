"""The mean of what rays see over a square, by samples in strata that are halved where samples differ.

Which strata are halved is decided by samples of their own; the mean is that of fresh ones, so that nothing is chosen by
what is counted, and their scatter says how far it may be off. A feature that no sample of its stratum met is missing
from both: what seems apart is to be looked at with more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

QUARTERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
_DEEPEST = 20
"""Halvings of a stratum, at most."""
_PASSES = 4
"""Times that all strata are looked at."""


def refined_mean(
    look: Callable[[Any], Any], rng: np.random.Generator, side: int = 32, most: int = 60_000, within: float = 0.0
) -> tuple[Any, Any]:
    """(mean over the unit square, its standard error); ``look`` takes places (N, 2) and returns values (N, C).

    It begins with ``side`` x ``side`` strata and goes on until about ``most`` samples were taken or the standard error
    is ``within`` or less.
    """
    corner = np.stack(np.meshgrid(*[np.arange(side) / side] * 2), axis=-1).reshape(-1, 2)
    size, spread, taken = np.full(len(corner), 1.0 / side), np.zeros(len(corner)), 0
    for turn in range(_PASSES):
        # strata whose samples all fell on one side of an edge are looked at again
        spread = np.maximum(spread, _scatter(_samples(look, rng, corner, size)) * size**2)
        taken += 4 * len(corner)
        while taken + 4 * len(corner) < most * (turn + 1) / _PASSES and np.sqrt((spread**2).sum()) > 0.7 * within:
            some = _worst(spread, max(1, (most - taken) // 64))
            some = some[size[some] * side > 0.5**_DEEPEST]
            if not len(some):
                break
            half = np.repeat(0.5 * size[some], 4)
            quarters = np.repeat(corner[some], 4, axis=0) + np.tile(QUARTERS, (len(some), 1)) * half[:, None]
            new = _scatter(_samples(look, rng, quarters, half)) * half**2
            taken += 4 * len(quarters)
            kept = np.ones(len(size), bool)
            kept[some] = False
            corner, size = np.concatenate([corner[kept], quarters]), np.concatenate([size[kept], half])
            spread = np.concatenate([spread[kept], new])
    fresh = _samples(look, rng, corner, size)
    area = (size**2)[:, None]
    return (area * fresh.mean(axis=1)).sum(axis=0), np.sqrt((area**2 * fresh.var(axis=1, ddof=1) / 4).sum(axis=0))


def _worst(spread: Any, most: int) -> Any:
    """Those that make the larger part of the variance, the largest first."""
    order = np.argsort(-spread)
    share = np.cumsum(spread[order] ** 2)
    some = order[: min(int(np.searchsorted(share, 0.9 * share[-1])) + 1, most)]
    return some[spread[some] > 0.0]


def _samples(look: Callable[[Any], Any], rng: np.random.Generator, corner: Any, size: Any) -> Any:
    """(N, 4, C) what one sample in every quarter of N squares sees."""
    places = corner[:, None] + (QUARTERS + rng.random((len(corner), 4, 2))) * 0.5 * size[:, None, None]
    found = look(places.reshape(-1, 2))
    return found.reshape(len(corner), 4, -1)


def _scatter(values: Any) -> Any:
    """(N,) standard deviation of the samples of squares, of the channel that scatters most."""
    return values.std(axis=1, ddof=1).max(axis=1) / 2
