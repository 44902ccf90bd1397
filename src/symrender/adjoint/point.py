"""The lobe integral of surface points, differentiated: values of the split rule with exact gradients.

The rule runs as it always does, its accepted panels are replayed with their adjoint (``adjoint/panel.py``), and the
adjoint is contracted with how every number of the chart moves. The adjoint costs the same for one parameter and for a
hundred; only the last contraction knows how many there are.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import clear_flag, is_flagged
from symrender.adjoint.lights import light_point_tangents
from symrender.adjoint.lobe import gradient_rim, own_moves
from symrender.adjoint.lobe_mass import horizon_slopes
from symrender.adjoint.moves import fastest_of
from symrender.adjoint.panel import UNUSED
from symrender.adjoint.point_moves import chart_moves, lobe_moves, looks_pace, point_moves
from symrender.adjoint.rooms import moves_in_frame
from symrender.adjoint.shape import leave_out, outline, rim_speed, rounded_ellipse, shape_slopes
from symrender.adjoint.sums import clear
from symrender.adjoint.walls import AXIS, BACKGROUND, HORIZON_NORMAL, LOG_NORMALISER, ONE_SIDED
from symrender.adjoint.work import AdjointWork, Tangents, Wanted, adjoint_work
from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.mass import cap_share, tilt_of
from symrender.chambers.lobes.units import is_brdf
from symrender.chambers.lobes.width import fastest_fall
from symrender.chambers.unseen import list_seen
from symrender.chambers.work import Frames, View, begin_counts
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined
from symrender.jit.records import Table, copied, joined, one, stacked, table
from symrender.quadrature.mirror import NARROWEST
from symrender.quadrature.split_scene import SplitScene, radiance_bound, split_scene
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import (
    CAPPED,
    EVENT,
    MET,
    UNSUPPORTED,
    floor_strips,
    inside_another,
    place_point,
    sphere_strips,
    stand_in_frame,
)
from symrender.scene.arrays import FIRST_SPHERE, MARBLE, SceneArrays
from symrender.scene.frames import floor_of, frame_moves
from symrender.scene.moves import SceneMoves
from symrender.scene.records import Floor, Frame

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

BUDGET: Final = 4
"""Evaluations a derivative may take over those of its value: a value's rule, then two orders of every panel of it."""

SAFETY: Final = 3.0
"""Error reported over the change between the last two orders, summed over panels."""


@dataclass(frozen=True)
class GradientResult:
    """Gloss of N points and its derivative in Q parameters.

    ``gradient`` (Q, N, 3); ``error`` (Q, N), estimated largest absolute error over the channels; ``status`` (Q, N),
    ``MET``, ``CAPPED``, ``UNSUPPORTED`` or ``EVENT``; ``evaluations`` (N,), shaded hits, those of the value included.
    """

    gradient: Array
    error: Array
    status: Ints
    evaluations: Ints


class Places(NamedTuple):
    """N points: (N, 3) places, unit normals and incoming directions, (N,) hit classes."""

    points: Array
    normals: Array
    incoming: Array
    surface: Ints


class Slopes(NamedTuple):
    """The arrays of a ``GradientResult``, to be filled."""

    gradient: Array
    error: Array
    status: Ints
    evaluations: Ints


class Owner(NamedTuple):
    """Point ``i``, the sphere ``own`` or, unless -1, the plane ``home`` it lies on; exponent and rim of its lobe."""

    i: int
    own: int
    home: int
    power: float
    rim: float


@inlined
def owner_of(i: int, places: Places, lobes: Array, frames: Frames) -> Owner:
    """What point ``i`` lies on."""
    shape = places.surface[i]
    return Owner(i, shape - FIRST_SPHERE, frames.homes[shape], lobes[shape, 0], lobes[shape, 1])


@inlined
def sky_slopes(at: Owner, normal: Array, view: View, tangents: Tangents, scratch: AdjointWork) -> None:
    """Add the derivatives of the background's share of the lobe."""
    t, background = scratch.tangent, view.shading.background
    n, theta_max = at.power, at.rim
    sky = max(background[0], background[1], background[2])
    alpha = tilt_of(t.lobe, normal)
    share, by_n, by_theta, by_alpha = 1.0, 0.0, 0.0, 0.0
    if alpha + theta_max > 0.5 * math.pi:
        share = cap_share(n, theta_max, alpha, 0.5 * math.pi, scratch.gauss)
        if sky > 0.0:
            by_n, by_theta, by_alpha = horizon_slopes(n, theta_max, alpha, share, scratch.gauss)
    for p in range(t.moves.shape[0]):
        row = t.moves[p]
        tilt = 0.0
        for a in range(3):
            tilt += row[AXIS + a] * normal[a] + t.lobe[a] * row[HORIZON_NORMAL + a]
        tilt = -tilt / max(math.sin(alpha), 1e-300) if by_alpha != 0.0 else 0.0
        if at.home >= 0:
            longer, wider = own_moves(tangents.floors[p, at.home])
        else:
            longer, wider = own_moves(tangents.spheres[p, at.own])
        change = by_n * longer + by_theta * wider + by_alpha * tilt
        for a in range(3):
            t.value[p, a] += row[BACKGROUND + a] * share + background[a] * change


@inlined
def sphere_slopes(at: Owner, view: View, tangents: Tangents, wanted: Wanted, scratch: AdjointWork) -> float:
    """Add what all spheres do; the error of their values."""
    work, t, tol = scratch.work, scratch.tangent, wanted.tol
    chart, lobe = work.chart, t.lobe
    spent = 0.0
    for b in range(work.counts.balls):
        j = work.balls[b]
        sphere_chart(j, at.own, lobe, view, work)
        k = chart.ratio
        # all of the shape, at the lobe's largest density on it, and how fast that can change
        gap = max(0.0, chart.lobe_beta - chart.beta_max)
        most = largest_density(4.0 * math.sin(0.5 * gap) ** 2, chart.lobe) * 2.0 * math.pi * k * k * wanted.bound
        slope = fastest_fall(gap, chart.lobe) + outline(chart)
        chart_moves(j, chart, tangents, t.moves)
        if gap < 1.5 and most * slope * fastest_of(t.moves) < 1e-4 * tol:
            spent += most
            leave_out(most * slope, t.moves, t.beyond)
            continue
        sphere_strips(j, view, work)
        spent += shape_slopes(at.own, lobe, view, t.moves, spent, wanted, scratch)
    return spent


@inlined
def plane_slopes(
    at: Owner, places: Places, view: View, frames: Frames, tangents: Tangents, spent: float, wanted: Wanted,
    scratch: AdjointWork,
) -> None:  # fmt: skip
    """Add what all planes do, the spheres' values having erred by ``spent``."""
    work, t, i = scratch.work, scratch.tangent, at.i
    chart, axis = work.chart, t.axis
    point, normal = places.points[i], places.normals[i]
    for k in range(view.sides.shape[0]):
        if k == at.home or work.room[k] == 0.0:
            continue
        stand_in_frame(k, point, normal, t.lobe, frames, work, axis)
        framed = frames.views[k]
        floor_chart(k, at.own, axis, framed, work)
        floor_strips(framed, work)
        moves_in_frame(k, point, normal, t.lobe, view, tangents.turns, frames, t.moves, t.framed)
        chart_moves(-1, chart, tangents, t.framed)
        mean, sweep = rounded_ellipse(framed, work)
        if sweep > 0.0:
            for p in range(t.framed.shape[0]):
                row = t.framed[p]
                t.beyond[p] += mean * abs(row[LOG_NORMALISER]) + sweep * rim_speed(row, chart)
        spent += shape_slopes(at.own, axis, framed, t.framed, spent, wanted, scratch)


@inlined
def state_slopes(i: int, tol: float, scratch: AdjointWork, out: Slopes) -> None:
    """Fill the results of point ``i``."""
    t = scratch.tangent
    out.evaluations[i] = scratch.work.counts.evaluations
    for p in range(t.value.shape[0]):
        largest, total = 0.0, 0.0
        for a in range(3):
            out.gradient[p, i, a] = t.value[p, a]
            largest = max(largest, abs(t.value[p, a]))
            total = max(total, t.error[p, a])
        total = SAFETY * total + t.beyond[p] + 1e-14 * largest
        out.error[p, i] = total
        out.status[p, i] = MET if total <= tol else CAPPED
        if is_flagged(scratch.disk):
            out.error[p, i], out.status[p, i] = math.inf, UNSUPPORTED
        if out.status[p, i] != UNSUPPORTED and abs(t.value[p, ONE_SIDED]) > 1e-9 * (largest + 1e-12):
            out.status[p, i] = EVENT


def gradient_kernel(
    places: Places, lobes: Array, view: View, frames: Frames, tangents: Tangents, scratch: AdjointWork, wanted: Wanted,
    out: Slopes,
) -> None:  # fmt: skip
    """Fill the arrays of a ``GradientResult`` for every point; see ``gloss_gradients``."""
    work, t = scratch.work, scratch.tangent
    tol, lobe, chart = wanted.tol, t.lobe, work.chart
    for i in range(places.points.shape[0]):
        begin_counts(wanted.evaluations, work)
        at = owner_of(i, places, lobes, frames)
        point, normal, incoming = places.points[i], places.normals[i], places.incoming[i]
        place_point(point, normal, incoming, at.home, lobe, view, work)
        # a lobe narrower than its rim's rounding has values, but no slopes
        if at.rim < NARROWEST or inside_another(point, at.own, view.spheres):
            for p in range(t.moves.shape[0]):
                out.error[p, i], out.status[p, i] = math.inf, UNSUPPORTED
            continue
        point_moves(i, tangents, frames, t.moves)
        lobe_moves(i, at.power, at.rim, at.own, at.home, normal, incoming, tangents, t.moves)
        outside = gradient_rim(
            at.power, at.rim, tol, wanted.bound, view.shading.shininess, chart.lobe, t.moves, t.beyond
        )  # fmt: skip
        for p in range(t.moves.shape[0]):
            t.beyond[p] += outside * looks_pace(p, tangents)
        clear(t.value)
        clear(t.error)
        clear_flag(scratch.disk)
        sky_slopes(at, normal, view, tangents, scratch)
        list_seen(at.own, lobe, view, work)
        spent = sphere_slopes(at, view, tangents, wanted, scratch)
        plane_slopes(at, places, view, frames, tangents, spent, wanted, scratch)
        state_slopes(i, tol, scratch, out)


@functools.lru_cache(maxsize=1)
def _kernel() -> Any:
    return compiled(gradient_kernel, _nrt=False)


def refuse_unknown(arrays: SceneArrays, moved: SceneMoves, names: tuple[str, ...]) -> None:
    """Raise ``Unsupported`` for what this rule cannot differentiate, by name."""
    if is_brdf(arrays):
        raise Unsupported("shading.lobe_units: brdf_normalised is not differentiated; choose lobe_average")
    for q, name in enumerate(names):
        for j in np.nonzero(moved.spheres["ku"][q])[0]:
            if arrays.spheres[int(j)].texture == MARBLE:
                raise Unsupported(
                    f"{name}: the seam of a marble, where its veins jump as ku grows, is not differentiated"
                )


def tangents_of(arrays: SceneArrays, moved: SceneMoves, disk_order: int) -> Tangents:
    """``Tangents`` from those of the scene's arrays (``scene/moves.py``), of no points."""
    lights = light_point_tangents(arrays, moved.lights, disk_order)
    eye = np.ascontiguousarray(moved.camera["eye"])
    nowhere = np.zeros((len(moved.floor), 0, 3))
    first = 1 if arrays.floor.present else 0
    count, planes = len(moved.floor), range(len(arrays.planes))
    turned = frame_moves(arrays.planes, moved.planes)
    made: list[Table[Floor]] = []
    turns: list[Table[Frame]] = []
    for q in range(count):
        floor = [one(moved.floor[q])] if first else []
        made.append(joined(Floor, [*floor, *(floor_of(moved.planes[q, k]) for k in planes)]))
        turns.append(joined(Frame, [table(Frame, first), turned[q]]))
    size = first + len(planes)
    floors, frames = stacked(Floor, made, size), stacked(Frame, turns, size)
    return Tangents(nowhere, nowhere, nowhere, moved.spheres, floors, frames, lights, moved.shading, eye)


@dataclass(frozen=True)
class SlopeScene:
    """A scene and how it moves, made ready once for many points; kernels read it only.

    ``tangents`` are of no points yet, ``bound`` is an upper bound of radiance and of what it changes by if a colour or
    a factor moves.
    """

    arrays: SceneArrays
    split: SplitScene
    tangents: Tangents
    bound: float

    def at(self, moving: tuple[Array, Array, Array]) -> Tangents:
        """The same of points that move so: places, normals and directions, (Q, N, 3) each."""
        place, normal, incoming = map(np.ascontiguousarray, moving)
        return self.tangents._replace(place=place, normal=normal, incoming=incoming)


def slope_scene(arrays: SceneArrays, moved: SceneMoves, disk_order: int) -> SlopeScene:
    """``arrays`` and their moves made ready."""
    split = split_scene(arrays, disk_order)
    tangents = tangents_of(arrays, moved, disk_order)
    lit: Any = copied(split.lights)
    lit["color"] = np.maximum(lit["color"], np.abs(tangents.points["color"]).max(axis=0, initial=0.0))
    shading: Any = copied(arrays.shading)
    for name in ("ka", "kd", "ks", "ambient", "background"):
        shading[name] = np.maximum(shading[name], np.abs(tangents.shading[name]).max(axis=0, initial=0.0))
    return SlopeScene(arrays, split, tangents, radiance_bound(replace(arrays, shading=shading), lit))


def gloss_gradients(
    scene: SlopeScene,
    points: Array,
    normals: Array,
    incoming: Array,
    surface: Ints,
    moving: tuple[Array, Array, Array],
    tol: float = 1e-6,
    max_evaluations: int = BUDGET * 1_000_000,
    scratch: SplitWork | None = None,
) -> GradientResult:
    """d gloss(P)/dp of every point in every parameter of ``scene``; points, surfaces and budget as in ``gloss_points``.

    ``moving``: how points, normals and directions move, (Q, N, 3) each. ``tol`` is absolute, in scene units of radiance
    over a parameter's unit. Silhouettes, shadows, terminators, texture lines, horizon and rim move with the parameters;
    between events the result is the derivative of the integral, not of a sum. Where walls coincide and part, the
    status is ``EVENT`` and the value belongs to one side.
    """
    split, tangents = scene.split, scene.at(moving)
    s = scratch or split_work(scene.arrays, split.lights)
    np.asarray(s.panels)["step"] = UNUSED
    count, n = tangents.place.shape[:2]
    disks = bool((split.lights["radius"] > 0.0).any())
    own = adjoint_work(s, count, len(split.lights), len(scene.arrays.spheres), len(split.frames.axes), disks)
    result = GradientResult(
        np.zeros((count, n, 3)), np.zeros((count, n)), np.zeros((count, n), np.int64), np.zeros(n, np.int64)
    )
    places = Places(
        np.ascontiguousarray(points, dtype=np.float64),
        np.ascontiguousarray(normals, dtype=np.float64),
        np.ascontiguousarray(incoming, dtype=np.float64),
        np.ascontiguousarray(surface, dtype=np.int64),
    )
    wanted = Wanted(float(tol), scene.bound, int(max_evaluations), tol < 1e-5)
    slopes = Slopes(result.gradient, result.error, result.status, result.evaluations)
    _kernel()(places, split.lobes, split.view, split.frames, tangents, own, wanted, slopes)
    return result
