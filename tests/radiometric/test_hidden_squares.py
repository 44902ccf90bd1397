"""What a ball hides of a checker, where its outline touches lines, sides and corners of squares.

A wall sees the floor past a black ball between them. The derivative of what arrives is an integral along the outline
on the floor, of radiance times the speed of the outline across itself, jumping where the outline passes lines of the
checker: arithmetic of its own, in one dimension.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

import symrender as sr
from symrender.scene.load import load_any

CELL, ABOVE, OUTLINE = 0.25, 2.0, 0.375
"""Squares; of the point over the floor, with the ball half way; radius of the outline on the floor, 1.5 squares."""
RADIUS = OUTLINE / math.hypot(ABOVE, OUTLINE)
BRIGHT, DARK, WALL, INTENSITY = 0.9, 0.1, 0.8, 3.0
LIGHT = np.array([1.5, 0.3, 0.6])
NAMES = ("shapes.S.center.x", "shapes.S.center.y", "shapes.S.center.z", "shapes.S.radius")


def scene(dx: float, dy: float) -> dict[str, Any]:
    """A ball on the axis of the point (0, 0, 2) that is seen, over a checker with a line through (dx, dy)."""
    checker = {"type": "checker", "bright": [BRIGHT] * 3, "dark": [DARK] * 3, "cell": CELL}
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
            {"type": "plane", "name": "F", "point": [dx, dy, 0], "normal": [0, 0, 1], "along": [1, 0, 0],
             "material": "tiles"},
            {"type": "sphere", "name": "S", "center": [0, 0, 0.5 * ABOVE], "radius": RADIUS, "material": "black"},
        ],
        "lights": [{"type": "point", "name": "L", "position": LIGHT.tolist(), "intensity": [INTENSITY] * 3}],
    }  # fmt: skip


def outline_speed(x: np.ndarray, y: np.ndarray, which: int) -> np.ndarray:
    """Speed at which the outline moves outwards at (x, y) with one of ``NAMES``.

    It is where the distance of the ball's centre c from the ray p + t d is the radius: |c - p|^2 - (d.(c - p))^2 / d^2
    - r^2 = 0, of which the floor's gradient points inwards.
    """
    d = np.stack([x, y, np.full_like(x, -ABOVE)])
    c = np.array([0.0, 0.0, -0.5 * ABOVE])
    square, along = (d * d).sum(0), c @ d
    if which < 3:
        by_number = 2.0 * c[which] - 2.0 * along * d[which] / square
    else:
        by_number = np.full_like(x, -2.0 * RADIUS)
    gradient = [-2.0 * along * c[k] / square + 2.0 * along**2 * d[k] / square**2 for k in range(2)]
    return np.asarray(-by_number / (gradient[0] * x + gradient[1] * y) * np.hypot(x, y))


def along_outline(dx: float, dy: float, which: int) -> float:
    """The derivative, piece by piece between the lines of the checker."""
    ends = [0.0, 2.0 * math.pi]
    for k in range(-4, 5):
        for level, turn in ((k * CELL + dx, 0.0), (k * CELL + dy, 0.5 * math.pi)):
            if abs(level) <= OUTLINE:
                half = math.acos(level / OUTLINE)
                ends += [(turn + half) % (2.0 * math.pi), (turn - half) % (2.0 * math.pi)]
    ends.sort()
    nodes, weights = leggauss(20)
    total = 0.0
    for a, b in pairwise(ends):
        phi = 0.5 * (a + b) + 0.5 * (b - a) * nodes
        x, y = OUTLINE * np.cos(phi), OUTLINE * np.sin(phi)
        middle = OUTLINE * math.cos(0.5 * (a + b)), OUTLINE * math.sin(0.5 * (a + b))
        square = math.floor((middle[0] - dx) / CELL) + math.floor((middle[1] - dy) / CELL)
        albedo = BRIGHT if square % 2 == 0 else DARK
        far2 = (x - LIGHT[0]) ** 2 + (y - LIGHT[1]) ** 2 + LIGHT[2] ** 2
        radiance = albedo / math.pi * INTENSITY * LIGHT[2] / far2**1.5
        arrives = radiance * WALL / math.pi * ABOVE**2 / (x * x + y * y + ABOVE**2) ** 2
        # outwards the outline hides
        total -= float(weights @ (arrives * outline_speed(x, y, which))) * OUTLINE * 0.5 * (b - a)
    return total


@pytest.mark.parametrize("tol", [1e-4, 1e-6])
@pytest.mark.parametrize(
    ("dx", "dy"),
    [
        (0.0, 0.0), (1e-9, 1e-9), (1e-6, -2e-6), (1e-4, 1e-4), (1e-3, 0.0), (0.0, 1e-3), (0.125, 0.0), (0.0, 0.125),
        (0.1249, 1e-7), (0.07, 0.1),
    ],
)  # fmt: skip
def test_derivatives_of_what_is_hidden_hold_where_outlines_touch_lines(dx: float, dy: float, tol: float) -> None:
    slopes = sr.gradient(load_any(scene(dx, dy)), list(NAMES), size=1, tol=tol, threads=1, tile=1)
    for which, name in enumerate(NAMES):
        expected = along_outline(dx, dy, which)
        assert abs(expected) > 1e-3, name
        found, stated = slopes[name].layer("indirect")[0, 0, 0], slopes[name].layer("error")[0, 0]
        # none of these states so much that it tells nothing
        assert stated <= 0.1 * abs(expected) + 100.0 * tol, (name, stated)
        assert abs(found - expected) <= stated + 1e-12, (name, found, expected, stated)


def test_no_derivative_of_what_is_hidden_is_beyond_what_it_states() -> None:
    """Lines at all distances, from none to a square, of where they touch the outline or meet where it touches."""
    rng = np.random.default_rng(20)
    met, judged = 0, 0
    for _ in range(40):
        base = [(0.0, 0.0), (0.125, 0.0), (0.0, 0.125), tuple(rng.uniform(0.0, CELL, 2))][rng.integers(4)]
        away = rng.choice([-1.0, 1.0], 2) * 10.0 ** rng.uniform(-14.0, -1.0, 2) * (rng.random(2) < 0.8)
        dx, dy = (float(x) for x in np.array(base) + away)
        tol = 10.0 ** -float(rng.integers(3, 9))
        slopes = sr.gradient(load_any(scene(dx, dy)), list(NAMES), size=1, tol=tol, threads=1, tile=1)
        for which, name in enumerate(NAMES):
            found, stated = slopes[name].layer("indirect")[0, 0, 0], slopes[name].layer("error")[0, 0]
            met += int(slopes[name].layer("status")[0, 0] == 0)
            judged += 1
            assert abs(found - along_outline(dx, dy, which)) <= stated + 1e-12, (dx, dy, tol, name)
    assert judged == 160
    assert met >= 130
