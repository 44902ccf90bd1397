"""Emission and direct light along a ray."""

from __future__ import annotations

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room
from symrender.radiometric.bumps import counted, shading_normal
from symrender.radiometric.reflection import reflectance, reflected
from symrender.radiometric.sight import hidden_direction, hidden_point, nearest
from symrender.radiometric.sky import area_irradiance, sky_irradiance
from symrender.radiometric.vectors import Vector, dot, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, DIRECTIONAL, FIRST_SHAPE, SKY, SPOT
from symrender.scene.radiometric.records import Light


@jitable
def arriving(light: Light, place: Vector) -> tuple[Vector, Vector]:
    """(unit vector to a point, a spot or a directional light, irradiance across its rays where nothing hides it)."""
    at, e = vector(light.place), vector(light.emitted)
    if light.kind == DIRECTIONAL:
        return (-at[0], -at[1], -at[2]), e
    x, y, z, fall = leaves.point_light(*place, *at)
    if light.kind == SPOT:
        axis = vector(light.axis)
        if light.smooth != 0.0:
            fall = fall * leaves.smooth_spot(x, y, z, *axis, light.beam, light.cutoff)
        else:
            fall = fall * leaves.linear_spot(x, y, z, *axis, light.beam, light.cutoff)
    return (x, y, z), (e[0] * fall, e[1] * fall, e[2] * fall)


@jitable
def is_hidden(world: World, own: int, front: bool, place: Vector, i: int) -> bool:
    """Whether a piece hides light ``i``, a point, a spot or a directional one, from a place of a piece facing it."""
    if world.lights[i].kind == DIRECTIONAL:
        return hidden_direction(world, own, front, place, i)
    return hidden_point(world, own, front, place, i)


@jitable
def extended_irradiance(
    world: World, light: Light, own: int, front: bool, place: Vector, normal: Vector, turned: Vector, room: Room
) -> float:  # fmt: skip
    """Irradiance of a place of piece ``own`` by a sky or a shape that emits, of radiance 1.

    Light counts from above the horizons of both normals, by the cosine of the one the material says.
    """
    if light.kind == AREA:
        return area_irradiance(world, own, front, int(light.emitter), place, normal, turned, room)
    return sky_irradiance(world, own, front, place, normal, turned, room)


@jitable
def direct_irradiance(world: World, own: int, front: bool, place: Vector, normal: Vector, room: Room) -> Vector:
    """Irradiance of a place of piece ``own`` by all lights; ``normal`` is unit, on the side that is lit.

    ``front`` says whether that is the side of the piece's own normal.
    """
    total = (0.0, 0.0, 0.0)
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        if light.kind == SKY or light.kind == AREA:
            share = extended_irradiance(world, light, own, front, place, normal, normal, room)
            e = vector(light.emitted)
        else:
            toward, e = arriving(light, place)
            share = dot(normal, toward)
            if share <= 0.0 or is_hidden(world, own, front, place, i):
                continue
        total = (total[0] + share * e[0], total[1] + share * e[1], total[2] + share * e[2])
    return total


@jitable
def direct_light(
    world: World, own: int, front: bool, place: Vector, normal: Vector, view: Vector, room: Room
) -> Vector:  # fmt: skip
    """Direct light leaving a place of piece ``own`` towards ``view``, but what is glossy leaves of sky and lamps.

    Under a bump nothing leaves below the turned horizon, and nothing arrives from below either.
    """
    material = world.materials[int(world.pieces[own].material)]
    total = (0.0, 0.0, 0.0)
    if not front and material.two_sided == 0.0:
        return total
    turned = shading_normal(world, own, front, place, normal, room)
    if material.terms != 0.0:
        square = dot(turned, turned)
        if not square > 0.0:
            # so steep that its normal is no number, and no value nor a slope of it either
            return (square / square, square / square, square / square)
        if dot(turned, view) <= 0.0:
            return total
    albedo = reflectance(world, own, place)
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        if light.kind == SKY or light.kind == AREA:
            if material.kind != DIFFUSE:
                # a lobe's integral, which is none of this kernel's
                continue
            e = vector(light.emitted)
            share = leaves.diffuse_reflection(
                extended_irradiance(world, light, own, front, place, normal, turned, room)
            )
            term = (albedo[0] * share, albedo[1] * share, albedo[2] * share)
        else:
            toward, e = arriving(light, place)
            white = reflected(material, (1.0, 1.0, 1.0), turned, view, toward)
            # what is black has a slope
            term = (albedo[0] * white[0], albedo[1] * white[1], albedo[2] * white[2])
            if material.terms != 0.0:
                if dot(normal, toward) <= 0.0 or dot(turned, toward) <= 0.0:
                    continue
                by = counted(material, normal, turned, toward)
                term = (by * term[0], by * term[1], by * term[2])
            if max(white[0], white[1], white[2]) == 0.0 or is_hidden(world, own, front, place, i):
                continue
        total = (total[0] + term[0] * e[0], total[1] + term[1] * e[1], total[2] + term[2] * e[2])
    return total


@jitable
def leaving(
    world: World, own: int, place: Vector, normal: Vector, front: bool, d: Vector, room: Room
) -> tuple[int, Vector, Vector]:  # fmt: skip
    """(hit class, emitted, direct) of what a unit ray meets, as ``nearest`` tells; 0 is nothing: the sky is seen."""
    emitted = (0.0, 0.0, 0.0)
    if own < 0:
        for i in range(world.lights.shape[0]):
            if world.lights[i].kind == SKY:
                emitted = vector(world.lights[i].emitted)
        return 0, emitted, (0.0, 0.0, 0.0)
    shape = int(world.pieces[own].owner)
    if front:
        for i in range(world.lights.shape[0]):
            if world.lights[i].kind == AREA and int(world.lights[i].emitter) == shape:
                emitted = vector(world.lights[i].emitted)
    view = (-d[0], -d[1], -d[2])
    return FIRST_SHAPE + shape, emitted, direct_light(world, own, front, place, normal, view, room)


@jitable
def along_ray(world: World, origin: Vector, d: Vector, room: Room) -> tuple[int, Vector, Vector]:
    """(hit class, emitted, direct) along a unit ray."""
    own, _, place, normal, front = nearest(world, origin, d)
    return leaving(world, own, place, normal, front, d, room)
