"""The kernels of places on faces: their direct light, and where rays meet them."""

from __future__ import annotations

from symrender.jit.marks import inlined
from symrender.radiometric.arcs import Room
from symrender.radiometric.direct import direct_irradiance
from symrender.radiometric.reflection import reflectance
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array, Vector, vector
from symrender.radiometric.world import World
from symrender.radiosity.records import Ints


@inlined
def facing(world: World, own: int, front: bool) -> Vector:
    """Unit normal of a side of a piece."""
    up = vector(world.pieces[own].up)
    return up if front else (-up[0], -up[1], -up[2])


def fill_lit(world: World, owns: Ints, fronts: Ints, places: Array, room: Room, lit: Array) -> None:
    """Write the irradiance by all lights of places of pieces ``owns``, each on the front or the back of its piece."""
    for i in range(places.shape[0]):
        own, front = owns[i], fronts[i] != 0
        place = (places[i, 0], places[i, 1], places[i, 2])
        red, green, blue = direct_irradiance(world, own, front, place, facing(world, own, front), room)
        lit[i, 0], lit[i, 1], lit[i, 2] = red, green, blue


def fill_reflects(world: World, owns: Ints, places: Array, reflects: Array) -> None:
    """Write how pieces ``owns`` reflect at places of theirs."""
    for i in range(places.shape[0]):
        found = reflectance(world, owns[i], (places[i, 0], places[i, 1], places[i, 2]))
        reflects[i, 0], reflects[i, 1], reflects[i, 2] = found


def fill_met(
    world: World, origins: Array, directions: Array, owns: Ints, fronts: Ints, places: Array, normals: Array,
    albedo: Array,
) -> None:  # fmt: skip
    """Write which piece every ray meets first, -1 for none, whether its front, where, and how that side reflects.

    ``normals`` are unit, towards the ray.
    """
    for i in range(origins.shape[0]):
        origin = (origins[i, 0], origins[i, 1], origins[i, 2])
        own, _, at, facing_ray, front = nearest(world, origin, (directions[i, 0], directions[i, 1], directions[i, 2]))
        owns[i], fronts[i] = own, 1 if front else 0
        if own < 0:
            continue
        shows = front or world.materials[int(world.pieces[own].material)].two_sided != 0.0
        reflects = reflectance(world, own, at)
        for c in range(3):
            places[i, c], normals[i, c] = at[c], facing_ray[c]
            albedo[i, c] = reflects[c] if shows else 0.0
