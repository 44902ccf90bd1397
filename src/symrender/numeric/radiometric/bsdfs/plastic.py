"""A diffuse base under a smooth or rough dielectric layer, as Mitsuba 3 defines ``plastic`` and ``roughplastic``.

``through`` and ``within`` of a material are computed once for each world: what the layer lets through from outside at
64 cosines, and the share of diffuse light from within that it returns.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.bsdfs.choice import Choice, by_cosine, mirrored, spread
from symrender.numeric.radiometric.bsdfs.facets import facet_density, facets, half_way, seen, tangent2, visible_facet
from symrender.numeric.radiometric.bsdfs.fresnel import diffuse_reflectance, interface
from symrender.numeric.vectors import Vector, dot, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import BECKMANN
from symrender.scene.radiometric.records import Material

KNOTS: Final = 64
"""Cosines at which the share that a rough layer lets through is known."""
_RINGS: Final = 48
_TURNS: Final = 96
"""Nodes of the integral over the normals of facets: shares are right to 1e-4, 1e-3 where total reflection begins."""


class Facets(NamedTuple):
    """What of a material the shares of its layer depend on in addition to the index."""

    alpha: float
    density: float
    correlated: float
    walter: float


def lay_layer(material: Material) -> None:
    """Write ``through`` and ``within`` of a material."""
    if material.alpha == 0.0:
        material.within = diffuse_reflectance(1.0 / material.ior)
        return
    made = Facets(*(float(x) for x in (material.alpha, material.density, material.correlated, material.walter)))
    material.through[:], material.within = _layer(made, float(material.ior))


@lru_cache(maxsize=64)
def _layer(made: Facets, ior: float) -> tuple[Array, float]:
    cosines = np.maximum(1e-6, np.arange(KNOTS) / (KNOTS - 1.0))
    within = layer_shares(made, cosines, 1.0 / ior)[0]
    return layer_shares(made, cosines, ior)[1], 2.0 * float(np.mean(within * cosines))


def layer_shares(material: Facets, cosines: Array, eta: float) -> Array:
    """Shares (2, n) of light at cosines (n,) that facets reflect, and let through to ``eta`` times its index.

    What neighbouring facets block is in neither. Light meets facets as they are seen, with G1 as it is; on its way out
    masking is that of the material, which may be a fit.
    """
    found = np.zeros((2, len(cosines)))
    for k, cosine in enumerate(cosines):
        incidence, z, weight = _facets_before(material, float(cosine))
        beyond = np.sqrt(np.maximum(0.0, 1.0 - (1.0 - incidence**2) / eta**2))
        s = (incidence - eta * beyond) / (incidence + eta * beyond)
        p = (eta * incidence - beyond) / (eta * incidence + beyond)
        back = 0.5 * (s * s + p * p)
        back_out = 2.0 * incidence * z - cosine
        through_out = cosine / eta - (incidence / eta - beyond) * z
        for part, (light, out) in enumerate(((back, back_out), (1.0 - back, through_out))):
            masked = _masking(material, np.array(cosine), np.where(out > 0.0, out, 1.0))
            found[part, k] = float((weight * np.where(out > 0.0, light * masked, 0.0)).sum())
    return found


def _facets_before(material: Facets, cosine: float) -> tuple[Array, Array, Array]:
    """(cosine of incidence, cosine of their normal, weight in the integral) of facets that light of a cosine meets.

    By the mapping of ``visible_facet``, whose integrand is smooth, in rings and turns of equal weight.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_RINGS)
    a, share = 0.5 + 0.5 * nodes[:, None], 0.5 * weights[:, None] / _TURNS
    turn = 2.0 * np.pi * (np.arange(_TURNS) + 0.5) / _TURNS
    sine = math.sqrt(1.0 - cosine * cosine)
    if material.density == BECKMANN:
        t = material.alpha * np.sqrt(-np.log1p(-a))
        z = 1.0 / np.sqrt(1.0 + t * t)
        incidence = sine * t * z * np.cos(turn) + cosine * z
        met = incidence > 0.0
        return np.where(met, incidence, 1.0), z, np.where(met, share * incidence / (cosine * z), 0.0)
    stretched = math.hypot(material.alpha * sine, cosine)
    v, lean = cosine / stretched, material.alpha * sine / stretched
    # places of the disk that stretched facets show, the half of it that is turned away pressed onto the rest
    x, y = np.sqrt(a) * np.cos(turn), np.sqrt(a) * np.sin(turn)
    y = 0.5 * (1.0 - v) * np.sqrt(1.0 - x * x) + 0.5 * (1.0 + v) * y
    up = np.sqrt(np.maximum(0.0, 1.0 - x * x - y * y))
    ahead, across, rise = up * lean - y * v, x, up * v + y * lean
    size = np.sqrt((material.alpha * ahead) ** 2 + (material.alpha * across) ** 2 + rise**2)
    z = np.maximum(rise / size, 1e-300)
    incidence = np.maximum((sine * material.alpha * ahead + cosine * rise) / size, 1e-300)
    # over the masking of the light's own side, which the choice of what it sees holds already
    return incidence, z, share / _masking(material, np.array(cosine), np.array(1.0))


def _masking(material: Facets, first: Array, second: Array) -> Array:
    """G of two cosines."""
    from scipy.special import erfc

    hidden = []
    for cosine, fitted in ((first, False), (second, material.walter != 0.0)):
        slope = np.maximum(material.alpha * np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / cosine, 1e-100)
        if material.density != BECKMANN:
            hidden.append(0.5 * (np.sqrt(1.0 + slope**2) - 1.0))
            continue
        a = 1.0 / slope
        if fitted:
            fit = (1.0 + a * (2.276 + 2.577 * a)) / (a * (3.535 + 2.181 * a)) - 1.0
            hidden.append(np.where(a >= 1.6, 0.0, fit))
        else:
            hidden.append(0.5 * (np.exp(-a * a) / (a * math.sqrt(math.pi)) - erfc(a)))
    one, other = hidden
    return np.asarray(1.0 / (1.0 + one + other) if material.correlated != 0.0 else 1.0 / ((1.0 + one) * (1.0 + other)))


@jitable
def let_through(material: Material, cosine: float) -> float:
    """Share of light at a cosine of incidence that the layer lets through."""
    if material.alpha == 0.0:
        return 1.0 - interface(cosine, material.ior)[0]
    x = cosine * (KNOTS - 1.0)
    k = min(int(x), KNOTS - 2)
    low: float = material.through[k]
    high: float = material.through[k + 1]
    return low + (x - k) * (high - low)


@jitable
def share_of_gloss(material: Material, reflectance: Vector, wo: Vector) -> float:
    """Probability with which ``choose`` takes the layer: about its share of what is reflected."""
    through = let_through(material, wo[2])
    gloss = (1.0 - through) * max(material.specular[0], material.specular[1], material.specular[2])
    base = through * max(reflectance[0], reflectance[1], reflectance[2])
    return gloss / (gloss + base) if gloss + base > 0.0 else 0.0


@inlined
def returned(material: Material, reflectance: float) -> float:
    """What light that is let in becomes by base and layer, of one channel."""
    again = material.within * (reflectance if material.nonlinear != 0.0 else 1.0)
    return reflectance / (1.0 - again)


@jitable
def value(material: Material, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel, without the mirror of a smooth layer."""
    gloss = 0.0
    if material.alpha > 0.0:
        h = half_way(wo, wi)
        back, _ = interface(0.5 * math.sqrt(dot(h, h)), material.ior)
        gloss = 0.25 * back * facets(material, tangent2(h)) * seen(material, wo, wi) / wo[2]
    share = (
        let_through(material, wo[2]) * let_through(material, wi[2]) * wi[2] / (math.pi * material.ior * material.ior)
    )
    return (
        gloss * material.specular[0] + share * returned(material, reflectance[0]),
        gloss * material.specular[1] + share * returned(material, reflectance[1]),
        gloss * material.specular[2] + share * returned(material, reflectance[2]),
    )


@jitable
def density(material: Material, reflectance: Vector, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of what ``choose`` chooses."""
    chance = share_of_gloss(material, reflectance, wo)
    found = (1.0 - chance) * wi[2] / math.pi
    if material.alpha > 0.0:
        h = unit(half_way(wo, wi))
        found += chance * facet_density(material, wo, h) / (4.0 * dot(wo, h))
    return found


@jitable
def choose(material: Material, reflectance: Vector, wo: Vector, a: float, b: float) -> Choice:
    """A direction by two numbers in [0, 1), by the layer or by the base; it may lie below the surface."""
    chance = share_of_gloss(material, reflectance, wo)
    if a >= chance:
        return spread(by_cosine((a - chance) / (1.0 - chance), b))
    if material.alpha == 0.0:
        share = (1.0 - let_through(material, wo[2])) / chance
        specular = material.specular
        return Choice(mirrored(wo), True, (share * specular[0], share * specular[1], share * specular[2]))
    h = visible_facet(material, wo, a / chance, b)
    twice = 2.0 * dot(wo, h)
    return spread((twice * h[0] - wo[0], twice * h[1] - wo[1], twice * h[2] - wo[2]))
