from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.jit.compiled import compiled
from symrender.numeric.estimators import two_sum
from symrender.numeric.lobe import cone_depth
from symrender.numeric.random import pixel_key
from symrender.numeric.samplers import JITTERED, square_point
from symrender.numeric.shading import power
from symrender.scene.scene import Scene

from .conftest import render, with_parts

SAMPLERS = ["jittered", "independent", "importance", "sobol"]


def _furnace(exponent: float, theta_max: float, radiance: float) -> Scene:
    """Background and every surface of one radiance; seen from above, where no lobe of the floor crosses the horizon."""
    lobe = {"weight": 1.0, "exponent": exponent, "theta_max": theta_max}
    return Scene.model_validate(
        {
            "camera": {"type": "plane", "eye": [0.0, 0.0, 400.0], "window_half": 1.5},
            "spheres": [{"name": "a", "center": [0.0, 0.0, 1.2], "radius": 0.5}],
            "floor": {"lobe": lobe},
            "background": [radiance, radiance / 3, radiance / 7],
            "ambient": [radiance / 0.5, radiance / 3 / 0.5, radiance / 7 / 0.5],
            "shading": {"ka": 0.5},
        },
        strict=False,
    )


@pytest.mark.parametrize("numeric", SAMPLERS)
@pytest.mark.parametrize(
    "exponent,theta_max",
    [(0.0, 1.5), (0.5, 1.0), (16.0, 1.0471975511965976), (1e4, 1.5), (1e12, 1.5), (1e12, 1e-9), (3.0, 1e-300)],
)
def test_constant_world_comes_back(numeric: str, exponent: float, theta_max: float) -> None:
    image = render(_furnace(exponent, theta_max, 0.7310585786300049), 8, lobe=5, numeric=numeric)
    expected = np.array([0.7310585786300049, 0.7310585786300049 / 3, 0.7310585786300049 / 7])
    assert set(image["hit_class"].ravel()) == {1.0, 2.0}
    floor = image["hit_class"] == 1
    assert floor.sum() > 30 and image["evaluations"] == floor.sum() * 25
    error = np.abs(image["gloss"][floor] - expected) / np.spacing(expected)
    assert error.max() <= 2


def test_two_sum_loses_nothing() -> None:
    values = np.random.default_rng(1).normal(size=1000) * 10.0 ** np.random.default_rng(2).integers(-12, 12, 1000)
    high = low = 0.0
    for value in values:
        high, low = two_sum(high, low, value)
    assert high + low == pytest.approx(math.fsum(values), rel=4e-16)
    assert abs(sum(values) - math.fsum(values)) > 10 * abs(high + low - math.fsum(values))


def _ratio_of_one_minus_cosine(order: int, pixels: int, exponent: float, height: float) -> tuple[float, float]:
    mean = square = 0.0
    for p in range(pixels):
        key = pixel_key(5, p & 1023, p >> 10)
        top = bottom = 0.0
        for k in range(order * order):
            depth = cone_depth(square_point(JITTERED, key, k, order)[0], height)
            weight = power(1.0 - depth, exponent)
            top += weight * depth
            bottom += weight
        mean += top / bottom
        square += (top / bottom) ** 2
    mean /= pixels
    return mean, math.sqrt(max(0.0, square / pixels - mean * mean) / pixels)


@pytest.mark.parametrize("order,bias", [(2, 0.73), (4, 0.089), (8, 0.0077)])
def test_bias_of_the_ratio_estimator(order: int, bias: float) -> None:
    """f = 1 - cos theta, n = 16, 60 degrees: the ratio of means is not the mean of ratios (math.md 9.6)."""
    exact = 1 - (17 / 18) * (1 - 0.5**18) / (1 - 0.5**17)
    mean, error = compiled(_ratio_of_one_minus_cosine)(order, 400_000, 16.0, 0.5)
    assert error / exact < 0.1 * bias
    # 4.5 standard errors (false alarm 7e-6) and half a unit of the last digit stated
    assert abs(mean / exact - 1 - bias) < 4.5 * error / exact + 0.5 * 10 ** math.floor(math.log10(bias) - 1)


def _one_pixel(chapter8: Scene, **lobe: float) -> Scene:
    """A floor scene with spheres in the lobe and nothing below the horizon, the lobe as given."""
    data = chapter8.model_dump()
    data["floor"]["lobe"] = {"weight": 1.0, "exponent": 16.0, "theta_max": 1.0} | lobe
    data["camera"] = {"type": "plane", "eye": [3.0, -3.0, 2.5], "window_half": 0.02, "window_center": [0.95, -0.83]}
    return Scene.model_validate(data, strict=False)


@pytest.mark.parametrize("numeric", ["jittered", "independent", "importance", "sobol"])
def test_unbiased_where_it_says_so(chapter8: Scene, numeric: str) -> None:
    """Mean over 4096 pixels of one tiny patch against the same patch at K = 96: 4.5 standard errors, three channels
    and four samplers, false alarm 8e-5."""
    scene = _one_pixel(chapter8)
    few = render(scene, 64, lobe=3, numeric=numeric, normalised=True, seed=3)["gloss"].reshape(-1, 3)
    fine = render(scene, 16, lobe=96, numeric="importance", seed=4)["gloss"].reshape(-1, 3)
    reference = fine.mean(axis=0)
    assert reference.min() > 0.02
    error = np.hypot(few.std(axis=0) / 64, fine.std(axis=0) / 16)
    assert (error < 0.03 * reference).all()
    assert (np.abs(few.mean(axis=0) - reference) < 4.5 * error).all()


def test_ratio_is_biased_on_the_same_patch(chapter8: Scene) -> None:
    """The power of the test above: the ratio estimator fails it."""
    scene = _one_pixel(chapter8, exponent=64.0)
    few = render(scene, 64, lobe=2, numeric="independent", seed=3)["gloss"].reshape(-1, 3)
    fine = render(scene, 16, lobe=96, numeric="importance", seed=4)["gloss"].reshape(-1, 3)
    error = np.hypot(few.std(axis=0) / 64, fine.std(axis=0) / 16)
    assert (np.abs(few.mean(axis=0) - fine.mean(axis=0)) > 6 * error).any()


def test_exact_disk_is_unbiased(chapter8: Scene) -> None:
    """Sampled disk against its 32 x 32 rule, mean over pixels: 4.5 standard errors, false alarm 4e-5."""
    scene = _one_pixel(chapter8)
    big = scene.model_dump()
    big["lights"] = [big["lights"][0] | {"radius": 4.0, "position": [1.0, -2.0, 6.0]}, *big["lights"][1:]]
    scene = Scene.model_validate(big, strict=False)
    sampled = render(scene, 64, lobe=2, disk="exact", seed=5, numeric="importance")
    rule = render(scene, 32, lobe=4, disk="24x24", numeric="importance", aa="none")
    assert sampled["direct"].std() > 1e-3
    for layer in ("direct", "gloss"):
        a, b = sampled[layer].reshape(-1, 3), rule[layer].reshape(-1, 3)
        error = np.hypot(a.std(axis=0) / 64, b.std(axis=0) / 32)
        assert a.mean() > 0.02
        assert (np.abs(a.mean(axis=0) - b.mean(axis=0)) < 4.5 * error + 2e-4).all(), layer


@pytest.mark.parametrize("numeric", SAMPLERS)
def test_mirror_limits(chapter8: Scene, numeric: str) -> None:
    """theta_max 0 is one evaluation along the mirror ray; narrow and sharp lobes tend to it."""
    mirror = render(_one_pixel(chapter8, theta_max=0.0), 4, numeric=numeric)
    assert mirror["evaluations"] == 16
    flag = _one_pixel(chapter8).model_dump()
    flag["floor"]["lobe"]["mirror"] = True
    same = render(Scene.model_validate(flag, strict=False), 4, numeric=numeric)
    np.testing.assert_array_equal(same["radiance"], mirror["radiance"])
    assert mirror["gloss"].min() > 0.01
    for theta_max in (1e-12, 1e-100, 1e-300):
        for normalised in (False, True):
            narrow = render(
                _one_pixel(chapter8, theta_max=theta_max), 4, lobe=3, numeric=numeric, normalised=normalised
            )
            np.testing.assert_allclose(narrow["gloss"], mirror["gloss"], rtol=1e-10)
    if numeric in ("importance", "sobol"):
        errors = [
            np.abs(
                render(_one_pixel(chapter8, exponent=n), 4, lobe=16, numeric=numeric)["gloss"] - mirror["gloss"]
            ).max()
            for n in (1e4, 1e8, 1e12)
        ]
        assert errors[0] > errors[1] > errors[2] and errors[2] < 1e-5


def test_lobe_partly_below_the_horizon_keeps_its_weight() -> None:
    """A constant world seen flat: the mean is the share of the lobe above the horizon, not 1."""
    scene = with_parts(
        _furnace(1.0, math.pi / 2, 1.0),
        spheres=[],
        camera={"type": "look_at", "eye": [0.0, -100.0, 1.0], "target": [0.0, 0.0, 0.0], "fov": 0.2},
    )
    image = render(scene, 4, lobe=64, numeric="importance")
    assert (image["hit_class"] == 1).all()
    slope = 0.01
    # n = 1: the half above a plane tilted by the elevation e holds (1 + sin e)/2 of the weight
    assert image["gloss"][..., 0].mean() == pytest.approx((1 + slope) / 2, abs=2e-3)
