"""What a ray sees: the nearest shape among candidates, and the radiance that comes back from it."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.lobe import COS_MAX, SIN_MAX
from symrender.numeric.planes import faces, nearest_plane, plane_point
from symrender.numeric.random import Key
from symrender.numeric.rays import floor_distance, sphere_offset, sphere_roots
from symrender.numeric.shading import direct_light
from symrender.numeric.textures import floor_albedo, floor_sign, sphere_albedo
from symrender.numeric.vectors import Vector, along, dot, unit
from symrender.numeric.world import World
from symrender.scene.arrays import EYE, FIRST_SPHERE, FLOOR, NOTHING, Array

# candidates[c]: f = origin - centre 0:3, radius 3, power |f|^2 - radius^2 4, sphere index 5, and 6 the square of f.d
# below which a ray certainly misses a sphere it starts outside of
CANDIDATE_COLUMNS: Final = 7
_SLACK = 1e-12


def candidate_room(world: World) -> Array:
    """Room for as many candidates as there are spheres."""
    return np.empty((len(world.spheres), CANDIDATE_COLUMNS))


@inlined
def gather(world: World, candidates: Array, leaves: int, origin: Vector) -> int:
    """List every sphere but the one being left, as seen from ``origin``; returns how many."""
    count = 0
    for j in range(world.spheres.shape[0]):
        if leaves == FIRST_SPHERE + j:
            continue
        sphere, row = world.spheres[j], candidates[count]
        f = (origin[0] - sphere.center[0], origin[1] - sphere.center[1], origin[2] - sphere.center[2])
        square = dot(f, f)
        row[0], row[1], row[2], row[3] = f[0], f[1], f[2], sphere.radius
        row[4] = square - sphere.radius * sphere.radius
        row[5] = j
        row[6] = row[4] - _SLACK * square
        count += 1
    return count


@inlined
def keep_in_lobe(candidates: Array, count: int, n: Vector, m: Vector, lobe: Array) -> int:
    """Drop spheres that no direction of the cone about m above the horizon of n can meet; returns how many stay.

    The bounds are slack by far more than rounding, so what is dropped could only have been missed.
    """
    kept = 0
    for c in range(count):
        row = candidates[c]
        square = row[0] * row[0] + row[1] * row[1] + row[2] * row[2]
        if row[4] > 0.0:
            distance = math.sqrt(square)
            height = -(row[0] * n[0] + row[1] * n[1] + row[2] * n[2])
            if height < -row[3] - _SLACK * (distance + row[3]):
                continue
            sine = row[3] / distance
            cosine = math.sqrt(max(0.0, 1.0 - sine * sine))
            toward = -(row[0] * m[0] + row[1] * m[1] + row[2] * m[2]) / distance
            if toward < lobe[COS_MAX] * cosine - lobe[SIN_MAX] * sine - _SLACK:
                continue
        if kept != c:
            for column in range(CANDIDATE_COLUMNS):
                candidates[kept, column] = row[column]
        kept += 1
    return kept


@inlined
def nearest(candidates: Array, count: int, d: Vector, floor: float) -> tuple[int, float, bool]:
    """Row of the nearest sphere met before distance ``floor`` (-1 for none), its distance, and whether from inside.

    Of equal distances the floor comes first, then the spheres in the order of the scene.
    """
    best, distance, inside = -1, floor, False
    for c in range(count):
        row = candidates[c]
        f = (row[0], row[1], row[2])
        toward = -dot(f, d)
        if row[4] > 0.0 and (toward <= 0.0 or toward * toward < row[6]):
            continue
        near, far = sphere_roots(f, d, row[3], row[4])
        if 0.0 < near < distance:
            best, distance, inside = c, near, False
        elif near <= 0.0 < far and far < distance:
            best, distance, inside = c, far, True
    return best, distance, inside


@inlined
def sphere_point(world: World, row: Array, d: Vector, inside: bool) -> tuple[Vector, Vector]:
    """Point and outward unit normal where the ray d meets the sphere of a candidate row."""
    n = sphere_offset((row[0], row[1], row[2]), d, row[3], inside)
    sphere = world.spheres[int(row[5])]
    return along((sphere.center[0], sphere.center[1], sphere.center[2]), sphere.radius, n), n


@inlined
def sees(
    world: World,
    candidates: Array,
    count: int,
    leaves: int,
    origin: Vector,
    d: Vector,
    eye: Vector,
    key: Key,
    sample: int,
) -> tuple[Vector, int, float]:
    """Radiance that the unit ray d from a surface brings back, the hit class it meets and the distance.

    ``candidates`` are the spheres as seen from ``origin``. A floor or plane seen from behind is black; where nothing is
    met the radiance is the background's and the distance inf. Of equal distances the floor comes first, then spheres,
    then planes in the order of the scene.
    """
    limit = math.inf
    if world.floor.present != 0.0 and leaves != FLOOR:
        limit = floor_distance(origin[2], d[2])
    best, distance, inside = nearest(candidates, count, d, limit)
    wall, first = -1, FIRST_SPHERE + world.spheres.shape[0]
    if world.frames.shape[0] > 0:
        wall, distance = nearest_plane(world.frames, first, leaves, origin, d, distance)
    if wall >= 0:
        own = first + wall
        if not faces(world.frames[wall], d):
            return (0.0, 0.0, 0.0), own, distance
        inside = False
        q, n, x, y = plane_point(world.frames[wall], origin, d, distance)
        albedo = floor_albedo(world.floors[wall], floor_sign(world.floors[wall], x, y))
    elif best < 0:
        if distance == math.inf:
            s = world.shading
            return (s.background[0], s.background[1], s.background[2]), NOTHING, distance
        if d[2] > 0.0:
            return (0.0, 0.0, 0.0), FLOOR, distance
        own = FLOOR
        q = (origin[0] + distance * d[0], origin[1] + distance * d[1], 0.0)
        n = (0.0, 0.0, 1.0)
        albedo = floor_albedo(world.floor, floor_sign(world.floor, q[0], q[1]))
    else:
        own = FIRST_SPHERE + int(candidates[best, 5])
        q, n = sphere_point(world, candidates[best], d, inside)
        albedo = sphere_albedo(world.spheres[own - FIRST_SPHERE], n)
        if inside:
            n = (-n[0], -n[1], -n[2])
    v = (-d[0], -d[1], -d[2])
    to_eye = (eye[0] - q[0], eye[1] - q[1], eye[2] - q[2])
    if world.shading.highlight_view == EYE and dot(to_eye, to_eye) > 0.0:
        v = unit(to_eye)
    return direct_light(world, own, inside, q, n, v, albedo, key, sample, 1), own, distance
