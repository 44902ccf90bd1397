"""Emission and direct light along a ray, with what rounding may have done to them."""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.reflection import reflectance, reflected
from symrender.radiometric.sight import dot, hidden_direction, hidden_point, nearest, vector
from symrender.radiometric.sky import sky_irradiance
from symrender.radiometric.world import Array, Vector, World
from symrender.scene.arrays import MARBLE
from symrender.scene.radiometric.arrays import CONDUCTOR, FIRST_SHAPE, PHONG, POINT, SKY, SPHERE
from symrender.scene.radiometric.records import Material

_ULP: Final = 2.0**-52
_STEEPEST_VEIN: Final = 14.0
"""Slope of a vein's share in cells: pi (1 + .35 * 3 pi) and some."""
_SLACK: Final = 16.0
"""Roundings a term goes through, by which its slope is multiplied."""


@inlined
def largest(v: Vector) -> float:
    """The largest magnitude of three."""
    return max(abs(v[0]), abs(v[1]), abs(v[2]))


@jitable
def sharpness(material: Material, normal: Vector, view: Vector, light: Vector) -> float:
    """Largest relative slope of f cos_i in an angle: what a wrong direction is multiplied by."""
    found = 1.0 + 1.0 / max(dot(normal, light), _ULP)
    if material.kind == CONDUCTOR:
        cosine, sine2, _ = leaves.half_angles(*normal, *view, *light)
        steep = math.sqrt(sine2) / (max(cosine, _ULP) * material.alpha)
        found += 1.0 / max(dot(normal, view), _ULP) + (4.0 + 2.0 * steep) / material.alpha
    elif material.kind == PHONG:
        axis = values.mirror_direction(-view[0], -view[1], -view[2], *normal)
        cosine = max(1.0 - 0.5 * values.lobe_chord(*light, *axis), _ULP)
        found += 8.0 * math.sqrt(material.exponent) + material.exponent * math.sqrt(max(0.0, 1.0 - cosine**2)) / cosine
    return found


@jitable
def vein_blur(world: World, own: int, place: Vector, albedo: Vector, size: float) -> float:
    """What roundings of ``size`` in a place do to the reflectance of veins, relative to the largest channel.

    Fields are constant, so that only which of them a place is in could be wrong.
    """
    shape = world.shapes[own]
    material = world.materials[int(shape.material)]
    if material.texture != MARBLE:
        return 0.0
    wrong = _ULP * size
    if shape.kind == SPHERE:
        x, y = place[0] - shape.place[0], place[1] - shape.place[1]
        wrong = _ULP * (1.0 + size / max(math.sqrt(x * x + y * y), _ULP * shape.radius))
    dark, bright = material.dark, material.bright
    contrast = largest((bright[0] - dark[0], bright[1] - dark[1], bright[2] - dark[2]))
    return _STEEPEST_VEIN * wrong * contrast / (material.cell * max(largest(albedo), _ULP))


@jitable
def direct_light(
    world: World, own: int, front: bool, place: Vector, normal: Vector, view: Vector, size: float, caps: Array,
    arcs: Array,
) -> tuple[Vector, float]:  # fmt: skip
    """(direct light, its largest error over the channels by rounding) leaving a place towards ``view``.

    ``size`` is the largest coordinate on the way, in whose roundings the place is known.
    """
    shape = world.shapes[own]
    material = world.materials[int(shape.material)]
    total, error = (0.0, 0.0, 0.0), 0.0
    if not front and material.two_sided == 0.0:
        return total, error
    albedo = reflectance(world, own, place)
    blur = vein_blur(world, own, place, albedo, size)
    wrong = _ULP * (1.0 + (size / shape.radius if shape.kind == SPHERE else 0.0))
    for i in range(world.lights.shape[0]):
        light = world.lights[i]
        e = vector(light.emitted)
        if light.kind == SKY:
            seen = sky_irradiance(world, own, place, normal, caps, arcs) if front or shape.kind != SPHERE else 0.0
            share = leaves.diffuse_reflection(seen)
            term = (albedo[0] * share, albedo[1] * share, albedo[2] * share)
            miss = largest(e) * largest(albedo) * (wrong + blur + _ULP * caps.shape[0])
        else:
            at = vector(light.place)
            if light.kind == POINT:
                x, y, z, fall = leaves.point_light(*place, *at)
                toward, astray = (x, y, z), wrong + _ULP * (size + largest(at)) * math.sqrt(fall)
                e = (e[0] * fall, e[1] * fall, e[2] * fall)
            else:
                toward, astray = (-at[0], -at[1], -at[2]), wrong
            term = reflected(material, albedo, normal, view, toward)
            if largest(term) == 0.0:
                continue
            if light.kind == POINT:
                if hidden_point(world, own, front, place, at):
                    continue
            elif hidden_direction(world, own, front, place, toward):
                continue
            miss = largest((term[0] * e[0], term[1] * e[1], term[2] * e[2]))
            miss *= blur + astray * (2.0 + sharpness(material, normal, view, toward))
        total = (total[0] + term[0] * e[0], total[1] + term[1] * e[1], total[2] + term[2] * e[2])
        error += _SLACK * miss
    return total, error


@jitable
def along_ray(
    world: World, origin: Vector, d: Vector, caps: Array, arcs: Array
) -> tuple[int, Vector, Vector, float]:  # fmt: skip
    """(hit class, emitted, direct, error) along a unit ray; 0 is nothing, where the sky is seen."""
    own, distance, place, normal, front = nearest(world, origin, d)
    emitted = (0.0, 0.0, 0.0)
    if own < 0:
        for i in range(world.lights.shape[0]):
            if world.lights[i].kind == SKY:
                emitted = vector(world.lights[i].emitted)
        return 0, emitted, (0.0, 0.0, 0.0), 0.0
    size = largest(origin) + distance + largest(vector(world.shapes[own].place))
    view = (-d[0], -d[1], -d[2])
    light, error = direct_light(world, own, front, place, normal, view, size, caps, arcs)
    return FIRST_SHAPE + own, emitted, light, error
