"""What a conductor reflects of a background that nothing hides: its directional albedo.

Its lobe has no closed integral, so it is that of a ceiling that glows: a plane across the normal, which every direction
above the horizon meets.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import Conductor
from symrender.jit.records import record, table
from symrender.quadrature.split_point import SplitResult, SplitWork, gloss_points
from symrender.scene.arrays import FIRST_SPHERE, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere

Array = npt.NDArray[np.float64]


def directional_albedo(
    conductor: Conductor, cosines: Array, tol: float, budget: int, scratch: SplitWork
) -> SplitResult:  # fmt: skip
    """What a conductor reflects of radiance 1 from everywhere, seen at these ``cosines`` (N,) to its normal."""
    arrays = _under_a_ceiling()
    rows = table(Conductor, FIRST_SPHERE + 2)
    rows[FIRST_SPHERE] = conductor
    count = len(cosines)
    incoming = np.zeros((count, 3))
    incoming[:, 0], incoming[:, 2] = np.sqrt(np.maximum(0.0, (1.0 - cosines) * (1.0 + cosines))), -cosines
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    return gloss_points(
        arrays, np.zeros((count, 3)), normals, incoming, np.full(count, FIRST_SPHERE), tol, 1, budget, scratch,
        conductors=rows, emitted=np.zeros((0, 3)),
    )  # fmt: skip


def _under_a_ceiling() -> SceneArrays:
    """The plane z = 0 under the plane z = 1, which sends radiance 1."""
    planes = table(Plane, 2)
    planes[1].point[2] = 1.0
    for plane, up in zip(planes, (1.0, -1.0), strict=True):
        plane.normal[2], plane.along[0], plane.cell = up, 1.0, 1.0
    shading = record(Shading)
    shading.ka, shading.ambient[:] = 1.0, 1.0
    return SceneArrays(table(Sphere, 0), record(Floor), table(Light, 0), shading, record(Camera), planes)
