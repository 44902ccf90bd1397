"""What is black has a slope: light is of first degree in each colour it meets, so differences of values are exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Filter


def black(name: str, group: str, **changes: Any) -> RadiometricScene:
    """A scene with one of its colours black."""
    scene = sr.load(name).replace({f"{group}.{c}": 0.0 for c in "rgb"} | changes)
    assert isinstance(scene, RadiometricScene)
    return scene


def hidden_slopes(
    scene: RadiometricScene, name: str, filter: Filter, size: int, layer: str, known_to: float, degree: int
) -> tuple[float, float]:
    """By how much a derivative in a colour from 0 on is beyond what it states, at most, and the largest derivative.

    Of light that is of first degree in the colour two values tell the derivative, to ``known_to``, of second degree
    three.
    """
    image = sr.gradient(scene, [name], size=size, tol=1e-3, filter=filter)[name]
    weights = {1: {1.0: 1.0, 0.0: -1.0}, 2: {1.0: -1.0, 0.5: 4.0, 0.0: -3.0}}[degree]
    closer = known_to / sum(map(abs, weights.values()))
    parts = [
        (sr.truth(scene.replace({name: x}), size=size, tol=closer, filter=filter), by) for x, by in weights.items()
    ]
    wanted = sum(by * each.layer(layer) for each, by in parts)
    doubt = sum(abs(by) * each.layer("error") for each, by in parts)
    off = np.abs(image.layer(layer) - wanted).max(axis=2) - doubt - image.layer("error")
    known = np.isfinite(off)
    assert known.mean() > 0.7
    return float(off[known].max()), float(np.abs(wanted).max())


@pytest.mark.parametrize("filter", ["centre", "box"])
@pytest.mark.parametrize(
    ("name", "group"),
    [
        ("metal", "materials.tiles.reflectance.bright"),
        ("metal", "materials.gold20.reflectance.color"),
        ("metal", "lights.key.intensity"),
        ("furnace_radiometric", "materials.fields.reflectance.dark"),
        ("furnace_radiometric", "lights.world.radiance"),
    ],
)
def test_direct_light(name: str, group: str, filter: Filter) -> None:
    size = 6 if filter == "centre" else 4
    beyond, most = hidden_slopes(black(name, group), f"{group}.g", filter, size, "radiance", 8e-6, 1)
    assert beyond <= 1e-12 and most > 1e-3


@pytest.mark.parametrize(
    ("group", "filter"),
    [
        ("materials.sand.reflectance.color", "centre"),
        ("lights.lamp.intensity", "centre"),
        ("lights.lamp.intensity", "box"),
    ],
)
def test_bounced_light(group: str, filter: Filter) -> None:
    # of a bounce between what has one material light is of second degree
    degree = 2 if group.startswith("materials") else 1
    # narrow pixels, whose means are known much better than their slopes are large
    size, fov = (4, 31.0) if filter == "centre" else (2, 8.0)
    scene = black("interreflection", group, **{"camera.fov": fov})
    beyond, most = hidden_slopes(scene, f"{group}.r", filter, size, "indirect", 8e-5, degree)
    assert beyond <= 1e-12 and most > 1e-3
