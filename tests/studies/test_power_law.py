from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from symrender.studies.power_law import fit_power_law, t_quantile


@settings(max_examples=40, derandomize=True, deadline=None)
@given(st.floats(0.1, 6), st.floats(1e-6, 1e6), st.integers(3, 12))
def test_an_exact_power_law_is_recovered(order: float, factor: float, points: int) -> None:
    cost = np.logspace(1, 5, points)
    law = fit_power_law(cost.tolist(), (factor * cost**-order).tolist())
    assert law is not None and law.points == points
    assert law.order == pytest.approx(order, rel=1e-9)
    assert law.factor == pytest.approx(factor, rel=1e-7)
    assert law.low <= law.order <= law.high and law.high - law.low < 1e-6
    assert (law.start, law.end) == pytest.approx((10, 1e5))


def test_the_interval_holds_the_order_as_often_as_it_says() -> None:
    """2000 noisy laws: the share of hits is 0.95 +- 0.02, four standard errors; false alarm 6e-5."""
    rng = np.random.default_rng(3)
    cost = 4.0 ** np.arange(1, 7)
    hits = 0
    for _ in range(2000):
        law = fit_power_law(cost.tolist(), (cost**-0.8 * np.exp(0.2 * rng.standard_normal(len(cost)))).tolist())
        assert law is not None
        hits += law.low <= 0.8 <= law.high
    assert 0.93 < hits / 2000 < 0.97


@pytest.mark.parametrize("freedom", [1, 2, 3, 4, 5, 8, 13, 40])
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_student_quantiles(confidence: float, freedom: int) -> None:
    assert t_quantile(confidence, freedom) == pytest.approx(stats.t.ppf(0.5 + confidence / 2, freedom), rel=1e-9)


@pytest.mark.parametrize(
    ("cost", "error"),
    [([1, 2], [1, 1]), ([1, 1, 2], [3, 2, 1]), ([1, 2, 3], [1, 0, 1]), ([0, 2, 3], [1, 1, 1])],
)  # fmt: skip
def test_no_law_where_there_is_none_to_fit(cost: list[float], error: list[float]) -> None:
    assert fit_power_law(cost, error) is None
