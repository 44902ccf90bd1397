"""Reflection by facets: densities of their normals, masking, the Fresnel factor of a conductor.

B. Walter, S. Marschner, H. Li, K. Torrance, "Microfacet models for refraction through rough surfaces", EGSR 2007,
doi:10.2312/EGWR/EGSR07/195-206; E. Heitz, "Understanding the masking-shadowing function in microfacet-based BRDFs",
JCGT 3(2), 2014. Cosines are to the surface's normal unless said otherwise; ``alpha`` is the roughness in D.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, erf, exp, length, pi, positive, ramp, ratio, sqrt, where_positive
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, cross, dot, norm2


def half_angles(normal: Vec3, view: Vec3, light: Vec3) -> tuple[Real, Real, Real]:
    """(N.h, |N x h|^2, v.h) of the half vector h = unit(v + l): its cosine, the square of its sine, its incidence."""
    sum_ = view + light
    square = positive(norm2(sum_))
    size = sqrt(square)
    return dot(normal, sum_) / size, norm2(cross(normal, sum_)) / square, size * ratio(1, 2, size)


def ggx_density(cosine: Real, sine2: Real, alpha: Real) -> Real:
    """D = alpha^2/(pi (alpha^2 cos^2 + sin^2)^2) of a facet's normal, GGX."""
    spread = alpha * alpha
    bottom = spread * cosine * cosine + sine2
    return spread / (pi(alpha) * bottom * bottom)


def beckmann_density(cosine: Real, sine2: Real, alpha: Real) -> Real:
    """D = exp(-tan^2/alpha^2)/(pi alpha^2 cos^4) of a facet's normal, Beckmann."""
    square = positive(cosine * cosine)
    spread = alpha * alpha
    return exp(-sine2 / (spread * square)) / (pi(alpha) * spread * square * square)


def smith_root(cosine: Real, alpha: Real) -> Real:
    """sqrt(alpha^2 + (1 - alpha^2) cos^2), by which GGX masks."""
    return length(alpha * alpha + (1 - alpha) * (1 + alpha) * cosine * cosine)


def ggx_masking(cosine: Real, alpha: Real) -> Real:
    """G1 = 2 cos/(cos + sqrt(cos^2 + alpha^2 sin^2)), GGX."""
    return 2 * cosine / (cosine + smith_root(cosine, alpha))


def steepness(cosine: Real, alpha: Real) -> Real:
    """a = 1/(alpha tan theta), on which Beckmann's G1 depends alone."""
    return cosine / (alpha * length((1 - cosine) * (1 + cosine)))


def beckmann_masking(cosine: Real, alpha: Real) -> Real:
    """G1 = 2/(1 + erf(a) + exp(-a^2)/(a sqrt(pi))), a = 1/(alpha tan theta), Beckmann."""
    a = steepness(cosine, alpha)
    return 2 / (1 + erf(a) + exp(-(a * a)) / (a * sqrt(pi(a))))


def walter_masking(cosine: Real, alpha: Real) -> Real:
    """(3.535 a + 2.181 a^2)/(1 + 2.276 a + 2.577 a^2) for a < 1.6, else 1: Walter's fit to Beckmann's G1."""
    a = steepness(cosine, alpha)
    high = ratio(3535, 1000, a) * a + ratio(2181, 1000, a) * a * a
    low = 1 + ratio(2276, 1000, a) * a + ratio(2577, 1000, a) * a * a
    return where_positive(ratio(8, 5, a) - a, lambda: high / low, 1.0)


def separable_masking(inward: Real, outward: Real) -> Real:
    """G = G1(i) G1(o)."""
    return inward * outward


def correlated_masking(inward: Real, outward: Real) -> Real:
    """G = 1/(1/G1(i) + 1/G1(o) - 1), height-correlated."""
    return inward * outward / (inward + outward - inward * outward)


def conductor_fresnel(cosine: Real, eta: Real, k: Real) -> Real:
    """Share reflected by a conductor of index eta + i k, of unpolarised light at incidence ``cosine``.

    The wave beyond goes on as a + i b with (a + i b)^2 = s + 2 i eta k, s = eta^2 - k^2 - sin^2, so that
    2 a^2 = |s + 2 i eta k| + s. Where s < 0 that sum cancels: a would lose half its digits where k is small beside
    it, and its slope all of them at total reflection. It is written as 2 max(s, 0) and a rest of positive terms.
    """
    cos2 = cosine * cosine
    sin2 = (1 - cosine) * (1 + cosine)
    square = (eta - k) * (eta + k) - sin2
    mixed = eta * k
    size = length(square * square + 4 * mixed * mixed)
    rising, falling = ramp(square), ramp(-square)
    across = size + cos2
    twice = 2 * cosine * length(rising + 2 * mixed * mixed / positive(size + (rising + falling)))
    level = cos2 * size + sin2 * sin2
    tilted = twice * sin2
    upright = (across - twice) / (across + twice)
    return ratio(1, 2, size) * upright * (1 + (level - tilted) / (level + tilted))


def facet_reflection(density: Real, masking: Real, fresnel: Real, outward: Real) -> Real:
    """f cos_i = D G F/(4 cos_o)."""
    return density * masking * fresnel / (4 * outward)


LEAVES: Final = (
    Leaf(half_angles, ("cosine", "sine2", "incidence")),
    Leaf(ggx_density, ("density",)),
    Leaf(beckmann_density, ("density",)),
    Leaf(ggx_masking, ("share",)),
    Leaf(beckmann_masking, ("share",)),
    Leaf(walter_masking, ("share",)),
    Leaf(separable_masking, ("share",)),
    Leaf(correlated_masking, ("share",)),
    Leaf(conductor_fresnel, ("share",)),
    Leaf(facet_reflection, ("reflected",)),
)
