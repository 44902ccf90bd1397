"""The numeric pipeline of radiometric scenes: arrays and settings in, a kernel that fills tiles out."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from symrender.errors import OptionError
from symrender.jit.compiled import compiled
from symrender.numeric.radiometric import tile
from symrender.numeric.radiometric.shot import make_shot
from symrender.numeric.radiometric.world import fresh_notes, make_world
from symrender.numeric.rays import camera_frame
from symrender.numeric.samplers import CODES
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

TileKernel = Callable[[int, int, int, int, Mapping[str, Array]], int]


def prepare(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of the image by paths, ``settings.lobe`` squared of them a pixel.

    With a filter, an aperture or a shutter every path has a place of the pixel, of the lens and an instant of its own,
    else all go through the pixel's centre.
    It fills ``emitted``, ``direct``, ``indirect``, ``radiance`` (h, w, 3), their sum, and ``hit_class`` (h, w). Point
    and directional lights have no chance in them, so without a sky and bounces the image has none. Raises OptionError
    for the sampler ``none``.
    """
    if settings.numeric == "none":
        raise OptionError("numeric: must name a sampler to render numerically, got 'none'")
    world = make_world(arrays)
    width, height = settings.width, settings.height
    frame = camera_frame(arrays.camera, width, height)
    kernel = _kernel("fill_tile")
    chosen = (CODES[settings.numeric], settings.lobe, settings.seed)
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        if not hasattr(own, "shot"):
            own.world = world._replace(notes=fresh_notes())
            own.shot = make_shot(arrays, own.world, settings)
        names = ("emitted", "direct", "indirect", "hit_class")
        spent = kernel(
            own.world, own.shot, frame, width, height, x0, y0, x1, y1, *chosen, *(layers[name] for name in names)
        )
        here = (slice(y0, y1), slice(x0, x1))
        layers["radiance"][here] = layers["emitted"][here] + layers["direct"][here] + layers["indirect"][here]
        return int(spent)

    return render


def rays(
    arrays: RadiometricArrays,
    origins: Array,
    directions: Array,
    *,
    sampler: str = "jittered",
    order: int = 1,
    seed: int = 7,
) -> tuple[Array, Array, Array, Array]:
    """(emitted, direct, indirect (N, 3), hit class (N,)) along unit rays, of order x order paths each."""
    count = len(origins)
    found = (np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count))
    _kernel("fill_rays")(make_world(arrays), origins, directions, CODES[sampler], order, seed, *found)
    return found


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
