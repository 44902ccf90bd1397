"""Judges of lens, shutter and filters: the conventional tracer's rays through places of its own choice."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

Array = np.ndarray[Any, np.dtype[np.float64]]


def at_time(scene: RadiometricScene, t: float) -> RadiometricScene:
    """The scene as it stands at an instant, with nothing that moves."""
    changes: dict[str, Any] = {"shutter": [0.0, 0.0]}
    for field in ("shapes", "lights"):
        for index, part in enumerate(getattr(scene, field)):
            velocity = getattr(part, "velocity", None)
            if velocity is None or not any(velocity):
                continue
            way, name = np.array(velocity) * t, f"{field}[{index}]"
            for key in ("center", "corner", "point", "position"):
                if hasattr(part, key):
                    changes[f"{name}.{key}"] = (np.array(getattr(part, key)) + way).tolist()
            if hasattr(part, "vertices"):
                changes[f"{name}.vertices"] = (np.array(part.vertices) + way).tolist()
            changes[f"{name}.velocity"] = [0.0, 0.0, 0.0]
    way = np.array(scene.camera.velocity) * t
    for key in ("eye", "target"):
        changes[f"camera.{key}"] = (np.array(getattr(scene.camera, key)) + way).tolist()
    return scene.replace(changes | {"camera.velocity": [0.0, 0.0, 0.0]})


def lens_rays(
    scene: RadiometricScene, size: tuple[int, int], x: Array, y: Array, lens: Array
) -> tuple[Array, Array]:  # fmt: skip
    """(origins, unit directions) through image places (x, y), in pixels, and places of the unit disk (n, 2)."""
    camera, (width, height) = scene.camera, size
    eye, target, up = (np.array(v, dtype=float) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, forward)
    half = math.tan(math.radians(camera.fov) / 2)
    a, b = (2 * x / width - 1) * half * width / height, (1 - 2 * y / height) * half
    sharp = eye + camera.focus * (forward + a[:, None] * right + b[:, None] * above)
    origins = eye + camera.aperture * (lens[:, :1] * right + lens[:, 1:] * above)
    directions = sharp - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


WEIGHTS: dict[str, Callable[[Array], Array]] = {
    "box": np.ones_like,
    "tent": lambda x: 1 - abs(x),
    "gaussian": lambda x: np.exp(-8 * x**2) - np.exp(-8),
    "mitchell": lambda x: np.where(
        abs(x) < 0.5,
        7 * abs(2 * x) ** 3 - 12 * (2 * x) ** 2 + 16 / 3,
        -7 / 3 * abs(2 * x) ** 3 + 12 * (2 * x) ** 2 - 20 * abs(2 * x) + 32 / 3,
    ),
}
"""Weights along an axis by the distance from the middle over the support's half width, of any scale."""
REACH = {"centre": 0.0, "box": 0.5, "tent": 1.0, "gaussian": 2.0, "mitchell": 2.0}


def sampled(
    scene: RadiometricScene, size: tuple[int, int], place: tuple[int, int], filter: str, count: int, seed: int,
    times: int = 32, reach: float = 0.0,
) -> tuple[Array, Array]:  # fmt: skip
    """(mean of a pixel over its filter, lens and shutter, its standard error) by ``count`` shifted lattice points.

    Sixteen shifts; ``times`` strata of the shutter, each with one instant a shift.
    """
    rng = np.random.default_rng(seed)
    reach = reach or REACH[filter]
    opens, closes = scene.shutter
    times = times if closes > opens else 1
    n = max(1, count // (16 * times))
    # Korobov's lattice with Fibonacci-like generators
    k = np.arange(n)[:, None] * np.array([1.0 / n, 0.6180339887498949, 0.7548776662466927, 0.5698402909980532])
    found = []
    for _ in range(16):
        total, norm = np.zeros(3), 0.0
        for step in range(times):
            t = opens + (closes - opens) * (step + rng.random()) / times
            point = (k + rng.random(4)) % 1.0
            dx, dy = 2 * point[:, 0] - 1, 2 * point[:, 1] - 1
            weight = WEIGHTS[filter](dx) * WEIGHTS[filter](dy) if filter != "centre" else np.ones(n)
            radius, turn = np.sqrt(point[:, 2]), 2 * math.pi * point[:, 3]
            lens = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
            still = at_time(scene, t)
            x, y = place[0] + 0.5 + reach * dx, place[1] + 0.5 + reach * dy
            emitted, direct, _, _ = numeric_rays(radiometric_arrays(still), *lens_rays(still, size, x, y, lens))
            total += weight @ (emitted + direct)
            norm += weight.sum()
        found.append(total / norm)
    values = np.array(found)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / 4.0
