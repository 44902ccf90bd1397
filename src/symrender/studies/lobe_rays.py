"""The rays of a lobe, one by one: what each sees, and on which side of every wall it lies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import segment_meets, texture_side
from symrender.chambers.lobes.units import is_brdf, lobe_scale
from symrender.jit.compiled import compiled
from symrender.jit.records import Table
from symrender.quadrature.disk import light_points
from symrender.runtimes import image as symbolic
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, lobes_of
from symrender.scene.records import Sphere

Labels = npt.NDArray[np.int64]

BELOW: Final = -1
"""Visibility label of a direction below the horizon."""
SHAPE, TEXTURE, LIGHTS = 0, 1, 2
"""Columns of labels: shape seen or ``BELOW``, side of its texture, then ``BEHIND``, ``SHADED`` or ``LIT`` a light."""
BEHIND, SHADED, LIT = 0, 1, 2


@dataclass(frozen=True)
class Seen:
    """Radiance (N, 3), zero below the horizon, and labels (N, 2 + light points) of N rays of one lobe.

    In BRDF units radiance counts with its cosine to the normal and the lobe's scale, so that a rule whose weights sum
    to one gives gloss in either.
    """

    radiance: Array
    labels: Labels


class LobeRays:
    """Rays of the lobes of one scene."""

    def __init__(self, arrays: SceneArrays, disk_order: int) -> None:
        self._arrays, self._order = arrays, disk_order
        self._formulas: Any = numba.plain(numba.image_text())
        self._points = light_points(arrays.lights, disk_order, self._formulas.light_point)
        self._label = compiled(_label)

    def frame(self, incoming: Array, normal: Array) -> Array:
        """(u1, u2, m) as rows: the lobe's frame about the mirror direction, that of the strata kernels."""
        m = incoming - 2.0 * float(incoming @ normal) * normal
        parts = self._formulas.frame(*m.tolist())
        return np.array([parts[:3], parts[3:], m])

    def see(self, place: Array, normal: Array, leaves: int, directions: Array) -> Seen:
        """What unit ``directions`` (N, 3) in the world see from ``place`` on the shape of hit class ``leaves``."""
        start = np.broadcast_to(place, directions.shape)
        radiance, shape, distance = symbolic.trace(self._arrays, start, directions, leaves, self._order)
        below = directions @ normal <= 0.0
        radiance *= self._counts(normal, leaves, directions)
        radiance[below] = 0.0
        shape[below] = BELOW
        labels = np.ones((len(directions), LIGHTS + len(self._points)), np.int64)
        labels[:, SHAPE] = shape
        hits = place + directions * np.where(np.isfinite(distance), distance, 0.0)[:, None]
        self._label(hits, self._arrays.spheres, self._points, labels)
        return Seen(radiance, labels)

    def buried(self, place: Array, normal: Array, leaves: int, directions: Array, weights: Array) -> Array:
        """Weighted radiance (3,) of the directions below the horizon, were they not black."""
        below = directions @ normal <= 0.0
        if not below.any():
            return np.zeros(3)
        start = np.broadcast_to(place, (int(below.sum()), 3))
        radiance = symbolic.trace(self._arrays, start, directions[below], leaves, self._order)[0]
        seen: Array = weights[below] @ (radiance * self._counts(normal, leaves, directions[below]))
        return seen

    def _counts(self, normal: Array, leaves: int, directions: Array) -> Array:
        """What each direction counts beside its weight, (N, 1): 1, or the scale times |w.N| in BRDF units."""
        if not is_brdf(self._arrays):
            return np.ones((len(directions), 1))
        row = lobes_of(self._arrays)[leaves - at.FLOOR]
        counts: Array = np.abs(directions @ normal)[:, None] * lobe_scale(self._arrays, row[1], row[2])
        return counts


def _label(hits: Array, spheres: Table[Sphere], points: Array, labels: Labels) -> None:
    """Fill the texture and light columns of rays whose shape column is known."""
    for r in range(len(hits)):
        shape = labels[r, 0]
        if shape < at.FLOOR:
            continue
        own = shape - at.FIRST_SPHERE
        qx, qy, qz = hits[r, 0], hits[r, 1], hits[r, 2]
        nx, ny, nz = 0.0, 0.0, 1.0
        if own >= 0:
            s = spheres[own]
            nx, ny, nz = qx - s.center[0], qy - s.center[1], qz - s.center[2]
            length = math.sqrt(nx * nx + ny * ny + nz * nz)
            nx, ny, nz = nx / length, ny / length, nz / length
            labels[r, 1] = texture_side(spheres, own, nx, ny, nz)
        for i in range(len(points)):
            lx, ly, lz = points[i, 0] - qx, points[i, 1] - qy, points[i, 2] - qz
            if not lx * nx + ly * ny + lz * nz > 0.0:
                labels[r, 2 + i] = BEHIND
                continue
            labels[r, 2 + i] = LIT
            for k in range(len(spheres)):
                t = spheres[k]
                c = t.center
                if k != own and segment_meets(qx, qy, qz, lx, ly, lz, c[0], c[1], c[2], t.radius):
                    labels[r, 2 + i] = SHADED
                    break
