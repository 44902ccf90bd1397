"""Derivatives of what comes back along rays of a radiometric scene; the rays themselves stand still."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.twins import moving
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.arcs import Room
from symrender.radiometric.shaken import doubt, shaken, shaken_rays
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import record_moves, world_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_worlds
from symrender.runtimes.emission_slopes import bouncer_of
from symrender.runtimes.radiometric import integrated_layers
from symrender.runtimes.radiometric_gradient import check_gradient
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays

Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SentSlopes:
    """Derivatives of the radiance along N rays in Q parameters: ``slopes`` (Q, N, 3), ``error``, ``status`` (Q, N)."""

    slopes: Array
    error: Array
    status: Ints


def ray_slopes(
    arrays: RadiometricArrays, wrt: tuple[Move, ...], tol: float, budget: int
) -> Callable[[Array, Array], SentSlopes]:  # fmt: skip
    """What answers for origins and unit directions (N, 3), each derivative to ``tol``; else ``Unsupported``.

    ``error`` and ``status`` are those of ``gradient``. Threads may ask at the same time.
    """
    check_gradient(arrays, wrt)
    scenes, integrated, own = shaken(arrays), integrated_layers(arrays), threading.local()
    worlds = make_worlds(scenes)
    moves = [[world_moves(each, record_moves(each, move)) for each in scenes] for move in wrt]
    moving_worlds = [[moving(*pair) for pair in zip(worlds, each, strict=True)] for each in moves]

    def answer(origins: Array, directions: Array) -> SentSlopes:
        sent = shaken_rays(arrays, origins, directions)
        shape = len(wrt), len(origins)
        found = SentSlopes(np.zeros((*shape, 3)), np.zeros(shape), np.full(shape, MET))
        room = moving(sky_room(worlds[0]))
        for q, each in enumerate(moving_worlds):
            slopes = [_closed(world, room, rays) for world, rays in zip(each, sent, strict=True)]
            found.slopes[q], found.error[q] = slopes[0], doubt(slopes[0], slopes[1:])
        if integrated and not hasattr(own, "bouncers"):
            own.bouncers = [bouncer_of(arrays, wrt, layer, tol, budget) for layer in integrated]
        still = [(origins_ + 0j, directions_ + 0j) for origins_, directions_ in sent]
        for bouncer in own.bouncers if integrated else ():
            light = bouncer.sloped([still] * len(wrt), tol, budget)
            found.slopes[:] += light.slopes
            found.error[:] += light.error
            found.status[:] = np.maximum(found.status, light.status)
        unknown = ~np.isfinite(found.error)
        found.slopes[unknown], found.error[unknown] = 0.0, np.inf
        missed = np.where(unknown, UNSUPPORTED, np.maximum(found.status, CAPPED))
        found.status[:] = np.where(unknown | (found.error > tol) | (found.status == EVENT), missed, MET)
        return found

    return answer


def _closed(world: World, room: Room, rays: tuple[Array, Array]) -> Array:
    """Derivatives of emitted and direct light together, of a world with tangents; rays have none."""
    count = len(rays[0])
    emitted, direct = np.zeros((2, count, 3), np.complex128)
    _kernel()(world, *rays, room, emitted, direct, np.zeros(count))
    return np.asarray(emitted.imag + direct.imag)


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that answers for rays."""
    return compiled(tile.fill_rays, _nrt=False)
