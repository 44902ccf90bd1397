"""How the evaluations of a ray are shared: with looser rules, and with scenes that roundings have moved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Answer = TypeVar("Answer", bound="DataclassInstance")

AGAIN: Final = ((0.3, 1e3), (0.2, 1e6))
"""Parts of a budget, beyond it, each for a tolerance so many times looser."""
LATE: Final = 1.3
"""Times its budget a place takes at most of which looser rules are asked."""
BESIDE: Final = 0.3
"""Part of a budget, beyond it, for what rays meet in shaken scenes where that is not what they meet."""
ROUNDED: Final = 1e-9
"""By how much a logarithm may be rounded."""
HOPELESS: Final = 10.0
"""How many times the tolerance an error is that is not almost met."""


def after(budget: int, spent: Ints) -> Ints:
    """(N,) evaluations for the next part of a ray's light: what is left of its budget, or ``BESIDE`` of it."""
    return _rung(budget, np.maximum(budget - spent, BESIDE * budget))


def beside(budget: int, spent: Ints, elsewhere: Sequence[Ints]) -> Ints:
    """(N,) evaluations for what each ray meets in each of the shaken scenes where that is not what it meets.

    It is what the first value left of the budget and ``BESIDE`` of the budget, shared among the scenes. ``elsewhere``
    lists the rays that each scene concerns.
    """
    scenes = np.zeros(len(spent), np.int64)
    for rays in elsewhere:
        scenes[rays] += 1
    return _rung(budget, (np.maximum(budget - spent, 0) + BESIDE * budget) / np.maximum(scenes, 1))


def _rung(budget: int, wanted: Array) -> Ints:
    """``wanted`` rounded down to ``budget`` times a power of 2^(1/4): rays of one share are asked together."""
    steps = np.floor(4.0 * np.log2(wanted / budget) + ROUNDED)
    rungs: Ints = np.maximum(1.0, budget * 2.0 ** (steps / 4.0)).astype(np.int64)
    return rungs


def by_share(ask: Callable[[Ints, int], Answer], rays: Ints, shares: Ints) -> Answer:
    """``ask(some, share)`` of ``rays``, those of one share of ``shares`` (N,) together, in their order."""
    each = shares[rays]
    rows = [np.flatnonzero(each == share) for share in np.unique(each)]
    if len(rows) < 2:
        return ask(rays, int(each.max(initial=1)))
    parts = [ask(rays[some], int(each[some[0]])) for some in rows]
    order = np.argsort(np.concatenate(rows))
    merged = {
        name.name: np.concatenate([getattr(part, name.name) for part in parts])[order] for name in fields(parts[0])
    }
    return replace(parts[0], **merged)
