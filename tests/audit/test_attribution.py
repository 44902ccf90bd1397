"""Explanations come after the verdict, within their time, together where nothing tells them apart, or not at all."""

from __future__ import annotations

import time

import numpy as np
import pytest

import symrender as sr
from symrender.audit import attribution
from symrender.images.image import Image

SIZE = (24, 16)
SCENE = {
    "units": "radiometric", "name": "lit", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.4], "fov": 34},
    "materials": {"clay": {"type": "diffuse", "reflectance": 0.5}, "lime": {"type": "diffuse", "reflectance": 0.7}},
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"},
        {"type": "sphere", "name": "ball", "center": [0, 0, 0.8], "radius": 0.7, "material": "lime"},
    ],
    "lights": [{"type": "point", "name": "lamp", "position": [-2, -2, 4], "intensity": 30}],
}  # fmt: skip


@pytest.fixture(scope="module")
def true() -> Image:
    return sr.truth(SCENE, size=SIZE, tol=1e-8)


def test_what_cannot_be_told_apart_is_named_together(true: Image) -> None:
    """All light is of one lamp: 3 % more of it and an image 3 % brighter are one."""
    verdict = sr.audit(Image({"radiance": 1.03 * true.radiance}), SCENE, truth=true, noise_free=True)
    alike = [found for found in verdict.attribution if found.consistent]
    names = [found.name for found in alike]
    assert "the factor of the whole image" in names and any("lights.lamp.intensity" in name for name in names)
    assert all(found.value == pytest.approx(1.03, rel=1e-3) for found in alike) and len(alike) >= 2
    assert all(name in verdict.sentence() for name in names)


def test_what_explains_little_is_not_called_consistent(true: Image) -> None:
    """Noise that hides most of a bias lets anything leave no region off; 35 % of it explained is no explanation."""
    rng = np.random.default_rng(4)
    found = 0
    for seed in range(24):
        scale = 1.0 + 0.004 * (seed % 4)
        layers = [
            true.radiance * scale * (1 + 0.08 * rng.standard_normal((*true.radiance.shape[:2], 1))) for _ in range(8)
        ]
        verdict = sr.audit(
            [Image({"radiance": layer}) for layer in layers],
            SCENE,
            truth=true,
            wrt=["materials.lime.reflectance.color.g"],
        )
        for each in verdict.attribution:
            assert each.explains >= 0.8 or not each.consistent, each
            found += 1
    assert found > 24


def test_single_pixels_are_not_explained_and_others_within_their_time(
    true: Image, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = true.radiance.copy()
    one[8, 2] *= 1.01
    verdict = sr.audit(Image({"radiance": one}), SCENE, truth=true, noise_free=True)
    assert verdict.verdict == "failed" and verdict.pixels.rejected == 1
    if not verdict.failed:
        assert verdict.attribution == ()

    def slow(*args: object) -> object:
        for k in range(50):
            time.sleep(0.2)
            yield f"mistake {k}", true.radiance

    monkeypatch.setattr(attribution, "scene_mutations", slow)
    bright = Image({"radiance": 1.03 * true.radiance})
    begun = time.perf_counter()
    verdict = sr.audit(bright, SCENE, truth=true, noise_free=True, explain_seconds=1.0)
    assert time.perf_counter() - begun < 6.0 and verdict.verdict == "failed" and verdict.attribution
