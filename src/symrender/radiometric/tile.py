"""The kernels: one fills a tile of pixels, one answers for single rays."""

from __future__ import annotations

from symrender.jit.marks import inlined
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room
from symrender.radiometric.direct import along_ray
from symrender.radiometric.reflection import reflectance
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array, vector
from symrender.radiometric.world import World


@inlined
def pixel_ray(window: Array, width: int, height: int, i: int, j: int) -> tuple[float, float, float]:
    """Unit direction through the centre of column ``i`` of row ``j``."""
    f, r, u = window[0], window[1], window[2]
    a = (2.0 * i + 1.0) / width - 1.0
    b = 1.0 - (2.0 * j + 1.0) / height
    x, y, z = leaves.camera_ray(f[0], f[1], f[2], r[0], r[1], r[2], u[0], u[1], u[2], a, b)
    return x, y, z


def fill_axes(eye: Array, target: Array, up: Array, axes: Array) -> None:
    """Fill ``axes`` (3, 3) with the unit vectors forward, right and up of a camera."""
    fx, fy, fz, rx, ry, rz, ux, uy, uz = leaves.perspective_axes(*vector(eye), *vector(target), *vector(up))
    axes[0, 0], axes[0, 1], axes[0, 2] = fx, fy, fz
    axes[1, 0], axes[1, 1], axes[1, 2] = rx, ry, rz
    axes[2, 0], axes[2, 1], axes[2, 2] = ux, uy, uz


def fill_tile(
    world: World, eye: Array, window: Array, width: int, height: int, x0: int, y0: int, x1: int, y1: int, room: Room,
    emitted: Array, direct: Array, hit_class: Array,
) -> None:  # fmt: skip
    """Fill the layers of a tile, columns x0:x1 of rows y0:y1; arguments are many because a kernel takes arrays."""
    origin = (eye[0], eye[1], eye[2])
    for j in range(y0, y1):
        for i in range(x0, x1):
            d = pixel_ray(window, width, height, i, j)
            own, shining, light = along_ray(world, origin, d, room)
            hit_class[j - y0, i - x0] = own
            for c in range(3):
                emitted[j - y0, i - x0, c] = shining[c]
                direct[j - y0, i - x0, c] = light[c]


def fill_directions(
    window: Array, width: int, height: int, x0: int, y0: int, x1: int, y1: int, directions: Array
) -> None:  # fmt: skip
    """Unit directions of the rays through the pixels of a tile, row by row."""
    k = 0
    for j in range(y0, y1):
        for i in range(x0, x1):
            directions[k, 0], directions[k, 1], directions[k, 2] = pixel_ray(window, width, height, i, j)
            k += 1


def fill_hits(
    world: World, origins: Array, directions: Array, shape: Array, place: Array, normal: Array, albedo: Array,
    behind: Array,
) -> None:  # fmt: skip
    """Which ``shape`` every ray meets first, -1 for none, where, and the unit normal towards the ray.

    ``albedo`` is how the place reflects, ``behind`` 1 where the shape's own normal points away.
    """
    for k in range(origins.shape[0]):
        origin = (origins[k, 0], origins[k, 1], origins[k, 2])
        own, _, at, facing, front = nearest(world, origin, (directions[k, 0], directions[k, 1], directions[k, 2]))
        shape[k] = -1.0
        if own < 0:
            continue
        shape[k] = world.pieces[own].owner
        reflects = reflectance(world, own, at)
        behind[k] = 0.0 if front else 1.0
        for c in range(3):
            place[k, c], normal[k, c], albedo[k, c] = at[c], facing[c], reflects[c]


def fill_rays(
    world: World, origins: Array, directions: Array, room: Room, emitted: Array, direct: Array,
    hit_class: Array,
) -> None:  # fmt: skip
    """Answer for every ray, a row of the arrays each; directions are unit."""
    for k in range(origins.shape[0]):
        origin = (origins[k, 0], origins[k, 1], origins[k, 2])
        d = (directions[k, 0], directions[k, 1], directions[k, 2])
        own, shining, light = along_ray(world, origin, d, room)
        hit_class[k] = own
        for c in range(3):
            emitted[k, c] = shining[c]
            direct[k, c] = light[c]


def fill_places(
    world: World, eye: Array, window: Array, width: int, height: int, columns: Array, rows: Array, room: Room,
    light: Array,
) -> None:  # fmt: skip
    """Fill ``light`` (n, 6), radiance and what of it is emitted, along the rays through places of the image, in
    pixels."""
    origin = (eye[0], eye[1], eye[2])
    f, r, u = window[0], window[1], window[2]
    for k in range(columns.shape[0]):
        a, b = 2.0 * columns[k] / width - 1.0, 1.0 - 2.0 * rows[k] / height
        d = leaves.camera_ray(f[0], f[1], f[2], r[0], r[1], r[2], u[0], u[1], u[2], a, b)
        _, shining, lit = along_ray(world, origin, d, room)
        for c in range(3):
            light[k, c] = shining[c] + lit[c]
            light[k, 3 + c] = shining[c]
