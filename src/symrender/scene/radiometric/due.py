"""What the language of radiometric scenes has and nothing renders yet: refused by name where it is read or asked."""

from __future__ import annotations

from typing import Final

from symrender.errors import Unsupported
from symrender.limits import MAX_QUADRATURE_TRIANGLES
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import (
    BOX,
    CHECKERBOARD,
    CONDUCTOR,
    DIFFUSE,
    DISK,
    ENVIRONMENT,
    IMAGE,
    MESH,
    PHONG,
    RECTANGLE,
    SAMPLED_MATERIALS,
    SAMPLED_SHAPES,
    SPHERE,
    TRIANGLE,
    RadiometricArrays,
)
from symrender.scene.radiometric.records import Material

_SHAPES: Final = frozenset({PLANE, SPHERE, RECTANGLE, TRIANGLE, DISK, BOX, MESH})
_MATERIALS: Final = frozenset({DIFFUSE, CONDUCTOR, PHONG})
"""What quadrature integrates; everything else is sampled."""


_SECONDS: Final = 4e-4
"""Seconds of a processor that quadrature takes for a triangle before the first pixel (``warnings.py``)."""


def refuse_sampled(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for shapes and materials that the path tracer alone knows."""
    for j, shape in enumerate(arrays.shapes):
        kind, material = int(shape.kind), arrays.materials[int(shape.material)]
        if kind not in _SHAPES:
            name = SAMPLED_SHAPES.get(kind, "its type")
            raise Unsupported(f"shapes[{j}]: {name} is not integrated by quadrature; truth samples it")
        if not _is_integrated(material):
            name = SAMPLED_MATERIALS.get(int(material.kind), "its type")
            raise Unsupported(f"the material of shapes[{j}]: {name} is not integrated by quadrature; truth samples it")


def _is_integrated(material: Material) -> bool:
    mirror = material.kind == CONDUCTOR and (material.alpha == 0.0 or bool((material.eta == 0.0).any()))
    return int(material.kind) in _MATERIALS and not mirror


def refuse_detail(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported``, by name, for what the path tracer alone computes: images, normals of vertices, size."""
    names = {IMAGE: "an image as a texture", CHECKERBOARD: "a checkerboard in (u, v)"}
    used = {int(arrays.materials[int(shape.material)].texture) for shape in arrays.shapes}
    reasons = [words for kind, words in names.items() if kind in used]
    if any(light.kind == ENVIRONMENT for light in arrays.lights):
        reasons.append("an environment from an image")
    if len(arrays.detail.normals):
        reasons.append("shading normals of a mesh")
    if len(arrays.facets) > MAX_QUADRATURE_TRIANGLES:
        reasons.append(
            f"meshes of {len(arrays.facets)} triangles, of which {MAX_QUADRATURE_TRIANGLES} are the most "
            f"({_SECONDS * len(arrays.facets):.2g} s before the first pixel)"
        )
    if reasons:
        raise Unsupported(f"{' and '.join(reasons)}: not integrated by quadrature; paths sample it")


def refuse_bounces(bounces: int | str, reason: str, flat: bool) -> None:
    """Raise ``Unsupported`` where more light is asked of what has no noise than it integrates.

    ``reason`` is what of the scene keeps bounced light from being integrated, empty if nothing does; ``flat`` says
    whether it has rectangles, triangles, disks, boxes and meshes only, between which every bounce is.
    """
    if bounces == 0 or (not reason and (flat or bounces == 1)):
        return
    words = f" in a scene with {reason}" if reason and (flat or bounces == 1) else ""
    raise Unsupported(
        f"bounces: {bounces} is not yet integrated{words}; 0 (emission and direct light) is, 1 is between all shapes "
        "but meshes and all materials under points, spots and directional lights, and between diffuse spheres and "
        "planes under a sky and spheres that emit, 1 and all are between diffuse rectangles, triangles, boxes and "
        "meshes, and 1 among disks, under a sky, points, spots, directional lights and those that emit, and the "
        "numeric pipeline samples any"
    )
