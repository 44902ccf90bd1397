"""The light of one bounce at the places rays meet: lobe integrals of their materials, to a tolerance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import CONDUCTOR as ROUGH
from symrender.chambers.lobes.record import CORRELATED, LAMBERT, POWER, SEPARABLE, Conductor, Sender
from symrender.chambers.records import INVERSE_SQUARE
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, table
from symrender.quadrature.background import directional_albedo
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import SplitResult, gloss_at
from symrender.quadrature.split_scene import SplitScene, nearest_squares, refuse_conductors, split_scene
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.shaken import shaken
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_worlds
from symrender.runtimes.budgets import AGAIN, HOPELESS, beside, by_share
from symrender.scene.arrays import FIRST_SPHERE, SOLID, SceneArrays
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE, PHONG, SPHERE, RadiometricArrays
from symrender.scene.radiometric.bounce import Bounce, bounce_scenes, lamp_scene, shape_classes
from symrender.scene.radiometric.records import Material

Ints = npt.NDArray[np.int64]

SHARE: Final = 0.9
"""Part of the tolerance that the integrals may take; roundings have the rest."""
SLACK: Final = 16.0
"""Roundings a term goes through."""
ULP: Final = 2.0**-52
STEPS: Final = 4.0
"""Places whose reflectances differ by no more than the root of 2 of this degree share a tolerance."""
LEAST_SHARE: Final = 1e-9
"""What reflects less is asked for as much."""
RULE: Final = 1
"""``disk_order``: there are no disk lights."""
FELT_SLOPE: Final = 9.0
"""No direction where cos^n is above e^-40 has a larger slope of its logarithm than this times sqrt(n + 1)."""


@dataclass(frozen=True)
class Hits:
    """Where N rays meet shapes: ``shape`` (N,), -1 where none, and ``place``, unit ``normal``, ``albedo`` (N, 3).

    ``behind`` (N,) is 1 where the shape's own normal points away from the ray, whose unit direction is ``travel``
    (N, 3).
    """

    shape: Ints
    place: Array
    normal: Array
    albedo: Array
    behind: Array
    travel: Array

    def some(self, which: Ints) -> Hits:
        """Those of ``which``."""
        vectors = (self.place[which], self.normal[which], self.albedo[which])
        return Hits(self.shape[which], *vectors, self.behind[which], self.travel[which])


def hits(world: World, origins: Array, directions: Array) -> Hits:
    """Where unit rays meet the shapes of a world."""
    count = len(origins)
    place, normal, albedo = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    shape, behind = np.zeros(count), np.zeros(count)
    _hits_kernel()(world, origins, directions, shape, place, normal, albedo, behind)
    return Hits(shape.astype(np.int64), place, normal, albedo, behind, directions)


@dataclass(frozen=True)
class Bounced:
    """Light of N places: ``indirect`` (N, 3), and ``error``, ``status``, ``evaluations`` (N,) as of the split rule.

    ``incoming`` (N, 3) is what ``indirect`` is of, before the place reflects it.
    """

    indirect: Array
    incoming: Array
    error: Array
    status: Ints
    evaluations: Ints


@dataclass(frozen=True)
class Ready:
    """A scene of one bounce as the split rule takes its parts, and the conductors among its classes."""

    bounce: Bounce
    conductors: Table[Conductor] | None
    scenes: tuple[SplitScene, ...]


def ready(arrays: RadiometricArrays, bounce: Bounce, own: int, lamps: bool) -> Ready:
    """``bounce`` made ready for places of shape ``own``; with ``lamps`` nothing sends light on."""
    senders = sender_rows(arrays, bounce)
    conductors = conductor_rows(senders)
    if conductors is not None:
        for part in bounce.parts:
            refuse_conductors(part, conductors, bounce.classes[own : own + 1])
    scenes = [
        split_scene(part, RULE, conductors, None if lamps else senders, bounce.emitted, bounce.beams, bounce.glows)
        for part in bounce.parts
    ]
    return Ready(bounce, conductors, tuple(scenes))


class Bouncer:
    """A scene with the scratch of one thread; ``sent`` answers for rays.

    With ``lamps`` for the light of the sky and of spheres that emit on what is glossy, else for that of one bounce.
    """

    def __init__(self, arrays: RadiometricArrays, lamps: bool = False) -> None:
        self._arrays, self._lamps = arrays, lamps
        self._shaken = shaken(arrays)
        self._worlds = make_worlds(self._shaken)
        self._classes, _ = shape_classes(arrays)
        used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
        self._highlights = max([1.0, *(float(sharpness(m, np.ones(1))[0]) for m in used)])
        self._scenes: dict[bytes, Ready] = {}
        self._scratch: SplitWork | None = None

    def sent(
        self, rays: list[tuple[Array, Array]], tol: float, budget: int, blurred: npt.NDArray[np.bool_] | None = None
    ) -> Bounced:  # fmt: skip
        """One bounce of light along rays, each to ``tol``, absolute, or ``budget`` evaluations.

        ``rays`` are origins and unit directions (N, 3), as they are and as they go with the scenes of ``shaken``: where
        those meet another shape, or another part of a texture, the error says what that changes. What is flat
        reflects as the mean of its texture where ``blurred`` (N,) says so.
        """
        first, *others = (hits(world, *pair) for world, pair in zip(self._worlds, rays, strict=True))
        if blurred is not None:
            first, *others = (self._blurred(each, blurred) for each in (first, *others))
        found = self.light(first, tol, budget)
        doubts = [np.zeros(len(found.error))]
        elsewhere = [np.flatnonzero((first.shape != each.shape) | (first.behind != each.behind)) for each in others]
        shares = beside(budget, found.evaluations, elsewhere)
        for other, rays_there in zip(others, elsewhere, strict=True):

            def ask(some: Ints, share: int, at: Hits = other) -> Bounced:
                return self.light(at.some(some), tol, share)

            again = by_share(ask, rays_there, shares)
            doubts.append(doubted(found, np.abs(other.albedo - first.albedo), rays_there, again))
        found.error[:] += np.max(doubts, axis=0)
        return found

    def _blurred(self, found: Hits, blurred: npt.NDArray[np.bool_]) -> Hits:
        """``found`` with the means of textures of what is flat."""
        return replace(found, albedo=blurred_albedo(self._arrays, found.shape, found.albedo, blurred))

    def light(self, hits: Hits, tol: float, budget: int) -> Bounced:
        """One bounce of light at ``hits``, each to ``tol``, absolute, or ``budget`` evaluations.

        A surface seen from behind is black unless it reflects on both sides; of the inside of a sphere that does, of a
        place in another plane, and of one that may see a highlight whose end is a wall, no value is given: the status
        is ``UNSUPPORTED`` and the error infinite.
        """
        count = len(hits.shape)
        found = Bounced(
            np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64)
        )
        if not (hits.shape >= 0).any():
            return found
        shapes, materials = self._arrays.shapes, self._arrays.materials
        two_sided = np.array([materials[int(shape.material)].two_sided != 0.0 for shape in shapes], dtype=bool)
        is_plane = np.array([shape.kind != SPHERE for shape in shapes], dtype=bool)
        met = hits.shape >= 0
        if self._lamps:
            met &= np.array([materials[int(shape.material)].kind != DIFFUSE for shape in shapes])[hits.shape]
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
        keys = np.column_stack([turned, hits.shape[work], _reflected(hits.albedo[work])])
        for key in np.unique(keys, axis=0) if len(work) else ():
            some = work[(keys == key).all(axis=1)]
            self._integrate(some, key[:-2].astype(bool), 2.0 ** (key[-1] / STEPS), hits, tol, budget, found)
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

    def _nearness(self, own: int, place: Array) -> Array:
        """(N,) size of coordinates over the distance to the nearest other shape, or over the radius of their own."""
        size, nearest = np.abs(place).max(axis=1), np.full(len(place), np.inf)
        for j, shape in enumerate(self._arrays.shapes):
            size = np.maximum(size, np.abs(shape.place).max())
            if shape.kind == SPHERE:
                reach = np.sqrt(((place - shape.place) ** 2).sum(axis=1))
                gap = shape.radius if j == own else np.abs(reach - shape.radius)
            elif j == own:
                continue
            else:
                frame = self._arrays.frames[j]
                gap = np.abs((place - frame.origin) @ frame.up)
            nearest = np.minimum(nearest, gap)
        return np.asarray(1.0 + size / np.maximum(nearest, 1e-300))

    def _integrate(
        self, some: Ints, turned: npt.NDArray[np.bool_], part: float, hits: Hits, tol: float, budget: int,
        found: Bounced,
    ) -> None:  # fmt: skip
        """Fill ``found`` at places ``some``, all of one shape, with the planes ``turned`` that show their backs.

        None of the places reflects more than ``part`` in any channel.
        """
        own = int(hits.shape[some[0]])
        material = self._arrays.materials[int(self._arrays.shapes[own].material)]
        key = turned.tobytes() + bytes([int(material.kind == PHONG)])
        if key not in self._scenes:
            bounce = (lamp_scene if self._lamps else bounce_scenes)(self._arrays, turned, own)
            self._scenes[key] = ready(self._arrays, bounce, own, self._lamps)
        bounce, conductors = self._scenes[key].bounce, self._scenes[key].conductors
        most = min(part, float(max(material.bright.max(), material.dark.max())))
        place, normal, travel = hits.place[some], hits.normal[some], hits.travel[some]
        total, missed = np.zeros((len(some), 3)), np.zeros(len(some))
        for world, scene in zip(bounce.parts, self._scenes[key].scenes, strict=True):
            if self._scratch is None:
                self._scratch = split_work(world, scene.lights, bounce.glows is not None)
            surface = np.full(len(some), bounce.classes[own])
            share = SHARE * tol / (most * len(bounce.parts))
            sky = world.shading.background
            under = float(sky.max())
            if conductors is not None and material.kind == CONDUCTOR and under > 0.0:
                # one half of the tolerance is for what shapes take from the sky, the other for the whole of it
                share *= 0.5
                whole = directional_albedo(
                    conductors[int(bounce.classes[own])], -(travel * normal).sum(axis=1), share / under, budget,
                    self._scratch,
                )  # fmt: skip
                self._add(some, whole, sky, total, missed, found)
            lobes = (place, normal, -normal if material.kind == DIFFUSE else travel, surface)
            seen = gloss_within(scene, *lobes, share, budget, self._scratch)
            self._add(some, seen, np.ones(3), total, missed, found)
        albedo = hits.albedo[some]
        found.indirect[some], found.incoming[some] = albedo * total, total
        light = found.indirect[some].max(axis=1)
        # what is left of the sky is a difference
        light = np.maximum(light, most * max(float(world.shading.background.max()) for world in bounce.parts))
        astray = SLACK * ULP * np.maximum(closeness(bounce.parts[0], place), self._nearness(own, place))
        astray *= sharpness(material, -(travel * normal).sum(axis=1)) + self._highlights
        found.error[some] = albedo.max(axis=1) * missed + astray * light

    @staticmethod
    def _add(some: Ints, seen: SplitResult, color: Array, total: Array, missed: Array, found: Bounced) -> None:
        """Add integrals of places ``some``, times ``color``, to ``total``, what they miss too, note what they say."""
        total += color * seen.gloss
        missed += float(color.max()) * seen.error
        found.status[some] = np.maximum(found.status[some], seen.status)
        found.evaluations[some] += seen.evaluations


def doubted(found: Bounced, off: Array, elsewhere: Ints, again: Bounced) -> Array:
    """(N,) by how much light of N places changes where they reflect otherwise by ``off`` (N, 3) in a shaken scene.

    Those of ``elsewhere`` are other places there, whose light is that of ``again``; its evaluations are added.
    """
    doubts: Array = (off * found.incoming).max(axis=1, initial=0.0)
    doubts[elsewhere] = np.abs(again.indirect - found.indirect[elsewhere]).max(axis=1) + again.error
    found.evaluations[elsewhere] += again.evaluations
    return doubts


def _reflected(albedo: Array) -> Ints:
    """The power of the ``STEPS``-th root of 2 that is no less than any channel of ``albedo`` (N, 3).

    What a place reflects little of need not be known as well; places of one power are asked together.
    """
    powers: Ints = np.ceil(STEPS * np.log2(np.maximum(albedo.max(axis=1), LEAST_SHARE))).astype(np.int64)
    return powers


def gloss_within(
    scene: SplitScene, points: Array, normals: Array, incoming: Array, surface: Ints, tol: float, budget: int,
    scratch: SplitWork,
) -> SplitResult:  # fmt: skip
    """``gloss_at`` where the budget may end before the tolerance is met.

    What was not looked at is then all that its bound says. So where a budget leaves an error that is much larger than
    ``tol``, half as much again is spent on looser ones, and the best value stands, ``CAPPED``.
    """
    seen = gloss_at(scene, points, normals, incoming, surface, tol, budget, scratch)
    allowed = tol
    for part, looser in AGAIN:
        short = (seen.status != MET) & (seen.error > HOPELESS * allowed) & np.isfinite(seen.error)
        left = np.flatnonzero(short)
        if not len(left):
            break
        allowed = looser * tol
        lobes = (points[left], normals[left], incoming[left], surface[left])
        again = gloss_at(scene, *lobes, allowed, max(1, int(part * budget)), scratch)
        seen.evaluations[left] += again.evaluations
        better = again.error < seen.error[left]
        seen.gloss[left[better]], seen.error[left[better]] = again.gloss[better], again.error[better]
    return seen


def blurred_albedo(
    arrays: RadiometricArrays, shape: Ints, albedo: Array, blurred: npt.NDArray[np.bool_]
) -> Array:  # fmt: skip
    """``albedo`` (N, 3) of places of shapes, the mean of its texture where one is flat and ``blurred``."""
    used = [arrays.materials[int(each.material)] for each in arrays.shapes]
    flat = np.array([each.kind != SPHERE and m.texture != SOLID for each, m in zip(arrays.shapes, used, strict=True)])
    means = np.array([0.5 * (m.bright + m.dark) for m in used]).reshape(-1, 3)
    some = blurred & (shape >= 0) & flat[shape]
    return np.where(some[:, None], means[shape], albedo)


def conductor_rows(senders: Table[Sender] | None) -> Table[Conductor] | None:
    """The conductors of all hit classes of a scene whose shapes send light on so."""
    if senders is None:
        return None
    rows = table(Conductor, FIRST_SPHERE + len(senders))
    for k, sender in enumerate(senders):
        rows[FIRST_SPHERE + k] = sender.conductor
    return rows


def sender_rows(arrays: RadiometricArrays, bounce: Bounce) -> Table[Sender] | None:
    """How the shapes of ``bounce`` send light on; None if all are diffuse.

    Where gloss reflects at the first hit alone, glossy ones are told as black diffuse ones, which keep their lobes.
    """
    rows, glossy = table(Sender, len(bounce.shapes)), False
    for row, j in zip(rows, bounce.shapes, strict=True):
        material = arrays.materials[int(arrays.shapes[j].material)]
        row.kind = LAMBERT
        if material.kind == PHONG:
            row.kind, row.exponent = POWER, material.exponent
        elif material.kind == CONDUCTOR:
            rough = row.conductor
            row.kind, rough.alpha = ROUGH, material.alpha
            rough.masking = CORRELATED if material.correlated else SEPARABLE
            rough.eta[:], rough.k[:] = material.eta, material.k
            rough.beckmann = 1.0 if material.density == BECKMANN else 0.0
            rough.walter = material.walter
        glossy = glossy or row.kind != LAMBERT
        if arrays.first_gloss:
            row.kind = LAMBERT
    return rows if glossy else None


def sharpness(material: Material, cosine: Array) -> Array:
    """(N,) largest slope of the logarithm of what a material reflects, seen at these cosines, in the directions."""
    if material.kind == DIFFUSE:
        return np.ones(len(cosine))
    if material.kind == PHONG:
        return np.full(len(cosine), FELT_SLOPE * np.sqrt(material.exponent + 1.0))
    if material.density == BECKMANN:
        # where D is above e^-40
        return np.asarray(1.0 + 13.0 / material.alpha + 1.0 / np.maximum(cosine, 1e-300))
    # D's is 2/alpha at most, and the masking's as where the view grazes
    return np.asarray(1.0 + 2.0 / material.alpha + 1.0 / np.maximum(cosine, 1e-300))


def closeness(part: SceneArrays, place: Array) -> Array:
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
