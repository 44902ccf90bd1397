"""The kernels: one fills a tile of pixels, one answers for single rays."""

from __future__ import annotations

from symrender.leaves import radiometric as leaves
from symrender.radiometric.direct import along_ray
from symrender.radiometric.world import Array, World


def fill_tile(
    world: World, eye: Array, window: Array, width: int, height: int, x0: int, y0: int, x1: int, y1: int, caps: Array,
    arcs: Array, emitted: Array, direct: Array, hit_class: Array, error: Array,
) -> None:  # fmt: skip
    """Fill columns x0:x1 of rows y0:y1 of the full-frame layers; arguments are many because a kernel takes arrays."""
    origin = (eye[0], eye[1], eye[2])
    f, r, u = window[0], window[1], window[2]
    for j in range(y0, y1):
        for i in range(x0, x1):
            a = (2.0 * i + 1.0) / width - 1.0
            b = 1.0 - (2.0 * j + 1.0) / height
            d = leaves.camera_ray(f[0], f[1], f[2], r[0], r[1], r[2], u[0], u[1], u[2], a, b)
            own, shining, light, missed = along_ray(world, origin, d, caps, arcs)
            hit_class[j, i] = own
            error[j, i] = missed
            for c in range(3):
                emitted[j, i, c] = shining[c]
                direct[j, i, c] = light[c]


def fill_rays(
    world: World, origins: Array, directions: Array, caps: Array, arcs: Array, emitted: Array, direct: Array,
    hit_class: Array, error: Array,
) -> None:  # fmt: skip
    """Answer for every ray, a row of the arrays each; directions are unit."""
    for k in range(origins.shape[0]):
        origin = (origins[k, 0], origins[k, 1], origins[k, 2])
        d = (directions[k, 0], directions[k, 1], directions[k, 2])
        own, shining, light, missed = along_ray(world, origin, d, caps, arcs)
        hit_class[k] = own
        error[k] = missed
        for c in range(3):
            emitted[k, c] = shining[c]
            direct[k, c] = light[c]
