"""Derivatives by what lights send: light is linear in it, so values times derivatives add up to the image."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from tests.radiance.test_sampled import world

import symrender as sr
from symrender.errors import Unsupported

LENS = {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.4], "fov": 35, "aperture": 0.05, "focus": 5.0}
LIGHTS = [
    {"type": "point", "name": "K", "position": [2, -2, 4], "intensity": [30, 20, 10]},
    {"type": "sky", "name": "S", "radiance": [0.2, 0.3, 0.4]},
]
SENT = [*(f"lights.K.intensity.{c}" for c in "rgb"), *(f"lights.S.radiance.{c}" for c in "rgb")]
SHAPES = [world()["shapes"][0], world()["shapes"][2]]


def added_up(scene: dict[str, Any], slopes: Any) -> tuple[Any, Any]:
    """Image and error of what lights send times the derivatives by it."""
    sent = [*scene["lights"][0]["intensity"], *scene["lights"][1]["radiance"]]
    parts = list(zip(sent, (slopes[name] for name in SENT), strict=True))
    return sum(x * each.radiance for x, each in parts), sum(x * each.layer("error") for x, each in parts)


@pytest.mark.parametrize("bounces", [0, 2])
def test_parts_of_an_image_through_a_lens_add_up_to_it(bounces: int) -> None:
    scene = world(camera=LENS, lights=LIGHTS, shapes=SHAPES, bounces=bounces)
    asked: dict[str, Any] = {"size": 4, "tol": 5e-3, "filter": "box", "threads": 1, "budget": 200_000}
    slopes, image = sr.gradient(scene, SENT, **asked), sr.truth(scene, **asked)
    assert all(each.radiance.max() > 1e-3 for each in slopes.values()) and image.radiance.max() > 0.2
    found, error = added_up(scene, slopes)
    off = np.abs(found - image.radiance).max(axis=2)
    assert (off <= error + image.layer("error")).all() and (off < 0.05 * image.radiance.max()).all()
    told = json.loads(slopes["lights.K.intensity.r"].meta["providers"])
    # a point light's share through a lens is quadrature's, where the sky's is sampled
    assert told["direct"] == "quadrature" and told["indirect"].startswith("sampled: ") == bool(bounces)
    assert json.loads(slopes["lights.S.radiance.r"].meta["providers"])["direct"].startswith("sampled: ")


def test_what_no_provider_differentiates_is_refused_by_name() -> None:
    scene = world(camera=LENS, lights=LIGHTS, shapes=SHAPES)
    with pytest.raises(Unsupported, match=r"camera.aperture: derivatives of means over a lens"):
        sr.gradient(scene, ["lights.K.intensity.r", "camera.eye.x"], size=2, filter="box")
    with pytest.raises(Unsupported, match=r"camera.aperture has no walls yet for a sky"):
        sr.gradient(scene, ["lights.S.radiance.r"], size=2, filter="box", method="quadrature")
    with pytest.raises(Unsupported, match=r"camera.eye.x: .* by what lights send"):
        sr.gradient(scene | {"camera": LENS | {"aperture": 0.0}}, ["camera.eye.x"], size=2, method="sampled")


def test_both_providers_find_one_derivative() -> None:
    scene = world(lights=LIGHTS[:1], shapes=SHAPES)
    names = ["lights.K.intensity.g", "camera.eye.x"]
    exact = sr.gradient(scene, names, size=4, tol=1e-6)
    paths = sr.gradient(scene, names[:1], size=4, tol=1e-3, method="sampled")
    one, other = exact[names[0]], paths[names[0]]
    assert one.radiance[..., 1].max() > 1e-3 and "kind" in other.layers and len(exact) == 2
    assert (np.abs(one.radiance - other.radiance).max(axis=2) <= one.layer("error") + other.layer("error")).all()


def test_the_filter_reaches_as_far_as_asked() -> None:
    scene = world(lights=LIGHTS[:1], shapes=SHAPES)
    names = [f"lights.K.intensity.{c}" for c in "rgb"]
    asked: dict[str, Any] = {"size": 5, "tol": 1e-4, "filter": "tent", "threads": 1}
    near = sr.truth(scene, **asked)
    far, slopes = (sr.truth(scene, filter_radius=2.0, **asked), sr.gradient(scene, names, filter_radius=2.0, **asked))
    found = sum(x * slopes[name].radiance for x, name in zip((30, 20, 10), names, strict=True))
    assert np.abs(near.radiance - far.radiance).max() > 0.02
    assert np.abs(found - far.radiance).max() <= 70 * 1e-4
