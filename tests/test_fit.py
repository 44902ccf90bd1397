"""Fits: a scene's own image gives its numbers back."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError, SceneError
from symrender.fit import _untold
from symrender.scene.parameters import get

FREE = ["spheres.B.center.x", "floor.lobe.exponent"]


def test_a_scene_is_found_in_its_own_image() -> None:
    true = sr.load("gloss").replace({"floor.lobe.exponent": 64.0})
    target = sr.truth(true, size=(6, 4), tol=1e-5)
    start = true.replace({"spheres.B.center.x": 1.0, "floor.lobe.exponent": 60.0})
    seen = []
    found = sr.fit(start, target, FREE, tol=1e-5, iterations=8, precision=1e-4, progress=seen.append)
    assert found.converged
    assert len(seen) == len(found.steps) <= 6
    for name in FREE:
        assert found.values[name] == pytest.approx(get(true, name), rel=1e-3), name
        assert found.deviations[name] < 1.0
    assert found.residual < 1e-4
    assert np.allclose(np.diag(found.correlation), 1)
    lines = found.text().splitlines()
    assert [line.split()[0] for line in lines[: len(seen) + 1]] == ["iteration", *map(str, range(1, len(seen) + 1))]
    assert lines[len(seen) + 1].startswith("converged")
    assert found.text(steps=False).splitlines() == lines[len(seen) + 1 :]
    # no image is known better than its tolerance, however little is left
    assert all(found.deviations[name] > 1e-7 for name in FREE)


def test_a_number_that_few_pixels_tell_is_found() -> None:
    """All but a few pixels fit to the last digit after one step: the few are curved, they have not jumped."""
    scene = sr.load("metal")
    start = {"materials.gold50.alpha": 0.4, "lights.key.intensity.r": 60.0}
    target = sr.truth(scene, size=(24, 12))
    slopes = sr.gradient(scene, list(start), size=(24, 12))
    tells = [int((np.abs(slopes[name].radiance) > 1e-9).any(axis=2).sum()) for name in start]
    assert 3 <= tells[0] <= 12 and tells[1] > 8 * tells[0]
    found = sr.fit(scene.replace(start), target, list(start))
    assert found.converged
    for name in start:
        assert found.values[name] == pytest.approx(get(scene, name), rel=1e-8), name


def test_what_only_pixels_that_do_not_count_would_tell_is_not_said_to_be_found() -> None:
    names, jacobian = ["a", "b"], np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 2.0]])
    assert _untold(names, jacobian, np.array([1.0, 1.0, 1e-3, 1e-4])) == ["b"]
    assert _untold(names, jacobian, np.array([1.0, 1.0, 1e-3, 1.0])) == []


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(SceneError, match="unknown name"):
        sr.fit("gloss", sr.truth("furnace", size=2), ["spheres.Z.radius"])


def test_an_exact_disk() -> None:
    """The disk itself, not its points: its radius is found in the width of its penumbra."""
    true = sr.load("penumbra").replace({"floor.lobe.exponent": 12.0})
    target = sr.truth(true, size=2, tol=1e-3, disk="exact")
    start, name = true.replace({"lights.key.radius": 1.0}), "lights.key.radius"
    found = sr.fit(start, target, [name], tol=1e-3, iterations=5, precision=1e-3, disk="exact")
    assert found.converged
    assert found.steps[0].cost > 5e-5
    assert found.values[name] == pytest.approx(1.1, rel=1e-5)
    assert found.residual < 1e-8
    # the disk's four points are another light
    points = sr.truth(found.scene, size=2, tol=1e-3).radiance - target.radiance
    assert np.sqrt((points**2).mean()) > 1e-4


LAMP = {
    "name": "lamp", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 0], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 20},
    "materials": {"clay": {"type": "diffuse", "reflectance": 0.5}},
    "shapes": [{"type": "sphere", "name": "ball", "center": [0.1, 0, 0.05], "radius": 0.7, "material": "clay"}],
    "lights": [{"type": "area", "name": "glow", "shape": "ball", "radiance": [3, 2, 1]}],
}  # fmt: skip


def test_what_only_an_outline_tells_is_found_in_means() -> None:
    """A ball that shines alike everywhere: pixels' centres tell nothing of its radius, their means do."""
    true = sr.load(LAMP)
    names = ["shapes.ball.radius", "shapes.ball.center.x"]
    start = true.replace({"shapes.ball.radius": 0.74, "shapes.ball.center.x": 0.06})
    at_centres = sr.gradient(true, names, size=8)
    assert max(np.abs(at_centres[name].radiance).max() for name in names) == 0.0
    target = sr.truth(true, size=8, tol=1e-8, filter="box")
    assert ((target.radiance[..., 0] > 0.01) & (target.radiance[..., 0] < 2.99)).sum() > 10
    found = sr.fit(start, target, names, tol=1e-7, precision=1e-6, filter="box")
    assert found.converged
    for name in names:
        assert found.values[name] == pytest.approx(get(true, name), abs=1e-6), name


def test_a_target_of_other_pixels_is_refused() -> None:
    true = sr.load(LAMP)
    target = sr.truth(true, size=2, tol=1e-3, filter="box")
    with pytest.raises(OptionError, match=r"filter: a pixel of the target is its box, got centre"):
        sr.fit(true, target, ["shapes.ball.radius"])
    wide = sr.truth(true, size=2, tol=1e-3, filter="tent", filter_radius=1.5)
    with pytest.raises(OptionError, match=r"filter_radius: the target's tent reaches 1\.5 pixels, got 1$"):
        sr.fit(true, wide, ["shapes.ball.radius"], filter="tent")
