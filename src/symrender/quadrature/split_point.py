"""The lobe integral of surface points by splitting at the walls: value, error, evaluations, status."""

from __future__ import annotations

import functools
import math
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.mass import ROUNDED_SHARE, cap_share, facing_mass, tilt_of
from symrender.chambers.lobes.record import Conductor, Sender
from symrender.chambers.lobes.setup import conductor_setup, end_at_horizon, is_conductor, lobe_setup, weigh_by_cosine
from symrender.chambers.unseen import list_seen
from symrender.chambers.work import (
    Frames,
    View,
    begin_counts,
    is_spent,
)
from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined
from symrender.jit.moving import brightest, held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.quadrature.fall_off import is_radiometric
from symrender.quadrature.mirror import NARROWEST, largest_gap, mirror_value
from symrender.quadrature.paces import come_in, is_steady, note_pace, steady_rim
from symrender.quadrature.rule_errors import slope_error
from symrender.quadrature.split_scene import SplitScene, refuse_conductors, split_scene
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import (
    CAPPED,
    MET,
    NEAR_TANGENT,
    UNSUPPORTED,
    charts_to_come,
    inside_another,
    place_point,
    spare_share,
)
from symrender.quadrature.split_shapes import Asked, Stand, add_ball, add_plane
from symrender.scene.arrays import BRDF_NORMALISED, SceneArrays
from symrender.scene.radiometric.records import Glow
from symrender.scene.radiometric.records import Light as Beam

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

STATES: Final = 8
"""More than there are states of a point."""
ROUNDED: Final = 4e-16
"""Relative error of the base of a highlight."""


class SplitResult(NamedTuple):
    """Gloss of N points.

    ``gloss`` (N, 3) in scene units of radiance, without the mirror weight; ``error`` (N,) estimated largest absolute
    error over the channels; ``evaluations`` (N,) shaded hits; ``status`` (N,) ``MET``, ``CAPPED``, ``NEAR_TANGENT`` or
    ``UNSUPPORTED``, of ``split_setup.py``; ``chambers`` (N,) different labels met inside the lobe; ``crossings`` (N,)
    walls met inside it.
    """

    gloss: Array
    error: Array
    evaluations: Ints
    status: Ints
    chambers: Ints
    crossings: Ints


class Places(NamedTuple):
    """Where gloss is asked for: ``points``, unit ``normals`` and ``incoming`` (N, 3), hit classes ``surface`` (N,)."""

    points: Array
    normals: Array
    incoming: Array
    surface: Ints


@inlined
def aim_lobe(i: int, lobes: Array, places: Places, view: View, s: SplitWork, asked: Asked) -> tuple[float, float]:
    """Set the chart's lobe up for place ``i``; (share of the background that it sees, what is left out).

    The background fills what the surface can see of the lobe; every shape then adds its difference from it.
    """
    lobe, chart = s.work.notes.lobe, s.work.chart
    normal, surface = places.normals[i], places.surface[i]
    n, theta_max = lobes[surface, 0], come_in(max(lobes[surface, 1], NARROWEST))
    falling = is_radiometric(view) or view.glows is not None
    if moves(n) and s.work.notes.heed != 0:
        total = steady_rim(n, theta_max, s.work.notes.quick, view.shading.shininess, asked.tol, asked.bound, chart.lobe)
    else:
        total = held(lobe_setup(n, theta_max, 0.0 if falling else asked.tol, asked.bound, chart.lobe) * asked.bound)
    if falling:
        end_at_horizon(normal, lobe, chart.lobe)
    conductor = is_conductor(surface, view.conductors)
    if conductor:
        conductor_setup(surface, lobe, normal, view.conductors, chart.lobe)
        total = 0.0
    brdf = view.shading.units == BRDF_NORMALISED
    if brdf:
        weigh_by_cosine(normal, chart.lobe)
    sky = brightest(view.shading.background)
    if conductor:
        # of it the result is the difference alone: see ``directional_albedo``
        return 0.0, total
    if not sky > 0.0:
        return 1.0, total
    tilt = tilt_of(lobe, normal)
    if brdf:
        share = facing_mass(n, theta_max, tilt, s.gauss)
    else:
        share = cap_share(n, theta_max, tilt, 0.5 * math.pi, s.gauss)
    return share, total + (held(ROUNDED_SHARE * sky) if share < 1.0 else 0.0)


@inlined
def reflect_sharply(
    own: int, view: View, frames: Frames, s: SplitWork, total: float, value: Array
) -> float:  # fmt: skip
    """Put what a mirror sees in place of a lobe that is narrower than lobes are; the error, with the gap of the two."""
    notes, sharp = s.work.notes, s.work.notes.sharp
    total += mirror_value(own, notes.lobe, view, frames, s.work, s.gauss, notes.mirror, notes.coarse, sharp)
    total += largest_gap(value, sharp)
    for a in range(3):
        value[a] = sharp[a]
    return total


def gloss_kernel(
    places: Places, lobes: Array, view: View, frames: Frames, s: SplitWork, asked: Asked, found: SplitResult
) -> None:  # fmt: skip
    """Fill ``found`` for every place; see ``gloss_points``."""
    work, notes = s.work, s.work.notes
    lobe, chart = notes.lobe, work.chart
    # a rounded base errs by so much more as its power is higher
    powers = ROUNDED * view.shading.shininess if view.shading.ks > 0.0 else 0.0
    for i in range(places.points.shape[0]):
        begin_counts(asked.most, work)
        point, normal, surface = places.points[i], places.normals[i], places.surface[i]
        home, own = frames.homes[surface], surface - 2
        place_point(point, normal, places.incoming[i], home, lobe, view, work)
        value = found.gloss[i]
        if inside_another(point, own, view.spheres):
            value[0] = value[1] = value[2] = 0.0
            found.error[i] = math.inf
            found.status[i] = UNSUPPORTED
            found.evaluations[i] = found.chambers[i] = found.crossings[i] = 0
            continue
        conductor = is_conductor(surface, view.conductors)
        if lobes[surface, 1] == 0.0 and not conductor:
            largest = mirror_value(own, lobe, view, frames, work, s.gauss, notes.mirror, notes.coarse, value)
            largest += (1e-15 + powers) * max(abs(value[0]), abs(value[1]), abs(value[2])) + 1e-15
            found.error[i] = largest
            found.evaluations[i], found.chambers[i], found.crossings[i] = work.counts.evaluations, 1, 0
            found.status[i] = MET if largest <= asked.tol else CAPPED
            continue
        notes.holds = notes.errs = 0.0
        if moves(point[0]) and notes.heed != 0:
            note_pace(point, normal, lobe, work)
            notes.steady = int(is_steady(point, normal, lobe, lobes[surface, 0], lobes[surface, 1]))
        share, total = aim_lobe(i, lobes, places, view, s, asked)
        for a in range(3):
            value[a] = view.shading.background[a] * share
        bad = 0
        list_seen(own, lobe, view, work)
        stand = Stand(point, normal, lobe, own, home, conductor)
        left = charts_to_come(brightest(view.shading.background), view, frames, work)
        for b in range(work.counts.balls):
            added, unresolved = add_ball(work.balls[b], spare_share(left), total, stand, view, s, asked, value)
            total += added
            bad += unresolved
            left -= 1
        for k in range(view.sides.shape[0]):
            if k != home and work.room[k] != 0.0:
                total, left, unresolved = add_plane(k, left, total, stand, view, frames, s, asked, value)
                bad += unresolved
        for a in range(3):
            chart.point[a], chart.normal[a] = point[a], normal[a]
        if lobes[surface, 1] < NARROWEST and not conductor:
            # between a mirror and a lobe still wider
            total = reflect_sharply(own, view, frames, s, total, value)
        # nothing in the scene is brighter than the bound, so no error is larger
        largest = max(abs(value[0]), abs(value[1]), abs(value[2]))
        rounded = held(1e-15 + (1e-15 + powers) * largest)
        if moves(total):
            total = slope_error(
                moved(min(held(total) + rounded, asked.bound + held(largest)), tangent(total)), value, notes
            )
        else:
            total = min(total + rounded, asked.bound + largest)
        found.error[i] = total
        found.evaluations[i] = work.counts.evaluations
        found.chambers[i] = work.counts.chambers
        found.crossings[i] = work.counts.crossings
        found.status[i] = MET
        if not total <= asked.tol:
            # what is no number is no value either
            found.error[i] = total if total == total else math.inf
            found.status[i] = CAPPED if bad == 0 or is_spent(work) else NEAR_TANGENT
        if moves(total):
            # a bit for every tangent that is one-sided
            found.status[i] += STATES * work.counts.parted
            if work.counts.refused != 0:
                found.error[i], found.status[i] = moved(math.inf, math.inf), UNSUPPORTED


@functools.lru_cache(maxsize=1)
def gloss_compiled() -> Any:
    """``gloss_kernel``, compiled; it allocates nothing, so counting references would only cost."""
    return compiled(gloss_kernel, _nrt=False)


def gloss_points(
    arrays: SceneArrays,
    points: Array,
    normals: Array,
    incoming: Array,
    surface: Ints,
    tol: float = 1e-6,
    disk_order: int = 2,
    max_evaluations: int = 1_000_000,
    scratch: SplitWork | None = None,
    walled: bool = True,
    conductors: Table[Conductor] | None = None,
    senders: Table[Sender] | None = None,
    emitted: Array | None = None,
    spots: Table[Beam] | None = None,
    glows: Table[Glow] | None = None,
) -> SplitResult:
    """gloss(P) = (1/W) int_cone f(P, w) cos^n theta dw at every point, by quadrature that splits at the walls.

    In BRDF units, int_cone (n + 2)/(2 pi) cos^n theta (w.N) f(P, w) dw: the surface cosine has no walls.

    ``points`` (N, 3) on surfaces, unit ``normals`` (N, 3), unit ``incoming`` (N, 3) directions of travel towards the
    points, ``surface`` (N,) hit classes (1 the floor, 2 + j sphere j, then planes), whose lobe is used. ``tol`` is
    absolute, in scene units of radiance. ``disk_order`` K replaces a disk light by its K x K centroids, 0
    integrates it. Where not ``walled``, a sphere is done on a lattice of directions as far as that is good enough:
    quicker at loose tolerances, and ``chambers`` and ``crossings`` then leave it out. Deterministic; choose it whenever
    an error is wanted with the value, or more than two digits. Points inside a sphere are ``UNSUPPORTED``.

    ``conductors``, a row a hit class, are what surfaces of ``alpha`` > 0 reflect by in place of their lobe: of them the
    result is the integral of f(P, w) D F G/(4 cos_o) over the hemisphere, f less the background, of which they reflect
    their ``directional_albedo``. Raises ``Unsupported`` in BRDF units. ``senders``, a row a sphere and then a row a
    plane, are what shapes send light on by in place of Lambert's term: their colour times kd times pi D F G/(4 cos_o),
    or (n + 2)/2 N.l cos^n, of what arrives. Such a plane is of one colour. ``emitted`` (spheres, 3) is the radiance of
    spheres beside what they reflect. ``spots``, a row a light, say which of them shine into a cone. ``glows`` are skies
    and spheres whose light diffuse shapes send on. Arguments are many because the tables that only some scenes hold are
    apart from their records.
    """
    if conductors is not None:
        refuse_conductors(arrays, conductors, np.asarray(surface))
    scene = split_scene(arrays, disk_order, conductors, senders, emitted, spots, glows)
    work = scratch or split_work(arrays, scene.lights, glows is not None)
    return gloss_at(scene, points, normals, incoming, surface, tol, max_evaluations, work, walled)


def gloss_at(
    scene: SplitScene, points: Array, normals: Array, incoming: Array, surface: Ints, tol: float, max_evaluations: int,
    s: SplitWork, walled: bool = True,
) -> SplitResult:  # fmt: skip
    """``gloss_points`` of a scene that is asked more than once: made ready, of few points, it takes longer than they.

    Conductors are taken as they are.
    """
    n = len(points)
    scales = scene.scales[surface]
    largest = max(float(scales.max(initial=0.0)), 1e-300)
    found = SplitResult(np.zeros((n, 3)), np.zeros(n), *(np.zeros(n, np.int64) for _ in range(4)))
    places = Places(
        np.ascontiguousarray(points, dtype=np.float64), np.ascontiguousarray(normals, dtype=np.float64),
        np.ascontiguousarray(incoming, dtype=np.float64), np.ascontiguousarray(surface, dtype=np.int64),
    )  # fmt: skip
    asked = Asked(float(tol) / largest, scene.bound, int(max_evaluations), bool(walled))
    gloss_compiled()(places, scene.lobes, scene.view, scene.frames, s, asked, found)
    return SplitResult(found.gloss * scales[:, None], found.error * scales, *found[2:])
