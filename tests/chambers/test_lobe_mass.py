"""Lobe shares of discs and horizons against closed forms and brute force."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from symrender.chambers.lobes.mass import ROUNDED_SHARE, cap_share, facing_mass, ring_share, tilt_of
from symrender.jit.compiled import compiled
from symrender.jit.twins import moving_by
from symrender.jit.types import SEVERAL
from symrender.quadrature.gauss import gauss_table

TABLE = gauss_table()


def shares(given: np.ndarray, gauss: np.ndarray, out: np.ndarray) -> None:
    """The share above a horizon of a lobe given by its exponent, rim and tilt."""
    out[0] = cap_share(given[0], given[1], given[2], 0.5 * math.pi, gauss)


SHARES = compiled(shares)


def cap_slopes(n: float, theta_max: float, alpha: float) -> np.ndarray:
    """Slopes of that share in the three."""
    out: Any = np.zeros(1, SEVERAL)
    # from a right angle a rim can only come in
    theta = min(theta_max, 0.5 * math.pi - 1e-12)
    SHARES(moving_by(np.array([n, theta, alpha]), list(np.eye(3))), TABLE, out)
    return np.asarray(out["tangents"][0, :3])


@pytest.mark.parametrize("n", [0.0, 0.5, 3.0, 16.0, 256.0, 1e6, 1e9])
@pytest.mark.parametrize("alpha", [1e-3, 0.2, 1.0])
def test_disc_on_the_axis(n: float, alpha: float) -> None:
    u = n + 1
    closed = math.expm1(u * math.log(math.cos(alpha))) / math.expm1(u * math.log(math.cos(1.3)))
    assert cap_share(n, 1.3, 0.0, alpha, TABLE) == pytest.approx(min(1.0, closed), rel=1e-9)


@pytest.mark.parametrize("n", [0.0, 3.0, 16.0, 300.0])
def test_horizon_through_the_axis_leaves_half(n: float) -> None:
    assert cap_share(n, 1.0, math.pi / 2, math.pi / 2, TABLE) == pytest.approx(0.5, abs=1e-13)


def test_uniform_half_space_and_a_cap() -> None:
    # n = 0 over the half-space: a cap wholly inside has its share of the solid angle
    assert cap_share(0.0, math.pi / 2, 0.7, 0.5, TABLE) == pytest.approx(1 - math.cos(0.5), rel=1e-12)


@pytest.mark.parametrize(("n", "beta", "alpha"), [(1.0, 0.9, 0.5), (16.0, 0.4, 0.6), (40.5, 1.2, 1.4)])
def test_brute_force(n: float, beta: float, alpha: float) -> None:
    rings, sectors = 2000, 2000
    u, end = n + 1, 1 - math.cos(1.1) ** (n + 1)
    t = (np.arange(rings) + 0.5) / rings * end
    c = (1 - t) ** (1 / u)
    phi = 2 * math.pi * (np.arange(sectors) + 0.5) / sectors
    s = np.sqrt(1 - c * c)
    inside = c[:, None] * math.cos(beta) + s[:, None] * np.cos(phi) * math.sin(beta) > math.cos(alpha)
    assert 0.01 < inside.mean() < 1
    assert cap_share(n, 1.1, beta, alpha, TABLE) == pytest.approx(inside.mean(), abs=2e-4)


def test_rings_add_up() -> None:
    edges = np.linspace(0, 1.2, 9)
    total = sum(ring_share(1e5, a, b, 1.2) for a, b in itertools.pairwise(edges))
    assert total == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("n", [0.0, 0.5, 16.0, 1e6])
@pytest.mark.parametrize("theta_max", [0.3, 1.2, math.pi / 2])
def test_mean_facing_of_an_upright_lobe(n: float, theta_max: float) -> None:
    # mean cosine (u/(u + 1)) (1 - c^(u + 1))/(1 - c^u)
    u, log_c = n + 1, math.log(max(math.cos(theta_max), 1e-300))
    closed = u / (u + 1) * math.expm1((u + 1) * log_c) / math.expm1(u * log_c)
    assert facing_mass(n, theta_max, 0.0, TABLE) == pytest.approx(closed, rel=1e-12)


def test_mean_facing_of_tilted_lobes() -> None:
    # above the horizon altogether it is the upright mean times cos beta; in the horizon, a half-disc of cosines
    assert facing_mass(9.0, 0.4, 1.1, TABLE) == pytest.approx(math.cos(1.1) * facing_mass(9.0, 0.4, 0.0, TABLE), 1e-12)
    # half the hemisphere is above the horizon, at mean height 1/2
    assert facing_mass(0.0, math.pi / 2, math.pi / 2, TABLE) == pytest.approx(0.25, rel=1e-12)
    n, beta, theta_max = 5.0, 0.9, 1.4
    u, end = n + 1, 1 - math.cos(theta_max) ** (n + 1)
    t = (np.arange(3000) + 0.5) / 3000 * end
    c = ((1 - t) ** (1 / u))[:, None]
    phi = 2 * np.pi * (np.arange(3000) + 0.5) / 3000
    facing = np.maximum(c * math.cos(beta) + np.sqrt(1 - c * c) * math.sin(beta) * np.cos(phi), 0.0)
    assert facing_mass(n, theta_max, beta, TABLE) == pytest.approx(facing.mean(), abs=2e-6)


@pytest.mark.parametrize("theta_max", [0.4, 1.5, math.pi / 2 - 1e-6, math.pi / 2])
@pytest.mark.parametrize("n", [0.0, 0.01, 0.3, 0.5, 1.5, 7.3])
def test_shares_above_a_horizon_and_their_slopes_at_fractional_exponents(n: float, theta_max: float) -> None:
    # by azimuths about the axis, to 30 digits, on which nothing is fractional but the end of each ray
    tilt, digits = mp.mpf(1.3), mp.mpf(10) ** -12
    rim = mp.pi / 2 if theta_max == math.pi / 2 else mp.mpf(theta_max)

    def share(u: mp.mpf, alpha: mp.mpf) -> mp.mpf:
        def ray(phi: mp.mpf) -> mp.mpf:
            end = mp.atan2(mp.cos(alpha), -mp.sin(alpha) * mp.cos(phi))
            return 1 - mp.cos(min(end, rim)) ** u

        turn = mp.mpf(0) if rim == mp.pi / 2 else mp.acos(mp.cot(alpha) / mp.tan(rim))
        corners = [0, turn, mp.pi / 2, mp.pi - turn, mp.pi]
        return mp.quad(ray, sorted(set(corners))) / (mp.pi * ray(mp.mpf(0)))

    with mp.workdps(30):
        u = mp.mpf(n) + 1
        expected = share(u, tilt)
        by_n = (share(u + digits, tilt) - share(u - digits, tilt)) / (2 * digits)
        by_tilt = (share(u, tilt + digits) - share(u, tilt - digits)) / (2 * digits)
    assert 0.3 < expected < 0.95
    value = cap_share(n, theta_max, 1.3, math.pi / 2, TABLE)
    assert abs(value - float(expected)) < ROUNDED_SHARE
    slopes = cap_slopes(n, theta_max, 1.3)
    assert abs(by_tilt) > 0.1
    assert slopes[2] == pytest.approx(float(by_tilt), rel=1e-12)
    assert slopes[0] == pytest.approx(float(by_n), abs=3e-12)


@pytest.mark.parametrize("n", [0.0, 1.0, 8.0])
@pytest.mark.parametrize("theta", [1.2, math.pi / 2])
def test_slopes_of_what_is_above_a_horizon(n: float, theta: float) -> None:
    """A rim that begins to come in from a right angle moves what is on it, of a lobe of exponent 0 as much as any."""
    quarter, h = 0.5 * math.pi, 1e-4
    for alpha in (0.6, 1.1, 1.9):
        share = cap_share(n, theta, alpha, quarter, TABLE)
        back = [cap_share(n, theta - k * h, alpha, quarter, TABLE) for k in (1, 2)]
        by_theta = (3.0 * share - 4.0 * back[0] + back[1]) / (2.0 * h)
        ahead = [cap_share(n + k * h, theta, alpha, quarter, TABLE) for k in (1, 2)]
        by_n = (4.0 * ahead[0] - 3.0 * share - ahead[1]) / (2.0 * h)
        ends = [cap_share(n, theta, alpha + k * h, quarter, TABLE) for k in (1, -1)]
        by_alpha = (ends[0] - ends[1]) / (2.0 * h)
        told = cap_slopes(n, theta, alpha)
        assert told == pytest.approx([by_n, by_theta, by_alpha], abs=2e-6), (n, theta, alpha)
        assert np.abs(told).max() > 1e-3


def test_narrow_discs_keep_their_digits() -> None:
    # the share of a narrow uniform lobe is the overlap of two flat discs, but for the square of its width
    lobe, disc, apart = 1e-4, 7e-5, 9e-5
    x = (apart**2 + lobe**2 - disc**2) / (2 * apart)
    y = (apart**2 - lobe**2 + disc**2) / (2 * apart)
    lens = lobe**2 * math.acos(x / lobe) + disc**2 * math.acos(y / disc) - apart * math.sqrt(lobe**2 - x**2)
    assert 0.1 < lens / (math.pi * lobe**2) < 0.9
    assert cap_share(0.0, lobe, apart, disc, TABLE) == pytest.approx(lens / (math.pi * lobe**2), rel=1e-8)


def test_a_tilt_that_a_cosine_cannot_tell() -> None:
    axis = np.array([math.sin(1e-9), 0.0, math.cos(1e-9)])
    assert axis[2] == 1.0
    assert tilt_of(axis, np.array([0.0, 0.0, 1.0])) == pytest.approx(1e-9, rel=1e-12)
