"""Lights replaced by points.

A point light stands for itself. A disk light is its K x K centroids of equal-area strata, or, for the exact disk
(order 0), a product rule: Gauss in the area coordinate u = (r/rho)^2, in which the azimuthal mean is analytic, times
equispaced azimuths. The split rule resolves the walls of every such point by itself, penumbrae included, so the disk
rule only ever sees the smooth dependence of a finished integral on the light's position.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.scene.arrays import DISK, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]

EXACT_RULES: Final = ((1e-5, 2, 4), (1e-7, 3, 6), (0.0, 4, 8))
"""Smallest tolerance, radii and azimuths of the exact disk's product rules."""


def disk_frame(position: Array, target: Array) -> tuple[Array, Array]:
    """(e1, e2) spanning the disk that faces ``target``: w = unit(target - L), e1 = unit(w x up), e2 = w x e1."""
    w = target - position
    w = w / math.sqrt(float(w @ w))
    up = np.array([0.0, 1.0, 0.0]) if abs(w[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    e1 = np.cross(w, up)
    e1 /= math.sqrt(float(e1 @ e1))
    return e1, np.cross(w, e1)


def light_points(arrays: SceneArrays, order: int, tol: float = 0.0) -> Array:
    """(m, 7): position, the light's colour times the point's share, and the point's sign in the embedded rule.

    The embedded rule of an exact disk keeps every other azimuth: its difference from the full rule is the sum of
    contributions times this sign. Zero for every other light. ``tol`` chooses the rule of an exact disk.
    """
    radii, azimuths = next((r, a) for least, r, a in EXACT_RULES if tol >= least)
    rows: list[tuple[float, ...]] = []
    for light in arrays.lights:
        position, color = light[1:4], light[5:8]
        if light[0] != DISK:
            rows.append((*position, *color, 0.0))
            continue
        e1, e2 = disk_frame(position, light[8:11])
        if order == EXACT_DISK:
            nodes, weights = np.polynomial.legendre.leggauss(radii)
            for x, w in zip(nodes, weights, strict=True):
                r = light[4] * math.sqrt(0.5 * (1.0 + x))
                share = color * (0.5 * w / azimuths)
                for j in range(azimuths):
                    angle = 2.0 * math.pi * (j + 0.5) / azimuths
                    point = position + r * (math.cos(angle) * e1 + math.sin(angle) * e2)
                    rows.append((*point, *share, 1.0 - 2.0 * (j % 2)))
            continue
        share = color / (order * order)
        for i in range(order):
            r = light[4] * math.sqrt((i + 0.5) / order)
            for j in range(order):
                angle = 2.0 * math.pi * (j + 0.5) / order
                rows.append((*(position + r * (math.cos(angle) * e1 + math.sin(angle) * e2)), *share, 0.0))
    return np.array(rows).reshape(-1, 7)
