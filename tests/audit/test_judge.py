"""The tests keep their level, see what they say they see, and say so where they may not judge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from symrender.audit.evidence import Evidence, evidence
from symrender.audit.judge import (
    benjamini_hochberg,
    holm,
    judged,
    pixel_test,
    region_tests,
    scale_test,
)
from symrender.audit.measured import Measured, of_seeds
from symrender.audit.regions import Region
from symrender.audit.verdict import Finding

SHAPE = (24, 32, 3)
RGB = ("R", "G", "B")
ALL = (Region("all", np.ones(SHAPE[:2], dtype=bool), ""),)


def truth_of(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.2, 1.0, SHAPE)


def noisy(truth: np.ndarray, seed: int, *, samples: int = 256, factor: float = 1.0, share: float = 0.05) -> Evidence:
    """A render with normal noise of ``share`` of the truth in a pixel's mean, the variance known as of ``samples``."""
    rng = np.random.default_rng(seed)
    sigma = share * truth
    mean = factor * truth + sigma * rng.standard_normal(SHAPE)
    variance = sigma**2 * rng.chisquare(samples - 1, SHAPE) / (samples - 1)
    found = Measured(mean, variance, samples, "moments", RGB, np.eye(3), False)
    return evidence(found, truth, np.zeros(SHAPE[:2]), None)


def all_tests(seen: Evidence, level: float) -> list[Finding]:
    return judged([scale_test(seen), *region_tests(seen, ALL)], level)


def test_false_alarms_are_as_rare_as_the_level() -> None:
    """500 right renders at level .1, means and pixels: 50 of each expected, more than 68 are no chance (.995)."""
    truth, means, pixels = truth_of(), 0, 0
    for seed in range(500):
        seen = noisy(truth, seed)
        means += any(test.outcome == "failed" for test in all_tests(seen, 0.1))
        pixels += pixel_test(seen, 0.1)[0].outcome == "failed"
    assert 15 <= means <= 68 and 5 <= pixels <= 68


def test_the_stated_bias_is_seen_nine_times_of_ten() -> None:
    truth = truth_of()
    visible = next(test for test in all_tests(noisy(truth, 0), 0.01) if test.region == "all" and test.channel == "G")
    factor = 1.0 + visible.visible_relative
    caught = 0
    for seed in range(200):
        tests = all_tests(noisy(truth, 1000 + seed, factor=factor), 0.01)
        caught += next(t for t in tests if t.name == "mean" and t.channel == "G").outcome == "failed"
    # Holm makes it no less than .9; .99 of chance
    assert caught >= 168


def test_the_scale_and_its_error() -> None:
    truth = truth_of()
    found = np.array([scale_test(noisy(truth, seed, factor=1.01)).bias for seed in range(100)])
    error = scale_test(noisy(truth, 0, factor=1.01)).error
    assert found.mean() == pytest.approx(0.01, abs=4 * error / 10)
    # channels are taken to share their samples, so their error is stated up to sqrt(3) too large
    assert 0.8 < error / found.std() < 2.0


def test_seeds_have_students_distribution() -> None:
    """Eight seeds of pixels that all move together: the scatter of seeds, not of pixels, is the error."""
    truth, alarms = truth_of(), 0
    for seed in range(400):
        rng = np.random.default_rng(seed)
        together = 1.0 + 0.02 * rng.standard_normal((8, 1, 1, 1))
        seen = evidence(of_seeds(truth * together), truth, np.zeros(SHAPE[:2]), None)
        test = next(t for t in region_tests(seen, ALL))
        assert test.freedom == 7
        alarms += test.p <= 0.05
    # 20 expected; the normal distribution in place of Student's would give 36
    assert 8 <= alarms <= 33


def test_an_error_of_the_truth_is_no_fault_of_the_render() -> None:
    truth = truth_of()
    seen = noisy(truth, 1, factor=1.05, share=1e-3)
    assert all_tests(seen, 0.01)[0].outcome == "failed"
    doubtful = evidence(seen.measured, truth, np.full(SHAPE[:2], 0.06), None)
    assert all(test.outcome == "passed" for test in all_tests(doubtful, 0.01))
    assert pixel_test(doubtful, 0.01)[0].rejected == 0


def test_pixels_without_a_truth_are_left_out() -> None:
    truth = truth_of()
    seen = noisy(truth, 1)
    error = np.zeros(SHAPE[:2])
    error[:, :4] = np.inf
    seen.measured.mean[:, :4] = 50.0
    unknown = np.where(np.isinf(error)[..., None], np.nan, truth)
    left = evidence(seen.measured, unknown, error, None)
    assert all(test.outcome == "passed" for test in all_tests(left, 0.01))
    assert pixel_test(left, 0.01)[0].unjudged == 4 * SHAPE[0]


def test_one_wrong_pixel_is_found() -> None:
    truth = truth_of()
    seen = noisy(truth, 3)
    seen.difference[7, 11] += 0.6 * truth[7, 11]
    found, maps = pixel_test(seen, 0.005)
    assert found.outcome == "failed" and found.worst == (11, 7) and found.rejected == 1
    assert maps["rejected"][7, 11] == 1 and maps["rejected"].sum() == 1


def test_a_firefly_is_named_and_not_judged() -> None:
    truth = truth_of()
    mean, variance = truth.copy(), (0.01 * truth) ** 2
    mean[3, 3], variance[3, 3] = 60.0, 20.0**2
    seen = evidence(Measured(mean, variance, 64, "moments", RGB, np.eye(3), False), truth, np.zeros(SHAPE[:2]), None)
    tests = [test for test in all_tests(seen, 0.01) if test.name == "mean"]
    assert [test.outcome for test in tests] == ["not judged"] * 3
    assert all("one pixel carries" in test.why for test in tests)


def test_what_is_not_judged_shields_nothing() -> None:
    """Of too little light in rare samples nothing follows, and the sure test beside it fails all the same."""
    bare = Finding("mean", "all", "R", 384, 1.0, -0.1, 0.008, 0.0, np.inf, -12.5, 1e-35, 1.0, 0.0, "passed", "")
    rare = replace(bare, why="heavy tails")
    sure = replace(bare, region="shapes.A", z=-10.0, p=1e-23)
    right = [replace(bare, region=f"shapes.{k}", z=0.1, p=0.9) for k in range(40)]
    found = judged([rare, sure, *right], 0.005)
    assert [test.outcome for test in found[:2]] == ["not judged", "failed"]
    assert found[0].adjusted > 0.005 > found[1].adjusted and all(test.outcome == "passed" for test in found[2:])
    # Chebyshev's inequality decides by itself where it can, and too much light is no chance of rare samples
    far, bright = replace(rare, z=-200.0, p=0.0), replace(rare, bias=0.1, z=12.5)
    assert [test.outcome for test in judged([far, *right], 0.005)[:1]] == ["failed"]
    assert [test.outcome for test in judged([bright, *right], 0.005)[:1]] == ["failed"]


def test_a_filter_is_noticed() -> None:
    """A tent filter makes neighbours alike; sums then vary more than their pixels say, and alarms stay rare."""
    truth, alarms, spreads = truth_of(), 0, []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal((SHAPE[0] + 2, SHAPE[1] + 2, 3))
        smooth = sum(noise[i : i + SHAPE[0], j : j + SHAPE[1]] for i in range(3) for j in range(3)) / 3.0
        found = Measured(truth + 0.05 * smooth, np.full(SHAPE, 0.05**2), 256, "moments", RGB, np.eye(3), False)
        seen = evidence(found, truth, np.zeros(SHAPE[:2]), None)
        spreads.append(seen.spread)
        alarms += any(test.outcome == "failed" for test in all_tests(seen, 0.05))
    assert min(spreads) > 2.0
    assert alarms <= 25
    assert noisy(truth, 1).spread < 1.5


def test_noiseless_pixels_are_judged_by_the_margin_alone() -> None:
    truth = truth_of().astype(np.float32).astype(np.float64)
    for factor, outcome in ((1.0 + 9e-5, "passed"), (1.0 + 2e-4, "failed")):
        mean = (factor * truth).astype(np.float32).astype(np.float64)
        found = Measured(mean, np.zeros(SHAPE), 1, "none", RGB, np.eye(3), True)
        seen = evidence(found, truth, np.zeros(SHAPE[:2]), None)
        assert {test.outcome for test in all_tests(seen, 0.01)} == {outcome}
        assert pixel_test(seen, 0.01)[0].outcome == outcome


def test_grey_images_are_tested_once() -> None:
    truth = np.repeat(truth_of()[..., :1], 3, axis=-1)
    found = Measured(truth.copy(), np.full(SHAPE, 1e-4), 64, "moments", RGB, np.eye(3), False)
    seen = evidence(found, truth, np.zeros(SHAPE[:2]), None)
    assert [test.channel for test in region_tests(seen, ALL)] == ["grey"]


def test_holm_and_benjamini_hochberg_by_their_definitions() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        p = np.concatenate([rng.uniform(size=20), rng.uniform(size=5) * 1e-3])
        order = np.sort(p)
        kept = [k for k in range(25) if order[k] > 0.05 / (25 - k)]
        assert holm(p, 0.05).sum() == (kept[0] if kept else 25)
        under = [k + 1 for k in range(25) if order[k] <= 0.05 * (k + 1) / 25]
        assert benjamini_hochberg(p, 0.05).sum() == max(under, default=0)
    assert holm(np.array([]), 0.05).sum() == 0
