"""The split rule bound to a scene and a camera: a kernel that fills tiles with values, errors and statuses."""

from __future__ import annotations

import threading
from collections.abc import Mapping

import numpy as np

from symrender.quadrature.light_points import light_points
from symrender.quadrature.split_point import gloss_points, split_work
from symrender.runtimes.image import TileKernel, prepare_sight
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays
from symrender.settings import Settings

FACTS = ("error", "status", "evaluations", "chambers", "crossings")
"""Layers (h, w) of the split rule's own report, named as in ``SplitResult``."""


def prepare(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles to ``settings.tol``, absolute, in scene units of radiance, of the gloss term.

    It fills ``layers["radiance"]``, ``["direct"]``, ``["gloss"]`` (h, w, 3), ``["hit_class"]`` and the ``FACTS``
    (h, w) of the full image, and returns the shaded hits it needed. Deterministic: every pixel is a pure function of
    the scene, the settings and its place.
    """
    sight = prepare_sight(arrays, settings)
    weights = np.zeros(at.FIRST_SPHERE + len(arrays.spheres))
    weights[at.FLOOR] = arrays.floor[at.FLOOR_LOBE] if arrays.camera[3] > 0 else 0.0
    weights[at.FIRST_SPHERE :] = arrays.spheres[:, at.LOBE]
    size = (settings.height, settings.width, 3)
    # memory is taken only where a tile is written
    places: dict[str, Array] = {name: np.zeros(size) for name in ("place", "normal", "incoming")}
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        sight(x0, y0, x1, y1, {**layers, **places})
        surface = layers["hit_class"][y0:y1, x0:x1].astype(np.int64)
        rows, columns = np.nonzero(weights[surface] > 0)
        surface = surface[rows, columns]
        at_pixel = (rows + y0, columns + x0)
        if not hasattr(own, "scratch"):
            own.scratch = split_work(arrays, light_points(arrays, settings.disk_order))
        found = gloss_points(
            arrays,
            places["place"][at_pixel],
            places["normal"][at_pixel],
            places["incoming"][at_pixel],
            surface,
            settings.tol,
            settings.disk_order,
            settings.budget,
            own.scratch,
        )
        layers["gloss"][at_pixel] = found.gloss
        layers["radiance"][at_pixel] += weights[surface][:, None] * found.gloss
        for name in FACTS:
            layers[name][at_pixel] = getattr(found, name)
        return int(found.evaluations.sum())

    return render
