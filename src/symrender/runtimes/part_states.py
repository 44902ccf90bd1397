"""What is known of the parts of pixels while they are looked at more and more closely."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table, chosen, joined
from symrender.radiometric.pixels.records import Part
from symrender.radiometric.vectors import Array

Ints = npt.NDArray[np.int64]


@dataclass
class State:
    """Parts of the pixels of a tile, and what is known of each."""

    parts: Table[Part]
    pixel: Ints
    values: Array
    gap: Array
    """What the last two rules differed by."""
    error: Array
    inner: Array
    stage: Ints
    """How many rules it took beyond the first two; -1 before these."""
    fastest: Array
    """Of what moves: how fast the walls of a part cross it."""
    rough: Array
    """Of what moves: what nodes of a part that is not resolved see change."""

    @staticmethod
    def of(parts: Table[Part], pixel: Ints, channels: int) -> State:
        """Parts of which nothing is known yet."""
        n = len(parts)
        return State(
            parts, pixel, np.zeros((n, channels)), np.full(n, np.inf), np.full(n, np.inf), np.zeros(n),
            np.full(n, -1, np.int64), np.zeros(n), np.zeros(n),
        )  # fmt: skip

    def kept(self, keep: npt.NDArray[np.bool_], more: State) -> State:
        """Those of ``keep``, and more."""
        old = chosen(self.parts, keep)
        pairs = [
            np.concatenate([getattr(self, name)[keep], getattr(more, name)])
            for name in ("pixel", "values", "gap", "error", "inner", "stage", "fastest", "rough")
        ]
        return State(joined(Part, [old, more.parts]), *pairs)


@dataclass
class Best:
    """The means (N, C) of pixels that stated least: halves of a part may be known less well than it was."""

    values: Array
    error: Array

    def keep(self, state: State, whole: Array, channels: int, tol: float) -> None:
        """Take over what states less, ``whole``, unless it was within ``tol`` before."""
        better = (whole < self.error) & (self.error > tol)
        if better.any():
            held = state.values.reshape(len(state.pixel), -1, channels).sum(axis=1)
            found = np.column_stack([added(state.pixel, held[:, c], len(whole)) for c in range(channels)])
            self.values[better], self.error[better] = found[better], whole[better]


@dataclass
class Pixels:
    """What is known of the pixels of a tile."""

    low: Array
    high: Array
    status: Ints
    account: Ints | None
    """Evaluations of all nodes of a pixel together, at most, or None without end."""
    evaluations: Ints = field(init=False)
    nodes: Ints = field(init=False)

    def __post_init__(self) -> None:
        self.evaluations, self.nodes = np.zeros((2, len(self.low)), np.int64)

    def share(self, pixel: Ints, most: int) -> Ints:
        """(N,) evaluations for each of N nodes of these pixels, asked together: what is left, shared alike.

        Powers of two below ``most``, so that nodes of many pixels are asked together, and 1 at least.
        """
        if self.account is None:
            return np.full(len(pixel), most)
        left = np.maximum(self.account - self.evaluations, 0)
        each = left[pixel] // np.bincount(pixel, minlength=len(left))[pixel]
        found: Ints = np.where(each < most, 2 ** np.floor(np.log2(np.maximum(each, 1))).astype(np.int64), most)
        return found


def added(owner: Ints, what: Array, count: int) -> Array:
    """(count,) sums of what belongs to each owner."""
    return np.asarray(np.bincount(owner, what, count), np.float64)


def sums_within(pixel: Ints, order: Ints, what: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(N,) sums, in an ``order`` of pixel after pixel, of what belongs to the same pixel: up to each, and with it."""
    sums = np.cumsum(what[order])
    first = np.flatnonzero(np.diff(pixel[order], prepend=-1))
    before = np.concatenate([sums[:1] * 0, sums])[first]
    found: npt.NDArray[Any] = sums - np.repeat(before, np.diff(first, append=len(order)))
    return found


def spared(pixel: Ints, error: Array, most: float) -> npt.NDArray[np.bool_]:
    """(N,) the parts of the smallest errors of each pixel, as many as make no more than ``most`` together."""
    order = np.lexsort((error, pixel))
    found = np.zeros(len(pixel), np.bool_)
    # no larger than tells that it is too large: sums of all pixels are one sum
    found[order] = sums_within(pixel, order, np.minimum(error, 2.0 * most)) <= most
    return found


def afforded(pixel: Ints, error: Array, cost: Ints, left: Ints) -> npt.NDArray[np.bool_]:
    """(N,) the parts of the largest errors of each pixel before which its others cost no more than is ``left`` of it.

    The first one of a pixel is among them however dear it is. Costs are whole numbers, so that no tile changes a sum.
    """
    order = np.lexsort((-error, pixel))
    found = np.zeros(len(pixel), np.bool_)
    found[order] = sums_within(pixel, order, cost) - cost[order] <= left[pixel[order]]
    return found
