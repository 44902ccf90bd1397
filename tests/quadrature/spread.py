"""As many spheres as are asked for, spread over a floor before the eye."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import symrender as sr


def spread(count: int) -> dict[str, Any]:
    """Spheres of .2 to .45, one on each cell of a grid of cells 1 wide."""
    rng, side = np.random.default_rng(0), math.isqrt(count)
    scene = sr.load("gloss").model_dump()
    spheres = []
    for k in range(count):
        radius = float(rng.uniform(0.2, 0.45))
        x, y = (np.array(divmod(k, side)) + 0.5 - 0.5 * side + rng.uniform(-0.1, 0.1, 2)).tolist()
        spheres.append({**scene["spheres"][1], "name": f"S{k}", "center": [x, y, radius], "radius": radius})
    camera = {"type": "look_at", "eye": [0.15 * side, -1.2 * side - 1.0, 0.7 * side + 0.6], "target": [0.0, 0.0, 0.2]}
    return {**scene, "name": f"spread{count}", "spheres": spheres, "camera": {**camera, "up": [0, 0, 1], "fov": 42.0}}
