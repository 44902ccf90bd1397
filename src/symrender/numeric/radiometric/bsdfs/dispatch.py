"""What a tracer asks of any material, a line for each question and material (``docs/adding-a-bsdf.md``)."""

from __future__ import annotations

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table, copied
from symrender.numeric.radiometric.bsdfs import conductor, dielectric, diffuse, phong, plastic
from symrender.numeric.radiometric.bsdfs.choice import Choice
from symrender.numeric.vectors import Vector
from symrender.scene.radiometric.arrays import CONDUCTOR, DIELECTRIC, DIFFUSE, PLASTIC
from symrender.scene.radiometric.records import Material


def laid_materials(materials: Table[Material]) -> Table[Material]:
    """The materials with what is computed of them once."""
    found = copied(materials)
    for material in found:
        if material.kind == PLASTIC:
            plastic.lay_layer(material)
    return found


@jitable
def scattered(material: Material, inside: bool, reflectance: Vector, wo: Vector, wi: Vector) -> Vector:
    """f |cos_i|, channel by channel, without what a smooth surface sends one way; ``inside`` is where the eye is."""
    if wo[2] <= 0.0:
        return (0.0, 0.0, 0.0)
    if material.kind == DIELECTRIC:
        return dielectric.value(material, inside, reflectance, wo, wi)
    if wi[2] <= 0.0:
        return (0.0, 0.0, 0.0)
    if material.kind == DIFFUSE:
        return diffuse.value(reflectance, wi)
    if material.kind == CONDUCTOR:
        return conductor.value(material, reflectance, wo, wi)
    if material.kind == PLASTIC:
        return plastic.value(material, reflectance, wo, wi)
    return phong.value(material, reflectance, wo, wi)


@jitable
def density(material: Material, inside: bool, reflectance: Vector, wo: Vector, wi: Vector) -> float:
    """Probability per solid angle of the directions out of a continuum that ``choose`` chooses."""
    if material.kind == DIELECTRIC:
        return dielectric.density(material, inside, wo, wi)
    if wi[2] <= 0.0:
        return 0.0
    if material.kind == DIFFUSE:
        return diffuse.density(wi)
    if material.kind == CONDUCTOR:
        return conductor.density(material, wo, wi)
    if material.kind == PLASTIC:
        return plastic.density(material, reflectance, wo, wi)
    return phong.density(material, wo, wi)


@inlined
def asks_for_three(material: Material) -> bool:
    """Whether ``choose`` makes use of its third number."""
    return material.kind == DIELECTRIC and material.alpha > 0.0


@jitable
def choose(
    material: Material, inside: bool, reflectance: Vector, wo: Vector, a: float, b: float, c: float
) -> Choice:  # fmt: skip
    """A direction by three numbers in [0, 1); it may lie below the surface, where nothing is reflected."""
    if material.kind == DIFFUSE:
        return diffuse.choose(a, b)
    if material.kind == CONDUCTOR:
        return conductor.choose(material, reflectance, wo, a, b)
    if material.kind == DIELECTRIC:
        return dielectric.choose(material, inside, reflectance, wo, a, b, c)
    if material.kind == PLASTIC:
        return plastic.choose(material, reflectance, wo, a, b)
    return phong.choose(material, wo, a, b)


@jitable
def widening(material: Material, inside: bool, wi: Vector) -> float:
    """Factor by which radiance grows again once it leaves what it enters along ``wi``: the squared relative index."""
    return dielectric.widening(material, inside, wi) if material.kind == DIELECTRIC else 1.0
