"""The sky in closed form: against known values, against quadrature over directions, against the path tracer."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

CAMERA = {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.5]}
FLOOR = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "white"}


def scene(*shapes: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "units": "radiometric",
        "bounces": 0,
        "camera": CAMERA,
        "materials": {"white": {"type": "diffuse", "reflectance": 1}},
        "shapes": list(shapes),
        "lights": [{"type": "sky", "name": "sky", "radiance": [2, 1, 0.5]}],
    } | more


def sphere(name: str, center: list[float], radius: float) -> dict[str, Any]:
    return {"type": "sphere", "name": name, "center": center, "radius": radius, "material": "white"}


def wall(name: str, point: list[float], normal: list[float], along: tuple[float, ...] = (0, 1, 0.3)) -> dict[str, Any]:
    return {"type": "plane", "name": name, "point": point, "normal": normal, "along": list(along), "material": "white"}


def share(world: dict[str, Any], place: list[float], above: float = 0.3) -> float:
    """What a white place of the floor sends straight up, of a sky of radiance 1."""
    found = sr.probe(world, rays=([place[0], place[1], above], [0, 0, -1]), tol=1e-9)
    assert found.shape == ("shapes.floor",)
    np.testing.assert_allclose(found.direct[0], found.direct[0][1] * np.array([2, 1, 0.5]), rtol=1e-14)
    return float(found.direct[0][1])


def test_a_white_floor_under_the_whole_sky_is_the_sky() -> None:
    assert share(scene(FLOOR), [0.4, 3.0]) == pytest.approx(1.0, abs=1e-15)
    seen = sr.probe(scene(FLOOR), rays=([0, 0, 1], [0, 0, 1]))
    assert seen.shape == ("nothing",)
    np.testing.assert_array_equal(seen.emitted, [[2, 1, 0.5]])
    np.testing.assert_array_equal(seen.radiance, seen.emitted)


@pytest.mark.parametrize("place", [[0.0, 0.0], [1.5, 0.2], [3.0, -1.0]])
def test_a_sphere_takes_its_form_factor(place: list[float]) -> None:
    # wholly above the horizon: R^2 cos/d^2
    center, radius = np.array([0.3, 0.1, 1.2]), 0.5
    d = center - np.array([*place, 0.0])
    expected = 1 - radius**2 * d[2] / np.linalg.norm(d) ** 3
    assert share(scene(FLOOR, sphere("A", center.tolist(), radius)), place) == pytest.approx(expected, abs=1e-14)


def test_a_sphere_half_below_the_horizon_takes_half() -> None:
    # its centre in the plane: by symmetry about the horizon's edge, in closed form (asin k - k sqrt(1-k^2))/pi
    k = 0.5 / 2.0
    expected = 1 - (math.asin(k) - k * math.sqrt(1 - k * k)) / math.pi
    assert share(scene(FLOOR, sphere("A", [2, 0, 0], 0.5)), [0.0, 0.0]) == pytest.approx(expected, abs=1e-14)


def test_walls_take_their_half_space() -> None:
    # of a wall at angle t to the floor the sky keeps (1 + cos t)/2
    upright = wall("wall", [1, 0, 0], [-1, 0, 0])
    assert share(scene(FLOOR, upright), [0.0, 0.0]) == pytest.approx(0.5, abs=1e-14)
    leaning = wall("wall", [1, 0, 0], [-math.sin(1.0), 0, math.cos(1.0)])
    assert share(scene(FLOOR, leaning), [0.0, 0.0]) == pytest.approx((1 + math.cos(1.0)) / 2, abs=1e-14)
    corner = scene(FLOOR, upright, wall("other", [0, 1, 0], [0, -1, 0], (1, 0, 0)))
    assert share(corner, [0.0, 0.0]) == pytest.approx(0.25, abs=1e-14)


def test_what_hides_everything_leaves_nothing_and_what_is_twice_there_counts_once() -> None:
    upright = wall("wall", [1, 0, 0], [-1, 0, 0])
    ceiling = {"type": "plane", "name": "lid", "point": [0, 0, 2], "normal": [0, 0, -1], "material": "white"}
    assert share(scene(FLOOR, ceiling), [0.0, 0.0]) == pytest.approx(0.0, abs=1e-15)
    assert share(scene(FLOOR, upright, upright | {"name": "same"}), [0, 0]) == pytest.approx(0.5, abs=1e-14)
    behind = upright | {"name": "behind", "point": [3, 0, 0]}
    assert share(scene(FLOOR, upright, behind), [0, 0]) == pytest.approx(0.5, abs=1e-14)
    one = scene(FLOOR, sphere("A", [0.3, 0.1, 1.2], 0.5))
    two = scene(FLOOR, sphere("A", [0.3, 0.1, 1.2], 0.5), sphere("B", [0.6, 0.2, 2.4], 0.9))
    smaller = share(one, [0.0, 0.0])
    assert share(two, [0.0, 0.0]) == pytest.approx(smaller, abs=1e-14), "B lies in the shadow of A"
    touching = scene(FLOOR, sphere("A", [0, 0, 0.5], 0.5))
    assert 0 <= share(touching, [1e-3, 0.0], above=1e-7) < 1e-4 < share(touching, [0.1, 0.0], above=1e-3) < 0.1


def crowd(seed: int) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    spheres = [
        sphere(
            f"S{k}", [*random.uniform(-2, 2, 2).tolist(), float(random.uniform(0, 2))], float(random.uniform(0.2, 0.9))
        )
        for k in range(6)
    ]
    return scene(FLOOR, *spheres, wall("wall", [3, 0, 0], [-1, 0.2, 0.3]))


def test_overlapping_occluders_equal_counted_directions() -> None:
    """A midpoint rule over directions, each traced, which edges leave an error of some 1/n."""
    compared = 0
    for seed in range(12):
        world = crowd(seed)
        arrays = radiometric_arrays(sr.load(world))
        place = np.random.default_rng(100 + seed).uniform(-2.5, 2.5, 2).tolist()
        inside = any(math.dist([*place, 0.0], s.place) < s.radius for s in arrays.shapes if s.radius > 0)
        if inside:
            continue
        found = share(world, place, above=1e-9)
        n = 400
        a, b = np.meshgrid((np.arange(n) + 0.5) / n, 2 * np.pi * (np.arange(n) + 0.5) / n)
        r = np.sqrt(a.ravel())
        d = np.column_stack([r * np.cos(b.ravel()), r * np.sin(b.ravel()), np.sqrt(1 - r * r)])
        met = numeric_rays(arrays, np.tile([*place, 1e-9], (n * n, 1)), d)[3]
        assert 0.05 < found < 0.95
        assert abs(found - np.mean(met == 0)) < 1e-3
        compared += 1
    assert compared >= 8


def test_the_path_tracer_agrees_within_its_noise() -> None:
    world = crowd(3)
    arrays = radiometric_arrays(sr.load(world))
    random = np.random.default_rng(5)
    origins = np.tile([0.0, -5.0, 2.0], (24, 1))
    toward = np.column_stack([random.uniform(-2, 2, 24), random.uniform(-2, 2, 24), random.uniform(0, 1, 24)]) - origins
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    true = sr.probe(world, rays=(origins, toward))
    for sampler in ("independent", "importance"):
        several = np.array(
            [numeric_rays(arrays, origins, toward, sampler=sampler, order=32, seed=s)[1] for s in range(8)]
        )
        mean, error = several.mean(0), several.std(0, ddof=1) / math.sqrt(8)
        assert true.direct.max() > 0.5 and 0 < error.max() < 0.02
        z = (mean - true.direct) / np.maximum(error, 1e-9)
        assert np.abs(z).max() < 6 and abs(float(z[:, 1].mean())) < 1


def test_turned_rooms_count_what_coincides_once() -> None:
    """Walls in one plane and lids over floors, at any angle: rounding must not count a circle twice or never."""
    random, compared = np.random.default_rng(9), 0
    for _ in range(40):
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        up, side = turn[2], turn[0]
        floor = wall("floor", (0.7 * up).tolist(), up.tolist(), tuple(side))
        upright = wall("wall", (0.7 * up + 2 * side).tolist(), (-side).tolist(), tuple(up))
        same = upright | {"name": "same", "normal": (-3.7 * side).tolist()}
        behind = upright | {"name": "behind", "point": (0.7 * up + 3.1 * side).tolist()}
        lid = wall("lid", (1.9 * up).tolist(), (-1.3 * up).tolist(), tuple(side))
        ray = ((1.1 * up + 0.2 * turn[1]).tolist(), (-up + 0.1 * turn[1]).tolist())
        ball = sphere("A", (1.4 * up + 0.9 * turn[1] - 0.3 * side).tolist(), 0.31)
        once = float(sr.probe(scene(floor, ball), rays=ray).direct[0][1])
        twice = float(sr.probe(scene(floor, ball, ball | {"name": "B"}), rays=ray).direct[0][1])
        assert 0.7 < once < 0.95 and abs(twice - once) < 1e-11
        for shapes, expected in (
            ((floor, upright, same, behind), 0.5),
            ((floor, lid), 0.0),
            ((floor, lid, upright), 0.0),
        ):
            found = sr.probe(scene(*shapes), rays=ray)
            assert found.shape == ("shapes.floor",)
            assert abs(found.direct[0][1] - expected) < 1e-11
            compared += 1
    assert compared == 120
