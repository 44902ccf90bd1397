"""Facets of rough surfaces: the density of their normals, masking, and a normal by chance.

Facets are described by the squared tangent t2 of their normal's angle, since D cos^4 depends on it alone.
"""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.numeric.vectors import Vector, along, cross, dot, unit
from symrender.scene.radiometric.arrays import BECKMANN
from symrender.scene.radiometric.records import Material


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


@jitable
def seen(material: Material, wo: Vector, wi: Vector) -> float:
    """Share G of facets that both directions see."""
    lo, li = hidden(material, wo), hidden(material, wi)
    return 1.0 / (1.0 + lo + li) if material.correlated != 0.0 else 1.0 / ((1.0 + lo) * (1.0 + li))


@inlined
def half_way(wo: Vector, wi: Vector) -> Vector:
    """wo + wi, not normalised."""
    return (wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2])


@jitable
def chosen_facet(material: Material, a: float, b: float) -> Vector:
    """Unit normal of a facet by two numbers in [0, 1), with density D cos."""
    turn = 2.0 * math.pi * b
    spread = -math.log1p(-a) if material.density == BECKMANN else a / (1.0 - a)
    t = material.alpha * math.sqrt(spread)
    z = 1.0 / math.sqrt(1.0 + t * t)
    return (t * z * math.cos(turn), t * z * math.sin(turn), z)


@jitable
def visible_facet(material: Material, wo: Vector, a: float, b: float) -> Vector:
    """Unit normal of a facet by two numbers in [0, 1): of GGX one of those that ``wo`` sees, of Beckmann of all.

    E. Heitz, "Sampling the GGX distribution of visible normals", JCGT 7(4), 2018.
    """
    if material.density == BECKMANN:
        return chosen_facet(material, a, b)
    v = unit((material.alpha * wo[0], material.alpha * wo[1], wo[2]))
    size = math.sqrt(v[0] * v[0] + v[1] * v[1])
    first = (-v[1] / size, v[0] / size, 0.0) if size > 0.0 else (1.0, 0.0, 0.0)
    second = cross(v, first)
    r, turn = math.sqrt(a), 2.0 * math.pi * b
    x, y, share = r * math.cos(turn), r * math.sin(turn), 0.5 * (1.0 + v[2])
    y = (1.0 - share) * math.sqrt(max(0.0, 1.0 - x * x)) + share * y
    z = math.sqrt(max(0.0, 1.0 - x * x - y * y))
    n = along(along((x * first[0], x * first[1], x * first[2]), y, second), z, v)
    return unit((material.alpha * n[0], material.alpha * n[1], max(0.0, n[2])))


@jitable
def facet_density(material: Material, wo: Vector, h: Vector) -> float:
    """Probability per solid angle of a facet's unit normal by ``visible_facet``."""
    if material.density == BECKMANN:
        return facets(material, tangent2(h)) * h[2]
    return facets(material, tangent2(h)) * max(0.0, dot(wo, h)) / ((1.0 + hidden(material, wo)) * wo[2])
