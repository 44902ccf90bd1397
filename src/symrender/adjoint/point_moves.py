"""How the columns of a point's adjoint move with the parameters: its place, its lobe, its charts, the scene."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.adjoint.lobe import fill_own, own_moves
from symrender.adjoint.lobe_mass import normaliser_slopes
from symrender.adjoint.rooms import side_moves
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
    SHADING,
    TURN,
)
from symrender.adjoint.work import Tangents
from symrender.chambers.records import Chart
from symrender.chambers.work import Frames
from symrender.jit.marks import jitable
from symrender.jit.moving import brightest

Array = npt.NDArray[np.float64]


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
def looks_pace(p: int, tangents: Tangents) -> float:
    """The fastest motion of what only charts know of: colours and textures of all shapes."""
    most = 0.0
    for j in range(tangents.spheres.shape[1]):
        sphere = tangents.spheres[p, j]
        most = max(most, brightest(sphere.color), abs(sphere.dark), abs(sphere.ku), abs(sphere.kv))
    for k in range(tangents.floors.shape[1]):
        floor = tangents.floors[p, k]
        most = max(most, brightest(floor.bright), brightest(floor.dark))
        most = max(most, abs(floor.cell), abs(floor.offset[0]), abs(floor.offset[1]))
    return most
