"""Derivatives of the closed forms of a radiometric scene, at the pixels' centres."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import Seen, pushed_module, pushed_text, seen, seen_moves, shaken
from symrender.radiometric.world import Array
from symrender.runtimes.image import TileKernel
from symrender.runtimes.radiometric import check
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

SHAKES: Final = 3
"""Shaken scenes whose derivatives are compared with that of the scene."""
_LAST: Final = 2.0**-48
"""Relative error stated at least."""


def check_gradient(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for scenes whose light is no closed form."""
    if arrays.bounces:
        asked = arrays.bounces if arrays.bounces == 1 else "all"
        raise Unsupported(f"gradient: knows radiometric scenes with bounces: 0, got bounces: {asked}")
    check(arrays)


def prepare(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivatives of what ``runtimes/radiometric.py`` makes; bounces must be 0.

    For every parameter of ``wrt`` it fills ``emitted:NAME``, ``direct:NAME``, ``radiance:NAME`` (h, w, 3),
    ``error:NAME`` and ``status:NAME`` (h, w), and once ``hit_class``. The error is the largest change of the derivative
    when all numbers of the scene are shaken by 64 roundings, three times over, which is no less where a pixel's ray
    comes within that of the edge of a shape, a shadow or a field. No finite derivative, as at the very limb of a
    sphere, is ``unsupported``.
    """
    check_gradient(arrays)
    width, height = settings.width, settings.height
    worlds = [arrays, *(shaken(arrays, number) for number in range(SHAKES))]
    views = [seen(each, width, height) for each in worlds]
    moving = {move[0]: [seen_moves(each, move, width, height) for each in worlds] for move in wrt}

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here = (slice(y0, y1), slice(x0, x1))
        for name, moves in moving.items():
            results = [_slopes(*pair, width, height, x0, y0, x1, y1) for pair in zip(views, moves, strict=True)]
            emitted, direct, classes = results[0]
            radiance = emitted + direct
            with np.errstate(invalid="ignore", over="ignore"):
                off = [np.abs(radiance - (e + d)).max(axis=2) for e, d, _ in results[1:]]
                error = np.max(off, axis=0) + _LAST * np.abs(radiance).max(axis=2)
            unknown = ~np.isfinite(error)
            layers["hit_class"][here] = classes
            for layer, values in (("emitted", emitted), ("direct", direct), ("radiance", radiance)):
                layers[f"{layer}:{name}"][here] = np.where(unknown[:, :, None], 0.0, values)
            layers[f"error:{name}"][here] = np.where(unknown, np.inf, error)
            missed = np.where(unknown, UNSUPPORTED, CAPPED)
            layers[f"status:{name}"][here] = np.where(unknown | (error > settings.tol), missed, MET)
        return (x1 - x0) * (y1 - y0) * len(moving)

    return render


def _slopes(
    view: Seen, moves: Seen, width: int, height: int, x0: int, y0: int, x1: int, y1: int
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Slopes of emitted and direct light of a tile, and the hit classes."""
    shape = (y1, x1)
    values, slopes = _room(shape), _room(shape)
    caps, arcs = sky_room(view.world)
    _kernel()(
        *view, width, height, x0, y0, x1, y1, caps, arcs, *values,
        *moves, np.zeros_like(caps), np.zeros_like(arcs), *slopes,
    )  # fmt: skip
    here = (slice(y0, y1), slice(x0, x1))
    return slopes[0][here], slopes[1][here], values[2][here]


def _room(shape: tuple[int, int]) -> tuple[Array, Array, Array, Array]:
    """Layers emitted, direct, hit_class and error."""
    return np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape), np.zeros(shape)


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """The pushed kernel, compiled."""
    return compiled(pushed_module().fill_tile_dot, sources=[pushed_text()], _nrt=False)
