"""Materials: the formulas against 50 digits and the literature, both pipelines against each other, and their energy."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

from radiometric.lobes import UP, WHITE, Array, conductors, directions, made, materials
from symrender.leaves import radiometric as leaves
from symrender.numeric.radiometric.bsdfs import dispatch
from symrender.radiometric.reflection import reflected
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE, PHONG
from symrender.scene.radiometric.records import Material

Vector = tuple[float, float, float]


def exact(material: Material, wo: Array, wi: Array) -> list[mp.mpf]:
    """f cos_i by the textbook, 50 digits: densities in angles, Smith's G1, Fresnel's amplitudes as complex numbers."""
    o, i = mp.matrix(wo.tolist()), mp.matrix(wi.tolist())
    if material.kind == DIFFUSE:
        return [i[2] / mp.pi] * 3
    if material.kind == PHONG:
        n = mp.mpf(float(material.exponent))
        cosine = -o[0] * i[0] - o[1] * i[1] + o[2] * i[2]
        return [(n + 2) / (2 * mp.pi) * cosine**n * i[2] if cosine > 0 else mp.mpf(0)] * 3
    h = o + i
    h = h / mp.sqrt(mp.fsum(x * x for x in h))
    alpha, theta = mp.mpf(float(material.alpha)), mp.acos(h[2])
    tan2 = mp.tan(theta) ** 2
    if material.density == BECKMANN:
        density = mp.exp(-tan2 / alpha**2) / (mp.pi * alpha**2 * h[2] ** 4)
    else:
        density = 1 / (mp.pi * alpha**2 * h[2] ** 4 * (1 + tan2 / alpha**2) ** 2)

    def smith(z: mp.mpf) -> mp.mpf:
        a = 1 / (alpha * mp.tan(mp.acos(z)))
        if material.density != BECKMANN:
            return 2 / (1 + mp.sqrt(1 + 1 / a**2))
        if material.walter:
            if a >= mp.mpf("1.6"):
                return mp.mpf(1)
            return (mp.mpf("3.535") * a + mp.mpf("2.181") * a**2) / (1 + mp.mpf("2.276") * a + mp.mpf("2.577") * a**2)
        return 2 / (1 + mp.erf(a) + mp.exp(-(a**2)) / (a * mp.sqrt(mp.pi)))

    inward, outward = smith(i[2]), smith(o[2])
    seen = 1 / (1 / inward + 1 / outward - 1) if material.correlated else inward * outward
    cosine = mp.fsum(a * b for a, b in zip(o, h, strict=True))
    found = []
    for eta, k in zip(material.eta, material.k, strict=True):
        n = mp.mpc(float(eta), float(k))
        inner = mp.sqrt(1 - (1 - cosine**2) / n**2)
        s = (cosine - n * inner) / (cosine + n * inner)
        p = (n * cosine - inner) / (n * cosine + inner)
        found.append(density * seen * (abs(s) ** 2 + abs(p) ** 2) / 2 / (4 * o[2]))
    return found


def pairs(count: int) -> list[tuple[Array, Array]]:
    """Directions to the eye and to the light; half of the pairs lie about a mirror direction."""
    eye, light = directions(count, 3), directions(count, 4)
    near = eye * [-1, -1, 1] + 0.05 * light
    light[::2] = (near / np.linalg.norm(near, axis=1, keepdims=True))[::2]
    return [(o, i) for o, i in zip(eye, light, strict=True) if i[2] > 0]


def test_both_pipelines_equal_fifty_digits() -> None:
    mp.mp.dps = 50
    largest, compared = {"formulas": 0.0, "numeric": 0.0}, 0
    for material in materials():
        # a direction of doubles is known to an ulp, of which a narrow lobe makes more
        narrow = 1 + (float(material.exponent) if material.kind == PHONG else 0)
        for wo, wi in pairs(60):
            true = exact(material, wo, wi)
            steep = float(np.hypot(*(wo + wi)[:2]) / (wo + wi)[2] / material.alpha)
            sharp = narrow if material.kind != CONDUCTOR else (1 + steep**2 * (material.density == BECKMANN))
            sharp = sharp / float(material.alpha) if material.kind == CONDUCTOR else sharp
            if float(true[0]) < 1e-200:
                continue
            compared += 1
            values = {
                "formulas": reflected(material, WHITE, UP, tuple(wo), tuple(wi)),
                "numeric": dispatch.scattered(material, False, WHITE, tuple(wo), tuple(wi)),
            }
            for name, value in values.items():
                misses = [abs(float(v / t - 1)) for v, t in zip(value, true, strict=True)]
                largest[name] = max(largest[name], max(misses) / sharp)
    assert compared > 1200
    assert largest["formulas"] < 5e-14 and largest["numeric"] < 5e-14, largest


@pytest.mark.parametrize("density", [0, BECKMANN])
def test_reciprocity_holds_to_rounding(density: int) -> None:
    compared = 0
    for material in (m for m in conductors() if m.density == density):
        for wo, wi in pairs(80):
            there = np.array(reflected(material, WHITE, UP, tuple(wo), tuple(wi))) * wo[2]
            back = np.array(reflected(material, WHITE, UP, tuple(wi), tuple(wo))) * wi[2]
            if there.min() > 1e-200:
                compared += 1
                assert np.abs(there / back - 1).max() < 2e-13
    assert compared > 400


def albedo_by_directions(material: Material, wo: Vector, count: int) -> Array:
    """int f cos_i dw over the upper half by Gauss's rule in the directions of the light, split at the mirror's."""
    x, w = np.polynomial.legendre.leggauss(count)
    azimuth = math.atan2(-wo[1], -wo[0])
    total = np.zeros(3)
    theta0 = math.acos(wo[2])
    for low, high in ((0.0, theta0), (theta0, math.pi / 2)):
        middle, half = (low + high) / 2, (high - low) / 2
        for t, wt in zip(middle + half * x, half * w, strict=True):
            for first in (azimuth - math.pi, azimuth):
                for p, wp in zip(first + math.pi / 2 * (1 + x), math.pi / 2 * w, strict=True):
                    wi = (math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t))
                    total += wt * wp * math.sin(t) * np.array(reflected(material, WHITE, UP, wo, wi))
    return total


def albedo_by_facets(material: Material, wo: Vector, count: int) -> Array:
    """The same in half vectors, of the other pipeline's value: tan theta_h = alpha tan s, dw_i = 4 (wo.h) dh."""
    x, w = np.polynomial.legendre.leggauss(count)
    total = np.zeros(3)
    alpha = float(material.alpha)
    phi = math.atan2(wo[1], wo[0])
    # past the facets' angle at which the light sinks below the surface nothing is reflected
    sine, cosine = math.hypot(wo[0], wo[1]), wo[2]
    for p, wp in zip(math.pi / 2 * (1 + x), math.pi / 2 * w, strict=True):
        # light's z: 2 (o.h) h_z - o_z = 0 is a quadratic in tan(theta_h)
        c = math.cos(p) * sine
        # 2 (cosine + c t)/(1 + t^2) - cosine = 0, the root that is not negative
        most = (c + math.sqrt(c * c + cosine * cosine)) / cosine
        last = math.atan(most / alpha)
        for s, ws in zip(last / 2 * (1 + x), last / 2 * w, strict=True):
            t = alpha * math.tan(s)
            z = 1 / math.sqrt(1 + t * t)
            h = np.array([t * z * math.cos(phi + p), t * z * math.sin(phi + p), z])
            facing = float(np.dot(wo, h))
            wi = 2 * facing * h - np.array(wo)
            # dh = sin dtheta dphi, and dtheta = alpha (1 + tan^2 s)/(1 + t^2) ds
            measure = t * z * alpha * (1 + math.tan(s) ** 2) / (1 + t * t)
            value = np.array(dispatch.scattered(material, False, WHITE, wo, (wi[0], wi[1], max(wi[2], 1e-300))))
            total += 2 * wp * ws * measure * 4 * facing * value
    return total


@pytest.mark.parametrize("alpha", [0.3, 0.6])
@pytest.mark.parametrize(("density", "correlated"), [(0, 0), (0, 1), (BECKMANN, 0)])
def test_directional_albedo_equals_that_in_half_vectors(density: int, correlated: int, alpha: float) -> None:
    material = made(kind=CONDUCTOR, density=density, correlated=correlated, alpha=alpha)
    for z in (0.9, 0.5):
        wo = (math.sqrt(1 - z * z), 0.0, z)
        one, other = albedo_by_directions(material, wo, 48), albedo_by_facets(material, wo, 48)
        assert 0.25 < one.min() < one.max() < 1
        assert np.abs(one - other).max() < 1e-9


def test_a_white_furnace_returns_what_it_should() -> None:
    # a diffuse surface returns its reflectance; phong's (n+2)/(2 pi) exactly 1 straight down
    wo = (0.0, 0.0, 1.0)
    x, w = np.polynomial.legendre.leggauss(60)
    for material, expected in ((made(kind=DIFFUSE), 1.0), (made(kind=PHONG, exponent=7.0), 1.0)):
        z, weight = (1 + x) / 2, w / 2
        values = [reflected(material, WHITE, UP, wo, (math.sqrt(1 - c * c), 0.0, c))[0] for c in z]
        assert abs(2 * math.pi * float(np.dot(weight, values)) - expected) < 1e-12
    # facets project to the surface they cover: int D cos = 1
    for density in (leaves.ggx_density, leaves.beckmann_density):
        for alpha in (0.05, 0.3, 0.9):
            u, weight = (1 + x) / 2, w / 2
            tan2 = alpha**2 * (u / (1 - u) if density is leaves.ggx_density else -np.log1p(-u))
            cos2 = 1 / (1 + tan2)
            # dcos^2/du of the substitution: 2 pi cos sin dtheta = -pi dcos^2
            slope = alpha**2 / (1 - u) ** 2 if density is leaves.ggx_density else alpha**2 / (1 - u)
            mass = [
                math.pi * density(math.sqrt(c), float(t * c), alpha) * s * c**2
                for c, t, s in zip(cos2, tan2, slope, strict=True)
            ]
            assert abs(float(np.dot(weight, mass)) - 1) < 1e-12


def test_weak_white_furnace_of_smith_masking() -> None:
    """int G1(o) D(h) max(0, o.h)/o_z dh = 1: masking shares the projected area among what is seen (Heitz 2014)."""
    x, w = np.polynomial.legendre.leggauss(80)
    for beckmann in (False, True):
        g1 = leaves.beckmann_masking if beckmann else leaves.ggx_masking
        density = leaves.beckmann_density if beckmann else leaves.ggx_density
        for alpha in (0.2, 0.5):
            for z in (0.8, 0.3):
                sine, total = math.sqrt(1 - z * z), 0.0
                for p, wp in zip(math.pi / 2 * (1 + x), math.pi / 2 * w, strict=True):
                    c = math.cos(p) * sine
                    # facets are seen up to tan = -z/c where c < 0
                    last = math.atan(-z / c / alpha) if c < 0 else math.pi / 2
                    for s, ws in zip(last / 2 * (1 + x), last / 2 * w, strict=True):
                        t = alpha * math.tan(s)
                        cos2 = 1 / (1 + t * t)
                        measure = t * math.sqrt(cos2) * alpha * (1 + math.tan(s) ** 2) * cos2
                        facing = (z + c * t) * math.sqrt(cos2)
                        total += 2 * wp * ws * measure * density(math.sqrt(cos2), t * t * cos2, alpha) * facing
                assert abs(g1(z, alpha) * total / z - 1) < 1e-9, (beckmann, alpha, z)


def test_walters_fit_jumps_where_it_should() -> None:
    alpha = 0.3
    edge = 1 / math.sqrt(1 + (1.6 * alpha) ** -2)
    below, above = leaves.walter_masking(edge * (1 - 1e-9), alpha), leaves.walter_masking(edge * (1 + 1e-9), alpha)
    assert above == 1.0 and 5e-5 < below - 1 < 6e-5
    assert abs(leaves.walter_masking(0.2, alpha) / leaves.beckmann_masking(0.2, alpha) - 1) < 4e-3


def test_what_is_chosen_has_the_density_that_is_said() -> None:
    """Mean of g/density over choices is int g: tested with g = cos^4 about the mirror direction."""
    random = np.random.default_rng(11)
    # where a narrow lobe hardly ever chooses a direction, its density times g would need more than these
    wide = (made(kind=DIFFUSE), made(kind=PHONG, exponent=1.0), made(kind=CONDUCTOR, alpha=0.9),
            made(kind=CONDUCTOR, alpha=0.8, density=BECKMANN))  # fmt: skip
    for material in wide:
        wo, values = (0.3, -0.2, math.sqrt(1 - 0.13)), []
        for a, b in random.random((20000, 2)):
            wi = dispatch.choose(material, False, WHITE, wo, a, b, 0.0).wi
            g = max(0.0, -wi[0] * wo[0] - wi[1] * wo[1] + wi[2] * wo[2]) ** 4
            values.append(g / dispatch.density(material, False, WHITE, wo, wi) if wi[2] > 0 else 0.0)
        x, w = np.polynomial.legendre.leggauss(100)
        phi = np.pi * (1 + x)
        wanted = 0.0
        for z, wz in zip((1 + x) / 2, w / 2, strict=True):
            r = math.sqrt(1 - z * z)
            cosine = -r * np.cos(phi) * wo[0] - r * np.sin(phi) * wo[1] + z * wo[2]
            wanted += wz * float(np.dot(np.pi * w, np.maximum(cosine, 0) ** 4))
        error = float(np.std(values)) / math.sqrt(len(values))
        assert error < 0.02 * wanted
        assert abs(float(np.mean(values)) - wanted) < 4 * error
