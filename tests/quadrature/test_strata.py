"""Rules over a lobe: what they integrate exactly, how many nodes count, what starves."""

from __future__ import annotations

import math
from typing import get_args

import mpmath
import numpy as np
import pytest

from emitted import FORMULAS
from symrender.quadrature.strata import Rings, mirror_rule, rings, rule
from symrender.settings import Nodes, Partition, Weights

CONE = math.pi / 3


def effective(ring: Rings) -> float:
    """(sum w)^2 / sum w^2: how many rings the rule really uses."""
    return float(ring.weights.sum() ** 2 / (ring.weights**2).sum())


@pytest.mark.parametrize("k", [4, 16, 64])
def test_equal_weight_never_starves_and_equal_angle_does(k: int) -> None:
    equal = rings(FORMULAS, 4096, CONE, k, partition="equal_weight")
    assert effective(equal) == pytest.approx(k, rel=1e-12)
    # the lobe's rms angle is sqrt(2/4096) = .022, a ring of the coarse partition is pi/3k wide
    starved = effective(rings(FORMULAS, 4096, CONE, k, partition="equal_angle"))
    assert starved < 1.01 if k <= 16 else starved < k / 10
    assert effective(rings(FORMULAS, 4096, CONE, k, partition="equal_solid_angle")) < 2


@pytest.mark.parametrize("exponent", [0, 0.5, 16, 4096, 1e6, 1e12])
@pytest.mark.parametrize("partition", get_args(Partition))
@pytest.mark.parametrize("nodes", get_args(Nodes))
@pytest.mark.parametrize("weights", get_args(Weights))
def test_every_rule_is_finite_and_sums_to_one(
    exponent: float, partition: Partition, nodes: Nodes, weights: Weights
) -> None:
    for theta_max in (1e-6, CONE, math.pi / 2):
        for k in (1, 5):
            ring = rings(FORMULAS, exponent, theta_max, k, weights=weights, nodes=nodes, partition=partition)
            assert np.isfinite(ring.weights).all() and (ring.weights >= 0).all() and ring.weights.sum() > 0
            assert (ring.nodes >= 0).all() and (ring.nodes <= theta_max).all() and (np.diff(ring.nodes) > 0).all()
            if weights == "exact":
                assert abs(math.fsum(ring.weights) - 1) <= 4 * 2.0**-52
            ratio = rule(ring, sectors=k, normalised=False)
            assert ratio.directions.shape == (k * k, 3) and ratio.weights.shape == (k * k,)
            assert abs(math.fsum(ratio.weights) - 1) <= 4 * 2.0**-52
            assert np.abs(np.linalg.norm(ratio.directions, axis=1) - 1).max() <= 4 * 2.0**-52
            assert np.abs(ratio.directions[:, 2] - np.cos(np.repeat(ring.nodes, k))).max() == 0


@pytest.mark.parametrize("k", [1, 2, 4, 7])
@pytest.mark.parametrize("exponent", [0, 1.5, 16, 4096])
def test_gauss_is_exact_to_its_degree_and_no_further(exponent: float, k: int) -> None:
    """t = cos^u theta is uniform under the lobe on [cos^u theta_max, 1], so t^d has mean (1 - c^(d+1))/((d+1)(1-c))."""
    ring = rings(FORMULAS, exponent, CONE, k, nodes="gauss", partition="equal_weight")
    u = exponent + 1
    with mpmath.workdps(40):
        t = [mpmath.cos(mpmath.mpf(node)) ** u for node in ring.nodes.tolist()]
        c = mpmath.cos(mpmath.mpf(CONE)) ** u

        def error(degree: int) -> float:
            mean = (1 - c ** (degree + 1)) / ((degree + 1) * (1 - c))
            return float(
                abs(mpmath.fsum(w * x**degree for w, x in zip(ring.weights.tolist(), t, strict=True)) / mean - 1)
            )

        # an ulp of the node's angle moves t by u tan(theta) ulps of the angle
        steep = max(1.0, *(u * math.tan(x) * x for x in ring.nodes.tolist()))
        for degree in range(2 * k):
            assert error(degree) <= 4e-15 * steep * max(1, degree)
        # the first degree beyond misses by the rule's own error term, far above rounding for few nodes
        if k <= 4 and c < 0.6:
            assert error(2 * k) > 1e-8


@pytest.mark.parametrize("partition", get_args(Partition))
@pytest.mark.parametrize("exponent", [0, 0.5, 16, 4096, 1e9])
def test_barycentres_are_exact_for_radiance_linear_in_the_cosine(exponent: float, partition: Partition) -> None:
    u = mpmath.mpf(exponent) + 1
    with mpmath.workdps(40):
        c = mpmath.cos(mpmath.mpf(CONE))
        vers = 1 - u / (u + 1) * (1 - c ** (u + 1)) / (1 - c**u)
    for k in (1, 3, 16):
        exact = rings(FORMULAS, exponent, CONE, k, nodes="barycentre", partition=partition)
        found = math.fsum((exact.weights * 2 * np.sin(exact.nodes / 2) ** 2).tolist())
        assert abs(found / float(vers) - 1) <= 1e-13
    middle = rings(FORMULAS, exponent, CONE, 3, nodes="midpoint", partition=partition)
    found = math.fsum((middle.weights * 2 * np.sin(middle.nodes / 2) ** 2).tolist())
    assert abs(found / float(vers) - 1) > 1e-3


@pytest.mark.parametrize("exponent", [1e4, 1e6, 1e12])
def test_midpoint_weights_survive_a_needle(exponent: float) -> None:
    for k in (1, 4, 64):
        ring = rings(FORMULAS, exponent, CONE, k, weights="midpoint")
        ratio = rule(ring, sectors=4, normalised=False)
        assert np.isfinite(ratio.weights).all()
        # the innermost ring holds the lobe: the mirror is what is left
        assert ratio.weights[:4].sum() == pytest.approx(1, abs=1e-9) or CONE / k < 0.05


def test_midpoint_weights_are_the_source_chapters() -> None:
    """cos^n at the middle times sin times the width, over W."""
    n, k = 16, 8
    ring = rings(FORMULAS, n, CONE, k, weights="midpoint")
    middle = (np.arange(k) + 0.5) * CONE / k
    expected = np.cos(middle) ** n * np.sin(middle) * CONE / k * (n + 1) / (1 - math.cos(CONE) ** (n + 1))
    np.testing.assert_allclose(ring.weights, expected, rtol=1e-13)
    assert abs(ring.weights.sum() - 1) > 1e-4
    normalised = rule(ring, sectors=4, normalised=True)
    assert normalised.weights.sum() == pytest.approx(ring.weights.sum(), rel=1e-14)


def test_directions_are_ring_by_ring_at_the_middle_of_sectors() -> None:
    ring = rings(FORMULAS, 16, CONE, 2)
    found = rule(ring, sectors=4, normalised=True)
    azimuth = np.arctan2(found.directions[:, 1], found.directions[:, 0]) % (2 * math.pi)
    np.testing.assert_allclose(azimuth, np.tile((np.arange(4) + 0.5) * math.pi / 2, 2), rtol=1e-14)
    np.testing.assert_allclose(np.arccos(found.directions[:, 2]), np.repeat(ring.nodes, 4), rtol=1e-12)


def test_mirror_is_one_direction() -> None:
    mirror = mirror_rule()
    assert mirror.directions.tolist() == [[0, 0, 1]] and mirror.weights.tolist() == [1]


def test_strata_converge_to_the_integral_of_a_smooth_radiance() -> None:
    """Mean of cos(theta)^3 + sin(theta) cos(phi) under the lobe: second order in K for midpoints with exact weights."""
    n = 16
    u = n + 1
    c = math.cos(CONE)
    exact = u / (u + 3) * (1 - c ** (u + 3)) / (1 - c**u)
    errors = []
    for k in (8, 16, 32):
        found = rule(rings(FORMULAS, n, CONE, k), sectors=k, normalised=True)
        x, _, z = found.directions.T
        errors.append(abs(found.weights @ (z**3 + x) - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] > 1e-12
    assert (abs(orders - 2) < 0.2).all()
