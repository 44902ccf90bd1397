"""What a camera sees of a radiometric scene, row by row and without an error: for who asks where light changes.

An image states its error, and computes the scene seven times for it. Where a shadow begins takes one.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.radiometric import tile
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import seen
from symrender.runtimes.bounce import hits
from symrender.runtimes.radiometric import check, lamps_on_gloss
from symrender.scene.radiometric.arrays import RadiometricArrays

Rows = Callable[[int, int, Array], None]
"""``rows(y0, y1, layer)`` fills rows y0:y1 of a layer (h, w, 3); rows apart may be filled at the same time."""


def direct_rows(arrays: RadiometricArrays, width: int, height: int) -> Rows:
    """Direct light through the centres of pixels; ``Unsupported`` where an image of the scene is."""
    check(arrays)
    if lamps_on_gloss(arrays):
        raise Unsupported(
            "regions: of a sky or an area light over a conductor or a phong material they are not yet known"
        )
    view = seen(arrays, width, height)

    def rows(y0: int, y1: int, layer: Array) -> None:
        emitted, hit_class = np.zeros((y1 - y0, width, 3)), np.zeros((y1 - y0, width))
        part = (width, height, 0, y0, width, y1)
        _kernel("fill_tile")(*view, *part, sky_room(view.world), emitted, layer[y0:y1], hit_class)

    return rows


def reflectance_rows(arrays: RadiometricArrays, width: int, height: int) -> Rows:
    """How the place reflects that the centre of a pixel sees, its texture's colour there; 0 where nothing is."""
    view = seen(arrays, width, height)

    def rows(y0: int, y1: int, layer: Array) -> None:
        directions = np.zeros((width * (y1 - y0), 3))
        _kernel("fill_directions")(view.window, width, height, 0, y0, width, y1, directions)
        seen_there = hits(view.world, np.tile(view.eye, (len(directions), 1)), directions)
        layer[y0:y1] = seen_there.albedo.reshape(y1 - y0, width, 3)

    return rows


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
