"""Circles that are no more than points: they are no walls, and what they may hold is stated."""

from __future__ import annotations

import math

import numpy as np

from adversary.case import Case
from chambers.charts import charts_of
from symrender.chambers.walls import NORMAL
from symrender.quadrature.split_panel import POINTS, leave_points

EXPONENT, BRIGHT, TOL = 6.0, 3.0, 1e-4


def standing(seed: int, gap: float) -> Case:
    """A ball ``gap`` above a floor or, by rounding, in it, beside another, seen from a place of the floor near it."""
    rng = np.random.default_rng(seed)
    radius = float(rng.uniform(0.2, 1.5))
    place = rng.uniform(-1, 1, 2) * 2.5 * radius
    place *= max(1.0, 1.2 * radius / np.linalg.norm(place))
    scene = {
        "camera": {"type": "look_at", "eye": [0.3, -9, 4], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40},
        "floor": {"lobe": {"exponent": EXPONENT, "theta_max": 1.5}},
        "spheres": [
            {"name": "standing", "center": [0, 0, radius + gap], "radius": radius},
            {"name": "beside", "center": [3.1 * radius, 0.4, 0.8 * radius], "radius": 0.9 * radius},
        ],
        "lights": [{"name": "key", "type": "point", "position": [3, -2, 6], "color": [1, 1, 1]}],
    }
    return Case("standing", seed, scene, "floor", [[float(place[0]), float(place[1]), 0.0]])


def test_what_a_point_holds_is_stated_and_no_wall_is_lost() -> None:
    left = others = 0
    for seed in range(30):
        for shape, _, work, _, _, mirror in charts_of(standing(seed, -1e-15)):
            if shape != 0:
                continue
            chart, count = work.chart, work.counts.walls
            chart.bright = BRIGHT
            walls = work.walls[:count].copy()
            points = (walls["kind"] == NORMAL) & (walls["sin"] < 1e-7)
            stated = leave_points(TOL, work)
            kept = work.walls[: work.counts.walls]
            assert kept.tobytes() == walls[~points].tobytes()
            others += len(kept)
            if not points.any():
                continue
            left += int(points.sum())
            down = np.array([0.0, 0.0, -1.0]) * chart.radius + chart.center - chart.point
            away = math.sqrt(down @ down)
            density = (EXPONENT + 1.0) / (2.0 * math.pi) * max(0.0, float(down @ mirror) / away) ** EXPONENT
            holds = sum(math.pi * (chart.radius * sine / away) ** 2 for sine in walls["sin"][points])
            assert BRIGHT * density * holds <= stated < POINTS * TOL
            assert stated > 0.0
    assert left >= 10 and others >= 10


def test_a_circle_that_holds_something_stays() -> None:
    stayed = 0
    for seed in range(10):
        for gap, tol in ((-1e-4, TOL), (-1e-15, 1e-18)):
            for shape, _, work, _, _, _ in charts_of(standing(seed, gap)):
                if shape == 0:
                    work.chart.bright, before = BRIGHT, work.counts.walls
                    assert leave_points(tol, work) == 0.0 and work.counts.walls == before
                    stayed += before
    assert stayed >= 20
