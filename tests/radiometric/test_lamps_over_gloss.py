"""Spheres that emit over conductors and phong: a lamp that is a point, the path tracer, tolerances, what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

METAL = {"type": "conductor", "alpha": 0.3, "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1]}
KINDS = [METAL, METAL | {"distribution": "beckmann", "masking": "correlated"}, {"type": "phong", "exponent": 30}]
EYE = np.array([0.2, -4.0, 2.5])
AIMS = np.array([[0.4, 0.1, 0.0], [0.1, 0.4, 0.0], [-0.2, 0.2, 1.0], [0.8, 0.5, 0.0], [2.0, 0.5, 0.0]])


def scene(material: dict[str, Any], radius: float = 0.5, radiance: float = 3.0) -> dict[str, Any]:
    """A lamp over a floor and a ball of one material, and a plane that hides some of it from some."""
    return {
        "units": "radiometric",
        "bounces": 0,
        "camera": {"type": "look_at", "eye": EYE.tolist(), "target": [0, 0, 0.5], "fov": 40},
        "materials": {"gloss": material, "dull": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "gloss"},
            {"type": "sphere", "name": "lamp", "center": [0.5, 1.5, 1.5], "radius": radius, "material": "dull"},
            {"type": "sphere", "name": "ball", "center": [-0.3, 0.2, 0.6], "radius": 0.5, "material": "gloss"},
            {"type": "sphere", "name": "hides", "center": [0.6, 0.9, 0.7], "radius": 0.2, "material": "dull"},
        ],
        "lights": [{"type": "area", "name": "light", "shape": "lamp", "radiance": [radiance, 0.5 * radiance, 0.0]}],
    }


@pytest.mark.parametrize("material", KINDS, ids=["ggx", "beckmann", "phong"])
def test_a_small_lamp_is_a_point(material: dict[str, Any]) -> None:
    tiny, lit = scene(material, 1e-3, 1e6), 0
    tiny["shapes"] = [shape for shape in tiny["shapes"] if shape["name"] != "hides"]
    intensity = [math.pi, 0.5 * math.pi, 0]
    for at in range(5):
        lamp = sr.probe(tiny, rays=(EYE, AIMS[at] - EYE), tol=1e-9)
        point = tiny | {
            "shapes": [shape for shape in tiny["shapes"] if shape["name"] != "lamp"],
            "lights": [{"type": "point", "name": "L", "position": [0.5, 1.5, 1.5], "intensity": intensity}],
        }  # fmt: skip
        known = sr.probe(point, rays=(EYE, AIMS[at] - EYE)).direct[0]
        assert lamp.error[0] < 1e-5 * max(1.0, known[0])
        if known[0] > 1e-4:
            lit += 1
            # a lamp differs from a point by the square of its angle, times the slopes of the lobe
            np.testing.assert_allclose(lamp.direct[0, :2], known[:2], rtol=3e-5)
        else:
            assert lamp.direct[0].max() < 2e-4
    assert lit >= 2


@pytest.mark.parametrize("material", KINDS, ids=["ggx", "beckmann", "phong"])
def test_the_path_tracer_finds_the_same(material: dict[str, Any]) -> None:
    made = sr.load(scene(material))
    origins, directions = np.tile(EYE, (5, 1)), AIMS - EYE
    seen = sr.probe(made, rays=(origins, directions), tol=1e-8)
    assert (
        (seen.status == 0).all() and (seen.error <= 1e-8).all() and set(seen.shape) == {"shapes.floor", "shapes.ball"}
    )
    for tol in (1e-2, 1e-4):
        loose = sr.probe(made, rays=(origins, directions), tol=tol)
        assert (np.abs(loose.direct - seen.direct).max(axis=1) <= loose.error + seen.error).all()
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    runs = [numeric_rays(radiometric_arrays(made), origins, unit, order=64, seed=s)[1] for s in range(8)]
    mean, error = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.direct > 1e-2
    assert bright.sum() >= 5 and (error[bright] < 0.02 * seen.direct[bright]).all()
    z = (mean - seen.direct)[bright] / (error[bright] + 1e-8)
    assert np.abs(z).max() < 8 and abs(float(np.mean(z))) < 2.5, z


def test_an_image_has_it_in_its_direct_layer_beside_what_is_diffuse() -> None:
    made = scene(METAL)
    made["shapes"].append(
        {"type": "sphere", "name": "dull", "center": [0.9, -0.4, 0.3], "radius": 0.3, "material": "dull"}
    )
    image = sr.truth(made, size=16, tol=1e-4)
    seen, direct = image.layer("hit_class"), image.layer("direct")
    assert {1, 3, 5} <= set(np.unique(seen)) and image.layer("status").max() == 0
    assert min(direct[seen == k].max() for k in (1, 3, 5)) > 0.05 and image.layer("indirect").max() == 0
    np.testing.assert_allclose(image.radiance, direct + image.layer("emitted"), rtol=1e-15)


def test_what_is_not_integrated_is_refused_by_name() -> None:
    made = scene(METAL)
    with pytest.raises(Unsupported, match="in a scene with an area light"):
        sr.truth(made | {"bounces": 1}, size=4, method="quadrature")
    made["lights"] = [{"type": "sky", "name": "sky", "radiance": 1}]
    made["shapes"].append({"type": "disk", "name": "coin", "center": [2, 0, 1], "normal": [0, 0, 1], "radius": 0.2,
                           "material": "dull"})  # fmt: skip
    with pytest.raises(Unsupported, match=r"a sky over a conductor .* in a scene with a disk"):
        sr.truth(made, size=4, method="quadrature")
    made["shapes"][-1] = {"type": "triangle", "name": "sail", "vertices": [[2, 0, 1], [3, 0, 1], [2, 1, 1]],
                          "material": "dull"}  # fmt: skip
    with pytest.raises(
        Unsupported, match=r"a sky over a conductor .* in a scene with a rectangle, a triangle, a box or a mesh"
    ):
        sr.truth(made, size=4, method="quadrature")
