"""Smooth conductors: a mirror shows what stands before it, by closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.scene.load import load_any
from symrender.scene.radiometric.materials import Conductor
from symrender.scene.radiometric.metals import METALS
from symrender.scene.warnings import warnings

LAMP = {"type": "sphere", "name": "lamp", "center": [0, 3, 4], "radius": 0.5, "material": "black"}
FLOOR = {"type": "rectangle", "name": "floor", "corner": [-9, -9, 0], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0]}


def scene(metal: dict[str, Any], *, bounces: int = 0, **fields: Any) -> dict[str, Any]:
    """A mirror for a floor, that shows the middle of a lamp."""
    return {
        "units": "radiometric", "name": "mirror", "bounces": bounces,
        "camera": {"type": "look_at", "eye": [0, -3, 4], "target": [0, 0, 0], "fov": 1},
        "materials": {"black": {"type": "diffuse", "reflectance": 0}, "metal": {"type": "conductor"} | metal},
        "shapes": [FLOOR | {"material": "metal"}, LAMP],
        "lights": [{"type": "area", "name": "glow", "shape": "lamp", "radiance": [1, 2, 3]}],
    } | fields  # fmt: skip


def fresnel(cosine: float, n: complex) -> float:
    """Unpolarised reflectance, by the angle of refraction as a complex number."""
    inner = np.sqrt(1 - (1 - cosine**2) / n**2 + 0j)
    s = (cosine - n * inner) / (cosine + n * inner)
    p = (n * cosine - inner) / (n * cosine + inner)
    return float(abs(s) ** 2 + abs(p) ** 2) / 2


def test_a_mirror_that_shows_a_lamp_is_direct_light_and_exact() -> None:
    image = sr.truth(scene({"material": "Au", "alpha": 0}), size=1, tol=1e-3, budget=100_000, threads=1)
    eta, k = METALS["Au"]
    cosine = 4 / 5
    wanted = [r * fresnel(cosine, complex(n, x)) for r, n, x in zip((1, 2, 3), eta, k, strict=True)]
    assert max(wanted) > 0.9 and wanted[0] / 1 > 1.2 * wanted[2] / 3
    assert np.abs(image.layer("direct")[0, 0] - wanted).max() < 1e-12
    assert not image.layer("indirect").any() and not image.layer("emitted").any()
    assert "a smooth conductor" in image.meta["providers"]


def test_a_mirror_between_mirrors_shows_as_many_as_bounces_allow() -> None:
    """Up and down between two plane mirrors, the upper one with a hole that a lamp fills."""
    above = {"type": "plane", "name": "above", "point": [0, 0, 1], "normal": [0, 0, -1], "material": "metal"}
    sky = {"type": "plane", "name": "below", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "metal"}
    lamp = {
        "type": "disk",
        "name": "lamp",
        "center": [0, 0, 0.9],
        "normal": [0, 0, -1],
        "radius": 0.1,
        "material": "black",
    }
    slope = 0.25
    for bounces in range(4):
        eye = [0.0, -slope * (0.9 + 2.0 * bounces + 0.5), 0.5]
        camera = {"type": "look_at", "eye": eye, "target": [0, eye[1] + slope * 0.5, 0], "fov": 0.01}
        made = scene({"material": "none", "alpha": 0, "reflectance": 0.5}, bounces=bounces, camera=camera)
        made |= {"shapes": [above, sky, lamp], "lights": [made["lights"][0] | {"shape": "lamp"}]}
        image = sr.truth(made, size=1, tol=1e-3, budget=100_000, threads=1)
        count = 2 * bounces + 1
        seen = image.radiance[0, 0, 0]
        assert abs(seen - (0.5**count if count <= bounces + 1 else 0.0)) < 1e-12, (bounces, seen)
        assert abs(image.layer("direct")[0, 0, 0] - (0.5 if bounces == 0 else 0.0)) < 1e-12


def test_a_smooth_metal_is_the_limit_of_rough_ones() -> None:
    smooth = sr.truth(scene({"material": "Cu", "alpha": 0}), size=1, tol=1e-3, budget=200_000, threads=1)
    rough = sr.truth(scene({"material": "Cu", "alpha": 1e-4}), size=1, tol=1e-3, budget=200_000, threads=1)
    assert smooth.radiance.min() > 0.4
    assert np.abs(smooth.radiance - rough.radiance).max() <= rough.layer("error")[0, 0] + 1e-6


def test_light_of_a_point_has_no_path_over_a_mirror() -> None:
    """No direction that is chosen meets a point: the image is without that light, and the scene says so."""
    lights = [{"type": "point", "name": "spark", "position": [0, 3, 4], "intensity": 9}]
    made = scene({"material": "Au", "alpha": 0}, lights=lights)
    assert not sr.truth(made, size=1, tol=1e-3, budget=1000, threads=1).radiance.any()
    assert any("lights.spark" in line for line in warnings(load_any(made)))


def test_metals_by_name_and_their_faults() -> None:
    loaded = load_any(scene({"material": "Au", "alpha": 0}))
    metal = loaded.materials["metal"]  # type: ignore[union-attr]
    assert isinstance(metal, Conductor) and (metal.eta, metal.k) == METALS["Au"]
    assert load_any(loaded.model_dump()).hash == loaded.hash
    for wrong, said in (
        ({"material": "Aux", "alpha": 0}, "did you mean 'Au'"),
        ({"material": "Au", "alpha": 0, "eta": 1}, "stands for eta and k"),
        ({"alpha": 1e-6, "eta": 1, "k": 1}, "must be 0, which is smooth, or at least 0.0001"),
        ({"alpha": 0, "eta": 0, "k": 0}, "must be at least 0.001, or 0 with a k above 0"),
    ):
        with pytest.raises(SceneError, match=said):
            load_any(scene(wrong))
    with pytest.raises(Unsupported, match="a smooth conductor is not integrated by quadrature"):
        sr.truth(scene({"material": "Au", "alpha": 0}), size=1, method="quadrature")
    assert math.isclose(fresnel(0.3, 1j), 1.0)
