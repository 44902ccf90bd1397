"""Taylor models against the functions they stand for, and the walls of bumps against where their levels change sign."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats, heights

from symrender.jit.records import record, table
from symrender.numeric.radiometric.pipeline import rays as traced
from symrender.radiometric.bumps import shading_normal
from symrender.radiometric.pixels import models
from symrender.radiometric.pixels.cells import BOX, Cell, Eye
from symrender.radiometric.pixels.records import KINK, MODELS, REST, TERMS, TURNED, Wall, make_room
from symrender.radiometric.pixels.rules import strips
from symrender.radiometric.pixels.turned import put_bump, put_turned_curve, turned_walls
from symrender.radiometric.sight import nearest
from symrender.radiometric.world import make_world
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

Array = np.ndarray[Any, np.dtype[np.float64]]


def polynomial(model: Array, x: Array, y: Array) -> Array:
    """A model's polynomial at places of its cell."""
    return np.asarray(sum(model[5 * i + j] * x**i * y**j for i in range(5) for j in range(5 - i)))


def varied(rng: np.random.Generator, size: float) -> Array:
    """A random model without a rest, of factors that fall with their degree."""
    found = np.zeros(TERMS)
    for i in range(5):
        for j in range(5 - i):
            found[5 * i + j] = rng.normal() * size ** (i + j)
    return found


FUNCTIONS: list[tuple[str, Callable[..., None], Callable[[Array], Array], float]] = [
    ("reciprocal", lambda a, w, o: models.put_reciprocal(a, w, o), lambda v: 1.0 / v, 3.0),
    ("root", lambda a, w, o: models.put_root(a, w, o), np.sqrt, 3.0),
    ("sine", lambda a, w, o: models.put_wave(a, 0.0, w, o), np.sin, 40.0),
    ("cosine", lambda a, w, o: models.put_wave(a, 1.0, w, o), np.cos, -7.0),
    ("exponential", lambda a, w, o: models.put_grown(a, w, o), np.exp, 1.0),
]


@pytest.mark.parametrize(("name", "put", "true", "middle"), FUNCTIONS)
def test_a_function_lies_within_the_rest(
    name: str, put: Callable[..., None], true: Callable[[Array], Array], middle: float
) -> None:
    rng = np.random.default_rng(len(name))
    x, y = rng.uniform(-1, 1, (2, 400))
    used = []
    for size in (0.3, 0.1, 0.02) * 20:
        given = varied(rng, size)
        given[0], given[REST] = middle, float(rng.choice([0.0, 1e-3]))
        out, work = np.zeros(TERMS), np.zeros((2, TERMS))
        put(given, work, out)
        assert out[REST] < math.inf
        value = polynomial(given, x, y) + given[REST] * rng.uniform(-1, 1, 400)
        off = np.abs(true(value) - polynomial(out, x, y)).max()
        assert off <= out[REST]
        used.append(off / out[REST])
    # a bound that is never nearly reached is none of these
    assert max(used) > 0.2


@pytest.mark.parametrize(("name", "put", "true", "middle"), FUNCTIONS)
def test_the_rest_of_a_function_of_a_line_is_reached(
    name: str, put: Callable[..., None], true: Callable[[Array], Array], middle: float
) -> None:
    x = np.linspace(-1, 1, 101)
    for size in (0.5, 0.1):
        given, out, work = np.zeros(TERMS), np.zeros(TERMS), np.zeros((2, TERMS))
        given[0], given[5] = middle, size * min(abs(middle), 1.5)
        put(given, work, out)
        off = np.abs(true(polynomial(given, x, 0 * x)) - polynomial(out, x, 0 * x)).max()
        # a wave's fifth derivative is no more than 1, and less where the cell is
        assert 0.1 * out[REST] < off <= out[REST], (name, size)


def test_all_walls_of_bumps_are_listed() -> None:
    lights = [
        {"type": "point", "name": "a", "position": [0, 0, 3], "intensity": 1.0},
        {"type": "directional", "name": "b", "direction": [0, 0, -1], "irradiance": 1.0},
        {"type": "spot", "name": "c", "position": [0, 0, 3], "direction": [0, 0, -1], "intensity": 1.0, "beam": 9,
         "cutoff": 20},
    ]  # fmt: skip
    bump = {"height": {"sin": "x"}}
    materials = {
        "shading": flats.WHITE | {"bump": bump}, "geometric": flats.WHITE | {"bump": bump | {"normals": "geometric"}},
        "white": flats.WHITE,
    }  # fmt: skip
    shapes = [flats.ball(name, [2.0 * k, 0, 0], 0.5, name) for k, name in enumerate(materials)]
    world = make_world(radiometric_arrays(load_any(flats.world(*shapes, lights=lights, materials=materials))))
    walls = table(Wall, 20)
    count = turned_walls(world, walls, 0, -1)
    found = [(int(wall.own), int(wall.rest), float(wall.soft)) for wall in walls[:count]]
    assert all(wall.kind == TURNED for wall in walls[:count])
    assert found == [(0, -1, 0.0), *((0, k, KINK) for k in range(3)), (1, -1, 0.0), *((1, k, 0.0) for k in range(3))]
    # a place on the first one sees the second alone
    assert turned_walls(world, walls, 0, 0) == 4 and walls[0].own == 1


def test_a_product_lies_within_the_rest() -> None:
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-1, 1, (2, 400))
    used = []
    for _ in range(50):
        a, b, out = varied(rng, 0.4), varied(rng, 0.4), np.zeros(TERMS)
        a[REST], b[REST] = 1e-3, float(rng.choice([0.0, 1e-2]))
        models.put_product(a, b, out)
        value = (polynomial(a, x, y) + a[REST] * rng.uniform(-1, 1, 400)) * (
            polynomial(b, x, y) + b[REST] * rng.uniform(-1, 1, 400)
        )
        off = np.abs(value - polynomial(out, x, y)).max()
        assert off <= out[REST]
        used.append(off / out[REST])
    assert max(used) > 0.1


def test_what_may_be_anything_is_unknown() -> None:
    work, out = np.zeros((2, TERMS)), np.zeros(TERMS)
    crossing = np.zeros(TERMS)
    crossing[5] = 1.0
    models.put_reciprocal(crossing, work, out)
    assert not models.is_known(out)
    # a root of what may be less than 0 is bounded alone, a wave of anything is no more than 1
    models.put_root(crossing, work, out)
    assert models.is_known(out) and out[0] + out[REST] >= 1.0 and out[0] - out[REST] <= 0.0
    unknown = np.zeros(TERMS)
    models.put_unknown(unknown)
    models.put_wave(unknown, 0.0, work, out)
    assert out[REST] == 1.0 and out[0] == 0.0
    product = np.zeros(TERMS)
    models.put_product(unknown, crossing, product)
    assert not models.is_known(product)


def test_the_turned_normal_of_a_cell_is_that_of_its_rays() -> None:
    rng, judged, tight = np.random.default_rng(5), 0, 0
    for seed in range(60):
        kind = ("plane", "sphere", "rectangle", "disk")[seed % 4]
        bump = {"height": heights.varied(rng, 4), "coordinates": ("world", "own")[seed % 2]}
        material = flats.WHITE | {"bump": bump, "two_sided": True}
        shape = flats.one_of(rng, kind, "it", "white", 0.5)
        scene = flats.world(shape, lights=[], materials={"white": material})
        world = make_world(radiometric_arrays(load_any(scene)))
        room = make_room(world)
        assert room.models is not None and len(room.models) > MODELS
        eye = rng.normal(size=3) * 3.0
        v = -eye + rng.normal(size=3) * 0.2
        size = float(rng.choice([0.2, 0.05, 0.01]))
        vx, vy = (tuple((size * rng.normal(size=3)).tolist()) for _ in range(2))
        seen = Eye(world, world, tuple(eye.tolist()), table(Wall, 0), None, 1.0, True, BOX)  # type: ignore[arg-type]
        cell = Cell(tuple(v.tolist()), vx, vy, 0, 1.0, 0.0, 0.0, 0.0, 1.0)
        put_bump(seen, cell, 0, room.models)
        for _ in range(20):
            x, y = rng.uniform(-1, 1, 2)
            d = v + x * np.array(vx) + y * np.array(vy)
            d /= np.linalg.norm(d)
            own, _, place, normal, front = nearest(world, seen.place, tuple(d.tolist()))
            if own < 0 or not all(models.is_known(room.models[6 + c]) for c in range(3)):
                continue
            turned = np.array(shading_normal(world, own, front, place, normal, room.sky))
            turned *= 1.0 if front else -1.0
            model = np.array([float(polynomial(room.models[6 + c], np.array(x), np.array(y))) for c in range(3)])
            rest = room.models[6:9, REST]
            # it is of no length in particular
            length = turned @ model / (turned @ turned)
            slack = 2.0 * np.linalg.norm(rest) + 1e-9 * np.linalg.norm(model)
            assert np.linalg.norm(model - length * turned) <= slack, seed
            judged, tight = judged + 1, tight + (np.linalg.norm(rest) < 0.01 * np.linalg.norm(model))
    assert judged > 300 and tight > 150


def test_what_a_rest_leaves_open_is_a_strip() -> None:
    material = flats.WHITE | {"bump": {"height": {"sin": "x"}}}
    scene = flats.world(flats.plane("p", [0, 0, 0], [0, 0, 1]), lights=[], materials={"white": material})
    room = make_room(make_world(radiometric_arrays(load_any(scene))))
    # t + 3/4 t s of lines: slopes from 1/4 to 7/4, in strips of |level| <= rest
    rest, s = 0.01, np.linspace(-1, 1, 2001)
    room.turned[0, 5], room.turned[0, 6], room.turned[0, REST] = 1.0, 0.75, rest
    room.bounds[0, 2:4] = 0.25, 1.75
    true = float(np.mean(2.0 * rest / (1.0 + 0.75 * s)) * 2.0)
    room.soft[0] = 0.0
    assert 0.04 < true < strips(room, 1) <= 4.0 * rest / 0.25
    # light that does not jump across a wall is off by its slope alone
    room.soft[0] = KINK
    assert 0.0 < strips(room, 1) < 0.2 * 4.0 * rest / 0.25
    room.turned[0, REST] = 0.0
    assert strips(room, 1) == 0.0


def test_a_wall_that_misses_a_cell_is_nowhere_in_it() -> None:
    rng, missed, entered = np.random.default_rng(6), 0, 0
    for seed in range(80):
        bump = {"height": heights.varied(rng, 4), "amplitude": float(rng.choice([0.2, 1.0]))}
        shape = flats.one_of(rng, ("plane", "sphere")[seed % 2], "it", "white", 0.5)
        key = {"type": "point", "name": "key", "position": (3.0 * rng.normal(size=3)).tolist(), "intensity": 1.0}
        scene = flats.world(shape, lights=[key], materials={"white": flats.WHITE | {"bump": bump}})
        world = make_world(radiometric_arrays(load_any(scene)))
        room, eye = make_room(world), rng.normal(size=3) * 3.0
        assert room.models is not None
        v = -eye + rng.normal(size=3) * 0.2
        size = float(rng.choice([0.1, 0.03]))
        vx, vy = (tuple((size * rng.normal(size=3)).tolist()) for _ in range(2))
        seen = Eye(world, world, tuple(eye.tolist()), table(Wall, 0), None, 1.0, True, BOX)  # type: ignore[arg-type]
        cell = Cell(tuple(v.tolist()), vx, vy, 0, 1.0, 0.0, 0.0, 0.0, 1.0)
        wall, out = record(Wall), np.zeros(TERMS)
        for light in (-1, 0):
            wall.kind, wall.own, wall.rest, wall.soft = TURNED, 0, light, KINK
            put_turned_curve(seen, cell, wall, -1, room.models, out)
            level = []
            for _ in range(60):
                x, y = rng.uniform(-1, 1, 2)
                d = v + x * np.array(vx) + y * np.array(vy)
                d /= np.linalg.norm(d)
                own, _, place, normal, front = nearest(world, seen.place, tuple(d.tolist()))
                if own >= 0:
                    turned = np.array(shading_normal(world, own, front, place, normal, room.sky))
                    way = -d if light < 0 else np.array(key["position"]) - place
                    level.append(turned @ way * (1.0 if front else -1.0))
            if len(level) < 60:
                continue
            if abs(out[0]) > np.abs(out[1:]).sum():
                missed += 1
                assert min(level) * max(level) > 0.0, (seed, light)
            else:
                entered += min(level) * max(level) < 0.0
    assert missed > 40 and entered > 5


def test_the_judge_turns_normals_too() -> None:
    # the conventional tracer sees a wall where the model says one is
    bump = {"height": {"mul": [0.3, {"sin": {"mul": [3, "x"]}}]}}
    sun = {"type": "directional", "name": "sun", "direction": [-1.0, 0.0, -0.5], "irradiance": 1.0}
    scene = flats.world(
        flats.plane("it", [0, 0, 0], [0, 0, 1]), lights=[sun], materials={"white": flats.WHITE | {"bump": bump}}
    )
    x = np.linspace(-2, 2, 2001)
    origins = np.column_stack([x, 0 * x, 0 * x + 5.0])
    _, direct, _, _ = traced(
        radiometric_arrays(load_any(scene)), origins, np.tile([0.0, 0.0, -1.0], (len(x), 1)), order=1
    )
    # (-h', 0, 1).(1, 0, .5) = 0 where h' = .5: cos 3x = .5/.9
    dark = direct[:, 0] == 0.0
    assert dark.sum() > 100
    assert (dark == (np.cos(3 * x) > 0.5 / 0.9)).mean() > 0.998
