"""The integrand of scenes with planes: its values against the ray tracer's, its walls, its derivative."""

from __future__ import annotations

import numpy as np
import pytest

from runtimes.test_planes import room, scene_of
from symrender.errors import OptionError, SceneError
from symrender.expression.integrand import expression
from symrender.numeric import pipeline as numeric
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, scene_arrays
from symrender.scene.frames import frames
from symrender.scene.load import load


def _seen(arrays: SceneArrays, rng: np.random.Generator, count: int) -> tuple[Array, Array, Array]:
    """Points of the first plane by its coordinates, outside every sphere, their places, and directions above it."""
    frame = frames(arrays.planes)[0]
    given, places = np.zeros((0, 2)), np.zeros((0, 3))
    while len(given) < count:
        x, y = rng.uniform(-1.5, 1.5, 2)
        place = frame.origin + x * frame.east + y * frame.north
        if (np.linalg.norm(arrays.spheres["center"] - place, axis=1) > arrays.spheres["radius"]).all():
            given, places = np.vstack([given, [x, y]]), np.vstack([places, place])
    directions = rng.normal(size=(count, 3))
    directions *= np.sign(directions @ frame.up)[:, None]
    return given, places, directions / np.linalg.norm(directions, axis=1)[:, None]


def test_the_integrand_of_a_plane_is_what_the_ray_tracer_sees() -> None:
    """Evaluated to 30 digits, so that what differs is the ray tracer's rounding; other planes are met too."""
    shaded, met = 0, set()
    for seed in (0, 2, 3, 6):
        scene = scene_of(room(seed))
        arrays, rng = scene_arrays(scene), np.random.default_rng(seed)
        held = expression(scene, surface="planes.w0")
        given, places, directions = _seen(arrays, rng, 10)
        own = at.FIRST_SPHERE + len(scene.spheres)
        radiance, hit, _ = numeric.trace(arrays, places, directions, own)
        for k in range(10):
            value = [float(x) for x in held.evaluate(given[k].tolist(), directions[k].tolist())]
            assert np.abs(value - radiance[k]).max() <= 1e-13
        met |= set(np.sign(hit - own).tolist()) if len(scene.planes) > 1 else set()
        shaded += int((radiance.max(axis=1) > 0.05).sum())
    assert shaded >= 15 and met >= {-1.0, 1.0}


@pytest.mark.parametrize("wall", ["floor", "planes"])
def test_from_a_sphere_behind_a_plane_nothing_is_seen_through_it(wall: str) -> None:
    """A floor and a plane are black from behind and hide the background, in the integrand as in the ray tracer."""
    flat = {"lobe": {}} if wall == "floor" else None
    planes = [{"name": "w", "point": [1.0, 2.0, 0.0], "normal": [0.0, 0.0, 3.0]}] if wall == "planes" else []
    scene = scene_of(
        {
            "camera": {"type": "look_at", "eye": [0.0, -9.0, -4.0], "target": [0.0, 0.0, -4.0]},
            "spheres": [{"name": "A", "center": [0.0, 0.0, -4.0], "radius": 1.0, "lobe": {}}],
            "floor": flat,
            "planes": planes,
            "ambient": [0.5, 0.5, 0.5],
            "background": [1.0, 1.0, 1.0],
        }
    )
    held, arrays = expression(scene, surface="spheres.A"), scene_arrays(scene)
    for direction, dark in (((0.0, 0.0, 1.0), True), ((0.0, -1.0, 0.5), True), ((0.0, -1.0, -0.5), False)):
        unit = np.array(direction) / np.linalg.norm(direction)
        normal = (0.0, 0.0, 1.0) if dark else (0.0, -1.0, 0.0)
        radiance, hit, _ = numeric.trace(arrays, np.add((0.0, 0.0, -4.0), normal), unit, at.FIRST_SPHERE)
        assert (hit[0] != at.NOTHING) == dark
        value = [float(x) for x in held.evaluate(normal, direction)]
        assert radiance[0].tolist() == value == [0.0 if dark else 1.0] * 3


def test_the_derivative_of_a_plane_is_that_of_its_values() -> None:
    """Central differences of the evaluated integrand, to their own error, by numbers that turn and shift a plane."""
    data = room(2)
    for plane in data["planes"]:
        plane["texture"] = {"type": "solid", "color": [0.7, 0.5, 0.3]}
    data["shading"]["highlight_view"] = "eye"
    scene = scene_of(data)
    given, _, directions = _seen(scene_arrays(scene), np.random.default_rng(5), 8)
    moved = 0
    for name in ("planes.w1.normal.x", "planes.w1.point.y", "planes.w0.point.z", "planes.w0.along.y"):
        slope, h = expression(scene, surface="planes.w0").diff(name), 1e-9
        centre = {p.name: p.value for p in scene.parameters()}[name]
        low, high = (expression(scene.replace({name: centre + d}), surface="planes.w0") for d in (-h, h))
        for x, w in zip(given[:4].tolist(), directions[:4].tolist(), strict=True):
            exact = np.array([float(v) for v in slope.evaluate(x, w)])
            differences = [
                float((b - a) / (2 * h)) for a, b in zip(low.evaluate(x, w), high.evaluate(x, w), strict=True)
            ]
            assert np.abs(exact - differences).max() <= 1e-5 * max(1.0, np.abs(exact).max())
            moved += int(np.abs(exact).max() > 1e-4)
    assert moved >= 4


def test_what_a_plane_does_to_its_neighbours_is_listed_as_walls() -> None:
    held = expression("room", surface="planes.glass")
    kinds = {(wall.shape, wall.kind) for wall in held.walls}
    assert {("plane 0", "texture"), ("plane 1", "cut"), ("floor", "cut"), ("sphere 1", "cut")} <= kinds
    assert not any(shape == "plane 2" for shape, _ in kinds), "what leaves a plane does not meet it"


def test_surfaces_that_are_not_there_are_refused_by_name() -> None:
    with pytest.raises(SceneError, match=r"planes\.rear has no lobe"):
        expression("room", surface="planes.rear")
    with pytest.raises(SceneError, match=r"floor.*planes\.none"):
        expression("room", surface="planes.none")
    with pytest.raises(OptionError):
        expression("room", surface="planes.glass").evaluate((0.1, 0.2, 0.3), (0, 0, 1))
    assert load("room").planes[2].name == "glass"
