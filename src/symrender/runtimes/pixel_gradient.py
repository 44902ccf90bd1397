"""Derivatives of means over pixels: slopes at their nodes, and what walls sweep."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import lru_cache
from types import ModuleType
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.generated import load_module
from symrender.jit.records import table
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.pixels import cells, moving, pixel, walls
from symrender.radiometric.pixels.moving import Sweep
from symrender.radiometric.pixels.records import TERMS, Family, Wall, make_room
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
_FINER: Final = 1e-3
"""Tolerance of the means whose rules are differentiated, over that of the derivative: the square is what a cell that is
not resolved adds, for a derivative has its side where a mean has its area."""


@lru_cache(maxsize=1)
def pushed_text() -> str:
    """Text of the kernels that push rays and walls forward."""
    return pushed((walls.list_walls, walls.list_families, moving.fill_levels, tile.fill_rays))


def pushed_module() -> ModuleType:
    """The module that ``pushed_text`` is the text of."""
    return load_module(pushed_text())


class _Pixel:
    """The sweep of one pixel, copied: nodes, edges, walls of edges, and what is not resolved."""

    def __init__(self, sweep: Sweep, coarse: float, spread: float) -> None:
        nodes, edges, over = (int(x) for x in sweep.counts)
        self.nodes, self.edges = sweep.nodes[:nodes].copy(), sweep.edges[:edges].copy()
        self.walls, self.over = sweep.walls[:edges].copy(), bool(over)
        self.coarse = coarse * spread


def prepare_box(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """The layers of ``runtimes/radiometric_gradient.py`` of means over pixels, moving edges included.

    The error is the difference of two rules, and for cells that are not resolved their side times the span of radiance
    times the fastest wall of the pixel.
    """
    check_pixels(arrays, f"filter: {settings.filter}")
    width, height = settings.width, settings.height
    view = seen(arrays, width, height)
    eye = eye_of(arrays, view, DOMAINS[settings.filter])
    moving_worlds = {move[0]: seen_moves(arrays, move, width, height) for move in wrt}
    held = len(eye.walls), len(eye.families)
    speeds = {name: _wall_moves(view, moves, *held) for name, moves in moving_worlds.items()}
    own = threading.local()
    tol = max(1e-12, settings.tol * _FINER)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        if not hasattr(own, "room"):
            own.room = make_room(view.world), np.arange(len(eye.walls)), make_sweep()
        room, candidates, sweep = own.room
        spent = 0
        for j in range(y0, y1):
            for i in range(x0, x1):
                # a filter's support is wider than the pixel
                low, high = 0.5 - settings.reach, 0.5 + settings.reach
                whole = cells.window_cell(view.window, width, height, i + low, j + low, i + high, j + high, tol)
                count = _kernel("block_walls")(eye, whole, room, candidates)
                coarse = _kernel("sweep_pixel")(eye, whole, room, candidates, count, tol, settings.budget // 4, sweep)
                span = float(max(0.0, (room.span[1] - room.span[0]).max()))
                found = _Pixel(sweep, coarse, max(span, eye.bright))
                spent += len(found.nodes)
                for name, moves in moving_worlds.items():
                    value, error = _moved(found, view, moves, speeds[name], eye, (i, j), settings)
                    known = np.isfinite(error)
                    layers[f"emitted:{name}"][j, i] = value[:3] if known else 0.0
                    layers[f"direct:{name}"][j, i] = value[3:] if known else 0.0
                    layers[f"radiance:{name}"][j, i] = value[:3] + value[3:] if known else 0.0
                    layers[f"error:{name}"][j, i] = error
                    missed = CAPPED if known else UNSUPPORTED
                    layers[f"status:{name}"][j, i] = missed if error > settings.tol or not known else MET
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        unused, hit_class = np.zeros((*shape, 3)), np.zeros(shape)
        place = (width, height, x0, y0, x1, y1)
        _kernel("fill_tile")(*view, *place, sky_room(view.world), unused, unused, hit_class)
        layers["hit_class"][here] = hit_class
        return spent

    return render


def make_sweep() -> Sweep:
    """Room for the derivative of a pixel."""
    return Sweep(
        np.zeros((MOST_NODES, 4)), np.zeros((MOST_NODES, 11)), np.zeros((MOST_NODES, 2), np.int64),
        np.zeros(3, np.int64), np.zeros((2, 6)),
    )  # fmt: skip


def _wall_moves(view: Seen, moves: Seen, count: int, coordinates: int) -> tuple[Any, Any]:
    """How walls and texture coordinates move."""
    found, rates = table(Wall, count), table(Wall, count)
    _pushed("list_walls_dot")(view.world, view.eye, found, moves.world, moves.eye, rates)
    families, turns = table(Family, coordinates), table(Family, coordinates)
    _pushed("list_families_dot")(view.world, view.eye, families, moves.world, moves.eye, turns)
    return rates, turns


def _rays_of(view: Seen, moves: Seen, x: Array, y: Array, settings: Settings) -> tuple[Array, Array]:
    """Rays through places of the image, in pixels, of any length, and how they move."""
    a, b = 2.0 * x / settings.width - 1.0, 1.0 - 2.0 * y / settings.height
    rays = view.window[0] + a[:, None] * view.window[1] + b[:, None] * view.window[2]
    turns = moves.window[0] + a[:, None] * moves.window[1] + b[:, None] * moves.window[2]
    return np.ascontiguousarray(rays), np.ascontiguousarray(turns)


def _moved(
    found: _Pixel, view: Seen, moves: Seen, speeds: tuple[Any, Any], eye: cells.Eye, at: tuple[int, int],
    settings: Settings,
) -> tuple[Array, float]:  # fmt: skip
    """(slope of emitted and direct light of a pixel, what it may be off by)."""
    if found.over:
        return np.zeros(6), np.inf
    (i, j), reach = at, settings.reach
    nodes, edges = found.nodes, found.edges
    rays, turns = _rays_of(view, moves, i + 0.5 + reach * nodes[:, 0], j + 0.5 - reach * nodes[:, 1], settings)
    size = np.sqrt((rays**2).sum(axis=1, keepdims=True))
    rays, turns = rays / size, turns / size
    turns -= rays * (rays * turns).sum(axis=1, keepdims=True)
    light = _pushed_rays(view, moves, rays, turns)
    values = nodes[:, 2] @ light, nodes[:, 3] @ light
    fastest = 0.0
    if len(edges):
        rays, turns = _rays_of(view, moves, i + 0.5 + reach * edges[:, 0], j + 0.5 - reach * edges[:, 1], settings)
        right, up = 2.0 * reach * view.window[1] / settings.width, 2.0 * reach * view.window[2] / settings.height
        steps = np.ascontiguousarray(edges[:, 2:3] * right + edges[:, 3:4] * up)
        levels, slopes, rates = (np.zeros(len(edges)) for _ in range(3))
        work, out = np.zeros((8, TERMS)), np.zeros(TERMS)
        which = found.walls.astype(np.float64)
        _pushed("fill_levels_dot")(
            eye.walls, eye.families, which, rays, steps, work, out, levels, slopes,
            *speeds, np.zeros_like(which), turns, np.zeros_like(steps), np.zeros_like(work), np.zeros_like(out), rates,
            np.zeros_like(slopes),
        )  # fmt: skip
        with np.errstate(divide="ignore", invalid="ignore"):
            speed = -rates / slopes
        swept = edges[:, 4:10] * speed[:, None]
        values = values[0] + swept[edges[:, 10] == 0].sum(axis=0), values[1] + swept[edges[:, 10] == 1].sum(axis=0)
        across = np.hypot(edges[:, 2], edges[:, 3])
        fastest = float(np.abs(speed * across).max())
    error = float(np.abs((values[0] - values[1]).reshape(2, 3).sum(axis=0)).max()) + found.coarse * max(fastest, 1.0)
    return np.asarray(values[0]), error if np.isfinite(error) and np.isfinite(values[0]).all() else np.inf


def _pushed_rays(view: Seen, moves: Seen, rays: Array, turns: Array) -> Array:
    """(n, 6) slopes of emitted and direct light along rays from the eye."""
    count = len(rays)
    eyes, shifts = np.tile(view.eye, (count, 1)), np.tile(moves.eye, (count, 1))
    values = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    slopes = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    room, shaking = sky_room(view.world), sky_room(view.world)
    _pushed("fill_rays_dot")(view.world, eyes, rays, room, *values, moves.world, shifts, turns, shaking, *slopes)
    return np.concatenate(slopes[:2], axis=1)


@lru_cache(maxsize=4)
def _pushed(name: str) -> Any:
    """A pushed kernel, compiled."""
    return compiled(getattr(pushed_module(), name), sources=[pushed_text()], _nrt=False)


@lru_cache(maxsize=3)
def _kernel(name: str) -> Any:
    """Compiled function that lists what a pixel's derivative is summed from."""
    module = next(each for each in (moving, pixel, tile) if hasattr(each, name))
    return compiled(getattr(module, name), _nrt=False)
