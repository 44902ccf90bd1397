"""A small lamp wholly over a plane lights it like a point of intensity pi radius^2 radiance at its centre.

That is exact: the irradiance of a sphere over a receiver's horizon is pi L r^2 z / d^3. So what bounces off the plane
is the point's, whose rules are judged by rules within rules, but for what the lamp hides of the plane behind it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.scene.load import load_any

Scene = dict[str, Any]
SIZE = 0.01
"""Radius of a lamp, over its height."""
HIDDEN = 4e-3
"""Share of the light that lamps of that size may hide."""
ASKED = (1e-2, 1e-3, 1e-4, 1e-5)
"""Of the light."""
PLACES = [(z, away) for z in (0.02, 0.1, 0.5) for away in (3.0, 17.0)]


def scene(z: float, away: float, texture: Any, gloss: Scene, lamp: bool) -> Scene:
    """A ball over a plane, and a lamp, or a point, ``away`` from it."""
    shapes = [
        {"type": "plane", "name": "P", "point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "material": "floor"},
        {"type": "sphere", "name": "S", "center": [0.0, 0.0, 0.6], "radius": 0.5, "material": "ball"},
    ]
    at = [0.1 * away, -away, z]
    light: Scene = {"type": "point", "name": "L", "position": at, "intensity": [np.pi * (SIZE * z) ** 2 * 1e6] * 3}
    if lamp:
        shapes.append({"type": "sphere", "name": "lamp", "center": at, "radius": SIZE * z, "material": "black"})
        light = {"type": "area", "name": "L", "shape": "lamp", "radiance": [1e6] * 3}
    return {
        "units": "radiometric", "name": "far lamp", "bounces": 1, "gloss": "first_hit",
        "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
        "materials": {
            "floor": {"type": "diffuse", "reflectance": texture},
            "ball": gloss | {"reflectance": [0.9] * 3},
            "black": {"type": "diffuse", "reflectance": [0.0] * 3},
        },
        "shapes": shapes, "lights": [light],
    }  # fmt: skip


@pytest.mark.parametrize("gloss", [
    {"type": "diffuse"},
    {"type": "conductor", "distribution": "beckmann", "alpha": 0.3, "eta": [1.0] * 3, "k": [3.0] * 3},
], ids=["diffuse", "conductor"])  # fmt: skip
@pytest.mark.parametrize("texture", [
    [0.5] * 3,
    {"type": "checker", "bright": [0.9] * 3, "dark": [0.1] * 3, "cell": 0.7},
], ids=["solid", "checker"])  # fmt: skip
def test_a_small_lamp_shines_like_a_point(texture: Any, gloss: Scene) -> None:
    # meets the ball at (0, -.4, .3), the mirror direction falls to the floor on the lamp's side
    toward = np.array([0.05, 0.6, 0.5])
    ray = (np.array([0.0, -0.4, 0.3]) - 0.2 * toward, toward)
    beyond, told = [], 0
    for z, away in PLACES:
        known = sr.probe(load_any(scene(z, away, texture, gloss, lamp=False)), rays=ray, tol=1e-12, budget=3_000_000)
        lamp = load_any(scene(z, away, texture, gloss, lamp=True))
        light = float(known.indirect.max())
        assert light > 1e-9
        for share in ASKED:
            seen = sr.probe(lamp, rays=ray, tol=max(1e-12, share * light), budget=3_000_000)
            stated = float(seen.error[0] + known.error[0])
            off = float(np.abs(seen.indirect - known.indirect).max())
            told += stated < 0.5 * light
            if off > stated + HIDDEN * light:
                beyond.append((z, away, share, off / light, stated / light))
    assert told >= 3 * len(PLACES)
    assert not beyond


def test_the_light_of_a_lamp_is_right_however_small_it_is_seen() -> None:
    """Its irradiance is pi L r^2 cos / d^2: a sine of the double nearest to 2 pi must not show beside r^2/d^2."""
    rng = np.random.default_rng(3)
    off, seen = [], 0
    for _ in range(60):
        normal, away = rng.normal(size=3), rng.normal(size=3)
        up = normal / np.linalg.norm(normal)
        level = away - (away @ up) * up
        distance, radius, cosine = 10 ** rng.uniform(0, 4), 10 ** rng.uniform(-5, -2), 10 ** rng.uniform(-1.5, 0)
        way = cosine * up + np.sqrt(1 - cosine**2) * level / np.linalg.norm(level)
        along = np.eye(3)[np.argmin(np.abs(up))]
        world = {
            "units": "radiometric", "name": "small", "bounces": 0,
            "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
            "materials": {
                "floor": {"type": "diffuse", "reflectance": 1.0}, "black": {"type": "diffuse", "reflectance": 0.0}
            },
            "shapes": [
                {"type": "plane", "name": "P", "point": [0.0, 0.0, 0.0], "normal": up.tolist(), "along": along.tolist(),
                 "material": "floor"},
                {"type": "sphere", "name": "lamp", "center": (distance * way).tolist(), "radius": radius,
                 "material": "black"},
            ],
            "lights": [{"type": "area", "name": "L", "shape": "lamp", "radiance": 1.0}],
        }  # fmt: skip
        found = sr.probe(world, rays=(up[None], -up[None]), tol=1.0)
        true = (radius / distance) ** 2 * cosine
        assert 0.0 < found.error[0] < 1e-9 * true
        # what the numbers of the scene themselves are rounded by, over a cosine
        off.append(abs(found.radiance[0, 0] - true) / (found.error[0] + 4e-16 * true / cosine))
        seen += 1
    assert seen == 60 and max(off) < 1.0
