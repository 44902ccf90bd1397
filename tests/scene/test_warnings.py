"""Oddities are said, ordinary scenes are not accused."""

from __future__ import annotations

import pytest

from symrender.scene import gallery
from symrender.scene.load import load
from symrender.scene.warnings import warnings


@pytest.mark.parametrize("name", [name for name in gallery.names() if name != "furnace"])
def test_gallery_scenes_are_not_odd(name: str) -> None:
    assert warnings(load(name)) == ()


ODD: list[tuple[dict[str, object], tuple[str, ...]]] = [
    ({"camera.eye": (-0.72, 0.15, 1.0)}, ("camera.eye is inside spheres.A: its far side is seen, from within",)),
    ({"camera.eye.z": -1}, ("camera.eye is below the floor, which is black from below",)),
    ({"camera.eye.z": 0}, ("camera.eye lies on the floor plane: the floor cannot be seen",)),
    ({"lights": []}, ("there are no lights: only ambient and background are seen",)),
    (
        {"lights.key.color": (0, 0, 0), "lights.fill.color": (0, 0, 0)},
        ("all lights are black: only ambient and background are seen",),
    ),
    ({"lights.fill.position": (-0.72, 0.15, 1.0)}, ("lights.fill is inside spheres.A: nothing outside is lit by it",)),
    ({"lights.key.position.z": -2}, ("lights.key is below the floor: the floor is not lit by it",)),
    (
        {"spheres.B.center": (-0.72, 0.15, 0.9), "spheres.B.radius": 0.9},
        ("spheres.A and spheres.B are the same sphere: the first is seen",),
    ),
    ({"spheres.B.center.z": -0.56}, ("spheres.B lies below the floor: it cannot be seen from above",)),
    ({"spheres.B.lobe.weight": 0}, ("spheres.B.lobe.weight is 0: the lobe has no effect",)),
    ({"floor.lobe.weight": 0}, ("floor.lobe.weight is 0: the lobe has no effect",)),
    ({"spheres": [], "floor": None}, ("there is nothing to see: no spheres, no floor and no planes",)),
]


@pytest.mark.parametrize(("changes", "said"), ODD)
def test_odd_scenes(changes: dict[str, object], said: tuple[str, ...]) -> None:
    assert warnings(load("gloss").replace(changes)) == said


@pytest.mark.parametrize(
    "changes",
    [
        {"floor": None, "camera.eye.z": -1},
        {"floor": None, "lights.key.position.z": -2, "spheres.B.center.z": -3},
        {"camera.eye": (-0.72, 0.15, 1.8000001)},
        {"spheres.B.center.z": -0.55},
        {"spheres.B.center": (-0.72, 0.15, 0.9)},
    ],
)
def test_nearly_odd_scenes(changes: dict[str, object]) -> None:
    assert warnings(load("gloss").replace(changes)) == ()
