"""Derivatives of the bounced light of spots, skies and lamps, of blunt lobes and of a sky and lamps over gloss."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.quadrature.split_setup import MET
from symrender.scene.parameters import get

from .test_bounce_of_lights import AIMS, LAMP, METAL, SKY, SPOT, ball, plane, scene
from .test_bounced_gradient import difference_of

KEY = {"type": "point", "name": "key", "position": [-1.5, -2, 2.5], "intensity": [30, 25, 20]}
MATERIALS: dict[str, Any] = {
    "metal": METAL,
    "walter": {"type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.4, "eta": 1.5, "k": 3},
    "blunt": {"type": "phong", "exponent": 4.3, "reflectance": [0.5, 0.4, 0.3]},
    "half": {"type": "phong", "exponent": 0.6, "reflectance": [0.5, 0.4, 0.3]},
}
GROUND, BALL, _, WALL, OTHER = AIMS.tolist()


def crowd(lights: list[dict[str, Any]], aim: list[float], gloss: str = "dull", **changes: Any) -> dict[str, Any]:
    """Three balls, one of which touches the floor, before a wall that leans."""
    shapes = [plane("floor", [0, 0, 0], [0, 0, 1], changes.pop("floor", "dull")),
              plane("wall", [0, 2, 0], [0, -1, 0.1]), ball("A", [-0.5, 0.2, 0.6], 0.5, gloss),
              ball("B", [0.7, -0.2, 0.4], 0.4, gloss), ball("C", [0.2, 0.5, 1.4], 0.25)]  # fmt: skip
    made = scene(shapes, lights, **MATERIALS)
    made["camera"] = made["camera"] | {"eye": [0.2, -4, 2], "target": aim}
    return made | changes


CASES = {
    "spot": (crowd([SPOT], GROUND), ["lights.spot.beam", "lights.spot.direction.x", "shapes.B.radius"]),
    "cone": (crowd([SPOT | {"beam": 0, "falloff": "smooth"}], BALL), ["lights.spot.cutoff", "shapes.A.radius"]),
    "sky": (crowd([SKY], BALL), ["lights.sky.radiance.g", "shapes.A.center.x", "shapes.C.center.z"]),
    # a ball that touches the floor, which turns, or grows
    "touch": (crowd([SKY], GROUND), ["shapes.floor.normal.x", "lights.sky.radiance.r"]),
    "lamp": (crowd([LAMP], BALL), ["lights.lamp.radiance.r", "shapes.C.radius", "shapes.A.radius"]),
    "all": (crowd([LAMP, SKY, SPOT], OTHER), ["shapes.C.radius", "shapes.B.center.x", "lights.spot.position.z"]),
    "gloss": (crowd([SKY], BALL, "metal") | {"gloss": "first_hit"}, ["materials.metal.alpha", "camera.target.x"]),
    "walter": (crowd([KEY], BALL, "walter"), ["materials.walter.alpha", "shapes.A.radius", "lights.key.position.x"]),
    "blunt": (crowd([KEY], GROUND, "blunt"), ["materials.blunt.exponent", "shapes.B.radius", "lights.key.position.x"]),
    "half": (crowd([KEY], GROUND, "half"), ["materials.half.exponent", "shapes.B.radius"]),
    "sky over metal": (
        crowd([SKY], BALL, "metal", bounces=0),
        ["materials.metal.alpha", "shapes.A.radius", "lights.sky.radiance.r", "camera.target.x"],
    ),
    "lamp over metal": (
        crowd([LAMP], [0.1, 0.4, 0], floor="metal", bounces=0),
        ["materials.metal.alpha", "shapes.C.radius", "lights.lamp.radiance.b", "camera.target.x"],
    ),
    "lamp over walter": (
        crowd([LAMP], [0.1, 0.4, 0], floor="walter", bounces=0),
        ["materials.walter.alpha", "shapes.C.radius"],
    ),
    "lamp over half": (
        crowd([LAMP], [0.1, 0.4, 0], floor="half", bounces=0),
        ["materials.half.exponent", "shapes.C.radius"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_extrapolated_differences(name: str) -> None:
    made, names = CASES[name]
    layer = "indirect" if made["bounces"] else "direct"
    slopes = sr.gradient(made, names, size=1, tol=1e-6, threads=1, tile=1)
    acting, loaded = 0, sr.load(made)
    step, tol = (1e-3, 1e-9) if name == "touch" else (2.5e-4, 1e-11)
    for each in names:
        image = slopes[each]
        found, stated = image.layer(layer)[0, 0], float(image.layer("error")[0, 0])
        wanted, doubt = difference_of(made, each, step * max(abs(float(get(loaded, each))), 0.2), layer, tol)
        size, off = float(np.abs(wanted).max()), float(np.abs(found - wanted).max())
        assert doubt <= 1e-7 * size + 5e-9, (each, doubt, size)
        assert off <= stated + doubt + 2e-9, (each, off, stated, size)
        # what touches loses digits
        assert stated <= 2e-6 if name == "touch" else image.layer("status")[0, 0] == MET
        acting += size > 1e-5
    assert acting >= 2


def test_a_sky_between_planes_along_axes_tells_of_the_one_that_turns() -> None:
    # circles begin where they cross: the stretch that a turn adds has no length yet
    shapes = [plane("floor", [0, 0, 0], [0, 0, 1]), plane("wall", [0, 2, 0], [0, -1, 0.3])]
    made = scene(shapes, [SKY])
    made["camera"] = made["camera"] | {"target": GROUND}
    names = ["shapes.wall.normal.z", "shapes.floor.normal.x", "shapes.wall.normal.x"]
    slopes = sr.gradient(made, names, size=1, tol=1e-8, threads=1, tile=1)
    wanted, doubt = difference_of(made, names[0], 1e-3, "indirect", 1e-11)
    assert abs(wanted).max() > 1e-3 and doubt < 1e-8
    np.testing.assert_allclose(slopes[names[0]].layer("indirect")[0, 0], wanted, atol=1e-8)
    # the scene is its own mirror image
    for name in names[1:]:
        assert np.abs(slopes[name].layer("indirect")).max() < 1e-8


def test_light_is_linear_in_what_skies_and_lamps_send() -> None:
    glossy = crowd([SKY, LAMP], GROUND, floor="metal", bounces=0)
    for made, layer in ((crowd([SKY, LAMP], BALL), "indirect"), (glossy, "direct")):
        loaded = sr.load(made)
        names = [f"lights.{light}.radiance.{c}" for light in ("sky", "lamp") for c in "rgb"]
        slopes = sr.gradient(made, names, size=1, tol=1e-6, threads=1, tile=1)
        seen = sr.truth(made, size=1, tol=1e-6, threads=1, tile=1)
        total = sum(float(get(loaded, n)) * slopes[n].layer(layer)[0, 0] for n in names)
        stated = sum(float(get(loaded, n)) * float(slopes[n].layer("error")[0, 0]) for n in names)
        assert seen.layer(layer).max() > 1e-3 and stated < 1e-4
        assert np.abs(total - seen.layer(layer)[0, 0]).max() <= stated + float(seen.layer("error")[0, 0]) + 1e-12


def test_what_is_asked_loosely_is_as_near_as_stated() -> None:
    names = ["shapes.A.radius", "shapes.C.center.x", "lights.spot.cutoff"]
    made = crowd([SKY, LAMP, SPOT], OTHER)
    sharp, rough = (sr.gradient(made, names, size=1, tol=tol, threads=1, tile=1) for tol in (1e-7, 1e-2))
    off = [float(np.abs(rough[n].radiance - sharp[n].radiance).max()) for n in names]
    stated = [float(rough[n].layer("error")[0, 0]) for n in names]
    assert max(off) > 1e-9 and all(a <= b <= 1e-2 for a, b in zip(off, stated, strict=True))


def test_equal_balls_have_cylinders_and_none_touches_itself() -> None:
    shapes = [ball("A", [-0.5, 0.2, 0.6], 0.4), ball("B", [0.7, -0.2, 0.6], 0.4), plane("floor", [0, 0, 0], [0, 0, 1])]
    made = scene(shapes, [SKY])
    made["camera"] = made["camera"] | {"target": GROUND}
    names = ["shapes.A.radius", "shapes.B.center.x"]
    slopes = sr.gradient(made, names, size=1, tol=1e-6, threads=1, tile=1)
    for name in names:
        wanted, doubt = difference_of(made, name, 2.5e-4, "indirect", 1e-11)
        stated = float(slopes[name].layer("error")[0, 0])
        assert abs(wanted).max() > 1e-3 and stated <= 1e-6
        assert np.abs(slopes[name].layer("indirect")[0, 0] - wanted).max() <= stated + doubt


def test_what_is_not_had_is_refused_by_name() -> None:
    box = {"type": "box", "name": "box", "center": [0, 1, 0.5], "size": [1, 1, 1], "material": "metal"}
    made = crowd([LAMP], BALL, bounces=0)
    with pytest.raises(Unsupported, match="flat shapes there are derivatives by what lights send"):
        sr.gradient(made | {"shapes": [*made["shapes"][2:], box]}, ["shapes.A.radius"], size=1)
