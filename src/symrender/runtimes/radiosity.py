"""Diffuse light of flat scenes at the places rays meet: gathered from a table that is made once a scene."""

from __future__ import annotations

import threading
from collections import OrderedDict
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.records import flat
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.radiometric.shaken import shaken
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_world
from symrender.radiosity.gather import BOUND, NEAR, RULE, WORK
from symrender.radiosity.places import fill_met
from symrender.radiosity.records import CHANNELS
from symrender.radiosity.table import Sendings, sendings
from symrender.runtimes.bounce import Bounced, Ints
from symrender.scene.radiometric.arrays import ALL, RadiometricArrays

KEPT: Final = 4
"""Tables that are kept in memory."""
SLACK: Final = 64.0
"""Roundings a term goes through."""
ULP: Final = 2.0**-52

_tables: OrderedDict[tuple[bytes, float], Sendings] = OrderedDict()
_lock = threading.Lock()


def table_of(arrays: RadiometricArrays, tol: float, threads: int = 1) -> Sendings:
    """What the faces of a scene send each other, for radiances to ``tol``; made once, and kept."""
    parts = (flat(arrays.materials), flat(arrays.shapes), flat(arrays.lights), np.array([arrays.bounces]))
    key = (b"".join(part.tobytes() for part in parts), tol)
    with _lock:
        if key not in _tables:
            _tables[key] = sendings(make_world(arrays), arrays.bounces == ALL, tol, threads)
            while len(_tables) > KEPT:
                _tables.popitem(last=False)
        _tables.move_to_end(key)
        return _tables[key]


class Gatherer:
    """A scene of flat diffuse faces; ``sent`` answers for rays, as ``Bouncer`` does for spheres and planes."""

    def __init__(self, arrays: RadiometricArrays, tol: float, threads: int = 1) -> None:
        self._sendings = table_of(arrays, tol, threads)
        self._worlds = [make_world(each) for each in shaken(arrays)]
        cells = [forest.cells for forest in self._sendings.forests]
        self._brightest = sum(float(np.abs(each["terms"]).sum(axis=1).max(initial=0.0)) for each in cells)
        self._extent = float(np.abs(np.asarray(self._sendings.world.pieces["corners"])).max(initial=0.0))

    def sent(self, rays: list[tuple[Array, Array]], tol: float, _budget: int) -> Bounced:
        """Reflected light along rays; ``rays`` are as ``Bouncer.sent`` takes them.

        ``tol`` is absolute, and decides the status alone: the table was made for it.
        """
        first, *others = (met(world, *pair) for world, pair in zip(self._worlds, rays, strict=True))
        found = self._light(first)
        for owns, fronts, places, albedo in others:
            elsewhere = np.flatnonzero((owns != first[0]) | (fronts != first[1]))
            if len(elsewhere):
                again = self._light((owns[elsewhere], fronts[elsewhere], places[elsewhere], albedo[elsewhere]))
                off = np.abs(again.indirect - found.indirect[elsewhere]).max(axis=1) + again.error
                found.error[elsewhere] = np.maximum(found.error[elsewhere], off)
                found.evaluations[elsewhere] += again.evaluations
        found.status[:] = np.where(found.error > tol, CAPPED, MET)
        return found

    def _light(self, at: tuple[Ints, Ints, Array, Array]) -> Bounced:
        owns, fronts, places, albedo = at
        count = len(owns)
        found = Bounced(
            np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64)
        )
        lit = np.flatnonzero((owns >= 0) & (albedo.max(axis=1, initial=0.0) > 0.0))
        sums = self._sendings.gathered(owns[lit], fronts[lit], places[lit])
        most = albedo[lit].max(axis=1, initial=0.0)
        found.incoming[lit] = sums[:, :CHANNELS]
        found.indirect[lit] = albedo[lit] * found.incoming[lit]
        size = self._extent + np.abs(places[lit]).max(axis=1, initial=0.0)
        # within roundings of another face a place may see any of it
        astray = self._brightest * np.minimum(1.0, SLACK * ULP * (1.0 + size * sums[:, NEAR]))
        found.error[lit] = most * (sums[:, BOUND] + sums[:, RULE] + astray)
        found.evaluations[lit] = sums[:, WORK].astype(np.int64)
        return found


def met(world: World, origins: Array, directions: Array) -> tuple[Ints, Ints, Array, Array]:
    """(piece or -1, 1 if its front (N,), place, albedo (N, 3)) where unit rays meet faces."""
    count = len(origins)
    owns, fronts = np.zeros(count, np.int64), np.zeros(count, np.int64)
    places, albedo = np.zeros((count, 3)), np.zeros((count, 3))
    _met_kernel()(world, origins, directions, owns, fronts, places, albedo)
    return owns, fronts, places, albedo


@lru_cache(maxsize=1)
def _met_kernel() -> Any:
    # the kernel only borrows arrays
    return compiled(fill_met, _nrt=False)
