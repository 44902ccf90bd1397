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
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.radiometric.shaken import doubt, shaken, shaken_rays
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import pushed_module, pushed_text, record_moves, world_moves
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
    moving = [[world_moves(each, record_moves(each, move)) for each in scenes] for move in wrt]

    def answer(origins: Array, directions: Array) -> SentSlopes:
        sent = shaken_rays(arrays, origins, directions)
        shape = len(wrt), len(origins)
        found = SentSlopes(np.zeros((*shape, 3)), np.zeros(shape), np.full(shape, MET))
        for q, moves in enumerate(moving):
            slopes = [_closed(*each) for each in zip(worlds, moves, sent, strict=True)]
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


def _closed(world: World, moves: World, rays: tuple[Array, Array]) -> Array:
    """Slopes of what is closed form, emitted and direct light together."""
    count = len(rays[0])
    values, slopes = ((np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)) for _ in range(2))
    still = np.zeros((count, 3)), np.zeros((count, 3))
    _kernel()(world, *rays, sky_room(world), *values, moves, *still, sky_room(world), *slopes)
    return np.asarray(slopes[0] + slopes[1])


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """The pushed kernel, compiled."""
    return compiled(pushed_module().fill_rays_dot, sources=[pushed_text()], _nrt=False)
