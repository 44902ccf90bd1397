"""Metal, rough or a mirror: f = reflectance D F G/(4 cos_i cos_o), F of a conductor."""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.numeric.radiometric.bsdfs.choice import Choice, mirrored, spread
from symrender.numeric.radiometric.bsdfs.facets import chosen_facet, facets, half_way, seen, tangent2
from symrender.numeric.radiometric.bsdfs.fresnel import fresnel
from symrender.numeric.vectors import Vector, dot
from symrender.scene.radiometric.records import Material


@jitable
def value(material: Material, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel."""
    if material.alpha == 0.0:
        return (0.0, 0.0, 0.0)
    h = half_way(wo, wi)
    incidence = 0.5 * math.sqrt(dot(h, h))
    return tinted(
        material, reflectance, 0.25 * facets(material, tangent2(h)) * seen(material, wo, wi) / wo[2], incidence
    )


@jitable
def tinted(material: Material, reflectance: Vector, share: float, incidence: float) -> Vector:
    """A share of light as the metal reflects it at a cosine of incidence, channel by channel."""
    return (
        reflectance[0] * share * fresnel(incidence, material.eta[0], material.k[0]),
        reflectance[1] * share * fresnel(incidence, material.eta[1], material.k[1]),
        reflectance[2] * share * fresnel(incidence, material.eta[2], material.k[2]),
    )


@jitable
def density(material: Material, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    if material.alpha == 0.0:
        return 0.0
    h = half_way(wo, wi)
    size = math.sqrt(dot(h, h))
    return facets(material, tangent2(h)) * h[2] / (2.0 * size * size)


@jitable
def choose(material: Material, reflectance: Vector, wo: Vector, a: float, b: float) -> Choice:
    """The mirror direction, or one by two numbers in [0, 1), by D cos of the facets' normals; it may lie below."""
    if material.alpha == 0.0:
        return Choice(mirrored(wo), True, tinted(material, reflectance, 1.0, wo[2]))
    h = chosen_facet(material, a, b)
    twice = 2.0 * dot(wo, h)
    return spread((twice * h[0] - wo[0], twice * h[1] - wo[1], twice * h[2] - wo[2]))
