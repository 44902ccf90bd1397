"""Direct light at a point: shadows, diffuse and highlight terms, summed over the lights."""

from __future__ import annotations

import math

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.lights import disk_point
from symrender.numeric.planes import planes_hide
from symrender.numeric.random import Key, uniforms
from symrender.numeric.vectors import Vector, along, dot, minus
from symrender.numeric.world import World
from symrender.scene.arrays import BLINN, CUT, FIRST_SPHERE, FLOOR
from symrender.scene.records import Sphere

_WHOLE_POWER = 256.0


@inlined
def power(x: float, exponent: float) -> float:
    """x^exponent for x >= 0, with 0^0 = 1."""
    if exponent > _WHOLE_POWER or exponent != np.floor(exponent):
        return float(x**exponent)
    result = 1.0
    n = int(exponent)
    while n > 0:
        if n & 1:
            result *= x
        x *= x
        n >>= 1
    return result


@inlined
def inside_sphere(sphere: Sphere, point: Vector) -> float:
    """Radius^2 - distance^2 from the centre: positive inside, negative outside."""
    f = (point[0] - sphere.center[0], point[1] - sphere.center[1], point[2] - sphere.center[2])
    return float(sphere.radius * sphere.radius - dot(f, f))


@inlined
def sphere_blocks(sphere: Sphere, q: Vector, light: Vector) -> bool:
    """Whether the open segment from q to the light point meets the sphere's surface, or is a chord of it."""
    f = (q[0] - sphere.center[0], q[1] - sphere.center[1], q[2] - sphere.center[2])
    d = minus(light, q)
    toward = -dot(f, d)
    power_of_q = dot(f, f) - sphere.radius * sphere.radius
    if power_of_q < 0.0:
        return inside_sphere(sphere, light) < 0.0
    if toward <= 0.0:
        return False
    if power_of_q == 0.0:
        return inside_sphere(sphere, light) <= 0.0
    length = dot(d, d)
    if toward >= length:
        return inside_sphere(sphere, light) > 0.0
    l = along(f, toward / length, d)
    return bool(dot(l, l) <= sphere.radius * sphere.radius)


@inlined
def visible(world: World, own: int, inside: bool, q: Vector, light: Vector) -> bool:
    """Whether a light point lights q on the shape of hit class ``own``, which was met from ``inside`` or not.

    Other spheres block where the open segment meets them; floor and planes where the ends are on opposite sides (a
    light not above them does not light them); the shape's own sphere iff the light point is on its other side.
    """
    if world.floor.present != 0.0:
        if own == FLOOR:
            if light[2] <= 0.0:
                return False
        elif (q[2] > 0.0 and light[2] < 0.0) or (q[2] < 0.0 and light[2] > 0.0):
            return False
    if world.frames.shape[0] > 0 and planes_hide(
        world.frames, FIRST_SPHERE + world.spheres.shape[0], own, q, light
    ):  # fmt: skip
        return False
    for j in range(world.spheres.shape[0]):
        sphere = world.spheres[j]
        if own == FIRST_SPHERE + j:
            within = inside_sphere(sphere, light)
            if within < 0.0 if inside else within > 0.0:
                return False
        elif sphere_blocks(sphere, q, light):
            return False
    return True


@inlined
def light_terms(
    world: World, own: int, inside: bool, q: Vector, n: Vector, v: Vector, light: Vector
) -> tuple[float, float]:
    """Visible diffuse max(0, n.l) and highlight s of one light point; both 0 for a light at q itself."""
    d = minus(light, q)
    length = math.sqrt(dot(d, d))
    if length == 0.0:
        return 0.0, 0.0
    l = (d[0] / length, d[1] / length, d[2] / length)
    cosine = dot(n, l)
    diffuse = max(0.0, cosine)
    shininess = world.shading.shininess
    base = -1.0
    if (cosine > 0.0 or world.shading.terminator != CUT) and dot(v, v) > 0.0:
        if world.shading.model == BLINN:
            h = along(l, 1.0, v)
            square = dot(h, h)
            base = max(0.0, dot(n, h) / math.sqrt(square)) if square > 0.0 else 0.0
        else:
            base = max(0.0, 2.0 * cosine * dot(n, v) - dot(l, v))
    highlight = base > 0.0 or (base == 0.0 and shininess == 0.0)
    if diffuse == 0.0 and not highlight:
        return 0.0, 0.0
    if not visible(world, own, inside, q, light):
        return 0.0, 0.0
    return diffuse, power(base, shininess) if highlight else 0.0


@inlined
def direct_light(
    world: World,
    own: int,
    inside: bool,
    q: Vector,
    n: Vector,
    v: Vector,
    albedo: Vector,
    key: Key,
    sample: int,
    strata: int,
) -> Vector:
    """Radiance of a lit point: ka ambient + sum over lights of colour (kd albedo diffuse + ks s), scene units.

    A disk light's terms are means over its points, or over ``strata`` x ``strata`` points drawn on it where it has
    none; those are drawn in the dimensions of ``sample`` of the pixel ``key``.
    """
    ka, kd, ks = world.shading.ka, world.shading.kd, world.shading.ks
    red = ka * world.shading.ambient[0]
    green = ka * world.shading.ambient[1]
    blue = ka * world.shading.ambient[2]
    for index in range(world.lights.shape[0]):
        start = world.first[index]
        count = world.first[index + 1] - start
        drawn = count == 0
        if drawn:
            count = strata * strata
        diffuse, highlight = 0.0, 0.0
        for k in range(count):
            if drawn:
                a, b = uniforms(key, sample * count + k, 2 * index + strata)
                a, b = (k // strata + a) / strata, (k % strata + b) / strata
                light = disk_point(world.lights[index], world.axes[index], a, b)
            else:
                light = (world.points[start + k, 0], world.points[start + k, 1], world.points[start + k, 2])
            terms = light_terms(world, own, inside, q, n, v, light)
            diffuse += terms[0]
            highlight += terms[1]
        if diffuse != 0.0 or highlight != 0.0:
            diffuse *= kd / count
            highlight *= ks / count
            red += world.lights[index].color[0] * (albedo[0] * diffuse + highlight)
            green += world.lights[index].color[1] * (albedo[1] * diffuse + highlight)
            blue += world.lights[index].color[2] * (albedo[2] * diffuse + highlight)
    return red, green, blue
