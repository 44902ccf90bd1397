"""What the language of radiometric scenes has and nothing renders yet: refused by name where it is read or asked."""

from __future__ import annotations

from symrender.errors import Unsupported


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
