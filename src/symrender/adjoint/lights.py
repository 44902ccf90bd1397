"""How the points that stand for lights move."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import LightMove, LightPoint
from symrender.jit.records import Grid, Table, copied, grid
from symrender.leaves import tangents
from symrender.quadrature.light_points import disk_frame, frame_numbers, light_rows
from symrender.scene.arrays import DISK, SceneArrays
from symrender.scene.records import Frame, Light
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]

LEVEL: Final = 1e-15
"""Height of a light over its distance from the origin of a plane up to which it lies in the plane, but for rounding."""


def light_point_tangents(arrays: SceneArrays, moves: Grid[Light], order: int) -> Grid[LightMove]:
    """(Q, m): how the points of ``light_rows`` move as the lights do by ``moves`` (Q, lights).

    Place and the light's colour times the point's share; of an exact disk also its radius and the turn omega of its
    frame, de = omega x e. A point of a disk is L + a e1 + b e2 with a and b proportional to the radius, so only the
    frame needs a formula.
    """
    if order == EXACT_DISK and (arrays.lights["kind"] == DISK).any():
        return _exact_tangents(arrays, moves)
    points = light_rows(arrays, order)
    white = copied(arrays.lights)
    white["color"][:] = 1.0
    shares = light_rows(replace(arrays, lights=white), order)["color"][:, 0]
    disks = int((arrays.lights["kind"] == DISK).sum())
    size = (len(points) - (len(arrays.lights) - disks)) // max(1, disks)
    moved = grid(LightMove, moves.shape[0], len(points))
    first = 0
    for l, light in enumerate(arrays.lights):
        if light.kind != DISK:
            moved["position"][:, first], moved["color"][:, first] = moves["position"][:, l], moves["color"][:, l]
            first += 1
            continue
        here = slice(first, first + size)
        first = here.stop
        e1, e2 = disk_frame(light.position, light.target)
        offset = points["position"][here] - light.position
        for q in range(moves.shape[0]):
            move = moves[q, l]
            de1, de2 = _frame_tangent(light.position, light.target, move.position, move.target)
            along = np.outer(offset @ e1, de1) + np.outer(offset @ e2, de2)
            moved["position"][q, here] = move.position + along + offset * (move.radius / light.radius)
            moved["color"][q, here] = shares[here, None] * move.color
    return moved


def lights_leaving(
    points: Table[LightPoint], moves: Grid[LightMove], axes: Table[Frame], turns: Grid[Frame]
) -> npt.NDArray[np.bool_]:
    """(Q, planes): whether a point light that lies in a plane leaves it: derivatives of its light there are one-sided.

    The height of a light over a plane is (L - O).up, of planes ``axes`` that move by ``turns`` (Q, planes).
    """
    found = np.zeros((moves.shape[0], len(axes)), np.bool_)
    for i, light in enumerate(points):
        for k, frame in enumerate(axes):
            away = light.position - frame.origin
            if light.radius > 0.0 or abs(away @ frame.up) > LEVEL * np.abs(away).sum():
                continue
            for q in range(moves.shape[0]):
                rise = (moves[q, i].position - turns[q, k].origin) @ frame.up + turns[q, k].up @ away
                found[q, k] = found[q, k] or rise != 0.0
    return found


def _exact_tangents(arrays: SceneArrays, moves: Grid[Light]) -> Grid[LightMove]:
    """Of exact disks, which ``light_rows`` puts behind all other lights."""
    disks = arrays.lights["kind"] == DISK
    order = [*np.nonzero(~disks)[0].tolist(), *np.nonzero(disks)[0].tolist()]
    moved = grid(LightMove, moves.shape[0], len(order))
    for row, l in enumerate(order):
        light = arrays.lights[l]
        for q in range(moves.shape[0]):
            move, found = moves[q, l], moved[q, row]
            found.position[:], found.color[:] = move.position, move.color
            if disks[l]:
                frame = disk_frame(light.position, light.target)
                change = _frame_tangent(light.position, light.target, move.position, move.target)
                axis, axis_change = np.cross(*frame), np.cross(frame[0], change[1]) + np.cross(change[0], frame[1])
                turned = zip((*frame, axis), (*change, axis_change), strict=True)
                found.radius = move.radius
                found.turn[:] = 0.5 * sum(np.cross(e, de) for e, de in turned)
    return moved


def _frame_tangent(position: Array, target: Array, dposition: Array, dtarget: Array) -> tuple[Array, Array]:
    """Derivative of ``disk_frame``, of which a step of its light's place is one back of its target's."""
    told: Array = np.array(tangents.disk_frame_tangents(*frame_numbers(position, target)))
    change = (dtarget - dposition) @ told.reshape(4, 9)[1:]
    return change[3:6], change[6:]
