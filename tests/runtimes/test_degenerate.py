"""The degenerate scenes of the numeric tests, symbolically: finite, never negative, the same shapes met."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from numeric.test_pipeline import DEGENERATE, LOOK
from symrender.render import render
from symrender.scene.load import load
from symrender.scene.scene import Scene

TIES = {
    "camera on a sphere": "the eye is on the surface: inside or outside is the last bit",
    "huge": "the sphere's top and the floor are one plane to the last bit of 1e12",
    "light aimed along y": "half the disk's points are in the floor plane to the last bit",
}
"""Scenes whose very construction is a tie, where the two may decide differently, each finitely."""
UNEQUAL = 0.05
"""Share of pixels that may differ elsewhere: tangents."""
DIGITS = {"far": 1e-7}
"""Largest difference of direct light where it is not 1e-9: at 4e8 radii a double resolves 6e-8 of one."""


@pytest.mark.parametrize("name", DEGENERATE)
def test_both_pipelines_survive_and_agree(name: str) -> None:
    scene = Scene.model_validate({"camera": LOOK, "ambient": [0.1, 0.1, 0.1]} | DEGENERATE[name], strict=False)
    pair = render(scene, size=(16, 9), lobe=2, numeric="jittered", threads=1)
    assert pair.numeric is not None and pair.symbolic is not None
    for layer in ("radiance", "direct", "gloss"):
        values = pair.symbolic.layer(layer)
        assert np.isfinite(values).all() and (values >= 0).all(), layer
    if name in TIES:
        return
    same = pair.numeric.layer("hit_class") == pair.symbolic.layer("hit_class")
    assert same.mean() >= 1 - UNEQUAL
    difference = np.abs(pair.numeric.layer("direct") - pair.symbolic.layer("direct")).max(axis=-1)
    assert (difference <= DIGITS.get(name, 1e-9)).mean() >= 1 - UNEQUAL


@pytest.mark.parametrize("cell", [1e-12, 1e-18, 1e-19, 1e-20, 1e-40, 1e-150])
@pytest.mark.parametrize("camera", ["look_at", "plane"])
def test_cells_too_small_to_count_are_their_mean(cell: float, camera: str) -> None:
    looks = LOOK if camera == "look_at" else {"type": "plane", "eye": [0.0, 0.0, 3.0], "window_half": 2.0}
    floor = {"texture": {"type": "checker", "cell": cell, "bright": [0.8] * 3, "dark": [0.2] * 3}}
    lights = [{"type": "point", "name": "k", "position": [0.0, 0.0, 5.0]}]
    scenes = [
        Scene.model_validate({"camera": looks, "floor": f, "lights": lights}, strict=False)
        for f in (floor, {"texture": {"type": "solid", "color": [0.5] * 3}})
    ]
    checked, plain = (render(scene, size=(12, 9), lobe=1) for scene in scenes)
    for image, expected in ((checked.numeric, plain.numeric), (checked.symbolic, plain.symbolic)):
        assert image is not None and expected is not None
        seen = expected.layer("hit_class") == 1
        assert seen.sum() > 40 and expected.radiance[seen].min() > 0
        np.testing.assert_allclose(image.radiance[seen], expected.radiance[seen], rtol=2e-3)


@pytest.mark.parametrize("theta", [1e-12, 1e-149, 1e-151, 1e-200, 5e-324])
@pytest.mark.parametrize("rule", [{}, {"normalised": True}, {"weights": "midpoint"}, {"nodes": "barycentre"}])
def test_a_lobe_of_almost_no_angle_is_the_mirror(theta: float, rule: dict[str, Any]) -> None:
    scene = load("gloss")
    narrow, mirror = scene.replace({"floor.lobe.theta_max": theta}), scene.replace({"floor.lobe.mirror": True})
    pairs = [render(s, size=24, lobe=3, threads=1, **rule) for s in (narrow, mirror)]
    for a, b in ((pairs[0].numeric, pairs[1].numeric), (pairs[0].symbolic, pairs[1].symbolic)):
        assert a is not None and b is not None and (b.layer("gloss").max(axis=-1) > 0.05).mean() > 0.1
        difference = np.abs(a.layer("gloss") - b.layer("gloss")).max(axis=-1)
        assert (difference <= 1e-9).mean() >= 1 - 1 / 24**2 * 2, "but for a pixel or two on a texture's edge"
