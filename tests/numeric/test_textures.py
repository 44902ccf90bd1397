from __future__ import annotations

import math

import mpmath
import pytest

from symrender.jit.records import record
from symrender.numeric.textures import floor_albedo, floor_sign, sin_pi, sphere_albedo, sphere_factor
from symrender.scene.arrays import CHECKER, MARBLE, SOLID, STRIPES
from symrender.scene.records import Floor, Sphere


def _sphere(kind: int, ku: float = 8.0, kv: float = 4.0, dark: float = 0.2) -> Sphere:
    sphere = record(Sphere)
    sphere.radius, sphere.color[:] = 1.0, (0.5, 0.25, 1.0)
    sphere.texture, sphere.ku, sphere.kv, sphere.dark = kind, ku, kv, dark
    return sphere


def _floor(cell: float = 1.0, offset: tuple[float, float] = (0.0, 0.0)) -> Floor:
    floor = record(Floor)
    floor.present, floor.kind, floor.bright[:], floor.dark[:] = 1, CHECKER, 0.8, 0.1
    floor.cell, floor.offset[:] = cell, offset
    return floor


def _point(u: float, v: float) -> tuple[float, float, float]:
    """Unit normal with chart coordinates (u, v)."""
    phi, theta = 2 * math.pi * u - math.pi, math.pi * v
    return (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def test_sin_pi_is_exact_where_it_vanishes() -> None:
    assert [sin_pi(float(k)) for k in (-3, -2, 0, 1, 2, 10**12, 2**60)] == [0.0] * 7
    for x in (0.25, -0.75, 1.5, 12345.625, -1e6 + 0.125):
        assert sin_pi(x) == pytest.approx(float(mpmath.sinpi(x)), abs=2e-16)


@pytest.mark.parametrize("u,v", [(a / 16 + 1 / 32, b / 8 + 1 / 16) for a in range(16) for b in range(8)])
def test_checker_and_stripes_follow_the_chart(u: float, v: float) -> None:
    around, down = math.floor(u * 8) % 2, math.floor(v * 4) % 2
    assert sphere_factor(_sphere(CHECKER), _point(u, v)) == (1.0 if around == down else 0.2)
    assert sphere_factor(_sphere(STRIPES), _point(u, v)) == (0.2 if around else 1.0)
    m = 0.5 + 0.5 * math.sin(2 * math.pi * (8 * u + 0.35 * math.sin(3 * math.pi * 4 * v)))
    assert sphere_factor(_sphere(MARBLE), _point(u, v)) == pytest.approx(0.55 + 0.45 * m, abs=1e-13)
    assert sphere_factor(_sphere(SOLID), _point(u, v)) == 1.0


def test_ties_are_bright() -> None:
    poles_and_seam = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (-1.0, -0.0, 0.0), (0.6, 0.0, 0.8)]
    for n in poles_and_seam:
        assert sphere_factor(_sphere(CHECKER), n) == sphere_factor(_sphere(STRIPES), n) == 1.0
    for x, y in ((0.0, 0.5), (3.0, -1.5), (-7.0, 2.0), (0.5, -4.0)):
        assert floor_sign(_floor(), x, y) == 1.0


def test_normal_a_little_too_long_is_taken() -> None:
    assert sphere_factor(_sphere(CHECKER), (0.0, 0.0, 1.0 + 2e-16)) == 1.0
    assert math.isfinite(sphere_factor(_sphere(MARBLE), (0.0, 0.0, -1.0 - 2e-16)))


def test_floor_cells_and_offset() -> None:
    for i in range(-3, 3):
        for j in range(-3, 3):
            bright = 1.0 if (i + j) % 2 == 0 else -1.0
            assert floor_sign(_floor(), i + 0.4, j + 0.7) == bright
            assert floor_sign(_floor(0.5, (0.25, -0.125)), 0.25 + (i + 0.4) / 2, -0.125 + (j + 0.7) / 2) == bright


def test_albedos_mix_linearly() -> None:
    assert floor_albedo(_floor(), 1.0) == (0.8,) * 3 and floor_albedo(_floor(), -1.0) == (0.1,) * 3
    assert floor_albedo(_floor(), 0.0) == pytest.approx((0.45,) * 3)
    assert sphere_albedo(_sphere(CHECKER), _point(0.19, 0.1)) == pytest.approx((0.1, 0.05, 0.2))
