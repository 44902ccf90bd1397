"""Lights as records a kernel can read.

A point light stands for itself. A disk light is its K x K centroids of equal-area strata or, exact (order 0), one
record that carries the disk, which ``quadrature/disk_term.py`` integrates.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import DISTANT, INVERSE_SQUARE, LINEAR, SMOOTH, LightPoint
from symrender.jit.records import Table, joined, table
from symrender.leaves import values
from symrender.scene import arrays as at
from symrender.scene.arrays import DISK, SceneArrays
from symrender.scene.radiometric.arrays import SPOT
from symrender.scene.radiometric.records import Light as Beam
from symrender.scene.records import Light
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]


def disk_frame(position: Array, target: Array) -> tuple[Array, Array]:
    """(e1, e2) spanning the disk that faces ``target``."""
    frame: Array = np.array(values.disk_frame(*frame_numbers(position, target)))
    return frame[3:6], frame[6:]


def frame_numbers(position: Array, target: Array) -> Array:
    """What the frame of a disk is made of: L, the target and ``up``, which is x for a disk that faces along y."""
    _, y, *_ = values.heading(*(target - position))
    return np.concatenate((position, target, (0.0, 1.0, 0.0) if abs(y) < 0.9 else (1.0, 0.0, 0.0)))


def light_rows(arrays: SceneArrays, order: int, spots: Table[Beam] | None = None) -> Table[LightPoint]:
    """Position and colour of every light point, then of exact disks radius and frame too.

    The points of a K x K disk (``order`` K) share its colour; the fields of a disk are zero elsewhere. ``spots``, a row
    a light where none is a disk, say which of them shine into a cone.
    """
    disks = [light for light in arrays.lights if light.kind == DISK and order == EXACT_DISK]
    rows = [_points(light, order) for light in arrays.lights if light.kind != DISK or order != EXACT_DISK]
    points = joined(LightPoint, [*rows, *map(_whole, disks)])
    for point, spot in zip(points, spots if spots is not None else (), strict=spots is not None):
        if spot.kind == SPOT:
            point.axis[:], point.beam, point.cutoff = spot.axis, spot.beam, spot.cutoff
            point.spot = SMOOTH if spot.smooth else LINEAR
    return points


def _whole(light: Light) -> Table[LightPoint]:
    rows = table(LightPoint, 1)
    row = rows[0]
    row.position[:], row.color[:], row.radius = light.position, light.color, light.radius
    row.e1[:], row.e2[:] = disk_frame(light.position, light.target)
    row.axis[:] = np.cross(row.e1, row.e2)
    return rows


def _points(light: Light, order: int) -> Table[LightPoint]:
    position, color = light.position, light.color
    if light.kind != DISK:
        rows = table(LightPoint, 1)
        rows["position"][:], rows["color"][:] = position, color
        rows["fall"][:] = {at.FALLING: INVERSE_SQUARE, at.DISTANT: DISTANT}.get(int(light.kind), 0.0)
        return rows
    e1, e2 = disk_frame(position, light.target)
    middles = (np.arange(order) + 0.5) / order
    angle = 2.0 * math.pi * middles
    around = np.cos(angle)[:, None] * e1 + np.sin(angle)[:, None] * e2
    rows = table(LightPoint, order * order)
    rows["position"][:] = position + np.kron((light.radius * np.sqrt(middles))[:, None], around)
    rows["color"][:] = color / (order * order)
    return rows
