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
Sampler = Callable[[tuple[int, int, int, int], int, int, Mapping[str, Array]], int]
"""``sampler(tile, order, seed, layers)`` fills a tile by order x order paths a pixel and returns the rays it took."""
_FILLED = ("emitted", "direct", "indirect", "hit_class")


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
    sampler = sampler_of(arrays, settings, settings.numeric)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        spent = sampler((x0, y0, x1, y1), settings.lobe, settings.seed, layers)
        here = (slice(y0, y1), slice(x0, x1))
        layers["radiance"][here] = layers["emitted"][here] + layers["direct"][here] + layers["indirect"][here]
        return spent

    return render


def sampler_of(arrays: RadiometricArrays, settings: Settings, name: str = "jittered") -> Sampler:
    """Return the path tracer of an image, to be called for any tile, number of paths and seed.

    It fills ``emitted``, ``direct``, ``indirect`` (h, w, 3) and ``hit_class`` (h, w); threads may call it together.
    """
    world = make_world(arrays)
    frame = camera_frame(arrays.camera, settings.width, settings.height)
    kernel = _kernel("fill_tile")
    own = threading.local()

    def sample(tile_: tuple[int, int, int, int], order: int, seed: int, layers: Mapping[str, Array]) -> int:
        if not hasattr(own, "shot"):
            own.world = world._replace(notes=fresh_notes(), stack=np.zeros_like(world.stack))
            own.shot = make_shot(arrays, own.world, settings)
        size = settings.width, settings.height
        filled = (layers[layer] for layer in _FILLED)
        return int(kernel(own.world, own.shot, frame, *size, *tile_, CODES[name], order, seed, *filled))

    return sample


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
