"""Glass, smooth, thin or rough: reflected and refracted light (Walter et al., doi:10.2312/EGWR/EGSR07/195-206).

Radiance is divided by the squared relative index where it goes through.
"""

from __future__ import annotations

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.bsdfs.choice import Choice, mirrored, spread
from symrender.numeric.radiometric.bsdfs.facets import facet_density, facets, half_way, seen, tangent2, visible_facet
from symrender.numeric.radiometric.bsdfs.fresnel import interface
from symrender.numeric.vectors import Vector, along, dot, unit
from symrender.scene.radiometric.records import Material


@inlined
def relative_index(material: Material, inside: bool) -> float:
    """Index beyond the surface over that on the side of the eye."""
    return 1.0 / material.ior if inside else material.ior


@jitable
def facet_between(eta: float, wo: Vector, wi: Vector) -> Vector:
    """Unit normal, on the side of the eye, of the facet that sends ``wi`` to ``wo``; zero if none does."""
    h = half_way(wo, wi) if wi[2] > 0.0 else unit(along(wo, eta, wi))
    h = unit(h)
    if h[2] < 0.0:
        h = (-h[0], -h[1], -h[2])
    if dot(wo, h) <= 0.0 or dot(wi, h) * wi[2] <= 0.0 or h[2] == 0.0:
        return (0.0, 0.0, 0.0)
    return h


@jitable
def value(material: Material, inside: bool, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f |cos_i|, channel by channel."""
    black = (0.0, 0.0, 0.0)
    if material.alpha == 0.0 or wi[2] == 0.0:
        return black
    eta = relative_index(material, inside)
    h = facet_between(eta, wo, wi)
    if h[2] == 0.0:
        return black
    back, _ = interface(dot(wo, h), eta)
    share = facets(material, tangent2(h)) * seen(material, wo, wi) / wo[2]
    if wi[2] > 0.0:
        share *= 0.25 * back
        return (reflectance[0] * share, reflectance[1] * share, reflectance[2] * share)
    size = dot(wo, h) + eta * dot(wi, h)
    share *= (1.0 - back) * dot(wo, h) * -dot(wi, h) / (size * size)
    return (material.transmitted[0] * share, material.transmitted[1] * share, material.transmitted[2] * share)


@jitable
def density(material: Material, inside: bool, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    if material.alpha == 0.0 or wi[2] == 0.0:
        return 0.0
    eta = relative_index(material, inside)
    h = facet_between(eta, wo, wi)
    if h[2] == 0.0:
        return 0.0
    back, _ = interface(dot(wo, h), eta)
    chance = facet_density(material, wo, h)
    if wi[2] > 0.0:
        return chance * back / (4.0 * dot(wo, h))
    size = dot(wo, h) + eta * dot(wi, h)
    return chance * (1.0 - back) * eta * eta * -dot(wi, h) / (size * size)


@jitable
def choose(
    material: Material, inside: bool, reflectance: Vector, wo: Vector, a: float, b: float, c: float
) -> Choice:  # fmt: skip
    """A direction by numbers in [0, 1), reflected or refracted as often as light is; one of none has z = 0."""
    sent = (material.transmitted[0], material.transmitted[1], material.transmitted[2])
    if material.thin != 0.0:
        back, _ = interface(wo[2], material.ior)
        # with all that is reflected between both faces
        if a < 2.0 * back / (1.0 + back):
            return Choice(mirrored(wo), True, reflectance)
        return Choice((-wo[0], -wo[1], -wo[2]), True, sent)
    eta = relative_index(material, inside)
    if material.alpha == 0.0:
        back, beyond = interface(wo[2], eta)
        if a < back:
            return Choice(mirrored(wo), True, reflectance)
        scale = 1.0 / (eta * eta)
        wi = (-wo[0] / eta, -wo[1] / eta, -beyond)
        return Choice(wi, True, (scale * sent[0], scale * sent[1], scale * sent[2]))
    h = visible_facet(material, wo, a, b)
    cosine = dot(wo, h)
    back, beyond = interface(cosine, eta)
    along_h = 2.0 * cosine if c < back else cosine / eta - beyond
    along_o = 1.0 if c < back else 1.0 / eta
    wi = (along_h * h[0] - along_o * wo[0], along_h * h[1] - along_o * wo[1], along_h * h[2] - along_o * wo[2])
    if cosine <= 0.0 or (wi[2] > 0.0) != (c < back):
        # another facet would have to send it on
        return spread((0.0, 0.0, 0.0))
    return spread(wi)


@inlined
def widening(material: Material, inside: bool, wi: Vector) -> float:
    """Squared relative index of what ``wi`` comes from, 1 where it is reflected."""
    eta = 1.0 if wi[2] > 0.0 or material.thin != 0.0 else relative_index(material, inside)
    return eta * eta
