"""Means over pixels of what only whole batches of rays can be asked for: lobes' integrals, each with its own error.

A pixel is cut at its curves (``radiometric/pixels/parts.py``). Every part takes two rules, the difference of which is
its error; while the errors of a pixel's parts add up to more than is asked, those of the largest are looked at more
closely, all pixels of a tile at once. What the rays themselves state is added. The file is long because cutting, asking
and refining share one state and one budget.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.records import Table, chosen, table
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.radiometric.pixels import parts as kernels
from symrender.radiometric.pixels.cells import BOX, Eye
from symrender.radiometric.pixels.records import LEVELS, SMOOTH, Nodes, Part, Room, make_room
from symrender.radiometric.vectors import Array
from symrender.runtimes.budgets import by_share
from symrender.runtimes.part_rules import (
    DIRECT,
    LOBES,
    TOLD,
    Rules,
    Taken,
    at_corners,
    bends,
    cornered,
    is_smooth,
    kinds_of,
    tail,
)
from symrender.runtimes.part_states import Best, Ints, Pixels, State, added, afforded, spared
from symrender.runtimes.pixel_blocks import SQUARES, Known, Picture, block_means

INNER: Final = 0.5
"""Part of the tolerance that single rays take."""
_GRAIN: Final = 0.05
"""Part of the tolerance that the brightest light in a cell may make for it not to be halved at once."""
_WORST: Final = 0.25
"""Part of the largest error of a pixel's parts that those looked at more closely have."""
_ROUNDS: Final = 200
_SHARE: Final = 8
"""Nodes that the budget of a pixel is to last for, at least."""
_FIELD_NODES: Final = 40
"""Nodes that a field takes where all of them are cut at, about."""
_QUARTERS: Final = 20
"""Nodes that the quarters of a part take at first, about."""
_ENDLESS: Final = 1e12
"""Fields that are as many as without end: no budget is enough for them."""
_TEXTURE_LEVELS: Final = 3
"""Halvings that fields which are too many to be cut at are worth: means of textures miss less in smaller cells."""
_LEAST: Final = 2000
"""Evaluations of a node, at least, where the budget is not strict."""
_NO_END: Final = 1 << 62
_CHEAPEST: Final = 32
"""Evaluations of a node, at least, for the nodes of a pixel to be asked where its budget is strict."""
_TRIES: Final = 4
"""Times that what nodes left of a strict budget is shared by those for which their shares did not last."""
_UNKNOWN: Final = 1e300
"""What a node may be off by that was not asked."""
_FLOOR: Final = 1e-3
"""Part of the tolerance below which the error of a part is not what keeps a pixel from it."""


@dataclass(frozen=True)
class Light:
    """What N nodes see: ``values`` (N, C), what each may be off by, ``status`` and ``evaluations`` (N,)."""

    values: Array
    error: Array
    status: Ints
    evaluations: Ints


@dataclass(frozen=True)
class Places:
    """Where the nodes lie: ``columns`` and ``rows`` (N,) of the image, in pixels; ``blurred`` where textures of planes
    are to be their means."""

    columns: Array
    rows: Array
    blurred: npt.NDArray[np.bool_]

    def chosen(self, some: Ints) -> Places:
        """Those of ``some``."""
        return Places(self.columns[some], self.rows[some], self.blurred[some])


Look = Callable[[Places, float, int], Light]
"""What nodes see, each to a tolerance or a number of evaluations."""


@dataclass(frozen=True)
class Canvas:
    """An image as an eye sees it: its window and size, the ``reach`` of its filter, the largest radiance of ``bright``.

    ``lobes`` says that nodes ask for lobes, not for direct light.
    """

    eye: Eye
    window: Array
    width: int
    height: int
    reach: float
    bright: float
    lobes: bool


@dataclass(frozen=True)
class Mean:
    """Of N pixels: ``values`` (N, C), ``error``, ``status`` and ``evaluations`` (N,)."""

    values: Array
    error: Array
    status: Ints
    evaluations: Ints


class PixelRule:
    """Means over the pixels of a canvas; of threads each has its scratch.

    ``rules`` are by default those of the canvas's light. ``hope`` is how many times what it may take a
    part may be off by for a rule of a higher order to be tried, ``inner`` what single rays take of the tolerance.
    ``slow`` is how many times their difference rules of what no curve enters may be off by, ``doubt`` the part of the
    difference of the two rules before that the difference of two rules is trusted to fall by, at most. Where nodes are
    cheap it is ``eager``: all parts are looked at more closely but those that together make no more than half of the
    tolerance. A mean may be the sum of several ``terms``, of which each has a say in what rules differ by: what one has
    too much another may have too little.
    """

    hope: float = 300.0
    inner: float = INNER
    slow: float = 1.0
    doubt: float = 0.12
    eager: bool = False

    def __init__(self, canvas: Canvas, channels: int, terms: int = 1, rules: Rules | None = None) -> None:
        self.canvas, self._channels, self._terms = canvas, channels, terms
        self._rules = rules or (LOBES if canvas.lobes else DIRECT)
        self._own = threading.local()

    def means(
        self, x0: int, y0: int, x1: int, y1: int, look: Look, tol: float, budget: int, strict: bool = False
    ) -> Mean:  # fmt: skip
        """Means of columns x0:x1 of rows y0:y1, row by row, each to ``tol`` or ``budget`` evaluations.

        A pixel is no longer refined once it has taken its budget, of which each of its nodes may take ``1/_SHARE``.
        All nodes of a pixel together keep to a ``strict`` budget, of which squares of pixels take half at most.
        A pixel is a function of its own parts alone, so that no tile changes a byte.
        """
        each = max(1 if strict else _LEAST, budget // _SHARE)
        found = self._smooth((x0, y0, x1, y1), look, tol, each, budget // 2 if strict else _NO_END)
        left = np.flatnonzero(~found.known)
        columns, rows = np.tile(np.arange(x0, x1), y1 - y0)[left], np.repeat(np.arange(y0, y1), x1 - x0)[left]
        if len(left):
            account = budget - found.evaluations[left] if strict else None
            rest = self._cut_means(columns, rows, look, tol, budget, each, account)
            found.values[left], found.error[left], found.status[left] = rest.values, rest.error, rest.status
            found.evaluations[left] += rest.evaluations
        return Mean(found.values, found.error, found.status, found.evaluations)

    def _smooth(self, tile: tuple[int, int, int, int], look: Look, tol: float, most: int, budget: int) -> Known:
        """What squares of pixels tell (``pixel_blocks.py``).

        A node takes ``most`` evaluations at most, all nodes of all squares that a pixel is tried in its ``budget``.
        """
        canvas, channels = self.canvas, self._channels
        if canvas.eye.domain != BOX or not canvas.lobes:
            return Known.nothing((tile[2] - tile[0]) * (tile[3] - tile[1]), channels)

        def seen(columns: Array, rows: Array, inner: float, density: float) -> tuple[Array, Array, Ints, Ints]:
            places = Places(columns, rows, np.zeros(len(columns), np.bool_))
            found = look(places, inner, max(1, min(most, int(budget / (len(SQUARES) * density)))))
            return found.values[:, :channels], found.error, found.status, found.evaluations

        room, candidates, _ = self.scratch()
        picture = Picture(canvas.eye, canvas.window, canvas.width, canvas.height, room, candidates)
        return block_means(picture, tile, seen, tol, channels, self.slow)

    def _cut_means(
        self, columns: Ints, rows: Ints, look: Look, tol: float, budget: int, each: int, account: Ints | None
    ) -> Mean:  # fmt: skip
        """The same of pixels, cut at their curves.

        All nodes of a pixel together take its ``account`` (N,) of evaluations at most, where there is one.
        """
        canvas, channels = self.canvas, self._channels
        starts = table(Part, len(columns))
        np.asarray(starts)["column"], np.asarray(starts)["row"] = columns, rows
        count = len(starts)
        pixels = Pixels(np.full(count, np.inf), np.full(count, -np.inf), np.zeros(count, np.int64), account)
        grain = _GRAIN * tol / canvas.bright
        if account is not None:
            # more cells than can be paid for are of no use
            grain = max(grain, _CHEAPEST / budget)
        parts, origins = self._cut(starts, grain)
        state = State.of(parts, origins, channels * self._terms)
        inner, whole = self.inner * tol, np.zeros(count)
        most = np.int64(budget) if account is None else account
        best = Best(np.zeros((count, channels)), np.full(count, np.inf))
        for _ in range(_ROUNDS):
            self._integrate(state, np.flatnonzero(state.stage < 0), pixels, look, inner, each)
            outer = state.error + self._unseen(state, pixels)
            whole = added(state.pixel, outer + state.inner, count)
            best.keep(state, whole, channels, tol)
            raised, halved = self._next(state, outer, whole, pixels, tol, most)
            if not (len(raised) or len(halved)):
                break
            self._integrate(state, raised, pixels, look, inner, each)
            if len(halved):
                state = self._halve(state, halved, grain)
        if account is not None:
            # where no rule could be paid for, a mean is between nothing and the brightest light
            lost = best.error > 0.5 * _UNKNOWN
            best.error[lost] = (canvas.bright + np.maximum(pixels.high, 0.0))[lost]
            pixels.status[lost] = CAPPED
        return Mean(best.values, best.error, pixels.status, pixels.evaluations)

    def _unseen(self, state: State, pixels: Pixels) -> Array:
        """What parts may be off by, for what no node sees."""
        swing = np.maximum(self.canvas.bright, pixels.high - pixels.low)[state.pixel]
        found: Array = swing * state.parts["missed"]
        return found + np.maximum(pixels.high, 0.0)[state.pixel] * state.parts["beside"]

    def _next(
        self, state: State, outer: Array, whole: Array, pixels: Pixels, tol: float, budget: Ints | np.int64
    ) -> tuple[Ints, Ints]:  # fmt: skip
        """The parts that are to take a rule of a higher order, and those that are to be halved."""
        worst = np.zeros(len(whole))
        np.maximum.at(worst, state.pixel, np.where(np.isfinite(outer), outer, 0.0))
        # what rays state is no less in halves
        stuck = added(state.pixel, state.inner, len(whole)) > tol
        going = (whole > tol) & ~stuck & (pixels.evaluations <= budget)
        asked = going[state.pixel] & (outer >= _WORST * worst[state.pixel]) & (outer > _FLOOR * tol)
        if self.eager:
            asked = going[state.pixel] & ~spared(state.pixel, outer, 0.5 * tol)
        allowed = tol * _allowed(state.parts)
        better = (
            (state.stage < self._rules.most(kinds_of(state.parts)))
            & (state.error >= 0.5 * outer)
            & (state.error <= self.hope * allowed)
        )
        deeper = asked & ~better & (state.parts["level"] < LEVELS)
        # where fields are too many to be cut at, their mean stays
        fields = np.minimum(state.parts["fields"], _ENDLESS)
        each = np.maximum(pixels.evaluations, 1) / np.maximum(pixels.nodes, 1)
        dear = each * _FIELD_NODES * added(state.pixel, fields, len(whole))
        some = (fields == 0.0) | (state.parts["level"] < _TEXTURE_LEVELS)
        deeper &= some | (dear <= budget - pixels.evaluations)[state.pixel]
        raised = asked & better
        order = self._rules.order(kinds_of(state.parts), state.stage + 2)
        nodes = np.where(raised, order**2, np.where(deeper, _QUARTERS, 0))
        # what is not asked comes last and costs nothing
        cost = np.ceil(nodes * (pixels.evaluations / np.maximum(pixels.nodes, 1))[state.pixel]).astype(np.int64)
        left = np.maximum(budget - pixels.evaluations, 0)
        kept = afforded(state.pixel, np.where(raised | deeper, outer, -1.0), cost, left)
        return np.flatnonzero(raised & kept), np.flatnonzero(deeper & kept)

    def _halve(self, state: State, halved: Ints, grain: float) -> State:
        """The parts of the quarters of some, in their stead."""
        starts = table(Part, 4 * len(halved))
        for quarter in range(4):
            rows = np.asarray(starts)[quarter::4]
            rows[:] = np.asarray(state.parts)[halved]
            rows["path"] = 4 * rows["path"] + quarter
            rows["level"] += 1
        parts, origins = self._cut(starts, grain)
        keep = np.ones(len(state.pixel), np.bool_)
        keep[halved] = False
        return state.kept(keep, State.of(parts, state.pixel[halved][origins // 4], state.values.shape[1]))

    def _integrate(
        self, state: State, some: Ints, pixels: Pixels, look: Look, inner: float, budget: int
    ) -> None:  # fmt: skip
        """Let parts take their next rule, of new ones the first two."""
        if not len(some):
            return
        kinds, number = kinds_of(state.parts)[some], state.stage[some] + 2
        first = number == 1
        if self._rules.told:
            # what one order more is not trusted to bring down takes two
            allowed = inner / self.inner * _allowed(state.parts)[some]
            number += (number == 2) & (kinds == SMOOTH) & (self.doubt * state.gap[some] > allowed)
        fresh, order = np.flatnonzero(first), self._rules.order(kinds, number)
        before = self._rules.order(kinds, state.stage[some] + 1)
        orders, two = np.concatenate([order, before[fresh]]), np.concatenate([some, some[fresh]])
        # both rules of a part one after the other, so that what it is cut at is made once
        beside = np.argsort(two, kind="stable")
        values = np.zeros((len(two), state.values.shape[1]))
        error, hint = np.zeros(len(two)), np.zeros(len(two))
        values[beside], error[beside], hint[beside] = self._sums(
            state, two[beside], orders[beside], pixels, look, inner, budget
        )
        new, old = values[: len(some)], state.values[some]
        old[fresh] = values[len(some) :]
        gap = np.abs(new - old).reshape(len(some), self._terms, self._channels).max(axis=2).sum(axis=1)
        last = np.where(first, 0.0, state.gap[some])
        taken = Taken(kinds, first, order, before, gap, last, hint[: len(some)])
        state.error[some] = taken.off(self._rules.told, self.slow, self.doubt)
        state.values[some], state.gap[some], state.inner[some] = new, gap, error[: len(some)]
        state.stage[some] = number - 1

    def _sums(
        self, state: State, some: Ints, orders: Ints, pixels: Pixels, look: Look, inner: float, budget: int
    ) -> tuple[Array, Array, Array]:
        """(values (N, C), what rays state, ``bends`` or ``tails``) of a rule of its order for each of some parts."""
        places, weights, ends = self._nodes(state.parts, some, orders)
        owner = np.repeat(np.arange(len(some)), np.diff(ends, prepend=0))
        parts = np.asarray(state.parts)[some][owner]
        pixel = state.pixel[some][owner]
        found = self._asked(look, self._places(parts, places), inner, budget, pixels, pixel)
        sums = [added(owner, weights * found.values[:, c], len(some)) for c in range(self._channels)]
        stated = added(owner, np.abs(weights) * found.error, len(some))
        hint = bends(owner, places, weights, found.values, len(some))
        four = np.flatnonzero(is_smooth(kinds_of(state.parts)[some]) & (orders == 2))
        if self._rules.cornered and len(four):
            nodes = (ends[four, None] - np.arange(4, 0, -1)).ravel()
            beside = self._places(parts[nodes], at_corners(places[nodes]))
            corners = self._asked(look, beside, inner, budget, pixels, pixel[nodes])
            hint[four] = np.maximum(hint[four], cornered(weights[nodes], found.values[nodes], corners.values))
        if self._rules.told:
            for part in np.flatnonzero(is_smooth(kinds_of(state.parts)[some]) & (orders >= TOLD)).tolist():
                mine = slice(ends[part] - orders[part] ** 2, ends[part])
                hint[part] = tail(int(orders[part]), weights[mine, None] * found.values[mine])
        return np.column_stack(sums), stated, hint

    def _asked(
        self, look: Look, places: Places, tol: float, most: int, pixels: Pixels, pixel: Ints
    ) -> Light:  # fmt: skip
        """What nodes of these pixels see, each by ``most`` evaluations or its share of what is left to its pixel.

        What some leave of their shares the others of their pixel get. Nodes of a pixel that cannot pay for all of them
        are not asked: what they state is without end.
        """
        if pixels.account is None:
            return self._seen_by(pixels, pixel, look(places, tol, most))
        count, channels = len(pixel), self._channels
        found = Light(
            np.zeros((count, channels)), np.full(count, _UNKNOWN), np.full(count, CAPPED), np.zeros(count, np.int64)
        )
        some, had = np.flatnonzero(pixels.share(pixel, most) >= _CHEAPEST), np.zeros(count, np.int64)
        for _ in range(_TRIES):
            shares = pixels.share(pixel[some], most)
            more = shares >= 2 * had[some]
            some, shares = some[more], shares[more]
            if not len(some):
                break
            had[some] = shares
            seen = by_share(lambda rows, each: look(places.chosen(rows), tol, each), some, had)
            self._seen_by(pixels, pixel[some], seen)
            better = seen.error < found.error[some]
            found.values[some[better]], found.error[some[better]] = seen.values[better], seen.error[better]
            found.status[some[better]] = seen.status[better]
            some = some[(seen.status != MET) & (2 * seen.evaluations >= shares)]
        return found

    @staticmethod
    def _seen_by(pixels: Pixels, pixel: Ints, found: Light) -> Light:
        """``found``, which nodes of these pixels see, noted there."""
        # channel by channel: along rows of three it takes several times as long
        np.minimum.at(pixels.low, pixel, reduce(np.minimum, found.values.T))
        np.maximum.at(pixels.high, pixel, reduce(np.maximum, found.values.T))
        np.maximum.at(pixels.status, pixel, found.status)
        np.add.at(pixels.evaluations, pixel, found.evaluations)
        np.add.at(pixels.nodes, pixel, 1)
        return found

    def _places(self, parts: Any, places: Array) -> Places:
        """Where in the image places of parts lie."""
        reach = self.canvas.reach
        columns, rows = parts["column"] + 0.5 + reach * places[:, 0], parts["row"] + 0.5 - reach * places[:, 1]
        return Places(columns, rows, parts["fields"] != 0.0)

    def scratch(self) -> tuple[Room, Ints, Table[Part]]:
        """What kernels write to, of this thread."""
        if not hasattr(self._own, "scratch"):
            eye = self.canvas.eye
            self._own.scratch = make_room(eye.world), np.zeros(max(1, len(eye.walls)), np.int64), table(Part, 1)
        kept: tuple[Room, Ints, Table[Part]] = self._own.scratch
        return kept

    def _cut(self, starts: Table[Part], grain: float) -> tuple[Table[Part], Ints]:
        """The parts of cells, and which cell each is of."""
        canvas = self.canvas
        room, candidates, spare = self.scratch()
        size = 2 * len(starts) + 16
        while True:
            parts, origins = table(Part, size), np.zeros(size, np.int64)
            found = int(
                _kernel("list_parts")(
                    canvas.eye, canvas.window, canvas.width, canvas.height, canvas.reach, starts, grain,
                    self._rules.densest if canvas.lobes else 0.0, room, candidates, spare, parts, origins,
                )
            )  # fmt: skip
            if found <= size:
                return chosen(parts, np.arange(size) < found), origins[:found]
            size = found

    def _nodes(self, parts: Table[Part], some: Ints, orders: Ints) -> tuple[Array, Array, Ints]:
        """(places (N, 2), weights (N,), where those of each part end) of rules."""
        canvas = self.canvas
        room, candidates, _ = self.scratch()
        rows = table(Part, len(some))
        np.asarray(rows)[:] = np.asarray(parts)[some]
        size, ends = 16 * len(some), np.zeros(len(some), np.int64)
        while True:
            nodes = Nodes(np.zeros(1, np.int64), np.zeros((size, 2)), np.zeros(size))
            found = int(
                _kernel("list_nodes")(
                    canvas.eye._replace(nodes=nodes), canvas.window, canvas.width, canvas.height, canvas.reach,
                    rows, orders, room, candidates, ends,
                )
            )  # fmt: skip
            if found <= size:
                return nodes.places[:found], nodes.weights[:found], ends
            size = found


def _allowed(parts: Table[Part]) -> Array:
    """(N,) the share of a pixel's tolerance that parts may take."""
    return np.asarray(0.5 * 0.25 ** np.asarray(parts["level"], np.float64) + 0.01)


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function that lists parts or nodes."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(kernels, name), _nrt=False)
