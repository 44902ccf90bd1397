"""Means over pixels: areas in closed form, the conventional tracer's samples, walls against where it sees edges."""

from __future__ import annotations

import itertools
import json
import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError, Unsupported
from symrender.jit.records import Table
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.pixels.curves import put_curve
from symrender.radiometric.pixels.records import TERMS, Wall
from symrender.radiometric.world import seen
from symrender.runtimes.pixels import wall_tables
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

Array = np.ndarray[Any, np.dtype[np.float64]]


def world(shapes: list[dict[str, Any]], lights: list[dict[str, Any]], **more: Any) -> RadiometricScene:
    made = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0, 0, 4], "up": [0, 1, 0], "fov": 30},
        "materials": {"white": {"type": "diffuse", "reflectance": 1}, "black": {"type": "diffuse", "reflectance": 0}},
        "shapes": shapes, "lights": lights,
    } | more)  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def plane(material: str = "white", **more: Any) -> dict[str, Any]:
    return {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": material} | more


def ball(name: str, center: Any, radius: float, material: str = "white") -> dict[str, Any]:
    center = [float(x) for x in center]
    return {"type": "sphere", "name": name, "center": center, "radius": radius, "material": material}


SUN = {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": [math.pi, 2, 1]}


def mean(scene: RadiometricScene, tol: float, width: int = 1, height: int = 1, place: tuple[int, int] = (0, 0)) -> Any:
    """(radiance, stated error) of a pixel that met its tolerance."""
    image = sr.truth(scene, size=(width, height), tol=tol, filter="box", threads=1)
    i, j = place
    assert image.layer("error")[j, i] <= tol and not image.layer("status")[j, i]
    return image.radiance[j, i], image.layer("error")[j, i]


def clipped(corners: Array, n: Array) -> float:
    """Area of the part of a convex polygon where n[0] x + n[1] y + n[2] is positive."""
    level = corners @ n[:2] + n[2]
    kept = []
    for k in range(len(corners)):
        m = (k + 1) % len(corners)
        if level[k] > 0:
            kept.append(corners[k])
        if level[k] * level[m] < 0:
            kept.append(corners[k] + (corners[m] - corners[k]) * level[k] / (level[k] - level[m]))
    if len(kept) < 3:
        return 0.0
    x, y = np.array(kept).T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


@pytest.mark.parametrize("radius", [1e-3, 0.3, 0.9])
def test_a_sphere_on_the_axis_covers_its_disk(radius: float) -> None:
    lamp = {"type": "area", "name": "L", "shape": "lamp", "radiance": [3, 2, 1]}
    scene = world([ball("lamp", [0, 0, 0], radius)], [lamp])
    rim = radius / math.sqrt(16.0 - radius**2)
    share = math.pi * rim**2 / (2.0 * math.tan(math.radians(15.0))) ** 2
    value, error = mean(scene, 1e-9)
    assert share > 1e-7
    assert np.abs(value - share * np.array([3, 2, 1])).max() <= 1.5 * error


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, math.pi / 4, 1.2, math.pi / 2])
def test_a_horizon_cuts_pixels_at_any_angle(angle: float) -> None:
    camera = {
        "type": "look_at",
        "eye": [0, 0, 2],
        "target": [0, 5, 2.3],
        "fov": 30,
        "up": [math.sin(angle), 0, math.cos(angle)],
    }
    scene = world([plane("black")], [{"type": "sky", "name": "Y", "radiance": [1, 1, 1]}], camera=camera)
    image = sr.truth(scene, size=3, tol=1e-10, filter="box")
    forward, right, up = seen(radiometric_arrays(scene), 3, 3).window
    partly = 0
    for j in range(3):
        for i in range(3):
            a, b = 2 * np.array([i, i + 1]) / 3 - 1, 1 - 2 * np.array([j, j + 1]) / 3
            corners = np.array([[a[0], b[0]], [a[1], b[0]], [a[1], b[1]], [a[0], b[1]]])
            share = clipped(corners, np.array([right[2], up[2], forward[2]])) / (4 / 9)
            partly += 0.01 < share < 0.99
            assert abs(image.radiance[j, i, 0] - share) <= 1.5 * image.layer("error")[j, i] + 1e-15
            assert image.layer("error")[j, i] <= 1e-10
    assert partly >= 2


def test_a_checker_seen_from_above_is_its_duty() -> None:
    tiles = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 1, "dark": [0, 0.5, 0], "cell": 0.37}}
    scene = world([plane("tiles")], [SUN], materials={"tiles": tiles})
    image = sr.truth(scene, size=3, tol=1e-9, filter="box")
    half = 4 * math.tan(math.radians(15.0))

    def even(low: float, high: float) -> float:
        """Length of even fields between two places."""
        edges = np.concatenate([[low], np.arange(np.ceil(low / 0.37), np.floor(high / 0.37) + 1) * 0.37, [high]])
        return sum(b - a for a, b in itertools.pairwise(edges) if math.floor((a + b) / 0.74) % 2 == 0)

    side = 2 * half / 3
    for j in range(3):
        for i in range(3):
            x = -half + side * i
            y = half - side * (j + 1)
            p, q = even(x, x + side) / side, even(y, y + side) / side
            share = p * q + (1 - p) * (1 - q)
            expected = np.array([share, 2 / math.pi * (share + 0.5 * (1 - share)), share / math.pi])
            assert 0.2 < share < 0.8
            assert np.abs(image.radiance[j, i] - expected).max() <= 1.5 * image.layer("error")[j, i]
    assert image.layer("error").max() <= 1e-9


def test_a_shadow_seen_from_above_is_an_ellipse() -> None:
    slant = 1.1
    sun = SUN | {"direction": [math.sin(slant), 0, -math.cos(slant)], "irradiance": [math.pi, 0, 0]}
    # the ball stands beside the window
    camera = {"type": "look_at", "eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30}
    scene = world([plane(), ball("A", [-3 * math.tan(slant), 0, 3], 0.2)], [sun], camera=camera)
    value, error = mean(scene, 1e-9)
    dark = math.pi * 0.2**2 / math.cos(slant) / (8 * math.tan(math.radians(15.0))) ** 2
    assert dark > 0.05
    assert abs(value[0] - math.cos(slant) * (1 - dark)) <= 1.5 * error


def crowd(rng: np.random.Generator, kinds: str = "bcd") -> RadiometricScene:
    """Spheres that touch, cross or stand on a floor, of several materials, under a point and a sun."""
    texture = {
        "type": str(rng.choice(["checker", "stripes", "marble"])),
        "cell": 0.7,
        "bright": 0.9,
        "dark": [0, 0.2, 0.4],
    }
    materials = {
        "a": {"type": "diffuse", "reflectance": texture if rng.random() < 0.5 else 0.7},
        "b": {"type": "diffuse", "reflectance": texture | {"cell": 0.25}, "two_sided": True},
        "c": {"type": "conductor", "alpha": 0.2, "eta": [0.2, 0.9, 1.2], "k": [3, 2, 2]},
        "d": {"type": "phong", "exponent": 40},
    }
    scale = float(10.0 ** rng.integers(-4, 4))
    shapes = [plane("a", normal=[float(rng.normal() * 0.2), 0.1, 1])]
    place, size = np.array([0.0, 0.0, 1.0]), 1.0
    for k in range(int(rng.integers(1, 4))):
        shapes.append(ball(f"S{k}", place * scale, size * scale, str(rng.choice(list(kinds)))))
        way, other = rng.normal(size=3), float(10 ** rng.uniform(-1.3, 0))
        way[2] = abs(way[2])
        gap = float(rng.choice([1.0, 1 + 1e-6, 1.1, 0.8]))
        place, size = place + way / np.linalg.norm(way) * (size + other) * gap, other
    if rng.random() < 0.5:
        kind = str(rng.choice(["rectangle", "triangle", "disk", "box"]))
        at, one, two = rng.normal(size=(3, 3)) * [[1, 1, 1], [0.8, 0.8, 0.8], [0.8, 0.8, 0.8]]
        at[2] = abs(at[2]) + 0.3
        flat = {"type": kind, "name": "flat", "material": "b"}
        flat |= {
            "rectangle": {"corner": at, "edge_u": one, "edge_v": np.cross(one, two)},
            "triangle": {"vertices": np.array([at, at + one, at + two])},
            "disk": {"center": at, "normal": one / scale, "radius": 0.6},
            "box": {"center": at, "size": np.abs(two) + 0.1, "rotation": 30.0 / scale},
        }[kind]  # fmt: skip
        shapes.append({k: v if isinstance(v, str) else (np.asarray(v) * scale).tolist() for k, v in flat.items()})
    if rng.random() < 0.3:
        shapes.append(plane("b", name="wall", point=[0, 3 * scale, 0], normal=[0, -1, 0.1]))
    lamp = rng.normal(size=3) * 2 + [0, 0, 5]
    lights = [
        {
            "type": "point",
            "name": "P",
            "position": (lamp * scale).tolist(),
            "intensity": [20 * scale**2, 9 * scale**2, 0],
        },
        {"type": "directional", "name": "D", "direction": [0.3, float(rng.normal()), -1], "irradiance": [0, 1, 1]},
    ]
    eye = np.array([rng.normal(), -5, rng.uniform(0.3, 3)])
    # beside the rim of a sphere, or where it stands
    turn = rng.uniform(-1.2, 1.2) + (math.pi if rng.random() < 0.3 else 0.0)
    aim = np.array([math.sin(turn), -0.2, 1 + math.cos(turn)])
    camera = {"type": "look_at", "eye": (eye * scale).tolist(), "target": (aim * scale).tolist(), "fov": 3.0}
    return world(shapes, lights, camera=camera, materials=materials)  # fmt: skip


def sampled(arrays: RadiometricArrays, order: int, seed: int) -> tuple[Array, Array]:
    """(mean over the one pixel, its standard error) by the conventional tracer, jittered."""
    view, rng = seen(arrays, 1, 1), np.random.default_rng(seed)
    x = (np.arange(order)[None, :] + rng.random((order, order))) / order
    y = (np.arange(order)[:, None] + rng.random((order, order))) / order
    forward, right, up = view.window
    directions = (forward + (2 * x - 1)[..., None] * right + (1 - 2 * y)[..., None] * up).reshape(-1, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    emitted, direct, _, _ = numeric_rays(arrays, np.tile(view.eye, (len(directions), 1)), directions)
    values = (emitted + direct).reshape(order // 2, 2, order // 2, 2, 3)
    scatter = values.transpose(0, 2, 1, 3, 4).reshape(-1, 4, 3).var(axis=1, ddof=1).mean(axis=0)
    return values.mean(axis=(0, 1, 2, 3)), np.sqrt(scatter) / order


def test_hostile_pixels_are_those_of_the_conventional_tracer() -> None:
    judged = cut = 0
    worst = 0.0
    for seed in range(24):
        scene = crowd(np.random.default_rng(seed))
        expected, sigma = sampled(radiometric_arrays(scene), 160, seed)
        image = sr.truth(scene, size=1, tol=1e-4, filter="box", threads=1, budget=200_000)
        finer = sr.truth(scene, size=1, tol=1e-5, filter="box", threads=1, budget=200_000)
        error, value = image.layer("error")[0, 0], image.radiance[0, 0]
        judged += expected.max() > 1e-3
        cut += sigma.max() > 1e-6
        worst = max(worst, float((np.abs(value - expected) / (sigma + error / 3 + 1e-12)).max()))
        assert np.abs(value - finer.radiance[0, 0]).max() <= 1.5 * (error + finer.layer("error")[0, 0]), seed
    assert judged >= 20 and cut >= 20, (judged, cut)
    assert 0.5 < worst < 5.5


def edges(arrays: RadiometricArrays, start: Array, stop: Array, count: int) -> Array:
    """Places on a line of the image where the tracer's hit class, or whether one light is seen, changes."""
    view = seen(arrays, 1, 1)

    def label(share: Array) -> Array:
        place = start + share[:, None] * (stop - start)
        forward, right, up = view.window
        directions = forward + (2 * place[:, :1] - 1) * right + (1 - 2 * place[:, 1:]) * up
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        _, direct, _, shape = numeric_rays(arrays, np.tile(view.eye, (len(share), 1)), np.ascontiguousarray(directions))
        return shape * 2 + (direct.max(axis=1) > 0)

    share = np.linspace(0, 1, count)
    found = label(share)
    low, high = (side[found[1:] != found[:-1]] for side in (share[:-1], share[1:]))
    first = label(low) if len(low) else low
    for _ in range(45):
        middle = 0.5 * (low + high)
        same = label(middle) == first if len(low) else np.zeros(0, bool)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return start + low[:, None] * (stop - start)


def nearest_wall(arrays: RadiometricArrays, walls: Table[Wall], place: Array) -> float:
    """Distance on the image, in pixels, from a place to the nearest wall's curve, to first order."""
    forward, right, up = seen(arrays, 1, 1).window
    v = forward + (2 * place[0] - 1) * right + (1 - 2 * place[1]) * up
    curve, work, best = np.zeros(TERMS), np.zeros((8, TERMS)), math.inf
    for wall in walls:
        if put_curve(wall, tuple(v), tuple(2 * right), tuple(-2 * up), work, curve):
            slope = math.hypot(curve[5], curve[1])
            # beside a double point of a curve it is the root of the level that tells
            bent = math.sqrt(abs(curve[0])) / math.sqrt(max(1e-300, abs(curve[10]) + abs(curve[2]) + abs(curve[6])))
            best = min(best, abs(curve[0]) / max(slope, 1e-300), bent if slope < 1e-6 else math.inf)
    return best


def test_wherever_the_tracer_sees_an_edge_there_is_a_wall() -> None:
    seen_edges, far = 0, []
    for seed in range(30):
        rng = np.random.default_rng(1000 + seed)
        # the rim of a phong lobe is no edge, but dark beyond
        scene = crowd(rng, "bc")
        arrays = radiometric_arrays(scene.replace({"camera.fov": 40.0}))
        walls, _ = wall_tables(seen(arrays, 1, 1))
        for light in range(2):
            alone = radiometric_arrays(scene.replace({"camera.fov": 40.0}))
            for other in range(2):
                if other != light:
                    alone.lights[other].emitted[:] = 0
            for _ in range(4):
                start, stop = rng.random(2), rng.random(2)
                for place in edges(alone, start, stop, 300):
                    seen_edges += 1
                    gap = nearest_wall(arrays, walls, place)
                    if gap > 1e-6:
                        far.append((seed, light, place.tolist(), gap))
    assert seen_edges > 300
    assert not far, far[:3]


def test_bytes_depend_on_no_tile_and_no_thread() -> None:
    scene = crowd(np.random.default_rng(5)).replace({"camera.fov": 40.0})
    one = sr.truth(scene, size=(21, 13), tol=1e-4, filter="box", threads=1, tile=5)
    two = sr.truth(scene, size=(21, 13), tol=1e-4, filter="box", threads=2, tile=16)
    for name, layer in one.layers.items():
        np.testing.assert_array_equal(layer, two.layers[name])
    assert one.radiance.max() > 0.01
    assert json.loads(one.meta["conventions"])["filter"] == "box"
    centre = sr.truth(scene, size=(21, 13), tol=1e-4)
    assert json.loads(centre.meta["conventions"])["filter"] == "centre"
    assert np.abs(centre.radiance - one.radiance).max() > 0.01
    np.testing.assert_array_equal(centre.layer("hit_class"), one.layer("hit_class"))


def test_a_checker_to_the_horizon_is_finite_and_stated() -> None:
    tiles = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 1, "dark": 0, "cell": 0.5}}
    camera = {"type": "look_at", "eye": [0.1, 0, 1], "target": [0.3, 5, 1.005], "fov": 1}
    scene = world([plane("tiles")], [SUN], camera=camera, materials={"tiles": tiles})
    image = sr.truth(scene, size=2, tol=1e-4, filter="box", budget=40_000)
    expected, sigma = sampled(radiometric_arrays(scene), 1024, 1)
    stated = image.layer("error").mean()
    value = image.radiance.mean(axis=(0, 1))
    assert 1e-5 < stated < 0.1 and expected[0] > 0.1
    assert (np.abs(value - expected) <= 1.5 * stated + 5 * sigma).all()


def test_what_has_no_walls_is_refused_by_name() -> None:
    walter = {"type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.3, "eta": 1, "k": 2}
    with pytest.raises(Unsupported, match="filter: box has no walls yet for beckmann with g1: walter"):
        sr.truth(world([plane("m")], [SUN], materials={"m": walter}), size=1, filter="box", method="quadrature")
    with pytest.raises(Unsupported, match="phong exponent below 4"):
        sr.truth(
            world([plane("m")], [SUN], materials={"m": {"type": "phong", "exponent": 1}}),
            size=1,
            filter="box",
            method="quadrature",
        )
    fine = {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.001}}
    with pytest.raises(Unsupported, match="more than 256 fields about a sphere"):
        sr.truth(
            world([ball("A", [0, 0, 0], 1, "m")], [SUN], materials={"m": fine}),
            size=1,
            filter="box",
            method="quadrature",
        )
    with pytest.raises(Unsupported, match="filter: box has no walls yet for what mirrors show"):
        sr.truth("mirror", size=1, filter="box", method="quadrature")
    with pytest.raises(OptionError, match="filter: must be one of centre, box, tent, gaussian, mitchell"):
        sr.truth("metal", size=1, filter="sinc")  # type: ignore[arg-type]


def test_a_highlight_beside_a_limb_is_seen() -> None:
    # lit from behind: a five-hundredth of the pixel wide, and no corner of a cell about it lies on the ball
    scene = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {
            "type": "look_at", "eye": [-0.30691711504142305, -5.596558989448318, 0.976178153390397],
            "target": [-0.21540456984914255, -3.9278499721162947, 0.976178153390397], "up": [0.1, 0.2, 1],
            "fov": 4.12525526554044,
        },
        "materials": {"gloss": {"type": "phong", "exponent": 1000, "reflectance": 0.5}},
        "shapes": [
            {"type": "sphere", "name": "ball", "center": [0.1554186909665534, -0.3202907183916027, 1.0980254425747675],
             "radius": 0.04260128961937144, "material": "gloss"},
        ],
        "lights": [{"type": "point", "name": "P", "position": [-3.078713114454576, 3.6759033426440424, 6.5754190504387],
                    "intensity": 13.964821652263883}],
    })  # fmt: skip
    whole = sr.truth(scene, size=1, tol=1e-6, filter="box", threads=1, tile=1)
    parts = sr.truth(scene, size=48, tol=1e-6, filter="box", threads=1)
    expected = parts.radiance.mean(axis=(0, 1))
    assert expected.max() > 1e-4 and (parts.radiance > 1e-3).any(axis=2).sum() > 1
    assert np.abs(whole.radiance[0, 0] - expected).max() <= 1.5 * float(whole.layer("error")[0, 0]) + 1e-6


def veined(target: tuple[float, float, float]) -> RadiometricScene:
    """One pixel that sees about a vein and a half of a ball."""
    made = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0.5, -5, 1], "target": list(target), "up": [0.1, 0.2, 1], "fov": 4},
        "materials": {"marble": {"type": "diffuse", "reflectance": {
            "type": "marble", "cell": 0.25, "bright": 0.8, "dark": [0.1, 0, 0.3]}}},
        "shapes": [{"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": 1, "material": "marble"}],
        "lights": [{"type": "directional", "name": "sun", "direction": [0.4, 1, -0.5], "irradiance": 3.0}],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def test_veins_that_few_nodes_do_not_tell_are_stated() -> None:
    rng, met = np.random.default_rng(4), 0
    for _ in range(60):
        x, z = rng.uniform(-0.5, 0.5, 2)
        scene = veined((float(x), -1.0, float(z)))
        rough, fine = (sr.truth(scene, size=1, tol=tol, filter="box", threads=1, tile=1) for tol in (1e-2, 1e-7))
        stated, rest = (float(image.layer("error")[0, 0]) for image in (rough, fine))
        assert fine.radiance.max() > 0.05 and rest <= 1e-7
        met += stated <= 1e-2
        assert np.abs(rough.radiance - fine.radiance).max() <= 1.5 * stated + rest
    assert met == 60
