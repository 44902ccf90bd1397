"""What a conductor reflects of a background that nothing hides: its directional albedo.

Its lobe has no closed integral, so it is that of a ceiling that glows: a plane across the normal, which every direction
above the horizon meets.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import Conductor
from symrender.chambers.records import LightPoint
from symrender.chambers.work import scene_frames, scene_view
from symrender.jit.call import racked
from symrender.jit.records import record, table
from symrender.jit.twins import moving
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.quadrature.split_scene import radiance_bound
from symrender.quadrature.split_scratch import SplitWork
from symrender.quadrature.split_slopes import SlopeResult, gloss_slopes
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, SceneArrays, lobes_of
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


def directional_albedo(
    conductor: Conductor, cosines: Array, tol: float, budget: int, scratch: SplitWork
) -> SplitResult:  # fmt: skip
    """What a conductor reflects of radiance 1 from everywhere, seen at these ``cosines`` (N,) to its normal."""
    rows = table(Conductor, FIRST_SPHERE + 2)
    rows[FIRST_SPHERE] = conductor
    count = len(cosines)
    incoming = np.zeros((count, 3))
    incoming[:, 0], incoming[:, 2] = np.sqrt(np.maximum(0.0, (1.0 - cosines) * (1.0 + cosines))), -cosines
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    return gloss_points(
        _under_a_ceiling(), np.zeros((count, 3)), normals, incoming, np.full(count, FIRST_SPHERE), tol, 1, budget,
        scratch, conductors=rows, emitted=np.zeros((0, 3)),
    )  # fmt: skip


def albedo_slopes(
    conductors: Any, hit_class: int, cosines: Complex, tol: float, budget: int, scratch: SplitWork
) -> SlopeResult:  # fmt: skip
    """The same with tangents, of cosines and the conductor of a hit class that move."""
    arrays = _under_a_ceiling()
    view = scene_view(arrays, table(LightPoint, 0), emitted=np.zeros((0, 3)))
    count, cosine = len(cosines), cosines.real
    sine = np.sqrt(np.maximum(0.0, (1.0 - cosine) * (1.0 + cosine)))
    # at a right angle it is stationary
    turn = np.divide(-cosine * cosines.imag, sine, out=np.zeros(count), where=sine > 0.0)
    incoming = np.zeros((count, 3), np.complex128)
    incoming[:, 0], incoming[:, 2] = sine + 1j * turn, -cosines
    normals = np.tile(np.array([0.0, 0.0, 1.0], np.complex128), (count, 1))
    lobes = np.zeros((FIRST_SPHERE + 2, 2), np.complex128)
    lobes[FLOOR:] = lobes_of(arrays)[:, 1:]
    rows = np.take(conductors, [hit_class] * (FIRST_SPHERE + 2))
    seen, frames = moving(view)._replace(conductors=rows), moving(scene_frames(arrays, view))
    views = [each._replace(conductors=rows) for each in frames.views]
    return gloss_slopes(
        np.zeros((count, 3), np.complex128), normals, incoming, np.full(count, FIRST_SPHERE), lobes, seen,
        frames._replace(views=racked(seen, views)), radiance_bound(arrays, view.points), tol, budget, scratch,
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
