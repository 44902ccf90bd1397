"""Fits: a scene's own image gives its numbers back."""

from __future__ import annotations

import numpy as np
import pytest
from tests import fits

import symrender as sr
from symrender.errors import ImageError, OptionError, SceneError
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


BALL = {
    "name": "ball", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.3], "fov": 30},
    "materials": {
        "m": {"type": "diffuse", "reflectance": 0.5},
        "u": {"type": "diffuse", "reflectance": 0.4},
    },
    "shapes": [
        {"type": "plane", "name": "f", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"},
        {"type": "sphere", "name": "A", "center": [0, 0, 0.5], "radius": 0.5, "material": "m"},
        {"type": "sphere", "name": "hid", "center": [0, 40, 0.3], "radius": 0.3, "material": "u"},
    ],
    "lights": [{"type": "point", "name": "k", "position": [1, -2, 2.0], "intensity": 10.0}],
}  # fmt: skip
INTENSITY, REFLECTANCE = "lights.k.intensity", "materials.m.reflectance.color"


def test_of_a_product_no_factor_is_told() -> None:
    """Three channels, each with one product: the target tells three of six numbers, and which."""
    true = sr.load(BALL)
    target = sr.truth(true, size=4, tol=1e-8)
    start = true.replace({INTENSITY: [12.0, 11.0, 9.0], REFLECTANCE: [0.4, 0.4, 0.4]})
    found = sr.fit(start, target, [INTENSITY, REFLECTANCE, "lights.k.position.z"])
    assert found.converged and found.residual < 1e-9
    assert len(found.values) == 7 and found.rank == 4 and len(found.undetermined) == 3
    for channel in "rgb":
        pair = {f"{INTENSITY}.{channel}", f"{REFLECTANCE}.{channel}"}
        (direction,) = (each for each in found.undetermined if set(each) == pair)
        assert direction[f"{INTENSITY}.{channel}"] == 1.0
        assert direction[f"{REFLECTANCE}.{channel}"] == pytest.approx(-1.0, rel=1e-6)
        assert all(found.deviations[name] == np.inf for name in pair)
        product = found.values[f"{INTENSITY}.{channel}"] * found.values[f"{REFLECTANCE}.{channel}"]
        assert product == pytest.approx(5.0, rel=1e-6)
    assert found.deviations["lights.k.position.z"] < 1e-3
    assert np.isnan(found.correlation[0, 1]) and found.correlation[-1, -1] == pytest.approx(1.0)
    lines = found.text(steps=False).splitlines()
    assert "determines 4 of 7" in lines[1]
    assert f"  {INTENSITY}.r x 1, {REFLECTANCE}.r x -1" in lines
    assert sum("(not determined by the target)" in line for line in lines) == 6


def test_a_shape_that_no_ray_meets_is_not_known() -> None:
    true, hidden = sr.load(BALL), "shapes.hid.radius"
    target = sr.truth(true, size=4, tol=1e-8)
    found = sr.fit(true, target, [hidden, f"{INTENSITY}.r"])
    assert found.undetermined == ({hidden: 1.0},) and found.rank == 1
    assert found.values[hidden] == 0.3 and found.deviations[hidden] == np.inf
    assert found.deviations[f"{INTENSITY}.r"] < 1e-3


def test_a_number_at_the_end_of_its_range_is_reported() -> None:
    """A target that 1.25 would meet, where a reflectance ends at 1; the other channels stay inside."""
    true = sr.load(BALL)
    target = sr.truth(true.replace({f"{INTENSITY}.r": 25.0}), size=4, tol=1e-8)
    start = true.replace({REFLECTANCE: [0.9, 0.6, 0.6]})
    found = sr.fit(start, target, [REFLECTANCE])
    red = f"{REFLECTANCE}.r"
    assert found.converged and found.values[red] == 1.0
    assert list(found.at_bound) == [red] and found.at_bound[red] == pytest.approx(1.25, rel=1e-3)
    assert found.deviations[red] >= 0.24
    assert "at the end of its range; without it 1.25" in found.text()
    assert found.undetermined == () and found.rank == 3


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_target_that_is_not_finite_is_refused(bad: float) -> None:
    true = sr.load(BALL)
    radiance = np.array(sr.truth(true, size=4, tol=1e-6).radiance)
    radiance[2, 1, 0] = bad
    with pytest.raises(ImageError, match=r"target: 1 of 16 pixels are NaN or infinite, the first at column 1, row 2"):
        sr.fit(true, sr.Image({"radiance": radiance}), [f"{INTENSITY}.r"])


def test_nothing_free_is_refused() -> None:
    with pytest.raises(OptionError, match="free: must name at least one"):
        sr.fit(BALL, sr.Image({"radiance": np.zeros((2, 2, 3))}), [])


@pytest.mark.parametrize("degrees", [3.0, 1e6])
def test_deviations_are_those_of_repeated_noise(degrees: float) -> None:
    """Student's noise of three degrees, and Gaussian: what the fit's outliers hardly move is not counted for them."""
    true = sr.load(BALL)
    image = sr.truth(true, size=8, tol=1e-8).radiance
    rng, off = np.random.default_rng(7), []
    for _ in range(10):
        target = sr.Image({"radiance": image + 0.01 * rng.standard_t(degrees, image.shape)})
        found = sr.fit(true, target, [INTENSITY], precision=1e-6)
        off += [(value - 10.0) / found.deviations[name] for name, value in found.values.items()]
    assert len(off) == 30 and found.deviations[f"{INTENSITY}.r"] > 1e-3
    assert 0.7 < np.sqrt(np.mean(np.square(off))) < 1.3


@pytest.mark.parametrize("seed", [0, 3, 6, 9, 12])
def test_every_null_direction_is_named(seed: int) -> None:
    """An excerpt of `benchmarks/fits_are_stated.py`."""
    made = fits.case(seed)
    found = sr.fit(made.start, made.target, made.free, tol=1e-6 * made.target.radiance.max(), precision=1e-5)
    assert made.unknown and fits.named(found, made.unknown)
    unknown = {name for each in made.unknown for name in each}
    assert {name for name, deviation in found.deviations.items() if deviation == np.inf} == unknown


def test_a_target_of_other_pixels_is_refused() -> None:
    true = sr.load(LAMP)
    target = sr.truth(true, size=2, tol=1e-3, filter="box")
    with pytest.raises(OptionError, match=r"filter: a pixel of the target is its box, got centre"):
        sr.fit(true, target, ["shapes.ball.radius"])
    wide = sr.truth(true, size=2, tol=1e-3, filter="tent", filter_radius=1.5)
    with pytest.raises(OptionError, match=r"filter_radius: the target's tent reaches 1\.5 pixels, got 1$"):
        sr.fit(true, wide, ["shapes.ball.radius"], filter="tent")
