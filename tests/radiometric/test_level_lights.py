"""Lights that lie exactly in a plane: the plane is seen edge-on from there, and hides nothing of them.

The light is lifted off the planes that it lies in, to the side on which the ray meets a shape: what is seen there must
not change. Scenes are turned at random, so that whether a light lies in a plane is told by rounded numbers alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.radiometric.flats import Scene, ball, plane, rectangle

import symrender as sr

LIFT = 1e-9
KINDS = ("directional", "point", "spot")


def turn(rng: np.random.Generator) -> np.ndarray[Any, Any]:
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def light(kind: str, place: Any, way: Any) -> Scene:
    if kind == "directional":
        return {"type": kind, "name": "L", "direction": list(map(float, way)), "irradiance": [2.0, 3.0, 4.0]}
    found = {"type": kind, "name": "L", "position": list(map(float, place)), "intensity": [5.0, 4.0, 3.0]}
    return found | ({"direction": list(map(float, way)), "beam": 35.0, "cutoff": 55.0} if kind == "spot" else {})


def scene(seed: int, kind: str, bounces: int, lift: float) -> tuple[Scene, Any, Any]:
    """Two balls over a floor before a wall, a light in the floor's plane or, by seed, in both planes; and rays.

    Lifted, it shines on what is above the floor and before the wall. Then neither reflects: how much a point lights of
    a plane that it lies in jumps as it leaves it.
    """
    rng = np.random.default_rng(seed)
    m, shift = (np.eye(3), np.zeros(3)) if seed == 0 else (turn(rng), rng.normal(size=3) * rng.choice([0.0, 3.0]))
    up, out, side = m[2], m[1], m[0]
    both = seed % 3 == 2
    # over the floor at ``a`` along it and ``b`` before the wall
    at = lambda a, b, z: shift + a * side + b * out + z * up  # noqa: E731
    place = at(1.75, 0.0 if both else 1.25, 0.0) + lift * (up + both * out)
    way = -(side if both else side + 0.5 * out) - lift * (up + both * out) * (kind == "directional")
    black = lift > 0.0 and kind != "directional"
    shapes = [
        ball("A", at(0.0, 1.0, 0.6), 0.5), ball("B", at(-1.0, 1.75, 0.5), 0.375, "both"),
        plane("floor", shift, up, "dark" if black else "white"),
        plane("wall", shift, out, "dark" if black and both else "white"),
    ]  # fmt: skip
    world = {
        "units": "radiometric", "name": "level", "bounces": bounces, "shapes": shapes,
        "lights": [light(kind, place, way)],
        "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
        "materials": {
            "white": {"type": "diffuse", "reflectance": [0.8, 0.6, 0.4]},
            "both": {"type": "diffuse", "reflectance": 0.7, "two_sided": True},
            "dark": {"type": "diffuse", "reflectance": 0.0},
        },
    }  # fmt: skip
    # what the light is on, then what sees that
    eyes = np.repeat([at(0.75, 3.0, 1.5), at(-1.2, 0.5, 1.6)], 3, axis=0)
    targets = [at(0.2, 1.1, 0.9), at(0.1, 1.3, 0.4), at(-0.8, 1.8, 0.6), at(-0.35, 0.7, 0.8), at(-0.3, 0.65, 0.5)]
    toward = np.array([*targets, at(-0.8, 1.5, 0.6)]) - eyes
    return world, eyes, toward / np.linalg.norm(toward, axis=1, keepdims=True)


@pytest.mark.parametrize("bounces", [0, 1])
@pytest.mark.parametrize("kind", KINDS)
def test_a_light_in_a_plane_shines_as_one_lifted_off_it(kind: str, bounces: int) -> None:
    seen, signal = 0, 0
    for seed in range(9):
        made, origins, directions = scene(seed, kind, bounces, 0.0)
        found = sr.probe(made, rays=(origins, directions), tol=1e-5)
        true = sr.probe(scene(seed, kind, bounces, LIFT)[0], rays=(origins, directions), tol=1e-5)
        assert (found.status == 0).all() and (true.status == 0).all(), seed
        off = np.abs(found.radiance - true.radiance).max(axis=1)
        assert (off <= found.error + true.error + 100 * LIFT).all(), (seed, off)
        seen += len(off)
        lit = (found.indirect if bounces else found.direct).max(axis=1)
        signal += int((lit > 1e-3).sum())
    assert seen == 54 and signal >= 12


def test_a_light_in_the_plane_of_a_face_is_not_hidden_by_it() -> None:
    """A lamp at a point in the middle of a ceiling: below it all is lit, whatever is rounded."""
    rng = np.random.default_rng(1)
    seen = 0
    for _ in range(12):
        m, shift = turn(rng), rng.normal(size=3)
        side, out, up = m
        corner = shift + 2.0 * up - side - out
        shapes = [plane("floor", shift, up), rectangle("ceiling", corner, 2.0 * out, 2.0 * side)]
        world = {
            "units": "radiometric", "name": "lamp", "bounces": 0, "shapes": shapes,
            "lights": [light("point", corner + side + out, -up)],
            "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
            "materials": {"white": {"type": "diffuse", "reflectance": 1.0}},
        }  # fmt: skip
        eye = shift + 0.5 * up + 0.3 * side
        found = sr.probe(world, rays=(eye[None], -up[None]), tol=1e-9)
        square = 4.0 + 0.3**2
        true = np.array([5.0, 4.0, 3.0]) * 2.0 / square**1.5 / np.pi
        assert found.status[0] == 0 and np.abs(found.radiance[0] - true).max() <= found.error[0] < 1e-9
        seen += 1
    assert seen == 12


@pytest.mark.parametrize("by", [[0.5, 0.0, 0.0], [0.0, 0.0, 0.5]], ids=["within the plane", "out of it"])
def test_a_shutter_keeps_a_light_in_a_plane_only_where_it_stays_there(by: list[float]) -> None:
    """A sun level with a plane that moves lights a ball all the while; a point that leaves the plane does so, too."""
    shapes = [ball("A", [0, 0, 0.7], 0.5), plane("floor", [0, 0, 0], [0, 0, 1]) | {"velocity": by}]
    sun = light("directional", None, [-1, 0.25, 0])
    world = {
        "units": "radiometric", "name": "shutter", "bounces": 0, "shapes": shapes, "lights": [sun], "shutter": [0, 0.1],
        "camera": {"type": "look_at", "eye": [3, 0, 1], "target": [0, 0, 0.7], "up": [0, 0, 1], "fov": 4},
        "materials": {"white": {"type": "diffuse", "reflectance": 1.0}},
    }  # fmt: skip
    image = sr.truth(world, size=1, tol=1e-4, filter="box", threads=1)
    still = {k: v for k, v in world.items() if k not in ("shutter",)} | {"shapes": [shapes[0]]}
    alone = sr.truth(still, size=1, tol=1e-4, filter="box", threads=1)
    assert image.layer("status")[0, 0] == 0 and alone.radiance[0, 0].min() > 0.5
    assert np.abs(image.radiance - alone.radiance).max() <= image.layer("error")[0, 0] + alone.layer("error")[0, 0]
