"""Scenes of flat shapes, whose faces send each other diffuse light: what of them is integrated."""

from __future__ import annotations

from symrender.scene.arrays import SOLID
from symrender.scene.radiometric.arrays import ALL, BOX, DIFFUSE, RECTANGLE, SKY, SPOT, TRIANGLE, RadiometricArrays


def is_flat(arrays: RadiometricArrays) -> bool:
    """Whether a scene has rectangles, triangles and boxes only."""
    return len(arrays.shapes) > 0 and all(shape.kind in (RECTANGLE, TRIANGLE, BOX) for shape in arrays.shapes)


def flat_refusal(arrays: RadiometricArrays) -> str:
    """What of a scene of flat shapes keeps its bounced light from being integrated; empty if nothing does."""
    used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
    if any(material.kind != DIFFUSE for material in used):
        return "a conductor or a phong material"
    if any(light.kind == SKY for light in arrays.lights):
        return "a sky"
    if any(light.kind == SPOT for light in arrays.lights):
        return "a spot"
    if any(material.texture != SOLID for material in used):
        return "a texture"
    if arrays.bounces == ALL and any(float(material.bright.max()) >= 1.0 for material in used):
        return "a reflectance of 1, of which no end is bounded"
    return ""
