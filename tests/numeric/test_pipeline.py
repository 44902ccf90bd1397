from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import OptionError
from symrender.numeric.pipeline import prepare, trace
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, NOTHING, scene_arrays
from symrender.scene.scene import Scene
from symrender.settings import Settings

from .conftest import render, with_parts

LAYERS = ("radiance", "direct", "gloss", "hit_class")


def _finite(image: dict[str, Any]) -> None:
    for layer in LAYERS:
        assert np.isfinite(image[layer]).all(), layer


def test_hit_counts_of_the_chapter(chapter8: Scene) -> None:
    image = render(chapter8, 64)
    assert [int((image["hit_class"] == c).sum()) for c in (NOTHING, FLOOR, 2, 3)] == [0, 1809, 1872, 415]
    assert image["evaluations"] == 4096 * 16
    weight = np.choose(image["hit_class"].astype(int), [0, 0.3, 0.05, 0.05])[..., None]
    np.testing.assert_array_equal(image["radiance"], image["direct"] + weight * image["gloss"])
    floor = image["hit_class"] == FLOOR
    assert 1e-3 < image["gloss"][floor].max() < 0.05
    _finite(image)


@pytest.mark.parametrize("numeric", ["jittered", "independent", "importance", "sobol"])
def test_tiles_threads_and_crops_give_the_same_bytes(chapter8: Scene, numeric: str) -> None:
    options: dict[str, Any] = {"lobe": 3, "numeric": numeric, "disk": "exact", "seed": 2**40 + 1}
    whole = render(chapter8, 64, 40, **options)
    assert whole["gloss"].max() > 0
    for tile in (1, 7, 64):
        tiled = render(chapter8, 64, 40, tile=tile, **options)
        for layer in LAYERS:
            np.testing.assert_array_equal(tiled[layer], whole[layer])
    kernel = prepare(scene_arrays(chapter8), Settings(width=64, height=40, **options))
    layers = {layer: np.full_like(whole[layer], np.nan) for layer in LAYERS}
    with ThreadPoolExecutor(3) as pool:
        list(pool.map(lambda y: kernel(0, y, 64, y + 1, layers), range(40)))
    np.testing.assert_array_equal(layers["radiance"], whole["radiance"])
    crop = {layer: np.full_like(whole[layer], np.nan) for layer in LAYERS}
    kernel(10, 5, 30, 21, crop)
    np.testing.assert_array_equal(crop["radiance"][5:21, 10:30], whole["radiance"][5:21, 10:30])
    assert np.isnan(crop["radiance"]).sum() == (64 * 40 - 16 * 20) * 3


def test_seed_moves_only_what_is_sampled(chapter8: Scene) -> None:
    one, two = render(chapter8, 32, seed=1), render(chapter8, 32, seed=2)
    np.testing.assert_array_equal(one["direct"], two["direct"])
    assert (one["gloss"] != two["gloss"]).any(axis=2).sum() > 300


def test_lobe_weight_zero_is_direct_light(chapter8: Scene) -> None:
    data = chapter8.model_dump()
    for part in (*data["spheres"], data["floor"]):
        part["lobe"]["weight"] = 0.0
    dark = render(Scene.model_validate(data, strict=False), 32)
    np.testing.assert_array_equal(dark["radiance"], render(chapter8, 32)["direct"])
    assert dark["evaluations"] == 0 and not dark["gloss"].any()


def test_sampler_none_and_exact_disk_of_a_ray_are_refused(chapter8: Scene) -> None:
    with pytest.raises(OptionError, match="numeric"):
        prepare(scene_arrays(chapter8), Settings(numeric="none"))
    with pytest.raises(OptionError, match="disk"):
        trace(scene_arrays(chapter8), [[0, 0, 5.0]], [[0, 0, -1.0]], 0, disk_order=0)
    with pytest.raises(OptionError, match="origins"):
        trace(scene_arrays(chapter8), [[0, 0, 5.0]], [[0, -1.0]], 0)


def _scaled(scene: Scene, scale: float) -> Scene:
    data = scene.model_dump()

    def grow(part: dict[str, Any], *names: str) -> None:
        for name in names:
            value = part[name]
            part[name] = [scale * x for x in value] if isinstance(value, tuple | list) else scale * value

    grow(
        data["camera"], *(name for name in ("eye", "target", "window_half", "window_center") if name in data["camera"])
    )
    for sphere in data["spheres"]:
        grow(sphere, "center", "radius")
    for light in data["lights"]:
        grow(light, *(name for name in ("position", "target", "radius") if name in light))
    if data["floor"] is not None and data["floor"]["texture"]["type"] == "checker":
        grow(data["floor"]["texture"], "cell", "offset")
    return Scene.model_validate(data, strict=False)


@pytest.fixture(scope="module")
def oblique(chapter8: Scene) -> Scene:
    """The same shapes, all matte-textured solid, seen obliquely, with strong lobes."""
    data = chapter8.model_dump()
    data["camera"] = {"type": "look_at", "eye": [3.0, -3.0, 2.0], "target": [0.2, 0.0, 0.4], "fov": 40.0}
    for part in (*data["spheres"], data["floor"]):
        part["texture"] = {"type": "solid"}
        part["lobe"] = {"weight": 0.5, "exponent": 16.0, "theta_max": 1.2}
    data["background"] = [0.1, 0.2, 0.3]
    return Scene.model_validate(data, strict=False)


@pytest.mark.parametrize("power", [-130, -3, 7, 30])
def test_scaling_by_a_power_of_two_changes_no_bit(chapter8: Scene, oblique: Scene, power: int) -> None:
    for scene in (chapter8, oblique):
        plain, scaled = render(scene, 24, lobe=3), render(_scaled(scene, 2.0**power), 24, lobe=3)
        for layer in LAYERS:
            np.testing.assert_array_equal(plain[layer], scaled[layer])


@given(st.floats(0, 6.2))
@settings(max_examples=10, deadline=None, derandomize=True)
def test_turning_about_the_vertical_changes_nothing(oblique: Scene, turn: float) -> None:
    """Disk axes do not turn with the scene, so lights are points here. A pixel may change side of an edge."""
    data = oblique.model_dump()
    data["lights"] = [
        {"type": "point", "name": l["name"], "position": l["position"], "color": l["color"]} for l in data["lights"]
    ]
    plain = Scene.model_validate(data, strict=False)
    c, s = math.cos(turn), math.sin(turn)

    def turned(p: Any) -> list[float]:
        return [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]]

    for name in ("eye", "target"):
        data["camera"][name] = turned(data["camera"][name])
    for sphere in data["spheres"]:
        sphere["center"] = turned(sphere["center"])
    for light in data["lights"]:
        light["position"] = turned(light["position"])
    a, b = render(plain, 32, lobe=3), render(Scene.model_validate(data, strict=False), 32, lobe=3)
    assert a["gloss"].max() > 0.1
    off = np.abs(a["radiance"] - b["radiance"]).max(axis=2) > 1e-11
    assert off.sum() <= 3


def test_order_of_spheres_and_lights_does_not_matter(oblique: Scene) -> None:
    data = oblique.model_dump()
    data["spheres"] = data["spheres"][::-1]
    data["lights"] = data["lights"][::-1]
    a, b = render(oblique, 32), render(Scene.model_validate(data, strict=False), 32)
    np.testing.assert_array_equal(np.choose(a["hit_class"].astype(int), [0, 1, 3, 2]), b["hit_class"])
    np.testing.assert_allclose(a["radiance"], b["radiance"], rtol=4e-15)


def test_linear_in_light_colour_and_additive_over_lights(chapter8: Scene) -> None:
    data = chapter8.model_dump()
    lights = data["lights"]
    black = with_parts(chapter8, lights=[])
    singles = [with_parts(chapter8, lights=[light]) for light in lights]
    ambient = render(black, 32)["radiance"]
    parts = [render(scene, 32)["radiance"] - ambient for scene in singles]
    np.testing.assert_allclose(render(chapter8, 32)["radiance"] - ambient, sum(parts), atol=1e-14)
    dim = [light | {"color": [0.25 * x for x in light["color"]]} for light in lights]
    np.testing.assert_allclose(
        render(with_parts(chapter8, lights=dim), 32)["radiance"] - ambient,
        0.25 * (render(chapter8, 32)["radiance"] - ambient),
        atol=1e-15,
    )
    red = [light | {"color": [1.0, 0.0, 0.0]} for light in lights]
    only_red = render(with_parts(chapter8, lights=red, ambient=[0.1, 0.0, 0.0]), 32)["radiance"]
    assert only_red[..., 0].max() > 0.1 and not only_red[..., 1:].any()


def test_disk_of_radius_zero_is_the_point_light(chapter8: Scene) -> None:
    data = chapter8.model_dump()
    zero = [data["lights"][0] | {"radius": 0.0}, data["lights"][1]]
    point = [{"type": "point", "name": "key", "position": zero[0]["position"], "color": zero[0]["color"]}, zero[1]]
    for disk in ("2x2", "exact"):
        a, b = (render(with_parts(chapter8, lights=lights), 32, disk=disk) for lights in (zero, point))
        np.testing.assert_array_equal(a["radiance"], b["radiance"])


def test_what_is_under_the_floor_is_never_seen_from_above(oblique: Scene) -> None:
    data = oblique.model_dump()
    plain = render(oblique, 48)
    buried = {"name": "C", "center": [0.8, -0.6, -0.9], "radius": 0.8, "color": [1.0, 1.0, 1.0]}
    data["spheres"] = [*data["spheres"], buried]
    with_buried = render(Scene.model_validate(data, strict=False), 48)
    assert (plain["gloss"].max(axis=2) > 0.05).mean() > 0.2
    np.testing.assert_array_equal(plain["radiance"], with_buried["radiance"])


def test_trace_finds_the_nearest_by_brute_force(oblique: Scene) -> None:
    """Class and distance of 500 rays, half of them aimed at a sphere, against the roots of every shape in 40 digits."""
    arrays = scene_arrays(oblique)
    rng = np.random.default_rng(8)
    origins = rng.uniform((-2, -2, -1), (2, 2, 3), (500, 3))
    directions = rng.normal(size=origins.shape)
    directions[::2] = arrays.spheres["center"][rng.integers(0, 2, 250)] + 0.3 * directions[::2] - origins[::2]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    _, hit_class, distance = trace(arrays, origins, directions, NOTHING)
    with mpmath.workdps(40):
        for o, d, found, t in zip(origins, directions, hit_class, distance, strict=True):
            best = (mpmath.inf, NOTHING)
            slope = mpmath.mpf(d[2])
            if -mpmath.mpf(o[2]) / slope > 0:
                best = (-mpmath.mpf(o[2]) / slope, FLOOR, mpmath.mpf(1))
            for j, sphere in enumerate(arrays.spheres):
                f = [mpmath.mpf(x) - mpmath.mpf(c) for x, c in zip(o, sphere.center, strict=True)]
                a = sum(mpmath.mpf(x) ** 2 for x in d)
                b = sum(x * mpmath.mpf(y) for x, y in zip(f, d, strict=True))
                delta = b * b - a * (sum(x * x for x in f) - mpmath.mpf(sphere.radius) ** 2)
                if delta >= 0:
                    for root in ((-b - mpmath.sqrt(delta)) / a, (-b + mpmath.sqrt(delta)) / a):
                        if 0 < root < best[0]:
                            best = (root, FIRST_SPHERE + j, mpmath.sqrt(delta))
            assert found == best[1]
            # near tangency a root is known to the rounding of the discriminant over its own root
            assert t == math.inf if best[1] == NOTHING else abs(t - best[0]) < 2e-14 / min(1, best[2])
    assert min((hit_class == c).sum() for c in (0, 1, 2, 3)) >= 40


def test_a_shape_never_meets_itself() -> None:
    """Rays leave 40 spheres of very different size and place in 250 directions: none comes back to its own."""
    rng = np.random.default_rng(4)
    hits = 0
    for _ in range(40):
        radius, center = 10.0 ** rng.uniform(-8, 8), rng.normal(size=3) * 10.0 ** rng.uniform(-8, 8)
        scene = Scene.model_validate(
            {
                "camera": LOOK,
                "spheres": [{"name": "a", "center": [*map(float, center)], "radius": radius}],
            },
            strict=False,
        )
        n = rng.normal(size=(250, 3))
        n /= np.linalg.norm(n, axis=1)[:, None]
        d = rng.normal(size=n.shape)
        d /= np.linalg.norm(d, axis=1)[:, None]
        d *= np.sign((d * n).sum(axis=1))[:, None]
        _, left, _ = trace(scene_arrays(scene), center + radius * n, d, FIRST_SPHERE)
        assert not left.any()
        _, inside, t = trace(scene_arrays(scene), center + 0.99 * radius * n * (rng.random((250, 1))), d, NOTHING)
        if np.linalg.norm(center) < 1e4 * radius:
            assert (inside == FIRST_SPHERE).all() and (t > 0).all()
            hits += 250
    assert hits > 4000


@pytest.mark.parametrize("view", ["eye", "ray"])
def test_highlight_view_of_a_lobe_ray(view: str) -> None:
    """Highlight alone, N.h with v towards the camera or back along the ray, at every point met."""
    scene = Scene.model_validate(
        {
            "camera": LOOK,
            "spheres": [{"name": "a", "center": [0.0, 0.0, 1.0], "radius": 1.0}],
            "lights": [{"type": "point", "name": "l", "position": [3.0, 3.0, 6.0]}],
            "shading": {"ka": 0.0, "kd": 0.0, "ks": 1.0, "shininess": 1.0, "highlight_view": view},
        },
        strict=False,
    )
    rng = np.random.default_rng(1)
    origins = np.array([2.0, 1.0, 0.0]) + rng.normal(size=(400, 3)) * (0.1, 0.1, 0)
    directions = (0, 0, 1) + 0.6 * rng.normal(size=(400, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    radiance, hit, distance = trace(scene_arrays(scene), origins, directions, FLOOR)
    lit = 0
    for o, d, t, value in zip(
        origins[hit == 2], directions[hit == 2], distance[hit == 2], radiance[hit == 2], strict=True
    ):
        q = o + t * d
        n, l = q - (0, 0, 1), np.array([3.0, 3.0, 6.0]) - q
        v = np.array(LOOK["eye"]) - q if view == "eye" else -d
        h = l / np.linalg.norm(l) + v / np.linalg.norm(v)
        expected = max(0.0, n @ h / np.linalg.norm(h)) if n @ l > 0 else 0.0
        np.testing.assert_allclose(value, expected, atol=1e-12)
        lit += expected > 0.1
    assert lit > 100


SPHERE = {"name": "a", "center": [0.0, 0.0, 1.0], "radius": 1.0, "lobe": {}}
LIGHT = {"type": "disk", "name": "k", "position": [2.0, 2.0, 5.0], "radius": 0.3}
LOOK = {"type": "look_at", "eye": [4.0, -4.0, 2.0], "target": [0.0, 0.0, 0.5]}
USUAL: dict[str, Any] = {"spheres": [SPHERE], "floor": {"lobe": {}}, "lights": [LIGHT]}
RIGHT_ANGLE = 1.5707963267948966
DEGENERATE: dict[str, dict[str, Any]] = {
    "nothing at all": {},
    "lights only": {"lights": [LIGHT]},
    "no lights": {"spheres": [SPHERE], "floor": {"lobe": {}}},
    "black light": {"spheres": [SPHERE], "lights": [LIGHT | {"color": [0.0, 0.0, 0.0]}]},
    "camera inside a sphere": {**USUAL, "spheres": [SPHERE | {"center": [4.0, -4.0, 2.0]}]},
    "camera on a sphere": {**USUAL, "spheres": [SPHERE | {"center": [4.0, -4.0, 1.0]}]},
    "camera on the floor": {"camera": LOOK | {"eye": [4.0, -4.0, 0.0]}, **USUAL},
    "camera below the floor": {
        "camera": LOOK | {"eye": [4.0, -4.0, -2.0]},
        **USUAL,
        "spheres": [SPHERE | {"center": [0.0, 0.0, 0.0]}],
    },
    "light inside a sphere": {**USUAL, "lights": [LIGHT | {"position": [0.0, 0.0, 1.0], "radius": 0.1}]},
    "light swallowing the scene": {**USUAL, "lights": [LIGHT | {"radius": 100.0, "position": [0.0, 0.0, 0.5]}]},
    "light at the eye": {**USUAL, "lights": [LIGHT | {"position": LOOK["eye"]}]},
    "light in the floor": {**USUAL, "lights": [LIGHT | {"position": [1.0, 1.0, 0.0]}]},
    "light below the floor": {**USUAL, "lights": [LIGHT | {"position": [1.0, 1.0, -2.0]}]},
    "light aimed along y": {**USUAL, "lights": [LIGHT | {"position": [0.0, -5.0, 0.0]}]},
    "two equal spheres": {**USUAL, "spheres": [SPHERE, SPHERE | {"name": "b"}]},
    "tangent and nested": {
        **USUAL,
        "spheres": [SPHERE, SPHERE | {"name": "b", "center": [0.0, 0.0, 3.0]}, SPHERE | {"name": "c", "radius": 0.5}],
    },
    "speck": {**USUAL, "spheres": [SPHERE | {"radius": 1e-30}]},
    "huge": {**USUAL, "spheres": [SPHERE | {"radius": 1e12, "center": [0.0, 0.0, -1e12]}]},
    "far": {"camera": LOOK | {"eye": [4e8, -4e8, 2e8], "fov": 1e-6}, **USUAL},
    "horizon": {"camera": LOOK | {"eye": [0.0, -4.0, 1.0], "target": [0.0, 0.0, 1.0], "fov": 90.0}, **USUAL},
    "grazing": {
        "camera": LOOK | {"eye": [0.0, -1e6, 1e-6], "target": [0.0, 0.0, 0.0], "fov": 1e-3},
        "floor": {"lobe": {"theta_max": RIGHT_ANGLE}},
        "lights": [LIGHT],
    },
    "cells too small to count": {
        **USUAL,
        "floor": {"texture": {"type": "checker", "cell": 1e-150}, "lobe": {}},
    },
    "all rays along the horizon": {
        **USUAL,
        "camera": LOOK | {"eye": [0.0, -4.0, 1.0], "target": [0.0, 0.0, 1.0], "fov": 1e-300},
    },
    "floor 1e28 away": {
        **USUAL,
        "camera": LOOK | {"eye": [0.0, -1e12, 1e12], "target": [0.0, 0.0, 999999999999.9999], "fov": 1e-14},
    },
    "shininess 0": {**USUAL, "shading": {"shininess": 0.0}},
    "shininess 1e9": {**USUAL, "shading": {"shininess": 1e9, "model": "phong"}},
    "lobe n 0": {**USUAL, "floor": {"lobe": {"exponent": 0.0, "theta_max": RIGHT_ANGLE}}},
    "lobe n 1e-300": {**USUAL, "floor": {"lobe": {"exponent": 1e-300, "theta_max": RIGHT_ANGLE}}},
    "lobe n 1e12": {**USUAL, "floor": {"lobe": {"exponent": 1e12, "theta_max": RIGHT_ANGLE}}},
    "lobe theta 1e-300": {**USUAL, "floor": {"lobe": {"theta_max": 1e-300}}},
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_scenes_are_finite(name: str) -> None:
    scene = Scene.model_validate({"camera": LOOK, "ambient": [0.1, 0.1, 0.1]} | DEGENERATE[name], strict=False)
    for numeric, normalised, disk in (("jittered", False, "2x2"), ("jittered", True, "exact"), ("sobol", False, "3x3")):
        image = render(scene, 16, 9, lobe=2, numeric=numeric, normalised=normalised, disk=disk)
        _finite(image)
        for layer in ("radiance", "direct", "gloss"):
            assert (image[layer] >= 0).all(), layer


def test_odd_sizes() -> None:
    scene = Scene.model_validate({"camera": LOOK, **USUAL}, strict=False)
    for width, height in ((1, 1), (257, 1), (1, 63)):
        _finite(render(scene, width, height))


def test_equal_spheres_look_like_one() -> None:
    base = {"camera": LOOK, "floor": {"lobe": {}}, "lights": [LIGHT]}
    one = render(Scene.model_validate(base | {"spheres": [SPHERE]}, strict=False), 32)
    two = Scene.model_validate(base | {"spheres": [SPHERE, SPHERE | {"name": "b"}]}, strict=False)
    image = render(two, 32, lobe=4)
    assert (image["hit_class"] == 2).sum() == (one["hit_class"] == 2).sum() > 100 and not (
        image["hit_class"] == 3
    ).any()


def test_below_the_floor_is_black_and_blocks() -> None:
    scene = Scene.model_validate(
        {
            "camera": LOOK | {"eye": [0.0, -4.0, -2.0], "target": [0.0, 0.0, 0.0]},
            "spheres": [{"name": "a", "center": [0.0, 0.0, 0.3], "radius": 1.0}],
            "floor": {"lobe": {}},
            "lights": [LIGHT],
            "ambient": [0.5, 0.5, 0.5],
            "background": [0.3, 0.3, 0.3],
        },
        strict=False,
    )
    image = render(scene, 32)
    floor, sphere = image["hit_class"] == 1, image["hit_class"] == 2
    assert floor.sum() > 100 and sphere.sum() > 50
    assert not image["radiance"][floor].any() and not image["gloss"][floor].any()
    # ambient only: the light is on the other side of the floor
    np.testing.assert_allclose(image["direct"][sphere], 0.05, rtol=1e-14)


def test_whole_image_of_single_sphere_head_on() -> None:
    """A Lambert sphere lit from the eye: radiance kd albedo cosine, silhouette of the right area."""
    size, distance = 101, 50.0
    scene = Scene.model_validate(
        {
            "camera": {"type": "look_at", "eye": [0.0, -distance, 0.0], "fov": 4.0},
            "spheres": [{"name": "a", "center": [0.0, 0.0, 0.0], "radius": 1.0, "color": [1.0, 0.5, 0.25]}],
            "lights": [{"type": "point", "name": "l", "position": [0.0, -distance, 0.0]}],
            "shading": {"ks": 0.0, "kd": 0.8},
        },
        strict=False,
    )
    image = render(scene, size)
    half = math.tan(math.radians(2.0))
    disc = math.pi * (1 / math.sqrt(distance**2 - 1) / half * size / 2) ** 2
    assert image["hit_class"].astype(bool).sum() == pytest.approx(disc, rel=0.01)
    x = (np.arange(size) - 50) * 2 / size * half
    square = x[:, None] ** 2 + x[None, :] ** 2
    sine = np.sqrt(square / (1 + square)) * distance
    lit = sine < 0.99
    assert lit.sum() > 1000
    # the angle of incidence at a sphere seen from distance e under angle a: sin(incidence) = e sin(a)
    expected = 0.8 * np.sqrt(1 - np.where(lit, sine, 0) ** 2)
    np.testing.assert_allclose(image["radiance"][lit][:, 0], expected[lit], rtol=1e-11)
    np.testing.assert_allclose(image["radiance"][lit][:, 2], expected[lit] / 4, rtol=1e-11)


def test_lobe_ray_from_below_meets_a_black_floor(oblique: Scene) -> None:
    """The same floor point seen from above is lit."""
    points = np.array([[1.5, 0.4, -0.5], [1.5, 0.4, 0.5]])
    radiance, hit, distance = trace(scene_arrays(oblique), points, [[0, 0, 1.0], [0, 0, -1.0]], NOTHING)
    assert hit.tolist() == [FLOOR, FLOOR] and distance.tolist() == [0.5, 0.5]
    assert not radiance[0].any() and (radiance[1] > 0.1).all()
