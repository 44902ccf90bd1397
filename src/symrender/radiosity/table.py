"""What the faces of a scene send each other: direct light, and all that is reflected, as cubics on cells.

The irradiance H of a face is H0 + K(rho H): H0 is direct light, a closed form, and K gathers what faces send. Two
forests hold what is sent: one rho H0, cut where shadows and penumbrae begin, one rho K(rho H), which is smoother.

What the cubics are off is measured: at places that are no nodes, the first against the closed form, the second against
what is gathered there in the end, the residual of the equation. From these doubts d follows a bound of the error at any
place, u = K(d + rho u), gathered like light: for K adds up positive numbers only, and |e| <= |r| + K rho |e|. It is as
sure as the largest deviation that was sampled is the largest of its cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.radiometric.pieces import POLYGON
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import contacts, shadow_edges
from symrender.radiosity.cells import NODES, Quads, deviations, fitting, monomials, node_weights, sampled_places
from symrender.radiosity.endless import Laid
from symrender.radiosity.forest import (
    Doubts,
    Evaluate,
    Forest,
    Grown,
    Limits,
    doubts_of,
    grown,
    put_terms,
    root_cells,
    sampled,
)
from symrender.radiosity.gathered import ALONE, Places, direct, gather, gather_at
from symrender.radiosity.near import lamps, pieces_of
from symrender.radiosity.places import fill_reflects
from symrender.radiosity.records import BOUND, CHANNELS, NEVER, RULE, Ints
from symrender.radiosity.work import Work
from symrender.scene.radiometric.arrays import DIFFUSE

MOST_LIT: Final = 12_000
MOST_GATHERED: Final = 6_000
"""Most cells of the forests of direct and of reflected light."""
MOST_SHARP: Final = 40_000
"""The same of direct light where some shape is glossy."""
_SHARP: Final = 0.5
"""Part of the tolerance that direct light may be off anywhere where some shape is glossy."""
_TAIL: Final = 0.02
"""Part of the tolerance that may be left out at the end of the series."""
_MOST_TERMS: Final = 400
_REST: Final = 0.05
"""What may be left at the end of a bound's series, in parts of the bound."""
_LITTLE: Final = 0.1
"""Part of the target that is a bound large enough where planes have no end."""
_TRIES: Final = 4
_COARSE: Final = 4.0
"""Target of the first cells where light is reflected more than once, in parts of the tolerance."""
_ENOUGH: Final = 1.0
"""Part of the tolerance that is stated at ``_SHARE_MET`` of places of faces, where cells can be made fine enough.

Of pixels some 99 of 100 then state the tolerance or less."""
_AIM: Final = 0.9
"""The same of the next cells, where what was stated is too much."""
_FALLS: Final = 0.57
"""Power of the target with which what is stated falls, as long as nothing else is known of it."""
_SHARE_MET: Final = 0.9
_PARTS: Final = (0.25, 0.5, 0.75, 1.0)
"""Parts of the evaluations of a table up to which cells of direct light are halved, those of reflected light are,
reflections are added, and bounds are."""


@dataclass(frozen=True)
class Faces:
    """The sides of faces that reflect: ``face`` (N,), ``side`` (N,) and the most they reflect, ``albedo`` (N, 3)."""

    world: World
    face: Ints
    side: Array
    albedo: Array

    def of(self, face: Ints, places: Array) -> Array:
        """(M, 3): how faces that reflect do so at places."""
        found = np.zeros((len(places), CHANNELS))
        _reflects_kernel()(self.world, face, places, found)
        return found


def reflecting(world: World) -> Faces:
    """The sides of diffuse polygons that reflect anything."""
    face, side, albedo = [], [], []
    for j, piece in enumerate(world.pieces):
        material = world.materials[int(piece.material)]
        most = np.maximum(material.bright, material.dark)
        if piece.kind != POLYGON or material.kind != DIFFUSE or not most.any():
            continue
        for s in (1.0, -1.0) if material.two_sided else (1.0,):
            face.append(j)
            side.append(s)
            albedo.append(most)
    return Faces(world, np.array(face, dtype=np.int64), np.array(side), np.array(albedo).reshape(-1, 3))


@dataclass(frozen=True)
class Sendings:
    """What faces send: forests that are gathered together, and how ``fine`` the rule is that gathers them."""

    laid: Laid
    forests: tuple[Forest, ...]
    fine: float

    def gathered(self, owns: Ints, fronts: Ints, places: Array, work: Work = ALONE) -> Array:
        """(N, SUMS): what places of pieces gather, the bound, the rule's error and how many nodes it took."""
        return gather(self.laid, self.forests, owns, fronts, places, self.fine, work)

    def reflected(self, at: Places, fine: float, most: int) -> Array:
        """The same of places as they are seen, whose lobes weigh what they gather, of about ``most`` nodes each."""
        return gather_at(self.laid, self.forests, at, fine, most=most)

    def missed(self, owns: Ints, places: Array) -> Array:
        """(N,) most that diffuse places of pieces ``owns`` gather beside all cells: beyond nets, and along rims."""
        found = self.laid.missed(owns, places)
        return found + brightest(self.forests) * self.laid.rim_share(owns, places) if self.laid.rims else found


def brightest(forests: tuple[Forest, ...]) -> float:
    """A bound of what anything sends."""
    # what cells with halves hold may be far more, and is then not sent
    sent = [np.asarray(forest.cells["terms"])[forest.leaves] for forest in forests]
    return sum(float(np.abs(each).sum(axis=1).max(initial=0.0)) for each in sent)


def sendings(scene: Laid, bounces: bool, tol: float, work: Work = ALONE) -> Sendings:
    """What faces send to each other, for values to ``tol``, a radiance; ``bounces`` says whether more than once.

    Where ``work`` has evaluations for no more it is coarser, or lacks reflections, and doubts so much more.
    """
    net, piece = scene.net, scene.piece
    faces = reflecting(net)
    most = float(faces.albedo.max(initial=0.0))
    # a radiance is rho/pi times an irradiance, which is pi times what is gathered
    fine = 0.05 * tol / max(most, 1e-300)
    if not len(faces.face):
        return Sendings(scene, (), fine)
    roots = root_cells(net, faces.face, faces.side)
    near = roots.some(np.flatnonzero(scene.matters[roots.face] == 1.0))
    edges, shadows = _edges(scene, faces)

    def lit(face: Ints, side: Array, places: Array) -> tuple[Array, Array]:
        light = direct(scene.world, piece[face], side, places, work) / math.pi
        return faces.of(face, places) * light, np.zeros(len(places))

    cuts = [a + b for a, b in zip(edges, shadows, strict=True)]
    glossy = any(net.materials[int(each.material)].kind != DIFFUSE for each in net.pieces)
    target, limits = (_COARSE if bounces else 1.0) * tol, (MOST_SHARP if glossy else MOST_LIT, MOST_GATHERED)
    solver = _Solver(scene, faces, fine, work)
    falls, last, spent, best = _FALLS, (0.0, 0.0), work.spent, math.inf
    kept = Sendings(scene, (), fine)
    for _ in range(_TRIES):
        begun = spent.evaluations
        aim = min(target, _SHARP * tol) if glossy else target
        lit_by = Limits(aim, limits[0], scene.ended(lamps(net)), glossy, scene.matters, spent, _PARTS[0])
        first = _grown(scene, roots, cuts, lit, lit_by).forest
        made = Sendings(scene, (first,), fine)
        if bounces:
            ends = scene.ended(pieces_of(net))
            things = Limits(target, MOST_GATHERED, ends, False, scene.matters, spent, _PARTS[1])
            made = Sendings(scene, (first, solver.reflected(first, roots, edges, things)), fine)
        stated = most * np.quantile(_stated(made, near, work), _SHARE_MET)
        full = any(
            len(forest.cells) >= most_cells - 1 for forest, most_cells in zip(made.forests, limits, strict=False)
        )
        if stated < best or not kept.forests:
            kept, best = made, stated
        if stated <= _ENOUGH * tol or full:
            return made
        # finer cells take no less, and less than all of that
        if not spent.lasts(1.0, 2.0 * (spent.evaluations - begun)):
            break
        if last[0] > 0.0:
            falls = min(1.0, max(0.3, math.log(stated / last[1]) / math.log(target / last[0])))
        last = (target, stated)
        target *= max(1e-3, (_AIM * tol / stated) ** (1.0 / falls))
    return made if math.isinf(spent.most) else kept


def _edges(scene: Laid, faces: Faces) -> tuple[list[list[Array]], list[list[Array]]]:
    """Segments of the sides of faces in which others meet them, and those in which shadows begin."""
    net, disks = scene.net, scene.disks
    edges = [contacts(net, int(f), disks) for f in faces.face]
    owner, level = np.asarray(net.pieces["owner"])[faces.face], {disk.owner for disk in disks}
    shadows: list[list[Array]] = []
    known: dict[tuple[float, float], list[Array]] = {}
    for f, side, shape in zip(faces.face.tolist(), faces.side.tolist(), owner.tolist(), strict=True):
        # faces of the net of a disk have one plane
        found = known.get((shape, side))
        if found is None:
            found = shadow_edges(net, f, side, scene.netted, disks)
        if shape in level:
            known[shape, side] = found
        shadows.append(found)
    return edges, shadows


def _grown(scene: Laid, roots: Quads, cuts: list[list[Array]], evaluate: Evaluate, limits: Limits) -> Grown:
    """``grown`` on the net of a scene; cells belong to pieces of its world."""
    made = grown(scene.net, roots, cuts, evaluate, limits)
    faces = made.forest.cells["face"]
    faces[:] = scene.piece[np.asarray(faces).astype(np.int64)]
    return made


def _stated(made: Sendings, roots: Quads, work: Work) -> Array:
    """What is stated of light gathered at the places at which faces as a whole would be sampled."""
    places = sampled_places(roots)
    per = places.shape[1]
    fronts = np.repeat((roots.side > 0).astype(np.int64), per)
    sums = made.gathered(np.repeat(made.laid.piece[roots.face], per), fronts, places.reshape(-1, 3), work)
    return np.asarray(sums[:, BOUND] + sums[:, RULE])


@dataclass
class _Solver:
    """Who finds what faces reflect, starting from what is ``known`` on the cells of the last time."""

    laid: Laid
    faces: Faces
    fine: float
    work: Work
    known: tuple[Forest, ...] = ()

    @property
    def most(self) -> float:
        """The largest reflectance."""
        return float(self.faces.albedo.max(initial=0.0))

    def gathered(self, forests: tuple[Forest, ...]) -> Evaluate:
        """What places reflect of what forests send, and what the rule may be off."""

        def evaluate(face: Ints, side: Array, places: Array) -> tuple[Array, Array]:
            fronts = (side > 0).astype(np.int64)
            sums = gather(self.laid, forests, self.laid.piece[face], fronts, places, self.fine, self.work)
            return self.faces.of(face, places) * sums[:, :CHANNELS], self.most * sums[:, RULE]

        return evaluate

    def reflected(self, first: Forest, roots: Quads, edges: list[list[Array]], limits: Limits) -> Forest:
        """All reflections of what ``first`` sends, and what they may be off."""
        second = _grown(self.laid, roots, edges, self.gathered((first, *self.known)), limits)
        cells, rows = second.forest.cells, second.forest.leaves
        quads = second.quads.some(rows)
        places = sampled_places(quads)
        powers = monomials(second.frames.some(rows), places)
        fit = fitting(powers, node_weights(quads))
        self._iterate(first, second, places[:, :NODES], powers[:, :NODES], fit, limits.target)
        # the residual: what is gathered of both forests, less what the second holds
        values, off = sampled(quads, places, self.gathered((first, second.forest)))
        held = powers @ np.asarray(cells["terms"])[rows].reshape(len(rows), CHANNELS, -1).transpose(0, 2, 1)
        unseen = second.unseen[rows] + self.most * self.laid.missed_by(quads.face, quads.corners)
        doubts = Doubts(*deviations(powers, fit, values - held), off.max(axis=1) + unseen, off.mean(axis=1) + unseen)
        doubts.write(cells, rows)
        second.inner.write_doubts(cells)
        self._bound(first, second, quads, places, limits.target)
        self.known = (second.forest,)
        return second.forest

    def _iterate(
        self, first: Forest, second: Grown, nodes: Array, powers: Array, fit: Array, target: float
    ) -> None:  # fmt: skip
        """Fill the second forest with all reflections, from what it holds on."""
        cells, rows, most = second.forest.cells, second.forest.leaves, self.most
        quads = second.quads.some(rows)
        total = np.asarray(cells["terms"])[rows].reshape(len(rows), CHANNELS, -1).copy()
        term, before = total, (powers @ total.transpose(0, 2, 1)).reshape(-1, CHANNELS)
        # without something known the second forest holds the first term of the series, else all but a residual of it
        missing, spent = bool(self.known), self.work.spent
        for _ in range(_MOST_TERMS):
            begun = spent.evaluations
            put_terms(cells, rows, term)
            second.inner.write(cells)
            values, _ = sampled(quads, nodes, self.gathered((first, second.forest) if missing else (second.forest,)))
            now = values.reshape(-1, CHANNELS)
            if missing:
                now, before = now - before, np.zeros_like(before)
            missing = False
            term = np.ascontiguousarray((fit @ now.reshape(values.shape)).transpose(0, 2, 1))
            total = total + term
            # what follows a term that is a multiple of the one before is a geometric series
            ratio = np.clip((now * before).sum(axis=0) / np.maximum((before**2).sum(axis=0), 1e-300), 0.0, most)
            off = np.abs(now - ratio * before).max(initial=0.0)
            before = now
            # what is left out is part of the residual
            lasts = spent.lasts(_PARTS[2], spent.evaluations - begun)
            if float(off) * most / (1.0 - most) < _TAIL * target or not lasts:
                total += term * (ratio / (1.0 - ratio))[None, :, None]
                break
        put_terms(cells, rows, total)
        second.inner.write(cells)

    def _bound(self, first: Forest, second: Grown, quads: Quads, places: Array, target: float) -> None:
        """Add to what the leaves of the second forest doubt what follows from it, u = rho K(d + u)."""
        rows, cells = second.forest.leaves, second.forest.cells
        few = np.ascontiguousarray(places[:, [0, 3, 12, 15, NODES + 4]])
        face = np.repeat(self.laid.piece[quads.face], few.shape[1])
        fronts = np.repeat((quads.side > 0).astype(np.int64), few.shape[1])
        doubts, none = doubts_of(cells, rows), np.zeros(len(rows))
        # bounds alone are gathered: what varies within a cell asks for no finer rule
        forests: tuple[Forest, ...] = (first, second.forest)
        both = forests
        spreads = [forest.cells["spread"].copy() for forest in both]
        for forest in both:
            forest.cells["spread"][:] = 0.0
        rough = cells["rough"].copy()
        grows = np.zeros((len(rows), few.shape[1]))
        before: Array | None = None
        # a cell sends on what it gathers by its own reflectance
        reflects = (
            self.faces.of(np.repeat(quads.face, few.shape[1]), few.reshape(-1, 3)).max(axis=1).reshape(-1, few.shape[1])
        )
        spent = self.work.spent
        for _ in range(_MOST_TERMS):
            begun = spent.evaluations
            sums = gather(self.laid, forests, face, fronts, few.reshape(-1, 3), self.fine, self.work)
            more = reflects * sums[:, BOUND].reshape(-1, few.shape[1])
            grows += more
            rest = _rest(more.max(axis=1), before, self.most)[:, None]
            # cells far out on planes doubt much, of which little arrives: their largest is no measure of others
            enough = np.maximum(grows, _LITTLE * target) if self.laid.beyond else grows.max(initial=0.0)
            if (rest <= _REST * enough).all() or not spent.lasts(_PARTS[3], spent.evaluations - begun):
                grows += rest
                break
            before = more.max(axis=1) if self.laid.beyond else None
            # bounds are joined as they are: no cubic stands for them
            forests = (second.forest,)
            cells["rough"][:] = np.where(rough < NEVER, 0.0, rough)
            Doubts(none, none, none, more.max(axis=1), more.mean(axis=1)).write(cells, rows)
            second.inner.write_doubts(cells)
        for forest, spread in zip(both, spreads, strict=True):
            forest.cells["spread"][:] = spread
        cells["rough"][:] = rough
        drift, haze = doubts.drift + grows.max(axis=1), doubts.haze + grows.mean(axis=1)
        Doubts(doubts.doubt, doubts.bulk, doubts.even, drift, haze).write(cells, rows)
        second.inner.write_doubts(cells)


def _rest(now: Array, before: Array | None, most: float) -> Array:
    """(N,) bound of what follows the term ``now`` of a series, in which the next term is at most ``most`` of one.

    A gather adds up positive numbers only: if no term is more than q of the one ``before`` of its own cell, none will
    be, and what follows is q/(1 - q) of it.
    """
    rest = np.full(len(now), float(now.max(initial=0.0)) * most / (1.0 - most))
    if before is None or (now[before <= 0.0] > 0.0).any():
        return rest
    ratio = float((now / np.where(before > 0.0, before, 1.0)).max(initial=0.0))
    return np.minimum(rest, now * ratio / (1.0 - ratio)) if ratio < 1.0 else rest


@lru_cache(maxsize=1)
def _reflects_kernel() -> Any:
    return compiled(fill_reflects, _nrt=False)
