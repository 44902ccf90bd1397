"""Derivatives of bounced light as a mean over pixels: slopes at the nodes of parts, and what walls sweep.

The parts are those of the mean (``runtimes/pixel_parts.py``), and are looked at more closely until the derivative of
their rules is within the tolerance, not the mean. The lobes' integrals are asked for with their slopes, once a node.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.records import Table, table
from symrender.quadrature.gloss_gradients import BUDGET as STRICT
from symrender.quadrature.split_setup import UNSUPPORTED
from symrender.radiometric.pixels import moving, sweeps, walls
from symrender.radiometric.pixels.records import COARSE, CUT, Part
from symrender.radiometric.shaken import shaken
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import seen_all
from symrender.runtimes.bounce_slopes import Complex, SlopeBouncer
from symrender.runtimes.bounced_pixels import CHANNELS, DIRECT_SHARE, canvas_of
from symrender.runtimes.budgets import by_share
from symrender.runtimes.part_rules import Rules, bends
from symrender.runtimes.part_states import Ints, Pixels, State, added
from symrender.runtimes.pixel_parts import Canvas, Light, Look, Mean, PixelRule, Places
from symrender.runtimes.speeds import Beside, Speeds, Steps, beside_edges, make_sweep, part_twins, unresolved
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

_MOST_NODES: Final = 200_000
"""Nodes, and crossings of walls, of a part, at most."""
_BUDGET: Final = 16
"""Evaluations of a derivative, over those of a value: nodes are asked for ten times less, and rules are of slopes."""
_SLOW: Final = 128.0
"""Steps of a wall, over those that a parameter's unit makes, up to which what it sweeps is no dearer than slopes."""


Cut = Callable[[Table[Part], float], tuple[Table[Part], Ints]]
List = Callable[[Table[Part], Ints, Ints], tuple[moving.Sweep, Ints]]


class Beginning:
    """What derivatives of a tile along several moves begin with: parts of its pixels, and what their first rules sum.

    It is listed for the first of them and kept for the others, of every thread its own.
    """

    def __init__(self) -> None:
        self._own = threading.local()

    def cut(self, starts: Table[Part], grain: float, make: Cut) -> tuple[Table[Part], Ints]:
        """The parts of whole pixels as they were listed last, or those that ``make`` lists."""
        if np.asarray(starts)["level"].any():
            return make(starts, grain)
        asked = np.asarray(starts).tobytes(), grain
        if getattr(self._own, "asked", None) != asked:
            self._own.asked, self._own.parts, self._own.orders = asked, make(starts, grain), None
        kept: tuple[Table[Part], Ints] = self._own.parts
        return kept

    def swept(self, parts: Table[Part], some: Ints, orders: Ints, make: List) -> tuple[moving.Sweep, Ints]:
        """What the rules of kept parts sum, two of each one after the other, or what ``make`` lists."""
        held = getattr(self._own, "parts", None)
        if held is None or parts is not held[0] or not np.array_equal(some, np.repeat(np.arange(len(parts)), 2)):
            return make(parts, some, orders)
        if self._own.orders is None:
            self._own.orders, self._own.sweep = orders.copy(), make(parts, some, orders)
        assert np.array_equal(orders, self._own.orders)
        kept: tuple[moving.Sweep, Ints] = self._own.sweep
        return kept


class SweptRule(PixelRule):
    """Derivatives of means of C channels along one move.

    What nodes see are (N, 2 C + 1): slopes, light, and what light may be off by. What nodes see change and what walls
    sweep are two terms of a mean, for beside a limb what one has too much the other has too little.
    Halves of a part beside a limb are hardly better, for slopes there are as one over a root: rules of higher orders
    are always tried first. ``beside`` looks at what opens between walls that coincide.
    """

    rules = Rules(((1, 2, 3, 5), (2, 3, 5, 8, 12), (2, 3)), told=False, densest=1.0)
    hope = math.inf
    inner = 0.5
    # beside a limb outside of it: of 1/sqrt(x) two rules differ by a third to two thirds of what the better is off by
    slow = 3.0
    doubt = 0.08

    def __init__(
        self, canvas: Canvas, channels: int, speeds: Speeds, beginning: Beginning | None = None,
        beside: Beside | None = None,
    ) -> None:  # fmt: skip
        super().__init__(canvas, channels, 2, self.rules)
        self._speeds, self._beginning, self._beside = speeds, beginning or Beginning(), beside

    def _unseen(self, state: State, pixels: Pixels) -> Array:
        """What parts may be off by: of what may be cut off unseen the length, times what walls part and their speed."""
        swing = np.maximum(self.canvas.bright, pixels.high - pixels.low)[state.pixel]
        missed: Array = np.asarray(state.parts["missed"], np.float64)
        # two curves that bend past each other part an area as the cube of the length
        length = np.where(state.parts["kind"] == CUT, np.cbrt(missed), np.sqrt(missed))
        length = np.minimum(length, 0.5 ** np.asarray(state.parts["level"], np.float64))
        return np.asarray(swing * length * np.where(length > 0.0, state.fastest, 0.0) + state.rough)

    def _cut_means(
        self, columns: Ints, rows: Ints, look: Look, tol: float, budget: int, each: int, account: Ints | None
    ) -> Mean:  # fmt: skip
        found = super()._cut_means(columns, rows, look, tol, budget, each, account)
        # a part of which nothing is known may have become ones that are
        found.status[:] = np.where(np.isfinite(found.error), found.status, UNSUPPORTED)
        return found

    def _sums(
        self, state: State, some: Ints, orders: Ints, pixels: Pixels, look: Look, inner: float, budget: int
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        """(slopes (N, C), what rays state, ``bends``) of a rule of its order for each of some parts."""
        sweep, ends = self._swept(state.parts, some, orders)
        count, own = len(some), [np.repeat(np.arange(len(some)), np.diff(ends[:, k], prepend=0)) for k in range(2)]
        parts = np.asarray(state.parts)[some]
        edges, walls = sweep.edges[: len(own[1])], sweep.walls[: len(own[1])]
        at = Steps(*self._at(parts[own[1]], edges), edges[:, 2:4], walls[:, :2], self.canvas.reach)
        speed = self._speeds.across(at)
        fast = _fastest(own[1], edges, speed, count)
        fast[ends[:, 2] == 1] = np.inf
        state.fastest[some] = np.maximum(state.fastest[some], fast)
        nodes, pixel = sweep.nodes[: len(own[0])], state.pixel[some][own[0]]
        shares = pixels.share(pixel, budget)
        seen = self._seen(parts[own[0]], nodes, fast[own[0]], look, inner, shares)
        slopes, light, error = seen.values[:, : self._channels], seen.values[:, self._channels :], seen.error
        self._seen_by(pixels, pixel, replace(seen, values=light[:, :CHANNELS]))
        before, behind, size = beside_edges(walls, light)
        parted = before - behind
        none = (edges[:, 4] == 0.0) | (edges[:, 5] == moving.UNRESOLVED) | (edges[:, 5] == moving.TWIN)
        moved = np.where(none, 0.0, edges[:, 4] * speed)
        border = edges[:, 5] == moving.BORDER
        inside, outside = np.where(border, 0.0, moved), np.where(border, np.abs(moved), 0.0)
        swept = inside[:, None] * parted[:, : self._channels]
        rows, opened, half, doubt = part_twins(
            at, edges, speed, before[:, : self._channels], behind[:, : self._channels], self._beside, self.canvas.bright
        )  # fmt: skip
        np.add.at(swept, rows, opened)
        values = np.column_stack(
            [added(own[0], nodes[:, 2] * slopes[:, c], count) for c in range(self._channels)]
            + [added(own[1], swept[:, c], count) for c in range(self._channels)]
        )  # fmt: skip
        most = np.abs(parted[:, : self._channels]).max(axis=1, initial=0.0)
        stated = added(own[0], np.abs(nodes[:, 2]) * error, count)
        stated += added(own[1], outside * most + np.abs(moved) * size[:, self._channels], count)
        # along a checker's line one way brings what the other takes
        halves = [np.abs(added(own[1][rows], half[:, c], count)) for c in range(self._channels)]
        stated += added(own[1][rows], doubt, count) + np.max(halves, axis=0)
        known = np.isfinite(values).all(axis=1) & np.isfinite(stated) & (ends[:, 2] == 0)
        rough = np.flatnonzero((parts["kind"] == COARSE)[own[0]])
        changed = added(own[0][rough], np.abs(nodes[rough, 2]) * np.abs(slopes[rough]).max(axis=1, initial=0.0), count)
        # of what is not known rules of a higher order know no more, halves may
        state.rough[some] = np.where(known, changed, np.inf)
        bent = bends(own[0], nodes[:, :2], nodes[:, 2], slopes, count)
        return np.where(known[:, None], values, 0.0), np.where(known, stated, 0.0), bent

    def _seen(
        self, parts: Any, nodes: Array, fast: Array, look: Look, inner: float, shares: Ints
    ) -> Light:  # fmt: skip
        """What nodes see where walls of their parts are ``fast``, each by its share (N,) of evaluations."""
        columns, rows = self._at(parts, nodes)
        # light beside fast walls has to be the better known; a part's own nodes alone have a say
        power = np.ceil(np.log2(np.clip(fast / _SLOW, 1.0, 2.0**20)) / 2.0)
        count = len(nodes)
        found = Light(np.zeros((count, 2 * self._channels + 1)), np.zeros(count), *np.zeros((2, count), np.int64))
        for each in np.unique(power).tolist():
            which = np.flatnonzero(power == each)
            places, finer = Places(columns[which], rows[which], np.zeros(len(which), np.bool_)), inner * 4.0**-each
            seen = by_share(partial(_chosen, look, places, finer), np.arange(len(which)), shares[which])
            found.values[which], found.error[which] = seen.values, seen.error
            found.status[which], found.evaluations[which] = seen.status, seen.evaluations
        return found

    def _at(self, parts: Any, places: Array) -> tuple[Array, Array]:
        """Columns and rows of places of the pixels of parts."""
        reach = self.canvas.reach
        return parts["column"] + 0.5 + reach * places[:, 0], parts["row"] + 0.5 - reach * places[:, 1]

    def _cut(self, starts: Table[Part], grain: float) -> tuple[Table[Part], Ints]:
        return self._beginning.cut(starts, grain, super()._cut)

    def _swept(self, parts: Table[Part], some: Ints, orders: Ints) -> tuple[moving.Sweep, Ints]:
        """What rules sum, and where what belongs to each part ends."""
        return self._beginning.swept(parts, some, orders, self._listed)

    def _listed(self, parts: Table[Part], some: Ints, orders: Ints) -> tuple[moving.Sweep, Ints]:
        canvas = self.canvas
        room, candidates, _ = self.scratch()
        rows, size = table(Part, len(some)), 64 * len(some)
        np.asarray(rows)[:] = np.asarray(parts)[some]
        ends = np.zeros((len(some), 3), np.int64)
        while True:
            sweep = make_sweep(size)
            _kernel()(
                canvas.eye, canvas.window, canvas.width, canvas.height, canvas.reach, rows, orders, room, candidates,
                sweep, ends,
            )  # fmt: skip
            if sweep.counts[2] == 0 or size > _MOST_NODES * len(some):
                return sweep, ends
            size *= 4


def _fastest(owner: Ints, edges: Array, speed: Array, count: int) -> Array:
    """(count,) how fast walls cross parts: of a part that is cut one by one, of one that is not resolved together."""
    found, cut = np.zeros(count), edges[:, 5] != moving.UNRESOLVED
    np.maximum.at(found, owner[cut], np.abs(speed[cut]) * np.hypot(edges[cut, 2], edges[cut, 3]))
    rows, slowest = unresolved(edges, speed)
    return np.maximum(found, added(owner[rows], slowest, count))


def node_budget(settings: Settings, count: int) -> int:
    """Evaluations that the nodes of a pixel take for one of ``count`` derivatives.

    Derivatives keep to four times a strict budget, all together, of which these are three quarters.
    """
    return max(1, STRICT * settings.budget * 3 // (4 * count)) if settings.strict else _BUDGET * settings.budget


Swept = Callable[[int, int, int, int], dict[str, Mean]]
"""By a parameter's name derivatives of the pixels of a tile, row by row."""


def prepare_swept(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> Swept:
    """What differentiates means of bounced light over the pixels of a tile, each to what direct light leaves of
    ``settings.tol``."""
    worlds = shaken(arrays)
    views = seen_all(worlds, settings.width, settings.height)
    canvas = canvas_of(views[0], settings)
    rules, turns, beginning = {}, {}, Beginning()
    for move in wrt:
        moves = [seen_moves(each, move, settings.width, settings.height) for each in worlds]
        turns[move[0]] = [
            Speeds.of(canvas.eye, view, each, walls.list_seen_walls, settings)
            for view, each in zip(views, moves, strict=True)
        ]
        rules[move[0]] = SweptRule(canvas, CHANNELS, turns[move[0]][0], beginning)
    own, budget = threading.local(), node_budget(settings, len(wrt))
    tol = (1.0 - DIRECT_SHARE) * settings.tol

    def slopes(x0: int, y0: int, x1: int, y1: int) -> dict[str, Mean]:
        if not hasattr(own, "bouncers"):
            own.bouncers = {move[0]: SlopeBouncer(arrays, (move,)) for move in wrt}
        found = {}
        for name, rule in rules.items():
            look = _look(own.bouncers[name], turns[name])
            found[name] = rule.means(x0, y0, x1, y1, look, tol, budget, settings.strict)
        return found

    return slopes


def _look(bouncer: SlopeBouncer, shaking: list[Speeds]) -> Look:
    """What answers for nodes, in the scene as it is and as it is shaken."""

    def look(places: Places, tol: float, budget: int) -> Light:
        sent = [(each, *each.unit_rays(places.columns, places.rows)) for each in shaking]
        rays = [(_moving(*_eyes(each, len(d))), _moving(d, turn)) for each, d, turn in sent]
        found = bouncer.sloped([rays], tol, budget)
        assert found.light is not None and found.missed is not None
        values = np.column_stack([found.slopes[0], found.light[0], found.missed[0]])
        return Light(values, found.error[0], found.status[0], found.evaluations)

    return look


def _chosen(look: Look, places: Places, tol: float, some: Ints, budget: int) -> Light:
    return look(places.chosen(some), tol, budget)


def _eyes(each: Speeds, count: int) -> tuple[Array, Array]:
    return np.tile(each.view.eye, (count, 1)), np.tile(each.moves.eye, (count, 1))


def _moving(values: Array, slopes: Array) -> Complex:
    return np.asarray(values + 1j * slopes)


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that lists what derivatives of parts are summed from."""
    # the kernel only borrows arrays; counting references to them would cost more than the arithmetic
    return compiled(sweeps.sweep_parts, _nrt=False)
