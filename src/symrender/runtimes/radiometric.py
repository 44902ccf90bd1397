"""Emission and direct light of radiometric scenes, bound to a scene and a camera: kernels that fill tiles and rays."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from symrender.errors import Unsupported
from symrender.kernel_cache import compiled
from symrender.radiometric import tile
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import Array, camera_window, make_world
from symrender.runtimes.image import TileKernel
from symrender.scene.radiometric.arrays import DIFFUSE, SKY, RadiometricArrays
from symrender.scene.radiometric.due import refuse_bounces
from symrender.settings import Settings

MET, CAPPED = 0, 1


def prepare(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of a scene with ``bounces: 0``; Unsupported where ``check`` says so.

    It fills ``emitted``, ``direct``, ``indirect`` (zero), ``radiance`` (h, w, 3), ``hit_class``, ``error`` (what
    rounding may have done) and ``status`` (h, w) of the full image. Every pixel is a pure function of its place.
    """
    check(arrays)
    world = make_world(arrays)
    width, height = settings.width, settings.height
    window, eye = camera_window(arrays.camera, width, height), np.ascontiguousarray(arrays.camera.eye)
    kernel = _kernel("fill_tile")

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        names = ("emitted", "direct", "hit_class", "error")
        kernel(
            *(world, eye, window, width, height, x0, y0, x1, y1, *sky_room(world)), *(layers[name] for name in names)
        )
        here = (slice(y0, y1), slice(x0, x1))
        layers["radiance"][here] = layers["emitted"][here] + layers["direct"][here]
        layers["status"][here] = np.where(layers["error"][here] > settings.tol, CAPPED, MET)
        return (x1 - x0) * (y1 - y0)

    return render


def rays(arrays: RadiometricArrays, origins: Array, directions: Array) -> tuple[Array, Array, Array, Array]:
    """(emitted, direct (N, 3), hit class, error (N,)) along unit rays; Unsupported where ``check`` says so."""
    check(arrays)
    world, count = make_world(arrays), len(origins)
    found = (np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.zeros(count))
    _kernel("fill_rays")(world, origins, directions, *sky_room(world), *found)
    return found


def check(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for what takes the integral over a lobe: bounces, and a sky on what is not diffuse."""
    refuse_bounces("all" if arrays.bounces > 1 else arrays.bounces)
    used = {int(shape.material) for shape in arrays.shapes}
    glossy = any(arrays.materials[m].kind != DIFFUSE for m in used)
    if glossy and any(light.kind == SKY for light in arrays.lights):
        raise Unsupported(
            "lights: a sky over a conductor or a phong material is not yet integrated, which takes its lobe; "
            "over diffuse ones it is, and the numeric pipeline samples any"
        )


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
