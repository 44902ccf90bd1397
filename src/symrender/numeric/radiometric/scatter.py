"""Reflection in the frame of the surface, z its normal, told by tangents: value, density and choice of a direction.

``wo`` and ``wi`` are unit vectors to the eye and to the light. Facets are told by the squared tangent t2 of their
normal's angle, since D cos^4 depends on it alone, and Fresnel's amplitudes are computed as complex numbers, as pairs.
"""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.numeric.vectors import Vector, cross, dot
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE
from symrender.scene.radiometric.records import Material

Complex = tuple[float, float]


@inlined
def times(a: Complex, b: Complex) -> Complex:
    """Product of two complex numbers."""
    return (a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0])


@inlined
def over(a: Complex, b: Complex) -> Complex:
    """Quotient of two complex numbers."""
    size = b[0] * b[0] + b[1] * b[1]
    return ((a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size)


@inlined
def principal_root(a: Complex) -> Complex:
    """Square root of a complex number, its real part not negative."""
    size = math.sqrt(math.sqrt(a[0] * a[0] + a[1] * a[1]))
    half = 0.5 * math.atan2(a[1], a[0])
    return (size * math.cos(half), size * math.sin(half))


@jitable
def fresnel(cosine: float, eta: float, k: float) -> float:
    """Mean of |r_s|^2 and |r_p|^2 of a conductor of index n = eta + i k, by Snell's law for a complex n."""
    n = (eta, k)
    bent = over((1.0 - cosine * cosine, 0.0), times(n, n))
    inner = principal_root((1.0 - bent[0], -bent[1]))
    a, b = times(n, inner), (n[0] * cosine, n[1] * cosine)
    s = over((cosine - a[0], -a[1]), (cosine + a[0], a[1]))
    p = over((b[0] - inner[0], b[1] - inner[1]), (b[0] + inner[0], b[1] + inner[1]))
    return 0.5 * (s[0] * s[0] + s[1] * s[1] + p[0] * p[0] + p[1] * p[1])


@inlined
def tangent2(w: Vector) -> float:
    """Squared tangent of the angle to the normal."""
    return (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2])


@jitable
def facets(material: Material, t2: float) -> float:
    """D of facets whose normals have this squared tangent."""
    ratio, secant2 = t2 / (material.alpha * material.alpha), 1.0 + t2
    height = secant2 * secant2 / (math.pi * material.alpha * material.alpha)
    if material.density == BECKMANN:
        return height * math.exp(-ratio)
    return height / ((1.0 + ratio) * (1.0 + ratio))


@jitable
def hidden(material: Material, w: Vector) -> float:
    """Smith's Lambda of a direction: 1/G1 - 1."""
    slope = material.alpha * math.sqrt(tangent2(w))
    if slope == 0.0:
        return 0.0
    if material.density != BECKMANN:
        return 0.5 * (math.sqrt(1.0 + slope * slope) - 1.0)
    a = 1.0 / slope
    if material.walter != 0.0:
        if a >= 1.6:
            return 0.0
        return (1.0 + a * (2.276 + 2.577 * a)) / (a * (3.535 + 2.181 * a)) - 1.0
    return 0.5 * (math.exp(-a * a) / (a * math.sqrt(math.pi)) - math.erfc(a))


@inlined
def half_way(wo: Vector, wi: Vector) -> Vector:
    """wo + wi, not normalised."""
    return (wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2])


@inlined
def cosine_power(w: Vector, axis: Vector, exponent: float) -> float:
    """cos^n of the angle between two directions, 0 from the right angle on."""
    c = dot(w, axis)
    if c <= 0.0:
        return 0.0
    s = cross(w, axis)
    return math.exp(-0.5 * exponent * math.log1p(dot(s, s) / (c * c)))


@inlined
def mirrored(w: Vector) -> Vector:
    """The mirror direction."""
    return (-w[0], -w[1], w[2])


@jitable
def reflected(material: Material, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel."""
    if wo[2] <= 0.0 or wi[2] <= 0.0:
        return (0.0, 0.0, 0.0)
    if material.kind == DIFFUSE:
        share = wi[2] / math.pi
        return (reflectance[0] * share, reflectance[1] * share, reflectance[2] * share)
    if material.kind == CONDUCTOR:
        h = half_way(wo, wi)
        incidence = 0.5 * math.sqrt(dot(h, h))
        lo, li = hidden(material, wo), hidden(material, wi)
        seen = 1.0 / (1.0 + lo + li) if material.correlated != 0.0 else 1.0 / ((1.0 + lo) * (1.0 + li))
        share = 0.25 * facets(material, tangent2(h)) * seen / wo[2]
        return (
            reflectance[0] * share * fresnel(incidence, material.eta[0], material.k[0]),
            reflectance[1] * share * fresnel(incidence, material.eta[1], material.k[1]),
            reflectance[2] * share * fresnel(incidence, material.eta[2], material.k[2]),
        )
    n = material.exponent
    share = (n + 2.0) / (2.0 * math.pi) * cosine_power(wi, mirrored(wo), n) * wi[2]
    return (reflectance[0] * share, reflectance[1] * share, reflectance[2] * share)


@jitable
def density(material: Material, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    if wi[2] <= 0.0:
        return 0.0
    if material.kind == DIFFUSE:
        return wi[2] / math.pi
    if material.kind == CONDUCTOR:
        h = half_way(wo, wi)
        size = math.sqrt(dot(h, h))
        return facets(material, tangent2(h)) * h[2] / (2.0 * size * size)
    n = material.exponent
    return (n + 1.0) / (2.0 * math.pi) * cosine_power(wi, mirrored(wo), n)


@jitable
def choose(material: Material, wo: Vector, a: float, b: float) -> Vector:
    """A direction by two numbers in [0, 1): by cos_i, by D cos of the facets' normals, by cos^n about the mirror.

    It may lie below the surface, where nothing is reflected.
    """
    turn = 2.0 * math.pi * b
    if material.kind == DIFFUSE:
        r = math.sqrt(a)
        return (r * math.cos(turn), r * math.sin(turn), math.sqrt(1.0 - a))
    if material.kind == CONDUCTOR:
        spread = -math.log1p(-a) if material.density == BECKMANN else a / (1.0 - a)
        t = material.alpha * math.sqrt(spread)
        z = 1.0 / math.sqrt(1.0 + t * t)
        h = (t * z * math.cos(turn), t * z * math.sin(turn), z)
        twice = 2.0 * dot(wo, h)
        return (twice * h[0] - wo[0], twice * h[1] - wo[1], twice * h[2] - wo[2])
    c = (1.0 - a) ** (1.0 / (material.exponent + 1.0))
    s = math.sqrt(max(0.0, 1.0 - c * c))
    m = mirrored(wo)
    e = (m[2], 0.0, -m[0]) if abs(m[1]) > 0.5 else (0.0, -m[2], m[1])
    size = math.sqrt(dot(e, e))
    e = (e[0] / size, e[1] / size, e[2] / size)
    f = cross(m, e)
    x, y = s * math.cos(turn), s * math.sin(turn)
    return (c * m[0] + x * e[0] + y * f[0], c * m[1] + x * e[1] + y * f[1], c * m[2] + x * e[2] + y * f[2])
