"""Derivatives where panels are too thin to hold anything, and their ends move apart.

A ball cuts a floor that a wall sees: its outline, its shadow and the circle in which it stands in the floor touch one
another, and walls that touch cross at places that run as the floor moves. Between two of those lies a panel that holds
nothing. Left out, with what its ends sweep, a derivative was off by as much as it is itself, at some sizes of the scene
and tolerances: sizes are asked side by side, for only their units differ.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.chambers import crossings
from symrender.jit.compiled import compiled
from symrender.quadrature import split_slopes
from symrender.quadrature.split_point import gloss_kernel
from symrender.scene.load import load_any

NAME, LEVEL = "shapes.floor.point.z", -1.0


def scene(size: float) -> dict[str, Any]:
    """The wall x = 0, seen beside a ball of radius 2 that stands in it and in the floor, under a sun."""
    eye = [3.819040785968841, 5.02887339239107, 0.24253633302615346]
    target = [3.056547029164658, 4.406811491375175, 0.06465361284475166]
    center = [-0.39093917853023336, -0.7089012328966753, -0.5362416190823187]
    return {
        "units": "radiometric", "bounces": 1,
        "camera": {"type": "look_at", "eye": [size * x for x in eye], "target": [size * x for x in target],
                   "up": [0, 0, 1], "fov": 40.0},
        "materials": {"clay": {"type": "diffuse", "reflectance": [0.9, 0.2, 0.5]},
                      "black": {"type": "diffuse", "reflectance": [0.0, 0.0, 0.0]}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, size * LEVEL], "normal": [0, 0, 1], "material": "clay"},
            {"type": "plane", "name": "wall", "point": [0, 0, 0], "normal": [1, 0, 0], "along": [0, 1, 0],
             "material": "clay"},
            {"type": "sphere", "name": "ball", "center": [size * x for x in center],
             "radius": size * 1.9883745666976091,
             "material": "black"}],
        "lights": [{"type": "directional", "name": "sun", "irradiance": [8.5, 0, 8.5],
                    "direction": [-0.17877305184970332, 0.42231992572891025, -1.8886428282862981]}],
    }  # fmt: skip


@pytest.fixture(scope="module")
def slope() -> tuple[np.ndarray, float]:
    """The derivative by the floor's level at size 1, by differences of values, and its doubt."""
    loaded = load_any(scene(1.0))

    def value(step: float) -> tuple[np.ndarray, float]:
        seen = sr.truth(loaded.replace({NAME: LEVEL + step}), size=1, tol=1e-11, threads=1, tile=1, budget=8_000_000)
        return seen.layer("indirect")[0, 0], float(seen.layer("error")[0, 0])

    found = []
    for h in (4e-3, 2e-3):
        (ahead, a), (behind, b) = value(h), value(-h)
        found.append(((ahead - behind) / (2.0 * h), (a + b) / (2.0 * h)))
    best = (4.0 * found[1][0] - found[0][0]) / 3.0
    return best, float(np.abs(best - found[1][0]).max()) + 3.0 * found[1][1]


@pytest.mark.parametrize("size", [1e-4, 1e-3, 1e-2, 1.0, 10.0])
@pytest.mark.parametrize("tol", [1e-4, 1e-6])
def test_what_thin_panels_sweep_is_not_left_out(slope: tuple[np.ndarray, float], size: float, tol: float) -> None:
    known, doubt = slope
    assert np.abs(known).max() > 0.1 and doubt < 1e-6
    image = sr.gradient(load_any(scene(size)), [NAME], size=1, tol=min(1.0, tol / size), threads=1, tile=1)[NAME]
    off = size * np.abs(image.layer("indirect")[0, 0] - known / size).max()
    stated = size * float(image.layer("error")[0, 0])
    assert stated <= 0.05 * np.abs(known).max()
    assert off <= stated + doubt


def test_ends_are_followed_where_rounding_makes_two_crossings_of_one(
    slope: tuple[np.ndarray, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Crossings so close are held still; were they not, what the panels between them sweep is looked at."""
    known, doubt = slope
    monkeypatch.setattr(crossings, "ONE_OF_TWO", 0.0)
    apart = compiled(gloss_kernel, _nrt=False)
    monkeypatch.setattr(split_slopes, "gloss_compiled", lambda: apart)
    for size in (1e-4, 1e-3, 1e-2, 1.0, 10.0):
        for tol in (1e-4, 1e-6):
            image = sr.gradient(load_any(scene(size)), [NAME], size=1, tol=min(1.0, tol / size), threads=1, tile=1)[
                NAME
            ]
            off = size * np.abs(image.layer("indirect")[0, 0] - known / size).max()
            assert off <= size * float(image.layer("error")[0, 0]) + doubt
