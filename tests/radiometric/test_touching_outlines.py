"""A ball sunk into a checkered floor: outlines of what it hides and shades touch the circle in which it is cut.

There a dark stretch of a line closes and a bright one opens between the same two walls, and no order of walls tells. A
wall above sees the floor past the ball, which is black; what is missing is an integral over the hidden and the shaded
part of the floor, in polar coordinates about the circle, which knows neither squares nor conics.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from numpy.polynomial.legendre import leggauss

import symrender as sr
from symrender.scene.load import load_any

Array = npt.NDArray[np.float64]

ABOVE, RADIUS, INTENSITY, WALL = 2.0, 0.5, 3.0, 0.8
BRIGHT, DARK = 0.9, 0.1
TOL = 1e-6


def scene(ball: bool, cell: float, turn: float, height: float, light: tuple[float, float, float]) -> dict[str, Any]:
    """A wall that looks down on a checker turned by ``turn``, seen at (0, 0, 2), with a ball at (.35, -.15, height)."""
    checker = {"type": "checker", "bright": [BRIGHT] * 3, "dark": [DARK] * 3, "cell": cell}
    along = [math.cos(turn), math.sin(turn), 0.0]
    sphere = {"type": "sphere", "name": "S", "center": [0.35, -0.15, height], "radius": RADIUS, "material": "black"}
    return {
        "units": "radiometric",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [1.5, -2.0, 1.0], "target": [0, 0, ABOVE], "up": [0, 0, 1], "fov": 40.0},
        "materials": {
            "tiles": {"type": "diffuse", "reflectance": checker},
            "wall": {"type": "diffuse", "reflectance": [WALL] * 3},
            "black": {"type": "diffuse", "reflectance": [0.0] * 3},
        },
        "shapes": [
            {"type": "plane", "name": "W", "point": [0, 0, ABOVE], "normal": [0, 0, -1], "material": "wall"},
            {"type": "plane", "name": "F", "point": [0.03, 0.02, 0], "normal": [0, 0, 1], "along": along,
             "material": "tiles"},
            *([sphere] if ball else []),
        ],
        "lights": [{"type": "point", "name": "L", "position": list(light), "intensity": [INTENSITY] * 3}],
    }  # fmt: skip


def reach(phi: Array, centre: Array, eye: Array) -> Array:
    """How far from the foot of the ball its shadow from ``eye`` reaches on the floor, at azimuth ``phi``."""
    low = np.full_like(phi, math.sqrt(max(0.0, RADIUS**2 - centre[2] ** 2)))
    high = np.full_like(phi, 50.0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        x, y = centre[0] + middle * np.cos(phi), centre[1] + middle * np.sin(phi)
        way = np.stack([x - eye[0], y - eye[1], np.full_like(x, -eye[2])])
        to = (centre - eye)[:, None]
        square = (way * way).sum(0)
        share = np.clip((way * to).sum(0) / square, 0.0, 1.0)
        off = ((to - share * way) ** 2).sum(0)
        hidden = off < RADIUS**2
        low, high = np.where(hidden, middle, low), np.where(hidden, high, middle)
    assert low.max() < 49.0, "a shadow without end"
    return low


def missing(cell: float, turn: float, height: float, light: tuple[float, float, float], pieces: int = 3000) -> float:
    """What of the floor's light does not reach (0, 0, 2): the wall's radiance without the ball less that with it."""
    centre, lamp, eye = np.array([0.35, -0.15, height]), np.array(light), np.array([0.0, 0.0, ABOVE])
    nodes, weights = leggauss(6)
    phi = ((np.arange(pieces)[:, None] + 0.5 + 0.5 * nodes) * (2.0 * math.pi / pieces)).ravel()
    share = np.tile(weights * math.pi / pieces, pieces)
    far = np.maximum(reach(phi, centre, eye), reach(phi, centre, lamp))
    c, s = math.cos(turn), math.sin(turn)
    total = 0.0
    for angle, end, weight in zip(phi, far, share, strict=True):
        a, b = math.cos(angle), math.sin(angle)
        cuts = [0.0, end]
        for across, start in (
            (c * a + s * b, c * (centre[0] - 0.03) + s * (centre[1] - 0.02)),
            (c * b - s * a, c * (centre[1] - 0.02) - s * (centre[0] - 0.03)),
        ):
            first, last = sorted((start / cell, (start + across * end) / cell))
            cuts += [(k * cell - start) / across for k in range(math.ceil(first), math.floor(last) + 1)]
        edges = np.array(sorted(cuts))
        wide = np.diff(edges)
        rho = edges[:-1, None] + 0.5 * wide[:, None] * (1.0 + nodes)
        x, y = centre[0] + rho * a, centre[1] + rho * b
        middle = 0.5 * (edges[:-1] + edges[1:])
        mx, my = centre[0] + middle * a, centre[1] + middle * b
        u, v = c * (mx - 0.03) + s * (my - 0.02), c * (my - 0.02) - s * (mx - 0.03)
        odd = (np.floor(u / cell) + np.floor(v / cell)) % 2
        albedo = np.where(odd == 0, BRIGHT, DARK)[:, None]
        to_lamp = (lamp[0] - x) ** 2 + (lamp[1] - y) ** 2 + lamp[2] ** 2
        to_eye = x**2 + y**2 + ABOVE**2
        light_there = albedo / math.pi * INTENSITY * lamp[2] / to_lamp**1.5
        total += weight * float((0.5 * wide[:, None] * weights * rho * light_there * (ABOVE / to_eye) ** 2).sum())
    return WALL / math.pi * total


Case = tuple[float, float, float, tuple[float, float, float]]
CASES: list[Case] = [
    (0.7, 0.3, 0.2, (1.5, 0.3, 0.9)),
    (2.5, 0.0, 0.2, (1.5, 0.3, 0.9)),
    (2.5, 0.8, -0.1, (-1.2, 0.9, 1.1)),
    (0.4, 1.1, 0.3, (0.2, 1.4, 1.1)),
    (3.0, 0.641302932509398, -0.3615160851829216, (-1.3537268678184957, 1.4975283451952142, 1.4176060227467864)),
]


@pytest.mark.parametrize("case", CASES, ids=["turned", "one square", "deep", "small squares", "deeper"])
def test_what_lies_between_outlines_that_touch_is_seen_anew(case: Case) -> None:
    light = []
    for ball in (False, True):
        image = sr.truth(load_any(scene(ball, *case)), size=1, tol=TOL, threads=1, tile=1)
        assert image.layer("status")[0, 0] == 0.0 and image.layer("error")[0, 0] <= TOL
        light.append(float(image.layer("indirect")[0, 0, 0]))
    hidden = missing(*case)
    assert light[1] > 0.02 and hidden > 4e-4
    assert light[0] - light[1] == pytest.approx(hidden, abs=3.0 * TOL)


@pytest.mark.parametrize(("case", "step"), [(CASES[0], 1e-4), (CASES[2], 2e-3), (CASES[4], 2e-3)])
def test_outlines_that_touch_part_from_nothing(case: Case, step: float) -> None:
    """Two crossings that rounding makes of one move as they like; nothing is one-sided, and little is unsure."""
    name = "shapes.S.center.z"
    image = sr.gradient(load_any(scene(True, *case)), [name], size=1, tol=TOL, threads=1, tile=1)[name]
    cell, turn, height, light = case
    raised = [missing(cell, turn, height + k * step, light, pieces=2000) for k in (1, -1, 2, -2)]
    expected = -(8.0 * (raised[0] - raised[1]) - (raised[2] - raised[3])) / (12.0 * step)
    assert image.layer("status")[0, 0] == 0.0 and image.layer("error")[0, 0] <= TOL
    assert abs(expected) > 4e-3
    assert float(image.layer("indirect")[0, 0, 0]) == pytest.approx(expected, abs=2.0 * TOL)
