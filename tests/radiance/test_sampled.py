"""Sampled pixels: what quadrature knows lies in their intervals, and what it refuses is answered."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy import stats

import symrender as sr
from symrender.errors import Unsupported
from symrender.radiance.interval import HEAVY, LEVEL, half_width

FLOOR = {"type": "plane", "name": "F", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "grey"}
LAMP = {"type": "rectangle", "name": "R", "corner": [-1, -1, 2], "edge_u": [0, 2, 0], "edge_v": [2, 0, 0],
        "material": "grey"}  # fmt: skip
BALL = {"type": "sphere", "name": "B", "center": [0, 0, 0.5], "radius": 0.5, "material": "metal"}


CAMERA = {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.4], "fov": 35}


def world(**changes: Any) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "w", "bounces": 0,
        "camera": CAMERA,
        "materials": {
            "grey": {"type": "diffuse", "reflectance": 0.5},
            "metal": {"type": "conductor", "distribution": "ggx", "alpha": 0.2, "eta": 0.2, "k": 3.0},
        },
        "shapes": [FLOOR, LAMP, BALL],
        "lights": [{"type": "area", "name": "L", "shape": "R", "radiance": 3.0}],
    } | changes  # fmt: skip


def test_sampled_pixels_hold_what_quadrature_knows() -> None:
    asked: dict[str, Any] = {"size": 10, "tol": 5e-3, "threads": 1}
    exact = sr.truth("interreflection", **asked | {"tol": 1e-4})
    image = sr.truth("interreflection", method="sampled", budget=200_000, **asked)
    signal = exact.radiance.max(axis=2) > 0.01
    assert signal.sum() > 50 and (image.layer("indirect").max(axis=2) > 1e-3).sum() > 30
    off = np.abs(image.radiance - exact.radiance).max(axis=2)
    assert (off <= image.layer("error") + exact.layer("error")).all()
    # an interval that holds everything says nothing
    assert np.median(image.layer("error")[signal] / exact.radiance.max(axis=2)[signal]) < 0.1
    assert (image.layer("status") == (image.layer("error") > 5e-3)).all()
    assert set(np.unique(image.layer("kind"))) <= {2.0, 3.0}


@pytest.mark.parametrize(
    "changes",
    [
        {"filter": "gaussian"},
        {"bounces": 6},
        {"bounces": "all", "filter": "box"},
        {
            "camera": {
                "type": "look_at",
                "eye": [0, -5, 2],
                "target": [0, 0, 0.4],
                "fov": 35,
                "aperture": 0.1,
                "focus": 5,
            }
        },
        {"shutter": [0, 1], "shapes": [FLOOR, LAMP, BALL | {"velocity": [0.3, 0, 0]}], "bounces": 1},
    ],
)
def test_combinations_that_quadrature_refuses_are_sampled(changes: dict[str, Any]) -> None:
    asked = {"filter": changes.get("filter", "centre"), "size": 6, "tol": 0.05, "budget": 50_000, "threads": 1}
    scene = world(**{key: value for key, value in changes.items() if key != "filter"})
    with pytest.raises(Unsupported):
        sr.truth(scene, method="quadrature", **asked)
    image = sr.truth(scene, **asked)
    assert image.radiance.max() > 0.1 and np.isfinite(image.layer("error")).all()
    assert "sampled: " in json.loads(image.meta["providers"])["indirect"]
    runs = [sr.truth(scene, **asked | {"method": "sampled", "budget": 20_000}) for _ in range(2)]
    assert np.array_equal(runs[0].radiance, runs[1].radiance)
    other = sr.render(
        scene, size=6, numeric="jittered", symbolic="none", lobe=24, seed=99, filter=asked["filter"], threads=1
    ).numeric
    # one more run of the tracer by itself; single pixels of it are noisy
    assert other.radiance.mean() == pytest.approx(image.radiance.mean(), rel=0.05)


def test_direct_light_that_quadrature_covers_is_not_sampled() -> None:
    scene = sr.load("interreflection").replace({"bounces": 3})
    image = sr.truth(scene, size=6, tol=1e-2, threads=1)
    alone = sr.truth(scene.replace({"bounces": 0}), size=6, tol=1e-2, threads=1)
    providers = json.loads(image.meta["providers"])
    assert providers["direct"] == "quadrature" and providers["indirect"].startswith("sampled: bounces: 3")
    assert alone.layer("direct").max() > 0.1
    assert np.array_equal(image.layer("direct"), alone.layer("direct"))


def test_bytes_do_not_depend_on_tiles() -> None:
    asked: dict[str, Any] = {"size": (7, 5), "tol": 1e-2, "method": "sampled", "budget": 30_000}
    one, other = (sr.truth(world(), threads=n, tile=side, **asked) for n, side in ((1, 7), (2, 3)))
    assert one.radiance.max() > 0.1
    for name in one.layers:
        assert np.array_equal(one.layer(name), other.layer(name)), name


def test_budgets_are_kept_within_twice() -> None:
    from symrender.execution.fill import Crew, Means
    from symrender.truth import split_settings, truth_job

    for budget in (10_000, 200_000):
        settings = split_settings(
            4, tol=1e-7, disk="2x2", aa="analytic", budget=budget, threads=1, tile=0, method="sampled"
        )  # fmt: skip
        job = truth_job(sr.load(world(bounces=5)), settings)
        with Crew(Means(1, 0, "", False), (job,), None) as crew:
            _, timing = crew.fill(job)
        assert 0.2 * budget < timing.evaluations / 16 <= 2 * budget


@pytest.mark.parametrize("kind", ["normal", "uniform", "exponential", "lognormal"])
def test_intervals_cover_means_of_known_distributions(kind: str) -> None:
    """At a level at which failures can be counted: the quantile is that of Student, widened for skewness."""
    rng = np.random.default_rng(5)
    draws = {
        "normal": lambda: rng.normal(1.0, 1.0, (32, 200_000)),
        "uniform": lambda: rng.uniform(0.0, 2.0, (32, 200_000)),
        "exponential": lambda: rng.exponential(1.0, (32, 200_000)),
        "lognormal": lambda: rng.lognormal(-0.5, 1.0, (32, 200_000)),
    }[kind]()
    width, skewed = half_width(draws)
    outside = int((np.abs(draws.mean(axis=0) - 1.0) > width).sum())
    student = stats.t.ppf(1.0 - LEVEL / 2.0, 31) * draws.std(axis=0, ddof=1) / np.sqrt(32.0)
    unwidened = int((np.abs(draws.mean(axis=0) - 1.0) > student).sum())
    # LEVEL x 200,000 = .11 are expected. No interval of 32 draws holds that level under so heavy a tail as the last:
    # many of its intervals are called heavy-tailed.
    assert outside <= {"normal": 3, "uniform": 3, "exponential": 20, "lognormal": 100}[kind]
    if kind in ("exponential", "lognormal"):
        assert unwidened > 50 and outside < 0.2 * unwidened
    assert (np.mean(skewed > HEAVY * width) > 0.2) == (kind == "lognormal")
    assert (width >= student).all()
