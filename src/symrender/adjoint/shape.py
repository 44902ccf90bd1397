"""What one charted shape adds to a point's derivatives: its chart, its checker, and what of it is left out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.adjoint.grid import contrast_of, replay_grid
from symrender.adjoint.lights import LEVEL
from symrender.adjoint.moves import any_moves, fastest_of, pace, used_columns, what_moves
from symrender.adjoint.panel import clear_panels, panels_in_use, replay_chart
from symrender.adjoint.radial_walls import radial_walls
from symrender.adjoint.sums import contract
from symrender.adjoint.walls import AT_POINT, AXIS, LIGHTS, ONE_SIDED
from symrender.adjoint.work import AdjointWork, Charted, TangentWork, Wanted
from symrender.chambers.records import Chart
from symrender.chambers.work import View, Work, is_crowded
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.fall_off import most_floor_light
from symrender.quadrature.split_panel import split_chart
from symrender.scene.arrays import CHECKER

Array = npt.NDArray[np.float64]

ROUNDED_ELLIPSE: Final = 2e-13
"""Error of a mean over a narrow rim's ellipse on the floor, over the square of its distance over its half-width."""
ROUNDED_ROOT: Final = 1e-8
"""That of an integral along the ellipse, over its distance over its half-width."""

AIM: Final = 2.0
"""Panels are refined until so many times the sum of their errors is within the tolerance."""


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
    own: int, lobe: Array, view: View, moves: Array, spent: float, wanted: Wanted, scratch: AdjointWork
) -> float:  # fmt: skip
    """Add what the charted shape adds to derivatives and their errors; the error of its value.

    ``lobe``, ``view`` and ``moves`` are in the chart's coordinates, ``spent`` is the error of the values before.
    """
    work, t, outer, disk = scratch.work, scratch.tangent, scratch.panel, scratch.disk
    chart, found, tol, most = work.chart, 0.0, wanted.tol, wanted.evaluations
    if is_crowded(work):
        for p in range(moves.shape[0]):
            t.beyond[p] = math.inf
        return found
    nodes, some = what_moves(moves, disk is not None, view, work, t.moving)
    if not nodes and not some:
        return found
    used = t.columns[: used_columns(moves, t.columns)]
    lights = any_moves(moves, LIGHTS, LIGHTS + 6 * view.points.shape[0])
    on = Charted(lobe, view, work, scratch.gauss, disk, t, moves, nodes, lights, used)
    clear_panels(outer.panels)
    chart.pace, chart.least = fastest_of(moves) * outline(chart), math.inf
    found, _ = split_chart(
        max(0.5 * (tol - spent), 0.05 * tol), view, work, scratch.gauss, outer.panels, outer.spans, outer.ids,
        outer.events, outer.scratch, t.sums[0, 0],
    )  # fmt: skip
    # a chart dropped by its bound, for a brightness of ``UNBOUNDED``, has neither value nor slope in doubles
    found = found if panels_in_use(outer.panels) > 0 else 0.0
    if chart.least < math.inf:
        leave_out(chart.least * view.points.shape[0] * outline(chart), moves, t.beyond)
    replay_chart(room_left(tol, t.beyond, t.error), wanted.exact, most, outer, on)
    if chart.plane >= 0 and view.floor.kind == CHECKER and chart.side > 0.0:
        # however much was spent before, some is left for the checker
        most = max(most, work.counts.evaluations + most // 4)
        off = replay_grid(room_left(tol, t.beyond, t.error), own, most, on, scratch.grid)
        for p in range(moves.shape[0]):
            for a in range(3):
                t.error[p, a] += off
    if radial_walls(outer.scratch, on, t.sums[0]):
        contract(t.sums[0], moves, t.value)
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
