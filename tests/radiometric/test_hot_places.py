"""Bounced light that comes from nearby, by beams and from lamps beside walls, is no secret to a pixel of a floor.

Each scene has one pixel that holds all of it in a part of a tenth of its side or less, where neither one node nor four
fall. The judge is a grid of single rays through each pixel that is lit, whose cells are a third of what is lit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.scene.load import load_any

Scene = dict[str, Any]
SIZE, FOV = 4, 20.0
EYE = np.array([0.0, -8.0, 10.0])
GRID, DIM = 40, 12
"""Rays along a side of a pixel, and where neither as few as the second nor the package find much light."""
ROUGH = 0.08
"""What so coarse a grid may be off by, of the light."""
SCENES = {
    "a beam in a metal": {
        "type": "spot", "name": "L", "position": [0.2, 0.127, 0.9], "direction": [0.8, 0.0, -0.4], "beam": 1.5,
        "cutoff": 3.0, "intensity": [30.0] * 3,
    },
    "a lamp in a corner": {"type": "point", "name": "L", "position": [0.97, 0.35, 0.03], "intensity": [0.05] * 3},
}  # fmt: skip


def scene(light: Scene, wall: Scene) -> Scene:
    """A floor before a wall."""
    return {
        "units": "radiometric", "name": "hot", "bounces": 1,
        "camera": {"type": "look_at", "eye": EYE.tolist(), "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0],
                   "fov": FOV},
        "materials": {"floor": {"type": "diffuse", "reflectance": [0.5] * 3}, "wall": wall},
        "shapes": [
            {"type": "plane", "name": "P", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
            {"type": "plane", "name": "W", "point": [1, 0, 0], "normal": [-1, 0, 0], "along": [0, 1, 0],
             "material": "wall"},
        ],
        "lights": [light],
    }  # fmt: skip


def rays(row: int, column: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A grid of rays through a pixel."""
    ahead = -EYE / np.linalg.norm(EYE)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up, wide = np.cross(right, ahead), np.tan(np.radians(0.5 * FOV))
    at = (np.arange(count) + 0.5) / count
    x = np.tile(2.0 * (column + at) / SIZE - 1.0, count) * wide
    y = np.repeat(1.0 - 2.0 * (row + at) / SIZE, count) * wide
    d = ahead + x[:, None] * right + y[:, None] * up
    return np.tile(EYE, (len(d), 1)), d / np.linalg.norm(d, axis=1)[:, None]


@pytest.mark.parametrize("name", SCENES)
def test_a_pixel_knows_what_lights_a_part_of_it(name: str) -> None:
    metal = {"type": "conductor", "distribution": "ggx", "alpha": 0.01, "eta": [0.2] * 3, "k": [3.0] * 3}
    wall = metal if "metal" in name else {"type": "diffuse", "reflectance": [0.8] * 3}
    made = load_any(scene(SCENES[name], wall))
    loose, tight = (sr.truth(made, size=SIZE, tol=tol, filter="box", budget=2_000_000) for tol in (1e-3, 1e-4))

    def seen(k: int, count: int) -> np.ndarray:
        return np.asarray(sr.probe(made, rays=rays(k // SIZE, k % SIZE, count), tol=1e-4).indirect[:, 0])

    known = np.array([seen(k, DIM).mean() for k in range(SIZE * SIZE)])
    told = np.maximum(loose.layers["indirect"][..., 0], tight.layers["indirect"][..., 0]).ravel()
    lit = np.flatnonzero(np.maximum(known, told) > 0.01 * known.max())
    fine = {k: seen(k, GRID) for k in lit.tolist()}
    known[lit] = [each.mean() for each in fine.values()]
    most = int(known.argmax())
    # nearly all of it in a part of a pixel
    brightest = np.sort(fine[most])[::-1]
    assert known[most] > 2e-3 and brightest[: brightest.size // 10].sum() > 0.6 * brightest.sum()
    for image in (loose, tight):
        off = np.abs(image.layers["indirect"][..., 0].ravel() - known)
        assert (off <= image.layers["error"].ravel() + ROUGH * known[most]).all(), (off, image.layers["error"])
