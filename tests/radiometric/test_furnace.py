"""The furnace in watts: a convex body in light from everywhere shows its reflectance, whatever the bounces."""

from __future__ import annotations

import numpy as np

import symrender as sr
from symrender.images.image import Image
from symrender.scene.load import load_any

DARK = np.array([0.25, 0.5, 0.75])


def fields(image: Image) -> tuple[np.ndarray, np.ndarray]:
    """Radiance of the pixels that see the sphere, and which of them are of a dark field."""
    seen = image.layer("hit_class") == 1
    assert 0.2 < seen.mean() < 0.9
    light = image.radiance[seen]
    dark = light[:, 0] < 0.3
    assert min(dark.sum(), (~dark).sum()) > 0.3 * seen.sum()
    return light, dark


def test_every_field_shows_half_its_reflectance() -> None:
    image = sr.truth("furnace_radiometric", size=48, tol=1e-12)
    light, dark = fields(image)
    assert np.abs(light[~dark] - 0.5).max() <= 1e-14
    assert np.abs(light[dark] - 0.5 * DARK).max() <= 1e-14
    np.testing.assert_array_equal(image.radiance[image.layer("hit_class") == 0], 0.5)
    assert (image.layer("status") == 0).all()


def test_paths_find_the_same_at_any_number_of_bounces() -> None:
    for bounces in (0, 1, "all"):
        scene = load_any("furnace_radiometric").replace({"bounces": bounces})
        # directions drawn by the cosine alone all bring the same light
        pair = sr.render(scene, size=24, lobe=3, numeric="importance", symbolic="none")
        assert pair.numeric is not None
        light, dark = fields(pair.numeric)
        assert np.abs(light[~dark] - 0.5).max() <= 1e-12
        assert np.abs(light[dark] - 0.5 * DARK).max() <= 1e-12


def test_its_derivatives_are_known_too() -> None:
    names = ["lights.world.radiance.g", "materials.fields.reflectance.dark.b", "shapes.ball.radius", "camera.eye.z"]
    slopes = sr.gradient("furnace_radiometric", names, size=24)
    _, dark = fields(sr.truth("furnace_radiometric", size=24))
    seen = slopes[names[0]].layer("hit_class") == 1
    by_sky, by_dark = slopes[names[0]].radiance[seen], slopes[names[1]].radiance[seen]
    assert np.abs(by_sky[dark] - [0.0, 0.5, 0.0]).max() <= 1e-14 and np.abs(by_sky[~dark] - [0, 1, 0]).max() <= 1e-14
    assert np.abs(by_dark[dark] - [0, 0, 0.5]).max() <= 1e-14 and not by_dark[~dark].any()
    for name in names[2:]:
        assert np.abs(slopes[name].radiance).max() <= 1e-13
