"""The rules that parts of pixels take one after the other, and what each is off by."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table
from symrender.quadrature.line_errors import tail_error
from symrender.radiometric.pixels.records import COARSE, CUT, DENSE, DENSE_CUT, DENSER, SMOOTH, Part
from symrender.radiometric.vectors import Array
from symrender.runtimes.part_states import Ints
from symrender.runtimes.pixel_blocks import rule_of

TOLD: Final = 4
"""The least order of a smooth part's rule whose error its own coefficients tell."""
_FIRST: Final = {SMOOTH: 0.5, CUT: 8.0, COARSE: 1.0, DENSE: 0.5, DENSER: 0.5, DENSE_CUT: 2.0}
"""What the difference of the first two rules is taken times, by the kind of a part."""
_CORNERED: Final = 2.5
"""How many times the difference from a rule of the corners is what second degrees may be, for it errs twice as much as
the middle does."""
_KINKED: Final = 0.1
"""Part of the last coefficients that rules of what has kinks are off by, at least."""
_BENT: Final = 0.2
"""Part of what slopes of a smooth part let expect of second degrees that its first two rules differ by, at least."""


@dataclass(frozen=True)
class Rules:
    """The ``orders`` of the rules of parts by their kind, the first two of which are taken at once.

    ``told`` says whether coefficients tell the error of smooth parts from the order ``TOLD`` on. Nodes may be
    ``densest`` times as dense as four a cell where lobes turn; 0 says that they ask for direct light. Parts that are
    ``cornered`` and take four nodes ask at their corners, too.
    """

    orders: tuple[tuple[int, ...], ...]
    told: bool
    densest: float
    cornered: bool = False

    def order(self, kinds: Ints, number: Ints) -> Ints:
        """(N,) orders of the rules of these numbers, counted from 0, of parts of some kinds; the last ones go on."""
        most = max(len(each) for each in self.orders)
        table = np.array([each + each[-1:] * (most - len(each)) for each in self.orders])
        found: Ints = table[kinds, np.minimum(number, most - 1)]
        return found

    def most(self, kinds: Ints) -> Ints:
        """(N,) how many rules beyond the first two parts have."""
        found: Ints = np.array([len(each) for each in self.orders])[kinds] - 2
        return found


DIRECT: Final = Rules(((1, 2, 3, 5), (2, 3, 5, 8), (2,)), told=False, densest=0.0)
LOBES: Final = Rules(
    ((1, 2, 3, 4, 6), (2, 3, 5, 8), (2,), (2, 4, 6, 8), (4, 6, 8), (3, 5, 8)), told=True, densest=3.0
)  # fmt: skip
RIMMED: Final = Rules(((1, 2, 3, 5), (2, 3, 5, 8), (2,)), told=False, densest=1.0, cornered=True)
"""Of lobes whose rims are felt: where one begins to touch what it sees, between nodes, corners see most of it."""


def kinds_of(parts: Table[Part]) -> Ints:
    """(N,) kinds of parts."""
    return np.asarray(np.asarray(parts)["kind"], np.int64)


def is_smooth(kinds: Ints) -> npt.NDArray[np.bool_]:
    """Which kinds of parts no curve enters."""
    return np.asarray((kinds == SMOOTH) | (kinds == DENSE) | (kinds == DENSER))


@dataclass(frozen=True)
class Taken:
    """Of N parts that took a rule: their ``kinds``, the ``order`` of the rule and of the one ``before`` (N,).

    ``first`` tells which of them had none before these two. ``gap`` is what the two rules differ by, ``last`` what the
    two before did, and ``hint`` what the nodes of the rule itself tell: ``bends`` or ``tail``.
    """

    kinds: Ints
    first: npt.NDArray[np.bool_]
    order: Ints
    before: Ints
    gap: Array
    last: Array
    hint: Array

    def off(self, told: bool, slow: float, doubt: float) -> Array:
        """(N,) what the rules are off by.

        The difference of two rules, of what no curve enters ``slow`` times, and no less than ``doubt`` of the one
        before; where coefficients tell it no less than they say, and than ``doubt`` to the power of the orders between.
        """
        smooth = is_smooth(self.kinds)
        known = smooth & (self.order >= TOLD) if told else np.zeros_like(smooth)
        slowly = np.where((self.kinds == CUT) | (self.kinds == DENSE_CUT), 1.0, slow)
        times = np.array([_FIRST[k] for k in range(len(_FIRST))])[self.kinds]
        begun = slowly * times * np.maximum(self.gap, np.where(smooth, _BENT * self.hint, 0.0))
        orders = np.where(known, self.order - self.before, 1)
        later = np.maximum(slowly * self.gap, doubt**orders * self.last)
        found: Array = np.where(self.first & ~known, begun, later)
        return np.where(known, np.maximum(found, self.hint), found)


def bends(owner: Ints, places: Array, weights: Array, values: Array, count: int) -> Array:
    """(count,) what four nodes of a square let expect of its terms of second degree, in each of ``count`` rules.

    Two rules that differ by the sum of two curvatures agree on a saddle. The twist is seen by the nodes; a curvature is
    expected to be the square of the slope over the value. 0 for rules of other than four nodes. Nodes of a rule stand
    one after the other, ``owner`` by ``owner``.
    """
    nodes = np.bincount(owner, minlength=count)
    ends, four = np.cumsum(nodes), np.flatnonzero(nodes == 4)
    which = ends[four, None] - np.arange(4, 0, -1)
    at, light, weight = places[which], values[which], weights[which].sum(axis=1)
    x, y = np.moveaxis(np.sign(at - at.mean(axis=1, keepdims=True)), 2, 0)[..., None]
    # what is not known is not bent: it is told as such elsewhere
    light = np.where(np.isfinite(light), light, 0.0)
    slope = np.abs((x * light).sum(axis=1)) + np.abs((y * light).sum(axis=1))
    twist, size = np.abs((x * y * light).sum(axis=1)), np.abs(light).max(axis=1)
    curved = np.divide(slope * slope, 4.0 * size, out=np.zeros_like(slope), where=size > 0.0)
    found = np.zeros(count)
    found[four] = 0.25 * np.maximum(twist, curved).max(axis=1, initial=0.0) * np.abs(weight)
    return found


def at_corners(places: Array) -> Array:
    """(4 N, 2) corners of the cells of which ``places`` (4 N, 2), four a cell, are the nodes of a rule."""
    cells = places.reshape(-1, 4, 2)
    middle = cells.mean(axis=1, keepdims=True)
    return np.asarray((middle + math.sqrt(3.0) * (cells - middle)).reshape(-1, 2))


def cornered(weights: Array, values: Array, corners: Array) -> Array:
    """(N,) what rules of four nodes may miss by what corners see beside what nodes do, (4 N, C) each."""
    apart = (weights[:, None] * (corners - values)).reshape(len(weights) // 4, 4, -1).sum(axis=1)
    return np.asarray(_CORNERED * np.abs(apart).max(axis=1))


def tail(n: int, terms: Array) -> float:
    """What a rule of n x n nodes misses, by how the Legendre coefficients of what it sees fall along both sides.

    No less than a part of the last ones: where a lobe's rim touches what it sees, light has kinks of the power 3/2, and
    coefficients that fell fast at first do not go on to. ``terms`` (n^2, C) are the rule's: weights times values.
    Infinite where one is no number.
    """
    if not np.isfinite(terms).all():
        return math.inf
    rule = rule_of(1, n)
    weight = rule.means[0]
    seen = terms.reshape(n, n, -1) / (weight[:, None, None] * weight[None, :, None])
    size = np.einsum("i,j,ijc->c", weight, weight, np.abs(seen))
    missed = 0.0
    for side in (seen, seen.swapaxes(0, 1)):
        fall = np.einsum("j,kjc->kc", weight, np.abs(np.einsum("ki,ijc->kjc", rule.series, side)))
        middle = np.maximum(fall[(n - 1) // 2], fall[(n - 1) // 2 - 1])
        missed += max(
            max(_KINKED * last, tail_error(n, last, before, half, whole, 0.0))
            for last, before, half, whole in np.column_stack([fall[-1], fall[-2], middle, size]).tolist()
        )
    return missed
