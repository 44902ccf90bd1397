"""Disks under a sky, before lamps and as lamps: form factors, meridians, the rim against quadrature, derivatives."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats, meridians, rounds

import symrender as sr
from symrender.expression.formulas.polygons import rim_flux
from symrender.expression.vectors import Vec3
from symrender.radiometric.arcs import make_room, put_circle, put_rim
from symrender.radiometric.conics import cross_conic, curve_place, level_in
from symrender.scene.parameters import get

ABOVE = np.array([0.0, 0.0, 1e-6])
FLOOR = flats.plane("floor", [0, 0, 0], [0, 0, 1])


def share(world: dict[str, Any], place: Any) -> float:
    """E/pi of a place of the floor for radiance 1."""
    at = np.array(place, float)
    found = sr.probe(world, rays=(at + ABOVE, [0, 0, -1]), tol=1e-6)
    assert found.shape == ("shapes.floor",)
    return float(found.direct[0, 0])


def beside(r: float, h: float, a: float) -> float:
    """Form factor of a disk of radius r at height h, parallel to the element, its axis a beside it (Howell, B-13)."""
    z = 1 + (h / a) ** 2 + (r / a) ** 2
    return 0.5 * (1 - (1 + (h / a) ** 2 - (r / a) ** 2) / math.sqrt(z * z - 4 * (r / a) ** 2))


def assert_slopes_are_differences(scene: Any, names: list[str]) -> None:
    """That direct light has the derivatives that central differences have, where no pixel changes what it meets."""
    slopes = sr.gradient(scene, names, size=(8, 6))
    for name in names:
        slope, value, step = slopes[name].layer("direct"), float(get(scene, name)), 1e-5
        high, low = (sr.truth(scene.replace({name: value + s}), size=(8, 6)) for s in (step, -step))
        steady = (high.layer("hit_class") == low.layer("hit_class")) & (slopes[name].layer("status") == 0)
        off = np.abs((high.layer("direct") - low.layer("direct")) / (2 * step) - slope).max(axis=2)[steady]
        assert np.abs(slope).max() > 1e-3 and steady.sum() > 10, name
        assert (off < 1e-6).mean() > 0.9, (name, off.max())


@pytest.mark.parametrize("radius", [2.0, 0.5, 1e-3, 1e-5])
def test_disks_are_their_form_factors(radius: float) -> None:
    for height in (0.2, 1.0, 30.0):
        lamp = flats.disk("lamp", [0, 0, height], [0, 0, -1], radius)
        expected = radius**2 / (radius**2 + height**2)
        found = share(flats.world(FLOOR, lamp, lights=[flats.area("lamp")]), [0, 0, 0])
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)
        dark = share(flats.world(FLOOR, lamp, lights=[flats.SKY]), [0, 0, 0])
        assert dark == pytest.approx(1.0 - expected, abs=1e-14)
        # for small disks the textbook's own form cancels
        aside = share(flats.world(FLOOR, lamp, lights=[flats.area("lamp")]), [0.7, 0, 0])
        assert aside == pytest.approx(beside(radius, height, 0.7), abs=1e-14, rel=1e-12)


def test_a_rim_is_its_contour_integral() -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        radius = 10.0 ** rng.uniform(-4, 1)
        middle = rng.normal(size=3) if seed % 4 else axes[2] * rng.uniform(0.1, 3)
        first, second = radius * axes[0], radius * axes[1]
        begin, span = rng.uniform(-4, 4), rng.uniform(0.1, 6.2)
        nodes, weights = np.polynomial.legendre.leggauss(20)
        pieces = np.linspace(begin, begin + span, 401)
        t = (0.5 * (pieces[1:] + pieces[:-1])[:, None] + 0.5 * span / 400 * nodes).ravel()
        q = middle + np.cos(t)[:, None] * first + np.sin(t)[:, None] * second
        way = np.cos(t)[:, None] * second - np.sin(t)[:, None] * first
        scale = np.tile(0.5 * span / 400 * weights, 400) / (q**2).sum(axis=1)
        expected = (np.cross(q, way) * scale[:, None]).sum(axis=0)
        found = rim_flux(Vec3(*middle), Vec3(*first), Vec3(*second), begin, begin + span, span).parts
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max())


def test_crowds_are_what_meridians_see() -> None:
    judged = lit = 0
    for seed in range(2):
        for kind in ("sky", "disk", "rectangle"):
            rng = np.random.default_rng([seed, 7])
            floor = flats.plane("floor", [0, 0, -2.5], [0, 0, 1])
            shapes = [floor, *(flats.one_of(rng, k, k, "white") for k in ("rectangle", "box"))]
            shapes.append(flats.disk("lamp" if kind == "disk" else "D", rng.uniform(-1, 1, 3), [0.3, 0.2, -1], 1.3))
            if kind == "rectangle":
                shapes.append(flats.rectangle("lamp", [-1, -1, 2], [0, 2, 0.5], [2, 0, 0]))
            world = flats.world(*shapes, lights=[flats.SKY if kind == "sky" else flats.area("lamp")])
            place = np.array([*rng.uniform(-1.5, 1.5, 2), -2.5])
            found = sr.probe(world, rays=(place + ABOVE, [0, 0, -1]), tol=1e-6)
            lamp = None if kind == "sky" else "lamp"
            true, known = (
                x / math.pi for x in meridians.irradiance(shapes, "floor", place, np.array([0, 0, 1.0]), lamp)
            )
            assert found.shape == ("shapes.floor",) and known < 1e-5
            assert abs(found.direct[0, 0] - true) <= 1.5 * found.error[0] + known + 1e-8, (seed, kind)
            judged, lit = judged + 1, lit + (true > 1e-4)
    assert judged == 6 and lit > 3


def test_derivatives_are_those_of_differences() -> None:
    shapes = [
        FLOOR,
        flats.disk("lamp", [0.2, 0.1, 2], [0.1, 0.2, -1], 0.7),
        flats.box("B", [0.3, 0.4, 0.8], [0.4, 0.5, 0.2]),
    ]
    scene = sr.load(flats.world(*shapes, lights=[flats.area("lamp")]))
    names = [
        "shapes.lamp.radius",
        "shapes.lamp.normal.x",
        "shapes.B.size.x",
    ]
    assert_slopes_are_differences(scene, names)


@pytest.mark.parametrize("seed", [1, 10, 23, 31])
def test_disks_among_round_shapes_are_what_meridians_see(seed: int) -> None:
    """Rims that touch, coincide, lie on balls and in each other's outline; 72 more by a benchmark of this judge."""
    scene, place, lamp = rounds.scene(seed)
    found = sr.probe(scene, rays=(place + 1e-7 * abs(place[2]) * np.array([0, 0, 1.0]), [0, 0, -1]), tol=1e-6)
    true, known = (
        x / math.pi for x in meridians.irradiance(scene["shapes"], "floor", place, np.array([0, 0, 1.0]), lamp)
    )
    assert found.shape == ("shapes.floor",) and true > 1e-3 and known < 1e-8 and found.status[0] == 0
    assert abs(found.direct[0, 0] - true) <= 1.5 * found.error[0] + known + 1e-9


def test_what_lies_in_the_outline_of_a_round_shape_hides_nothing_more() -> None:
    """A disk's shadow, its back, a rim in a ball's circle; what is apart adds up."""
    at = np.array([0.3, -0.2, 0])
    n = np.array([0.2, 0.3, -1.0])
    one = flats.disk("A", [0.5, 0.1, 1.5], n, 0.6)
    shadow = flats.disk("E", at + 2.0 * (np.array([0.5, 0.1, 1.5]) - at), n, 1.2)
    back = flats.disk("E", [0.5, 0.1, 1.5], -n, 0.6)
    ball = flats.ball("B", [-1.0, 0.4, 1.2], 0.5)
    way = np.array([-1.0, 0.4, 1.2]) - at
    far = float(np.linalg.norm(way))
    circle = flats.disk("C", at + (1 - (0.5 / far) ** 2) * way, way, 0.5 * math.sqrt(1 - (0.5 / far) ** 2))

    def hidden(*shapes: Any) -> float:
        return 1.0 - share(flats.world(FLOOR, *shapes, lights=[flats.SKY]), at)

    alone, round_ = hidden(one), hidden(ball)
    assert alone > 0.1 and round_ > 0.04
    assert hidden(one, shadow) == pytest.approx(alone, abs=1e-12)
    assert hidden(one, back) == pytest.approx(alone, abs=1e-12)
    assert hidden(ball, circle) == pytest.approx(round_, abs=1e-9)
    assert hidden(one, ball) == pytest.approx(alone + round_, abs=1e-13)
    assert hidden(one, ball, circle, back) == pytest.approx(alone + round_, abs=1e-9)


def test_outlines_cross_where_a_fine_search_finds_them() -> None:
    """Up to four places: changes of the level at 800 angles of each curve, in the cone of the other."""
    room = make_room(3, 4, 1)
    four = judged = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        axes[2] = np.cross(axes[0], axes[1])
        middle = axes[2] * rng.uniform(0.2, 1.5) + 0.3 * rng.normal(size=3)
        if seed % 3 == 0:
            # seen at a slant, from as far as it is wide: long and narrow
            middle = 2.0 * axes[0] + 0.7 * axes[2]
        way = axes[2] if middle @ axes[2] > 0 else -axes[2]
        put_rim(room, 0, 1, tuple(middle), tuple(way), tuple(axes[0]), 1.0)
        if seed % 2:
            axis = middle + 0.2 * rng.normal(size=3)
            angle = rng.uniform(0.2, 1.5)
            if seed % 3 == 0:
                axis, angle = middle + 0.01 * rng.normal(size=3), 0.3
            put_circle(room, 1, 2, tuple(axis / np.linalg.norm(axis)), math.cos(angle), math.sin(angle))
        else:
            other = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            at = middle * rng.uniform(0.5, 2) + 0.3 * rng.normal(size=3)
            if seed % 3 == 0:
                at = middle + 0.01 * rng.normal(size=3)
                other[2] = middle / np.linalg.norm(middle)
                other[0] = np.cross(other[2], other[1]) / np.linalg.norm(np.cross(other[2], other[1]))
            way = other[2] if at @ other[2] > 0 else -other[2]
            put_rim(
                room,
                1,
                2,
                tuple(at),
                tuple(way),
                tuple(other[0]),
                0.6 if seed % 3 == 0 else float(rng.uniform(0.3, 1.5)),
            )
        for i, k in ((0, 1), (1, 0)):
            found, begins = cross_conic(room, i, k, 0)
            t = np.linspace(0, 2 * math.pi, 801)
            levels = np.array([level_in(room.arcs[k], curve_place(room.arcs[i], x)) for x in t])
            at_changes = t[:-1][levels[:-1] * levels[1:] < 0]
            angles = [room.crossings[m].angle for m in range(found)]
            assert len(angles) == len(at_changes) and begins == (levels[0] > 0), (seed, i)
            assert all(0 <= a - b < 8e-3 for a, b in zip(angles, at_changes, strict=True)), (seed, angles)
            assert all(abs(level_in(room.arcs[k], curve_place(room.arcs[i], a))) < 1e-12 for a in angles)
            judged, four = judged + found, four + (found == 4)
    assert judged > 50 and four >= 4


def test_derivatives_among_round_shapes_are_those_of_differences() -> None:
    """A ball and two disks before a disk that emits, whose outlines cross: slopes run through the crossings."""
    shapes = [
        FLOOR,
        flats.disk("lamp", [0.2, 0.1, 2.5], [0.1, 0.2, -1], 0.9),
        flats.disk("D", [0.4, 0.3, 1.2], [0.3, 0, 1], 0.5),
        flats.ball("S", [0.0, 0.1, 0.9], 0.4),
    ]
    scene = sr.load(flats.world(*shapes, lights=[flats.area("lamp")]))
    names = ["shapes.lamp.radius", "shapes.D.radius", "shapes.S.center.x"]
    assert_slopes_are_differences(scene, names)
