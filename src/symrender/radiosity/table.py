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
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.radiometric.pieces import POLYGON
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import contacts, shadow_edges
from symrender.radiosity.cells import NODES, Frames, Quads, monomials, sampled_places
from symrender.radiosity.forest import Forest, Limits, grown, put_terms, root_cells, sampled
from symrender.radiosity.gather import gather_places
from symrender.radiosity.near import lamps, pieces_of
from symrender.radiosity.places import fill_lit
from symrender.radiosity.records import BOUND, CHANNELS, RULE, SUMS, Ints, make_scratch
from symrender.scene.radiometric.arrays import DIFFUSE

MOST_LIT: Final = 12_000
MOST_GATHERED: Final = 6_000
"""Most cells of the forests of direct and of reflected light."""
MOST_SHARP: Final = 40_000
"""The same of direct light where some shape is glossy."""
_SHARP: Final = 0.5
"""Part of the tolerance that direct light may be off anywhere where some shape is glossy."""
_CHUNK: Final = 256
_TAIL: Final = 0.02
"""Part of the tolerance that may be left out at the end of the series."""
_MOST_TERMS: Final = 400
_TRIES: Final = 3
_AIM: Final = 0.5
"""Part of the tolerance that is stated at ``_SHARE_MET`` of places, where the forests can be made fine enough."""
_SHARE_MET: Final = 0.9


@dataclass(frozen=True)
class Faces:
    """The sides of faces that reflect: ``face`` (N,), ``side`` (N,) and how they reflect, ``albedo`` (N, 3)."""

    face: Ints
    side: Array
    albedo: Array


def reflecting(world: World) -> Faces:
    """The sides of diffuse polygons that reflect anything."""
    face, side, albedo = [], [], []
    for j, piece in enumerate(world.pieces):
        material = world.materials[int(piece.material)]
        if piece.kind != POLYGON or material.kind != DIFFUSE or not material.bright.any():
            continue
        for s in (1.0, -1.0) if material.two_sided else (1.0,):
            face.append(j)
            side.append(s)
            albedo.append(material.bright.copy())
    return Faces(np.array(face, dtype=np.int64), np.array(side), np.array(albedo).reshape(-1, 3))


@dataclass(frozen=True)
class Sendings:
    """What faces send: forests that are gathered together, and how ``fine`` the rule is that gathers them."""

    world: World
    forests: tuple[Forest, ...]
    fine: float

    def gathered(self, owns: Ints, fronts: Ints, places: Array, threads: int = 1) -> Array:
        """(N, SUMS): what places of pieces gather, the bound, the rule's error and how many nodes it took."""
        return gather(self.world, self.forests, owns, fronts, places, self.fine, threads)

    def reflected(self, at: Places, fine: float) -> Array:
        """The same of places as they are seen, whose lobes weigh what they gather."""
        return gather_at(self.world, self.forests, at, fine)


@dataclass(frozen=True)
class Places:
    """Places that gather: pieces ``own`` and whether their ``front`` (N,), then (N, 3) arrays.

    ``normal`` and the way to who looks, ``view``, are unit.
    """

    own: Ints
    front: Ints
    place: Array
    normal: Array
    view: Array

    def some(self, which: Ints) -> Places:
        """Those of ``which``."""
        return Places(self.own[which], self.front[which], self.place[which], self.normal[which], self.view[which])


def gather(
    world: World, forests: tuple[Forest, ...], owns: Ints, fronts: Ints, places: Array, fine: float, threads: int = 1
) -> Array:  # fmt: skip
    """(N, SUMS) of ``gather_places`` for places of flat pieces, over all forests."""
    normals = np.asarray(world.pieces["up"])[owns] * np.where(fronts > 0, 1.0, -1.0)[:, None]
    return gather_at(world, forests, Places(owns, fronts, places, normals, normals), fine, threads)


def gather_at(world: World, forests: tuple[Forest, ...], at: Places, fine: float, threads: int = 1) -> Array:
    """(N, SUMS) of ``gather_places``, over all forests."""
    sums = np.zeros((len(at.own), SUMS))

    def run(begin: int) -> None:
        part = slice(begin, min(begin + _CHUNK, len(at.own)))
        some = (at.own[part], at.front[part], at.place[part], at.normal[part], at.view[part])
        for forest in forests:
            scratch = make_scratch(len(world.pieces), len(forest.cells))
            _gather_kernel()(world, forest.cells, forest.roots, *some, fine, scratch, sums[part])

    in_parts(run, len(at.own), threads)
    return sums


def in_parts(run: Callable[[int], None], count: int, threads: int) -> None:
    """Call ``run`` with the beginning of every part of ``count`` places."""
    begins = range(0, count, _CHUNK)
    threads = threads or os.cpu_count() or 1
    if threads == 1 or len(begins) < 2:
        for begin in begins:
            run(begin)
        return
    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in pool.map(run, begins):
                pass
        except BaseException:
            # what waits is dropped, so that Ctrl-C is heard within a part
            pool.shutdown(cancel_futures=True)
            raise


def sendings(world: World, bounces: bool, tol: float, threads: int = 1) -> Sendings:
    """What faces send to each other, for values to ``tol``, a radiance; ``bounces`` says whether more than once."""
    faces = reflecting(world)
    most = float(faces.albedo.max(initial=0.0))
    # a radiance is rho/pi times an irradiance, which is pi times what is gathered
    fine = 0.05 * tol / max(most, 1e-300)
    if not len(faces.face):
        return Sendings(world, (), fine)
    roots = root_cells(world, faces.face, faces.side)
    albedo = {(int(f), float(s)): a for f, s, a in zip(faces.face, faces.side, faces.albedo, strict=True)}
    edges = [contacts(world, int(f)) for f in faces.face]
    shadows = [shadow_edges(world, int(f), float(s)) for f, s in zip(faces.face, faces.side, strict=True)]

    def reflect(face: Ints, side: Array, light: Array) -> Array:
        each = np.array([albedo[int(f), float(s)] for f, s in zip(face, side, strict=True)]).reshape(-1, 3)
        return each * light

    def lit(face: Ints, side: Array, places: Array) -> tuple[Array, Array]:
        light = direct(world, face, side, places, threads) / math.pi
        return reflect(face, side, light), np.zeros(len(places))

    def indirect(face: Ints, side: Array, places: Array) -> tuple[Array, Array]:
        sums = gather(world, (first,), face, (side > 0).astype(np.int64), places, fine, threads)
        return reflect(face, side, sums[:, :CHANNELS]), most * sums[:, RULE]

    cuts = [a + b for a, b in zip(edges, shadows, strict=True)]
    glossy = any(world.materials[int(piece.material)].kind != DIFFUSE for piece in world.pieces)
    target, limits = tol, (MOST_SHARP if glossy else MOST_LIT, MOST_GATHERED)
    for _ in range(_TRIES):
        aim = min(target, _SHARP * tol) if glossy else target
        first = grown(world, roots, cuts, lit, Limits(aim, limits[0], lamps(world), glossy))
        made = Sendings(world, (first,), fine)
        if bounces:
            second = grown(world, roots, edges, indirect, Limits(target, MOST_GATHERED, pieces_of(world)))
            _iterate(world, first, second, reflect, most, fine, target, threads)
            made = Sendings(world, (first, second), fine)
        stated = most * np.quantile(_stated(made, roots, threads), _SHARE_MET)
        full = any(
            len(forest.cells) >= most_cells - 1 for forest, most_cells in zip(made.forests, limits, strict=False)
        )
        if stated <= _AIM * tol or full:
            break
        target *= _AIM * tol / stated
    return made


def _stated(made: Sendings, roots: Quads, threads: int) -> Array:
    """What is stated of light gathered at the places at which faces as a whole would be sampled."""
    places = sampled_places(roots)
    per = places.shape[1]
    fronts = np.repeat((roots.side > 0).astype(np.int64), per)
    sums = made.gathered(np.repeat(roots.face, per), fronts, places.reshape(-1, 3), threads)
    return np.asarray(sums[:, BOUND] + sums[:, RULE])


def direct(world: World, face: Ints, side: Array, places: Array, threads: int) -> Array:
    """(N, 3): the irradiance by all lights of places of faces."""
    found = np.zeros((len(places), CHANNELS))
    fronts = (side > 0).astype(np.int64)

    def run(begin: int) -> None:
        part = slice(begin, min(begin + _CHUNK, len(places)))
        _lit_kernel()(world, face[part], fronts[part], places[part], sky_room(world), found[part])

    in_parts(run, len(places), threads)
    return found


def _iterate(
    world: World, first: Forest, second: Forest, reflect: Any, most: float, fine: float, tol: float, threads: int
) -> None:  # fmt: skip
    """Fill the second forest with all reflections, and with what they may be off."""
    rows = second.leaves
    quads = second.quads.some(rows)
    places = sampled_places(quads)
    powers = monomials(_some(second, rows), places)
    nodes = places[:, :NODES]
    # rows with halves are never used: what they would send is not kept
    inner = np.setdiff1d(np.arange(len(second.cells)), rows)
    second.cells["doubt"][inner] = 1e300
    second.cells["doubt"][rows], second.cells["drift"][rows] = 0.0, 0.0
    term = np.asarray(second.cells["terms"])[rows].reshape(len(rows), CHANNELS, -1).copy()
    total = term.copy()
    solver = np.linalg.pinv(powers[:, :NODES], rcond=1e-9)

    def step(face: Ints, side: Array, at: Array) -> tuple[Array, Array]:
        sums = gather(world, (second,), face, (side > 0).astype(np.int64), at, fine, threads)
        return reflect(face, side, sums[:, :CHANNELS]), most * sums[:, RULE]

    before = (powers[:, :NODES] @ term.transpose(0, 2, 1)).reshape(-1, CHANNELS)
    for _ in range(_MOST_TERMS):
        put_terms(second.cells, rows, term)
        values, _ = sampled(quads, nodes, step)
        term = np.ascontiguousarray((solver @ values).transpose(0, 2, 1))
        total += term
        now = values.reshape(-1, CHANNELS)
        # what follows a term that is a multiple of the one before is a geometric series
        ratio = np.clip((now * before).sum(axis=0) / np.maximum((before**2).sum(axis=0), 1e-300), 0.0, most)
        off = np.abs(now - ratio * before).max(initial=0.0)
        before = now
        if float(off) * most / (1.0 - most) < _TAIL * tol:
            total += term * (ratio / (1.0 - ratio))[None, :, None]
            break
    put_terms(second.cells, rows, total)

    # the residual: what is gathered of both forests, less what the second holds
    def both(face: Ints, side: Array, at: Array) -> tuple[Array, Array]:
        sums = gather(world, (first, second), face, (side > 0).astype(np.int64), at, fine, threads)
        return reflect(face, side, sums[:, :CHANNELS]), most * sums[:, RULE]

    values, off = sampled(quads, places, both)
    held = powers @ total.transpose(0, 2, 1)
    second.cells["doubt"][rows] = np.abs(held - values).max(axis=(1, 2), initial=0.0)
    second.cells["drift"][rows] = off + second.unseen[rows]
    _bound(world, first, second, quads, places, most, fine, threads)


def _bound(
    world: World, first: Forest, second: Forest, quads: Quads, places: Array, most: float, fine: float, threads: int
) -> None:  # fmt: skip
    """Add to what the leaves of the second forest doubt what follows from it, u = rho K(d + u)."""
    rows = second.leaves
    few = np.ascontiguousarray(places[:, [0, 3, 12, 15, NODES + 4]])
    face, fronts = np.repeat(quads.face, few.shape[1]), np.repeat((quads.side > 0).astype(np.int64), few.shape[1])
    own, drift = second.cells["doubt"][rows].copy(), second.cells["drift"][rows].copy()
    # bounds alone are gathered: what varies within a cell asks for no finer rule
    spreads = [forest.cells["spread"].copy() for forest in (first, second)]
    for forest in (first, second):
        forest.cells["spread"][:] = 0.0
    grows = np.zeros((len(rows), few.shape[1]))
    # a cell sends on what it gathers by its own reflectance
    faces = reflecting(world)
    each = {(int(f), float(s)): a.max() for f, s, a in zip(faces.face, faces.side, faces.albedo, strict=True)}
    reflects = np.array([each[int(f), float(s)] for f, s in zip(quads.face, quads.side, strict=True)])[:, None]
    forests: tuple[Forest, ...] = (first, second)
    for _ in range(_MOST_TERMS):
        sums = gather(world, forests, face, fronts, few.reshape(-1, 3), fine, threads)
        forests = (second,)
        more = reflects * sums[:, BOUND].reshape(-1, few.shape[1])
        grows += more
        # what is more than the mean of a cell counts as its deviations do
        mean = more.mean(axis=1)
        second.cells["doubt"][rows], second.cells["drift"][rows] = more.max(axis=1, initial=0.0) - mean, mean
        largest = float(more.max(initial=0.0)) * most / (1.0 - most)
        if largest <= 0.05 * float(grows.max(initial=0.0)):
            grows += largest
            break
    for forest, spread in zip((first, second), spreads, strict=True):
        forest.cells["spread"][:] = spread
    mean = grows.mean(axis=1)
    second.cells["doubt"][rows] = own + grows.max(axis=1, initial=0.0) - mean
    second.cells["drift"][rows] = drift + mean


def _some(forest: Forest, rows: Ints) -> Frames:
    f = forest.frames
    return Frames(f.middle[rows], f.across[rows], f.along[rows], f.reach[rows], f.area[rows])


@lru_cache(maxsize=1)
def _gather_kernel() -> Any:
    return compiled(gather_places, _nrt=False)


@lru_cache(maxsize=1)
def _lit_kernel() -> Any:
    return compiled(fill_lit, _nrt=False)
