"""Scenes of flat shapes, whose faces send each other diffuse light: what of them is integrated."""

from __future__ import annotations

from typing import Final

from symrender.scene.arrays import MARBLE, PLANE, SOLID
from symrender.scene.radiometric.arrays import (
    ALL,
    AREA,
    BOX,
    CONDUCTOR,
    DIFFUSE,
    DISK,
    MESH,
    RECTANGLE,
    SPHERE,
    TRIANGLE,
    RadiometricArrays,
)

_FLAT: Final = frozenset({RECTANGLE, TRIANGLE, DISK, BOX, MESH})


def is_flat(arrays: RadiometricArrays) -> bool:
    """Whether a scene has shapes that are flat and end, and nothing beside them but spheres and planes."""
    kinds = {int(shape.kind) for shape in arrays.shapes}
    return bool(kinds & _FLAT) and kinds <= _FLAT | {SPHERE, PLANE}


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
    endless = any(shape.kind == PLANE for shape in arrays.shapes)
    if endless and any(material.kind != DIFFUSE for material in used):
        return "a conductor or a phong material, and a plane"
    if any(shape.kind == DISK for shape in arrays.shapes):
        if any(material.kind != DIFFUSE for material in used):
            return "a conductor or a phong material, and a disk"
        if arrays.bounces == ALL:
            return "a disk (bounces: 1 is)"
    for shape, material in zip(arrays.shapes, used, strict=True):
        if shape.kind == DISK and material.texture != SOLID:
            return "a texture on a disk"
        if shape.kind == PLANE and material.texture != SOLID:
            return "a texture on a plane beside other flat shapes"
        if shape.kind == SPHERE and material.kind == DIFFUSE and (material.bright.any() or material.dark.any()):
            return "a diffuse sphere"
    if any(light.kind == AREA and arrays.shapes[int(light.emitter)].kind == SPHERE for light in arrays.lights):
        return "a sphere that emits"
    if any(material.texture == MARBLE for material in used):
        return "marble"
    bright = [float(max(material.bright.max(), material.dark.max())) for material in used if material.kind == DIFFUSE]
    if arrays.bounces == ALL and max(bright, default=0.0) >= 1.0:
        return "a reflectance of 1, of which no end is bounded"
    return ""
