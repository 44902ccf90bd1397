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
    scene: RadiometricScene, name: str, filter: Filter, size: int, layer: str, tol: float, closer: float
) -> tuple[float, float]:
    """By how much a derivative in a colour from 0 on is beyond what it states, at most, and the largest derivative."""
    image = sr.gradient(scene, [name], size=size, tol=tol, filter=filter)[name]
    ahead, half, here = (
        sr.truth(scene.replace({name: x}), size=size, tol=closer, filter=filter) for x in (1.0, 0.5, 0.0)
    )
    # of a bounce between what has one material of second degree, so three values are asked
    parts = ((ahead, -1.0), (half, 4.0), (here, -3.0))
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
    beyond, most = hidden_slopes(black(name, group), f"{group}.g", filter, 6, "radiance", 1e-3, 1e-6)
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
    beyond, most = hidden_slopes(black("interreflection", group), f"{group}.r", filter, 4, "indirect", 1e-3, 1e-5)
    assert beyond <= 1e-12 and most > 1e-3
