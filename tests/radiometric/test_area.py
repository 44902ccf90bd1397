"""Spheres that emit: known values, quadrature over their cones, the path tracer, derivatives, what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays

FLOOR = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "white"}


def ball(name: str, center: list[float], radius: float, material: str = "white") -> dict[str, Any]:
    return {"type": "sphere", "name": name, "center": center, "radius": radius, "material": material}


def lit(*shapes: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A white world in which the sphere ``lamp`` emits radiance (2, 1, 0.5)."""
    return {
        "units": "radiometric", "bounces": 0, "camera": {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.5]},
        "materials": {"white": {"type": "diffuse", "reflectance": 1}, "both": {
            "type": "diffuse", "reflectance": 1, "two_sided": True}},
        "shapes": list(shapes), "lights": [{"type": "area", "name": "L", "shape": "lamp", "radiance": [2, 1, 0.5]}],
    } | more  # fmt: skip


def share(world: dict[str, Any], place: list[float], above: float = 1e-6) -> float:
    """E/pi of a place of the floor for radiance 1."""
    found = sr.probe(world, rays=([place[0], place[1], above], [0, 0, -1]), tol=1e-6)
    assert found.shape == ("shapes.floor",)
    np.testing.assert_allclose(found.direct[0], found.direct[0][1] * np.array([2, 1, 0.5]), rtol=1e-14)
    return float(found.direct[0][1])


@pytest.mark.parametrize("place", [[0.0, 0.0], [1.5, 0.2], [30.0, -1.0]])
@pytest.mark.parametrize("radius", [0.6, 1e-3, 1e-6])
def test_a_sphere_above_the_horizon_is_its_form_factor(place: list[float], radius: float) -> None:
    center = np.array([0.3, 0.1, 1.2])
    d = center - np.array([*place, 0.0])
    expected = radius**2 * d[2] / np.linalg.norm(d) ** 3
    found = share(lit(FLOOR, ball("lamp", center.tolist(), radius)), place)
    assert found == pytest.approx(expected, rel=1e-12 + 1e-15 / radius)


def test_a_lamp_is_seen_and_does_not_light_itself() -> None:
    seen = sr.probe(lit(FLOOR, ball("lamp", [0, 0, 2], 0.5)), rays=([0, -3, 2], [0, 1, 0]))
    np.testing.assert_array_equal(seen.emitted, [[2, 1, 0.5]])
    assert seen.shape == ("shapes.lamp",) and not seen.direct.any()


def test_a_sunken_horizon_takes_what_is_below_it() -> None:
    # a place on a ball whose tangent plane passes through the lamp's centre; apart, so nothing else hides it
    found = sr.probe(
        lit(ball("ground", [0, 0, -1], 1.0), ball("lamp", [2, 0, 0], 0.5)), rays=([0, 0, 1e-3], [0, 0, -1])
    )
    k = 0.5 / 2.0
    assert found.direct[0, 1] == pytest.approx((math.asin(k) - k * math.sqrt(1 - k * k)) / math.pi, abs=1e-12)


def test_who_is_in_front_of_whom() -> None:
    lamp, free = ball("lamp", [0, 0, 3], 0.5), share(lit(FLOOR, ball("lamp", [0, 0, 3], 0.5)), [0.0, 0.0])
    assert free == pytest.approx(0.25 / 9)
    before, behind = ball("A", [0, 0, 1], 0.4), ball("A", [0, 0, 6], 2.0)
    assert share(lit(FLOOR, lamp, before), [0, 0]) == 0.0
    assert share(lit(FLOOR, lamp, behind), [0, 0]) == pytest.approx(free, rel=1e-13)
    # a ring is left of the lamp
    small = share(lit(FLOOR, lamp, ball("A", [0, 0, 1], 0.1)), [0, 0])
    assert small == pytest.approx(free - 0.01, rel=1e-10)
    lid = {"type": "plane", "name": "lid", "point": [0, 0, 2], "normal": [0, 0, -1], "material": "white"}
    assert share(lit(FLOOR, lamp, lid), [0, 0]) == 0.0
    assert share(lit(FLOOR, lamp, lid | {"point": [0, 0, 4]}), [0, 0]) == pytest.approx(free, rel=1e-13)


def test_a_room_with_a_lamp_in_it() -> None:
    """Lamp and place inside a ball: its inside is lit, from outside nothing is; around the lamp alone it hides it."""
    room, lamp = ball("room", [0, 0, 0], 5.0, "both"), ball("lamp", [1, 0, 0], 0.5)
    inside = sr.probe(lit(room, lamp), rays=([0, 0, 0], [-1, 0, 0]))
    assert inside.shape == ("shapes.room",)
    assert inside.direct[0, 1] == pytest.approx(0.25 / 36, rel=1e-12)
    outside = sr.probe(lit(room, lamp), rays=([-9, 0, 0], [1, 0, 0]))
    assert outside.shape == ("shapes.room",) and not outside.direct.any()
    shade = ball("shade", [1, 0, 0], 1.0, "both")
    assert not sr.probe(lit(room, lamp, shade), rays=([-1, 0, 0], [-1, 0, 0])).direct.any()
    assert share(lit(FLOOR, ball("lamp", [0, 0, 3], 0.5), ball("big", [0, 0, 9], 20.0, "both")), [0, 0]) == (
        pytest.approx(0.25 / 9)
    )


def crowd(seed: int) -> dict[str, Any]:
    """Balls and a wall, a lamp that crosses none of them."""
    random = np.random.default_rng(seed)
    lamp, radius = np.array([*random.uniform(-2, 2, 2), random.uniform(1.0, 3)]), float(random.uniform(0.05, 0.8))
    balls: list[dict[str, Any]] = []
    while len(balls) < 5:
        center, size = np.array([*random.uniform(-2, 2, 2), random.uniform(0.1, 3)]), float(random.uniform(0.1, 0.7))
        if np.linalg.norm(center - lamp) > size + radius:
            balls.append(ball(f"S{len(balls)}", center.tolist(), size))
    wall = {"type": "plane", "name": "wall", "point": [3.5, 0, 0], "normal": [-1, 0.2, 0.1], "material": "white"}
    return lit(FLOOR, *balls, ball("lamp", lamp.tolist(), radius), wall)


def test_hidden_and_half_hidden_lamps_equal_traced_directions() -> None:
    """A midpoint rule over the lamp's cone, each direction traced, which edges leave an error of some 1/n."""
    partly = lit_ = 0
    for seed in range(24):
        world = crowd(seed)
        arrays = radiometric_arrays(sr.load(world))
        random = np.random.default_rng(100 + seed)
        lamp = arrays.shapes[len(world["shapes"]) - 2]
        for _ in range(6):
            place = np.array([*random.uniform(-2.5, 2.5, 2), 0.0])
            if any(math.dist(place, s.place) < s.radius for s in arrays.shapes if s.radius > 0):
                continue
            found = share(world, place[:2].tolist())
            way = np.asarray(lamp.place) - place
            sine2 = lamp.radius**2 / (way @ way)
            height, axis = sine2 / (1 + math.sqrt(1 - sine2)), way / np.linalg.norm(way)
            first = np.cross(axis, [1.0, 0.3, 0.2])
            first /= np.linalg.norm(first)
            n = 160
            a, b = np.meshgrid((np.arange(n) + 0.5) / n, 2 * np.pi * (np.arange(n) + 0.5) / n)
            a, b = a.ravel() * height, b.ravel()
            r = np.sqrt(a * (2 - a))
            d = (1 - a)[:, None] * axis + (r * np.cos(b))[:, None] * first
            d += (r * np.sin(b))[:, None] * np.cross(axis, first)
            up = d[:, 2] > 0
            met = numeric_rays(arrays, np.tile([*place[:2], 1e-9], (n * n, 1)), d)[3]
            cosines = np.where(up & (met == len(world["shapes"]) - 1), d[:, 2], 0.0)
            counted, whole = cosines.mean() * 2 * height, np.where(up, d[:, 2], 0.0).mean() * 2 * height
            assert abs(found - counted) < 3e-3 * whole + 1e-12, (seed, place)
            lit_ += counted > 0.0
            partly += 0.02 * whole < counted < 0.98 * whole
    assert lit_ > 50 and partly > 8


def test_the_path_tracer_agrees_within_its_noise() -> None:
    """Both of its estimators; |z| of 72 beyond 6 comes by chance less than once in a million runs."""
    world = crowd(3)
    arrays = radiometric_arrays(sr.load(world))
    random = np.random.default_rng(5)
    origins = np.tile([0.0, -5.0, 2.0], (24, 1))
    toward = np.column_stack([random.uniform(-2, 2, 24), random.uniform(-2, 2, 24), random.uniform(0, 1, 24)]) - origins
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    true = sr.probe(world, rays=(origins, toward))
    assert true.direct.max() > 0.05
    errors = {}
    for sampler in ("independent", "importance"):
        several = np.array(
            [numeric_rays(arrays, origins, toward, sampler=sampler, order=32, seed=s)[1] for s in range(12)]
        )
        mean, error = several.mean(0), several.std(0, ddof=1) / math.sqrt(12)
        errors[sampler] = float(np.median(error[error > 0]))
        z = (mean - true.direct) / np.maximum(error, 1e-7)
        assert np.abs(z).max() < 6 and abs(float(z[:, 1].mean())) < 1
    assert errors["independent"] < 0.5 * errors["importance"]


def test_metal_under_a_lamp_is_sampled_by_both_alike() -> None:
    """Lights and materials ask for directions by very different densities; their weights must not show."""
    metal = {"type": "conductor", "distribution": "ggx", "alpha": 0.2, "eta": 0.3, "k": 3}
    floor, lamp = FLOOR | {"material": "metal"}, ball("lamp", [0, 3, 2.0], 0.7)
    world = lit(floor, lamp, ball("A", [0.5, 1.2, 0.6], 0.3, "metal"), materials={
        "metal": metal, "white": {"type": "diffuse", "reflectance": 1}})  # fmt: skip
    arrays = radiometric_arrays(sr.load(world))
    origins = np.tile([0.0, -3.0, 2.0], (12, 1))
    toward = np.array([[x, y, -2.0] for x in (-0.3, 0.0, 0.4) for y in (2.4, 3.0, 3.5, 4.2)])
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    runs = [
        np.array([numeric_rays(arrays, origins, toward, sampler=s, order=24, seed=k)[1] for k in range(12)])
        for s in ("independent", "importance")
    ]
    (a, da), (b, db) = ((r.mean(0), r.std(0, ddof=1) / math.sqrt(12)) for r in runs)
    assert a.max() > 0.2 and np.median(da) < 0.02 * a.max()
    assert np.abs((a - b) / np.maximum(np.hypot(da, db), 1e-7)).max() < 6
    seen = sr.probe(world, rays=(origins, toward), tol=1e-6)
    assert (seen.status == 0).all()
    assert np.abs((a - seen.direct) / np.maximum(da, 1e-6)).max() < 8


def test_derivatives_are_those_of_differences() -> None:
    world = crowd(7)
    names = ["shapes.lamp.radius", "shapes.lamp.center.x", "shapes.S1.center.z", "lights.L.radiance.g", "camera.fov"]
    scene = sr.load(world)
    slopes = sr.gradient(scene, names, size=(16, 12))
    step = 1e-6
    for name in names:
        value = float(get(scene, name))
        high, low = (sr.truth(scene.replace({name: value + s}), size=(16, 12)) for s in (step, -step))
        steady = (high.layer("hit_class") == low.layer("hit_class")) & (slopes[name].layer("status") == 0)
        off = np.abs((high.layer("direct") - low.layer("direct")) / (2 * step) - slopes[name].layer("direct"))
        size = np.abs(slopes[name].layer("direct")).max()
        assert size > 1e-3, name
        # where a penumbra begins the second derivative has a square root's edge
        assert np.mean(off.max(axis=2)[steady] < 1e-6 * max(1.0, size)) > 0.97, name


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"shape": "lamb"}, r"lights\[0\].shape: unknown shape 'lamb', did you mean 'lamp'"),
        (
            {"shape": "floor"},
            r"lights\[0\].shape: must name a shape that ends, got the plane 'floor'",
        ),
        ({"radiance": -1}, "radiance"),
    ],
)
def test_what_cannot_emit_is_refused(changed: dict[str, Any], said: str) -> None:
    light = {"type": "area", "name": "L", "shape": "lamp", "radiance": 1} | changed
    with pytest.raises(SceneError, match=said):
        sr.load(lit(FLOOR, ball("lamp", [0, 0, 2], 0.5), lights=[light]))
    twice = [light | {"shape": "lamp", "radiance": 1}] * 2
    with pytest.raises(SceneError, match=r"lights\[1\].shape: 'lamp' is the shape of lights\[0\] already"):
        sr.load(lit(FLOOR, ball("lamp", [0, 0, 2], 0.5), lights=[twice[0], twice[1] | {"name": "M"}]))


@pytest.mark.parametrize(
    "other", [FLOOR | {"point": [0, 0, 1.6]}, ball("A", [0.6, 0, 2], 0.3), ball("A", [0, 0, 2], 0.1)]
)
def test_a_lamp_that_crosses_a_shape_is_refused(other: dict[str, Any]) -> None:
    world = lit(ball("lamp", [0, 0, 2], 0.5), other)
    with pytest.raises(Unsupported, match=r"lights\[0\]: its sphere, shapes\[0\], crosses shapes\[1\]"):
        sr.truth(world, size=2, method="quadrature")
    assert sr.render(world, size=4, lobe=2, symbolic="none").numeric is not None
