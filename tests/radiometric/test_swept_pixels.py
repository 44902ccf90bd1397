"""Derivatives of means over pixels of bounced light, against differences of the means."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.scene.load import load_any
from symrender.scene.parameters import get
from symrender.scene.radiometric.scene import RadiometricScene

from .test_bounced_pixels import SOLID, TILES, world

DIFFUSE = {
    "red": {"type": "diffuse", "reflectance": [0.8, 0.2, 0]},
    "metal": {"type": "diffuse", "reflectance": [0.2, 0.7, 0.5]},
}
LIMB = {"type": "look_at", "eye": [0.3, -5.6, 2.5], "target": [0.15, -0.4, 0.6], "up": [0, 0, 1], "fov": 2.5}
"""Where ball B ends before the floor; half of its one pixel sees either."""
CONTACT = LIMB | {"target": [-0.78, 0.0, 0.02], "fov": 1.5}
"""Where the floor ends under ball A."""
TOL = 1e-3


def pixel(floor: Any = SOLID, camera: Any = LIMB) -> RadiometricScene:
    """One pixel of two diffuse balls over a floor."""
    return world(floor, camera=camera, materials=DIFFUSE | {"floor": {"type": "diffuse", "reflectance": floor}})


def differences(scene: RadiometricScene, name: str, kind: str, step: float) -> tuple[Any, float]:
    """(derivative of the indirect light of the one pixel, what it may be off by), extrapolated."""
    value, found, stated = float(get(scene, name)), [], []
    for each in (step, 2 * step):
        high, low = (
            sr.truth(
                scene.replace({name: value + side * each}), size=1, tol=1e-5, filter=kind, budget=3 * 10**7, threads=1,
                tile=1,
            )
            for side in (1, -1)
        )  # fmt: skip
        found.append((high.layer("indirect") - low.layer("indirect"))[0, 0] / (2 * each))
        stated.append(float((high.layer("error") + low.layer("error"))[0, 0]) / (2 * each))
    near, far = found
    # what extrapolation leaves is less than a tenth of what it takes away
    return (4 * near - far) / 3, (4 * stated[0] + stated[1]) / 3 + 0.1 * float(np.abs(near - far).max())


@pytest.mark.parametrize(
    ("scene", "name", "kind"),
    [
        (pixel(), "shapes.B.radius", "box"),
        (pixel(), "shapes.B.center.x", "tent"),
        (pixel(SOLID, CONTACT), "shapes.A.center.z", "box"),
    ],
    ids=["limb", "tent", "contact"],
)
def test_derivatives_are_those_of_the_means(scene: RadiometricScene, name: str, kind: str) -> None:
    image = sr.gradient(scene, [name], size=1, tol=TOL, filter=kind, threads=1, tile=1)[name]
    found, error = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
    expected, doubt = differences(scene, name, kind, 5e-3)
    assert not image.layer("status").any() and error <= TOL
    assert np.abs(expected).max() > 0.05 and doubt < 0.02 * np.abs(expected).max()
    assert np.abs(found - expected).max() <= 1.5 * error + doubt


def test_what_lights_send_scales_the_mean() -> None:
    scene = pixel(TILES)
    name = "lights.sun.irradiance.g"
    value = sr.truth(scene, size=1, tol=1e-4, filter="box", threads=1, tile=1)
    slope = sr.gradient(scene, [name], size=1, tol=TOL, filter="box", threads=1, tile=1)[name]
    one = value.layer("indirect")[0, 0, 1] / float(get(scene, name))
    assert one > 5 * TOL
    assert abs(slope.layer("indirect")[0, 0, 1] - one) <= 1.5 * float(slope.layer("error")[0, 0]) + 1e-4


def test_bytes_do_not_depend_on_tiles() -> None:
    scene = pixel(SOLID, LIMB | {"fov": 3})
    whole, parts = (
        sr.gradient(scene, ["shapes.B.radius"], size=2, tol=1e-2, filter="box", threads=1, tile=tile)["shapes.B.radius"]
        for tile in (2, 1)
    )
    assert np.abs(whole.layer("indirect")).max() > 0.05
    for layer, values in whole.layers.items():
        np.testing.assert_array_equal(values, parts.layer(layer))


def beside_a_limb(fov: float, away: float, bounces: int) -> RadiometricScene:
    """One pixel on a ball that ends ``away`` pixels to the right of it, before a bright wall: slopes there are as one
    over the root of the distance, outside of the pixel."""
    wide = 2.0 * np.tan(np.radians(fov) / 2.0)
    middle = np.tan(np.arcsin(1.0 / 6.0)) - wide * (away + 0.5)
    made = load_any({
        "units": "radiometric", "bounces": bounces,
        "camera": {"type": "look_at", "eye": [0, -6, 1.2], "target": [float(6 * middle), 0, 1.2], "up": [0, 0, 1],
                   "fov": fov},
        "materials": {"white": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.2]}},
        "shapes": [
            {"type": "plane", "name": "wall", "point": [0, 1.5, 0], "normal": [0, -1, 0], "material": "white"},
            {"type": "sphere", "name": "ball", "center": [0, 0, 1.2], "radius": 1, "material": "white"},
        ],
        "lights": [{"type": "directional", "name": "sun", "direction": [-0.6, 1, -0.3], "irradiance": 3.0}],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


@pytest.mark.parametrize(
    ("layer", "fov", "away", "tol", "finest"),
    [("indirect", 0.5, 0.021, 0.2, 1e-3), ("indirect", 1.0, 0.027, 0.2, 1e-3), ("direct", 3.0, 0.01, 0.2, 1e-6)],
)
def test_slopes_beside_a_limb_are_stated(layer: str, fov: float, away: float, tol: float, finest: float) -> None:
    scene, name = beside_a_limb(fov, away, int(layer == "indirect")), "shapes.ball.center.x"
    loose, tight = (
        sr.gradient(scene, [name], size=1, tol=each, filter="box", threads=1, tile=1)[name] for each in (tol, finest)
    )
    error, rest = loose.layer("error")[0, 0], tight.layer("error")[0, 0]
    assert np.abs(tight.layer(layer)).max() > 0.3 and rest < 0.1 * error <= tol
    assert np.abs(loose.layer(layer) - tight.layer(layer)).max() <= 1.5 * error + rest


def striped(at: float, cell: float) -> RadiometricScene:
    """One pixel that sees some twenty stripes of a floor from above, lit by a ball beside it."""
    made = load_any({
        "units": "radiometric", "bounces": 1,
        "camera": {"type": "look_at", "eye": [at, 0, 20], "target": [at, 0, 0], "up": [0, 1, 0], "fov": 4},
        "materials": {
            "floor": {"type": "diffuse",
                      "reflectance": {"type": "stripes", "cell": cell, "bright": 0.9, "dark": 0.1}},
            "white": {"type": "diffuse", "reflectance": 0.8},
        },
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
            {"type": "sphere", "name": "ball", "center": [4, 0, 2], "radius": 2.5, "material": "white"},
        ],
        "lights": [{"type": "directional", "name": "sun", "direction": [1, 0.2, -1], "irradiance": 3.0}],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def test_stripes_that_nodes_do_not_tell_are_counted() -> None:
    # the nodes of the first rules all fall on dark stripes, and agree
    scene, name = striped(0.1159, 0.07161), "shapes.ball.center.x"
    image = sr.gradient(scene, [name], size=1, tol=1e-2, filter="box", threads=1, tile=1)[name]
    found, error = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
    expected, doubt = differences(scene, name, "box", 5e-3)
    assert np.abs(expected).max() > 5e-3 and doubt < 0.05 * np.abs(expected).max()
    assert image.layer("status")[0, 0] == 0 and error <= 1e-2
    assert np.abs(found - expected).max() <= 1.5 * error + doubt
