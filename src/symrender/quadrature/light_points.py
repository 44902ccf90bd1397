"""Lights replaced by points: a point light by itself, a disk light by the centroids of K x K equal-area strata."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.scene.arrays import DISK, SceneArrays

Array = npt.NDArray[np.float64]


def disk_frame(position: Array, target: Array) -> tuple[Array, Array]:
    """(e1, e2) spanning the disk that faces ``target``: w = unit(target - L), e1 = unit(w x up), e2 = w x e1."""
    w = target - position
    w = w / math.sqrt(float(w @ w))
    up = np.array([0.0, 1.0, 0.0]) if abs(w[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    e1 = np.cross(w, up)
    e1 /= math.sqrt(float(e1 @ e1))
    return e1, np.cross(w, e1)


def light_points(arrays: SceneArrays, order: int) -> Array:
    """(m, 6): position, then colour over the number of the light's points; in the order of the scene's lights."""
    rows: list[tuple[float, ...]] = []
    for light in arrays.lights:
        position, color = light[1:4], light[5:8]
        if light[0] != DISK:
            rows.append((*position, *color))
            continue
        e1, e2 = disk_frame(position, light[8:11])
        share = color / (order * order)
        for i in range(order):
            r = light[4] * math.sqrt((i + 0.5) / order)
            for j in range(order):
                angle = 2.0 * math.pi * (j + 0.5) / order
                rows.append((*(position + r * (math.cos(angle) * e1 + math.sin(angle) * e2)), *share))
    return np.array(rows).reshape(-1, 6)
