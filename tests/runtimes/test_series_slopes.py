"""Derivatives of means over pixels of scenes in units of the series against differences of the means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.gradient import gradient_job
from symrender.runtimes.series_pixels import prepare_series
from symrender.runtimes.series_slopes import prepare
from symrender.scene.arrays import scene_arrays
from symrender.scene.parameters import get
from symrender.scene.scene import Scene
from symrender.settings import Filter, split_settings

SIZE = 48
STEP = 1e-3


def slope_and_difference(scene: Scene, name: str, column: int, row: int, kind: Filter, tol: float) -> tuple[Any, ...]:
    """(direct and gloss (2, 3) of a pixel, what they state, their differences, what these may be off by)."""
    settings = split_settings(
        SIZE, tol=tol, disk="2x2", aa="none", budget=100_000, threads=1, tile=0, filter=kind
    )  # fmt: skip
    job, place = gradient_job(scene, [name], settings), (column, row, column + 1, row + 1)
    layers = job.empty_layers()
    prepare(scene_arrays(scene), settings, job.wrt)(*place, layers)
    value, fine = float(get(scene, name)), replace(settings, tol=3e-6, budget=1_000_000)

    def mean(step: float) -> tuple[Any, float]:
        filled = {layer: np.zeros((SIZE, SIZE, 3)) for layer in ("direct", "gloss", "radiance")}
        filled |= {layer: np.zeros((SIZE, SIZE)) for layer in ("error", "status", "evaluations", "hit_class")}
        prepare_series(scene_arrays(scene.replace({name: value + step})), fine)(*place, filled)
        return np.array([filled[layer][row, column] for layer in ("direct", "gloss")]), filled["error"][row, column]

    sides = [(mean(step), mean(-step)) for step in (STEP, 2 * STEP)]
    near, far = ((high[0] - low[0]) / (2 * STEP * (1 + k)) for k, (high, low) in enumerate(sides))
    doubt = float(np.abs(near - far).max()) + (sides[0][0][1] + sides[0][1][1]) / (2 * STEP)
    found = np.array([layers[f"{layer}:{name}"][row, column] for layer in ("direct", "gloss")])
    return found, float(layers[f"error:{name}"][row, column]), (4 * near - far) / 3, doubt


@pytest.mark.parametrize(
    ("name", "column", "row", "kind"),
    [
        ("spheres.B.center.x", 38, 29, "box"),
        ("spheres.B.radius", 39, 23, "box"),
        ("lights.key.position.x", 15, 9, "tent"),
        ("camera.eye.x", 21, 21, "box"),
        ("lights.key.position.x", 15, 9, "box"),
        ("floor.lobe.weight", 16, 31, "box"),
    ],
)
def test_derivatives_are_those_of_the_means(name: str, column: int, row: int, kind: Filter) -> None:
    scene = sr.load("gloss")
    assert isinstance(scene, Scene)
    found, stated, expected, doubt = slope_and_difference(scene, name, column, row, kind, 1e-2)
    assert stated <= 1e-2 and np.abs(expected).max() > 5 * (stated + doubt)
    assert np.abs((found - expected).sum(axis=0)).max() <= 1.5 * stated + doubt


@pytest.mark.parametrize("name", ["spheres.B.radius", "spheres.B.center.x", "camera.eye.x"])
def test_silhouettes_of_direct_light_move(name: str) -> None:
    # the limb of B before the background; nothing has a lobe
    dark = {f"spheres.{ball}.lobe.weight": 0.0 for ball in "ABC"} | {"floor.lobe.weight": 0.0}
    scene = sr.load("gloss").replace(dark)
    assert isinstance(scene, Scene)
    found, stated, expected, doubt = slope_and_difference(scene, name, 43, 14, "box", 1e-3)
    assert stated <= 1e-3 and np.abs(expected).max() > 5 * (stated + doubt)
    assert np.abs((found - expected).sum(axis=0)).max() <= 1.5 * stated + doubt
