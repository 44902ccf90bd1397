"""Scenes whose bounced light is integrated by cutting what every place sees, as no faster rule knows all they hold."""

from __future__ import annotations

from symrender.scene.radiometric.arrays import DIRECTIONAL, MESH, POINT, SPOT, RadiometricArrays
from symrender.scene.radiometric.bounce import bounce_refusal
from symrender.scene.radiometric.bumped import bumped
from symrender.scene.radiometric.flat import flat_refusal, is_flat


def cut_reason(arrays: RadiometricArrays) -> str:
    """Why the light of one bounce is integrated so, as words for a message; empty if it is not.

    It is under points, spots and directional lights alone, which leave no penumbrae, and without meshes.
    """
    rays = all(light.kind in (POINT, SPOT, DIRECTIONAL) for light in arrays.lights)
    if arrays.bounces != 1 or not rays or any(shape.kind == MESH for shape in arrays.shapes):
        return ""
    found = bumped(arrays)
    if found:
        return f"a bump, that of shapes[{found[0]}]"
    return flat_refusal(arrays) if is_flat(arrays) else bounce_refusal(arrays)
