"""The numeric pipeline: a scene's arrays and settings in, a kernel that fills tiles out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.jit.compiled import compiled
from symrender.scene.arrays import Array, SceneArrays
from symrender.settings import EXACT_DISK, Settings

TileKernel = Callable[[int, int, int, int, Mapping[str, Array]], int]
"""``kernel(x0, y0, x1, y1, layers)`` fills columns x0:x1 of rows y0:y1 and returns the lobe evaluations it made."""


def prepare(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of the image by sampling.

    It fills ``layers["radiance"]``, ``["direct"]``, ``["gloss"]`` (h, w, 3) and ``["hit_class"]`` (h, w) of the full
    image: radiance = direct + (lobe weight) gloss, in scene units of radiance. Every pixel is a pure function of the
    scene, the settings and its place, so tiles may be rendered in any order by any number of threads (the kernel
    releases the GIL) and give the same bytes. Raises OptionError for the sampler ``none`` and SceneError for a camera
    without a direction.

    With a ``filter`` a pixel is the mean of as many rays through places of its own as a lobe has directions, each with
    all of these, and ``gloss`` is weighed by the lobes already: radiance = direct + gloss.

    With ``disk="exact"`` disk lights are sampled: 2 x 2 jittered strata where the camera looks, one point for each
    lobe sample; unbiased, and noisier than a KxK rule.
    """
    if settings.numeric == "none":
        raise OptionError("numeric: must name a sampler to render numerically, got 'none'")
    from symrender.numeric.filters import FILTERS
    from symrender.numeric.planes import plane_cameras
    from symrender.numeric.rays import camera_frame
    from symrender.numeric.samplers import CODES
    from symrender.numeric.sight import candidate_room
    from symrender.numeric.world import make_world

    world = make_world(arrays, settings.disk_order)
    width, height = settings.width, settings.height
    frame = camera_frame(arrays.camera, width, height)
    cameras = plane_cameras(world.frames, frame)
    kernel = _kernel("render_tile")
    sampler, order, analytic = CODES[settings.numeric], settings.lobe, settings.aa == "analytic"
    normalised, seed = settings.normalised, settings.seed

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        evaluations = kernel(
            *(world, frame, width, height, x0, y0, x1, y1, sampler, order, normalised, analytic, seed),
            *(FILTERS[settings.filter], settings.reach, cameras, candidate_room(world), candidate_room(world)),
            *(layers["radiance"], layers["direct"], layers["gloss"], layers["hit_class"]),
        )
        return int(evaluations)

    return render


def trace(
    arrays: SceneArrays,
    origins: npt.ArrayLike,
    directions: npt.ArrayLike,
    leaves: npt.ArrayLike,
    disk_order: int = 2,
) -> tuple[Array, Array, Array]:
    """What unit rays see as lobe rays leaving a surface: radiance (N, 3), hit class (N,), distance (N,).

    ``origins`` and ``directions`` are (N, 3); ``leaves`` (N,) or one number is the hit class of the shape each ray
    leaves, excluded by identity, 0 for none. Directions are taken as above the horizon of that shape. Where nothing is
    met the radiance is the background's and the distance inf. ``disk_order`` is K of the K x K disk rule; the exact
    disk has no single ray and raises OptionError.
    """
    from symrender.numeric.sight import candidate_room
    from symrender.numeric.world import make_world

    if disk_order == EXACT_DISK:
        raise OptionError("disk: must be 'KxK' to trace single rays, got 'exact'")
    starts = np.ascontiguousarray(np.atleast_2d(np.asarray(origins, dtype=np.float64)))
    rays = np.ascontiguousarray(np.atleast_2d(np.asarray(directions, dtype=np.float64)))
    if starts.shape != rays.shape or starts.ndim != 2 or starts.shape[1] != 3:
        raise OptionError(f"origins, directions: must both be (N, 3), got {starts.shape} and {rays.shape}")
    left = np.ascontiguousarray(np.broadcast_to(np.asarray(leaves).astype(np.int64), starts.shape[:1]))
    radiance, hit_class, distance = np.empty(starts.shape), np.empty(len(starts)), np.empty(len(starts))
    eye = np.ascontiguousarray(arrays.camera.eye)
    world = make_world(arrays, disk_order)
    room = candidate_room(world)
    _kernel("trace_rays")(world, eye, starts, rays, left, room, radiance, hit_class, distance)
    return radiance, hit_class, distance


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function of ``tile``."""
    from symrender.numeric import tile

    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
