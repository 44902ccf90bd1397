"""Direct light of disks at given points, differentiated: ``disk_direct.py`` with tangents beside its values."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.twins import moving_by
from symrender.jit.types import SEVERAL
from symrender.quadrature.disk_direct import direct_compiled, disk_step
from symrender.quadrature.gloss_gradients import SlopeScene
from symrender.quadrature.split_scratch import SplitWork

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def direct_gradients(
    scene: SlopeScene, points: Array, normals: Array, incoming: Array, surface: Ints, albedo: Array,
    moving: tuple[Array, Array, Array, Array], tol: float, scratch: SplitWork,
) -> tuple[Array, Array]:  # fmt: skip
    """(Q, N, 3) derivatives of what ``disk_direct`` adds to N seen points, and (Q, N) their estimated errors.

    ``moving`` tells how the points, their normals, the rays and the albedo move, (Q, N, 3) each; the other arguments
    are those of ``disk_direct``, in a scene whose disks are exact. An error is inf where no derivative is given: on the
    inside of a sphere, and where a ball touches a disk.
    """
    count, n = moving[0].shape[:2]
    gradient, error = np.zeros((count, n, 3)), np.zeros((count, n))
    given, step = (points, normals, incoming, albedo), disk_step(tol)
    surfaces = np.ascontiguousarray(surface, dtype=np.int64)
    for part in scene.parts:
        lanes = range(part.first, part.stop)
        place, normal, way, tint = (
            moving_by(np.ascontiguousarray(one, dtype=np.float64), [each[q] for q in lanes])
            for one, each in zip(given, moving, strict=True)
        )
        direct: Any = np.zeros((n, 3), SEVERAL)
        missed: Any = np.zeros(n, SEVERAL)
        direct_compiled()(
            place, normal, way, surfaces, tint, step, tol, part.view, scratch.work, scratch.gauss,
            np.zeros((3, 3), SEVERAL), part.frames, direct, missed,
        )  # fmt: skip
        for lane, q in enumerate(lanes):
            gradient[q], error[q] = direct["tangents"][..., lane], missed["tangents"][:, lane]
    return gradient, error
