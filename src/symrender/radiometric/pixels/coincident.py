"""Places in the planes of two shapes: roundings decide which is seen, and whether one hides the light of the other."""

from __future__ import annotations

from typing import Final

from symrender.jit.marks import jitable
from symrender.radiometric.arcs import Room
from symrender.radiometric.bumps import shading_normal
from symrender.radiometric.direct import arriving
from symrender.radiometric.reflection import reflectance, reflected
from symrender.radiometric.sight import height_over, passes
from symrender.radiometric.vectors import Vector, dot, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, SKY, SPHERE

_SAME: Final = 2.0**-46
"""Distance of a place from a plane, over the coordinates that it was made of, which roundings may be."""


@jitable
def unhidden_light(world: World, own: int, place: Vector, view: Vector, room: Room) -> Vector:
    """The radiance of a flat piece at a place if nothing hides any light from it; of a sky it is no more."""
    piece = world.pieces[own]
    material = world.materials[int(piece.material)]
    up = vector(piece.up)
    front = dot(up, view) > 0.0
    if not front and material.two_sided == 0.0:
        return (0.0, 0.0, 0.0)
    turned = shading_normal(world, own, front, place, up if front else minus_of(up), room)
    albedo, total = reflectance(world, own, place), (0.0, 0.0, 0.0)
    for i in range(world.lights.shape[0]):
        lamp = world.lights[i]
        e = vector(lamp.emitted)
        share = (0.0, 0.0, 0.0)
        if lamp.kind != SKY and lamp.kind != AREA:
            toward, e = arriving(lamp, place)
            share = reflected(material, albedo, turned, view, toward)
        elif lamp.kind == AREA and int(lamp.emitter) == int(piece.owner):
            share = (1.0, 1.0, 1.0)
        elif material.kind == DIFFUSE:
            share = albedo
        total = (total[0] + share[0] * e[0], total[1] + share[1] * e[1], total[2] + share[2] * e[2])
    return total


@jitable
def apart(a: Vector, b: Vector) -> float:
    """Largest difference over the channels."""
    return max(abs(a[0] - b[0]), max(abs(a[1] - b[1]), abs(a[2] - b[2])))


@jitable
def undecided_light(
    world: World, own: int, origin: Vector, place: Vector, d: Vector, light: Vector, room: Room
) -> float:  # fmt: skip
    """What roundings may have changed of the ``light`` along a ray that meets two flat shapes in one plane, else 0.

    Either shape is seen, and neither hides light from the other: the light differs from that of both by no more.
    """
    if own < 0 or world.pieces[own].kind == SPHERE:
        return 0.0
    size = max(abs(place[0]) + abs(origin[0]), max(abs(place[1]) + abs(origin[1]), abs(place[2]) + abs(origin[2])))
    view, most, met = minus_of(d), 0.0, False
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind == SPHERE or piece.owner == world.pieces[own].owner:
            continue
        height = height_over(piece, place)
        far = max(abs(piece.place[0]), max(abs(piece.place[1]), abs(piece.place[2])))
        if abs(height) <= _SAME * (size + far) and passes(piece, height, 1.0, place, vector(piece.up)):
            most, met = max(most, apart(unhidden_light(world, j, place, view, room), light)), True
    return max(most, apart(unhidden_light(world, own, place, view, room), light)) if met else 0.0
