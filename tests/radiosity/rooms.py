"""Rooms of flat shapes for the tests, and one bounce of light in them by lattices and the other pipeline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric.flats import box, rectangle, triangle, world

from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

Scene = dict[str, Any]
Array = np.ndarray[Any, np.dtype[np.float64]]
MATERIALS = {
    "white": {"type": "diffuse", "reflectance": [0.8, 0.7, 0.9]},
    "both": {"type": "diffuse", "reflectance": [0.5, 0.6, 0.4], "two_sided": True},
    "grey": {"type": "diffuse", "reflectance": 0.4},
    "red": {"type": "diffuse", "reflectance": [0.9, 0.0, 0.1]},
}
SHIFTS = 4


def closed(size: float = 1.0, at: tuple[float, float, float] = (0.0, 0.0, 0.0), material: str = "white") -> list[Scene]:
    """The six walls of a cube, seen from inside."""
    x, y, z, s = *at, size
    return [
        rectangle("floor", [x, y, z], [s, 0, 0], [0, s, 0], material),
        rectangle("ceiling", [x, y, z + s], [0, s, 0], [s, 0, 0], material),
        rectangle("back", [x, y + s, z], [s, 0, 0], [0, 0, s], material),
        rectangle("front", [x, y, z], [0, 0, s], [s, 0, 0], material),
        rectangle("left", [x, y, z], [0, s, 0], [0, 0, s], material),
        rectangle("right", [x + s, y, z], [0, 0, s], [0, s, 0], material),
    ]


def lamp(shape: Scene, radiance: Any = 1.0) -> Scene:
    return {"type": "area", "name": f"of_{shape['name']}", "shape": shape["name"], "radiance": radiance}


def hostile(seed: int, scale: float) -> Scene:
    """A room of coloured walls with a point light and shapes that touch, cross, all but touch, or are needles."""
    rng = np.random.default_rng(seed)
    shapes = closed(1.0, material="grey")
    shapes[2]["material"], shapes[4]["material"] = "red", "both"
    for k in range(3):
        material = ["white", "both", "grey", "red"][int(rng.integers(4))]
        gap = 10.0 ** -float(rng.integers(2, 7))
        shapes.append(
            [
                box(f"o{k}", [0.1, 0.5, 0.15], [0.2, 0.3, 0.3], 0.0, material),
                box(
                    f"o{k}", rng.uniform(0.2, 0.8, 3), rng.uniform(0.05, 0.5, 3), float(rng.uniform(-90, 90)), material
                ),
                box(f"o{k}", [0.5, 0.5, 0.3], [gap, 0.4, 0.3], 20.0, material),
                rectangle(f"o{k}", [0.3, 0.3, gap], [0.4, 0, 0], [0, 0.3, 0], material),
                rectangle(f"o{k}", [0.3, 0, 0], [0, 1, 0], [0, 0, 0.6], material),
                triangle(f"o{k}", [[0.1, 0.1, 0.3], [0.9, 0.8, 0.4], [0.9, 0.8 + gap, 0.4]], material),
                triangle(f"o{k}", rng.uniform(0.05, 0.95, (3, 3)), material),
            ][(seed + 3 * k) % 7]
        )
    for shape in shapes:
        for key in ("corner", "edge_u", "edge_v", "center", "size"):
            if key in shape:
                shape[key] = [scale * c for c in shape[key]]
        if "vertices" in shape:
            shape["vertices"] = [[scale * c for c in v] for v in shape["vertices"]]
    key = {
        "type": "point",
        "name": "key",
        "position": [scale * c for c in rng.uniform(0.3, 0.7, 3)],
        "intensity": [scale * scale * c for c in (0.9, 0.5, 0.2)],
    }
    return world(*shapes, lights=[key], materials=MATERIALS, bounces=1)


def hemisphere(normal: Array, count: int, shift: Array) -> Array:
    """Directions of a lattice above a surface, a cosine weighs them."""
    k = np.arange(count)[:, None]
    u = np.mod(k * np.array([0.7548776662466927, 0.5698402909980532]) + shift, 1.0)
    first = np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.7 else [0, 1.0, 0])
    first /= np.linalg.norm(first)
    r, turn = np.sqrt(u[:, :1]), 2 * math.pi * u[:, 1:]
    flat = r * np.cos(turn) * first + r * np.sin(turn) * np.cross(normal, first)
    return flat + np.sqrt(1 - u[:, :1]) * normal


def reflected_once(scene: Scene, place: Array, normal: Array, count: int, seed: int) -> tuple[Array, Array]:
    """(mean over directions of the direct light that a place sees, standard error) by the numeric pipeline."""
    arrays = radiometric_arrays(load_any(scene | {"bounces": 0}))  # type: ignore[arg-type]
    means = []
    for shift in range(SHIFTS):
        directions = hemisphere(normal, count, np.random.default_rng([seed, shift]).random(2))
        origins = np.tile(place + 1e-10 * np.abs(place).max() * normal, (count, 1))
        means.append(numeric_rays(arrays, origins, directions)[1].mean(axis=0))
    found = np.array(means)
    return found.mean(axis=0), found.std(axis=0, ddof=1) / math.sqrt(SHIFTS)
