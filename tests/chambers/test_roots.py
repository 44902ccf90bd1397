"""Roots of walls on a line against the level functions themselves and against numpy."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.chambers.roots import bernstein_value, circle_roots, quadratic_roots, quartic_roots

unit = st.floats(-1, 1)


@settings(max_examples=80, derandomize=True, deadline=None)
@given(unit, unit, unit, st.floats(1e-9, math.pi - 1e-9), st.floats(0, 6.3))
def test_circle_roots_lie_on_the_circle(x: float, y: float, z: float, alpha: float, phi: float) -> None:
    length = math.sqrt(x * x + y * y + z * z)
    if length < 1e-3:
        return
    a0, a1, a2 = x / length, y / length, z / length
    c, s = math.cos(phi), math.sin(phi)
    found, c1, s1, c2, s2 = circle_roots(a0, a1, a2, math.cos(alpha), math.sin(alpha), c, s)
    away = abs(a2 * c - a1 * s)
    assert found == (away < math.sin(alpha)) or abs(away - math.sin(alpha)) < 1e-12
    if found and math.hypot(a0, a1 * c + a2 * s) > 1e-3:
        for cx, sx in ((c1, s1), (c2, s2)):
            assert abs(math.hypot(cx, sx) - 1) < 1e-9
            assert abs(a0 * cx + (a1 * c + a2 * s) * sx - math.cos(alpha)) < 1e-9


def test_quadratic_roots_do_not_cancel() -> None:
    count, small, large = quadratic_roots(1.0, -5e7, 1.0)
    assert count == 2
    assert abs(small - 1e-8) < 1e-23
    assert abs(large - 1e8) < 1e-7


@settings(max_examples=80, derandomize=True, deadline=None)
@given(st.lists(st.integers(-40, 40).map(lambda k: k / 20), min_size=5, max_size=5))
def test_quartic_roots_match_a_fine_scan(coefficients: list[float]) -> None:
    p = np.array(coefficients)
    out, stack = np.zeros(8), np.zeros((64, 7))
    n = quartic_roots(p, stack, out)
    assert n <= 4
    assert (np.diff(out[:n]) > 0).all()
    scale = max(1e-300, np.abs(p).max())
    for root in out[:n]:
        assert abs(bernstein_value(p, root)) <= 1e-9 * scale
    grid = np.linspace(0, 1, 4001)
    values = np.array([bernstein_value(p, x) for x in grid])
    crossed = np.flatnonzero(values[:-1] * values[1:] < 0)
    for i in crossed:
        assert ((out[:n] >= grid[i] - 1e-9) & (out[:n] <= grid[i + 1] + 1e-9)).any()
