"""Scenes with bumps: what of them is not integrated."""

from __future__ import annotations

from symrender.errors import Unsupported
from symrender.scene.radiometric.arrays import ALL, DIFFUSE, EXTENDED, RadiometricArrays


def bumped(arrays: RadiometricArrays) -> list[int]:
    """The shapes whose materials turn their normals."""
    return [j for j, shape in enumerate(arrays.shapes) if arrays.materials[int(shape.material)].terms != 0.0]


def refuse_bumps(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for bumps in light whose walls they move, or under a lobe's integral."""
    found = bumped(arrays)
    if not found:
        return
    if arrays.bounces == ALL:
        raise Unsupported(
            f"bounces: all is not yet integrated over a bump, that of shapes[{found[0]}]; bounces: 1 and 0 are, and "
            "the numeric pipeline samples any"
        )
    for light in arrays.lights if arrays.bounces else ():
        if light.kind in EXTENDED:
            raise Unsupported(
                f"bounces: 1 is not yet integrated over a bump, that of shapes[{found[0]}], under "
                f"{EXTENDED[int(light.kind)]}; under points, spots and directional lights it is, and the numeric "
                "pipeline samples any"
            )
    for j in found:
        if arrays.materials[int(arrays.shapes[j].material)].kind == DIFFUSE:
            continue
        for light in arrays.lights:
            if light.kind in EXTENDED:
                raise Unsupported(
                    f"lights: {EXTENDED[int(light.kind)]} over a conductor or a phong material with a bump, that of "
                    f"shapes[{j}], is not yet integrated; over a diffuse one it is, and the numeric pipeline samples "
                    "any"
                )


def refuse_means_of_bumps(arrays: RadiometricArrays, filter: str, exposed: bool) -> None:
    """Raise ``Unsupported`` for a bump in means over lens and shutter, and over pixels under a sky or a lamp."""
    found = bumped(arrays)
    if found and exposed:
        raise Unsupported(
            f"a lens or a shutter: is not yet integrated over a bump, that of shapes[{found[0]}]: where its normals "
            "turn away from a light or the eye is no curve of known shape; over pixels it is, and the numeric pipeline "
            "samples any"
        )
    for light in arrays.lights if found and filter != "centre" else ():
        if light.kind in EXTENDED:
            raise Unsupported(
                f"filter: {filter}: is not yet integrated where {EXTENDED[int(light.kind)]} shines on a bump, that of "
                f"shapes[{found[0]}]; under points, spots and directional lights it is, filter: centre is, and the "
                "numeric pipeline samples any"
            )
