"""Weights, barycentres and edges of strata, against 50 digits at the very doubles that enter them."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emitted import FORMULAS
from symrender.quadrature.strata import edges
from symrender.settings import Partition

EXPONENTS = (0.0, 1e-300, 0.5, 1.0, 16.0, 256.0, 4096.0, 1e6, 1e9, 1e12)
ANGLES = (1e-6, 0.3, math.pi / 3, math.pi / 2)
PARTITIONS: tuple[Partition, ...] = ("equal_angle", "equal_solid_angle", "equal_weight")
COUNTS = (1, 2, 7, 64, 1024)
SMALLEST = 2.2250738585072014e-308
Weight = Callable[[float, float, float], float]


def exact_powers(angles: list[float], exponent: float) -> list[mpmath.mpf]:
    """cos^u of each angle."""
    u = mpmath.mpf(exponent) + 1
    return [mpmath.cos(mpmath.mpf(t)) ** u for t in angles]


def naive(a: float, b: float, u: float) -> float:
    """The subtraction that cancels: the seeded fault."""
    return float((math.cos(a) ** u - math.cos(b) ** u) / u)


def faults(weight: Weight, exponent: float, theta_max: float) -> tuple[int, float, float, int]:
    """Weights examined, worst ulps of a sum, worst relative error of a weight, number of negative weights."""
    seen = negative = 0
    ulps = relative = 0.0
    u = exponent + 1
    with mpmath.workdps(50):
        for partition in PARTITIONS:
            for k in COUNTS:
                bounds = edges(FORMULAS, exponent, theta_max, k, partition).tolist()
                weights = [weight(a, b, u) for a, b in pairwise(bounds)]
                total = (1 - exact_powers([theta_max], exponent)[0]) / (mpmath.mpf(exponent) + 1)
                ulps = max(ulps, float(abs(mpmath.mpf(math.fsum(weights)) - total)) / math.ulp(float(total)))
                negative += sum(w < 0 for w in weights)
                step = max(1, k // 24)
                for i in range(0, k, step):
                    inner, outer = exact_powers(bounds[i : i + 2], exponent)
                    exact = (inner - outer) / (mpmath.mpf(exponent) + 1)
                    if exact > SMALLEST:
                        seen += 1
                        relative = max(relative, float(abs(weights[i] - exact) / exact))
    return seen, ulps, relative, negative


@pytest.mark.parametrize("theta_max", ANGLES)
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_weights_sum_to_the_normaliser_and_keep_their_digits(exponent: float, theta_max: float) -> None:
    seen, ulps, relative, negative = faults(FORMULAS.ring_weight, exponent, theta_max)
    assert seen >= 30
    assert negative == 0
    assert ulps <= 4
    assert relative <= 1e-12


def test_the_subtraction_is_caught() -> None:
    caught = [faults(naive, n, t) for n in (16.0, 4096.0) for t in (1e-6, math.pi / 3)]
    assert all(seen >= 30 for seen, *_ in caught)
    assert sum(relative > 1e-12 for _, _, relative, _ in caught) == len(caught)
    assert sum(ulps > 4 for _, ulps, _, _ in caught) >= 2


@settings(max_examples=80, derandomize=True, deadline=None)
@given(
    st.floats(0, math.pi / 2),
    st.floats(0, math.pi / 2),
    st.floats(0, 1),
    st.one_of(st.floats(0, 64), st.floats(0, 12).map(lambda e: 10.0**e)),
)
def test_splitting_a_stratum_conserves_its_weight(a: float, b: float, share: float, exponent: float) -> None:
    a, b = min(a, b), max(a, b)
    middle = min(b, max(a, a + share * (b - a)))
    u = exponent + 1
    whole = FORMULAS.ring_weight(a, b, u)
    parts = FORMULAS.ring_weight(a, middle, u) + FORMULAS.ring_weight(middle, b, u)
    assert whole >= 0
    # each of the three is within 1e-12 of its exact value, or below the normal numbers
    assert abs(parts - whole) <= 2e-12 * whole + 4 * SMALLEST


@pytest.mark.parametrize("theta_max", ANGLES)
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_barycentre_has_the_mean_cosine(exponent: float, theta_max: float) -> None:
    thin = thick = 0
    with mpmath.workdps(60):
        u = mpmath.mpf(exponent) + 1
        for partition in PARTITIONS:
            for k in (1, 7, 64, 1024):
                bounds = edges(FORMULAS, exponent, theta_max, k, partition).tolist()
                for i in range(0, k, max(1, k // 16)):
                    a, b = bounds[i : i + 2]
                    c, d = mpmath.cos(mpmath.mpf(a)), mpmath.cos(mpmath.mpf(b))
                    if c**u - d**u < 1e-290:
                        continue
                    vers = 1 - (c ** (u + 1) - d ** (u + 1)) / (u + 1) * u / (c**u - d**u)
                    angle = FORMULAS.ring_barycentre(a, b, float(u))
                    found = 2 * mpmath.sin(mpmath.mpf(angle) / 2) ** 2
                    assert a <= angle <= b
                    assert abs(found - vers) <= 4e-14 * vers, (partition, k, i)
                    steep = u * mpmath.log(c / d) > 0.03
                    thin, thick = thin + (not steep), thick + steep
    assert thin + thick >= 40
    assert thin or theta_max > 1e-3
    assert thick or u * mpmath.mpf(theta_max) ** 2 < 0.1


@pytest.mark.parametrize("u", [1.0, 2.5, 17.0, 1e6, 1e12])
def test_barycentre_on_both_sides_of_its_switch(u: float) -> None:
    with mpmath.workdps(60):
        for level in (0.0299, 0.0301):
            b = float(mpmath.acos(mpmath.exp(-mpmath.mpf(level) / u)))
            c = mpmath.cos(mpmath.mpf(b))
            vers = 1 - (1 - c ** (u + 1)) / (u + 1) * u / (1 - c ** mpmath.mpf(u))
            angle = FORMULAS.ring_barycentre(0.0, b, u)
            assert abs(2 * mpmath.sin(mpmath.mpf(angle) / 2) ** 2 - vers) <= 4e-14 * vers, level


@pytest.mark.parametrize("theta_max", ANGLES)
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_edges_of_partitions(exponent: float, theta_max: float) -> None:
    seen = 0
    with mpmath.workdps(60):
        u, cone = mpmath.mpf(exponent) + 1, mpmath.mpf(theta_max)
        exact: dict[Partition, Callable[[mpmath.mpf], mpmath.mpf]] = {
            "equal_angle": lambda share: share * cone,
            "equal_solid_angle": lambda share: mpmath.acos(1 - share * (1 - mpmath.cos(cone))),
            "equal_weight": lambda share: mpmath.acos((1 - share * (1 - mpmath.cos(cone) ** u)) ** (1 / u)),
        }
        for partition, angle in exact.items():
            for k in COUNTS:
                bounds = edges(FORMULAS, exponent, theta_max, k, partition)
                assert len(bounds) == k + 1 and bounds[0] == 0 and bounds[-1] == theta_max
                assert (bounds[1:] > bounds[:-1]).all()
                for i in range(1, k, max(1, k // 16)):
                    expected = angle(mpmath.mpf(i) / k)
                    assert abs(bounds[i] - expected) <= 8 * 2.0**-53 * expected, (partition, k, i)
                    seen += 1
    assert seen >= 100


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("angle", [1e-6, 0.3, 1.0, 1.5])
def test_log_weight(angle: float, exponent: float) -> None:
    with mpmath.workdps(50):
        t = mpmath.mpf(angle)
        expected = mpmath.mpf(exponent) * mpmath.log(mpmath.cos(t)) + mpmath.log(mpmath.sin(t))
        level = abs(mpmath.mpf(exponent) * mpmath.log(mpmath.cos(t))) + abs(mpmath.log(mpmath.sin(t)))
    assert abs(FORMULAS.log_weight(angle, exponent) - expected) <= 8 * 2.0**-53 * max(1, level)
