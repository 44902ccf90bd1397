"""Second derivatives of radiometric scenes against closed forms, and what is said of events."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from tests.radiometric import second_order
from tests.radiometric.test_bounce import CORNER, ball, corner, plane, scene

import symrender as sr
from symrender.errors import OptionError, Unsupported
from symrender.scene.load import load_any
from symrender.scene.radiometric.scene import RadiometricScene

ALONG = ([0, -3, 3], [0, 3, -3])
"""A ray that meets the floor at the origin, from 45 degrees."""


def lit(light: dict[str, Any], *shapes: dict[str, Any], **changes: Any) -> RadiometricScene:
    """A grey floor, and other shapes of its material, under one light."""
    made = scene([plane("grey", (0, 0, 1)), *shapes], [light], grey=0.5)
    loaded = load_any(made | {"bounces": 0} | changes)
    assert isinstance(loaded, RadiometricScene)
    return loaded


def check(found: sr.Hessian, value: sp.Expr, numbers: dict[sp.Symbol, float], least: float, most: float) -> None:
    """The first channel is the Hessian of ``value``, within what is stated, which is at most ``most`` of it."""
    wanted = np.array(sp.hessian(value, list(numbers)).evalf(40, subs=numbers), dtype=float)
    size = np.abs(wanted).max()
    assert size > least
    stated = found.error.reshape(wanted.shape)
    assert (np.abs(found.values[..., 0].reshape(wanted.shape) - wanted) <= stated).all()
    assert stated.max() <= most * size


def test_a_point_light_above_a_floor() -> None:
    x, y, z, r = symbols = sp.symbols("x y z r")
    at = [0.3, -0.4, 1.1]
    light = {"type": "point", "position": at, "intensity": 3}
    names = ["lights.L0.position", "materials.grey.reflectance.color.r"]
    found = sr.hessian(lit(light), names, rays=ALONG)
    assert found.names[-1] == names[-1] and found.values.shape == (4, 4, 1, 3)
    assert np.array_equal(found.values, found.values.swapaxes(0, 1))
    radiance = 3 * r / sp.pi * z / (x * x + y * y + z * z) ** sp.Rational(3, 2)
    check(found, radiance, dict(zip(symbols, [*at, 0.5], strict=True)), 0.5, 1e-8)
    # linear in the reflectance
    assert np.abs(found.values[3, 3]).max() < 1e-12


def test_a_floor_that_turns_and_sinks() -> None:
    a, b, s = symbols = sp.symbols("a b s")
    light = {"type": "point", "position": [0.3, -0.4, 1.1], "intensity": 3}
    names = ["shapes.S0.normal.x", "shapes.S0.normal.y", "shapes.S0.point.z"]
    found = sr.hessian(lit(light), names, rays=ALONG)
    normal = sp.Matrix([a, b, 1])
    # where (0, -3, 3) + t (0, 1, -1) meets the plane through (0, 0, s)
    t = (normal[2] * s - (-3 * b + 3)) / (b - 1)
    to = sp.Matrix([sp.Rational(3, 10), -sp.Rational(2, 5), sp.Rational(11, 10)]) - sp.Matrix([0, t - 3, 3 - t])
    radiance = 3 * 0.5 / sp.pi * normal.dot(to) / sp.sqrt(normal.dot(normal)) / to.dot(to) ** sp.Rational(3, 2)
    check(found, radiance, dict.fromkeys(symbols, 0.0), 0.5, 1e-8)


def test_an_image_is_its_rays() -> None:
    light = {"type": "point", "position": [0.3, -0.4, 1.1], "intensity": 3}
    camera = {"type": "look_at", "eye": [0, -3, 3], "target": [0, 0, 0], "fov": 30}
    made, names = lit(light, camera=camera), ["lights.L0.position.z", "shapes.S0.point.z"]
    image, along = sr.hessian(made, names, size=1), sr.hessian(made, names, rays=ALONG)
    assert image.values.shape == (2, 2, 1, 1, 3) and np.abs(image.values).max() > 0.5
    gap = np.abs(image.values[:, :, 0, 0] - along.values[:, :, 0]).max(axis=-1)
    assert (gap <= image.error[:, :, 0, 0] + along.error[:, :, 0]).all() and image.error.max() < 1e-8


@pytest.mark.parametrize("alpha", [0.3, 0.01])
def test_the_roughness_of_a_conductor(alpha: float) -> None:
    materials = {"grey": {"type": "conductor", "alpha": alpha, "eta": 0.4, "k": 3.0, "distribution": "ggx"}}
    # a little beside the mirror direction
    place = [0.02, 1.0, 1.01]
    made = lit({"type": "point", "position": place, "intensity": 1}, materials=materials)
    (found,) = (sr.hessian(made, ["materials.grey.alpha"], rays=ALONG),)
    digits = mpmath.mp.clone()
    digits.dps = 40
    to = [digits.mpf(c) for c in place]
    length = digits.sqrt(sum(c * c for c in to))
    half = [c / length + v / digits.sqrt(2) for c, v in zip(to, (0, -1, 1), strict=True)]
    size = digits.sqrt(sum(c * c for c in half))
    cosine = half[2] / size

    def lobe(a: Any) -> Any:
        def masked(z: Any) -> Any:
            return 2 / (1 + digits.sqrt(1 + a * a * (1 / (z * z) - 1)))

        density = a * a / (digits.pi * (cosine * cosine * (a * a - 1) + 1) ** 2)
        return density * masked(to[2] / length) * masked(1 / digits.sqrt(2))

    # all else does not depend on alpha, and is in the value
    radiance = sr.probe(made, rays=ALONG).radiance[0, 0]
    wanted = float(digits.diff(lobe, digits.mpf(alpha), 2) / lobe(digits.mpf(alpha))) * radiance
    assert radiance > 1e-3 and abs(wanted) > 0.1 * radiance
    assert abs(found.values[0, 0, 0, 0] - wanted) <= found.error[0, 0, 0] <= 1e-6 * abs(wanted)


def test_the_radius_of_a_lamp_is_squared() -> None:
    shapes = {**ball("lamp", (0.5, 0.2, 2.0), 0.3), "name": "lamp"}
    materials = {"grey": {"type": "diffuse", "reflectance": 0.5}, "lamp": {"type": "diffuse", "reflectance": 0}}
    made = lit({"type": "area", "shape": "lamp", "radiance": 4}, shapes, materials=materials)
    found = sr.hessian(made, ["shapes.lamp.radius", "shapes.lamp.center.z"], rays=ALONG)
    r, z = sp.symbols("r z")
    radiance = 0.5 * 4 * r * r * z / (0.29 + z * z) ** sp.Rational(3, 2)
    check(found, radiance, {r: 0.3, z: 2.0}, 0.9, 1e-8)


def test_bounced_light_of_a_wall() -> None:
    names = ["lights.L0.direction.x", "lights.L0.direction.z", "materials.wall.reflectance.color.r"]
    found = sr.hessian(corner(), names, rays=CORNER)
    x, z, r = sp.symbols("x z r")
    radiance = 0.8 / sp.pi * (-z - r / 2 * x) / sp.sqrt(x * x + z * z)
    check(found, radiance, {x: -3.0, z: -4.0, r: 0.5}, 0.01, 1e-6)


def test_a_ball_that_the_ray_leaves_within_a_step() -> None:
    c = sp.Symbol("c")
    sun = {"type": "directional", "direction": [-1, 1, -2], "irradiance": 3}
    made = lit(sun, ball("grey", (0, 0, 3), 0.5))
    # along y, .495 beside the middle of the ball
    found = sr.hessian(made, ["shapes.S1.center.x"], rays=([0.495, -3, 3], [0, 1, 0]))
    radiance = 1.5 / sp.pi * ((0.495 - c) + sp.sqrt(0.25 - (0.495 - c) ** 2)) / 0.5 / sp.sqrt(6)
    check(found, radiance, {c: 0.0}, 10.0, 1e-5)


def test_a_shadow_narrower_than_every_step_is_told() -> None:
    light = {"type": "point", "position": [0, 0, 1.0], "intensity": 3}
    name = "lights.L0.position.x"
    bare = sr.hessian(lit(light), [name], rays=ALONG)
    assert bare.values[0, 0, 0, 0] == pytest.approx(-4.5 / math.pi, rel=1e-9)
    # in the middle of the shadow of a speck all is black; beside it is what there is without the speck
    found = sr.hessian(lit(light, ball("grey", (0, 0, 0.5), 2.0**-56)), [name], rays=ALONG)
    assert found.error[0, 0, 0] == math.inf
    # larger ones are found by more steps
    for radius in (2.0**-40, 2.0**-20):
        found = sr.hessian(lit(light, ball("grey", (0, 0, 0.5), radius)), [name], rays=ALONG)
        assert found.error[0, 0, 0] < 1e-9 and np.abs(found.values).max() <= found.error[0, 0, 0]


def test_where_the_second_derivative_jumps_either_side_is_within_what_is_stated() -> None:
    # the floor's origin is where the spot ends: f = t^2 (3 - 2 t) with t = 0 there
    spot = {"type": "spot", "position": [0, 0, 1], "direction": [1, 0, -1], "intensity": 1, "falloff": "smooth"}
    found = sr.hessian(lit({**spot, "beam": 20, "cutoff": 45}), ["lights.L0.cutoff"], rays=ALONG)
    slope = math.radians(1) * math.sin(math.pi / 4) / (math.cos(math.radians(20)) - math.cos(math.pi / 4))
    inside = 0.5 / math.pi * 6 * slope**2
    value, stated = found.values[0, 0, 0, 0], found.error[0, 0, 0]
    assert inside > 1e-3 and abs(value - inside) <= stated and abs(value) <= stated < 10 * inside


def test_a_light_that_rises_over_the_floor_has_none() -> None:
    found = sr.hessian(
        lit({"type": "point", "position": [1, 0, 0], "intensity": 3}), ["lights.L0.position.z"], rays=ALONG
    )
    assert found.error[0, 0, 0] == math.inf


DOWN = ([0.1, 0.2, 1], [0, 0, -1])
LEVEL = {"shapes": [{"type": "plane", "name": "S0", "material": "grey", "point": [0, 0, 0], "normal": [0, 0, 1]}]}
"""A floor whose own coordinates are those of the scene."""


@pytest.mark.parametrize("size", [1e-6, 1e-4, 1.0])
def test_steps_follow_the_scene_not_the_unit(size: float) -> None:
    x = sp.Symbol("x")
    at = [0.3 * size, 0.2 * size, 0.5 * size]
    light = {"type": "point", "position": at, "intensity": size**2}
    camera = {"type": "look_at", "eye": [0, -6 * size, 2 * size], "target": [0, 0, 0.1 * size], "fov": 30}
    found = sr.hessian(lit(light, camera=camera), ["lights.L0.position.x"], rays=([0, 0, size], [0, 0, -1]))
    radiance = 0.5 / sp.pi * size**2 * at[2] / (x * x + at[1] ** 2 + at[2] ** 2) ** sp.Rational(3, 2)
    check(found, radiance, {x: at[0]}, 0.1 / size**2, 1e-6)


def test_steps_do_not_grow_with_the_distance_from_the_origin() -> None:
    x, far = sp.Symbol("x"), 1e5
    light = {"type": "point", "position": [far + 0.3, 0.2, 0.5], "intensity": 1}
    camera = {"type": "look_at", "eye": [far, -6, 2], "target": [far, 0, 0.1], "fov": 30}
    found = sr.hessian(lit(light, camera=camera), ["lights.L0.position.x"], rays=([far + 0.1, 0, 1], [0, 0, -1]))
    gap = x - sp.Float(far + 0.1, 30)
    radiance = 0.5 / sp.pi * 0.5 / (gap**2 + sp.Rational(29, 100)) ** sp.Rational(3, 2)
    check(found, radiance, {x: far + 0.3}, 1.0, 1e-4)


@pytest.mark.parametrize("cell", [2.0**-7, 2.0**-8, 0.002])
def test_steps_that_are_multiples_of_a_period_are_not_believed(cell: float) -> None:
    """Halved steps see marble of a cell of 1/128 as one colour, on every level that is coarser."""
    x = sp.Symbol("x")
    materials = {
        "grey": {"type": "diffuse", "reflectance": {"type": "marble", "bright": 0.8, "dark": 0.2, "cell": cell}}
    }
    sun = {"type": "directional", "direction": [0, 0, -1], "irradiance": 1}
    place = (13.1 * cell, 0.2 * cell)
    rays = ([*place, 1], [0, 0, -1])
    found = sr.hessian(lit(sun, materials=materials, **LEVEL), ["shapes.S0.point.x"], rays=rays)
    vein = (1 + sp.sin(2 * sp.pi * ((place[0] - x) / cell + 0.35 * sp.sin(3 * sp.pi * place[1] / cell)))) / 2
    check(found, (0.2 + 0.6 * vein) / sp.pi, {x: 0.0}, 1e4, 1e-5)


def test_a_fine_bump() -> None:
    x, pace = sp.Symbol("x"), 256 * math.pi
    bump = {"amplitude": 0.01 / pace, "height": {"sin": {"mul": [pace, "x"]}}, "coordinates": "own"}
    materials = {"grey": {"type": "diffuse", "reflectance": 0.5, "bump": bump}}
    sun = {"type": "directional", "direction": [-0.5, 0, -1], "irradiance": 1}
    found = sr.hessian(lit(sun, materials=materials, **LEVEL), ["shapes.S0.point.x"], rays=DOWN)
    slope = 0.01 * sp.cos(pace * (0.1 - x))
    radiance = 0.5 / sp.pi * (1 - slope / 2) / sp.sqrt(1 + slope**2) / sp.sqrt(sp.Rational(5, 4))
    check(found, radiance, {x: 0.0}, 50.0, 1e-5)


@pytest.mark.parametrize("seed", [8, 11, 13])
def test_planes_of_any_size(seed: int) -> None:
    """Marble, a bump and GGX, as `benchmarks/second_derivatives_are_stated.py` judges a thousand."""
    made = second_order.case(seed)
    names = sorted(made.steps)[-2:]
    found = sr.hessian(made.scene, names, rays=made.rays)
    told = 0
    for ray in range(second_order.RAYS):
        for i, j in ((0, 0), (0, 1), (1, 1)):
            true = second_order.second(made, (names[i], names[j]), ray)
            stated = found.error[i, j, ray]
            assert abs(found.values[i, j, ray, 0] - true) <= stated
            told += 0.0 < stated < 1e-3 * abs(true)
    assert told >= 3


def test_refusals() -> None:
    made = lit({"type": "point", "position": [0, 0, 1], "intensity": 0})
    with pytest.raises(Unsupported, match=r"lights\.L0\.intensity\.r: no second derivative at the end of its range"):
        sr.hessian(made, ["lights.L0.intensity.r"], rays=ALONG)
    with pytest.raises(OptionError, match="points, rays, size"):
        sr.hessian(made, ["lights.L0.position"], rays=ALONG, size=4)
    with pytest.raises(Unsupported, match="probed along rays"):
        sr.hessian(made, ["lights.L0.position"], [(0, 0)])
