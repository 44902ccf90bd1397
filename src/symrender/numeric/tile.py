"""The two kernels: one fills a tile of pixels, one answers for single rays."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined
from symrender.numeric.antialias import pixel_sign
from symrender.numeric.estimators import gloss
from symrender.numeric.lobe import WEIGHT
from symrender.numeric.planes import faces, nearest_plane, plane_point
from symrender.numeric.random import pixel_key
from symrender.numeric.rays import primary_ray
from symrender.numeric.shading import direct_light
from symrender.numeric.sight import gather, nearest, sees, sphere_point
from symrender.numeric.textures import floor_albedo, floor_sign, sphere_albedo
from symrender.numeric.vectors import Vector
from symrender.numeric.world import World
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, NOTHING, Array

_PRIMARY_STRATA = 2


@inlined
def pixel(
    world: World,
    frame: Array,
    width: int,
    height: int,
    i: int,
    j: int,
    sampler: int,
    order: int,
    normalised: bool,
    analytic: bool,
    seed: int,
    cameras: Array,
    from_eye: Array,
    count: int,
    from_point: Array,
) -> tuple[int, Vector, Vector, float, int]:
    """Hit class, direct light, gloss, lobe weight and lobe evaluations of the pixel in column i of row j.

    ``cameras`` are those of ``plane_cameras``; ``from_eye`` holds the ``count`` spheres as seen from the eye,
    ``from_point`` is room for as many. Arguments are many because a kernel takes numbers and arrays, and this is one
    pixel of one.
    """
    key = pixel_key(seed, i, j)
    eye = (frame[1], frame[2], frame[3])
    a = 2.0 * (i + 0.5) / width - 1.0
    b = 1.0 - 2.0 * (j + 0.5) / height
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
    (n, CANDIDATE_COLUMNS) each. Arguments are many because a kernel takes numbers and arrays.
    """
    count = gather(world, from_eye, NOTHING, (frame[1], frame[2], frame[3]))
    evaluations = 0
    for j in range(y0, y1):
        for i in range(x0, x1):
            own, light, reflected, weight, spent = pixel(
                *(world, frame, width, height, i, j, sampler, order, normalised, analytic, seed),
                *(cameras, from_eye, count, from_point),
            )
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
