"""The kernel of direct light at places of faces."""

from __future__ import annotations

from symrender.radiometric.arcs import Room
from symrender.radiometric.direct import direct_irradiance
from symrender.radiometric.vectors import Array, vector
from symrender.radiometric.world import World
from symrender.radiosity.records import Ints


def fill_lit(world: World, owns: Ints, fronts: Ints, places: Array, room: Room, lit: Array) -> None:
    """Write the irradiance by all lights of places of pieces ``owns``, each on the front or the back of its piece."""
    for i in range(places.shape[0]):
        own, front = owns[i], fronts[i] != 0
        up = vector(world.pieces[own].up)
        normal = up if front else (-up[0], -up[1], -up[2])
        place = (places[i, 0], places[i, 1], places[i, 2])
        red, green, blue = direct_irradiance(world, own, front, place, normal, room)
        lit[i, 0], lit[i, 1], lit[i, 2] = red, green, blue
