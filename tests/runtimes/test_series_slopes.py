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
        SIZE, tol=tol, disk="2x2", aa="none", budget=None, threads=1, tile=0, filter=kind
    )  # fmt: skip
    job, place = gradient_job(scene, [name], settings), (column, row, column + 1, row + 1)
    layers = job.empty_layers()
    prepare(scene_arrays(scene), settings, job.wrt)(*place, layers)
    value, fine = float(get(scene, name)), replace(settings, tol=3e-6)

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


def room() -> Scene:
    """A ball before a wall that stands askew on a checkered floor, seen through one pixel."""
    scene = sr.load({
        "name": "room",
        "camera": {"type": "look_at", "eye": [0.1, -6, 3], "target": [0.35, 1.6, 0.1], "fov": 5},
        "spheres": [{"name": "A", "center": [0.6, 0.9, 0.4], "radius": 0.4, "color": [0.2, 0.5, 0.9],
                     "texture": {"type": "stripes", "ku": 2.3}}],
        "floor": {"texture": {"type": "checker", "cell": 0.8, "offset": [0.1, 0.05]}},
        "planes": [{"name": "wall", "point": [0, 1.93, 0], "normal": [0.3, -1, 0.1], "along": [1, 0, 0.2],
                    "texture": {"type": "checker", "cell": 2.7, "offset": [0.2, 0.1]}}],
        "lights": [{"type": "point", "name": "k", "position": [1, -3, 4]}],
        "background": [0.1, 0.2, 0.3],
        "shading": {"shininess": 12.5},
    })  # fmt: skip
    assert isinstance(scene, Scene)
    return scene


def test_whatever_a_pixel_shows_moves_it_as_differences_say() -> None:
    """An excerpt of ``benchmarks/filtered_derivatives_are_stated.py``: a ball, a floor and a plane in one pixel."""
    scene, told = room(), 0
    names = [
        *("planes.wall.point.y", "planes.wall.normal.x", "planes.wall.texture.cell", "planes.wall.texture.bright.b"),
        *("floor.texture.offset.x", "spheres.A.center.x", "spheres.A.texture.ku", "lights.k.position.x"),
        *("shading.shininess", "camera.eye.y", "camera.fov"),
    ]
    found = sr.gradient(scene, names, size=1, tol=1e-3, filter="box", threads=1)
    for name in names:
        value, sides = float(get(scene, name)), []
        step = 2e-3 * max(1.0, abs(value))
        for part in (1.0, 0.5):
            high, low = (
                sr.truth(scene.replace({name: value + side * part * step}), size=1, tol=1e-6, filter="box", threads=1)
                for side in (1, -1)
            )
            sides.append((high.radiance[0, 0] - low.radiance[0, 0]) / (2 * part * step))
        far, near = sides
        expected = (4 * near - far) / 3
        stated = float(found[name].layer("error")[0, 0])
        doubt = np.abs(near - far).max() + 2 * float(high.layer("error")[0, 0]) / step
        assert np.abs(found[name].radiance[0, 0] - expected).max() <= 1.5 * stated + 2 * doubt, name
        told += np.abs(expected).max() > 5 * (stated + doubt)
    assert told >= 8
