"""Scenes of flat shapes, whose faces send each other diffuse light: what of them is integrated."""

from __future__ import annotations

from symrender.scene.arrays import PLANE, SOLID
from symrender.scene.radiometric.arrays import (
    ALL,
    AREA,
    BOX,
    CONDUCTOR,
    DIFFUSE,
    RECTANGLE,
    SKY,
    SPHERE,
    SPOT,
    TRIANGLE,
    RadiometricArrays,
)


def is_flat(arrays: RadiometricArrays) -> bool:
    """Whether a scene has rectangles, triangles and boxes, and nothing beside them but spheres."""
    kinds = {int(shape.kind) for shape in arrays.shapes}
    return bool(kinds & {RECTANGLE, TRIANGLE, BOX}) and kinds <= {RECTANGLE, TRIANGLE, BOX, SPHERE}


def is_round(arrays: RadiometricArrays) -> bool:
    """Whether a scene has spheres and planes alone."""
    return all(shape.kind in (SPHERE, PLANE) for shape in arrays.shapes)


def flat_refusal(arrays: RadiometricArrays) -> str:
    """What of a scene of flat shapes keeps its bounced light from being integrated; empty if nothing does."""
    used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
    if any(material.kind != DIFFUSE for material in used) and not arrays.first_gloss:
        return "a conductor or a phong material that reflects after the first hit too (gloss: first_hit is)"
    if any(material.kind == CONDUCTOR and material.walter for material in used):
        return "a conductor of g1: walter"
    for shape, material in zip(arrays.shapes, used, strict=True):
        if shape.kind == SPHERE and material.kind == DIFFUSE and (material.bright.any() or material.dark.any()):
            return "a diffuse sphere"
    if any(light.kind == SKY for light in arrays.lights):
        return "a sky"
    if any(light.kind == SPOT for light in arrays.lights):
        return "a spot"
    if any(light.kind == AREA and arrays.shapes[int(light.emitter)].kind == SPHERE for light in arrays.lights):
        return "a sphere that emits"
    if any(material.texture != SOLID for material in used):
        return "a texture"
    bright = [float(material.bright.max()) for material in used if material.kind == DIFFUSE]
    if arrays.bounces == ALL and max(bright, default=0.0) >= 1.0:
        return "a reflectance of 1, of which no end is bounded"
    return ""
