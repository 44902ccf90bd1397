"""Cylinders: hits against roots in 40 digits, lamps and wells against closed forms and quadrature."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.numeric.radiometric.hits import first_hit
from symrender.numeric.radiometric.world import World, make_world
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

Vector = tuple[float, float, float]
CAMERA = {"type": "look_at", "eye": [0, 0, 0.5], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 1}
FLOOR = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "white"}
BLACK = {"type": "diffuse", "reflectance": 0}


def scene(shape: dict[str, Any], *others: dict[str, Any], **fields: Any) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "cylinder", "bounces": 0, "camera": CAMERA,
        "materials": {"white": {"type": "diffuse", "reflectance": 1}, "black": BLACK},
        "shapes": [{"type": "cylinder", "name": "can", "material": "black"} | shape, *others], "lights": [],
    } | fields  # fmt: skip


def world_of(shape: dict[str, Any]) -> World:
    loaded = load_any(scene(shape))
    assert isinstance(loaded, RadiometricScene)
    return make_world(radiometric_arrays(loaded))


def inner(a: Any, b: Any) -> Any:
    return sum(a[k] * b[k] for k in range(3))


def exact_roots(shape: dict[str, Any], origin: Vector, d: Vector) -> list[tuple[Any, Any, Any]]:
    """(distance, its part: 0 side, 1 base, 2 top, by how little it is a hit) of all that a ray meets, in 40 digits."""
    base, axis, o, w = (mp.matrix([mp.mpf(float(x)) for x in v]) for v in (shape["base"], shape["axis"], origin, d))
    height, radius = mp.sqrt(inner(axis, axis)), mp.mpf(shape["radius"])
    up, f = axis / height, o - base
    z, slope = inner(f, up), inner(w, up)
    p, q = f - z * up, w - slope * up
    a, b, c = inner(q, q), inner(p, q), inner(p, p) - radius**2
    found = []
    if b * b - a * c > 0:
        for sign in (-1, 1):
            t = (-b + sign * mp.sqrt(b * b - a * c)) / a
            level = z + t * slope
            if t > 0 and 0 <= level <= height:
                found.append((t, 0, min(level, height - level, t)))
    for part, level in ((1, mp.mpf(0)), (2, height)) if shape["caps"] else ():
        t = (level - z) / slope
        place = p + t * q
        away = mp.sqrt(inner(place, place))
        if t > 0 and away <= radius:
            found.append((t, part, min(radius - away, t)))
    return sorted(found)


def drawn(rng: np.random.Generator) -> dict[str, Any]:
    return {
        "base": rng.normal(size=3).tolist(), "axis": (rng.normal(size=3) * 10.0 ** rng.uniform(-2, 1)).tolist(),
        "radius": float(10.0 ** rng.uniform(-2, 0.5)), "caps": bool(rng.random() < 0.5),
    }  # fmt: skip


def test_hits_are_roots_of_the_quadratic_in_forty_digits() -> None:
    rng = np.random.default_rng(3)
    met = {0: 0, 1: 0, 2: 0}
    missed = within = 0
    with mp.workdps(40):
        for _ in range(80):
            shape = drawn(rng)
            world = world_of(shape)
            middle = np.array(shape["base"]) + 0.5 * np.array(shape["axis"])
            size = float(np.hypot(shape["radius"], np.linalg.norm(shape["axis"])))
            for _ in range(10):
                away = rng.normal(size=3) * size * 10.0 ** rng.uniform(-1.5, 2)
                target = middle + rng.normal(size=3) * size * 0.4
                origin = middle + away
                way = target - origin
                o = (float(origin[0]), float(origin[1]), float(origin[2]))
                way /= np.linalg.norm(way)
                d = (float(way[0]), float(way[1]), float(way[2]))
                exact = exact_roots(shape, o, d)
                hit = first_hit(world, o, d, -1, -1, False)
                if any(margin < 1e-9 * size for _, _, margin in exact):
                    continue
                assert (hit.own == 0) == bool(exact)
                if not exact:
                    missed += 1
                    continue
                t, part, _ = exact[0]
                met[part] += 1
                within += hit.behind
                # a grazing root is as sharp as the square root of roundings
                place = np.array(o) + float(t) * way
                assert np.abs(np.array(hit.place) - place).max() < 1e-6 * size + 1e-13 * float(t)
                assert abs(hit.distance - float(t)) < 1e-6 * size
                assert {0: -1, 1: -2, 2: -3}[part] == hit.face
                assert abs(np.linalg.norm(hit.outward) - 1.0) < 1e-14
                assert hit.behind == (np.dot(hit.outward, way) > 0.0)
    assert min(met.values()) > 25 and missed > 100 and within > 40, (met, missed, within)


def test_a_ray_that_leaves_a_cylinder_meets_it_again_from_inside_alone() -> None:
    rng = np.random.default_rng(5)
    again_met = outer = through = 0
    with mp.workdps(40):
        for _ in range(60):
            shape = drawn(rng)
            world, size = world_of(shape), float(np.hypot(shape["radius"], np.linalg.norm(shape["axis"])))
            middle = np.array(shape["base"]) + 0.5 * np.array(shape["axis"])
            for _ in range(12):
                origin = middle + rng.normal(size=3) * 3.0 * size
                way = middle + rng.normal(size=3) * 0.3 * size - origin
                way /= np.linalg.norm(way)
                hit = first_hit(world, tuple(origin.tolist()), tuple(way.tolist()), -1, -1, False)
                if hit.own < 0:
                    continue
                turn = rng.normal(size=3)
                turn /= np.linalg.norm(turn)
                inside = bool(np.dot(turn, hit.outward) < 0.0)
                d = (float(turn[0]), float(turn[1]), float(turn[2]))
                again = first_hit(world, hit.place, d, hit.own, hit.face, inside)
                if not inside:
                    outer += 1
                    assert again.own < 0
                    continue
                exact = [root for root in exact_roots(shape, hit.place, d) if root[0] > 1e-7 * size]
                if any(root[2] < 1e-6 * size for root in exact):
                    continue
                assert (again.own == 0) == bool(exact)
                if exact:
                    again_met += 1
                    assert abs(again.distance - float(exact[0][0])) < 1e-7 * size and again.behind
                else:
                    through += 1
    assert again_met > 80 and outer > 80 and through > 10, (again_met, outer, through)


def test_a_well_shows_the_sky_through_its_mouth() -> None:
    """The floor of a black well of radius R and depth h: rho L R^2/(R^2 + h^2) at its centre."""
    radius, depth = 0.4, 0.7
    sky = {"type": "sky", "name": "sky", "radiance": [1, 2, 3]}
    well = scene({"base": [0, 0, 0], "axis": [0, 0, depth], "radius": radius}, FLOOR, lights=[sky])
    image = sr.truth(well, size=1, tol=5e-3, budget=3_000_000, threads=1)
    wanted = np.array([1.0, 2.0, 3.0]) * radius**2 / (radius**2 + depth**2)
    assert np.abs(image.radiance[0, 0] - wanted).max() <= image.layer("error")[0, 0] < 0.05
    assert "cylinder" in image.meta["providers"]


@pytest.mark.parametrize("caps", [False, True])
def test_a_lamp_lights_a_place_as_its_area_integral_says(caps: bool) -> None:
    base, axis, radius = np.array([0.6, 0.3, 0.5]), np.array([-0.9, 0.4, 0.3]), 0.3
    shape = {"base": base.tolist(), "axis": axis.tolist(), "radius": radius, "caps": caps}
    lamp = {"type": "area", "name": "lamp", "shape": "can", "radiance": 2}
    image = sr.truth(scene(shape, FLOOR, lights=[lamp]), size=1, tol=2e-3, budget=3_000_000, threads=1)
    height = np.linalg.norm(axis)
    up = axis / height
    east = np.cross(up, [0.3, 1.0, 0.2])
    east /= np.linalg.norm(east)
    north = np.cross(up, east)
    count = 1200
    u = (np.arange(count) + 0.5) / count
    normals = np.cos(2 * np.pi * u)[:, None] * east + np.sin(2 * np.pi * u)[:, None] * north
    total = 0.0

    def add(places: Any, outward: Any, area: Any) -> None:
        nonlocal total
        far = np.linalg.norm(places, axis=-1)
        above, facing = places[..., 2] / far, -(places * outward).sum(axis=-1) / far
        total += float(area) * float((np.maximum(above, 0.0) * np.maximum(facing, 0.0) / far**2).mean())

    side = base + u[:, None, None] * axis + radius * normals
    add(side, np.broadcast_to(normals, side.shape), 2 * np.pi * radius * height)
    for level, sign in ((0.0, -1.0), (1.0, 1.0)) if caps else ():
        disk = base + level * axis + radius * np.sqrt(u)[:, None, None] * normals
        add(disk, np.broadcast_to(sign * up, disk.shape), np.pi * radius**2)
    wanted = 2.0 * total / math.pi
    assert wanted > 0.1
    assert abs(image.radiance[0, 0, 0] - wanted) <= image.layer("error")[0, 0] + 1e-4 * wanted
    assert image.layer("error")[0, 0] < 0.02 * wanted


def test_a_long_lamp_lights_what_faces_it_as_an_endless_one() -> None:
    """pi L R/d of irradiance on what faces an endless cylinder at the distance d of its axis."""
    lamp = {"type": "area", "name": "lamp", "shape": "can", "radiance": 1}
    shape = {"base": [-400, 0, 1.0], "axis": [800, 0, 0], "radius": 0.25}
    image = sr.truth(scene(shape, FLOOR, lights=[lamp]), size=1, tol=5e-3, budget=10_000_000, threads=1)
    assert abs(image.radiance[0, 0, 0] - 0.25) <= image.layer("error")[0, 0] + 1e-6
    assert image.layer("error")[0, 0] < 0.02


def test_its_texture_goes_about_the_axis() -> None:
    stripes = {"type": "diffuse", "reflectance": {"type": "stripes", "bright": 1, "dark": 0, "cell": 0.25}}
    shape = {"base": [0, 0, -1], "axis": [0, 0, 2], "radius": 1.0, "material": "white"}
    camera = {"type": "look_at", "fov": 1}
    seen = []
    for k in range(8):
        turn = (k + 0.5) * math.pi / 4.0
        eye = [4.0 * math.cos(turn), 4.0 * math.sin(turn), 0.0]
        sun = {"type": "directional", "name": "sun", "direction": [-x for x in eye], "irradiance": math.pi}
        made = scene(
            shape, lights=[sun], camera=camera | {"eye": eye, "target": [0, 0, 0]}, materials={"white": stripes}
        )
        made["materials"]["black"] = BLACK
        seen.append(round(float(sr.truth(made, size=1, tol=0.1, budget=1000, threads=1).radiance[0, 0, 0])))
    # a half turn and k + 1/2 eighths of a turn, in quarters of a half turn
    assert seen == [
        1 - int((math.pi + (k + 0.5) * math.pi / 4.0) % (2.0 * math.pi) / math.pi / 0.25) % 2 for k in range(8)
    ]


def test_faults_are_named() -> None:
    with pytest.raises(SceneError, match="axis must be longer than zero"):
        load_any(scene({"base": [0, 0, 0], "axis": [0, 0, 0], "radius": 1}))
    with pytest.raises(SceneError, match="along must not be parallel to axis"):
        load_any(scene({"base": [0, 0, 0], "axis": [0, 0, 2], "radius": 1, "along": [0, 0, 1]}))
    made = scene({"base": [0, 0, 0], "axis": [0, 0, 2], "radius": 1})
    with pytest.raises(Unsupported, match="a cylinder is not integrated by quadrature"):
        sr.truth(made, size=1, method="quadrature")
