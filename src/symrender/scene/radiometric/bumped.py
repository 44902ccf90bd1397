"""Scenes with bumps: what of them is not integrated."""

from __future__ import annotations

from symrender.errors import Unsupported
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, SKY, RadiometricArrays


def bumped(arrays: RadiometricArrays) -> list[int]:
    """The shapes whose materials turn their normals."""
    return [j for j, shape in enumerate(arrays.shapes) if arrays.materials[int(shape.material)].terms != 0.0]


def refuse_bumps(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for bumps in light whose walls they move, or under a lobe's integral."""
    found = bumped(arrays)
    if not found:
        return
    if arrays.bounces:
        asked = arrays.bounces if arrays.bounces <= 1 else "all"
        raise Unsupported(
            f"bounces: {asked} is not yet integrated over a bump, that of shapes[{found[0]}]: where its normals turn "
            "away from a light is no curve of known shape; with bounces: 0 it is, and the numeric pipeline samples any"
        )
    extended = {SKY: "a sky", AREA: "an area light"}
    for j in found:
        if arrays.materials[int(arrays.shapes[j].material)].kind == DIFFUSE:
            continue
        for light in arrays.lights:
            if light.kind in extended:
                raise Unsupported(
                    f"lights: {extended[int(light.kind)]} over a conductor or a phong material with a bump, that of "
                    f"shapes[{j}], is not yet integrated; over a diffuse one it is, and the numeric pipeline samples "
                    "any"
                )


def refuse_means_of_bumps(arrays: RadiometricArrays, filter: str, exposed: bool) -> None:
    """Raise ``Unsupported`` for a bump in means over pixels, lens and shutter."""
    found = bumped(arrays)
    if found and (exposed or filter != "centre"):
        what = "a lens or a shutter" if exposed else f"filter: {filter}"
        raise Unsupported(
            f"{what}: is not yet integrated over a bump, that of shapes[{found[0]}]: where its normals turn away from "
            "a light or the eye is no curve of known shape; filter: centre is, and the numeric pipeline samples any"
        )
