"""Light of flat scenes at the places rays meet: gathered of a table that is made once a scene, or of lamps."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric.shaken import shaken
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_worlds
from symrender.radiosity.gathered import Places
from symrender.radiosity.lamps import gather_lamps, lamp_cells
from symrender.radiosity.places import fill_met
from symrender.radiosity.records import BOUND, CHANNELS, NEAR, RULE, SUMS, WORK, make_scratch
from symrender.radiosity.table import brightest
from symrender.runtimes.bounce import Bounced, Ints, blurred_albedo, sharpness
from symrender.runtimes.budgets import AGAIN, LATE, beside, by_share
from symrender.runtimes.tables import Need, table_of
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, SPHERE, RadiometricArrays

SLACK: Final = 64.0
"""Roundings a term goes through."""
ULP: Final = 2.0**-52
FINE: Final = 0.05
"""Part of the tolerance that rules of one lobe may take."""


class Gatherer:
    """A scene of flat diffuse faces and glossy shapes; ``sent`` answers for rays, as ``Bouncer`` does for others.

    With ``lamps`` for the light of shapes that emit on what is glossy, else for what faces reflect.
    """

    def __init__(
        self, arrays: RadiometricArrays, tol: float, budget: int = 1_000_000, threads: int = 1, lamps: bool = False
    ) -> None:  # fmt: skip
        self._arrays, self._lamps, self._tol = arrays, lamps, tol
        self._worlds = make_worlds(shaken(arrays))
        world = self._worlds[0]
        if lamps:
            self._cells, _ = lamp_cells(world)
            self._scratch = make_scratch(len(world.pieces), len(self._cells))
            self._brightest = float(max(light.emitted.max() for light in world.lights if light.kind == AREA))
        else:
            self._sendings = table_of(Need(arrays, tol, budget), threads)
            self._brightest = brightest(self._sendings.forests)
        corners = float(np.abs(np.asarray(world.pieces["corners"])).max(initial=0.0))
        places = np.abs(np.asarray(world.pieces["place"])).max(axis=1, initial=0.0) + np.asarray(world.pieces["radius"])
        self._extent = max(corners, float(places.max(initial=0.0)))

    def sent(
        self, rays: list[tuple[Array, Array]], tol: float, budget: int, blurred: npt.NDArray[np.bool_] | None = None
    ) -> Bounced:  # fmt: skip
        """Reflected light along rays, each of about ``budget`` nodes; ``rays`` are as ``Bouncer.sent`` takes them.

        ``tol`` is absolute, and decides the status alone: the table was made for it.
        """
        first, *others = (self._met(world, *pair, blurred) for world, pair in zip(self._worlds, rays, strict=True))
        found = self._light(*first, budget)
        here = first[0]
        elsewhere = [np.flatnonzero((at.own != here.own) | (at.front != here.front)) for at, _ in others]
        shares = beside(budget, found.evaluations, elsewhere)
        for (at, albedo), rays_there in zip(others, elsewhere, strict=True):

            def ask(some: Ints, share: int, at: Places = at, albedo: Array = albedo) -> Bounced:
                return self._light(at.some(some), albedo[some], share)

            again = by_share(ask, rays_there, shares)
            off = np.abs(again.indirect - found.indirect[rays_there]).max(axis=1) + again.error
            found.error[rays_there] = np.maximum(found.error[rays_there], off)
            found.evaluations[rays_there] += again.evaluations
        found.status[:] = np.where(found.error > tol, np.maximum(found.status, CAPPED), MET)
        return found

    def _met(
        self, world: World, origins: Array, directions: Array, blurred: npt.NDArray[np.bool_] | None
    ) -> tuple[Places, Array]:  # fmt: skip
        """``met``, with the means of textures of what is flat where ``blurred`` says so."""
        at, albedo = met(world, origins, directions)
        if blurred is not None:
            owners = np.asarray(world.pieces["owner"]).astype(np.int64)
            shape = np.where(at.own >= 0, owners[at.own], -1)
            albedo = blurred_albedo(self._arrays, shape, albedo, blurred)
        return at, albedo

    def _light(self, at: Places, albedo: Array, budget: int) -> Bounced:
        count = len(at.own)
        found = Bounced(
            np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64)
        )
        world = self._worlds[0]
        materials = np.asarray(world.pieces["material"]).astype(int)[at.own]
        kinds = np.asarray(world.materials["kind"])[materials]
        inside = (np.asarray(world.pieces["kind"])[at.own] == SPHERE) & (at.front == 0)
        lit = (at.own >= 0) & (albedo.max(axis=1, initial=0.0) > 0.0)
        if self._lamps:
            lit &= kinds != DIFFUSE
        found.status[lit & inside], found.error[lit & inside] = UNSUPPORTED, np.inf
        for m in np.unique(materials[lit & ~inside]).tolist():
            self._of_material(np.flatnonzero(lit & ~inside & (materials == m)), m, at, albedo, budget, found)
        return found

    def _of_material(self, some: Ints, m: int, at: Places, albedo: Array, budget: int, found: Bounced) -> None:
        """Fill ``found`` at places ``some``, of material ``m``."""
        world, some_at = self._worlds[0], at.some(some)
        material = world.materials[m]
        most = albedo[some].max(axis=1, initial=0.0)
        # of all of the material, not of these places alone: what a place gathers does not depend on its neighbours
        fine = FINE * self._tol / float(np.maximum(material.bright, material.dark).max())
        if not self._lamps and material.kind == DIFFUSE:
            fine = self._sendings.fine
        sums = self._sums(some_at, fine, budget)
        for part, looser in AGAIN:
            # what was not looked at is all that its bound says
            short = np.flatnonzero((sums[:, WORK] > budget) & (sums[:, WORK] < LATE * budget))
            if not len(short):
                break
            again = self._sums(some_at.some(short), looser * fine, max(1, int(part * budget)))
            better = again[:, BOUND] + again[:, RULE] < sums[short, BOUND] + sums[short, RULE]
            again[:, WORK] += sums[short, WORK]
            sums[short, WORK] = again[:, WORK]
            sums[short[better]] = again[better]
        if not self._lamps and material.kind == DIFFUSE:
            sums[:, BOUND] += self._sendings.missed(some_at.own, some_at.place)
        found.incoming[some] = sums[:, :CHANNELS]
        found.indirect[some] = albedo[some] * found.incoming[some]
        size = self._extent + np.abs(some_at.place).max(axis=1, initial=0.0)
        # within roundings of another face a place may see any of it
        astray = self._brightest * np.minimum(1.0, SLACK * ULP * (1.0 + size * sums[:, NEAR]))
        cosine = (some_at.view * some_at.normal).sum(axis=1)
        astray *= sharpness(material, cosine)
        found.error[some] = most * (sums[:, BOUND] + sums[:, RULE] + astray)
        found.evaluations[some] = sums[:, WORK].astype(np.int64)

    def _sums(self, at: Places, fine: float, budget: int) -> Array:
        """(N, SUMS) of places, of about ``budget`` nodes each."""
        if not self._lamps:
            return self._sendings.reflected(at, fine, budget)
        sums = np.zeros((len(at.own), SUMS))
        one = (at.own, at.front, at.place, at.normal, at.view)
        _lamps_kernel()(self._worlds[0], self._cells, *one, fine, float(budget), self._scratch, sums)
        return sums


def met(world: World, origins: Array, directions: Array) -> tuple[Places, Array]:
    """(places, their pieces -1 where there are none, albedo (N, 3)) where unit rays meet shapes."""
    count = len(origins)
    owns, fronts = np.zeros(count, np.int64), np.zeros(count, np.int64)
    places, normals, albedo = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    _met_kernel()(world, origins, directions, owns, fronts, places, normals, albedo)
    return Places(owns, fronts, places, normals, -directions), albedo


@lru_cache(maxsize=1)
def _met_kernel() -> Any:
    # the kernels only borrow arrays
    return compiled(fill_met, _nrt=False)


@lru_cache(maxsize=1)
def _lamps_kernel() -> Any:
    return compiled(gather_lamps, _nrt=False)
