"""Direct light against a tracer of its own, whole disks against lines across what is seen of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .direct import Count, Look, hostile, judge_direct
from .disk import disk_mean
from .world import world_of

pytestmark = pytest.mark.timeout(1200)

WRONG_ONCE = (1, 16, 39, 56, 94, 109, 120, 170, 204, 227)
"""Scenes in which a pixel was once beyond its stated error, by up to .0643; 16 sees a floor within a ball."""


def sharp(shininess: float, model: str) -> Look:
    """A large disk close by whose highlight on the floor is much narrower than the disk."""
    scene = {
        "camera": {"type": "look_at", "eye": [0, -4, 2.0], "target": [0, 0, 0.5], "fov": 20},
        "spheres": [{"name": "A", "center": [0.3, 1.2, 0.9], "radius": 0.3, "lobe": {"weight": 0.0}}],
        "floor": {"texture": {"type": "solid", "color": [0.3, 0.3, 0.3]}, "lobe": {"weight": 0.0}},
        "lights": [{"name": "L", "type": "disk", "position": [0, 3, 3.0], "target": [0, 0, 0], "radius": 1.0}],
        "shading": {"model": model, "ka": 0, "kd": 0.0, "ks": 1.0, "shininess": shininess},
    }
    return Look(f"sharp {shininess:g} {model}", scene, "exact", 1e-6)


@pytest.mark.parametrize("height", [0.05, 1.0, 30.0])
def test_a_whole_disk_at_the_zenith_and_half_of_one(height: float) -> None:
    light = {"name": "L", "type": "disk", "position": [0.0, 0.0, height], "target": [0.0, 0.0, -9.0], "radius": 0.7}
    scene = {"camera": {"eye": [0.0, -1.0, 1.0]}, "lights": [light], "shading": {"shininess": 0.0}}
    w = world_of(scene, "exact")
    n, v = (0.0, 0.0, 1.0), (0.0, 0.6, 0.8)
    found, shine, doubt = disk_mean(w, 0, False, (0.0, 0.0, 0.0), n, v, w.disks[0], 0.3, 1e-12)
    expected = 2.0 * height / (height + math.hypot(height, 0.7))
    assert found == pytest.approx(expected, abs=1e-11) and shine == pytest.approx(1.0, abs=1e-11) and doubt < 1e-10
    # seen along its plane from aside a vertical disk shows half of itself above the terminator
    upright = {**light, "position": [3.0, 0.0, 0.0], "target": [0.0, 0.0, 0.0]}
    w = world_of({**scene, "lights": [upright]}, "exact")
    found, shine, _ = disk_mean(w, 1, False, (0.0, 0.0, 0.0), n, v, w.disks[0], 0.3, 1e-12)
    assert shine == pytest.approx(0.5, abs=1e-11) and 0.0 < found < 0.5


@pytest.mark.parametrize("seed", [109, 120, 227])
def test_two_ways_across_a_disk_agree_and_see_a_planted_fault(seed: int) -> None:
    look, count = hostile(seed), Count()
    assert look.disk == "exact"
    assert not judge_direct(look, count, 3)
    broken = {**look.scene, "shading": {**look.scene["shading"], "kd": look.scene["shading"]["kd"] + 1e-3, "ks": 1e-3}}
    import symrender as sr

    lit = sr.truth(look.scene, size=3, tol=look.tol, disk="exact", threads=1)
    other = sr.truth(broken, size=3, tol=look.tol, disk="exact", threads=1)
    assert count.lit > 0 and np.abs(lit.layers["direct"] - other.layers["direct"]).max() > 1e-5


@pytest.mark.parametrize("seed", WRONG_ONCE)
def test_pixels_that_were_wrong_are_not(seed: int) -> None:
    count = Count()
    assert not judge_direct(hostile(seed), count)
    assert count.pixels == 25 and count.disks > 0


@pytest.mark.parametrize("model", ["blinn", "phong"])
@pytest.mark.parametrize("shininess", [3e2, 3e4])
def test_highlights_narrower_than_their_disk(shininess: float, model: str) -> None:
    count = Count()
    # fewer pixels where the evaluator takes a tenth of a second for one
    assert not judge_direct(sharp(shininess, model), count, 5 if shininess > 1e3 else 7)
    assert count.lit >= 4


def test_no_pixel_of_hostile_scenes_is_beyond_its_stated_error() -> None:
    count, wrong = Count(), []
    for seed in range(10_000, 10_080):
        look = hostile(seed)
        if look.disk != "exact" or look.scene["shading"]["shininess"] <= 500.0:
            wrong += judge_direct(look, count, 3)
    assert not wrong, [(w.look.name, w.pixel, w.said, w.stated, w.found) for w in wrong]
    assert count.pixels > 400 and count.lit > 100 and count.disks > 80 and count.edges < 0.02 * count.pixels
