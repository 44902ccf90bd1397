"""Roots of walls on a line against the level functions themselves and against numpy."""

from __future__ import annotations

import math
from math import comb

import mpmath as mp
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


def bernstein_of(roots: list[float]) -> np.ndarray:
    """(5,): the quartic with these roots, rounded."""
    powers = [mp.mpf(1)]
    for root in roots:
        higher, lower = [mp.mpf(0), *powers], [*powers, mp.mpf(0)]
        powers = [up - mp.mpf(root) * down for up, down in zip(higher, lower, strict=True)]
    return np.array([float(sum(mp.mpf(comb(i, k)) / comb(4, k) * powers[k] for k in range(i + 1))) for i in range(5)])


def known_roots(p: np.ndarray) -> list[float]:
    """What the rounded quartic has in (0, 1)."""
    exact = [mp.mpf(float(value)) for value in p]
    powers = [sum((-1) ** (k - i) * comb(4, k) * comb(k, i) * exact[i] for i in range(k + 1)) for k in range(5)]
    found = mp.polyroots(powers[::-1], maxsteps=200, extraprec=200)
    return sorted(float(root.real) for root in found if abs(root.imag) < mp.mpf(10) ** -25 and 0 < root.real < 1)


def test_quartic_roots_have_the_digits_that_their_coefficients_give() -> None:
    """Of pairs 1e-8 to .1 apart and of roots 1e-12 to .1 from the ends."""
    rng, judged, close = np.random.default_rng(1), 0, 0
    for trial in range(240):
        a, apart = float(rng.uniform(0.0, 1.0)), 10.0 ** float(rng.uniform(-8.0, -1.0))
        near, far = (10.0 ** float(rng.uniform(-12.0, -1.0)) for _ in range(2))
        pair = [a, a + apart, *rng.uniform(-1.0, 2.0, 2).tolist()]
        with mp.workdps(40):
            p = bernstein_of(pair if trial % 2 else [near, 1.0 - far, 5.0, -3.0])
            known = known_roots(p)
        out = np.zeros(4)
        found = quartic_roots(p, np.zeros((64, 7)), out)
        if found != len(known):
            # two that the coefficients hardly tell apart
            assert trial % 2 and apart < 1e-7
            continue
        for root, true in zip(out[:found], known, strict=True):
            slope = abs(bernstein_value(p, true + 1e-7) - bernstein_value(p, true - 1e-7)) / 2e-7
            noise = 4e-16 * np.abs(p).max() / slope
            assert abs(root - true) <= 0.5 * noise + 2e-16, (trial, root, true)
            judged, close = judged + 1, close + (noise > 1e-13)
    assert judged >= 400 and close >= 30
