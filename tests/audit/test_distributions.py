"""Tails and quantiles against SciPy's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from symrender.audit.distributions import critical, detectable, two_sided

SIZES = np.array([0.0, 0.1, 0.7, 1.96, 3.5, 6.0, 12.0, 40.0])


@pytest.mark.parametrize("freedom", [1.0, 2.0, 7.0, 15.5, 63.0, 1000.0, 9000.0])
def test_student_tails_keep_their_digits(freedom: float) -> None:
    true = 2.0 * stats.t.sf(SIZES, freedom)
    held = true > 1e-300
    assert held.sum() >= 7
    found = two_sided(SIZES, freedom)
    assert np.abs(found[held] / true[held] - 1.0).max() < 1e-6


def test_normal_tails() -> None:
    assert two_sided(SIZES) == pytest.approx(2.0 * stats.norm.sf(SIZES), rel=1e-12)


@pytest.mark.parametrize("freedom", [7.0, 30.0, math.inf])
@pytest.mark.parametrize("level", [0.05, 1e-3, 1e-7])
def test_critical_is_the_inverse(level: float, freedom: float) -> None:
    true = stats.norm.isf(level / 2) if math.isinf(freedom) else stats.t.isf(level / 2, freedom)
    assert critical(level, freedom) == pytest.approx(true, rel=1e-6)


def test_the_stated_power_is_had() -> None:
    """A shift of ``detectable`` standard errors is seen nine times of ten."""
    rng = np.random.default_rng(1)
    shift, edge = detectable(1e-3, math.inf), critical(1e-3)
    seen = (np.abs(rng.standard_normal(20_000) + shift) > edge).mean()
    assert seen == pytest.approx(0.9, abs=0.01)
