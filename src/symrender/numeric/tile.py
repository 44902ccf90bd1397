"""The two kernels: one fills a tile of pixels, one answers for single rays."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined, jitable
from symrender.numeric.antialias import pixel_sign
from symrender.numeric.estimators import gloss
from symrender.numeric.filters import CENTRE, tap
from symrender.numeric.lobe import WEIGHT
from symrender.numeric.planes import faces, nearest_plane, plane_point
from symrender.numeric.random import Key, pixel_key, uniforms
from symrender.numeric.rays import primary_ray
from symrender.numeric.samplers import INDEPENDENT
from symrender.numeric.shading import direct_light
from symrender.numeric.sight import gather, nearest, sees, sphere_point
from symrender.numeric.textures import floor_albedo, floor_sign, sphere_albedo
from symrender.numeric.vectors import Vector
from symrender.numeric.world import World
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, NOTHING, Array

_PRIMARY_STRATA = 2
_PLACE = (1 << 30) + 1
"""Dimension of a ray's place in the pixel."""
_ABOVE = np.uint64(8)
"""Bits of a seed's upper word below the number of a ray."""


@inlined
def pixel(
    world: World,
    frame: Array,
    width: int,
    height: int,
    a: float,
    b: float,
    key: Key,
    sampler: int,
    order: int,
    normalised: bool,
    analytic: bool,
    cameras: Array,
    from_eye: Array,
    count: int,
    from_point: Array,
) -> tuple[int, Vector, Vector, float, int]:
    """Hit class, direct light, gloss, lobe weight and lobe evaluations of the ray through (a, b) of the window.

    ``cameras`` are those of ``plane_cameras``; ``from_eye`` holds the ``count`` spheres as seen from the eye,
    ``from_point`` is room for as many. Arguments are many because a kernel takes numbers and arrays, and this is one
    pixel of one.
    """
    eye = (frame[1], frame[2], frame[3])
    d, distance, p = primary_ray(frame, a, b)
    best, distance, inside = nearest(from_eye, count, d, distance if world.floor.present != 0.0 else math.inf)
    wall, first = -1, FIRST_SPHERE + world.spheres.shape[0]
    if world.frames.shape[0] > 0:
        wall, distance = nearest_plane(world.frames, first, NOTHING, eye, d, distance)
    if wall >= 0:
        own = first + wall
        if not faces(world.frames[wall], d):
            return own, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0
        inside = False
        p, n, x, y = plane_point(world.frames[wall], eye, d, distance)
        if analytic:
            sign = pixel_sign(world.floors[wall], cameras[wall], a, b, 1.0 / width, 1.0 / height, x, y)
        else:
            sign = floor_sign(world.floors[wall], x, y)
        albedo = floor_albedo(world.floors[wall], sign)
    elif best >= 0:
        own = FIRST_SPHERE + int(from_eye[best, 5])
        p, n = sphere_point(world, from_eye[best], d, inside)
        albedo = sphere_albedo(world.spheres[own - FIRST_SPHERE], n)
        if inside:
            n = (-n[0], -n[1], -n[2])
    elif distance < math.inf:
        own = FLOOR
        if eye[2] < 0.0:
            return own, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0
        n = (0.0, 0.0, 1.0)
        if analytic:
            sign = pixel_sign(world.floor, frame, a, b, 1.0 / width, 1.0 / height, p[0], p[1])
        else:
            sign = floor_sign(world.floor, p[0], p[1])
        albedo = floor_albedo(world.floor, sign)
    else:
        s = world.shading
        return NOTHING, (s.background[0], s.background[1], s.background[2]), (0.0, 0.0, 0.0), 0.0, 0
    v = (-d[0], -d[1], -d[2])
    direct = direct_light(world, own, inside, p, n, v, albedo, key, 0, _PRIMARY_STRATA)
    weight = world.lobes[own - FLOOR, WEIGHT]
    if weight == 0.0:
        return own, direct, (0.0, 0.0, 0.0), 0.0, 0
    reflected, evaluations = gloss(world, from_point, own, p, n, d, eye, sampler, order, normalised, key)
    return own, direct, reflected, weight, evaluations


@jitable
def mean_pixel(
    world: World,
    frame: Array,
    width: int,
    height: int,
    i: int,
    j: int,
    key: Key,
    sampler: int,
    order: int,
    normalised: bool,
    cameras: Array,
    from_eye: Array,
    count: int,
    from_point: Array,
    filter: int,
    reach: float,
) -> tuple[Vector, Vector, int]:
    """(direct light, gloss by its weight, lobe evaluations) of a pixel: the mean of order x order rays and their lobes.

    Rays pass places of the filter's support in strata, and each draws its own lobe. Arguments are many because a
    kernel takes numbers and arrays.
    """
    direct, glossy, evaluations = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0
    places = order * order
    for index in range(places):
        p, q = uniforms(key, index, _PLACE)
        if sampler != INDEPENDENT:
            p, q = (index // order + p) / order, (index % order + q) / order
        x, heavy = tap(filter, reach, p)
        y, other = tap(filter, reach, q)
        a, b = 2.0 * (i + 0.5 + x) / width - 1.0, 1.0 - 2.0 * (j + 0.5 + y) / height
        # every ray is a pixel of its own to the samplers of lobes
        mine = (key[0], key[1], key[2], key[3] ^ (np.uint64(index + 1) << _ABOVE))
        _, light, reflected, weight, spent = pixel(
            *(world, frame, width, height, a, b, mine, sampler, order, normalised, False),
            *(cameras, from_eye, count, from_point),
        )
        evaluations += spent
        share = heavy * other / places
        bright = share * weight
        direct = (direct[0] + share * light[0], direct[1] + share * light[1], direct[2] + share * light[2])
        glossy = (
            glossy[0] + bright * reflected[0],
            glossy[1] + bright * reflected[1],
            glossy[2] + bright * reflected[2],
        )
    return direct, glossy, evaluations


def render_tile(
    world: World,
    frame: Array,
    width: int,
    height: int,
    x0: int,
    y0: int,
    x1: int,
    y1: int,
    sampler: int,
    order: int,
    normalised: bool,
    analytic: bool,
    seed: int,
    filter: int,
    reach: float,
    cameras: Array,
    from_eye: Array,
    from_point: Array,
    radiance: Array,
    direct: Array,
    glossy: Array,
    hit_class: Array,
) -> int:
    """Fill columns x0:x1 of rows y0:y1 of the full-frame layers; returns the lobe evaluations.

    ``cameras`` are those of ``plane_cameras``; ``from_eye`` and ``from_point`` are room for the candidates,
    (n, CANDIDATE_COLUMNS) each. With a ``filter`` a pixel is a mean, its hit class that of its centre, and gloss is
    weighed by the lobes already. Arguments are many because a kernel takes numbers and arrays.
    """
    count = gather(world, from_eye, NOTHING, (frame[1], frame[2], frame[3]))
    evaluations = 0
    for j in range(y0, y1):
        for i in range(x0, x1):
            key = pixel_key(seed, i, j)
            a, b = 2.0 * (i + 0.5) / width - 1.0, 1.0 - 2.0 * (j + 0.5) / height
            own, light, reflected, weight, spent = pixel(
                *(world, frame, width, height, a, b, key, sampler, order if filter == CENTRE else 1, normalised),
                *(analytic, cameras, from_eye, count, from_point),
            )
            if filter != CENTRE:
                light, reflected, spent = mean_pixel(
                    *(world, frame, width, height, i, j, key, sampler, order, normalised),
                    *(cameras, from_eye, count, from_point, filter, reach),
                )
                weight = 1.0
            evaluations += spent
            hit_class[j, i] = own
            for c in range(3):
                direct[j, i, c] = light[c]
                glossy[j, i, c] = reflected[c]
                radiance[j, i, c] = light[c] + weight * reflected[c]
    return evaluations


def trace_rays(
    world: World,
    eye: Array,
    origins: Array,
    directions: Array,
    leaves: npt.NDArray[np.int64],
    candidates: Array,
    radiance: Array,
    hit_class: Array,
    distance: Array,
) -> None:
    """What each ray from a surface sees, one row of the arrays a ray; ``candidates`` is room for the spheres."""
    key = pixel_key(0, 0, 0)
    at = (eye[0], eye[1], eye[2])
    for r in range(origins.shape[0]):
        origin = (origins[r, 0], origins[r, 1], origins[r, 2])
        d = (directions[r, 0], directions[r, 1], directions[r, 2])
        count = gather(world, candidates, leaves[r], origin)
        light, own, t = sees(world, candidates, count, leaves[r], origin, d, at, key, r)
        hit_class[r] = own
        distance[r] = t
        for c in range(3):
            radiance[r, c] = light[c]
