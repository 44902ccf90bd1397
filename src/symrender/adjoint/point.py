"""The lobe integral of surface points, differentiated: values of the split rule with exact gradients.

The rule runs as it always does, its accepted panels are replayed with their adjoint (``adjoint/panel.py``), and the
adjoint is contracted with how every number of the chart moves. The adjoint costs the same for one parameter and for a
hundred; only the last contraction knows how many there are.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_rows
from symrender.adjoint.grid import GRID_ROWS, contrast_of, replay_grid
from symrender.adjoint.lights import LEVEL, light_point_tangents
from symrender.adjoint.line import HERE_ROWS
from symrender.adjoint.lobe import fill_own, gradient_rim, own_moves
from symrender.adjoint.lobe_mass import horizon_slopes, normaliser_slopes
from symrender.adjoint.moves import fastest_of, pace, what_moves
from symrender.adjoint.panel import (
    SUMS,
    UNUSED,
    clear_panels,
    contract,
    panels_in_use,
    radial_walls,
    replay_chart,
)
from symrender.adjoint.rooms import moves_in_frame, side_moves
from symrender.adjoint.walls import (
    AMBIENT,
    AT_POINT,
    AXIS,
    BACKGROUND,
    BRIGHT,
    CHART,
    CHART_RADIUS,
    DARK,
    EYE,
    FREQUENCY,
    GRID,
    HORIZON_NORMAL,
    LIGHTS,
    LOG_NORMALISER,
    ONE_SIDED,
    SHADING,
    TURN,
    adjoint_columns,
)
from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.listed import in_lobe
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.mass import cap_share, tilt_of
from symrender.chambers.lobes.units import is_brdf
from symrender.chambers.lobes.width import fastest_fall
from symrender.chambers.records import Chart, Event, LightMove
from symrender.chambers.work import MAX_WALLS, Frames, View, Work, begin_counts, scene_frames, scene_view
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Grid, Table, joined, one, stacked, table
from symrender.quadrature.fall_off import most_floor_light
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.mirror import NARROWEST
from symrender.quadrature.records import Conic, Panel, Remainder, Span
from symrender.quadrature.split_panel import split_chart
from symrender.quadrature.split_point import SplitWork, radiance_bound, split_work
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
from symrender.scene.arrays import CHECKER, FIRST_SPHERE, FLOOR, MARBLE, SceneArrays, lobes_of
from symrender.scene.frames import floor_of, frame_moves
from symrender.scene.moves import SceneMoves
from symrender.scene.records import Floor, Frame, Shading, Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ROUNDED_ELLIPSE: Final = 2e-13
"""Error of a mean over a narrow rim's ellipse on the floor, over the square of its distance over its half-width."""
ROUNDED_ROOT: Final = 1e-8
"""That of an integral along the ellipse, over its distance over its half-width."""

BUDGET: Final = 4
"""Evaluations a derivative may take over those of its value: a value's rule, then two orders of every panel of it."""

AIM: Final = 2.0
"""Panels are refined until so many times the sum of their errors is within the tolerance."""
SAFETY: Final = 3.0
"""Error reported over the change between the last two orders, summed over panels."""


class Tangents(NamedTuple):
    """Derivatives of a scene and of N points in Q parameters: records of the same kinds, of each parameter.

    ``place``, ``normal``, ``incoming`` (Q, N, 3); ``points`` as of ``light_point_tangents``; ``eye`` (Q, 3); of
    every plane, the floor first, what it is made of and its frame.
    """

    place: Array
    normal: Array
    incoming: Array
    spheres: Grid[Sphere]
    floors: Grid[Floor]
    turns: Grid[Frame]
    points: Grid[LightMove]
    shading: Table[Shading]
    eye: Array


class TangentWork(NamedTuple):
    """Scratch of one thread: a place, one wall's and one panel's adjoints, how a chart's columns move, the same in a
    plane's coordinates, which walls do, two orders, what was left out."""

    here: Array
    own: Array
    sums: Array
    moves: Array
    framed: Array
    moving: Array
    low: Array
    high: Array
    value: Array
    error: Array
    square: Array
    shorter: Array
    longer: Array
    misses: Array
    beyond: Array


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


@jitable
def point_moves(i: int, tangents: Tangents, frames: Frames, moves: Array) -> None:
    """Fill the columns of ``moves`` that belong to point ``i`` and to the scene's lights and shapes, the rest 0."""
    for p in range(moves.shape[0]):
        row, shading = moves[p], tangents.shading[p]
        for k in range(row.shape[0]):
            row[k] = 0.0
        for a in range(3):
            row[AT_POINT + a] = tangents.place[p, i, a]
            row[HORIZON_NORMAL + a] = tangents.normal[p, i, a]
            row[AMBIENT + a] = shading.ambient[a]
            row[BACKGROUND + a] = shading.background[a]
            row[EYE + a] = tangents.eye[p, a]
        row[SHADING], row[SHADING + 1] = shading.ka, shading.kd
        row[SHADING + 2], row[SHADING + 3] = shading.ks, shading.shininess
        lights, spheres = tangents.points.shape[1], tangents.spheres.shape[1]
        balls = LIGHTS + 6 * lights
        planes = balls + 4 * spheres
        disks = planes + 4 * frames.axes.shape[0]
        side_moves(p, tangents.turns, frames, row[planes:])
        for l in range(lights):
            light = tangents.points[p, l]
            for a in range(3):
                row[LIGHTS + 6 * l + a], row[LIGHTS + 6 * l + 3 + a] = light.position[a], light.color[a]
                if disks < row.shape[0]:
                    row[disks + 4 * l + 1 + a] = light.turn[a]
            if disks < row.shape[0]:
                row[disks + 4 * l] = light.radius
        for j in range(spheres):
            sphere = tangents.spheres[p, j]
            for a in range(3):
                row[balls + 4 * j + a] = sphere.center[a]
            row[balls + 4 * j + 3] = sphere.radius


@jitable
def lobe_moves(
    i: int, n: float, theta_max: float, own: int, home: int, normal: Array, incoming: Array, tangents: Tangents,
    moves: Array,
) -> None:  # fmt: skip
    """Fill the columns of ``moves`` that belong to the lobe of point ``i``; the rim is the lobe's own.

    The point is of plane ``home`` or, where that is negative, of sphere ``own``.
    """
    by_n, by_theta = normaliser_slopes(n, theta_max)
    for p in range(moves.shape[0]):
        row = moves[p]
        lean, turn = 0.0, 0.0
        for a in range(3):
            lean += incoming[a] * normal[a]
            turn += tangents.incoming[p, i, a] * normal[a] + incoming[a] * tangents.normal[p, i, a]
        for a in range(3):
            row[AXIS + a] = tangents.incoming[p, i, a] - 2.0 * turn * normal[a] - 2.0 * lean * tangents.normal[p, i, a]
        if home >= 0:
            dn, dt = own_moves(tangents.floors[p, home])
        else:
            dn, dt = own_moves(tangents.spheres[p, own])
        fill_own(by_n, by_theta, theta_max, dn, dt, row)


@jitable
def chart_moves(j: int, chart: Chart, tangents: Tangents, moves: Array) -> None:
    """Fill the columns of ``moves`` that belong to the chart of sphere ``j``, -1 for that of a plane.

    The frame of a sphere's chart turns with its pole and no more: omega = c x dc.
    """
    for p in range(moves.shape[0]):
        row = moves[p]
        if j < 0:
            floor = tangents.floors[p, chart.plane]
            for a in range(3):
                row[TURN + a] = 0.0
                row[BRIGHT + a] = floor.bright[a]
                row[DARK + a] = floor.dark[a]
            row[GRID], row[GRID + 1], row[GRID + 2] = floor.cell, floor.offset[0], floor.offset[1]
            row[CHART] = chart.side * row[AT_POINT + 2]
            row[CHART_RADIUS] = row[FREQUENCY] = row[FREQUENCY + 1] = 0.0
            continue
        sphere = tangents.spheres[p, j]
        k, r = chart.ratio, chart.radius
        far = r / k
        move = sphere.center
        x, y, z = move[0] - row[AT_POINT], move[1] - row[AT_POINT + 1], move[2] - row[AT_POINT + 2]
        cx, cy, cz = chart.pole[0], chart.pole[1], chart.pole[2]
        recede = x * cx + y * cy + z * cz
        row[TURN] = (cy * z - cz * y) / far
        row[TURN + 1] = (cz * x - cx * z) / far
        row[TURN + 2] = (cx * y - cy * x) / far
        row[CHART] = (sphere.radius - k * recede) / far
        row[CHART_RADIUS] = sphere.radius
        for a in range(3):
            row[BRIGHT + a] = sphere.color[a]
            row[DARK + a] = 0.0
        row[DARK] = sphere.dark
        row[FREQUENCY], row[FREQUENCY + 1] = sphere.ku, sphere.kv


@jitable
def leave_out(slope: float, moves: Array, beyond: Array) -> None:
    """Add to every parameter's ``beyond`` what it may move of something left out that has this ``slope``."""
    for p in range(moves.shape[0]):
        beyond[p] += slope * pace(moves[p])


@jitable
def outline(chart: Chart) -> float:
    """1 and the length of the charted shape's limb over its solid angle, in radians.

    A derivative over a slope's own motion: what a wall of some height sweeps is its height times the wall's length, and
    what lies below that height over all of the shape holds no more than height times solid angle. A highlight that
    nowhere rises above a height is of bounded variation and sweeps no more than such a wall.
    """
    return 1.0 + 1.0 / math.tan(0.5 * chart.beta_max)


@jitable
def room_left(tol: float, beyond: Array, error: Array) -> float:
    """What one more shape may add to the errors (parameters, 4) of the shapes before: most of what they left."""
    most, tail = 0.0, 0.0
    for p in range(error.shape[0]):
        tail = max(tail, beyond[p])
        for a in range(3):
            most = max(most, error[p, a])
    return max(0.6 * ((tol - tail) / AIM - most), 0.05 * tol)


@jitable
def shape_slopes(
    own: int, lobe: Array, view: View, work: Work, t: TangentWork, moves: Array, gauss: Array, disk: Array | None,
    panels: Table[Panel], spans: Table[Span], ids: Ints, events: Table[Event], scratch: Array, conics: Table[Conic],
    remainders: Table[Remainder], what: Ints, grid: Array, tol: float, spent: float, max_evaluations: int, exact: bool,
) -> float:  # fmt: skip
    """Add what the charted shape adds to derivatives and their errors; the error of its value.

    ``lobe``, ``view`` and ``moves`` are in the chart's coordinates, ``spent`` is the error of the values before.
    Many arguments because spheres and planes ask alike, each with all the scratch there is.
    """
    chart, found = work.chart, 0.0
    nodes, some = what_moves(moves, disk is not None, view, work, t.moving)
    if not nodes and not some:
        return found
    clear_panels(panels)
    chart.pace, chart.least = fastest_of(moves) * outline(chart), math.inf
    found, _ = split_chart(
        max(0.5 * (tol - spent), 0.05 * tol), view, work, gauss, panels, spans, ids, events, scratch, max_evaluations,
        t.sums[0, 0],
    )  # fmt: skip
    # a chart dropped by its bound, for a brightness of ``UNBOUNDED``, has neither value nor slope in doubles
    found = found if panels_in_use(panels) > 0 else 0.0
    if chart.least < math.inf:
        leave_out(chart.least * view.points.shape[0] * outline(chart), moves, t.beyond)
    replay_chart(
        room_left(tol, t.beyond, t.error), lobe, view, work, gauss, disk, panels, spans, ids, events, scratch,
        t.here, t.own, nodes, t.moving, t.sums, moves, exact, max_evaluations, t.value, t.error, t.low,
        t.high, t.misses,
    )  # fmt: skip
    if chart.plane >= 0 and view.floor.kind == CHECKER and chart.side > 0.0:
        # however much was spent before, some is left for the checker
        most = max(max_evaluations, work.counts.evaluations + max_evaluations // 4)
        off = replay_grid(
            room_left(tol, t.beyond, t.error), own, lobe, view, work, conics, remainders, what, gauss, disk, grid,
            t.here, t.own, nodes, t.sums[0], moves, t.low, t.high, t.square, t.shorter, t.longer, t.value, most,
        )  # fmt: skip
        for p in range(moves.shape[0]):
            for a in range(3):
                t.error[p, a] += off
    if radial_walls(lobe, view, work, gauss, disk, scratch, t.here, t.own, t.sums[0]):
        contract(t.sums[0], moves, t.value, 1.0)
    if chart.plane >= 0 and chart.side > 0.0:
        note_level_lights(view, moves, t)
    return found


@jitable
def note_level_lights(view: View, moves: Array, t: TangentWork) -> None:
    """Call one-sided what lifts a point light off the plane in which it lies: all of the plane is lit from there on."""
    for i in range(view.points.shape[0]):
        light = view.points[i]
        reach = abs(light.position[0]) + abs(light.position[1])
        if light.radius > 0.0 or abs(light.position[2]) > LEVEL * reach:
            continue
        for p in range(moves.shape[0]):
            row = moves[p]
            if row[LIGHTS + 6 * i + 2] != 0.0:
                t.value[p, ONE_SIDED] = 1.0


@inlined
def rounded_ellipse(view: View, work: Work) -> tuple[float, float]:
    """What the rounding of a narrow rim's ellipse leaves of a mean over the checkered floor, at most, and of its sweep.

    The ellipse's half-width is the lobe's angle times the distance, taken from squares of its distance from the foot:
    beside a slope of the normaliser, of the inverse of that angle, it is felt. The sweep, for a rim that moves by its
    own angle, feels its square root where rows of the checker touch the ellipse.
    """
    chart, contrast = work.chart, contrast_of(view)
    if contrast == 0.0 or not 0.0 < chart.lobe.rim_sin < math.cos(chart.lobe_beta):
        return 0.0, 0.0
    ratio, light = math.sin(chart.lobe_beta) / chart.lobe.rim_sin, contrast * most_floor_light(view)
    return ROUNDED_ELLIPSE * ratio * ratio * light, ROUNDED_ROOT * ratio * light


@inlined
def rim_speed(row: Array, chart: Chart) -> float:
    """How fast a lobe's rim moves over the floor, in its own angle."""
    axis, place = 0.0, 0.0
    for a in range(3):
        axis += row[AXIS + a] ** 2
        place += row[AT_POINT + a] ** 2
    return (math.sqrt(axis) + math.sqrt(place) / chart.height) / chart.lobe.rim_sin


def gradient_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, lobes: Array, view: View, tangents: Tangents, work:
    Work, tangent_work: TangentWork, gauss: Array, disk: Array | None, panels: Table[Panel], spans: Table[Span], ids:
    Ints, events: Table[Event], scratch: Array, conics: Table[Conic], remainders: Table[Remainder], what: Ints, grid:
    Array, frames: Frames, tol: float, bound: float, max_evaluations: int, exact: bool, gradient: Array, error: Array,
    evaluations: Ints, status: Ints,
) -> None:  # fmt: skip
    """Fill the arrays of a ``GradientResult`` for every point; see ``gloss_gradients``."""
    lobe, axis = scratch[24:27], scratch[50:53]
    chart = work.chart
    t = tangent_work
    count = t.moves.shape[0]
    for i in range(points.shape[0]):
        begin_counts(max_evaluations, work)
        home = frames.homes[surface[i]]
        place_point(points[i], normals[i], incoming[i], home, lobe, view, work)
        own = surface[i] - FIRST_SPHERE
        n, theta_max = lobes[surface[i], 0], lobes[surface[i], 1]
        # a lobe narrower than its rim's rounding has values, but no slopes
        if theta_max < NARROWEST or inside_another(points[i], own, view.spheres):
            for p in range(count):
                error[p, i], status[p, i] = math.inf, UNSUPPORTED
            continue
        point_moves(i, tangents, frames, t.moves)
        lobe_moves(i, n, theta_max, own, home, normals[i], incoming[i], tangents, t.moves)
        gradient_rim(n, theta_max, tol, bound, view.shading.shininess, chart.lobe, t.moves, t.beyond)
        for p in range(count):
            for c in range(4):
                t.value[p, c] = t.error[p, c] = 0.0
        if disk is not None:
            disk[disk.shape[0] - 1, 0] = 0.0

        sky = max(view.shading.background[0], view.shading.background[1], view.shading.background[2])
        alpha = tilt_of(lobe, normals[i])
        share, by_n, by_theta, by_alpha = 1.0, 0.0, 0.0, 0.0
        if alpha + theta_max > 0.5 * math.pi:
            share = cap_share(n, theta_max, alpha, 0.5 * math.pi, gauss)
            if sky > 0.0:
                by_n, by_theta, by_alpha = horizon_slopes(n, theta_max, alpha, share, gauss)
        for p in range(count):
            row = t.moves[p]
            tilt = 0.0
            for a in range(3):
                tilt += row[AXIS + a] * normals[i, a] + lobe[a] * row[HORIZON_NORMAL + a]
            tilt = -tilt / max(math.sin(alpha), 1e-300) if by_alpha != 0.0 else 0.0
            if home >= 0:
                longer, wider = own_moves(tangents.floors[p, home])
            else:
                longer, wider = own_moves(tangents.spheres[p, own])
            change = by_n * longer + by_theta * wider + by_alpha * tilt
            for a in range(3):
                t.value[p, a] += row[BACKGROUND + a] * share + view.shading.background[a] * change

        spent = 0.0
        for j in range(view.spheres.shape[0]):
            ball = view.spheres[j]
            if j == own or not in_lobe(ball.center[0], ball.center[1], ball.center[2], ball.radius, lobe, chart):
                continue
            sphere_chart(j, own, lobe, view, work)
            k = chart.ratio
            # all of the shape, at the lobe's largest density on it, and how fast that can change
            gap = max(0.0, chart.lobe_beta - chart.beta_max)
            most = largest_density(4.0 * math.sin(0.5 * gap) ** 2, chart.lobe) * 2.0 * math.pi * k * k * bound
            slope = fastest_fall(gap, chart.lobe) + outline(chart)
            chart_moves(j, chart, tangents, t.moves)
            if gap < 1.5 and most * slope * fastest_of(t.moves) < 1e-4 * tol:
                spent += most
                leave_out(most * slope, t.moves, t.beyond)
                continue
            sphere_strips(j, view, work)
            spent += shape_slopes(
                own, lobe, view, work, t, t.moves, gauss, disk, panels, spans, ids, events, scratch, conics,
                remainders, what, grid, tol, spent, max_evaluations, exact,
            )  # fmt: skip
        for k in range(view.sides.shape[0]):
            if k == home or work.room[k] == 0.0:
                continue
            stand_in_frame(k, points[i], normals[i], lobe, frames, work, axis)
            framed = frames.views[k]
            floor_chart(k, own, axis, framed, work)
            floor_strips(framed, work)
            moves_in_frame(k, points[i], normals[i], lobe, view, tangents.turns, frames, t.moves, t.framed)
            chart_moves(-1, chart, tangents, t.framed)
            mean, sweep = rounded_ellipse(framed, work)
            if sweep > 0.0:
                for p in range(count):
                    row = t.framed[p]
                    t.beyond[p] += mean * abs(row[LOG_NORMALISER]) + sweep * rim_speed(row, chart)
            spent += shape_slopes(
                own, axis, framed, work, t, t.framed, gauss, disk, panels, spans, ids, events, scratch, conics,
                remainders, what, grid, tol, spent, max_evaluations, exact,
            )  # fmt: skip
        evaluations[i] = work.counts.evaluations
        for p in range(count):
            largest, total = 0.0, 0.0
            for a in range(3):
                gradient[p, i, a] = t.value[p, a]
                largest = max(largest, abs(t.value[p, a]))
                total = max(total, t.error[p, a])
            total = SAFETY * total + t.beyond[p] + 1e-14 * largest
            error[p, i] = total
            status[p, i] = MET if total <= tol else CAPPED
            if disk is not None and disk[disk.shape[0] - 1, 0] != 0.0:
                error[p, i], status[p, i] = math.inf, UNSUPPORTED
            if status[p, i] != UNSUPPORTED and abs(t.value[p, ONE_SIDED]) > 1e-9 * (largest + 1e-12):
                status[p, i] = EVENT


@functools.lru_cache(maxsize=1)
def _kernel() -> Any:
    return compiled(gradient_kernel, _nrt=False)


def tangent_work(parameters: int, lights: int, spheres: int, planes: int, disks: bool) -> TangentWork:
    """Scratch for ``parameters`` derivatives; ``disks``: whether there are exact disks."""
    columns = adjoint_columns(lights, spheres, planes, disks)
    here, own, sums = np.zeros((HERE_ROWS, 3)), np.zeros(columns), np.zeros((SUMS, 4, columns))
    low, high, value, error, square, shorter, longer, misses = np.zeros((8, parameters, 4))
    (moves, framed), moving = np.zeros((2, parameters, columns)), np.zeros(MAX_WALLS + 1)
    return TangentWork(
        here, own, sums, moves, framed, moving, low, high, value, error, square, shorter, longer, misses,
        np.zeros(parameters),
    )  # fmt: skip


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


def tangents_of(
    arrays: SceneArrays, moved: SceneMoves, places: tuple[Array, Array, Array], disk_order: int
) -> Tangents:
    """``Tangents`` from those of the scene's arrays (``scene/moves.py``) and of N points, normals and directions.

    Each of ``places`` is (Q, N, 3).
    """
    lights = light_point_tangents(arrays, moved.lights, disk_order)
    eye = np.ascontiguousarray(moved.camera["eye"])
    place, normal, incoming = map(np.ascontiguousarray, places)
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
    return Tangents(place, normal, incoming, moved.spheres, floors, frames, lights, moved.shading, eye)


def gloss_gradients(
    arrays: SceneArrays,
    points: Array,
    normals: Array,
    incoming: Array,
    surface: Ints,
    tangents: Tangents,
    tol: float = 1e-6,
    disk_order: int = 2,
    max_evaluations: int = BUDGET * 1_000_000,
    scratch: SplitWork | None = None,
) -> GradientResult:
    """d gloss(P)/dp of every point in every parameter of ``tangents``; the other arguments as in ``gloss_points``.

    ``tol`` is absolute, in scene units of radiance over a parameter's unit. Silhouettes, shadows, terminators, texture
    lines, horizon and rim move with the parameters; between events the result is the derivative of the integral, not
    of a sum. Where walls coincide and part, the status is ``EVENT`` and the value belongs to one side.
    """
    lights = light_rows(arrays, disk_order)
    view = scene_view(arrays, lights)
    frames = scene_frames(arrays, view)
    lobes = np.zeros((len(frames.homes), 2))
    lobes[FLOOR:] = lobes_of(arrays)[:, 1:]
    s = scratch or split_work(arrays, lights)
    for panel in s.panels:
        panel.step = UNUSED
    count, n = tangents.place.shape[:2]
    disks = bool((lights["radius"] > 0.0).any())
    own = tangent_work(count, len(lights), len(arrays.spheres), len(frames.axes), disks)
    table = np.zeros((disk_rows(len(arrays.spheres), len(frames.axes)), 3)) if disks else None
    result = GradientResult(
        np.zeros((count, n, 3)), np.zeros((count, n)), np.zeros((count, n), np.int64), np.zeros(n, np.int64)
    )
    _kernel()(
        np.ascontiguousarray(points, dtype=np.float64), np.ascontiguousarray(normals, dtype=np.float64),
        np.ascontiguousarray(incoming, dtype=np.float64), np.ascontiguousarray(surface, dtype=np.int64), lobes, view,
        tangents, s.work, own, s.gauss, table, s.panels, s.spans, s.ids,
        s.events, s.scratch, s.conics, s.remainders, np.zeros((len(s.conics), 4), np.int64), np.zeros((GRID_ROWS, 256)),
        frames, float(tol), radiance_bound(arrays, lights), int(max_evaluations),
        tol < 1e-5, result.gradient, result.error, result.evaluations, result.status,
    )  # fmt: skip
    return result
