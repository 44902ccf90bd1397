"""Limits with a known answer: a world of constant radiance, and the mirror."""

from __future__ import annotations

import itertools
import math
from typing import Any, get_args

import numpy as np
import pytest

from runtimes.test_image import layers_of
from symrender.numeric import pipeline as numeric
from symrender.runtimes import image as symbolic
from symrender.scene import arrays as at
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Nodes, Partition, Sampler, Weights

CONSTANTS = (0.25, 0.1, 1 / 3, math.pi)
RULES = [
    {"weights": weights, "nodes": nodes, "partition": partition}
    for weights, nodes, partition in itertools.product(get_args(Weights), get_args(Nodes), get_args(Partition))
]
SAMPLERS = [sampler for sampler in get_args(Sampler) if sampler != "none"]


def furnace(constant: float) -> Scene:
    """A world in which every ray sees ``constant``."""
    color = (constant,) * 3
    return load("furnace").replace({"ambient": color, "background": color})


def assert_furnace(pipeline: Any, constant: float, **options: Any) -> None:
    """Gloss within 2 ulp of the constant on every floor pixel; all of them are asked for first."""
    layers = layers_of(pipeline, furnace(constant), 24, **options)
    floor = layers["hit_class"] == at.FLOOR
    assert floor.sum() > 150 and (layers["hit_class"] >= at.FIRST_SPHERE).sum() > 50
    assert np.abs(layers["gloss"][floor] - constant).max() <= 2 * math.ulp(constant)
    assert np.abs(layers["radiance"][floor] - 2 * constant).max() <= 2 * math.ulp(2 * constant)


@pytest.mark.parametrize("constant", CONSTANTS)
@pytest.mark.parametrize("options", RULES, ids=lambda options: ",".join(options.values()))
def test_furnace_by_every_rule(constant: float, options: dict[str, Any]) -> None:
    for k in (1, 4, 16):
        assert_furnace(symbolic, constant, lobe=k, **options)


@pytest.mark.parametrize("constant", CONSTANTS)
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_furnace_by_every_sampler(constant: float, sampler: Sampler) -> None:
    for k in (1, 4, 16):
        assert_furnace(numeric, constant, lobe=k, numeric=sampler)


def test_furnace_sees_a_missing_direction() -> None:
    """A lobe that reaches below the horizon loses what it sees there: the exact test fails on it."""
    scene = furnace(0.1).replace({"floor.lobe.theta_max": math.pi / 2})
    layers = layers_of(symbolic, scene, 24, lobe=16)
    floor = layers["hit_class"] == at.FLOOR
    missing = np.abs(layers["gloss"][floor] - 0.1) > 2 * math.ulp(0.1)
    assert missing.sum() > 20


@pytest.mark.parametrize("pipeline", [numeric, symbolic], ids=["numeric", "symbolic"])
@pytest.mark.parametrize("name", ["gloss", "chapter8"])
def test_no_angle_is_the_mirror_bit_for_bit(pipeline: Any, name: str) -> None:
    scene = load(name)
    lobes = ["floor.lobe", "spheres.A.lobe", "spheres.B.lobe"]
    flagged = scene.replace({f"{lobe}.mirror": True for lobe in lobes})
    narrowed = scene.replace({f"{lobe}.theta_max": 0.0 for lobe in lobes})
    a, b = (layers_of(pipeline, each, 48, lobe=4) for each in (flagged, narrowed))
    assert (a["gloss"].max(axis=2) > 1e-3).sum() > 10
    for layer in a:
        assert a[layer].tobytes() == b[layer].tobytes(), layer


def slopes(pipeline: Any, name: str, size: int, exponents: tuple[float, ...], **options: Any) -> list[float]:
    """Slope in log n of the median distance to the mirror, over floor pixels whose mirror ray sees something lit."""
    scene = load(name)
    mirror = layers_of(pipeline, scene.replace({"floor.lobe.mirror": True}), size, lobe=1)
    lit = (mirror["hit_class"] == at.FLOOR) & (mirror["gloss"].max(axis=2) > 0.05)
    assert lit.sum() >= 1000
    medians = []
    for exponent in exponents:
        changes = {"floor.lobe.exponent": exponent, "floor.lobe.theta_max": math.pi / 3}
        layers = layers_of(pipeline, scene.replace(changes), size, **options)
        medians.append(np.median(np.abs(layers["gloss"] - mirror["gloss"]).max(axis=2)[lit]))
    # far above rounding, far below the signal
    assert 1e-10 < medians[-1] < medians[0] < 1e-4
    return (np.diff(np.log(medians)) / np.diff(np.log(exponents))).tolist()


@pytest.mark.parametrize(("name", "size"), [("mirror", 96), ("gloss", 72)])
def test_strata_approach_the_mirror(name: str, size: int) -> None:
    options = {"lobe": 16, "partition": "equal_weight", "nodes": "barycentre"}
    for slope in slopes(symbolic, name, size, (1e7, 1e8, 1e9), **options):
        assert abs(slope + 1) <= 0.1


def test_samples_approach_the_mirror() -> None:
    """2^10 scrambled Sobol' points, a net: their random part, far below sigma/K^2 = 1/(K^2 sqrt n), is what bends the
    slope towards -1/2 for larger n, and walls within reach of the lobe what bends it downwards for smaller n."""
    (slope,) = slopes(numeric, "gloss", 72, (2e6, 1e7), lobe=32, numeric="sobol")
    assert abs(slope + 1) <= 0.1


@pytest.mark.parametrize("theta_max", [1e-9, 1e-149, 1e-151, 1e-300])
def test_a_vanishing_cone_is_the_mirror(theta_max: float) -> None:
    """Below 1e-150 the cone's solid angle is no normal number; above it the strata still weigh it."""
    scene = load("gloss")
    narrow = layers_of(symbolic, scene.replace({"floor.lobe.theta_max": theta_max}), 24)
    mirror = layers_of(symbolic, scene.replace({"floor.lobe.mirror": True}), 24)
    floor = narrow["hit_class"] == at.FLOOR
    assert floor.sum() > 200 and mirror["gloss"][floor].max() > 0.1
    far = np.abs(narrow["gloss"] - mirror["gloss"]).max(axis=2)[floor]
    assert np.isfinite(far).all() and np.median(far) <= 1e-8 and (far <= 1e-6).mean() > 0.99
