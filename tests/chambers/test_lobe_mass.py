"""Lobe shares of discs and horizons against closed forms and brute force."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from symrender.chambers.lobe_mass import cap_share, ring_share
from symrender.quadrature.gauss import gauss_table

TABLE = gauss_table()


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
