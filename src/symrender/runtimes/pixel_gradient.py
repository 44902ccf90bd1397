"""Derivatives of means over pixels: slopes at their nodes, and what walls sweep."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.generated import load_module
from symrender.jit.records import Table, table
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.pixels import moving, sweeps, walls
from symrender.radiometric.pixels.cells import Eye
from symrender.radiometric.pixels.moving import Sweep
from symrender.radiometric.pixels.records import TERMS, Family, Ints, Wall, make_room
from symrender.radiometric.pixels.rules import GAUSS
from symrender.radiometric.pushforward import pushed
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, seen
from symrender.runtimes.image import TileKernel
from symrender.runtimes.pixels import DOMAINS, check_pixels, eye_of
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

MOST_NODES: Final = 200_000
"""Nodes, and crossings of walls, of a pixel's derivative, at most."""
_FINER: Final = (1e-3, 2e-5)
"""Tolerances of means whose rules are differentiated in turn, over that of the derivative: the square is what a cell
that is not resolved adds, for a derivative has its side where a mean has its area."""

_SLOW: Final = 4.0
"""Times the difference of two rules that the better may be off by: slopes beside a limb outside of a cell are as one
over a root, of which rules of 2 x 2 and 3 x 3 nodes differ by two fifths of what the better misses."""


@lru_cache(maxsize=1)
def pushed_text() -> str:
    """Text of the kernels that push rays and walls forward."""
    return pushed((walls.list_walls, walls.list_seen_walls, walls.list_families, moving.fill_levels, tile.fill_rays))


def pushed_module() -> ModuleType:
    """The module that ``pushed_text`` is the text of."""
    return load_module(pushed_text())


@dataclass(frozen=True)
class Steps:
    """N places of an image, in pixels, where walls cross lines, and the directions of these lines in an image.

    ``steps`` (N, 2) are in half widths of a filter's support, as the places of ``Sweep``.
    """

    columns: Array
    rows: Array
    steps: Array
    walls: Ints


@dataclass(frozen=True)
class Speeds:
    """How fast the walls of an eye cross lines while a view moves; ``rates`` and ``turns`` are those of the walls and
    of the coordinates of textures."""

    eye: Eye
    view: Seen
    moves: Seen
    rates: Table[Wall]
    turns: Table[Family]
    settings: Settings

    @classmethod
    def of(cls, eye: Eye, view: Seen, moves: Seen, lister: str, settings: Settings) -> Speeds:
        """Of the walls that the kernel ``lister`` lists."""
        found, rates = (table(Wall, len(eye.walls)) for _ in range(2))
        _pushed(f"{lister}_dot")(view.world, view.eye, found, moves.world, moves.eye, rates)
        families, turns = (table(Family, len(eye.families)) for _ in range(2))
        _pushed("list_families_dot")(view.world, view.eye, families, moves.world, moves.eye, turns)
        return cls(eye, view, moves, rates, turns, settings)

    def rays(self, columns: Array, rows: Array) -> tuple[Array, Array]:
        """Rays through places of the image, in pixels, of any length, and how they move."""
        a, b = 2.0 * columns / self.settings.width - 1.0, 1.0 - 2.0 * rows / self.settings.height
        window, turns = self.view.window, self.moves.window
        found = window[0] + a[:, None] * window[1] + b[:, None] * window[2]
        moved = turns[0] + a[:, None] * turns[1] + b[:, None] * turns[2]
        return np.ascontiguousarray(found), np.ascontiguousarray(moved)

    def unit_rays(self, columns: Array, rows: Array) -> tuple[Array, Array]:
        """The same of unit length."""
        rays, turns = self.rays(columns, rows)
        size = np.sqrt((rays**2).sum(axis=1, keepdims=True))
        rays, turns = rays / size, turns / size
        return rays, turns - rays * (rays * turns).sum(axis=1, keepdims=True)

    def across(self, at: Steps) -> Array:
        """(N,) steps that walls take along their lines."""
        settings, count = self.settings, len(at.columns)
        if not count:
            return np.zeros(0)
        rays, turns = self.rays(at.columns, at.rows)
        right = 2.0 * settings.reach * self.view.window[1] / settings.width
        up = 2.0 * settings.reach * self.view.window[2] / settings.height
        steps = np.ascontiguousarray(at.steps[:, :1] * right + at.steps[:, 1:] * up)
        levels, slopes, rates = (np.zeros(count) for _ in range(3))
        work, out = np.zeros((8, TERMS)), np.zeros(TERMS)
        which = np.ascontiguousarray(at.walls, np.float64)
        _pushed("fill_levels_dot")(
            self.eye.walls, self.eye.families, which, rays, steps, work, out, levels, slopes,
            self.rates, self.turns, np.zeros_like(which), turns, np.zeros_like(steps), np.zeros_like(work),
            np.zeros_like(out), rates, np.zeros_like(slopes),
        )  # fmt: skip
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-rates / slopes)


@lru_cache(maxsize=16)
def end_weights(order: int) -> Array:
    """(2, order): weights of the nodes of a piece in what is extrapolated to its beginning, and to its end."""
    nodes = GAUSS[0, order, :order]
    others = [np.delete(nodes, k) for k in range(order)]
    return np.array([
        [float(np.prod((end - rest) / (node - rest))) for node, rest in zip(nodes, others, strict=True)]
        for end in (0.0, 1.0)
    ])  # fmt: skip


def jumps(walls: Ints, values: Array) -> tuple[Array, Array]:
    """(edges, C): ``values`` (nodes, C) before each edge of a ``Sweep`` less those behind it, and the sum of their
    sizes as they were weighed. Nothing is swept where there is no piece before."""
    found, size = np.zeros((len(walls), values.shape[1])), np.zeros((len(walls), values.shape[1]))
    for order in np.unique(walls[:, 4]).tolist():
        some = np.flatnonzero((walls[:, 4] == order) & (walls[:, 2] >= 0))
        for row, sign in ((1, 1.0), (0, -1.0)) if order else ():
            nodes = values[walls[some, 3 - row, None] + np.arange(order)]
            weights = end_weights(order)[row][None, :, None]
            found[some] += sign * (weights * nodes).sum(axis=1)
            size[some] += (np.abs(weights) * np.abs(nodes)).sum(axis=1)
    return found, size


def unresolved(edges: Array, speed: Array) -> tuple[Ints, Array]:
    """Of walls in cells that are not resolved, (the first row of each, how far it moves at right angles, at most)."""
    rows = np.flatnonzero(edges[:, 5] == moving.UNRESOLVED)
    far = np.abs(speed[rows]) * np.hypot(edges[rows, 2], edges[rows, 3])
    # along the side that it is parallel to a wall has no speed
    return rows[::2], np.nan_to_num(np.fmin(far[::2], far[1::2]), nan=np.inf)


@dataclass(frozen=True)
class _Found:
    """What the derivatives of P pixels are summed from: all their nodes, then all their edges.

    ``columns`` and ``rows`` are the pixels' middles, ``of_node`` and ``of_edge`` say which one a row is of; ``coarse``
    and ``spread`` (P,) what cells that are not resolved may add, over a speed, and what radiance spans; ``over`` (P,)
    where there was no room for all.
    """

    nodes: Array
    edges: Array
    walls: Ints
    columns: Array
    rows: Array
    of_node: Ints
    of_edge: Ints
    coarse: Array
    spread: Array
    over: npt.NDArray[np.bool_]


class _Gathered:
    """The sweeps of pixels, some at a time."""

    def __init__(self) -> None:
        self._nodes: list[Array] = []
        self._edges: list[Array] = []
        self._walls: list[Ints] = []
        self._pixels: list[Array] = []
        self._counts: list[Ints] = []
        self._held = self._cells = 0

    def add(self, columns: Ints, rows: Ints, sweep: Sweep, ends: Ints, cells_: Array) -> None:
        """Copy what was listed of pixels."""
        nodes, edges = (int(x) for x in sweep.counts[:2])
        begins = np.zeros((1, 2), np.int64)
        counts = np.diff(np.concatenate([begins, ends[:, :2]]), axis=0)
        self._pixels.append(np.column_stack([columns + 0.5, rows + 0.5, cells_[:, 0] * cells_[:, 1], cells_[:, 1]]))
        self._counts.append(np.column_stack([counts, ends[:, 2]]))
        found, lines = sweep.nodes[:nodes].copy(), sweep.edges[:edges].copy()
        found[:, 4] += self._cells
        lines[:, 6] += self._cells
        self._cells += int(sweep.counts[3]) + 1
        self._nodes.append(found)
        self._edges.append(lines)
        walls = sweep.walls[:edges].copy()
        walls[:, 2:4] += np.where(walls[:, 2:4] >= 0, self._held, 0)
        self._walls.append(walls)
        self._held += nodes

    def found(self) -> _Found:
        """All of them."""
        (columns, rows, coarse, spread), counts = np.concatenate(self._pixels).T, np.concatenate(self._counts)
        which = np.arange(len(columns))
        return _Found(
            np.concatenate(self._nodes), np.concatenate(self._edges), np.concatenate(self._walls), columns, rows,
            np.repeat(which, counts[:, 0]), np.repeat(which, counts[:, 1]), coarse, spread, counts[:, 2] != 0,
        )  # fmt: skip


def prepare_box(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """The layers of ``runtimes/radiometric_gradient.py`` of means over pixels, moving edges included.

    The error is the difference of two rules, and for cells that are not resolved their side times the span of radiance
    times the fastest wall of the pixel.
    """
    check_pixels(arrays, f"filter: {settings.filter}")
    width, height = settings.width, settings.height
    view = seen(arrays, width, height)
    eye = eye_of(arrays, view, DOMAINS[settings.filter])
    moved = {
        move[0]: Speeds.of(eye, view, seen_moves(arrays, move, width, height), "list_walls", settings) for move in wrt
    }
    own = threading.local()

    def swept(columns: Ints, rows: Ints, tol: float) -> _Found:
        if not hasattr(own, "room"):
            own.room = make_room(view.world), np.arange(len(eye.walls)), make_sweep()
        room, candidates, sweep = own.room
        gathered = _Gathered()
        while len(columns):
            ends, sums = np.zeros((len(columns), 3), np.int64), np.zeros((len(columns), 2))
            done = int(
                _kernel("sweep_pixels")(
                    eye, view.window, width, height, settings.reach, columns, rows, room, candidates, tol,
                    settings.budget // 4, sweep, ends, sums,
                )
            )  # fmt: skip
            gathered.add(columns[:done], rows[:done], sweep, ends[:done], sums[:done])
            columns, rows = columns[done:], rows[done:]
        return gathered.found()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        columns, rows = np.tile(np.arange(x0, x1), y1 - y0), np.repeat(np.arange(y0, y1), x1 - x0)
        best = {name: (np.zeros((len(columns), 6)), np.full(len(columns), np.inf)) for name in moved}
        left, spent = np.arange(len(columns)), 0
        for finer in _FINER:
            if not len(left):
                break
            found = swept(columns[left], rows[left], max(1e-12, settings.tol * finer))
            spent += len(found.nodes)
            for name, (values, errors) in best.items():
                again, error = _moved(found, moved[name])
                values[left] = np.where((error < errors[left])[:, None], again, values[left])
                errors[left] = np.minimum(error, errors[left])
            left = np.flatnonzero(~(np.max([errors for _, errors in best.values()], axis=0) <= settings.tol))
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        for name, (flat, error_) in best.items():
            image, errors_ = flat.reshape(*shape, 6), error_.reshape(shape)
            known = np.isfinite(errors_)
            layers[f"emitted:{name}"][here], layers[f"direct:{name}"][here] = image[..., :3], image[..., 3:]
            layers[f"radiance:{name}"][here] = image[..., :3] + image[..., 3:]
            layers[f"error:{name}"][here] = errors_
            late = np.where(known, CAPPED, UNSUPPORTED)
            layers[f"status:{name}"][here] = np.where(~(errors_ <= settings.tol), late, MET)
        unused, hit_class = np.zeros((*shape, 3)), np.zeros(shape)
        place = (width, height, x0, y0, x1, y1)
        _kernel("fill_tile")(*view, *place, sky_room(view.world), unused, unused, hit_class)
        layers["hit_class"][here] = hit_class
        return spent

    return render


def make_sweep(most: int = MOST_NODES) -> Sweep:
    """Room for the derivative of a pixel."""
    return Sweep(
        np.zeros((most, 5)), np.zeros((most, 7)), np.zeros((most, 5), np.int64), np.zeros(4, np.int64)
    )  # fmt: skip


def _moved(found: _Found, speeds: Speeds) -> tuple[Array, Array]:
    """(slopes (P, 6) of emitted and direct light of pixels, what each may be off by)."""
    reach, count = speeds.settings.reach, len(found.over)
    nodes, edges = found.nodes, found.edges
    columns, rows = found.columns[found.of_node], found.rows[found.of_node]
    rays = speeds.unit_rays(columns + reach * nodes[:, 0], rows - reach * nodes[:, 1])
    values, light = _pushed_rays(speeds.view, speeds.moves, *rays)
    total = _sums(found.of_node, nodes[:, 2, None] * light, count)
    coarse, border = found.coarse, np.zeros(count)
    # of a pixel's cells, for what one rule has too much another may have too little
    cells = int(max(nodes[:, 4].max(initial=-1.0), edges[:, 6].max(initial=-1.0))) + 1
    owner = np.zeros(cells, np.int64)
    owner[nodes[:, 4].astype(np.int64)] = found.of_node
    gaps = _sums(nodes[:, 4].astype(np.int64), (nodes[:, 2] - nodes[:, 3])[:, None] * light, cells)
    if len(edges):
        columns, rows = found.columns[found.of_edge], found.rows[found.of_edge]
        at = Steps(columns + reach * edges[:, 0], rows - reach * edges[:, 1], edges[:, 2:4], found.walls[:, :2])
        speed, kind = speeds.across(at), edges[:, 5]
        still = (edges[:, 4] == 0.0) | (kind == moving.UNRESOLVED)
        swept = jumps(found.walls, values)[0] * (edges[:, 4] * np.where(still, 0.0, speed))[:, None]
        total += _sums(found.of_edge[kind == moving.FINER], swept[kind == moving.FINER], count)
        for rule, sign in ((moving.FINER, 1.0), (moving.COARSER, -1.0)):
            gaps += sign * _sums(edges[kind == rule, 6].astype(np.int64), swept[kind == rule], cells)
        two = kind == moving.BORDER
        border = _sums(found.of_edge[two], np.abs(swept[two]), count).reshape(count, 2, 3).sum(axis=1).max(axis=1)
        first, slowest = unresolved(edges, speed)
        swung = edges[first, 4] * np.hypot(edges[first, 2], edges[first, 3]) * slowest
        coarse = np.maximum(coarse, found.spread * _sums(found.of_edge[first], swung[:, None], count)[:, 0])
    gap = _sums(owner, np.abs(gaps.reshape(cells, 2, 3).sum(axis=1)), count).max(axis=1)
    error = _SLOW * gap + coarse + border
    known = np.isfinite(error) & np.isfinite(total).all(axis=1) & ~found.over
    return np.where(known[:, None], total, 0.0), np.where(known, error, np.inf)


def _sums(owner: Ints, what: Array, count: int) -> Array:
    """(count, C) sums of the rows (N, C) that belong to each owner, one after the other."""
    found = [np.bincount(owner, what[:, c], count) for c in range(what.shape[1])]
    return np.column_stack(found).astype(np.float64)


def _pushed_rays(view: Seen, moves: Seen, rays: Array, turns: Array) -> tuple[Array, Array]:
    """(n, 6) emitted and direct light along rays from the eye, and its slopes."""
    count = len(rays)
    eyes, shifts = np.tile(view.eye, (count, 1)), np.tile(moves.eye, (count, 1))
    values = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    slopes = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    room, shaking = sky_room(view.world), sky_room(view.world)
    _pushed("fill_rays_dot")(view.world, eyes, rays, room, *values, moves.world, shifts, turns, shaking, *slopes)
    return np.concatenate(values[:2], axis=1), np.concatenate(slopes[:2], axis=1)


@lru_cache(maxsize=4)
def _pushed(name: str) -> Any:
    """A pushed kernel, compiled."""
    return compiled(getattr(pushed_module(), name), sources=[pushed_text()], _nrt=False)


@lru_cache(maxsize=3)
def _kernel(name: str) -> Any:
    """Compiled function that lists what a pixel's derivative is summed from."""
    module = next(each for each in (sweeps, tile) if hasattr(each, name))
    return compiled(getattr(module, name), _nrt=False)
