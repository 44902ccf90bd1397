"""Radiometric scenes bound to a camera: emission and direct light in closed form, one bounce by the split rule."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.radiometric import tile
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import Array, camera_window, make_world
from symrender.runtimes.bounce import Bouncer
from symrender.runtimes.image import TileKernel
from symrender.scene.radiometric.arrays import DIFFUSE, SKY, RadiometricArrays
from symrender.scene.radiometric.bounce import bounce_refusal
from symrender.scene.radiometric.due import refuse_bounces
from symrender.settings import Settings

Ints = npt.NDArray[np.int64]

BUDGET: Final = 1_000_000
"""Most evaluations of a ray, unless said otherwise."""


def prepare(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of a scene; Unsupported where ``check`` says so.

    It fills ``emitted``, ``direct``, ``indirect``, ``radiance`` (h, w, 3), ``hit_class``, ``error`` (of radiance: what
    rounding may have done, and with ``bounces: 1`` what the split rule states) and ``status`` (h, w) of the full image.
    Every pixel is a pure function of its place.
    """
    check(arrays)
    world = make_world(arrays)
    width, height = settings.width, settings.height
    window, eye = camera_window(arrays.camera, width, height), np.ascontiguousarray(arrays.camera.eye)
    kernel = _kernel("fill_tile")
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        names = ("emitted", "direct", "hit_class", "error")
        kernel(
            *(world, eye, window, width, height, x0, y0, x1, y1, *sky_room(world)), *(layers[name] for name in names)
        )
        here = (slice(y0, y1), slice(x0, x1))
        layers["radiance"][here] = layers["emitted"][here] + layers["direct"][here]
        layers["status"][here] = np.where(layers["error"][here] > settings.tol, CAPPED, MET)
        count = (x1 - x0) * (y1 - y0)
        if not arrays.bounces:
            return count
        if not hasattr(own, "bouncer"):
            own.bouncer = Bouncer(arrays)
        directions = np.zeros((count, 3))
        _kernel("fill_directions")(window, width, height, x0, y0, x1, y1, directions)
        hits = own.bouncer.hits(np.tile(eye, (count, 1)), directions, layers["hit_class"][here].ravel())
        seen = own.bouncer.light(hits, settings.tol, settings.budget)
        shape = (y1 - y0, x1 - x0)
        layers["indirect"][here] = seen.indirect.reshape(*shape, 3)
        layers["radiance"][here] += layers["indirect"][here]
        layers["error"][here] += seen.error.reshape(shape)
        layers["status"][here] = _status(layers["error"][here], seen.status.reshape(shape), settings.tol)
        return count + int(seen.evaluations.sum())

    return render


def _status(error: Array, status: Array | Ints, tol: float) -> Ints:
    """Whether errors are within ``tol``, and if not what the split rule says of them."""
    return np.where(error > tol, np.maximum(status, CAPPED), MET).astype(np.int64)


@dataclass(frozen=True)
class Sent:
    """What comes back along N rays: ``emitted``, ``direct``, ``indirect`` (N, 3), then (N,) arrays."""

    emitted: Array
    direct: Array
    indirect: Array
    hit_class: Array
    error: Array
    status: Ints
    evaluations: Ints


def rays(arrays: RadiometricArrays, origins: Array, directions: Array, tol: float, budget: int = BUDGET) -> Sent:
    """What comes back along unit rays, each to ``tol``, absolute; Unsupported where ``check`` says so."""
    check(arrays)
    world, count = make_world(arrays), len(origins)
    found = (np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.zeros(count))
    _kernel("fill_rays")(world, origins, directions, *sky_room(world), *found)
    emitted, direct, hit_class, error = found
    indirect, status, evaluations = np.zeros((count, 3)), np.zeros(count, np.int64), np.ones(count, np.int64)
    if arrays.bounces:
        bouncer = Bouncer(arrays)
        seen = bouncer.light(bouncer.hits(origins, directions, hit_class), tol, budget)
        indirect, status, evaluations = seen.indirect, seen.status, evaluations + seen.evaluations
        error = error + seen.error
    return Sent(emitted, direct, indirect, hit_class, error, _status(error, status, tol), evaluations)


def check(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for what takes an integral that is not had: of bounces, and of a sky on what is glossy."""
    asked = arrays.bounces if arrays.bounces <= 1 else "all"
    refuse_bounces(asked, bounce_refusal(arrays) if asked == 1 else "")
    used = {int(shape.material) for shape in arrays.shapes}
    glossy = any(arrays.materials[m].kind != DIFFUSE for m in used)
    if glossy and any(light.kind == SKY for light in arrays.lights):
        raise Unsupported(
            "lights: a sky over a conductor or a phong material is not yet integrated, which takes its lobe; "
            "over diffuse ones it is, and the numeric pipeline samples any"
        )


@lru_cache(maxsize=3)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
