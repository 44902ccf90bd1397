"""Second derivatives against differences of values, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError, Unsupported

SCENE = sr.load("chapter8").replace({"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}})
POINT = (0.9, -0.85)
NAMES = ["spheres.A.radius", "floor.lobe.exponent"]


def value(radius: float, exponent: float) -> np.ndarray:
    changed = SCENE.replace({"spheres.A.radius": radius, "floor.lobe.exponent": exponent})
    return sr.probe(changed, [POINT], tol=1e-12).gloss[0]


def test_second_differences() -> None:
    found = sr.hessian(SCENE, NAMES, [POINT])
    assert found.names == tuple(NAMES)
    assert found.values.shape == (2, 2, 1, 3)
    assert np.array_equal(found.values, found.values.swapaxes(0, 1))

    def second(h: float) -> list[np.ndarray]:
        k = 16 * h
        middle = value(1.0, 16.0)
        return [
            (value(1 + h, 16.0) - 2 * middle + value(1 - h, 16.0)) / h**2,
            (value(1 + h, 16 + k) - value(1 + h, 16 - k) - value(1 - h, 16 + k) + value(1 - h, 16 - k)) / (4 * h * k),
            (value(1.0, 16 + k) - 2 * middle + value(1.0, 16 - k)) / k**2,
        ]

    for (i, j), coarse, fine in zip(((0, 0), (0, 1), (1, 1)), second(4e-3), second(2e-3), strict=True):
        expected = (4 * fine - coarse) / 3
        change = np.abs(expected - fine).max()
        gap = np.abs(found.values[i, j, 0] - expected).max()
        assert gap <= 1e-5 * np.abs(expected).max() + 0.05 * change + 1e-8
        assert found.error[i, j, 0] <= 1e-5 * np.abs(expected).max() + 1e-9
    assert np.abs(found.values[0, 0]).max() > 1e-3


def test_an_exact_disk() -> None:
    scene, name, point = sr.load("penumbra").replace({"floor.lobe.exponent": 12.0}), "lights.key.radius", (0.9, -0.85)
    found = sr.hessian(scene, [name], [point], tol=1e-5, disk="exact")

    def value(radius: float) -> np.ndarray:
        return sr.probe(scene.replace({name: radius}), [point], tol=1e-9, disk="exact").gloss[0]

    middle = value(1.1)
    coarse, fine = ((value(1.1 + h) - 2 * middle + value(1.1 - h)) / h**2 for h in (0.2, 0.1))
    expected = (4 * fine - coarse) / 3
    assert expected.min() > 5e-4
    assert np.abs(found.values[0, 0, 0] - expected).max() <= found.error[0, 0, 0] + 1e-3 * expected.max()


def test_the_area_of_a_ball_in_a_pixel() -> None:
    """Seen on the axis, r^2/(d^2 - r^2) times pi/4 of a pixel as wide as it is far, both ways."""
    distance, radius, half = 6.0, 0.7, np.tan(np.radians(10.0))
    scene = sr.load({
        "name": "disc", "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0, -distance, 0], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 20},
        "materials": {"clay": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [{"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": radius, "material": "clay"}],
        "lights": [{"type": "area", "name": "glow", "shape": "ball", "radiance": [3, 2, 1]}],
    })  # fmt: skip
    found = sr.hessian(scene, ["shapes.ball.radius"], size=1, tol=1e-6, filter="box")
    rest = distance**2 - radius**2
    curved = 2.0 * distance**2 * (distance**2 + 3.0 * radius**2) / rest**3
    expected = np.pi / (4.0 * half**2) * curved * np.array([3.0, 2.0, 1.0])
    off = np.abs(found.values[0, 0, 0, 0] - expected).max()
    assert expected.min() > 1.0
    assert off <= found.error[0, 0, 0, 0] <= 1e-3 * expected.max()
    # a looser tolerance loosens what is stated, not what is found
    assert off <= 1e-6 * expected.max()


def test_refusals() -> None:
    with pytest.raises(OptionError, match="filter: single points"):
        sr.hessian(SCENE, NAMES, [POINT], filter="box")
    with pytest.raises(OptionError, match="points, rays, size"):
        sr.hessian(SCENE, NAMES)
    with pytest.raises(Unsupported, match=r"background\.r"):
        sr.hessian(SCENE.replace({"background": (0.0, 0.0, 0.0)}), ["background.r"], [POINT])
