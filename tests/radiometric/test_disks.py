"""Disks under a sky, before lamps and as lamps: form factors, meridians, the rim against quadrature, derivatives."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats, meridians

import symrender as sr
from symrender.errors import Unsupported
from symrender.expression.formulas.polygons import rim_flux
from symrender.expression.vectors import Vec3
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
        found = rim_flux(Vec3(*middle), Vec3(*first), Vec3(*second), begin, begin + span).parts
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
    slopes = sr.gradient(scene, names, size=(8, 6))
    for name in names:
        slope, value, step = slopes[name].layer("direct"), float(get(scene, name)), 1e-5
        high, low = (sr.truth(scene.replace({name: value + s}), size=(8, 6)) for s in (step, -step))
        steady = (high.layer("hit_class") == low.layer("hit_class")) & (slopes[name].layer("status") == 0)
        off = np.abs((high.layer("direct") - low.layer("direct")) / (2 * step) - slope).max(axis=2)[steady]
        assert np.abs(slope).max() > 1e-3 and steady.sum() > 10, name
        assert (off < 1e-6).mean() > 0.9, (name, off.max())


def test_disks_beside_round_shapes_are_refused() -> None:
    one, two = flats.disk("D", [0, 0, 1], [0, 0, 1], 1), flats.disk("E", [3, 0, 1], [0, 0, 1], 1)
    for other in (two, flats.ball("S", [3, 0, 1], 0.5)):
        for light in (flats.SKY, flats.area("D")):
            with pytest.raises(
                Unsupported, match=r"in a scene with a disk, shapes\[1\], beside another disk or sphere"
            ):
                sr.truth(flats.world(FLOOR, one, other, lights=[light]), size=2)
