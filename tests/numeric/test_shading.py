from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.jit.records import record
from symrender.numeric.shading import light_terms, power, sphere_blocks, visible
from symrender.numeric.world import World, make_world
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, scene_arrays
from symrender.scene.records import Sphere
from symrender.scene.scene import Scene

Vector = tuple[float, float, float]


def _sphere(center: Vector, radius: float) -> Sphere:
    sphere = record(Sphere)
    sphere.center[:], sphere.radius = center, radius
    return sphere


def _world(*spheres: tuple[Vector, float], floor: bool = True, **shading: object) -> World:
    scene = {
        "camera": {"type": "plane", "eye": [0.0, 0.0, 4.0], "window_half": 1.0},
        "spheres": [{"name": f"s{k}", "center": list(c), "radius": r} for k, (c, r) in enumerate(spheres)],
        "floor": {} if floor else None,
        "shading": shading,
    }
    return make_world(scene_arrays(Scene.model_validate(scene, strict=False)), 2)


@given(st.tuples(*[st.floats(-3, 3)] * 3), st.tuples(*[st.floats(-3, 3)] * 3), st.tuples(*[st.floats(-2, 2)] * 3))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_sphere_blocks_what_dense_points_say(q: Vector, light: Vector, center: Vector) -> None:
    """The segment meets the surface iff it has points on both sides of it."""
    t = np.linspace(0, 1, 4001)[:, None]
    f = np.array(q) + t * np.subtract(light, q) - center
    depth = 1 - (f * f).sum(axis=1)
    if np.abs(depth).min() < 2e-3:
        return
    assert sphere_blocks(_sphere(center, 1.0), q, light) == bool((depth > 0).any() and (depth < 0).any())


@pytest.mark.parametrize(
    "q,light,blocked",
    [
        ((3, 0, 0), (-3, 0, 0), True),
        ((3, 0, 0), (2, 0, 0), False),
        ((3, 0, 0), (0.5, 0, 0), True),
        ((3, 0, 0), (1, 0, 0), False),
        ((3, 0, 0), (5, 0, 0), False),
        ((0.5, 0, 0), (-0.5, 0, 0), False),
        ((0.5, 0, 0), (3, 0, 0), True),
        ((0.5, 0, 0), (1, 0, 0), False),
        ((3, 1, 0), (-3, 1, 0), True),
        ((3, 1 + 1e-9, 0), (-3, 1 + 1e-9, 0), False),
        ((1, 0, 0), (3, 0, 0), False),
        ((1, 0, 0), (0, 0.5, 0), False),
        ((1, 0, 0), (-3, 0, 0), True),
        ((3e8, 0.999, 0), (-3e8, 0.999, 0), True),
        ((3e8, 1.001, 0), (-3e8, 1.001, 0), False),
    ],
)
def test_sphere_blocks_on_the_edges(q: Vector, light: Vector, blocked: bool) -> None:
    assert bool(sphere_blocks(_sphere((0, 0, 0), 1.0), q, light)) is blocked


@pytest.mark.parametrize(
    "own,inside,q,light,seen",
    [
        (FLOOR, False, (3, 0, 0), (3, 0, 5), True),
        (FLOOR, False, (3, 0, 0), (3, 0, 0), False),
        (FLOOR, False, (3, 0, 0), (3, 1, -5), False),
        (FIRST_SPHERE, False, (0, 0, 1), (0, 0, -5), False),
        (FIRST_SPHERE, False, (1, 0, 0), (5, 0, -5), True),
        (FIRST_SPHERE, False, (0, 0, -1), (0, 0, 5), False),
        (FIRST_SPHERE, False, (0, 0, 1), (0, 0, 5), True),
        (FIRST_SPHERE, False, (0.6, 0, 0.8), (-4, 0, 0.1), True),
        (FIRST_SPHERE, False, (0, 0, 1), (0, 0, 0.5), False),
        (FIRST_SPHERE, True, (0, 0, 1), (0, 0, 0.5), True),
        (FIRST_SPHERE, True, (0, 0, 1), (0, 0, 5), False),
        (FIRST_SPHERE, False, (0, 0, 1), (0, 0, 1), True),
    ],
)
def test_own_sphere_and_floor_rules(own: int, inside: bool, q: Vector, light: Vector, seen: bool) -> None:
    world = _world(((0.0, 0.0, 0.0), 1.0))
    assert visible(world, own, inside, tuple(map(float, q)), tuple(map(float, light))) is seen
    if own != FLOOR and not inside and q[2] != 0:
        below = q[2] * light[2] < 0
        assert visible(_world(((0.0, 0.0, 0.0), 1.0), floor=False), own, inside, q, light) is (seen or below)


def test_light_at_the_point_and_highlights_without_direction() -> None:
    for model in ("blinn", "phong"):
        world = _world(floor=False, model=model, specular_terminator="open")
        n, v = (0.0, 0.0, 1.0), (0.0, 0.6, 0.8)
        assert light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), n, v, (0.0, 0.0, 0.0)) == (0.0, 0.0)
        assert light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), n, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0)) == (1.0, 0.0)
    # light opposite to the view: the half vector vanishes
    world = _world(floor=False, specular_terminator="open")
    assert light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.6, 0.8), (0.0, -0.6, -0.8)) == (
        0.0,
        0.0,
    )


@pytest.mark.parametrize("terminator,highlight", [("cut", 0.0), ("open", 1.0)])
def test_terminator_and_zeroth_power(terminator: str, highlight: float) -> None:
    """Shininess 0 makes every defined highlight 1, unless the terminator cuts it at n.l <= 0."""
    world = _world(floor=False, shininess=0.0, specular_terminator=terminator)
    n, v = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    for light in ((0.0, 2.0, 0.0), (0.0, 1.0, -1.0)):
        assert light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), n, v, light) == (0.0, highlight)
    assert light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), n, v, (0.0, 0.0, 1.0)) == (1.0, 1.0)


def test_blinn_and_phong_against_their_definitions() -> None:
    rng = np.random.default_rng(2)
    lit = 0
    for _ in range(200):
        n, v, to = (x / np.linalg.norm(x) for x in rng.normal(size=(3, 3)))
        l = to
        for model in ("blinn", "phong"):
            world = _world(floor=False, model=model, specular_terminator="open", shininess=8.0)
            h = (l + v) / np.linalg.norm(l + v)
            r = 2 * (n @ l) * n - l
            expected = max(0.0, n @ h) ** 8 if model == "blinn" else max(0.0, r @ v) ** 8
            diffuse, highlight = light_terms(world, FLOOR, False, (0.0, 0.0, 0.0), (*n,), (*v,), (*(3 * to),))
            assert diffuse == pytest.approx(max(0.0, n @ l), abs=1e-14)
            assert highlight == pytest.approx(expected, abs=1e-14)
            lit += highlight > 0.1
    assert lit > 20


def test_power() -> None:
    assert power(0.0, 0.0) == 1.0 and power(0.0, 3.0) == 0.0 and power(0.5, 3.0) == 0.125
    assert power(0.25, 0.5) == 0.5 and power(0.9, 1e9) == 0.0
    assert power(0.97, 256.0) == pytest.approx(math.exp(256 * math.log(0.97)), rel=1e-13)
    assert power(0.999, 300.0) == pytest.approx(math.exp(300 * math.log(0.999)), rel=1e-13)
