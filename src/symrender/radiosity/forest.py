"""Trees of cells: the sides of all faces, cut where light is not smooth, halved where cubics do not hold it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from symrender.jit.records import Table, table
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.cells import (
    NODES,
    Frames,
    Quads,
    cut_along,
    deviations,
    fitting,
    frames_of,
    halves,
    joined,
    monomials,
    node_weights,
    sampled_places,
)
from symrender.radiosity.fields import field_lines
from symrender.radiosity.inner import Inner, inner_of
from symrender.radiosity.near import Thing, too_large
from symrender.radiosity.records import CHANNELS, NONE, Cell, Ints
from symrender.radiosity.work import Spent

Evaluate = Callable[[Ints, Array, Array], tuple[Array, Array]]
"""``evaluate(face, side, places)`` of M places: what they send (M, CHANNELS), and what that may be off (M,)."""

SMALLEST: Final = 1e-7
"""Area of a cell, in parts of its face, below which it is not halved."""
CUTS: Final = 4000
"""Most cells a forest is cut into along segments."""


@dataclass(frozen=True)
class Forest:
    """Cells in a table whose first rows are the ``roots``; ``leaves`` are the rows of leaves."""

    cells: Table[Cell]
    roots: Ints
    leaves: Ints


@dataclass(frozen=True)
class Grown:
    """A forest and what its cells are filled by: their ``quads`` and ``frames``.

    ``unseen`` is the part of their doubt that stands for what no sample may have met; ``inner`` are those with halves.
    """

    forest: Forest
    quads: Quads
    frames: Frames
    unseen: Array
    inner: Inner


@dataclass
class _Growing:
    """Rows of a forest that grows: parts of what will be its arrays, and the children of every row."""

    parts: list[Quads] = field(default_factory=list)
    first: list[int] = field(default_factory=list)
    second: list[int] = field(default_factory=list)
    pentagons: dict[int, Array] = field(default_factory=dict)

    def add(self, quads: Quads) -> Ints:
        """Add cells; returns their rows."""
        begin = len(self.first)
        self.parts.append(quads)
        self.first += [NONE] * len(quads)
        self.second += [NONE] * len(quads)
        return np.arange(begin, len(self.first))


def root_cells(world: World, faces: Ints, sides: Array) -> Quads:
    """The sides of faces as cells."""
    corners = np.array([np.asarray(world.pieces[int(j)].corners).reshape(4, 3) for j in faces]).reshape(-1, 4, 3)
    count = np.array([int(world.pieces[int(j)].count) for j in faces], dtype=np.int64)
    corners[count == 3, 3] = corners[count == 3, 2]
    return Quads(faces.astype(np.int64), sides, count, corners)


@dataclass(frozen=True)
class Limits:
    """A cell is halved while its largest deviation, times the root of its share of its face, is over ``target``.

    With ``anywhere`` the share has no part in it: what is glossy may see one cell alone. A cell is halved, too, while
    it is too large for one of the ``things`` near it; but only while there are fewer than ``most``.
    """

    target: float
    most: int
    things: list[Thing]
    anywhere: bool = False
    matters: Array | None = None
    """(pieces,) what deviations on each face count, where some face is seen from far away alone; else all count 1."""
    spent: Spent = field(default_factory=Spent)
    part: float = 1.0
    """Part of what may be spent after which no cell is halved."""


def grown(world: World, roots: Quads, segments: list[list[Array]], evaluate: Evaluate, limits: Limits) -> Grown:
    """The forest of ``roots``, cut along the ``segments`` of each and its texture's, then halved as ``limits`` say."""
    growing = _Growing()
    growing.add(roots)
    ups = np.array([world.pieces[int(j)].up for j in roots.face]).reshape(-1, 3)
    whole = frames_of(roots, ups).area
    face_area = dict(zip(roots.face.tolist(), whole.tolist(), strict=True))
    trees = [{row: roots.corners[row][: int(roots.count[row])]} for row in range(len(roots))]
    for row, tree in enumerate(trees):
        _cut_tree(growing, row, tree, field_lines(world, int(roots.face[row])), ups[row], None)
    for row, tree in enumerate(trees):
        _cut_tree(growing, row, tree, segments[row], ups[row], CUTS)
    quads = joined(growing.parts)
    fresh = np.arange(len(quads))
    unseen: list[Array] = []
    begun = limits.spent.evaluations
    held: list[tuple[Array, Array, Array, Array]] = []
    while len(fresh):
        some = quads.some(fresh)
        frames = frames_of(some, _ups(world, some))
        places = sampled_places(some)
        values, off = sampled(some, places, evaluate)
        powers = monomials(frames, places)
        fit = fitting(powers, node_weights(some))
        made = fit @ values[:, :NODES]
        missed, bulk, even = deviations(powers, fit, values - powers @ made)
        off = off.max(axis=1)
        held.append((np.ascontiguousarray(made.transpose(0, 2, 1)), missed + off, bulk + off, even + off))
        leaf = np.array([growing.first[row] == NONE for row in fresh], dtype=bool)
        share = frames.area / np.array([face_area[f] for f in some.face.tolist()])
        large, covered = too_large(limits.things, some, frames)
        urgency = missed * (1.0 if limits.anywhere else np.sqrt(share)) / max(limits.target, 1e-300)
        if limits.matters is not None:
            urgency *= limits.matters[some.face]
        urgency += large
        room = (limits.most - len(quads)) // 2
        if not math.isinf(limits.spent.most):
            # halves are expected to take what cells took so far
            each = (limits.spent.evaluations - begun) / len(quads)
            rest = limits.part * limits.spent.most - limits.spent.evaluations
            room = min(room, max(0, int(rest / max(2.0 * each, 1.0))))
        chosen = np.flatnonzero(leaf & ((urgency > 1.0) | large) & (share > SMALLEST))
        if len(chosen) > room:
            order = np.argsort(-urgency[chosen], kind="stable")
            chosen = np.sort(chosen[order[: max(room, 0)]])
        covered[chosen] = 0.0
        unseen.append(covered)
        one, two = halves(some.some(chosen), values[chosen])
        rows = growing.add(one), growing.add(two)
        for parent, a, b in zip(fresh[chosen].tolist(), rows[0].tolist(), rows[1].tolist(), strict=True):
            growing.first[parent], growing.second[parent] = a, b
        fresh = np.concatenate(rows)
        quads = joined([quads, one, two])
    terms, doubt, bulk, even = (np.concatenate(parts) for parts in zip(*held, strict=True))
    # what no sample may have met changes a cell by no more than the most that anything sends
    missing = np.concatenate(unseen) * float(np.abs(terms[:, :, 0]).max(initial=0.0))
    return _laid(world, growing, quads, len(roots), (terms, Doubts(doubt, bulk, even, missing, missing)))


def sampled(quads: Quads, places: Array, evaluate: Evaluate) -> tuple[Array, Array]:
    """(values (N, P, CHANNELS), their errors (N, P)) of cells at places (N, P, 3)."""
    per = places.shape[1]
    values, off = evaluate(np.repeat(quads.face, per), np.repeat(quads.side, per), places.reshape(-1, 3))
    return values.reshape(-1, per, CHANNELS), off.reshape(-1, per)


def _ups(world: World, quads: Quads) -> Array:
    return np.asarray(world.pieces["up"])[quads.face]


def _cut_tree(
    growing: _Growing, root: int, polygons: dict[int, Array], segments: list[Array], up: Array, most: int | None
) -> None:  # fmt: skip
    """Cut a root, whose rows are ``polygons``, along segments, one after the other, each leaf that it passes through.

    No more is cut once there are ``most`` cells.
    """
    first = growing.parts[0].some(np.array([root]))
    face, side = first.face, first.side
    for segment in segments:
        for row in [row for row in polygons if growing.first[row] == NONE]:
            if most is not None and len(growing.first) > most:
                return
            parts = cut_along(polygons[row], segment, up)
            if parts is None or len(parts) < 2:
                continue
            rows = []
            for part in parts:
                rows.append(_add_polygon(growing, polygons, part, face, side))
            growing.first[row], growing.second[row] = rows


def _add_polygon(growing: _Growing, polygons: dict[int, Array], polygon: Array, face: Ints, side: Array) -> int:
    """Add a convex polygon as a cell, one of five corners with two halves; returns its row."""
    row = int(growing.add(_quad(polygon[:4], face, side))[0])
    polygons[row] = polygon
    if len(polygon) > 4:
        growing.pentagons[row] = polygon
        pair = [_add_polygon(growing, polygons, part, face, side) for part in (polygon[:4], polygon[[0, 3, 4]])]
        growing.first[row], growing.second[row] = pair
    return row


def _quad(polygon: Array, face: Ints, side: Array) -> Quads:
    corners = polygon if len(polygon) == 4 else np.concatenate([polygon, polygon[-1:]])
    return Quads(face, side, np.array([len(polygon)]), corners[None])


@dataclass(frozen=True)
class Doubts:
    """What N leaves may be off: the largest ``doubt`` of a deviation, its mean modulus ``bulk``, its ``even`` part.

    ``drift`` is the largest and ``haze`` the mean of what is off anywhere and alike.
    """

    doubt: Array
    bulk: Array
    even: Array
    drift: Array
    haze: Array

    def some(self, which: Ints) -> Doubts:
        """Those of ``which``."""
        return Doubts(*(each[which] for each in (self.doubt, self.bulk, self.even, self.drift, self.haze)))

    def write(self, cells: Table[Cell], rows: Ints) -> None:
        """Write them into leaves."""
        for name in ("doubt", "bulk", "even", "drift", "haze"):
            cells[name][rows] = getattr(self, name)


def doubts_of(cells: Table[Cell], rows: Ints) -> Doubts:
    """What leaves may be off."""
    return Doubts(*(np.asarray(cells[name])[rows].copy() for name in ("doubt", "bulk", "even", "drift", "haze")))


def _laid(world: World, growing: _Growing, quads: Quads, roots: int, found: tuple[Array, Doubts]) -> Grown:
    """The forest as records; ``found`` are terms and what they doubt."""
    terms, doubts = found
    frames = frames_of(quads, _ups(world, quads))
    cells = table(Cell, len(quads))
    for name in ("middle", "across", "along", "reach", "area"):
        cells[name][:] = getattr(frames, name)
    cells["face"][:], cells["side"][:], cells["count"][:] = quads.face, quads.side, quads.count
    cells["first"][:], cells["second"][:] = growing.first, growing.second
    cells["corners"][:, :12] = quads.corners.reshape(-1, 12)
    # from the last on, so that halves of five corners are known
    for row in sorted(growing.pentagons, reverse=True):
        cell, polygon = cells[row], growing.pentagons[row]
        middle = polygon.mean(axis=0)
        cell.count, cell.corners[:], cell.middle[:] = 5, polygon.reshape(-1), middle
        cell.reach = np.sqrt(((polygon - middle) ** 2).sum(axis=1)).max()
        cell.area = sum(cells["area"][child] for child in (growing.first[row], growing.second[row]))
    first, second = np.array(growing.first), np.array(growing.second)
    leaves = np.flatnonzero(first == NONE)
    inner = inner_of(quads, frames, first, second, np.array(sorted(growing.pentagons), dtype=np.int64))
    put_terms(cells, np.arange(len(quads)), terms)
    inner.write(cells)
    doubts.some(leaves).write(cells, leaves)
    inner.write_doubts(cells)
    return Grown(Forest(cells, np.arange(roots), leaves), quads, frames, doubts.drift, inner)


def put_terms(cells: Table[Cell], rows: Ints, terms: Array) -> None:
    """Write the cubics (N, CHANNELS, TERMS) of cells."""
    cells["terms"][rows] = terms.reshape(len(rows), -1)
    cells["spread"][rows] = np.abs(terms[..., 1:]).sum(axis=2).max(axis=1, initial=0.0)
