"""What places of a scene are lit by, and what they gather of forests of cells: the dear rows of a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.endless import Laid
from symrender.radiosity.forest import Forest
from symrender.radiosity.gather import MOST_NODES, gather_places
from symrender.radiosity.places import fill_lit
from symrender.radiosity.records import CHANNELS, SUMS, WORK, Ints, make_scratch
from symrender.radiosity.work import Work

ALONE: Final = Work()
"""One thread that keeps nothing."""
_LIT: Final = np.array([1])
_GATHERED: Final = np.array([2])


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
    scene: Laid, forests: Sequence[Forest], owns: Ints, fronts: Ints, places: Array, fine: float, work: Work = ALONE
) -> Array:  # fmt: skip
    """(N, SUMS) of ``gather_places`` for places of flat pieces, over all forests."""
    normals = np.asarray(scene.world.pieces["up"])[owns] * np.where(fronts > 0, 1.0, -1.0)[:, None]
    return gather_at(scene, forests, Places(owns, fronts, places, normals, normals), fine, work)


def gather_at(
    scene: Laid, forests: Sequence[Forest], at: Places, fine: float, work: Work = ALONE, most: int = MOST_NODES
) -> Array:  # fmt: skip
    """(N, SUMS) of ``gather_places``, over all forests, of each of which a place takes about ``most`` nodes."""
    world = scene.world
    each = (at.own, at.front, at.place, at.normal, at.view)

    def fill(part: slice, sums: Array) -> None:
        some = tuple(rows[part] for rows in each)
        for forest in forests:
            scratch = make_scratch(len(world.pieces), len(forest.cells), len(scene.rims), scene.corners)
            _gather_kernel()(world, forest.cells, forest.roots, *some, fine, float(most), scratch, sums)

    common = [_GATHERED, np.array([fine, most]), *(part for forest in forests for part in (forest.cells, forest.roots))]
    found = work.filled(SUMS, fill, common, each)
    work.spent.evaluations += float(found[:, WORK].sum())
    return found


def direct(world: World, face: Ints, side: Array, places: Array, work: Work = ALONE) -> Array:
    """(N, 3): the irradiance by all lights of places of faces."""
    fronts = (side > 0).astype(np.int64)

    def fill(part: slice, found: Array) -> None:
        _lit_kernel()(world, face[part], fronts[part], places[part], sky_room(world), found)

    work.spent.evaluations += float(len(places) * len(world.lights))
    return work.filled(CHANNELS, fill, [_LIT], (face, fronts, places))


@lru_cache(maxsize=1)
def _gather_kernel() -> Any:
    return compiled(gather_places, _nrt=False)


@lru_cache(maxsize=1)
def _lit_kernel() -> Any:
    return compiled(fill_lit, _nrt=False)
