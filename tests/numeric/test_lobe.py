from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from symrender.numeric.lobe import (
    HEIGHT,
    MASS,
    RATIO,
    cone_density,
    cone_depth,
    direction,
    frame_about,
    lobe_density,
    lobe_depth,
    lobe_rows,
    mirror_direction,
)
from symrender.numeric.random import pixel_key, uniforms

EXPONENTS = [0.0, 0.5, 1.0, 4.0, 16.0, 256.0, 4096.0, 1e6, 1e9]
ANGLES = [1e-3, 0.3, math.pi / 3, math.pi / 2]
Vector = tuple[float, float, float]

unit_vectors = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 1e-3)


@given(unit_vectors, unit_vectors)
@settings(max_examples=100, deadline=None, derandomize=True)
def test_frame_and_mirror(a: Vector, b: Vector) -> None:
    d, n = np.array(a) / math.hypot(*a), np.array(b) / math.hypot(*b)
    m = np.array(mirror_direction((*d,), (*n,)))
    # the inputs are unit to an ulp or two, which the reflection quadruples
    assert m @ n == pytest.approx(-d @ n, abs=4e-15) and m @ m == pytest.approx(1, abs=4e-15)
    np.testing.assert_allclose(mirror_direction((*m,), (*n,)), d, atol=8e-15)
    u1, u2 = (np.array(u) for u in frame_about((*m,), (*n,)))
    gram = np.array([u1, u2, m]) @ np.array([u1, u2, m]).T
    np.testing.assert_allclose(gram, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(u1, u2), m, atol=1e-12)


@pytest.mark.parametrize("m", [(0, 0, 1), (0, 0, -1), (1e-9, 0, 1), (0, 1e-4, -1), (0, 1, 0)])
def test_frame_about_the_normal_itself(m: Vector) -> None:
    m = (*(float(x) for x in m),)
    u1, u2 = (np.array(u) for u in frame_about(m, m))
    np.testing.assert_allclose(np.array([u1, u2, m]) @ np.array([u1, u2, m]).T, np.eye(3), atol=1e-8)
    assert abs(u1 @ u2) < 1e-14


@pytest.mark.parametrize("exponent", [*EXPONENTS, 1e-300, 1e12])
@pytest.mark.parametrize("theta_max", [*ANGLES, 1e-300, 1e-12])
def test_constants_against_fifty_digits(exponent: float, theta_max: float) -> None:
    (row,) = lobe_rows(np.array([[0.3, exponent, theta_max]]))
    assert np.isfinite(row).all() and row[RATIO] > 0
    with mpmath.workdps(700):
        n, t = mpmath.mpf(exponent), mpmath.mpf(theta_max)
        cosine = mpmath.cos(t)
        mass = 1 - cosine ** (n + 1)
        ratio = (1 - cosine) * (n + 1) / mass
        if 1 - cosine > 1e-300:
            assert row[HEIGHT] == pytest.approx(float(1 - cosine), rel=1e-15)
            assert row[MASS] == pytest.approx(float(mass), rel=1e-13)
        assert row[RATIO] == pytest.approx(float(ratio), rel=1e-13)


def _draws(count: int, seed: int) -> np.ndarray:
    return np.array([uniforms(pixel_key(seed, i & 255, i >> 8), 0, 0) for i in range(count)])


CASES = [(n, t) for n in EXPONENTS for t in ANGLES]
ALPHA = 1 - (1 - 1e-3) ** (1 / (2 * len(CASES)))
"""Šidák: the whole family of 72 chi-square tests raises a false alarm with probability 1e-3."""


@pytest.fixture(scope="module")
def draws() -> np.ndarray:
    return _draws(40_000, 11)


@pytest.mark.parametrize("exponent,theta_max", CASES)
def test_lobe_warp_matches_its_density(exponent: float, theta_max: float, draws: np.ndarray) -> None:
    """Cells equal in theta, masses integrated from the stated density; none drawn outside the cone."""
    (row,) = lobe_rows(np.array([[0.3, exponent, theta_max]]))
    warps = {
        "lobe": ([lobe_depth(s, exponent, row[MASS]) for s in draws[:, 0]], exponent, row[MASS], lobe_density),
        "cone": ([cone_depth(s, row[HEIGHT]) for s in draws[:, 0]], 0.0, row[HEIGHT], None),
    }
    for name, (depths, n, mass, density) in warps.items():
        depth = np.array(depths)
        assert depth.min() >= 0 and depth.max() <= row[HEIGHT] * (1 + 1e-12), name
        # ring edges in depth: where the distribution is, whatever the width
        reach = min(row[HEIGHT], 12 / (n + 1)) if n > 0 else row[HEIGHT]
        edges = np.linspace(0, reach, 13)
        middle = (edges[:, None][:-1] + np.diff(edges)[:, None] * (np.arange(400) + 0.5) / 400).clip(0, 1 - 1e-16)
        if density is None:
            value = np.full_like(middle, cone_density(row[HEIGHT]))
        else:
            value = np.vectorize(lambda x, n=n, mass=mass: lobe_density(x, n, mass))(middle)
        mass_of = 2 * np.pi * value.mean(axis=1) * np.diff(edges)  # dw = 2 pi d(depth)
        cells = np.append(mass_of, max(0.0, 1 - mass_of.sum()))
        assert mass_of.sum() == pytest.approx(1, abs=2e-4) if reach == row[HEIGHT] else mass_of.sum() > 0.99
        which = np.minimum(np.searchsorted(edges, depth, side="right") - 1, 12)
        sector = np.minimum((draws[:, 1] * 8).astype(int), 7)
        counted = np.bincount(which * 8 + sector, minlength=104).astype(float)
        expected = np.repeat(cells, 8) / 8 * len(depth)
        rare = expected < 5
        counted, expected = (
            np.append(counted[~rare], counted[rare].sum()),
            np.append(expected[~rare], expected[rare].sum()),
        )
        if expected[-1] < 5:
            counted[-2] += counted[-1]
            expected[-2] += expected[-1]
            counted, expected = counted[:-1], expected[:-1]
        assert len(expected) > 20
        statistic = ((counted - expected) ** 2 / expected).sum()
        assert stats.chi2.sf(statistic, len(expected) - 1) > ALPHA, name


def test_wrong_density_is_noticed(draws: np.ndarray) -> None:
    """Seeded fault: samples of cos^16 against the density of cos^17."""
    (row,) = lobe_rows(np.array([[0.3, 16.0, math.pi / 3]]))
    depth = np.array([lobe_depth(s, 16.0, row[MASS]) for s in draws[:, 0]])
    edges = np.linspace(0, 0.5, 13)
    wrong = np.diff(-((1 - edges) ** 18)) / (1 - 0.5**18)
    counted = np.histogram(depth, edges)[0]
    statistic = ((counted - wrong * len(depth)) ** 2 / (wrong * len(depth))).sum()
    assert stats.chi2.sf(statistic, 11) < 1e-6


def test_direction_keeps_its_angle() -> None:
    u1, u2 = frame_about((0.0, 0.6, 0.8), (0.0, 0.0, 1.0))
    for depth in (0.0, 1e-30, 1e-12, 1e-3, 0.5, 1.0):
        w = np.array(direction(u1, u2, (0.0, 0.6, 0.8), depth, 0.37))
        assert w @ w == pytest.approx(1, abs=4e-16)
        sine = np.linalg.norm(np.cross(w, (0.0, 0.6, 0.8)))
        assert sine == pytest.approx(math.sqrt(depth * (2 - depth)), rel=1e-3, abs=2e-16)
    assert direction(u1, u2, (0.0, 0.6, 0.8), 0.0, 0.37) == (0.0, 0.6, 0.8)
