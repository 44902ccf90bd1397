"""Derivatives of the light of one bounce at the places rays meet, to a tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.twins import moving
from symrender.quadrature.background import albedo_slopes
from symrender.quadrature.split_scratch import SplitWork
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.quadrature.split_slopes import SlopeResult, gloss_slopes, moving_work
from symrender.radiometric import tile
from symrender.radiometric.slopes import record_moves, world_moves
from symrender.radiometric.world import make_world
from symrender.runtimes.bounce import SLACK, ULP, Bounced, Bouncer, Hits, closeness, sharpness
from symrender.runtimes.bounce_moves import MovingBounce, moving_bounce, shifted
from symrender.runtimes.bounce_pace import Pace, is_faint_colour, moves_lengths, pace_of
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import CONDUCTOR, DIFFUSE, SPHERE, RadiometricArrays

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Ints = npt.NDArray[np.int64]

FIRST: Final = 0.1
"""Tolerance of the value that is asked at first, over that of the derivative."""
TIGHTER: Final = (1.0, 0.1, 1e-2)
"""By how much tighter values are asked in turn, until derivatives are within their tolerance."""
CLOSEST: Final = (1e-3, 1e-4, 1e-6)
"""The same where it is for what no node looked at that they are not."""
UNSEEN: Final = 0.5
"""Share of an error that is taken for most of it."""
SHIFTED: Final = 4.0
"""Relative error of a slope by roundings, over that of a value."""


@dataclass(frozen=True)
class MovingHits:
    """Where N rays meet shapes, with tangents along one move: ``place``, ``normal``, ``albedo``, ``travel`` (N, 3)."""

    place: Complex
    normal: Complex
    albedo: Complex
    travel: Complex

    def some(self, which: Ints) -> MovingHits:
        """Those of ``which``."""
        return MovingHits(self.place[which], self.normal[which], self.albedo[which], self.travel[which])


@dataclass(frozen=True)
class BouncedSlopes:
    """Derivatives of the light of N places in Q parameters.

    ``slopes`` (Q, N, 3) are those of what is reflected, ``incoming`` (Q, N, 3) what arrives, the value and as imaginary
    part its derivative; ``error`` and ``status`` (Q, N); ``evaluations`` (N,). ``light`` (Q, N, 3) is what is reflected
    itself and ``missed`` (Q, N) what it may be off by, where they are known.
    """

    slopes: Array
    incoming: Complex
    error: Array
    status: Ints
    evaluations: Ints
    light: Array | None = None
    missed: Array | None = None


def product(a: Complex, b: Complex) -> Complex:
    """Of numbers that move: values times values, and the product rule."""
    return np.asarray(a.real * b.real + 1j * (a.real * b.imag + a.imag * b.real))


def share(factor: Array, error: Array) -> Array:
    """Factor times error; of none of it nothing, however little is known."""
    return np.multiply(factor, error, out=np.zeros_like(error), where=factor != 0.0)


@dataclass
class _Sums:
    """Integrals of N places: ``total`` (N, 3), what it misses, what its tangent is the sum of, ``status``.

    ``unseen`` is what no node looked at may hold.
    """

    total: Complex
    missed: Complex
    steep: Array
    unseen: Array
    status: Ints

    @classmethod
    def of(cls, count: int) -> _Sums:
        """Nothing yet."""
        missed = np.zeros(count, np.complex128)
        return cls(np.zeros((count, 3), np.complex128), missed, np.zeros(count), np.zeros(count), np.full(count, MET))

    def add(self, seen: SlopeResult, factor: Complex) -> None:
        """Add integrals times ``factor`` (N, 3)."""
        self.total += product(seen.gloss, factor)
        most, changed = np.abs(factor.real).max(axis=1), np.abs(factor.imag).max(axis=1)
        # part by part: i times what is not known would leave no number of the other one
        self.missed.real += share(most, seen.error.real)
        self.missed.imag += share(most, seen.error.imag) + share(changed, seen.error.real)
        self.unseen += seen.unseen * most
        self.steep += seen.steep * most + np.abs(seen.gloss.real).max(axis=1) * changed
        self.status = np.maximum(self.status, seen.status)

    def back(self) -> None:
        """From light of a colour that is one more to that of the colour itself; it is of first degree in it."""
        self.total -= self.total.imag
        self.missed += self.missed.imag


class SlopeBouncer(Bouncer):
    """A scene with the scratch of one thread; ``sloped`` answers for rays by every parameter of ``wrt``."""

    def __init__(self, arrays: RadiometricArrays, wrt: tuple[Move, ...], lamps: bool = False) -> None:
        super().__init__(arrays, lamps)
        self._moves = [[record_moves(each, move) for each in self._shaken] for move in wrt]
        rows = arrays.shapes["place"], arrays.shapes["radius"], arrays.lights["place"]
        self._size = max(float(np.abs(each).max(initial=0.0)) for each in rows)
        self._units = [min(1.0, self._size) if moves_lengths(arrays, moves[0]) else 1.0 for moves in self._moves]
        self._paces: dict[int, Pace] = {}
        self._ball = float(arrays.shapes["radius"][arrays.shapes["kind"] == SPHERE].min(initial=np.inf))
        faint = [is_faint_colour(arrays, moves[0]) for moves in self._moves]
        self._bases = [shifted(arrays, moves[0], 1.0) if ahead else arrays
                       for ahead, moves in zip(faint, self._moves, strict=True)]  # fmt: skip
        self._unseen = np.zeros((0, 0))
        self._moving: dict[tuple[int, bytes], MovingBounce] = {}
        self._work: SplitWork | None = None
        self._hits: list[MovingHits] = []
        self._found: BouncedSlopes | None = None

    def sloped(self, rays: list[list[tuple[Complex, Complex]]], tol: float, budget: int) -> BouncedSlopes:
        """Derivatives of one bounce of light along rays, each to ``tol``, absolute.

        ``rays``: for every parameter, origins and unit directions (N, 3) with their tangents, as they are and as they
        go with the scenes of ``shaken``.
        """
        first, *others = (self._met(k, [each[k] for each in rays]) for k in range(len(self._shaken)))
        found = self._at(*first, tol, budget)
        assert found.light is not None and found.missed is not None
        doubts = np.zeros(found.error.shape)
        for hits, moved in others:
            same = (first[0].shape == hits.shape) & (first[0].behind == hits.behind)
            off = np.zeros(found.error.shape)
            for q, (here, there) in enumerate(zip(first[1], moved, strict=True)):
                off[q] = np.abs(((there.albedo - here.albedo) * found.incoming[q]).imag).max(axis=1, initial=0.0)
            off[:, ~same] = 0.0
            elsewhere = np.flatnonzero(~same)
            if len(elsewhere):
                again = self._at(hits.some(elsewhere), [each.some(elsewhere) for each in moved], tol, budget)
                off[:, elsewhere] = np.abs(again.slopes - found.slopes[:, elsewhere]).max(axis=2) + again.error
                assert again.light is not None and again.missed is not None
                gap = np.abs(again.light - found.light[:, elsewhere]).max(axis=2) + again.missed
                found.missed[:, elsewhere] = np.maximum(found.missed[:, elsewhere], gap)
                found.evaluations[elsewhere] += again.evaluations
            doubts = np.maximum(doubts, off)
        found.error[:] += doubts
        found.status[(found.status == MET) & (found.error > tol)] = CAPPED
        return found

    def _met(self, k: int, rays: list[tuple[Complex, Complex]]) -> tuple[Hits, list[MovingHits]]:
        """What rays meet in the scene ``k`` of those that are shaken, and how that moves with every parameter."""
        arrays, count = self._shaken[k], len(rays[0][0])
        world = make_world(arrays)
        shape, behind = np.zeros(count, np.complex128), np.zeros(count)
        moved = []
        for moves, (origins, directions) in zip(self._moves, rays, strict=True):
            at, facing, albedo = (np.zeros((count, 3), np.complex128) for _ in range(3))
            world_ = moving(world, world_moves(arrays, moves[k]))
            _hits_kernel()(world_, origins, directions, shape, at, facing, albedo, behind)
            moved.append(MovingHits(at, facing, albedo, directions))
        here = moved[0]
        place, normal, travel = (np.ascontiguousarray(each.real) for each in (here.place, here.normal, here.travel))
        # what is black may have a derivative
        felt = np.max([np.abs(each.albedo).max(axis=1, initial=0.0) for each in moved], axis=0) > 0.0
        albedo_ = np.where(felt[:, None], 1.0, np.zeros((count, 3)))
        return Hits(shape.real.astype(np.int64), place, normal, albedo_, behind, travel), moved

    def _at(self, hits: Hits, moved: list[MovingHits], tol: float, budget: int) -> BouncedSlopes:
        """Derivatives of the light at ``hits``."""
        shape = len(self._moves), len(hits.shape)
        self._hits, self._unseen = moved, np.zeros(shape)
        self._found = BouncedSlopes(
            np.zeros((*shape, 3)), np.zeros((*shape, 3), np.complex128), np.zeros(shape), np.full(shape, MET),
            np.zeros(shape[1], np.int64), np.zeros((*shape, 3)), np.zeros(shape),
        )  # fmt: skip
        found, light = self._found, self.light(hits, tol, budget)
        undone = light.status == UNSUPPORTED
        found.status[:, undone], found.error[:, undone] = UNSUPPORTED, np.inf
        return found

    def _integrate(
        self, some: Ints, turned: npt.NDArray[np.bool_], part: float, hits: Hits, tol: float, budget: int,
        found: Bounced,
    ) -> None:  # fmt: skip
        """Fill what was found by ``_at`` at places ``some``, all of one shape, with ``turned`` planes.

        ``part`` has no say: a place that reflects little may soon reflect much.
        """
        for q in range(len(self._moves)):
            left = some
            assert self._found is not None
            self._found.error[q, some], self._found.status[q, some] = np.inf, UNSUPPORTED
            for tighter in TIGHTER + CLOSEST:
                self._differentiate(q, left, turned, hits, tol, FIRST * tighter * self._units[q] * tol, budget)
                left = left[self._found.error[q, left] > tol]
                left = left[self._found.status[q, left] != EVENT]
                if tighter <= TIGHTER[-1]:
                    left = left[self._unseen[q, left] > UNSEEN * self._found.error[q, left]]
                if not len(left):
                    break

    def _differentiate(
        self, q: int, some: Ints, turned: npt.NDArray[np.bool_], hits: Hits, tol: float, within: float, budget: int
    ) -> None:
        """The same of parameter ``q``, by values each within ``within``."""
        own, arrays, found = int(hits.shape[some[0]]), self._arrays, self._found
        assert found is not None
        material = arrays.materials[int(arrays.shapes[own].material)]
        key = q, turned.tobytes() + bytes([own])
        if key not in self._moving:
            self._moving[key] = moving_bounce(self._bases[q], self._moves[q][0], turned, own, self._lamps)
        bounce, here = self._moving[key], self._hits[q].some(some)
        # no other place of a tile may have a say in what is asked of one
        change = self._moves[q][0].materials[int(arrays.shapes[own].material)]
        most = max(1e-300, *(float(np.abs(each).max()) for each in (material.bright, material.dark, change.bright)))
        sums = _Sums.of(len(some))
        for part in bounce.parts:
            if self._work is None:
                self._work = moving_work(part.part, part.lights, part.view.glows is not None)
            surface = np.full(len(some), bounce.still.classes[own])
            scale = part.scales[surface]
            share = within / (most * len(bounce.parts))
            view: Any = part.view
            sky = np.asarray(view.shading["background"])
            under = float(sky.real.max())
            if material.kind == CONDUCTOR and (sky != 0.0).any():
                # as of the value: one half for what shapes take from the sky, the other for the whole of it
                share *= 0.5
                whole = albedo_slopes(
                    view.conductors, int(surface[0]), -product(here.travel, here.normal).sum(axis=1),
                    share / max(under, 1.0), budget, self._work,
                )  # fmt: skip
                sums.add(whole, np.tile(sky, (len(some), 1)))
                found.evaluations[some] += whole.evaluations
            seen = gloss_slopes(
                here.place, here.normal, -here.normal if material.kind == DIFFUSE else here.travel, surface, part.lobes,
                part.view, part.frames, part.bound, share / float(scale[0].real), budget, self._work,
            )  # fmt: skip
            sums.add(seen, np.tile(scale[:, None], 3))
            found.evaluations[some] += seen.evaluations
        if self._bases[q] is not arrays:
            sums.back()
        total, missed, steep, status = sums.total, sums.missed, sums.steep, sums.status
        light = product(here.albedo, total)
        reflected, changed = np.abs(here.albedo.real).max(axis=1), np.abs(here.albedo.imag).max(axis=1)
        place = here.place.real
        closer = np.maximum(closeness(bounce.still.parts[0], place), self._nearness(own, place))
        astray = SHIFTED * SLACK * ULP * closer
        cosine = -(here.travel.real * here.normal.real).sum(axis=1)
        sharp = sharpness(material, cosine) + self._highlights
        astray = astray * sharp
        error = reflected * missed.imag + changed * missed.real
        unseen = reflected * sums.unseen * self._pace(q, here, closer, sharp)
        error += unseen
        error += astray * (reflected * steep + changed * np.abs(total.real).max(axis=1))
        known = np.isfinite(light.imag).all(axis=1) & np.isfinite(error)
        # what asks too much of roundings may be worse than what asked less
        better = known & (error < found.error[q, some])
        here_ = some[better]
        found.slopes[q, here_], found.incoming[q, here_] = light.imag[better], total[better]
        found.error[q, here_], self._unseen[q, here_] = error[better], unseen[better]
        assert found.light is not None and found.missed is not None
        found.light[q, here_] = light.real[better]
        found.missed[q, here_] = (reflected * missed.real + astray * np.abs(light.real).max(axis=1))[better]
        reached = np.where(error > tol, np.maximum(status, CAPPED), np.where(status == EVENT, EVENT, MET))
        found.status[q, here_] = reached[better]

    def _pace(self, q: int, here: MovingHits, closer: Array, sharp: Array) -> Array:
        """(N,) by how much more than it holds what places see may change with parameter ``q``.

        ``closer`` (N,) is the size of coordinates over distances to shapes, and of lights from these.
        """
        speeds = [np.abs(each.imag).max(axis=1) for each in (here.place, here.normal, here.travel)]
        size = np.maximum(self._size, np.abs(here.place.real).max(axis=1))
        closer = np.maximum(closer, size / self._ball)
        if q not in self._paces:
            self._paces[q] = pace_of(self._arrays, self._moves[q][0])
        return self._paces[q].at((speeds[0], speeds[1] + speeds[2]), size / closer, size, sharp)


def moving_rays(
    view: Any, moves: Any, width: int, height: int, tile_: tuple[int, int, int, int]
) -> tuple[Complex, Complex]:
    """Origins and unit directions (N, 3) of the rays through the pixels of a tile, with their tangents."""
    x0, y0, x1, y1 = tile_
    count = (x1 - x0) * (y1 - y0)
    directions = np.zeros((count, 3), np.complex128)
    _directions_kernel()(moving(view.window, moves.window), width, height, x0, y0, x1, y1, directions)
    return np.tile(moving(view.eye, moves.eye), (count, 1)), directions


@lru_cache(maxsize=1)
def _hits_kernel() -> Any:
    # the kernel only borrows arrays; counting references to them would cost more than the arithmetic
    return compiled(tile.fill_hits, _nrt=False)


@lru_cache(maxsize=1)
def _directions_kernel() -> Any:
    return compiled(tile.fill_directions, _nrt=False)
