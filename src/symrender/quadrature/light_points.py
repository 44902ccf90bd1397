"""Lights as rows a kernel can read.

A point light stands for itself. A disk light is its K x K centroids of equal-area strata or, exact (order 0), one row
that carries the disk, which ``quadrature/disk_term.py`` integrates.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_AXIS, DISK_E1, DISK_E2, DISK_RADIUS, LIGHT_POINT_COLUMNS
from symrender.scene.arrays import DISK, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]


def disk_frame(position: Array, target: Array) -> tuple[Array, Array]:
    """(e1, e2) spanning the disk that faces ``target``: w = unit(target - L), e1 = unit(w x up), e2 = w x e1."""
    w = target - position
    w = w / math.sqrt(float(w @ w))
    up = np.array([0.0, 1.0, 0.0]) if abs(w[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    e1 = np.cross(w, up)
    e1 /= math.sqrt(float(e1 @ e1))
    return e1, np.cross(w, e1)


def light_rows(arrays: SceneArrays, order: int) -> Array:
    """(m, LIGHT_POINT_COLUMNS): position and colour of every light point, then of exact disks radius and frame too.

    The points of a K x K disk (``order`` K) share its colour; the columns of a disk are zero elsewhere.
    """
    disks = [light for light in arrays.lights if light[0] == DISK and order == EXACT_DISK]
    rows = [_points(light, order) for light in arrays.lights if light[0] != DISK or order != EXACT_DISK]
    for light in disks:
        row = np.zeros((1, LIGHT_POINT_COLUMNS))
        row[0, :3], row[0, 3:6], row[0, DISK_RADIUS] = light[1:4], light[5:8], light[4]
        e1, e2 = disk_frame(light[1:4], light[8:11])
        row[0, DISK_E1 : DISK_E1 + 3], row[0, DISK_E2 : DISK_E2 + 3] = e1, e2
        row[0, DISK_AXIS : DISK_AXIS + 3] = np.cross(e1, e2)
        rows.append(row)
    return np.concatenate(rows) if rows else np.zeros((0, LIGHT_POINT_COLUMNS))


def _points(light: Array, order: int) -> Array:
    position, color = light[1:4], light[5:8]
    if light[0] != DISK:
        row = np.zeros((1, LIGHT_POINT_COLUMNS))
        row[0, :3], row[0, 3:6] = position, color
        return row
    e1, e2 = disk_frame(position, light[8:11])
    middles = (np.arange(order) + 0.5) / order
    angle = 2.0 * math.pi * middles
    around = np.cos(angle)[:, None] * e1 + np.sin(angle)[:, None] * e2
    rows = np.zeros((order * order, LIGHT_POINT_COLUMNS))
    rows[:, :3] = position + np.kron((light[4] * np.sqrt(middles))[:, None], around)
    rows[:, 3:6] = color / (order * order)
    return rows
