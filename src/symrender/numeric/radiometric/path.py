"""Paths: what one sample of a pixel adds, lights and materials both asked for directions where both can be."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.bsdfs.dispatch import asks_for_three, choose, density, scattered, widening
from symrender.numeric.radiometric.bumps import raised_normal
from symrender.numeric.radiometric.emitters import chance_of, emitter_sample, shining
from symrender.numeric.radiometric.environment import beyond, sky_chance, sky_way
from symrender.numeric.radiometric.hits import Hit, first_hit, reaches
from symrender.numeric.radiometric.meshes import smooth_normal
from symrender.numeric.radiometric.pictures import painted
from symrender.numeric.radiometric.world import World
from symrender.numeric.random import Key, uniforms
from symrender.numeric.samplers import IMPORTANCE, square_point
from symrender.numeric.vectors import Vector, along, cross, dot, minus, triple, unit
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, DIRECTIONAL, ENVIRONMENT, MESH, SKY, SPOT
from symrender.scene.radiometric.records import Light, Material

ROULETTE: Final = 3
"""Reflections after which a path may end by chance."""
_MOST_KEPT: Final = 0.95
_DEGREE: Final = math.pi / 180.0


class Surface(NamedTuple):
    """A hit that reflects: its normal towards the ray, two directions across it, its albedo, the eye in its frame.

    ``normal`` is that by which it reflects, ``facing`` that of the shape, the same without a bump and normals of
    vertices.
    """

    hit: Hit
    facing: Vector
    normal: Vector
    first: Vector
    second: Vector
    reflectance: Vector
    wo: Vector


@inlined
def shows(world: World, hit: Hit) -> bool:
    """Whether the side of a shape that was hit reflects."""
    return not hit.behind or world.materials[int(world.shapes[hit.own].material)].two_sided != 0.0


@jitable
def surface(world: World, hit: Hit, d: Vector) -> Surface:
    """What a ray of direction d finds at a hit."""
    o = hit.outward
    n = (-o[0], -o[1], -o[2]) if hit.behind else o
    facing = n
    if world.materials[int(world.shapes[hit.own].material)].terms != 0.0:
        o = raised_normal(world, hit)
        n = (-o[0], -o[1], -o[2]) if hit.behind else o
    elif hit.face >= 0 and world.normals.shape[0] > 0:
        # as Mitsuba does: the side is that of this normal, and light is not cut at the horizon of the face
        n = smooth_normal(world.faces[hit.face], world.normals[hit.face], hit.place, n)
        if dot(n, d) > 0.0 and world.materials[int(world.shapes[hit.own].material)].two_sided != 0.0:
            n = (-n[0], -n[1], -n[2])
    first = unit(cross(n, (0.0, 0.0, 1.0) if abs(n[2]) < 0.7 else (1.0, 0.0, 0.0)))
    second = cross(n, first)
    wo = (-dot(d, first), -dot(d, second), -dot(d, n))
    return Surface(hit, facing, n, first, second, painted(world, hit), wo)


@inlined
def local(at: Surface, w: Vector) -> Vector:
    """A direction in the frame of the surface."""
    return (dot(w, at.first), dot(w, at.second), dot(w, at.normal))


@inlined
def outside(at: Surface, w: Vector) -> Vector:
    """A direction of the surface's frame in the world."""
    x = along((w[0] * at.first[0], w[0] * at.first[1], w[0] * at.first[2]), w[1], at.second)
    return along(x, w[2], at.normal)


@inlined
def scaled(a: Vector, b: Vector, factor: float) -> Vector:
    """a b factor, channel by channel."""
    return (a[0] * b[0] * factor, a[1] * b[1] * factor, a[2] * b[2] * factor)


@inlined
def plus(a: Vector, b: Vector) -> Vector:
    """a + b"""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@jitable
def leaving(material: Material, at: Surface, w: Vector, wi: Vector) -> Vector:
    """f cos_i of the direction w, which is wi in the frame of the surface."""
    return from_above(material, at, w, wi, scattered(material, at.hit.behind, at.reflectance, at.wo, wi))


@jitable
def from_above(material: Material, at: Surface, w: Vector, wi: Vector, share: Vector) -> Vector:
    """A share of the direction w, which is wi in the frame of the surface, as a bump lets it arrive.

    Nothing arrives from below the shape's own horizon, and the cosine may be that of its own normal.
    """
    if material.terms == 0.0:
        return share
    own = dot(at.facing, w)
    if own <= 0.0 or wi[2] <= 0.0:
        return (0.0, 0.0, 0.0)
    return scaled(share, (1.0, 1.0, 1.0), own / wi[2] if material.geometric != 0.0 else 1.0)


@inlined
def goes_inside(at: Surface, wi: Vector) -> bool:
    """Whether a direction leads to the inside of the shape of a hit."""
    return at.hit.behind != (wi[2] < 0.0)


@jitable
def in_beam(light: Light, toward: Vector) -> float:
    """Share of its intensity that a spot sends against the unit vector ``toward`` it."""
    axis = triple(light.axis)
    apart, mean = plus(toward, axis), minus(toward, axis)
    # twice the angle whose tangent is |w - a|/|w + a|, w the way light goes
    angle = 2.0 * math.atan2(math.sqrt(dot(apart, apart)), math.sqrt(dot(mean, mean)))
    beam, cutoff = light.beam * _DEGREE, light.cutoff * _DEGREE
    if angle <= beam or angle >= cutoff:
        return 1.0 if angle <= beam else 0.0
    if light.smooth == 0.0:
        return (cutoff - angle) / (cutoff - beam)
    # a difference of cosines is a product of sines
    down = math.sin(0.5 * (cutoff + angle)) * math.sin(0.5 * (cutoff - angle))
    t = down / (math.sin(0.5 * (cutoff + beam)) * math.sin(0.5 * (cutoff - beam)))
    return t * t * (3.0 - 2.0 * t)


@jitable
def from_points(world: World, at: Surface) -> Vector:
    """Reflected light of all lights that are single points or directions."""
    total = (0.0, 0.0, 0.0)
    material = world.materials[int(world.shapes[at.hit.own].material)]
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        if light.kind == SKY or light.kind == AREA or light.kind == ENVIRONMENT:
            continue
        if light.kind == DIRECTIONAL:
            toward = (-light.place[0], -light.place[1], -light.place[2])
            limit, strength = math.inf, 1.0
        else:
            way = minus(triple(light.place), at.hit.place)
            limit = math.sqrt(dot(way, way))
            toward, strength = unit(way), 1.0 / (limit * limit)
            if light.kind == SPOT:
                strength *= in_beam(light, toward)
        wi = local(at, toward)
        share = leaving(material, at, toward, wi)
        if max(share[0], share[1], share[2]) > 0.0 and reaches(world, at.hit, toward, limit, goes_inside(at, wi)):
            total = plus(total, scaled(share, triple(light.emitted), strength))
    return total


@jitable
def from_sky(world: World, at: Surface, a: float, b: float) -> Vector:
    """Reflected light of a sky by a direction of its own choice, weighted against those the material chooses."""
    material = world.materials[int(world.shapes[at.hit.own].material)]
    if world.lights[world.sky].kind == SKY:
        r = math.sqrt(max(0.0, 1.0 - a * a))
        wi = (r * math.cos(2.0 * math.pi * b), r * math.sin(2.0 * math.pi * b), a)
        d = outside(at, wi)
    else:
        d = sky_way(world, a, b)
        wi = local(at, d)
    share, chance = leaving(material, at, d, wi), sky_chance(world, d)
    if max(share[0], share[1], share[2]) <= 0.0 or chance <= 0.0:
        return (0.0, 0.0, 0.0)
    if not reaches(world, at.hit, d, math.inf, goes_inside(at, wi)):
        return (0.0, 0.0, 0.0)
    # balance heuristic: 1/(own density + the other's)
    own = density(material, at.hit.behind, at.reflectance, at.wo, wi)
    return scaled(share, beyond(world, d), 1.0 / (chance + own))


@jitable
def from_emitters(world: World, at: Surface, a: float, b: float) -> Vector:
    """Reflected light of all shapes that emit, each by a direction of its own choice, weighted as a sky's."""
    total = (0.0, 0.0, 0.0)
    material = world.materials[int(world.shapes[at.hit.own].material)]
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        emitter = int(light.emitter)
        # of all shapes only a mesh may see some of itself
        if light.kind != AREA or (emitter == at.hit.own and world.shapes[emitter].kind != MESH):
            continue
        d, possible, face = emitter_sample(world, emitter, at.hit.place, a, b)
        if not possible:
            continue
        wi = local(at, d)
        share = leaving(material, at, d, wi)
        if max(share[0], share[1], share[2]) <= 0.0:
            continue
        hit = first_hit(world, at.hit.place, d, at.hit.own, at.hit.face, goes_inside(at, wi))
        # a way to a face behind another one of a mesh is none: there are ways to the nearer one already
        if hit.own == emitter and not hit.behind and (face < 0 or hit.face == face):
            chance = chance_of(world, hit, at.hit.place, d) + density(
                material, at.hit.behind, at.reflectance, at.wo, wi
            )
            total = plus(total, scaled(share, triple(light.emitted), 1.0 / chance))
    return total


@jitable
def met(world: World, hit: Hit, place: Vector, d: Vector, chance: float, both: bool) -> Vector:
    """What a hit emits towards ``place``, from which direction ``d`` of this density went, weighted."""
    light = shining(world, hit)
    if max(light[0], light[1], light[2]) <= 0.0:
        return light
    weight = 1.0 / (chance + (chance_of(world, hit, place, d) if both else 0.0))
    return scaled(light, (1.0, 1.0, 1.0), weight)


@jitable
def path(world: World, start: Surface, sampler: int, order: int, key: Key, index: int) -> tuple[Vector, Vector, int]:
    """(direct light of extended lights, all later light, rays) of one path on from a first hit."""
    direct, indirect, at = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), start
    through, spent, depth = (1.0, 1.0, 1.0), 0, 0
    both, wide = sampler != IMPORTANCE, 1.0
    while depth < world.bounces or (world.extended and depth == world.bounces):
        material = world.materials[int(world.shapes[at.hit.own].material)]
        a, b = uniforms(key, index, 3 * depth + 1)
        if depth == 0:
            # strata for the first choice of both
            a, b = (index // order + a) / order, (index % order + b) / order
        if both and world.extended:
            light = from_emitters(world, at, a, b)
            if world.sky >= 0:
                light = plus(light, from_sky(world, at, a, b))
            light = scaled(through, light, 1.0)
            spent += 1
            direct, indirect = (plus(direct, light), indirect) if depth == 0 else (direct, plus(indirect, light))
        a, b = square_point(sampler, key, index, order) if depth == 0 else uniforms(key, index, 3 * depth)
        third = uniforms(key, index, 3 * depth + 2)[1] if asks_for_three(material) else 0.0
        made = choose(material, at.hit.behind, at.reflectance, at.wo, a, b, third)
        wi, d = made.wi, unit(outside(at, made.wi))
        if made.sharp:
            # no light chooses this direction
            share, chance, shared = from_above(material, at, d, wi, made.weight), 1.0, False
        else:
            share, chance = leaving(material, at, d, wi), density(material, at.hit.behind, at.reflectance, at.wo, wi)
            shared = both
        if max(share[0], share[1], share[2]) <= 0.0 or chance <= 0.0:
            break
        hit = first_hit(world, at.hit.place, d, at.hit.own, at.hit.face, goes_inside(at, wi))
        spent += 1
        if hit.own < 0:
            if world.sky >= 0:
                # a uniform sky is asked for directions above the surface alone
                above = wi[2] > 0.0 or world.lights[world.sky].kind == ENVIRONMENT
                weight = 1.0 / (chance + (sky_chance(world, d) if shared and above else 0.0))
                light = scaled(scaled(through, share, weight), beyond(world, d), 1.0)
                direct, indirect = (plus(direct, light), indirect) if depth == 0 else (direct, plus(indirect, light))
            break
        light = scaled(scaled(through, share, 1.0), met(world, hit, at.hit.place, d, chance, shared), 1.0)
        direct, indirect = (plus(direct, light), indirect) if depth == 0 else (direct, plus(indirect, light))
        depth += 1
        if depth > world.bounces or not shows(world, hit):
            break
        if world.first_gloss and world.materials[int(world.shapes[hit.own].material)].kind != DIFFUSE:
            break
        through = scaled(through, share, 1.0 / chance)
        wide *= widening(material, at.hit.behind, wi)
        if depth > ROULETTE:
            kept = min(_MOST_KEPT, wide * max(through[0], through[1], through[2]))
            if uniforms(key, index, 3 * depth + 2)[0] >= kept:
                break
            through = (through[0] / kept, through[1] / kept, through[2] / kept)
        at = surface(world, hit, d)
        indirect = plus(indirect, scaled(through, from_points(world, at), 1.0))
    return direct, indirect, spent
