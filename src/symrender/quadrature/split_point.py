"""The lobe integral of surface points by splitting at the walls: value, error, evaluations, status."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.cones import put_cones
from symrender.chambers.jumps import put_jumps
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.mass import ROUNDED_SHARE, cap_share, facing_mass, tilt_of
from symrender.chambers.lobes.record import Conductor, Sender
from symrender.chambers.lobes.setup import conductor_setup, end_at_horizon, is_conductor, lobe_setup, weigh_by_cosine
from symrender.chambers.records import Event, LightPoint
from symrender.chambers.rooms import in_a_plane
from symrender.chambers.unseen import list_seen
from symrender.chambers.work import (
    MAX_ROOTS,
    Frames,
    View,
    Work,
    begin_counts,
    is_spent,
    work_arrays,
)
from symrender.jit.compiled import compiled
from symrender.jit.moving import brightest, held, moves
from symrender.jit.records import Table, table
from symrender.quadrature.fall_off import chart_bound, is_radiometric, plane_bound, sphere_bound
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.grid_tail import MOST_REMAINDERS
from symrender.quadrature.lattice_sphere import aim_lattice, lattice_sum
from symrender.quadrature.mirror import NARROWEST, largest_gap, mirror_value
from symrender.quadrature.panel_rule import stretched
from symrender.quadrature.records import Conic, Panel, Remainder, Span
from symrender.quadrature.rule_errors import slope_error
from symrender.quadrature.split_grid import split_grid
from symrender.quadrature.split_panel import split_chart
from symrender.quadrature.split_scene import SplitScene, refuse_conductors, split_scene
from symrender.quadrature.split_setup import (
    CAPPED,
    EVENT,
    MET,
    NEAR_TANGENT,
    UNSUPPORTED,
    charts_to_come,
    floor_strips,
    inside_another,
    place_point,
    spare_share,
    sphere_strips,
    stand_in_frame,
)
from symrender.quadrature.veins import veined_table
from symrender.scene.arrays import BRDF_NORMALISED, MARBLE, SOLID, SceneArrays
from symrender.scene.radiometric.records import Glow
from symrender.scene.radiometric.records import Light as Beam

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MAX_PANELS: Final = 4000
ROUNDED: Final = 4e-16
"""Relative error of the base of a highlight."""


@dataclass(frozen=True)
class SplitResult:
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


def gloss_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, lobes: Array, view: View, work: Work, gauss: Array,
    panels: Table[Panel], spans: Table[Span], ids: Ints, events: Table[Event], scratch: Array, tol: float, bound: float,
    max_evaluations: int, walled: bool, gloss: Array, error: Array, evaluations: Ints, status: Ints, chambers: Ints,
    crossings: Ints, conics: Table[Conic], remainders: Table[Remainder], states: Array, grid_stack: Array,
    frames: Frames,
) -> None:  # fmt: skip
    """Fill the arrays of a ``SplitResult`` for every point; see ``gloss_points``."""
    lobe, axis = scratch[24:27], scratch[50:53]
    chart = work.chart
    # a rounded base errs by so much more as its power is higher
    powers = ROUNDED * view.shading.shininess if view.shading.ks > 0.0 else 0.0
    falling = is_radiometric(view) or view.glows is not None
    # what planes send is then bounded by their lights
    shown = falling or view.emitted is not None
    for i in range(points.shape[0]):
        begin_counts(max_evaluations, work)
        home = frames.homes[surface[i]]
        place_point(points[i], normals[i], incoming[i], home, lobe, view, work)
        own = surface[i] - 2
        n, theta_max = lobes[surface[i], 0], max(lobes[surface[i], 1], NARROWEST)
        value = gloss[i]
        if inside_another(points[i], own, view.spheres):
            value[0] = value[1] = value[2] = 0.0
            error[i] = math.inf
            status[i] = UNSUPPORTED
            evaluations[i] = chambers[i] = crossings[i] = 0
            continue
        conductor = is_conductor(surface[i], view.conductors)
        if lobes[surface[i], 1] == 0.0 and not conductor:
            largest = mirror_value(own, lobe, view, frames, work, gauss, scratch[53:62], scratch[28:31], value)
            error[i] = largest + (1e-15 + powers) * max(abs(value[0]), abs(value[1]), abs(value[2])) + 1e-15
            evaluations[i], chambers[i], crossings[i] = work.counts.evaluations, 1, 0
            status[i] = MET if error[i] <= tol else CAPPED
            continue
        total = held(lobe_setup(n, theta_max, 0.0 if falling else tol, bound, chart.lobe) * bound)
        scratch[62] = scratch[63] = scratch[64] = 0.0
        if falling:
            end_at_horizon(normals[i], lobe, chart.lobe)
        if conductor:
            conductor_setup(surface[i], lobe, normals[i], view.conductors, chart.lobe)
            total = 0.0
        brdf = view.shading.units == BRDF_NORMALISED
        if brdf:
            weigh_by_cosine(normals[i], chart.lobe)

        # the background fills what the surface can see of the lobe; every shape then adds its difference from it
        sky = brightest(view.shading.background)
        share = 1.0
        if conductor:
            # of it the result is the difference alone: see ``directional_albedo``
            share = 0.0
        elif sky > 0.0:
            tilt = tilt_of(lobe, normals[i])
            if brdf:
                share = facing_mass(n, theta_max, tilt, gauss)
            else:
                share = cap_share(n, theta_max, tilt, 0.5 * math.pi, gauss)
            total += held(ROUNDED_SHARE * sky) if share < 1.0 else 0.0
        for a in range(3):
            value[a] = view.shading.background[a] * share
        bad = 0
        list_seen(own, lobe, view, work)
        left = charts_to_come(sky, view, frames, work)
        for b in range(work.counts.balls):
            j = work.balls[b]
            part = spare_share(left)
            left -= 1
            if not walled and not conductor and not in_a_plane(view, work):
                mass = aim_lattice(j, lobe, view, work)
                if mass >= 0.0:
                    spare = max(part * (tol - total), min(0.05, part) * tol)
                    bright = sphere_bound(j, view, chart)
                    e = lattice_sum(j, own, spare, mass, bright, max_evaluations, view, work, value)
                    if e >= 0.0:
                        total += held(e)
                        continue
            sphere_chart(j, own, lobe, view, work)
            k = chart.ratio
            # all of the shape, at the lobe's largest density on it
            gap = max(0.0, chart.lobe_beta - chart.beta_max)
            most = largest_density(4.0 * math.sin(0.5 * gap) ** 2, chart.lobe) * 2.0 * math.pi * k * k * bound
            if gap < 1.5 and most < min(0.1, part) * tol:
                total += held(most)
                continue
            put_cones(view, work)
            put_jumps(view, work)
            sphere_strips(j, view, work)
            chart.bright = chart_bound(sphere_bound(j, view, chart), view, work)
            e, unresolved = split_chart(
                max(part * (tol - total), min(0.05, part) * tol), view, work, gauss, panels, spans, ids, events,
                scratch, value,
            )  # fmt: skip
            total += e
            bad += unresolved
        for k in range(view.sides.shape[0]):
            if k == home or work.room[k] == 0.0:
                continue
            stand_in_frame(k, points[i], normals[i], lobe, frames, work, axis)
            if brdf:
                weigh_by_cosine(chart.normal, chart.lobe)
            front = work.room[k] > 0.0
            if not front and sky == 0.0:
                continue
            framed = frames.views[k]
            floor_chart(k, own, axis, framed, work)
            put_cones(framed, work)
            put_jumps(framed, work)
            floor_strips(framed, work)
            chart.bright = chart_bound(plane_bound(framed) if shown else bound, framed, work)
            part = spare_share(left)
            left -= 1
            e, unresolved = split_chart(
                max(part * (tol - total), 0.05 * tol), framed, work, gauss, panels, spans, ids, events, scratch,
                value,
            )  # fmt: skip
            total += e
            bad += unresolved
            if not front or framed.floor.kind == SOLID:
                continue
            # unlike panels, blocks of a checker may end a little above what they were given
            part = min(0.5, spare_share(left))
            left -= 1
            contrast = 0.0
            for a in range(3):
                half = 0.5 * view.shading.kd * (framed.floor.bright[a] - framed.floor.dark[a])
                scratch[16 + a] = half
                scratch[20 + a] = 0.0
                contrast = max(contrast, abs(half))
            if contrast > 0.0:
                e, unseen = split_grid(
                    max(part * (tol - total), 0.05 * tol) / contrast, own, axis, framed, work, conics, gauss,
                    states, grid_stack, remainders, max_evaluations, scratch[20:23],
                )  # fmt: skip
                total += stretched(contrast) * e
                if moves(total):
                    scratch[64] += held(stretched(contrast)) * (held(e) - unseen)
                for a in range(3):
                    value[a] += scratch[16 + a] * scratch[20 + a]
        for a in range(3):
            chart.point[a], chart.normal[a] = points[i, a], normals[i, a]
        if lobes[surface[i], 1] < NARROWEST and not conductor:
            # between a mirror and a lobe still wider
            total += mirror_value(own, lobe, view, frames, work, gauss, scratch[53:62], scratch[28:31], scratch[31:34])
            total += largest_gap(value, scratch[31:34])
            for a in range(3):
                value[a] = scratch[31 + a]
        # nothing in the scene is brighter than the bound, so no error is larger
        largest = max(abs(value[0]), abs(value[1]), abs(value[2]))
        total = min(total + held(1e-15 + (1e-15 + powers) * largest), bound + largest)
        error[i] = total = slope_error(total, value, scratch) if moves(total) else total
        evaluations[i] = work.counts.evaluations
        chambers[i] = work.counts.chambers
        crossings[i] = work.counts.crossings
        status[i] = MET
        if not total <= tol:
            # what is no number is no value either
            error[i] = total if total == total else math.inf
            status[i] = CAPPED if bad == 0 or is_spent(work) else NEAR_TANGENT
        if moves(total) and work.counts.parted != 0:
            status[i] = EVENT


@functools.lru_cache(maxsize=1)
def gloss_compiled() -> Any:
    """``gloss_kernel``, compiled; it allocates nothing, so counting references would only cost."""
    return compiled(gloss_kernel, _nrt=False)


@dataclass(frozen=True)
class SplitWork:
    """Scratch of one thread; allocate once per thread and pass it to every call."""

    work: Work
    gauss: Array
    panels: Table[Panel]
    spans: Table[Span]
    ids: Ints
    events: Table[Event]
    scratch: Array
    conics: Table[Conic]
    remainders: Table[Remainder]
    states: Array
    grid_stack: Array


def split_work(arrays: SceneArrays, points: Table[LightPoint], glowing: bool = False) -> SplitWork:
    """Scratch for ``gloss_points`` on a scene whose lights are ``points`` (see ``light_rows``), with glows or not."""
    balls, planes = len(arrays.spheres), len(arrays.planes)
    touching = balls * (balls - 1) + 2 * balls * planes if glowing else 0
    return SplitWork(
        work=work_arrays(len(arrays.spheres), len(points)),
        gauss=veined_table() if (arrays.planes["kind"] == MARBLE).any() else gauss_table(),
        panels=table(Panel, MAX_PANELS),
        spans=table(Span, 256),
        ids=np.zeros((3, MAX_ROOTS + 8), np.int64),
        events=table(Event, 2048),
        scratch=np.zeros(65),
        conics=table(Conic, 3 + planes + (2 + len(points)) * balls + 2 * len(points) + touching),
        remainders=table(Remainder, MOST_REMAINDERS),
        states=np.zeros(max(1, len(points))),
        grid_stack=np.zeros((256, 256)),
    )


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
    gloss, error = np.zeros((n, 3)), np.zeros(n)
    counts = [np.zeros(n, np.int64) for _ in range(4)]
    gloss_compiled()(
        np.ascontiguousarray(points, dtype=np.float64), np.ascontiguousarray(normals, dtype=np.float64),
        np.ascontiguousarray(incoming, dtype=np.float64), np.ascontiguousarray(surface, dtype=np.int64), scene.lobes,
        scene.view, s.work, s.gauss, s.panels, s.spans, s.ids, s.events, s.scratch, float(tol) / largest, scene.bound,
        int(max_evaluations), bool(walled), gloss, error, *counts,
        s.conics, s.remainders, s.states, s.grid_stack, scene.frames,
    )  # fmt: skip
    return SplitResult(gloss * scales[:, None], error * scales, *counts)
