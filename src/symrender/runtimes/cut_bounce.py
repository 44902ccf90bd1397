"""The light of one bounce where walls are of no known shape: every place an eye whose windows are cut as pixels are."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, chosen, copied, table
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric.bounds import Bound, laid_bounds
from symrender.radiometric.pieces import CORNERS, POLYGON, Piece
from symrender.radiometric.pixels import places, walls
from symrender.radiometric.pixels.records import Family, Wall, make_queue, make_room
from symrender.radiometric.shaken import shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_worlds
from symrender.runtimes.bounce import SHARE, SLACK, ULP, Bounced, doubted, sharpness
from symrender.runtimes.budgets import beside, by_share
from symrender.runtimes.pixels import MOST_WALLS, mean_world
from symrender.scene.arrays import SOLID
from symrender.scene.radiometric.arrays import DIFFUSE, DISK, SPHERE, RadiometricArrays

Ints = npt.NDArray[np.int64]


class Met(NamedTuple):
    """Where N rays meet pieces: ``piece`` (N,), -1 for none; (N, 3) ``place``, unit normals and ``albedo``.

    ``facing`` is the normal of the piece towards the ray, ``turned`` that by which it reflects. ``shows`` (N,) is 1
    where light is sent back, 0 where what is seen is black, -1 where nothing is known.
    """

    piece: Ints
    place: Array
    facing: Array
    turned: Array
    albedo: Array
    shows: Array

    def some(self, which: Ints) -> Met:
        """Those of ``which``."""
        rows = (self.place[which], self.facing[which], self.turned[which], self.albedo[which])
        return Met(self.piece[which], *rows, self.shows[which])


class CutBouncer:
    """A scene with the scratch of one thread; ``sent`` answers for rays, as ``Bouncer.sent`` does.

    Choose it where no faster rule knows what a scene holds: under points, spots and directional lights it knows all
    shapes and materials that pixels are cut at, and bumps. It takes some ten times as long as the split rule where
    both know a scene, and of what it does not resolve within its budget it states the bound of the light that may be
    there.
    """

    def __init__(self, arrays: RadiometricArrays) -> None:
        self._worlds = make_worlds(shaken(arrays))
        self._world = self._worlds[0]
        self._senders = _senders(self._world, bool(arrays.first_gloss))
        self._mean = mean_world(self._senders)
        self._sights: dict[int, World] = {}
        # out of every ball more of their outlines are walls than from within
        eye = 4.0 * (1.0 + _extent(self._world)) * np.array([1.0, 0.7, 0.4])
        count = _kernel("list_walls")(self._world, eye, table(Wall, 0)) + 1
        if count > MOST_WALLS:
            raise Unsupported(f"places are cut at {MOST_WALLS} walls at most, this scene has {count}")
        families = _kernel("list_families")(self._world, eye, table(Family, 0))
        self._walls, self._families = table(Wall, count), table(Family, families)
        self._room, self._queue = make_room(self._world, keeps=True), make_queue(count)
        self._sharpness = max(float(sharpness(m, np.ones(1))[0]) for m in arrays.materials)

    def sent(self, rays: list[tuple[Array, Array]], tol: float, budget: int) -> Bounced:
        """One bounce of light along rays, each to ``tol``, absolute, or ``budget`` evaluations.

        ``rays`` are origins and unit directions (N, 3), as they are and as they go with the scenes of ``shaken``: where
        those meet another shape, or another part of a texture, the error says what that changes.
        """
        first, *others = (_met(world, *pair) for world, pair in zip(self._worlds, rays, strict=True))
        found = self._light(first, rays[0][1], tol, budget)
        doubts = [np.zeros(len(found.error))]
        elsewhere = [np.flatnonzero((first.piece != each.piece) | (first.shows != each.shows)) for each in others]
        shares = beside(budget, found.evaluations, elsewhere)
        for other, rays_there in zip(others, elsewhere, strict=True):

            def ask(some: Ints, share: int, at: Met = other) -> Bounced:
                return self._light(at.some(some), rays[0][1][some], tol, share)

            again = by_share(ask, rays_there, shares)
            doubts.append(doubted(found, np.abs(other.albedo - first.albedo), rays_there, again))
        return replace(found, error=found.error + np.max(doubts, axis=0))

    def _light(self, met: Met, travel: Array, tol: float, budget: int) -> Bounced:
        """One bounce of light at places."""
        count = len(met.piece)
        found = Bounced(
            np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64)
        )
        unknown = met.shows < 0.0
        found.status[unknown], found.error[unknown] = UNSUPPORTED, np.inf
        work = (met.shows > 0.0) & (met.albedo.max(axis=1) > 0.0)
        for own in np.unique(met.piece[work]).tolist():
            some = np.flatnonzero(work & (met.piece == own))
            place, facing, turned, albedo = (
                np.ascontiguousarray(each[some]) for each in (met.place, met.facing, met.turned, met.albedo)
            )
            light, error, spent = np.zeros((len(some), 3)), np.zeros(len(some)), np.zeros(len(some), np.int64)
            _kernel("fill_sent")(
                self._senders, self._mean, self._sight(own), own, place, facing, turned, -travel[some], albedo,
                SHARE * tol, budget, self._walls, self._families, self._queue, self._room, light, error, spent,
            )  # fmt: skip
            error += self._roundings(own, place) * light.max(axis=1)
            found.indirect[some], found.error[some], found.evaluations[some] = light, error, spent
            found.incoming[some] = light / np.maximum(albedo, 1e-300)
        lost = ~np.isfinite(found.error) | ~np.isfinite(found.indirect).all(axis=1)
        found.indirect[lost], found.incoming[lost], found.error[lost] = 0.0, 0.0, np.inf
        found.status[found.error > tol] = np.maximum(found.status[found.error > tol], CAPPED)
        found.status[lost] = UNSUPPORTED
        return found

    def _roundings(self, own: int, place: Array) -> Array:
        """(N,) part of its light that roundings may have moved at places of a piece."""
        size, nearest = np.abs(place).max(axis=1), np.full(len(place), np.inf)
        for j, piece in enumerate(self._world.pieces):
            size = np.maximum(size, np.abs(piece.place).max())
            offset = place - piece.place
            if piece.kind == SPHERE:
                gap = piece.radius if j == own else np.abs(np.sqrt((offset**2).sum(axis=1)) - piece.radius)
            elif j == own:
                continue
            else:
                gap = np.maximum(np.abs(offset @ piece.up), _beside(piece, offset))
            nearest = np.minimum(nearest, gap)
        closeness = 1.0 + size / np.maximum(nearest, 1e-300)
        return np.asarray(SLACK * ULP * closeness * (1.0 + self._sharpness))

    def _sight(self, own: int) -> World:
        """The world without piece ``own``, for what a place of it sees."""
        if own not in self._sights:
            self._sights[own] = self._world._replace(bounds=_bounds_without(self._world, own))
        return self._sights[own]


def _extent(world: World) -> float:
    """A distance from the origin beyond which there are no balls."""
    return max((float(np.abs(piece.place).max() + piece.radius) for piece in world.pieces), default=0.0)


def _beside(piece: Piece, offset: Array) -> Array:
    """(N,) how far places at ``offset`` from the origin of a flat piece lie beside it, along its plane."""
    if piece.kind == DISK:
        along = offset - (offset @ piece.up)[:, None] * piece.up
        return np.asarray(np.sqrt((along**2).sum(axis=1)) - piece.radius)
    beyond = np.zeros(len(offset))
    if piece.kind == POLYGON:
        corners = piece.corners.reshape(CORNERS, 3)[: int(piece.count)] - piece.place
        for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            outward = np.cross(second - first, piece.up)
            beyond = np.maximum(beyond, (offset - first) @ outward / np.sqrt((outward**2).sum()))
    return beyond


def _senders(world: World, first_gloss: bool) -> World:
    """The world as it sends light on: where gloss reflects at the first hit alone, what is glossy is black."""
    if not first_gloss:
        return world
    materials = copied(world.materials)
    for material in materials:
        if material.kind != DIFFUSE:
            material.kind, material.texture, material.terms = DIFFUSE, SOLID, 0.0
            material.bright[:], material.dark[:] = 0.0, 0.0
    return world._replace(materials=materials)


def _bounds_without(world: World, own: int) -> Table[Bound]:
    kept = np.flatnonzero(np.arange(len(world.pieces)) != own)
    if not len(kept):
        return table(Bound, 0)
    some = chosen(world.pieces, np.arange(len(world.pieces)) != own)
    bounds = laid_bounds(some)
    for bound in bounds:
        count = int(bound.count)
        bound.held[:count] = kept[bound.held[:count].astype(np.int64)]
    return bounds


def _met(world: World, origins: Array, directions: Array) -> Met:
    count = len(origins)
    piece, shows = np.zeros(count), np.zeros(count)
    place, facing, turned, albedo = (np.zeros((count, 3)) for _ in range(4))
    _kernel("fill_places")(
        world, origins, directions, sky_room(world), piece, place, facing, turned, albedo, shows
    )  # fmt: skip
    return Met(piece.astype(np.int64), place, facing, turned, albedo, shows)


@lru_cache(maxsize=4)
def _kernel(name: str) -> Any:
    """Compiled function that lists walls, meets places or fills what they send."""
    module = walls if hasattr(walls, name) and name.startswith("list") else places
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(module, name), _nrt=False)
