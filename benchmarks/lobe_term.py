"""The lobe term of the source chapter's picture: the job several benchmarks time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from symrender.runtimes.image import prepare
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, scene_arrays
from symrender.scene.load import load
from symrender.settings import Settings, Weights

Layers = dict[str, np.ndarray]


def blank(width: int) -> Layers:
    """Layers of a square picture."""
    layers = {name: np.zeros((width, width, 3)) for name in ("radiance", "direct", "gloss")}
    return layers | {"hit_class": np.zeros((width, width))}


def picture(
    width: int, k: int, *, floor_weight: float = 0.3, weights: Weights = "exact"
) -> tuple[Callable[[], int], Layers]:
    """Work that renders ``chapter8`` by strata on one thread, spheres' lobes off, and the layers it fills.

    The work returns the number of lobe directions weighed.
    """
    changes = {"spheres.A.lobe.weight": 0.0, "spheres.B.lobe.weight": 0.0, "floor.lobe.weight": floor_weight}
    arrays = scene_arrays(load("chapter8").replace(changes))
    settings = Settings(width=width, height=width, lobe=k, numeric="none", weights=weights, aa="none")
    layers, kernel = blank(width), prepare(arrays, settings)
    return lambda: kernel(0, 0, width, width, layers), layers


def floor_pixels(layers: Layers) -> np.ndarray:
    """Which pixels see the floor."""
    return layers["hit_class"] == FLOOR


CHAPTER_CODES = {1: FIRST_SPHERE, 2: FIRST_SPHERE + 1, 3: FLOOR}
"""The chapter's codes of what a pixel sees, as hit classes."""
