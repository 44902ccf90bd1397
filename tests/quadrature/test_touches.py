"""Where on a plane what is seen of a sky touches: found by roots of angles, the conics that list it pass there."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import brentq

import symrender as sr
from symrender.chambers.cones import scene_cones
from symrender.chambers.work import scene_frames, scene_view, work_arrays
from symrender.jit.records import Table, table
from symrender.quadrature.floor_conics import ROUND, TOUCHES, is_felt, touch_conics
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.records import Conic
from symrender.runtimes.bounce import RULE
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.bounce import bounce_scenes

Array = npt.NDArray[np.float64]
LIFT = 0.7
FOOT = (0.3, -0.2)
UP = np.array([0.3, -1.0, 0.2]) / math.sqrt(1.13)
"""Normal of a wall."""


def made(balls: list[tuple[Array, float]]) -> dict[str, Any]:
    """Balls over a floor between two walls under a sky."""
    dull, flat = {"material": "dull"}, {"type": "plane", "material": "dull"}
    walls = [
        flat | {"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "along": [1, 0, 0]},
        flat | {"name": "back", "point": [0, 3, 0], "normal": UP.tolist(), "along": [1, 0, 0]},
        flat | {"name": "side", "point": [-3, 0, 0], "normal": [1, 0, 0], "along": [0, 1, 0]},
    ]
    spheres = [
        dull | {"type": "sphere", "name": f"S{k}", "center": c.tolist(), "radius": r} for k, (c, r) in enumerate(balls)
    ]
    return {
        "units": "radiometric",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5], "fov": 40},
        "materials": {"dull": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [*walls, *spheres],
        "lights": [{"type": "sky", "name": "sky", "radiance": 1}],
    }


def listed(balls: list[tuple[Array, float]]) -> tuple[Table[Conic], int, Any]:
    """The conics of the floor's chart, how many, and the scene as the floor has it."""
    arrays = radiometric_arrays(sr.load(made(balls)))
    bounce = bounce_scenes(arrays, np.zeros(len(arrays.shapes), dtype=bool), 0)
    part = bounce.parts[0]
    lights = light_rows(part, RULE)
    cones = scene_cones(part.spheres, lights, True)
    view = scene_view(part, lights, None, None, None, cones, bounce.glows)
    framed = scene_frames(part, view).views[0]
    work, conics = work_arrays(len(balls), 0), table(Conic, 100)
    work.chart.plane = 0
    work.chart.point[:] = (*FOOT, LIFT)
    return conics, touch_conics(0, framed, work, conics, framed.cones), framed


def passes(row: Any, place: Array) -> float:
    """Distance of a place on the floor from a conic, to first order."""
    x, y = place[0] - FOOT[0], place[1] - FOOT[1]
    level = row.xx * x * x + 2.0 * row.xy * x * y + row.yy * y * y + 2.0 * (row.x * x + row.y * y) + row.free
    steep = 2.0 * math.hypot(row.xx * x + row.xy * y + row.x, row.xy * x + row.yy * y + row.y)
    return abs(level) / max(steep, 1e-12)


def roots(f: Callable[[Array], float], start: Array, way: Array) -> list[Array]:
    """Places of a line on which a function changes its sign."""
    steps = np.linspace(-8.0, 8.0, 401)
    values = [f(start + s * way) for s in steps]
    found = []
    for a, b, u, v in zip(steps, steps[1:], values, values[1:], strict=False):
        if math.isfinite(u) and math.isfinite(v) and u * v < 0.0:
            found.append(start + brentq(lambda s: f(start + s * way), a, b, xtol=1e-14) * way)
    return found


def angle(q: Array, one: tuple[Array, float], other: tuple[Array, float], side: float) -> float:
    """By how much the circles of two balls, seen from a place, fail to touch, from without (-1) or within (1)."""
    (c, r), (d, s) = one, other
    to_c, to_d = c - q, d - q
    far_c, far_d = math.sqrt(to_c @ to_c), math.sqrt(to_d @ to_d)
    if far_c <= r or far_d <= s:
        return math.nan
    apart = math.atan2(float(np.linalg.norm(np.cross(to_c, to_d))), float(to_c @ to_d))
    return apart - abs(math.asin(r / far_c) - side * math.asin(s / far_d))


def gap(q: Array, ball: tuple[Array, float], side: float) -> float:
    """By how much a ball, seen from a place, fails to touch the great circle in which it sees a plane's horizon."""
    to = ball[0] - q
    far = math.sqrt(to @ to)
    return float(to @ UP) / far + side * ball[1] / far if far > ball[1] else math.nan


@pytest.mark.parametrize("alike", [False, True])
def test_touching_circles_lie_on_conics(alike: bool) -> None:
    rng = np.random.default_rng(4)
    met = {-1.0: 0, 1.0: 0}
    for _ in range(8):
        balls = [
            (rng.normal(size=3) * [0.4, 0.4, 0.9] + [0, 0, 1.5], 0.3 if alike else float(rng.uniform(0.1, 0.5)))
            for _ in "ab"
        ]
        conics, count, framed = listed(balls)
        assert 0 < count <= 2 + 2 * 2 * 2
        for _ in range(5):
            start, turn = np.array([*rng.uniform(-1, 1, 2), 0.0]), rng.uniform(0, 2 * math.pi)
            way = np.array([math.cos(turn), math.sin(turn), 0.0])
            for side in met:
                for place in roots(partial(angle, one=balls[0], other=balls[1], side=side), start, way):
                    near = [k for k in range(count) if passes(conics[k], place) < 1e-7]
                    assert near, (balls, place, side)
                    # whoever asks whether the smaller ball is felt there hears of it
                    assert all(conics[k].soft <= TOUCHES < ROUND for k in near)
                    assert any(is_felt(conics[k], place[0], place[1], 0.01, 1e-4, framed) for k in near)
                    met[side] += 1
    assert met[-1.0] >= 10 and met[1.0] >= 4, met


def test_balls_that_touch_other_planes_lie_on_lines() -> None:
    rng = np.random.default_rng(5)
    met = 0
    for _ in range(12):
        ball = (rng.normal(size=3) * 0.5 + [0, 0, 1.5], float(rng.uniform(0.1, 0.5)))
        conics, count, _ = listed([ball])
        assert count == 4
        for _ in range(6):
            start, turn = np.array([*rng.uniform(-1, 1, 2), 0.0]), rng.uniform(0, 2 * math.pi)
            way = np.array([math.cos(turn), math.sin(turn), 0.0])
            for side in (-1.0, 1.0):
                for place in roots(partial(gap, ball=ball, side=side), start, way):
                    assert min(passes(conics[k], place) for k in range(count)) < 1e-9
                    met += 1
    assert met >= 50
