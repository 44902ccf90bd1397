"""Single values of the lobe integral, to as many digits as double precision holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError, SceneError
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.scene import arrays as at
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Probe:
    """The lobe integral of N points.

    ``gloss`` (N, 3): mean radiance under the lobe, without the lobe's weight, scene units. ``error`` (N,): estimated
    largest absolute error over the channels. ``evaluations`` (N,): shaded hits. ``status`` (N,): 0 met, 1 capped,
    2 near-tangent, 3 unsupported (no value). ``chambers``, ``crossings`` (N,): different chambers and walls met.
    """

    gloss: Array
    error: Array
    evaluations: Ints
    status: Ints
    chambers: Ints
    crossings: Ints


def probe(
    scene: Scene | str | Path | Mapping[str, Any],
    points: npt.ArrayLike,
    *,
    surface: str = "floor",
    tol: float = 1e-9,
    disk: str = "2x2",
    budget: int = 1_000_000,
) -> Probe:
    """The lobe integral gloss(P) at points of ``surface``, ``floor`` or ``spheres.NAME``, seen from the camera's eye.

    ``points``: (N, 2) or (N, 3) positions on the floor z = 0, or (N, 3) unit outward normals of the sphere, where
    they face the eye. ``tol``: absolute, in scene units of radiance. ``disk``: ``KxK`` replaces a disk light by its
    centroids. ``budget``: most evaluations a point. Whether the eye really sees a point is not asked.
    Raises SceneError for a surface without a lobe, OptionError for a point not on the surface or facing away.
    """
    loaded = load(scene)
    settings = Settings(tol=float(tol), disk=disk, budget=budget)
    arrays = scene_arrays(loaded)
    place, normal, hit_class = _places(loaded, np.atleast_2d(np.asarray(points, dtype=np.float64)), surface)
    away = place - arrays.camera[1:4]
    length = np.linalg.norm(away, axis=1, keepdims=True)
    facing = (away * normal).sum(axis=1)
    if not (facing < 0).all():
        k = int(np.argmax(facing >= 0))
        raise OptionError(f"points[{k}]: {tuple(place[k].tolist())} of {surface} does not face the eye")
    surfaces = np.full(len(place), hit_class, dtype=np.int64)
    found: SplitResult = gloss_points(
        arrays, place, normal, away / length, surfaces, settings.tol, settings.disk_order, settings.budget
    )
    return Probe(found.gloss, found.error, found.evaluations, found.status, found.chambers, found.crossings)


def _places(scene: Scene, points: Array, surface: str) -> tuple[Array, Array, int]:
    """Positions, outward normals and hit class of points given as ``probe`` takes them."""
    if not np.isfinite(points).all():
        raise OptionError("points: must be finite numbers")
    if surface == "floor":
        if scene.floor is None or scene.floor.lobe is None:
            raise SceneError("surface: this scene has no floor with a lobe")
        flat = points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
        if flat.shape[1] != 3 or (flat[:, 2] != 0).any():
            raise OptionError("points: must be (x, y) or (x, y, 0) on the floor")
        return flat, np.tile([0.0, 0.0, 1.0], (len(flat), 1)), at.FLOOR
    names = {f"spheres.{sphere.name}": k for k, sphere in enumerate(scene.spheres)}
    if surface not in names:
        raise SceneError(f"surface: must be one of {', '.join(['floor', *names])}, got {surface!r}")
    sphere = scene.spheres[names[surface]]
    if sphere.lobe is None:
        raise SceneError(f"surface: {surface} has no lobe")
    if points.shape[1] != 3 or (np.abs(np.linalg.norm(points, axis=1) - 1) > 1e-9).any():
        raise OptionError(f"points: must be unit outward normals of {surface}")
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return np.asarray(sphere.center) + sphere.radius * normals, normals, at.FIRST_SPHERE + names[surface]
