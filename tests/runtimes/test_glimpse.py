"""A glimpse is the image without its error: the same light to the last bit, and the texture's own colour."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.runtimes.glimpse import direct_rows, reflectance_rows
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.suite.write import scene_of

SIZE = (20, 14)


@pytest.mark.parametrize("name", ["visibility", "penumbra", "sky", "texture", "roughness"])
def test_direct_light_is_that_of_the_image(name: str) -> None:
    scene = scene_of(name)
    layer = np.zeros((SIZE[1], SIZE[0], 3))
    rows = direct_rows(radiometric_arrays(scene), *SIZE)
    for y in range(0, SIZE[1], 4):
        rows(y, min(y + 4, SIZE[1]), layer)
    true = sr.truth(scene, size=SIZE, tol=1e-6).layer("direct")
    assert (true > 0.0).mean() > 0.1
    assert np.array_equal(layer, true)


def test_what_is_seen_has_its_reflectance() -> None:
    scene = scene_of("texture")
    layer = np.full((SIZE[1], SIZE[0], 3), -1.0)
    reflectance_rows(radiometric_arrays(scene), *SIZE)(0, SIZE[1], layer)
    true = sr.truth(scene, size=SIZE, tol=1e-6)
    bare = scene.model_dump()
    for part in bare["materials"].values():
        part["reflectance"] = 1.0
    white = sr.truth(load_any(bare), size=SIZE, tol=1e-6)
    lit = white.radiance.min(axis=-1) > 0.0
    assert lit.mean() > 0.5 and len(np.unique(layer[lit])) > 3
    assert np.abs(layer * white.radiance - true.radiance)[lit].max() < 1e-12
    assert not layer[true.layer("hit_class") == 0].any()


def test_what_an_image_refuses_a_glimpse_does_too() -> None:
    data = scene_of("sky").model_dump()
    data["materials"] = {name: {"type": "phong", "exponent": 8} for name in data["materials"]}
    with pytest.raises(Unsupported, match="a sky over a conductor or a phong"):
        direct_rows(radiometric_arrays(load_any(data)), *SIZE)
