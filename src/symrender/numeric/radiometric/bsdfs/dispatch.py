"""What a tracer asks of any material, a line for each question and material (``docs/adding-a-bsdf.md``)."""

from __future__ import annotations

from symrender.jit.marks import jitable
from symrender.numeric.radiometric.bsdfs import conductor, diffuse, phong
from symrender.numeric.radiometric.bsdfs.choice import Choice
from symrender.numeric.vectors import Vector
from symrender.scene.radiometric.arrays import CONDUCTOR, DIFFUSE
from symrender.scene.radiometric.records import Material


@jitable
def scattered(material: Material, inside: bool, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f cos_i, channel by channel, without what a smooth surface sends one way; ``inside`` is where the eye is."""
    if wo[2] <= 0.0 or wi[2] <= 0.0:
        return (0.0, 0.0, 0.0)
    if material.kind == DIFFUSE:
        return diffuse.value(reflectance, wi)
    if material.kind == CONDUCTOR:
        return conductor.value(material, reflectance, wo, wi)
    return phong.value(material, reflectance, wo, wi)


@jitable
def density(material: Material, inside: bool, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of the directions out of a continuum that ``choose`` chooses."""
    if wi[2] <= 0.0:
        return 0.0
    if material.kind == DIFFUSE:
        return diffuse.density(wi)
    if material.kind == CONDUCTOR:
        return conductor.density(material, wo, wi)
    return phong.density(material, wo, wi)


@jitable
def choose(material: Material, inside: bool, reflectance: Vector, wo: Vector, a: float, b: float) -> Choice:
    """A direction by two numbers in [0, 1); it may lie below the surface, where nothing is reflected."""
    if material.kind == DIFFUSE:
        return diffuse.choose(a, b)
    if material.kind == CONDUCTOR:
        return conductor.choose(material, reflectance, wo, a, b)
    return phong.choose(material, wo, a, b)


@jitable
def widening(material: Material, inside: bool, wi: Vector) -> float:
    """Factor by which radiance grows again once it leaves what it enters along ``wi``: the squared relative index."""
    return 1.0
