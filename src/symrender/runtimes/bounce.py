"""The light of one bounce at the places rays meet: lobe averages of diffuse surfaces, to a tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import INVERSE_SQUARE
from symrender.jit.compiled import compiled
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import SplitWork, gloss_points, nearest_squares, split_work
from symrender.quadrature.split_setup import MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.world import Array, make_world
from symrender.scene.arrays import SceneArrays
from symrender.scene.radiometric.arrays import SPHERE, RadiometricArrays
from symrender.scene.radiometric.bounce import Bounce, bounce_scenes, shape_classes

Ints = npt.NDArray[np.int64]

SHARE: Final = 0.9
"""Part of the tolerance that the integrals may take; roundings have the rest."""
SLACK: Final = 16.0
"""Roundings a term goes through."""
ULP: Final = 2.0**-52
RULE: Final = 1
"""``disk_order``: there are no disk lights."""


@dataclass(frozen=True)
class Hits:
    """Where N rays meet shapes: ``shape`` (N,), -1 where none, and ``place``, unit ``normal``, ``albedo`` (N, 3).

    ``blur`` (N,) is what rounding does to the albedo, relative to its largest channel, ``behind`` (N,) 1 where the
    shape's own normal points away from the ray.
    """

    shape: Ints
    place: Array
    normal: Array
    albedo: Array
    blur: Array
    behind: Array


@dataclass(frozen=True)
class Bounced:
    """Light of N places: ``indirect`` (N, 3), and ``error``, ``status``, ``evaluations`` (N,) as of the split rule."""

    indirect: Array
    error: Array
    status: Ints
    evaluations: Ints


class Bouncer:
    """A scene of diffuse surfaces with the scratch of one thread; ``light`` answers for the places of rays."""

    def __init__(self, arrays: RadiometricArrays) -> None:
        self._arrays = arrays
        self._classes, _ = shape_classes(arrays)
        self._scenes: dict[bytes, Bounce] = {}
        self._scratch: SplitWork | None = None

    def hits(self, origins: Array, directions: Array, hit_class: Array) -> Hits:
        """Where unit rays, whose hit classes are known, meet shapes."""
        count = len(origins)
        three = [np.zeros((count, 3)) for _ in range(3)]
        one = [np.zeros(count) for _ in range(2)]
        _hits_kernel()(make_world(self._arrays), origins, directions, *three, *one)
        return Hits(hit_class.astype(np.int64) - 1, *three, *one)

    def light(self, hits: Hits, tol: float, budget: int) -> Bounced:
        """One bounce of light at ``hits``, each to ``tol``, absolute, or ``budget`` evaluations.

        A surface seen from behind is black unless it reflects on both sides; of the inside of a sphere that does, and
        of a place in another plane, no value is given: the status is ``UNSUPPORTED`` and the error infinite.
        """
        count = len(hits.shape)
        found = Bounced(np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64))
        if not (hits.shape >= 0).any():
            return found
        shapes, materials = self._arrays.shapes, self._arrays.materials
        two_sided = np.array([materials[int(shape.material)].two_sided != 0.0 for shape in shapes], dtype=bool)
        is_plane = np.array([shape.kind != SPHERE for shape in shapes], dtype=bool)
        met = hits.shape >= 0
        black = met & (hits.behind != 0.0) & ~two_sided[hits.shape]
        undone = met & ~black & (((hits.behind != 0.0) & ~is_plane[hits.shape]) | self._in_a_plane(hits))
        found.status[undone], found.error[undone] = UNSUPPORTED, np.inf
        work = np.flatnonzero(met & ~black & ~undone & (hits.albedo.max(axis=1) > 0.0))
        turned = np.zeros((len(work), len(shapes)), dtype=bool)
        for j in np.flatnonzero(two_sided & is_plane).tolist():
            frame = self._arrays.frames[j]
            own = hits.shape[work] == j
            above = (hits.place[work] - frame.origin) @ frame.up
            turned[:, j] = np.where(own, hits.behind[work] != 0.0, above < 0.0)
        keys = np.column_stack([turned, hits.shape[work]])
        for key in np.unique(keys, axis=0) if len(work) else ():
            some = work[(keys == key).all(axis=1)]
            self._integrate(some, key[:-1].astype(bool), hits, tol, budget, found)
        return found

    def _in_a_plane(self, hits: Hits) -> npt.NDArray[np.bool_]:
        """Whether places lie, as far as rounding tells, in a plane that is not theirs."""
        inside = np.zeros(len(hits.shape), dtype=bool)
        for j, shape in enumerate(self._arrays.shapes):
            if shape.kind == SPHERE:
                continue
            frame = self._arrays.frames[j]
            offset = hits.place - frame.origin
            size = np.abs(hits.place).max(axis=1) + np.abs(frame.origin).max()
            inside |= (np.abs(offset @ frame.up) <= 4.0 * ULP * size) & (self._classes[hits.shape] != self._classes[j])
        return inside

    def _integrate(
        self, some: Ints, turned: npt.NDArray[np.bool_], hits: Hits, tol: float, budget: int, found: Bounced
    ) -> None:
        """Fill ``found`` at places ``some``, all of one shape, with the planes ``turned`` that show their backs."""
        key = turned.tobytes()
        if key not in self._scenes:
            self._scenes[key] = bounce_scenes(self._arrays, turned)
        bounce = self._scenes[key]
        own = int(hits.shape[some[0]])
        material = self._arrays.materials[int(self._arrays.shapes[own].material)]
        most = float(max(material.bright.max(), material.dark.max()))
        place, normal = hits.place[some], hits.normal[some]
        total, missed = np.zeros((len(some), 3)), np.zeros(len(some))
        for part in bounce.parts:
            if self._scratch is None:
                self._scratch = split_work(part, light_rows(part, RULE))
            surface = np.full(len(some), bounce.classes[own])
            share = SHARE * tol / (most * len(bounce.parts))
            seen = gloss_points(part, place, normal, -normal, surface, share, RULE, budget, self._scratch)
            total += seen.gloss
            missed += seen.error
            found.status[some] = np.maximum(found.status[some], seen.status)
            found.evaluations[some] += seen.evaluations
        albedo = hits.albedo[some]
        found.indirect[some] = albedo * total
        light = found.indirect[some].max(axis=1)
        astray = SLACK * (ULP * _closeness(bounce.parts[0], place) + hits.blur[some])
        found.error[some] = albedo.max(axis=1) * missed + astray * light


def _closeness(part: SceneArrays, place: Array) -> Array:
    """(N,) by how much the roundings of places are magnified in light that falls off, at the least."""
    lights = light_rows(part, RULE)
    if not len(lights):
        return np.ones(len(place))
    size = np.abs(place).max(axis=1) + float(
        np.abs(lights["position"][lights["fall"] == INVERSE_SQUARE]).max(initial=0.0)
    )
    return np.asarray(1.0 + size / float(np.sqrt(nearest_squares(part, lights).min())))


@lru_cache(maxsize=1)
def _hits_kernel() -> Any:
    # the kernel only borrows arrays; counting references to them would cost more than the arithmetic
    return compiled(tile.fill_hits, _nrt=False)
