"""Emission and direct light along a ray."""

from __future__ import annotations

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.reflection import reflectance, reflected
from symrender.radiometric.sight import hidden_direction, hidden_point, nearest, vector
from symrender.radiometric.sky import area_irradiance, sky_irradiance
from symrender.radiometric.world import Array, Vector, World
from symrender.scene.radiometric.arrays import AREA, FIRST_SHAPE, POINT, SKY, SPHERE


@jitable
def direct_light(
    world: World, own: int, front: bool, place: Vector, normal: Vector, view: Vector, caps: Array, arcs: Array
) -> Vector:
    """Direct light leaving a place of shape ``own`` towards ``view``."""
    shape = world.shapes[own]
    material = world.materials[int(shape.material)]
    total = (0.0, 0.0, 0.0)
    if not front and material.two_sided == 0.0:
        return total
    albedo = reflectance(world, own, place)
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        e = vector(light.emitted)
        if light.kind == SKY or light.kind == AREA:
            seen = 0.0
            if light.kind == AREA:
                seen = area_irradiance(world, own, front, int(light.emitter), place, normal, caps, arcs)
            elif front or shape.kind != SPHERE:
                seen = sky_irradiance(world, own, place, normal, caps, arcs)
            share = leaves.diffuse_reflection(seen)
            term = (albedo[0] * share, albedo[1] * share, albedo[2] * share)
        else:
            at = vector(light.place)
            if light.kind == POINT:
                x, y, z, fall = leaves.point_light(*place, *at)
                toward = (x, y, z)
                e = (e[0] * fall, e[1] * fall, e[2] * fall)
            else:
                toward = (-at[0], -at[1], -at[2])
            term = reflected(material, albedo, normal, view, toward)
            if max(term[0], term[1], term[2]) == 0.0:
                continue
            if light.kind == POINT:
                if hidden_point(world, own, front, place, at):
                    continue
            elif hidden_direction(world, own, front, place, toward):
                continue
        total = (total[0] + term[0] * e[0], total[1] + term[1] * e[1], total[2] + term[2] * e[2])
    return total


@jitable
def along_ray(world: World, origin: Vector, d: Vector, caps: Array, arcs: Array) -> tuple[int, Vector, Vector]:
    """(hit class, emitted, direct) along a unit ray; 0 is nothing, where the sky is seen."""
    own, _, place, normal, front = nearest(world, origin, d)
    emitted = (0.0, 0.0, 0.0)
    if own < 0:
        for i in range(world.lights.shape[0]):
            if world.lights[i].kind == SKY:
                emitted = vector(world.lights[i].emitted)
        return 0, emitted, (0.0, 0.0, 0.0)
    if front:
        for i in range(world.lights.shape[0]):
            if world.lights[i].kind == AREA and int(world.lights[i].emitter) == own:
                emitted = vector(world.lights[i].emitted)
    view = (-d[0], -d[1], -d[2])
    return FIRST_SHAPE + own, emitted, direct_light(world, own, front, place, normal, view, caps, arcs)
