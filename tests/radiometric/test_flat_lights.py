"""Skies and lamps among flat shapes: form factors, meridians, 50 digits, derivatives, the path tracer."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats, many_digits, meridians

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.world import seen
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.moves import radiometric_moves

FLOOR = flats.plane("floor", [0, 0, 0], [0, 0, 1])


def share(world: dict[str, Any], place: Any, normal: Any = (0, 0, 1), own: str = "floor") -> float:
    """E/pi of a place for radiance 1."""
    at, n = np.array(place, float), np.array(normal, float)
    found = sr.probe(world, rays=(at + 1e-6 * n, -n), tol=1e-6)
    assert found.shape == (f"shapes.{own}",)
    return float(found.direct[0, 0])


def parallel(a: float, b: float, c: float) -> float:
    """Form factor of a rectangle a x b at height c, from an element below its corner, parallel to it (Howell, B-3)."""
    x, y = a / c, b / c
    one, two = math.sqrt(1 + x * x), math.sqrt(1 + y * y)
    return (x / one * math.atan(y / one) + y / two * math.atan(x / two)) / (2 * math.pi)


def upright(high: float, wide: float, far: float) -> float:
    """The same of one that stands at a right angle to the element, its lower corner straight ahead (Howell, B-4)."""
    x, y = high / wide, far / wide
    root = math.hypot(x, y)
    return (math.atan(1 / y) - y / root * math.atan(1 / root)) / (2 * math.pi)


@pytest.mark.parametrize("size", [(1.0, 2.0, 0.5), (3.0, 0.2, 1.7), (1e-3, 1e-3, 1.0), (40.0, 30.0, 0.1)])
def test_rectangles_are_their_form_factors(size: tuple[float, float, float]) -> None:
    a, b, c = size
    above = flats.rectangle("lamp", [0, 0, c], [0, b, 0], [a, 0, 0])
    expected = parallel(a, b, c)
    assert 1e-8 < expected < 0.25
    assert share(flats.world(FLOOR, above, lights=[flats.area("lamp")]), [0, 0, 0]) == pytest.approx(
        expected, rel=1e-12, abs=1e-15
    )
    wall = flats.rectangle("lamp", [0, c, 0], [a, 0, 0], [0, 0, b])
    standing = upright(b, a, c)
    assert share(flats.world(FLOOR, wall, lights=[flats.area("lamp")]), [0, 0, 0]) == pytest.approx(
        standing, rel=1e-12, abs=1e-15
    )
    # behind its normal a lamp is black, and hides the sky like any wall
    back = flats.rectangle("lamp", [0, 0, c], [a, 0, 0], [0, b, 0])
    assert share(flats.world(FLOOR, back, lights=[flats.area("lamp")]), [0, 0, 0]) == 0.0
    assert share(flats.world(FLOOR, back, lights=[flats.SKY]), [0, 0, 0]) == pytest.approx(1.0 - expected, abs=1e-14)


def test_parts_of_a_lamp_add_up_and_fans_are_rectangles() -> None:
    whole = flats.rectangle("lamp", [-0.5, -0.4, 1], [0, 1, 0], [1.2, 0, 0])
    hidden = flats.box("B", [0.2, 0.3, 0.4], [0.4, 0.3, 0.2], 20)
    ball = flats.ball("S", [-0.3, 0.1, 0.4], 0.15)
    place = [0.05, -0.1, 0]
    expected = share(flats.world(FLOOR, whole, hidden, ball, lights=[flats.area("lamp")]), place)
    a, b, c, d = np.array([[-0.5, -0.4, 1], [-0.5, 0.6, 1], [0.7, 0.6, 1], [0.7, -0.4, 1]])
    first, second = flats.triangle("one", [a, b, c]), flats.triangle("two", [a, c, d])
    lamps = [flats.area("one"), flats.area("two", name="M")]
    found = share(flats.world(FLOOR, first, second, hidden, ball, lights=lamps), place)
    assert 0.02 < expected < 0.3 and found == pytest.approx(expected, rel=1e-13)


def test_a_box_in_the_sky_is_its_three_faces() -> None:
    box = flats.box("B", [1.2, 0.4, 0.7], [0.6, 0.8, 1.0], 25)
    dark = share(flats.world(FLOOR, box, lights=[flats.SKY]), [0, 0, 0])
    lit = share(flats.world(FLOOR, box, lights=[flats.area("B")]), [0, 0, 0])
    assert 0.02 < lit < 0.5 and dark == pytest.approx(1.0 - lit, abs=1e-14)


def test_inside_a_lit_box_all_that_is_not_dark_is_light() -> None:
    """Six rectangles that share their edges, each a lamp: an element inside sees light alone, E = pi L."""
    lamps = [
        ("x0", [0, 0, 0], [0, 1, 0], [0, 0, 1]), ("x1", [1, 0, 0], [0, 0, 1], [0, 1, 0]),
        ("y0", [0, 0, 0], [0, 0, 1], [1, 0, 0]), ("y1", [0, 1, 0], [1, 0, 0], [0, 0, 1]),
        ("z1", [0, 0, 1], [0, 1, 0], [1, 0, 0]),
    ]  # fmt: skip
    walls = [flats.rectangle(*lamp) for lamp in lamps]
    own = flats.rectangle("floor", [0, 0, 0], [1, 0, 0], [0, 1, 0])
    lights = [flats.area(lamp[0], name=f"L{lamp[0]}") for lamp in lamps]
    for place in ([0.3, 0.4, 0], [0.5, 0.5, 0], [1e-6, 1e-7, 0], [0.999999, 0.5, 0]):
        assert share(flats.world(own, *walls, lights=lights), place) == pytest.approx(1.0, abs=1e-9)
        assert share(flats.world(own, *walls, lights=[flats.SKY]), place) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("scale", [1.0, 119.79625017903811])
def test_meridians_see_no_light_where_a_ball_touches_the_place(scale: float) -> None:
    """Whatever way its radius is rounded; and all of the light if it is the ball that emits."""
    up = np.array([0.0, 0.0, 1.0])
    offset = scale * np.array([0.3, -0.7, -6.1])
    for step in range(-2, 3):
        radius = 0.5 * scale * (1.0 + step * 2.0**-52)
        shapes = [flats.plane("floor", offset, up), flats.ball("ball", offset + 0.5 * scale * up, radius)]
        assert meridians.irradiance(shapes, "floor", offset, up, None)[0] == 0.0
        assert meridians.irradiance(shapes, "floor", offset, up, "ball")[0] == pytest.approx(math.pi, rel=1e-12)
        beside = offset + 1e-3 * scale * np.array([1.0, 0.0, 0.0])
        assert 0.0 < meridians.irradiance(shapes, "floor", beside, up, None)[0] < 1e-4


def test_hostile_contacts_are_what_meridians_see() -> None:
    judged = lit = met = sharp = 0
    for seed in range(20_000, 20_025):
        scene, own, place, normal, lamp = flats.contact(seed)
        size = max(abs(place).max(), 1e-4)
        try:
            found = sr.probe(scene, rays=(place + 1e-7 * size * normal, -normal), tol=1e-6)
        except Unsupported:
            continue
        if found.shape[0] != f"shapes.{own}":
            continue
        true, known = (x / math.pi for x in meridians.irradiance(scene["shapes"], own, place, normal, lamp))
        assert known < 1e-4 and abs(found.direct[0, 0] - true) <= 1.5 * found.error[0] + known + 1e-9, seed
        sharp += known < 1e-9
        judged, lit, met = judged + 1, lit + (true > 1e-6), met + (found.status[0] == 0)
    assert judged > 18 and lit > 7 and met > 12 and sharp > 12


def pixel(seed: int) -> Any:
    """A hostile contact seen by one pixel."""
    scene, _, place, normal, _ = flats.contact(seed)
    scale = max(abs(place).max(), 1e-3)
    eye = place + scale * (normal + np.array([0.3, 0.2, 0.0]))
    camera = {"type": "look_at", "eye": eye.tolist(), "target": place.tolist(), "up": [0, 1, 0], "fov": 1.0}
    return sr.load(scene | {"camera": camera})


def test_roundings_are_stated() -> None:
    lit = lost = 0
    for seed in range(80):
        scene = pixel(seed)
        try:
            image = sr.truth(scene, size=1, method="quadrature")
        except Unsupported:
            continue
        arrays = radiometric_arrays(scene)
        (move,) = radiometric_moves(scene, ["camera.fov"])
        exact, _, _ = many_digits.value_and_slope(seen(arrays, 1, 1), seen_moves(arrays, move, 1, 1))
        off = max(abs(float(a - b)) for a, b in zip(exact, image.radiance[0, 0], strict=True))
        light = float(image.radiance.max())
        lit, lost = lit + (light > 0.0), lost + (off > 1e-15 * light > 0.0)
        assert off <= image.layer("error")[0, 0], seed
    assert lit > 25 and lost > 5


def test_the_path_tracer_finds_the_same() -> None:
    z = []
    for seed, kind in enumerate(("rectangle", "triangle", "box", "sphere", "sky")):
        rng = np.random.default_rng(seed + 3)
        shapes = [flats.plane("floor", [0, 0, -2.5], [0, 0, 1])]
        shapes += [flats.one_of(rng, k, k, "both") for k in ("rectangle", "triangle", "box", "sphere")]
        if kind != "sky":
            shapes.append(flats.one_of(rng, kind, "lamp", "white"))
        scene = sr.load(flats.world(*shapes, lights=[flats.SKY if kind == "sky" else flats.area("lamp")]))
        origins, directions = rng.uniform(-2, 2, (60, 3)), rng.normal(size=(60, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        true = sr.probe(scene, rays=(origins, directions), tol=1e-6)
        arrays = radiometric_arrays(scene)
        seeds = [numeric_rays(arrays, origins, directions, order=20, seed=s)[1][:, 0] for s in range(8)]
        error = np.std(seeds, axis=0, ddof=1) / math.sqrt(8)
        off, noisy = np.mean(seeds, axis=0) - true.direct[:, 0], error > 1e-6
        assert (np.abs(off) < 7 * error + 1e-3).all(), kind
        z += list(off[noisy] / error[noisy])
    assert len(z) > 60 and abs(float(np.mean(z))) < 0.5 and float(np.std(z)) < 1.6


MOVED = (
    "rectangle.edge_u.x", "rectangle.corner.z", "triangle.vertices[1].y", "box.size.z", "box.rotation", "box.center.x",
    "lamp.corner.z", "lamp.edge_v.x", "sphere.radius",
)  # fmt: skip


def test_derivatives_are_those_of_differences() -> None:
    acting: set[str] = set()
    checked = 0
    for seed in range(4):
        rng = np.random.default_rng(seed)
        kinds = ("rectangle", "triangle", "box", "sphere")
        shapes = [flats.plane("floor", [0, 0, -1.5], [0, 0, 1])]
        shapes += [flats.one_of(rng, k, k, "both", 1.0) for k in kinds]
        lights: list[dict[str, Any]] = [flats.SKY]
        if seed % 2:
            shapes.append(flats.rectangle("lamp", [-1, -1, 2.5], [0.2, 2, 0], [2, 0, 0.3]))
            lights = [flats.area("lamp")]
        scene = sr.load(flats.world(*shapes, lights=lights))
        names = [f"shapes.{name}" for name in MOVED if seed % 2 or not name.startswith("lamp")]
        slopes = sr.gradient(scene, names, size=(4, 3))
        for name in names:
            slope = slopes[name].layer("direct")
            if np.abs(slope).max() < 1e-3:
                continue
            value, step = float(get(scene, name)), 1e-5
            images = [sr.truth(scene.replace({name: value + k * step}), size=(4, 3)) for k in (2, 1, -1, -2)]
            a, b, c, d = (image.layer("direct") for image in images)
            difference = (8.0 * (b - c) - (a - d)) / (12.0 * step)
            classes = [image.layer("hit_class") for image in images]
            steady = np.all([np.equal(one, classes[0]) for one in classes], axis=0) & (
                slopes[name].layer("status") == 0
            )
            # the error of the difference where an outline passes an edge, as where it bends, is left out
            smooth = np.abs((b - c) / (2 * step) - (a - d) / (4 * step)).max(axis=2) < 1e-6
            off = np.abs(difference - slope).max(axis=2)[steady & smooth]
            assert (off < 1e-7 * max(1.0, np.abs(slope).max())).all(), (seed, name)
            checked += int((steady & smooth & (np.abs(slope).max(axis=2) > 1e-4)).sum())
            acting.add(name.split(".", 1)[1])
    assert checked > 100 and len(acting) > 6 and any(name.startswith("lamp") for name in acting), acting


def test_a_sphere_through_a_lamp_is_refused() -> None:
    lamp = flats.rectangle("lamp", [-1, -1, 1], [0, 2, 0], [2, 0, 0])
    through = flats.world(FLOOR, lamp, flats.ball("S", [0.9, 0, 1.2], 0.4), lights=[flats.area("lamp")])
    with pytest.raises(Unsupported, match=r"lights\[0\]: its shape, shapes\[1\], crosses shapes\[2\]"):
        sr.truth(through, size=2, method="quadrature")
    beside = flats.world(FLOOR, lamp, flats.ball("S", [1.6, 0, 1.2], 0.4), lights=[flats.area("lamp")])
    assert sr.truth(beside, size=2).layer("status").max() == 0
    box = flats.world(FLOOR, flats.box("lamp", [0, 0, 1], [1, 1, 1]), flats.ball("S", [0, 0, 1], 0.6),
                      lights=[flats.area("lamp")])  # fmt: skip
    with pytest.raises(Unsupported, match="crosses"):
        sr.truth(box, size=2, method="quadrature")


def test_under_the_face_of_a_lamp_that_lies_on_a_floor_all_is_dark_whichever_is_above() -> None:
    """The ray begins in the lamp: it meets the face from behind, or a floor that is in the lamp with it."""
    floor = flats.rectangle("floor", [-1, -1, 0.3], [2, 0, 0], [0, 2, 0], "both")
    shapes, dark = [], 0
    for gap in (-1e-7, -1e-13, 0.0, 1e-13, 1e-7, 2e-3):
        lamp = flats.box("lamp", [0.1, 0.2, 0.8 + gap], [0.5, 0.6, 1.0], 30.0)
        scene = flats.world(floor, lamp, lights=[flats.area("lamp")])
        seen = sr.probe(scene, rays=([0.15, 0.25, 0.301], [0, 0, -1]), tol=1e-6)
        shapes.append(seen.shape[0])
        if gap > 1e-3:
            # the ray begins below the lamp, which all but touches the floor
            assert seen.direct[0, 0] > 0.99 and seen.status[0] == 0
            continue
        dark += int(seen.radiance.max() + seen.error[0] < 1e-12 and seen.status[0] == 0)
    assert dark == 5 and set(shapes) == {"shapes.floor", "shapes.lamp"}
