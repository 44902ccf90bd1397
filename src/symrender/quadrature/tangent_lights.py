"""How the points that stand for lights move."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from symrender.quadrature.light_points import disk_frame, light_rows
from symrender.scene.arrays import DISK, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]


def light_point_tangents(arrays: SceneArrays, tangents: Array, order: int) -> Array:
    """(Q, m, 6): derivatives of the rows of ``light_rows`` as the lights' rows move by ``tangents`` (Q, lights, 11).

    Place and the light's colour times the point's share; (Q, m, 10) where there are exact disks, whose rows go on with
    their radius and with the turn omega of their frame, de = omega x e. A point of a disk is L + a e1 + b e2 with a and
    b proportional to the radius, so only the frame needs a formula.
    """
    if order == EXACT_DISK and (arrays.lights[:, 0] == DISK).any():
        return _exact_tangents(arrays, tangents)
    points = light_rows(arrays, order)
    white = arrays.lights.copy()
    white[:, 5:8] = 1.0
    shares = light_rows(replace(arrays, lights=white), order)["color"][:, 0]
    disks = int((arrays.lights[:, 0] == DISK).sum())
    size = (len(points) - (len(arrays.lights) - disks)) // max(1, disks)
    moved = np.zeros((len(tangents), len(points), 6))
    first = 0
    for l, light in enumerate(arrays.lights):
        if light[0] != DISK:
            moved[:, first, :3], moved[:, first, 3:6] = tangents[:, l, 1:4], tangents[:, l, 5:8]
            first += 1
            continue
        here = slice(first, first + size)
        first = here.stop
        e1, e2 = disk_frame(light[1:4], light[8:11])
        offset = points["position"][here] - light[1:4]
        for q, move in enumerate(tangents[:, l]):
            de1, de2 = _frame_tangent(light[1:4], light[8:11], move[1:4], move[8:11])
            along = np.outer(offset @ e1, de1) + np.outer(offset @ e2, de2)
            moved[q, here, :3] = move[1:4] + along + offset * (move[4] / light[4])
            moved[q, here, 3:6] = shares[here, None] * move[5:8]
    return moved


def _exact_tangents(arrays: SceneArrays, tangents: Array) -> Array:
    """Of exact disks, which ``light_rows`` puts behind all other lights."""
    disks = arrays.lights[:, 0] == DISK
    order = [*np.nonzero(~disks)[0], *np.nonzero(disks)[0]]
    moved = np.zeros((len(tangents), len(order), 10))
    for row, l in enumerate(order):
        light = arrays.lights[l]
        for q, move in enumerate(tangents[:, l]):
            moved[q, row, :3], moved[q, row, 3:6] = move[1:4], move[5:8]
            if disks[l]:
                frame = disk_frame(light[1:4], light[8:11])
                change = _frame_tangent(light[1:4], light[8:11], move[1:4], move[8:11])
                axis, axis_change = np.cross(*frame), np.cross(frame[0], change[1]) + np.cross(change[0], frame[1])
                turned = zip((*frame, axis), (*change, axis_change), strict=True)
                moved[q, row, 6] = move[4]
                moved[q, row, 7:] = 0.5 * sum(np.cross(e, de) for e, de in turned)
    return moved


def _frame_tangent(position: Array, target: Array, dposition: Array, dtarget: Array) -> tuple[Array, Array]:
    """Derivative of ``disk_frame``: w = unit(target - L), e1 = unit(w x up), e2 = w x e1."""
    away = target - position
    far = math.sqrt(float(away @ away))
    w = away / far
    dw = _unit_tangent(w, far, dtarget - dposition)
    up = np.array([0.0, 1.0, 0.0]) if abs(w[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    side = np.cross(w, up)
    length = math.sqrt(float(side @ side))
    e1 = side / length
    de1 = _unit_tangent(e1, length, np.cross(dw, up))
    return de1, np.cross(dw, e1) + np.cross(w, de1)


def _unit_tangent(unit: Array, length: float, change: Array) -> Array:
    moved: Array = (change - (change @ unit) * unit) / length
    return moved
