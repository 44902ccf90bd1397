"""Derivatives of the closed forms of a radiometric scene, at the pixels' centres."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.chambers.chart import FELT_END
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.radiometric.shaken import doubt, shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import pushed_module, pushed_text, seen_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, seen_all
from symrender.runtimes.bounce_moves import check_moves
from symrender.runtimes.bounce_slopes import BouncedSlopes, SlopeBouncer, moving_rays
from symrender.runtimes.exposed import is_exposed
from symrender.runtimes.image import TileKernel
from symrender.runtimes.pixel_gradient import prepare_box
from symrender.runtimes.radiometric import check, lamps_on_gloss
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import AREA, CONDUCTOR, PHONG, SKY, SPOT, RadiometricArrays
from symrender.scene.radiometric.flat import is_flat
from symrender.settings import Settings

EXTENDED: Final = {SKY: "a sky", AREA: "an area light", SPOT: "a spot"}
"""Lights of which bounced light has no derivative yet."""


def check_gradient(arrays: RadiometricArrays, wrt: tuple[Move, ...] = (), filter: str = "centre") -> None:
    """Raise ``Unsupported`` for scenes and parameters of which no derivative is had."""
    if arrays.bounces and filter != "centre":
        raise Unsupported(
            f"filter: {filter} of radiometric scenes is not yet differentiated with bounces; with none it is"
        )
    if arrays.bounces > 1:
        raise Unsupported("gradient: knows radiometric scenes with bounces: 0 and 1, got bounces: all")
    if arrays.bounces and is_flat(arrays):
        raise Unsupported("gradient: knows radiometric scenes of flat shapes with bounces: 0, got bounces: 1")
    if is_exposed(arrays):
        what = "camera.aperture" if arrays.exposure.aperture > 0.0 else "shutter"
        raise Unsupported(f"gradient: {what}: derivatives of means over a lens or over time are not yet had")
    check(arrays)
    if arrays.bounces:
        for light in arrays.lights:
            if light.kind in EXTENDED:
                raise Unsupported(
                    f"gradient: with bounces: 1 it knows points and directional lights, got {EXTENDED[int(light.kind)]}"
                )
        for shape in arrays.shapes:
            material = arrays.materials[int(shape.material)]
            if material.kind == CONDUCTOR and material.walter:
                raise Unsupported("gradient: with bounces: 1 it does not know a conductor of g1: walter yet")
            if material.kind == PHONG and material.exponent < FELT_END:
                raise Unsupported(f"gradient: with bounces: 1 it knows phong from an exponent of {FELT_END:g} on")
        check_moves(arrays, wrt)
    if lamps_on_gloss(arrays):
        raise Unsupported(
            "gradient: of a sky or an area light over a conductor or a phong material it is not yet integrated"
        )


def prepare(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivatives of what ``runtimes/radiometric.py`` makes.

    For every parameter of ``wrt`` it fills ``emitted:NAME``, ``direct:NAME``, ``indirect:NAME``, ``radiance:NAME``
    (h, w, 3), ``error:NAME`` and ``status:NAME`` (h, w), and once ``hit_class``. The error is the largest change of the
    derivative in the scenes of ``shaken``, which is no less where a pixel's ray comes within roundings of the edge of a
    shape, a shadow or a field, and of bounced light what ``SlopeBouncer`` states. No finite derivative, as at the very
    limb of a sphere, is ``unsupported``.
    """
    check_gradient(arrays, wrt, settings.filter)
    if settings.filter != "centre":
        return prepare_box(arrays, settings, wrt)
    width, height = settings.width, settings.height
    worlds = shaken(arrays)
    views = seen_all(worlds, width, height)
    moving = {move[0]: [seen_moves(each, move, width, height) for each in worlds] for move in wrt}

    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here = (slice(y0, y1), slice(x0, x1))
        for name, moves in moving.items():
            results = [_slopes(*pair, width, height, x0, y0, x1, y1) for pair in zip(views, moves, strict=True)]
            emitted, direct, classes = results[0]
            radiance = emitted + direct
            error = doubt(radiance, [e + d for e, d, _ in results[1:]])
            unknown = ~np.isfinite(error)
            layers["hit_class"][here] = classes
            for layer, values in (("emitted", emitted), ("direct", direct), ("radiance", radiance)):
                layers[f"{layer}:{name}"][here] = np.where(unknown[:, :, None], 0.0, values)
            layers[f"error:{name}"][here] = np.where(unknown, np.inf, error)
            missed = np.where(unknown, UNSUPPORTED, CAPPED)
            layers[f"status:{name}"][here] = np.where(unknown | (error > settings.tol), missed, MET)
        count = (x1 - x0) * (y1 - y0) * len(moving)
        if not arrays.bounces:
            return count
        if not hasattr(own, "bouncer"):
            own.bouncer = SlopeBouncer(arrays, wrt)
        tile = (x0, y0, x1, y1)
        rays = [
            [moving_rays(*pair, width, height, tile) for pair in zip(views, moves, strict=True)]
            for moves in moving.values()
        ]
        found = own.bouncer.sloped(rays, settings.tol, settings.budget)
        for q, name in enumerate(moving):
            _add(found, q, name, here, layers, settings.tol)
        return count + int(found.evaluations.sum())

    return render


def _add(
    found: BouncedSlopes, q: int, name: str, here: tuple[slice, slice], layers: Mapping[str, Array], tol: float
) -> None:
    """Add the derivative of bounced light to that of a tile's closed forms."""
    error = layers[f"error:{name}"][here]
    slopes = found.slopes[q].reshape(*error.shape, 3)
    status = found.status[q].reshape(error.shape)
    error += found.error[q].reshape(error.shape)
    unknown = ~np.isfinite(error)
    layers[f"indirect:{name}"][here] = np.where(unknown[:, :, None], 0.0, slopes)
    layers[f"radiance:{name}"][here] = np.where(unknown[:, :, None], 0.0, layers[f"radiance:{name}"][here] + slopes)
    missed = np.where(unknown, UNSUPPORTED, np.maximum(status, CAPPED))
    layers[f"status:{name}"][here] = np.where(unknown | (error > tol) | (status == EVENT), missed, MET)


def _slopes(
    view: Seen, moves: Seen, width: int, height: int, x0: int, y0: int, x1: int, y1: int
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Slopes of emitted and direct light of a tile, and the hit classes."""
    values, slopes = _room(x1 - x0, y1 - y0), _room(x1 - x0, y1 - y0)
    room, moving = sky_room(view.world), sky_room(view.world)
    _kernel()(*view, width, height, x0, y0, x1, y1, room, *values, *moves, moving, *slopes)
    return slopes[0], slopes[1], values[2]


def _room(width: int, height: int) -> tuple[Array, Array, Array]:
    """Layers emitted, direct and hit_class of a tile."""
    return np.zeros((height, width, 3)), np.zeros((height, width, 3)), np.zeros((height, width))


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """The pushed kernel, compiled."""
    return compiled(pushed_module().fill_tile_dot, sources=[pushed_text()], _nrt=False)
