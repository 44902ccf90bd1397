"""The lobe's formulas against the integrals they stand for."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import sympy as sp

from symrender.expression import lobe
from symrender.expression.formulas import lobes
from symrender.expression.vectors import Vec3, cross, dot, span, vec3

A, B = sp.symbols("a b", positive=True)
N, U, D = sp.symbols("n u d", positive=True)
STRATA = ((0, 0.3), (1e-4, 2e-4), (0.2, 0.21), (1.0, 1.4), (0, math.pi / 2))


def _closed(a: sp.Expr, b: sp.Expr, n: sp.Expr) -> sp.Expr:
    return (sp.cos(a) ** (n + 1) - sp.cos(b) ** (n + 1)) / (n + 1)


def test_stratum_integral_is_the_closed_form() -> None:
    found = lobe.stratum_integral(A, B, N)
    assert sp.simplify(found - _closed(A, B, N)) == 0
    # and its derivative is the integrand, whatever SymPy integrated
    integrand = sp.cos(B) ** N * sp.sin(B)
    difference = sp.diff(found, B) - integrand
    for b in (0.1, 0.7, 1.5):
        for n in (0.5, 1, 17):
            assert abs(difference.subs({A: 0.05, B: sp.Rational(b), N: sp.Rational(n)}).evalf(30)) < 1e-25


@pytest.mark.parametrize("n", [0, 0.5, 1, 16, 256])
@pytest.mark.parametrize(("a", "b"), STRATA)
def test_stratum_integral_against_quadrature(a: float, b: float, n: float) -> None:
    with mpmath.workdps(30):
        peak = mpmath.cos(a) ** n
        expected = peak * mpmath.quad(lambda t: mpmath.cos(t) ** n / peak * mpmath.sin(t), mpmath.linspace(a, b, 9))
        values = {A: sp.Rational(a), B: sp.Rational(b), N: sp.Rational(n)}
        found = mpmath.mpf(str(lobe.stratum_integral(A, B, N).subs(values).evalf(30)))
        assert expected > 0
        assert abs(found - expected) <= 1e-15 * expected


@pytest.mark.parametrize("n", [0, 0.5, 16, 4096, 1e9])
@pytest.mark.parametrize(("a", "b"), STRATA)
def test_stable_weight_is_the_closed_form(a: float, b: float, n: float) -> None:
    values = {A: sp.Rational(a), B: sp.Rational(b), N: sp.Rational(n)}
    drop = lobe.log_cos_drop(A, B)
    stable = lobe.stratum_weight(lobes.log_cosine(A), drop, N + 1).subs(values).evalf(40, maxn=400)
    closed = _closed(A, B, N).subs(values).evalf(40, maxn=400)
    assert abs(stable / closed - 1) < sp.Float("1e-30", 40)


@pytest.mark.parametrize("u", [1, 2.5, 17, 1e6])
@pytest.mark.parametrize("d", [1e-6, 0.01, 1, 30])
def test_mean_drop_is_the_mean(d: float, u: float) -> None:
    """Mean of 1 - e^-x over [0, d] under e^(-u x), by its integral; the series where u d <= .03."""
    with mpmath.workdps(40):
        width = mpmath.mpf(d) * mpmath.mpf(u)
        cuts = [0, *(c for c in (1, 10, 60) if c < width), width]
        mass = mpmath.quad(lambda s: mpmath.exp(-s), cuts)
        mean = mpmath.quad(lambda s: -mpmath.expm1(-s / u) * mpmath.exp(-s), cuts) / mass
    values = {D: sp.Rational(d), U: sp.Rational(u)}
    exact = lobe.mean_drop(D, U).subs(values).evalf(40, maxn=2000)
    assert abs(exact / sp.Float(mean, 40) - 1) < 1e-25
    if u * d <= 0.03:
        thin = lobe.mean_drop_thin(D, U).subs(values).evalf(40, maxn=400)
        assert abs(thin / exact - 1) < 1e-15


def test_log_cos_forms() -> None:
    for a, b in STRATA[:4]:
        values = {A: sp.Rational(a), B: sp.Rational(b)}
        drop = (sp.log(sp.cos(A)) - sp.log(sp.cos(B))).subs(values).evalf(40, maxn=400)
        assert abs(lobe.log_cos_drop(A, B).subs(values).evalf(40, maxn=400) / drop - 1) < 1e-30
        assert abs(lobes.log_cosine(B).subs(values).evalf(40) / sp.log(sp.cos(B)).subs(values).evalf(40) - 1) < 1e-30


def test_opaque_functions_stay_opaque_and_know_their_derivatives() -> None:
    for function, plain in ((lobe.log1p, sp.log(1 + A)), (lobe.expm1, sp.exp(A) - 1)):
        kept = sp.simplify(sp.expand(function(A)))
        assert isinstance(kept, function)
        assert sp.simplify(sp.diff(function(A), A) - sp.diff(plain, A)) == 0


@pytest.mark.parametrize("n", [0, 1, 16, 400])
@pytest.mark.parametrize("theta_max", [0.1, math.pi / 3, math.pi / 2])
def test_normaliser_is_the_integral_over_the_cone(n: float, theta_max: float) -> None:
    with mpmath.workdps(30):
        inner = mpmath.quad(lambda t: mpmath.cos(t) ** n * mpmath.sin(t), mpmath.linspace(0, theta_max, 17))
        found = mpmath.mpf(str(lobes.normaliser(lobes.log_cosine(sp.Rational(theta_max)), sp.Integer(n)).evalf(30)))
        assert abs(found / (2 * mpmath.pi * inner) - 1) < 1e-20


@pytest.mark.parametrize("u", [1, 17, 1e6])
def test_share_of_the_lobe(u: float) -> None:
    """The cone whose 1 - cos is ``one_minus_cos(share)`` holds that share of the lobe."""
    theta_max = sp.Rational(11, 10)
    level = lobes.log_cosine(theta_max)
    for share in (sp.Rational(1, 1000), sp.Rational(1, 2), sp.Rational(99, 100)):
        vers = lobe.one_minus_cos(share, level, sp.Rational(u)).evalf(60, maxn=2000)
        held = (1 - (1 - vers) ** sp.Rational(u)) / (1 - sp.cos(theta_max).evalf(60) ** sp.Rational(u))
        assert abs(held.evalf(40) - share) < 1e-30
        assert abs(1 - sp.cos(lobe.angle(vers)).evalf(60) - vers) < 1e-30


def test_mirror_direction_reflects() -> None:
    d, n = vec3("d"), vec3("n")
    m = lobes.mirror_direction(d, n)
    rng = np.random.default_rng(3)
    for _ in range(50):
        normal, incoming = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        values = dict(zip((*d.parts, *n.parts), (*incoming, *normal), strict=True))
        found = np.array([float(part.subs(values)) for part in m.parts])
        assert abs(np.dot(found, normal) + np.dot(incoming, normal)) < 1e-15
        assert np.abs(np.cross(found - incoming, normal)).max() < 1e-15
        assert abs(np.linalg.norm(found) - 1) < 1e-15


def test_frame_is_orthonormal_and_right_handed() -> None:
    axis = Vec3(*(sp.Rational(k, 7) for k in (2, 3, 6)))
    u1, u2 = span(axis, Vec3(sp.Integer(0), sp.Integer(1), sp.Integer(0)))
    gram = [[sp.simplify(dot(a, b)) for b in (u1, u2, axis)] for a in (u1, u2, axis)]
    assert gram == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert [sp.simplify(a - b) for a, b in zip(cross(u1, u2).parts, axis.parts, strict=True)] == [0, 0, 0]


def test_disc_cosines_bound_a_sphere() -> None:
    """Every direction into the disc of a sphere has its cosine between the two, which some directions reach."""
    rng = np.random.default_rng(11)
    inside = 0
    for _ in range(40):
        center, m = rng.normal(size=3) * 3, rng.normal(size=3)
        m /= np.linalg.norm(m)
        distance = float(np.linalg.norm(center))
        radius = distance * rng.uniform(0.05, 0.9)
        along = float(center @ m)
        across, tangent = math.sqrt(distance**2 - along**2), math.sqrt(distance**2 - radius**2)
        low, high = (float(v) for v in lobe.disc_cosines(*map(sp.Float, (along, across, tangent, radius))))
        axis = center / distance
        side = np.cross(axis, m)
        side /= np.linalg.norm(side)
        other = np.cross(side, axis)
        turn = np.linspace(0, 2 * math.pi, 4001)[:, None]
        rim = axis * (tangent / distance) + (np.cos(turn) * side + np.sin(turn) * other) * (radius / distance)
        cosines = rim @ m
        assert abs(cosines.min() - low) < 1e-5 and abs(cosines.max() - high) < 1e-5
        assert low - 1e-12 <= cosines.min() and cosines.max() <= high + 1e-12
        inside += along >= tangent
    assert 0 < inside < 40
