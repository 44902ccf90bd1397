"""Scales of a scene's numbers: they do not depend on where the origin is, and follow the unit."""

from __future__ import annotations

import pytest

from symrender.scene.load import AnyScene, load_any
from symrender.scene.scales import scale_of


def made(size: float, shift: float) -> AnyScene:
    return load_any({
        "name": "scales", "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [shift, -6 * size, 2 * size], "target": [shift, 0, 0], "fov": 30},
        "materials": {"m": {"type": "diffuse", "reflectance": [0.5, 0.0, 0.25]}},
        "shapes": [
            {"type": "sphere", "name": "A", "center": [shift, 0, size], "radius": size, "material": "m"},
            {"type": "rectangle", "name": "R", "corner": [shift, 0, -size], "edge_u": [3 * size, 0, 0],
             "edge_v": [0, size, 0], "material": "m"},
        ],
        "lights": [{"type": "point", "name": "k", "position": [shift + size, 0, 3 * size], "intensity": 1}],
    })  # fmt: skip


@pytest.mark.parametrize(("size", "shift"), [(1e-6, 0.0), (1.0, 0.0), (1.0, 1e5), (1e6, 0.0)])
def test_scales_follow_the_scene(size: float, shift: float) -> None:
    scene = made(size, shift)
    for name, low, high in (
        ("lights.k.position.x", 2, 6), ("camera.eye.x", 6, 7), ("shapes.A.center.z", 1, 6), ("shapes.A.radius", 1, 1),
        ("shapes.R.edge_u.y", 3, 3),
    ):  # fmt: skip
        assert (1 - 1e-9) * low * size <= scale_of(scene, name) <= (1 + 1e-9) * high * size, name
    assert [scale_of(scene, f"materials.m.reflectance.color.{c}") for c in "rgb"] == [0.5, 1.0, 0.25]
    assert scale_of(scene, "camera.up.x") == 1.0 and scale_of(scene, "camera.fov") == 30.0
