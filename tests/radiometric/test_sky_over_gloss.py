"""A constant sky over conductors and phong: directional albedos, a furnace, the path tracer, tolerances."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.quadrature.half_vector import Rough, albedo

import symrender as sr
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

from .test_glossy_bounce import ETA, K, phong_albedo

METAL = {"type": "conductor", "eta": ETA, "k": K}
KINDS = [METAL | {"alpha": 0.3}, METAL | {"alpha": 0.2, "distribution": "beckmann", "masking": "correlated"},
         METAL | {"alpha": 0.4, "distribution": "beckmann", "g1": "walter"},
         {"type": "phong", "exponent": 30, "reflectance": 1}]  # fmt: skip
SKY = np.array([0.5, 1.0, 2.0])
EYE = np.array([0.2, -4.0, 2.5])


def scene(material: dict[str, Any], shapes: list[dict[str, Any]], lamps: float = 0.0) -> dict[str, Any]:
    """A ball of a material among others, under a sky; spheres named lamp emit what share of it is said."""
    lights: list[dict[str, Any]] = [{"type": "sky", "name": "sky", "radiance": SKY.tolist()}]
    lights += [
        {"type": "area", "name": f"light{k}", "shape": shape["name"], "radiance": (lamps * SKY).tolist()}
        for k, shape in enumerate(shapes)
        if shape["name"].startswith("lamp")
    ]
    return {
        "units": "radiometric",
        "bounces": 0,
        "camera": {"type": "look_at", "eye": EYE.tolist(), "target": [0, 0, 0.5], "fov": 40},
        "materials": {"gloss": material, "dull": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "sphere", "name": "ball", "center": [0, 0, 0.6], "radius": 0.5, "material": "gloss"},
            *shapes,
        ],
        "lights": lights,
    }


def sphere(name: str, center: tuple[float, float, float], radius: float, material: str = "dull") -> dict[str, Any]:
    return {"type": "sphere", "name": name, "center": list(center), "radius": radius, "material": material}


AMONG = [
    {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "gloss"},
    {
        "type": "plane",
        "name": "back",
        "point": [-2.5, 0, 0],
        "normal": [-1, 0, 0],
        "along": [0, 1, 0],
        "material": "dull",
    },
    sphere("lamp", (0.5, 1.4, 1.5), 0.4),
    sphere("hides", (0.7, 0.6, 0.9), 0.25, "gloss"),
]
"""The floor and a ball are of the material too, and a wall shows the ball its black back."""
AIMS = np.array(
    [[0.1, 0.0, 0.9], [0.0, 0.0, 1.0], [0.1, -0.1, 1.0], [0.6, 0.5, 0.9], [1.4, -0.5, 0.0], [-1.0, -0.8, 0.0]]
)


@pytest.mark.parametrize("material", KINDS, ids=["ggx", "beckmann", "walter", "phong"])
def test_nothing_but_sky_gives_the_directional_albedo(material: dict[str, Any]) -> None:
    made = scene(material, [])
    top = np.array([0.0, 0.0, 1.1])
    for cosine in (0.95, 0.6, 0.2):
        way = np.array([0.6 * math.sqrt(1 - cosine**2), 0.8 * math.sqrt(1 - cosine**2), cosine])
        if material["type"] == "phong":
            known = np.full(3, phong_albedo(30.0, cosine))
        else:
            kind = [key in material for key in ("distribution", "g1")]
            rough = Rough(material["alpha"], "masking" in material, np.array(ETA), np.array(K), *kind)
            known = albedo(rough, cosine, 320)
        seen = sr.probe(made, rays=(top + 3 * way, -way), tol=1e-9)
        assert known.min() > 0.15 and known.max() <= 1.0
        assert seen.status[0] == 0 and seen.error[0] <= 1e-9
        assert np.abs(seen.direct[0] - SKY * known).max() < 2e-9


@pytest.mark.parametrize("material", KINDS, ids=["ggx", "beckmann", "walter", "phong"])
def test_lamps_as_bright_as_the_sky_are_not_seen_before_it(material: dict[str, Any]) -> None:
    places = [((0.45, -0.2, 1.9), 0.3), ((0.1, 0.3, 1.9), 0.25), ((-0.1, 0.7, 2.6), 0.45), ((0.9, 0.3, 1.7), 0.2)]
    lamps = [sphere(f"lamp{k}", center, radius) for k, (center, radius) in enumerate(places)]
    aims = AIMS[:3] - EYE
    alone = sr.probe(scene(material, []), rays=(EYE, aims), tol=1e-8)
    among = sr.probe(scene(material, lamps, 1.0), rays=(EYE, aims), tol=1e-8)
    black = sr.probe(scene(material, lamps, 0.0), rays=(EYE, aims), tol=1e-8)
    assert list(alone.shape) == list(among.shape) == ["shapes.ball"] * 3 and (among.status == 0).all()
    assert (np.abs(alone.direct - among.direct).max(axis=1) <= alone.error + among.error).all()
    assert (alone.direct - black.direct).max() > 0.1


@pytest.mark.parametrize("material", KINDS, ids=["ggx", "beckmann", "walter", "phong"])
def test_the_path_tracer_finds_the_same(material: dict[str, Any]) -> None:
    made = sr.load(scene(material, AMONG, 3.0))
    origins, directions = np.tile(EYE, (len(AIMS), 1)), AIMS - EYE
    seen = sr.probe(made, rays=(origins, directions), tol=1e-7)
    assert (seen.status == 0).all() and set(seen.shape) == {"shapes.floor", "shapes.ball", "shapes.hides"}
    for tol in (1e-2, 1e-4):
        loose = sr.probe(made, rays=(origins, directions), tol=tol)
        assert (np.abs(loose.direct - seen.direct).max(axis=1) <= loose.error + seen.error).all()
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    runs = [numeric_rays(radiometric_arrays(made), origins, unit, order=64, seed=s)[1] for s in range(8)]
    mean, error = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.direct > 0.02
    assert bright.sum() >= 12 and (error[bright] < 0.02 * seen.direct[bright]).all()
    z = ((mean - seen.direct) / (error + 1e-7))[bright]
    assert np.abs(z).max() < 8 and abs(float(np.mean(z))) < 2.0, z


def test_an_image_has_it_in_its_direct_layer() -> None:
    image = sr.truth(scene(KINDS[0], AMONG, 3.0), size=12, tol=1e-3)
    assert image.layer("status").max() == 0 and image.layer("error").max() <= 1e-3
    seen, direct = image.layer("hit_class"), image.layer("direct")
    assert {1, 2} <= set(np.unique(seen)) and direct[seen > 0].max() > 0.5 and image.layer("indirect").max() == 0
    assert (image.layer("emitted")[seen == 0] == SKY).all()
