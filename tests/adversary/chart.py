"""Compiled: charts of directions, one for each sphere the lobe sees from outside and one about the lobe for the rest.

A direction of a chart is (t, phi). On a sphere's chart t is the angle of incidence at the hit, in which everything is
smooth up to the limb; on the lobe's chart t^2 is the share of the lobe nearer its axis. A label tells pieces apart on
which the integrand is smooth; it is even where there is nothing to see.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from .compile import kernel
from .light import Vector, base_of, beyond, center_of, dot, lit, minus, nearest, on_surface, outward_normal, view_of
from .world import (
    ACROSS,
    BACKGROUND,
    BRDF,
    EXPONENT,
    HEIGHT,
    MASS,
    MIRROR,
    NORMAL,
    PLACE,
    SURFACE,
    Array,
    World,
)

# columns of a chart: sphere (0 the lobe's own), axis, two directions across it, sine of the disc's half-angle
AXIS: Final = 1
FIRST: Final = 4
SECOND: Final = 7
SINE: Final = 10
CHART: Final = 11
_MIX = 1000003


def lobe_chart(lobe: Array) -> Array:
    """The chart about the mirror direction."""
    chart = np.zeros(CHART)
    chart[AXIS:FIRST], chart[FIRST:SINE] = lobe[MIRROR:EXPONENT], lobe[ACROSS:]
    return chart


def sphere_chart(world: World, lobe: Array, j: int) -> Array:
    """The chart of sphere j, which the lobe's place is outside of."""
    chart = np.zeros(CHART)
    d = world.spheres[j, :3] - lobe[PLACE:NORMAL]
    distance = float(np.linalg.norm(d))
    axis = d / distance
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    chart[0], chart[AXIS:FIRST], chart[FIRST:SECOND] = 1 + j, axis, first
    chart[SECOND:SINE], chart[SINE] = np.cross(axis, first), world.spheres[j, 3] / distance
    return chart


@kernel
def direction(lobe: Array, chart: Array, t: float, phi: float) -> tuple[Vector, float, float]:
    """Unit direction, and cosine and sine of its angle to the chart's axis."""
    if chart[0] == 0.0:
        s = t * t * lobe[MASS]
        depth = -math.expm1(math.log1p(-s) / (lobe[EXPONENT] + 1.0)) if s < 1.0 else 1.0
        x, z = math.sqrt(depth * (2.0 - depth)), 1.0 - depth
    else:
        x = chart[10] * math.sin(t)
        z = math.sqrt(max(0.0, 1.0 - x * x))
    a, b = x * math.cos(phi), x * math.sin(phi)
    d = (
        z * chart[1] + a * chart[4] + b * chart[7],
        z * chart[2] + a * chart[5] + b * chart[8],
        z * chart[3] + a * chart[6] + b * chart[9],
    )
    return d, z, x


@kernel
def on_sphere(w: World, chart: Array, t: float, phi: float, z: float, x: float) -> tuple[Vector, Vector]:
    """Place and normal of a sphere's chart: the triangle of eye, centre and hit has the angles psi, t - psi, pi - t."""
    a, b = math.cos(t) * z + math.sin(t) * x, math.sin(t) * z - math.cos(t) * x
    p, q = b * math.cos(phi), b * math.sin(phi)
    n = (
        -a * chart[1] + p * chart[4] + q * chart[7],
        -a * chart[2] + p * chart[5] + q * chart[8],
        -a * chart[3] + p * chart[6] + q * chart[9],
    )
    return on_surface(w.spheres, int(chart[0]) - 1, n), n


@kernel
def between(w: World, own: int, shape: int, o: Vector, q: Vector) -> int:
    """0 where nothing but the two surfaces stands between o and q, else a number that tells what does."""
    found = 1 if w.floor[0] != 0.0 and own != 0 and o[2] * q[2] < 0.0 else 0
    for i in range(w.spheres.shape[0]):
        found *= 2
        if own != 1 + i and shape != 1 + i and beyond(w.spheres, i, o, q):
            found += 1
    return found


@kernel
def look(
    w: World,
    lobe: Array,
    chart: Array,
    charted: Array,
    t: float,
    phi: float,
    on_disk: Array,
    bases: Array,
    rgb: Array,
    whole: bool,
) -> int:
    """Label of a direction; with ``whole`` the integrand over dt dphi, into ``rgb``.

    ``charted`` (n,): spheres with charts of their own, which the lobe's chart leaves to them.
    """
    d, z, x = direction(lobe, chart, t, phi)
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    own, n = int(lobe[SURFACE]), lobe[EXPONENT]
    cosine = dot(d, (lobe[NORMAL], lobe[NORMAL + 1], lobe[NORMAL + 2]))
    above = 1 if cosine > 0.0 else 0
    if chart[0] == 0.0:
        shape, inside, distance = nearest(w, own, o, d)
        case = 8 * (2 + shape) + (4 if d[2] > 0.0 else 0) + (2 if inside else 0) + above
        if above == 0 or (shape > 0 and not inside and charted[shape - 1]) or (shape == 0 and d[2] > 0.0):
            return 2 * case
        weight = t / math.pi
        if lobe[BRDF] != 0.0:
            weight *= (n + 2.0) / (n + 1.0) * lobe[MASS] * cosine
        if shape < 0:
            for c in range(3):
                rgb[c] = weight * w.rules[BACKGROUND + c]
            return 2 * case + 1
        if shape == 0:
            q, normal = (o[0] + distance * d[0], o[1] + distance * d[1], 0.0), (0.0, 0.0, 1.0)
        else:
            normal = outward_normal(w.spheres, shape - 1, o, d, inside)
            q = on_surface(w.spheres, shape - 1, normal)
        label = lit(w, shape, inside, q, normal, d, on_disk, bases, rgb, whole)
        for c in range(3):
            rgb[c] *= weight
        return 2 * (label * _MIX + case) + 1
    shape = int(chart[0])
    q, normal = on_sphere(w, chart, t, phi, z, x)
    m = (d[0] - lobe[MIRROR], d[1] - lobe[MIRROR + 1], d[2] - lobe[MIRROR + 2])
    depth = 0.5 * dot(m, m)
    rim = 2 if depth <= lobe[HEIGHT] and depth < 1.0 else 0
    wall = between(w, own, shape, o, q)
    shut = above == 0 or rim == 0 or wall != 0
    label = lit(w, shape, False, q, normal, d, on_disk, bases, rgb, whole and not shut)
    case = 4 * wall + rim + above
    if shut:
        return 2 * case
    if whole:
        weight = math.exp(n * math.log1p(-depth)) if n > 0.0 else 1.0
        if lobe[BRDF] != 0.0:
            weight *= (n + 2.0) * cosine / (2.0 * math.pi)
        else:
            weight *= (n + 1.0) / (2.0 * math.pi * lobe[MASS])
        weight *= chart[10] * chart[10] * math.sin(t) * (math.cos(t) / z if z > 0.0 else 1.0)
        for c in range(3):
            rgb[c] *= weight
    return 2 * (label * _MIX + case) + 1


@kernel
def shining(
    w: World, lobe: Array, chart: Array, charted: Array, t: float, phi: float
) -> tuple[bool, Vector, Vector, Vector]:
    """Whether a direction meets anything of its chart, then place, normal and view of what it meets."""
    d, z, x = direction(lobe, chart, t, phi)
    if chart[0] != 0.0:
        q, normal = on_sphere(w, chart, t, phi, z, x)
        return True, q, normal, view_of(w, q, d)
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    if dot(d, (lobe[NORMAL], lobe[NORMAL + 1], lobe[NORMAL + 2])) <= 0.0:
        return False, d, d, d
    shape, inside, distance = nearest(w, int(lobe[SURFACE]), o, d)
    if shape < 0 or (shape == 0 and d[2] > 0.0) or (shape > 0 and not inside and charted[shape - 1]):
        return False, d, d, d
    if shape == 0:
        q, normal = (o[0] + distance * d[0], o[1] + distance * d[1], 0.0), (0.0, 0.0, 1.0)
    else:
        normal = outward_normal(w.spheres, shape - 1, o, d, inside)
        q = on_surface(w.spheres, shape - 1, normal)
        if inside:
            normal = (-normal[0], -normal[1], -normal[2])
    return True, q, normal, view_of(w, q, d)


@kernel
def base_at(w: World, lobe: Array, chart: Array, charted: Array, t: float, phi: float, k: int) -> float:
    """Base of the highlight of point light k at a direction, whatever hides it; -3 where nothing is met."""
    met, q, n, v = shining(w, lobe, chart, charted, t, phi)
    return base_of(w, q, n, v, (w.points[k, 0], w.points[k, 1], w.points[k, 2]))[1] if met else -3.0


@kernel
def place_of(w: World, lobe: Array, chart: Array, t: float, phi: float) -> tuple[bool, Vector]:
    """Where the direction meets what the chart is of (of the lobe's: the floor), whatever hides it."""
    d, z, x = direction(lobe, chart, t, phi)
    if chart[0] != 0.0:
        return True, on_sphere(w, chart, t, phi, z, x)[0]
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    if w.floor[0] == 0.0 or o[2] * d[2] >= 0.0:
        return False, o
    s = -o[2] / d[2]
    return True, (o[0] + s * d[0], o[1] + s * d[1], 0.0)


@kernel
def gap(spheres: Array, i: int, q: Vector, light: Vector) -> float:
    """How far the segment stays off sphere i, in radii; negative where it meets it."""
    f, d = minus(q, center_of(spheres, i)), minus(light, q)
    share = min(1.0, max(0.0, -dot(f, d) / dot(d, d)))
    l = (f[0] + share * d[0], f[1] + share * d[1], f[2] + share * d[2])
    return math.sqrt(dot(l, l)) / spheres[i, 3] - 1.0
