"""The split rule's own radiance against the one emitted from the expressions: one formula, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from emitted import FORMULAS
from symrender.jit.records import table
from symrender.leaves.values import marble
from symrender.quadrature.disk import light_points as emitted_points
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.light_term import light_term
from symrender.scene import arrays as at
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.records import Sphere


def units(rng: np.random.Generator, n: int) -> np.ndarray:
    v = rng.normal(size=(n, 3))
    return v / np.sqrt((v * v).sum(axis=1, keepdims=True))


@pytest.mark.parametrize("model", [at.BLINN, at.PHONG])
@pytest.mark.parametrize("shininess", [0.0, 1.0, 2.5, 7.0, 32.0, 40.0, 333.3])
def test_light_term_is_the_emitted_one(model: int, shininess: float) -> None:
    rng = np.random.default_rng(11)
    normals, views = units(rng, 400), units(rng, 400)
    offsets = units(rng, 400) * 10 ** rng.uniform(-3, 3, (400, 1))
    shown = behind = 0
    for n, v, d in zip(normals.tolist(), views.tolist(), offsets.tolist(), strict=True):
        cosine, gleam = light_term(*d, *n, *v, model == at.PHONG, shininess)
        expected, sign, square = FORMULAS.light_factors(*n, *v, *d, float(model))
        assert abs(cosine - expected) <= 4e-16
        if sign > 0 or shininess == 0.0:
            shown += 1
            # a power multiplies the rounding of its base
            assert abs(gleam - FORMULAS.power(square, shininess / 2)) <= (4 + shininess) * 4e-16
        else:
            behind += 1
            assert gleam == 0.0
    assert shown >= 100
    assert behind >= 100 or shininess == 0.0


def test_marble_is_the_emitted_one() -> None:
    rng = np.random.default_rng(3)
    spheres = table(Sphere, 1)
    for normal in units(rng, 300).tolist():
        ku, kv = rng.uniform(0, 9, 2)
        spheres[0].texture, spheres[0].ku, spheres[0].kv = at.MARBLE, ku, kv
        assert abs(marble(*normal, ku, kv) - FORMULAS.texture_factor(0, *normal, spheres)) < 1e-14


@pytest.mark.parametrize("name", ["chapter8", "penumbra", "gloss"])
@pytest.mark.parametrize("order", [1, 2, 5])
def test_light_points_are_the_emitted_ones(name: str, order: int) -> None:
    arrays = scene_arrays(load(name))
    assert (arrays.lights["kind"] == at.DISK).any()
    expected = emitted_points(arrays.lights, order, FORMULAS.light_point)
    rows = light_rows(arrays, order)
    np.testing.assert_allclose(np.hstack([rows["position"], rows["color"]]), expected, rtol=1e-13, atol=1e-13)
