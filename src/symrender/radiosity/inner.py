"""What cells with halves send: one cubic in place of those of their leaves, and what it is off them.

A place far from a cell sees no difference, so that it gathers of a few large cells what it would gather of many small
ones. Cubics of halves are joined by least squares over their area, which is a matrix of each half, made once; what the
cubic is off is found by writing it in the variables of each half, and handed upwards. Gauss's rule is exact for squares
of cubics, so that what is off has no mean, times any cubic: no place notices it but by what its weights are no cubics.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from symrender.jit.records import Table
from symrender.radiometric.vectors import Array
from symrender.radiosity.cells import NODES, Frames, Quads, monomials, node_weights, sampled_places
from symrender.radiosity.records import CHANNELS, NEVER, NONE, TERMS, Cell, Ints

_GRID: Final = np.cos(np.arange(5) * (np.pi / 4.0))
"""Values of a variable at which cubics are compared."""


@dataclass(frozen=True)
class Level:
    """Cells ``rows`` whose halves ``pair`` (N, 2) lie on lower levels.

    ``joins`` (N, 2, TERMS, TERMS) make of the terms of both halves theirs, ``parts`` of theirs the same cubic in the
    variables of each half.
    """

    rows: Ints
    pair: Ints
    joins: Array
    parts: Array


@dataclass(frozen=True)
class Inner:
    """The cells of a forest that have halves, from the lowest level up; ``never`` are those whose cubic is not used."""

    levels: tuple[Level, ...]
    never: Ints

    def write(self, cells: Table[Cell]) -> None:
        """Write what they send and how far it is from what their leaves send."""
        cells["rough"][self.never] = NEVER
        terms = np.asarray(cells["terms"]).reshape(len(cells), CHANNELS, TERMS).copy()
        for level in self.levels:
            below = terms[level.pair]
            made = np.einsum("nhij,nhcj->nci", level.joins, below)
            apart = np.einsum("nhij,ncj->nhci", level.parts, made) - below
            off = np.abs(apart @ _COMPARED.T).max(axis=(1, 2, 3))
            terms[level.rows] = made
            cells["terms"][level.rows] = made.reshape(len(made), -1)
            cells["spread"][level.rows] = np.abs(made[..., 1:]).sum(axis=2).max(axis=1)
            cells["rough"][level.rows] = off + np.asarray(cells["rough"])[level.pair].max(axis=1)

    def write_doubts(self, cells: Table[Cell]) -> None:
        """Write what they doubt: the most of their leaves', and its means over their area."""
        for level in self.levels:
            area = np.asarray(cells["area"])[level.pair]
            share = area / np.maximum(area.sum(axis=1, keepdims=True), 1e-300)
            for name in ("even", "bulk", "haze"):
                cells[name][level.rows] = (share * np.asarray(cells[name])[level.pair]).sum(axis=1)
            for name in ("doubt", "drift"):
                cells[name][level.rows] = np.asarray(cells[name])[level.pair].max(axis=1)
            cells["doubt"][level.rows] += cells["rough"][level.rows]
        cells["doubt"][self.never] = NEVER


def inner_of(quads: Quads, frames: Frames, first: Ints, second: Ints, pentagons: Ints) -> Inner:
    """The cells with halves of a forest; none above one of five corners has a cubic."""
    height = np.zeros(len(quads), dtype=np.int64)
    barred = np.zeros(len(quads), dtype=bool)
    barred[pentagons] = True
    for row in range(len(quads) - 1, -1, -1):
        if first[row] != NONE:
            height[row] = 1 + max(height[first[row]], height[second[row]])
            barred[row] |= barred[first[row]] or barred[second[row]]
    levels = []
    places, by_area, areas = sampled_places(quads), node_weights(quads), frames.area
    for h in range(1, int(height.max(initial=0)) + 1):
        rows = np.flatnonzero((height == h) & ~barred)
        if not len(rows):
            continue
        pair = np.stack([first[rows], second[rows]], axis=1)
        own, half = (
            np.stack([monomials(frames.some(which[k]), places[pair[:, k]]) for k in (0, 1)], axis=1)
            for which in ((rows, rows), (pair[:, 0], pair[:, 1]))
        )
        weights = np.concatenate([areas[pair[:, k], None] * by_area[pair[:, k]] for k in (0, 1)], axis=1)
        roots = np.sqrt(weights / np.maximum(weights.max(axis=1, keepdims=True), 1e-300))[:, None]
        nodes = own[:, :, :NODES].reshape(len(rows), -1, TERMS)
        joined = np.linalg.pinv(nodes * roots.transpose(0, 2, 1), rcond=1e-9) * roots
        joins = np.stack([joined[:, :, NODES * k : NODES * (k + 1)] @ half[:, k, :NODES] for k in (0, 1)], axis=1)
        levels.append(Level(rows, pair, joins, np.linalg.pinv(half, rcond=1e-9) @ own))
    return Inner(tuple(levels), np.flatnonzero(barred))


def _compared() -> Array:
    """(25, TERMS): the terms of a cubic over the square of its variables."""
    u, v = (each.ravel() for each in np.meshgrid(_GRID, _GRID))
    return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v, u**3, u * u * v, u * v * v, v**3], axis=1)


_COMPARED: Final = _compared()
