"""The whole image program, from the formulas to two entries and the small functions beside them."""

from __future__ import annotations

from symrender.kernel import footprint, gather, light, planes, shade, strata, tile, trace
from symrender.kernel.program import Program

ENTRIES = ("tile", "hits", "trace")
"""What a runtime compiles; the functions of lights, cameras and strata run once an image and need no compiler."""
ONCE = (
    "light_point",
    "camera_axes",
    "stand_planes",
    "ring_weight",
    "ring_barycentre",
    "share_angle",
    "cap_angle",
    "log_weight",
)
"""Functions that run once an image, as plain Python."""


def image_program() -> Program:
    """Program of one image: one text for every scene, since a scene is only arrays."""
    return Program(
        (
            light.light_point(),
            tile.camera_axes(),
            planes.stand_planes(),
            planes.nearest_plane(),
            planes.walled_off(),
            strata.ring_weight(),
            strata.ring_barycentre(),
            strata.share_angle(),
            strata.cap_angle(),
            strata.log_weight(),
            shade.power(),
            shade.texture_factor(),
            shade.floor_side(),
            shade.blocked(),
            shade.light_factors(),
            shade.direct(),
            shade.lit(),
            trace.nearest(),
            trace.sphere_radiance(),
            trace.floor_radiance(),
            trace.plane_radiance(),
            trace.see(),
            trace.trace(),
            gather.frame(),
            gather.candidates(),
            gather.gather(),
            footprint.box_share(),
            footprint.edge_share(),
            footprint.quad_share(),
            tile.footprint_share(),
            tile.plane_share(),
            tile.look(),
            tile.hits(),
            tile.tile(),
        ),
        ENTRIES,
    )
