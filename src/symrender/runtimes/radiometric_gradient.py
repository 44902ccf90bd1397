"""Derivatives of the closed forms of a radiometric scene, at the pixels' centres."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.twins import moving
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.arcs import Room
from symrender.radiometric.shaken import doubt, shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, seen_all
from symrender.runtimes.bounce_moves import check_moves
from symrender.runtimes.bounce_slopes import Ints, moving_rays
from symrender.runtimes.bounced_pixels import DIRECT_SHARE
from symrender.runtimes.emission_slopes import alone, bouncer_of, check_emission
from symrender.runtimes.exposed import is_exposed
from symrender.runtimes.image import TileKernel
from symrender.runtimes.pixel_gradient import prepare_box
from symrender.runtimes.radiometric import check, integrated_layers
from symrender.runtimes.swept_pixels import prepare_swept
from symrender.runtimes.tables import Need
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.scene.radiometric.bumped import bumped
from symrender.scene.radiometric.cut import cut_reason
from symrender.scene.radiometric.flat import is_round
from symrender.settings import Settings


def check_gradient(arrays: RadiometricArrays, wrt: tuple[Move, ...] = (), filter: str = "centre") -> None:
    """Raise ``Unsupported`` for scenes and parameters of which no derivative is had."""
    if arrays.bounces and filter != "centre" and not is_round(arrays):
        raise Unsupported(
            f"filter: {filter} of radiometric scenes of flat shapes is not yet differentiated with bounces; of spheres "
            "and planes it is"
        )
    if is_exposed(arrays):
        what = "camera.aperture" if arrays.exposure.aperture > 0.0 else "shutter"
        raise Unsupported(f"gradient: {what}: derivatives of means over a lens or over time are not yet had")
    check(arrays)
    found = bumped(arrays)
    if found and filter != "centre":
        raise Unsupported(
            f"gradient: filter: {filter} over a bump, that of shapes[{found[0]}], is not yet differentiated: by how "
            "much the curves move at which its normals turn away is not known; filter: centre is"
        )
    reason = cut_reason(arrays)
    if reason:
        raise Unsupported(
            f"gradient: bounces: 1 in a scene with {reason}, is not yet differentiated; with bounces: 0 it is"
        )
    if integrated_layers(arrays):
        (check_moves if is_round(arrays) else check_emission)(arrays, wrt)


def prepare(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivatives of what ``runtimes/radiometric.py`` makes.

    For every parameter of ``wrt`` it fills ``emitted:NAME``, ``direct:NAME``, ``indirect:NAME``, ``radiance:NAME``
    (h, w, 3), ``error:NAME`` and ``status:NAME`` (h, w), and once ``hit_class``. The error is the largest change of the
    derivative in the scenes of ``shaken``, which is no less where a pixel's ray comes within roundings of the edge of a
    shape, a shadow or a field, and of bounced light what ``bouncer_of`` states. No finite derivative, as at the very
    limb of a sphere, is ``unsupported``.
    """
    check_gradient(arrays, wrt, settings.filter)
    if settings.filter != "centre":
        return _prepare_means(arrays, settings, wrt)
    width, height = settings.width, settings.height
    worlds = shaken(arrays)
    views = seen_all(worlds, width, height)
    moved = {move[0]: [seen_moves(each, move, width, height) for each in worlds] for move in wrt}
    turning = {name: [moving(*pair) for pair in zip(views, moves, strict=True)] for name, moves in moved.items()}

    own, integrated = threading.local(), integrated_layers(arrays)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here = (slice(y0, y1), slice(x0, x1))
        room = moving(sky_room(views[0].world))
        for name in turning:
            results = [_slopes(view, room, width, height, x0, y0, x1, y1) for view in turning[name]]
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
        count = (x1 - x0) * (y1 - y0) * len(turning)
        if not integrated:
            return count
        if not hasattr(own, "bouncers"):
            own.bouncers = {
                layer: bouncer_of(arrays, wrt, layer, settings.tol, settings.budget) for layer in integrated
            }
        tile = (x0, y0, x1, y1)
        rays = [
            [moving_rays(*pair, width, height, tile) for pair in zip(views, moves, strict=True)]
            for moves in moved.values()
        ]
        if arrays.bounces:
            for name in moved:
                # a tile may be rendered twice
                layers[f"indirect:{name}"][here] = 0.0
        for layer, bouncer in own.bouncers.items():
            found = bouncer.sloped(rays, settings.tol, settings.budget)
            for q, name in enumerate(moved):
                each = found.slopes[q], found.error[q], found.status[q]
                _add(each, layer, name, here, layers, settings.tol)
            count += int(found.evaluations.sum())
        return count

    return render


def tables_needed(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> tuple[Need, ...]:
    """The tables of what faces send each other that the kernel of ``prepare`` makes, unless they are had before."""
    if not arrays.bounces or is_round(arrays):
        return ()
    return tuple(Need(alone(arrays, move), settings.tol, settings.budget) for move in wrt)


def _prepare_means(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """The same of means over pixels."""
    if not arrays.bounces:
        return prepare_box(arrays, settings, wrt)
    closed = prepare_box(arrays, replace(settings, tol=DIRECT_SHARE * settings.tol), wrt)
    bounced = prepare_swept(arrays, settings, wrt)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        spent = closed(x0, y0, x1, y1, layers)
        here = (slice(y0, y1), slice(x0, x1))
        for name, mean in bounced(x0, y0, x1, y1).items():
            # a tile may be rendered twice
            layers[f"indirect:{name}"][here] = 0.0
            _add((mean.values, mean.error, mean.status), "indirect", name, here, layers, settings.tol)
            spent += int(mean.evaluations.sum())
        return spent

    return render


def _add(
    found: tuple[Array, Array, Ints], layer: str, name: str, here: tuple[slice, slice], layers: Mapping[str, Array],
    tol: float,
) -> None:  # fmt: skip
    """Add the derivative of what is integrated, a part of ``layer``, to that of a tile's closed forms.

    ``found``: slopes (N, 3), what they may be off by and status (N,).
    """
    error = layers[f"error:{name}"][here]
    slopes, status = found[0].reshape(*error.shape, 3), found[2].reshape(error.shape)
    error += found[1].reshape(error.shape)
    unknown = ~np.isfinite(error)
    for each in (layer, "radiance"):
        values = layers[f"{each}:{name}"]
        values[here] = np.where(unknown[:, :, None], 0.0, values[here] + slopes)
    status = np.maximum(status, np.where(layers[f"status:{name}"][here] == EVENT, EVENT, MET))
    missed = np.where(unknown, UNSUPPORTED, np.maximum(status, CAPPED))
    layers[f"status:{name}"][here] = np.where(unknown | (error > tol) | (status == EVENT), missed, MET)


def _slopes(
    view: Seen, room: Room, width: int, height: int, x0: int, y0: int, x1: int, y1: int
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Derivatives of emitted and direct light of a tile (h, w, 3), of a view with tangents, and hit classes (h, w)."""
    emitted, direct = np.zeros((2, y1 - y0, x1 - x0, 3), np.complex128)
    hit_class = np.zeros((y1 - y0, x1 - x0))
    _kernel()(*view, width, height, x0, y0, x1, y1, room, emitted, direct, hit_class)
    return emitted.imag, direct.imag, hit_class


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that fills a tile."""
    return compiled(tile.fill_tile, _nrt=False)
