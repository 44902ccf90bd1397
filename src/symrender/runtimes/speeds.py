"""How fast walls of an image cross lines, and how what rays see changes, while a scene moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.records import Table, table
from symrender.jit.twins import moving
from symrender.radiometric import tile
from symrender.radiometric.pixels import walls
from symrender.radiometric.pixels.cells import Eye
from symrender.radiometric.pixels.moving import TWIN, UNRESOLVED, Sweep, fill_levels
from symrender.radiometric.pixels.records import TERMS, Family, Ints, Section, Wall
from symrender.radiometric.pixels.rules import GAUSS
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen
from symrender.settings import Settings

_ALIKE: Final = 1e-9
"""Relative difference of speeds up to which walls that coincide are one: what two ways to list it round."""
_OPENED: Final = 1e-6
"""How far the faster of two such walls is moved to see what lies between them, in half widths of a support."""
_LEAST: Final = 1e-10
"""Gaps that are looked into at least, in these: a hundred times what places of walls are known to."""
Lister = Callable[..., int]
"""A kernel that lists walls: ``list_walls``, ``list_seen_walls`` or ``list_series_walls``."""


@dataclass(frozen=True)
class Steps:
    """N places of an image, in pixels, where walls cross lines, and the directions of these lines in an image.

    ``steps`` (N, 2) are in half widths of a filter's support, as the places of ``Sweep``; ``reach`` is one, in pixels.
    """

    columns: Array
    rows: Array
    steps: Array
    walls: Ints
    reach: float


@dataclass(frozen=True)
class Speeds:
    """How fast the walls of an eye cross lines while a view moves.

    ``turning`` is the view with its tangents, ``walls`` and ``families`` the walls and the coordinates of textures with
    theirs.
    """

    view: Seen
    moves: Seen
    turning: Seen
    walls: Table[Wall]
    families: Table[Family]
    settings: Settings

    @classmethod
    def of(
        cls, eye: Eye, view: Seen, moves: Seen, lister: Lister, settings: Settings, *sections: Table[Section]
    ) -> Speeds:  # fmt: skip
        """Of the walls that ``lister`` lists, of ``list_series_walls`` with sections and their derivatives."""
        turning = moving(view, moves)
        found, families = moving(table(Wall, len(eye.walls))), moving(table(Family, len(eye.families)))
        cut = (moving(*sections),) if sections else ()
        _kernel(lister)(turning.world, turning.eye, *cut, found)
        _kernel(walls.list_families)(turning.world, turning.eye, families)
        return cls(view, moves, turning, found, families, settings)

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
        # a line stands still: its steps have no tangents
        levels, slopes = np.zeros((2, count), np.complex128)
        work, out = np.zeros((8, TERMS), np.complex128), np.zeros(TERMS, np.complex128)
        which = np.ascontiguousarray(at.walls, np.float64)
        _kernel(fill_levels)(self.walls, self.families, which, rays + 1j * turns, steps, work, out, levels, slopes)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-levels.imag / slopes.real)


@lru_cache(maxsize=16)
def end_weights(order: int) -> Array:
    """(2, order): weights of the nodes of a piece in what is extrapolated to its beginning, and to its end."""
    nodes = GAUSS[0, order, :order]
    others = [np.delete(nodes, k) for k in range(order)]
    return np.array([
        [float(np.prod((end - rest) / (node - rest))) for node, rest in zip(nodes, others, strict=True)]
        for end in (0.0, 1.0)
    ])  # fmt: skip


def beside_edges(walls: Ints, values: Array) -> tuple[Array, Array, Array]:
    """(edges, C) each: ``values`` (nodes, C) before each edge of a ``Sweep``, behind it, and the sum of their sizes as
    they were weighed. All are nothing where there is no piece before: nothing is swept."""
    before, behind, size = (np.zeros((len(walls), values.shape[1])) for _ in range(3))
    for order in np.unique(walls[:, 4]).tolist():
        some = np.flatnonzero((walls[:, 4] == order) & (walls[:, 2] >= 0))
        for row, found in ((1, before), (0, behind)) if order else ():
            nodes = values[walls[some, 3 - row, None] + np.arange(order)]
            weights = end_weights(order)[row][None, :, None]
            found[some] += (weights * nodes).sum(axis=1)
            size[some] += (np.abs(weights) * np.abs(nodes)).sum(axis=1)
    return before, behind, size


Beside = Callable[[float, Array, Array], Array]
"""(N, C) light through places of the image, columns and rows in pixels, where the parameter is by so much more."""


def part_twins(
    at: Steps, edges: Array, speed: Array, before: Array, behind: Array, beside: Beside | None, bright: float
) -> tuple[Ints, Array, Array, Array]:  # fmt: skip
    """Where walls coincide and part as the parameter moves a mean has two derivatives, one for either way.

    (rows of ``edges``, what is added to what the first of each group sweeps, (n, C), for the value between both, half
    of what they differ by, (n, C), and what both may be off by, (n,)). What opens between two walls is not there to be
    seen: it is looked at where the parameter is a little more and a little less; without ``beside`` any light up to the
    brightest may be there.
    """
    group = np.cumsum(edges[:, 5] != TWIN)
    which = np.flatnonzero((np.bincount(group, minlength=1)[group] > 1) & np.isfinite(speed))
    which = which[np.lexsort((speed[which], group[which]))]
    slow, fast = which[:-1], which[1:]
    parts = speed[fast] - speed[slow]
    most = np.maximum(np.abs(speed[slow]), np.abs(speed[fast]))
    # walls that are one move alike but for roundings
    apart = (group[slow] == group[fast]) & (parts > _ALIKE * most)
    slow, fast, parts, most = slow[apart], fast[apart], parts[apart], most[apart]
    seen = np.full((2, len(slow), before.shape[1]), 0.5 * bright)
    off = np.full(len(slow), 0.5 * bright)
    if beside is not None and len(slow):
        length = np.hypot(at.steps[slow, 0], at.steps[slow, 1])
        step = _OPENED / float((most * length).max())
        looks = np.empty((2, *seen.shape))
        for side, sign in enumerate((1.0, -1.0)):
            for k, share in enumerate((1.0, 0.5)):
                by = sign * share * step
                along = at.reach * (0.5 * by * (speed[slow] + speed[fast]))[:, None] * at.steps[slow]
                looks[k, side] = beside(by, at.columns[slow] + along[:, 0], at.rows[slow] - along[:, 1])
        told = step * parts * length > _LEAST
        seen[:, told] = (2.0 * looks[1] - looks[0])[:, told]
        off[told] = np.abs(looks[1] - looks[0]).max(axis=(0, 2))[told]
    first = np.maximum.accumulate(np.where(edges[:, 5] == TWIN, 0, np.arange(len(edges))))
    # of gaps that open before the first wall the rest of the sum is the other one
    swapped = (speed[fast] <= speed[first[slow]])[:, None]
    left, right = before[slow], behind[slow]
    more = seen[0] - np.where(swapped, left, right)
    less = np.where(swapped, right, left) - seen[1]
    weight = (edges[slow, 4] * parts)[:, None]
    return slow, 0.5 * weight * (more + less), 0.5 * weight * (more - less), np.abs(weight[:, 0]) * off


def unresolved(edges: Array, speed: Array) -> tuple[Ints, Array]:
    """Of walls in cells that are not resolved, (the first row of each, how far it moves at right angles, at most)."""
    rows = np.flatnonzero(edges[:, 5] == UNRESOLVED)
    far = np.abs(speed[rows]) * np.hypot(edges[rows, 2], edges[rows, 3])
    # along the side that it is parallel to a wall has no speed
    return rows[::2], np.nan_to_num(np.fmin(far[::2], far[1::2]), nan=np.inf)


def make_sweep(most: int) -> Sweep:
    """Room for nodes and for edges."""
    return Sweep(np.zeros((most, 3)), np.zeros((most, 6)), np.zeros((most, 5), np.int64), np.zeros(3, np.int64))


def moving_light(speeds: Speeds, columns: Array, rows: Array) -> tuple[Array, Array]:
    """Radiance and emitted light (n, 6) through places of the image, in pixels, and their derivatives."""
    settings, found = speeds.settings, np.zeros((len(columns), 6), np.complex128)
    room = moving(sky_room(speeds.view.world))
    _kernel(tile.fill_places)(*speeds.turning, settings.width, settings.height, columns, rows, room, found)
    return np.ascontiguousarray(found.real), np.ascontiguousarray(found.imag)


@lru_cache(maxsize=8)
def _kernel(function: Callable[..., Any]) -> Any:
    """A function of this side, compiled."""
    return compiled(function, _nrt=False)
