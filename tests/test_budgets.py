"""No engine takes more than twice the evaluations it is given, and what it could not do is part of the error it states.

Values are judged by the same scenes to a tolerance that they meet with evaluations to spare.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest

import symrender as sr
from symrender.runtimes import tables
from symrender.runtimes.radiometric import prepare
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.settings import split_settings

BUDGETS: Final = (1_000, 10_000, 100_000)
LEAST: Final = 3_000
"""Evaluations that the bounds of all parts of what a ray or a pixel sees may take, whatever the budget."""
CAMERA: Final = {"type": "look_at", "eye": [0.3, -4, 1.6], "target": [0, 0, 0.4], "up": [0, 0, 1], "fov": 40}
TILES: Final = {"type": "checker", "bright": 0.8, "dark": 0.2, "cell": 0.3}
MATERIALS: Final[dict[str, dict[str, Any]]] = {
    "clay": {"type": "diffuse", "reflectance": 0.6},
    "tiles": {"type": "diffuse", "reflectance": TILES},
    "metal": {"type": "conductor", "distribution": "beckmann", "alpha": 0.44, "eta": 1.5, "k": 3},
}
FLOOR: Final = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1]}
BALL: Final = {"type": "sphere", "name": "ball", "center": [0, 0, 0.5], "radius": 0.5, "material": "clay"}
OTHER: Final = {"type": "sphere", "name": "other", "center": [0.9, 0.2, 0.3], "radius": 0.3, "material": "clay"}
BULB: Final = {"type": "sphere", "name": "bulb", "center": [1.2, -0.4, 1.3], "radius": 0.2, "material": "clay"}
GROUND: Final = {"type": "triangle", "name": "ground", "vertices": [[-1, -1, 0], [1, -1, 0], [0, 1.2, 0.1]]}
SAIL: Final = {"type": "triangle", "name": "sail", "vertices": [[-0.8, 0.8, 0.05], [0.8, 0.9, 0.1], [0.1, 1.1, 1.5]]}
KEY: Final = {"type": "point", "name": "key", "position": [-1, -2, 3], "intensity": 20}
FILL: Final = {"type": "point", "name": "fill", "position": [2, -1, 2.5], "intensity": 10}
GLOW: Final = {"type": "area", "name": "glow", "shape": "bulb", "radiance": 4}
SKY: Final = {"type": "sky", "name": "sky", "radiance": 0.5}


def scene(bounces: int | str, material: str, shapes: list[dict[str, Any]], *lights: dict[str, Any]) -> dict[str, Any]:
    """A scene whose shapes without a material are of ``material``."""
    made = [{"material": material} | shape for shape in shapes]
    used = {each["material"]: MATERIALS[each["material"]] for each in made}
    return {
        "units": "radiometric", "name": "budgets", "bounces": bounces, "camera": CAMERA, "materials": used,
        "shapes": made, "lights": list(lights),
    }  # fmt: skip


ROUND: Final = [FLOOR, BALL, OTHER]
FLAT: Final = [GROUND, SAIL, BALL]
RAYS: Final = {
    "a lamp over gloss beside flat shapes": scene(0, "metal", [*FLAT, BULB], GLOW, KEY),
    "two lamps over gloss": scene(0, "metal", [*FLAT, BULB, OTHER], GLOW, {**GLOW, "name": "o", "shape": "other"}),
    "one bounce": scene(1, "clay", ROUND, KEY, FILL),
    "one bounce of a sky": scene(1, "clay", ROUND, SKY),
    "one bounce among checkers": scene(1, "tiles", ROUND, KEY),
    "one bounce in gloss": scene(1, "metal", ROUND, KEY),
    "one bounce between faces": scene(1, "tiles", FLAT, KEY),
}
PIXELS: Final = {
    "a box of checkers": (scene(0, "tiles", ROUND, KEY), {"filter": "box"}),
    "a box under a lamp": (scene(0, "clay", [*ROUND, BULB], GLOW, KEY), {"filter": "box"}),
    "a box of one bounce": (scene(1, "clay", ROUND, KEY, FILL), {"filter": "box"}),
    "a tent over one bounce of a sky": (scene(1, "clay", ROUND, SKY), {"filter": "tent"}),
    "a box over a bounce in gloss": (scene(1, "metal", ROUND, KEY), {"filter": "box"}),
    "a box of checkers between faces": (scene(1, "tiles", FLAT, {**KEY, "intensity": 100}), {"filter": "box"}),
    "a lens": ({**scene(0, "tiles", ROUND, KEY), "camera": {**CAMERA, "aperture": 0.05, "focus": 4}}, {}),
}


@pytest.mark.parametrize("of", RAYS)
def test_rays_take_twice_their_budget_at_most(of: str) -> None:
    eye = np.array(CAMERA["eye"], float)
    aims = np.random.default_rng(5).uniform([-0.7, -0.6, 0], [0.9, 0.6, 0.9], (4, 3))
    rays = (np.tile(eye, (4, 1)), aims - eye)
    known = sr.probe(RAYS[of], rays=rays, tol=1e-5, budget=4_000_000, threads=1)
    assert (known.status == 0).all() and (known.radiance.max(axis=1) > 1e-3).sum() >= 2
    ended = 0
    for budget in BUDGETS:
        found = sr.probe(RAYS[of], rays=rays, tol=1e-11, budget=budget, threads=1)
        assert (found.evaluations <= max(2 * budget, LEAST)).all()
        assert (np.abs(found.radiance - known.radiance).max(axis=1) <= found.error + known.error).all()
        assert ((found.status == 0) == (found.error <= 1e-11)).all()
        ended += int((found.evaluations >= budget // 2).sum())
    assert ended, "no budget of these ends anything"


@pytest.mark.parametrize("of", PIXELS)
def test_pixels_take_twice_their_budget_at_most(of: str) -> None:
    size, (made, options) = 3, PIXELS[of]
    arrays = radiometric_arrays(sr.load(made))

    def rendered(tol: float, budget: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        settings = split_settings(
            size, tol=tol, disk="2x2", aa="analytic", budget=budget, threads=1, tile=0, **options
        )  # fmt: skip
        layers = {name: np.zeros((size, size, 3)) for name in ("emitted", "direct", "indirect", "radiance")}
        layers |= {name: np.zeros((size, size)) for name in ("hit_class", "error", "status")}
        render = prepare(arrays, settings)
        spent = [[render(x, y, x + 1, y + 1, layers) for x in range(size)] for y in range(size)]
        return np.array(spent), layers

    _, known = rendered(1e-2, 10_000_000)
    assert (known["status"] == 0).sum() > 5 and (known["radiance"].max(axis=2) > 1e-2).sum() > 5
    ended = 0
    for budget in BUDGETS:
        spent, found = rendered(1e-10, budget)
        assert (spent <= max(2 * budget, LEAST)).all()
        off = np.abs(found["radiance"] - known["radiance"]).max(axis=2)
        assert (off <= found["error"] + known["error"]).all()
        ended += int((found["status"] != 0).sum())
    assert ended


def test_tables_take_their_share_and_state_what_they_lack(monkeypatch: pytest.MonkeyPatch) -> None:
    """A closed room that reflects 99 parts of 100: its table took minutes, whatever the budget."""
    corners = np.array([[x, y, z] for z in (0.0, 2.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    sides = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    faces = [
        {"type": "triangle", "name": f"side{k}{part}", "vertices": corners[list(each)].tolist(), "material": "white"}
        for k, (a, b, c, d) in enumerate(sides)
        for part, each in enumerate(((a, b, c), (a, c, d)))
    ]
    light = {"type": "point", "name": "key", "position": [0.2, 0.1, 1.5], "intensity": 1}
    white = {"type": "diffuse", "reflectance": 0.99, "two_sided": True}
    room = {
        "units": "radiometric", "name": "white", "bounces": "all", "camera": CAMERA, "materials": {"white": white},
        "shapes": faces, "lights": [light],
    }  # fmt: skip
    spent: list[tables.Spent] = []

    class Seen(tables.Spent):
        def __init__(self, most: float) -> None:
            super().__init__(most)
            spent.append(self)

    monkeypatch.setattr(tables, "Spent", Seen)
    rays, budget = ([[0, -0.9, 1]] * 2, [[0, 1, 0.1], [0.2, 1, -0.3]]), 40_000
    found = sr.probe(room, rays=rays, tol=1e-3, budget=budget, threads=1)
    assert len(spent) == 1 and spent[0].most == tables.SHARED * budget
    assert 0.1 * spent[0].most < spent[0].evaluations <= 2 * spent[0].most
    assert (found.status == 1).all() and (found.evaluations <= 2 * budget).all()
    # what the light sends, 4 pi, is absorbed: .01 of the mean irradiance times 24 square metres
    mean = 0.99 * 4.0 * np.pi / (0.01 * 24.0) / np.pi
    assert (
        np.isfinite(found.error).all() and (np.abs(found.radiance - mean).max(axis=1) < found.error + 0.05 * mean).all()
    )
