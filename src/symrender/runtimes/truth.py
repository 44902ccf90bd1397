"""The split rule bound to a scene and a camera: a kernel that fills tiles with values, errors and statuses."""

from __future__ import annotations

import threading
from collections.abc import Mapping

import numpy as np

from symrender.quadrature.disk_direct import disk_direct
from symrender.quadrature.split_point import gloss_at
from symrender.quadrature.split_scene import alike, split_scene
from symrender.quadrature.split_scratch import split_work
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.runtimes.image import TileKernel, prepare_sight
from symrender.runtimes.numba import emitting
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, lobes_of
from symrender.scene.frames import frames
from symrender.settings import EXACT_DISK, Settings

FACTS = ("status", "evaluations", "chambers", "crossings")
"""Layers (h, w) of the split rule's own report, named as in ``SplitResult``."""
DIRECT_SHARE = 0.1
"""Part of the tolerance that the direct light of exact disks may take."""


def lobe_weights(arrays: SceneArrays) -> Array:
    """Weight of the lobe of every hit class."""
    return np.concatenate([[0.0], lobes_of(arrays)[:, 0]])


def showing(arrays: SceneArrays) -> Array:
    """1 for every hit class, 0 for a floor or plane that the camera is behind."""
    eye = arrays.camera.eye
    planes = [(eye - frame.origin) @ frame.up > 0 for frame in frames(arrays.planes)]
    return np.array([1.0, eye[2] > 0, *np.ones(len(arrays.spheres)), *planes], dtype=np.float64)


def prepare(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles to ``settings.tol``, absolute, in scene units of radiance.

    It fills ``layers["radiance"]``, ``["direct"]``, ``["gloss"]`` (h, w, 3), ``["hit_class"]``, ``["error"]`` (of
    radiance: the lobe's weight times that of gloss) and the ``FACTS`` (h, w) of the full image, and returns the
    shaded hits it needed. Deterministic: every pixel is a pure function of
    the scene, the settings and its place.
    """
    if settings.filter != "centre":
        from symrender.runtimes.series_pixels import prepare_series

        return prepare_series(arrays, settings)
    weights = showing(arrays) * lobe_weights(arrays)
    ready = split_scene(arrays, settings.disk_order)
    groups = alike(np.stack([weights, ready.scales]))
    none = np.zeros((0, 3))
    with emitting("image"):
        if weights.any():
            # of no points it is but compiled
            gloss_at(ready, none, none, none, np.zeros(0, np.int64), 1.0, 0, split_work(arrays, ready.lights))
    sight = prepare_sight(arrays, settings)
    size = (settings.height, settings.width, 3)
    # memory is taken only where a tile is written
    places: dict[str, Array] = {name: np.zeros(size) for name in ("place", "normal", "incoming", "albedo")}
    own = threading.local()
    disks = settings.disk_order == EXACT_DISK and bool((arrays.lights["kind"] == at.DISK).any())

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        sight(x0, y0, x1, y1, {**layers, **places})
        seen = layers["hit_class"][y0:y1, x0:x1].astype(np.int64)
        missed = np.zeros(seen.shape)
        if not hasattr(own, "scratch"):
            own.scratch = split_work(arrays, ready.lights)
        if disks:
            rows, columns = np.nonzero(seen != at.NOTHING)
            pixels = (rows + y0, columns + x0)
            light, missed[rows, columns] = disk_direct(
                arrays,
                places["place"][pixels],
                places["normal"][pixels],
                places["incoming"][pixels],
                seen[rows, columns],
                places["albedo"][pixels],
                DIRECT_SHARE * settings.tol,
                (own.scratch.work, own.scratch.gauss),
            )
            layers["direct"][pixels] += light
            layers["radiance"][pixels] += light
            layers["error"][y0:y1, x0:x1] = missed
            layers["status"][y0:y1, x0:x1] = np.where(missed > settings.tol, CAPPED, MET)
        evaluations = 0
        for group in np.unique(groups[seen[weights[seen] > 0]]).tolist():
            rows, columns = np.nonzero(groups[seen] == group)
            pixels = (rows + y0, columns + x0)
            surfaces = seen[rows, columns]
            weight = float(weights[surfaces[0]])
            found = gloss_at(
                ready,
                places["place"][pixels],
                places["normal"][pixels],
                places["incoming"][pixels],
                surfaces,
                (1.0 - DIRECT_SHARE if disks else 1.0) * settings.tol / weight,
                settings.budget,
                own.scratch,
                walled=settings.counts,
            )
            layers["gloss"][pixels] = found.gloss
            layers["radiance"][pixels] += weight * found.gloss
            layers["error"][pixels] = missed[rows, columns] + weight * found.error
            for name in FACTS:
                layers[name][pixels] = getattr(found, name)
            over = layers["error"][pixels] > settings.tol
            layers["status"][pixels] = np.where(over, np.maximum(found.status, CAPPED), MET)
            evaluations += int(found.evaluations.sum())
        return evaluations

    return render
