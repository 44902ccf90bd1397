"""Irradiance of a constant sky, or of a sphere that emits, in closed form: arcs of circles bound what a place sees.

What hides the sky are caps of the sphere of directions: the horizon, a hemisphere for every other plane, a cone for
every other sphere. Of a sphere that emits only its own cone is seen, so that all but that cone is one cap more, and
only shapes before it hide it. Along the circle of each cap the arcs outside all others bound what is seen, and an arc
contributes ``arc_flux``.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.sight import dot, minus, vector
from symrender.radiometric.world import Array, Vector, World
from symrender.scene.radiometric.arrays import SPHERE

CAP: Final = 11
"""Numbers of a cap: axis 0:3, first and second direction across it 3:6 and 6:9, cosine 9 and sine 10 of its angle."""
_SAME: Final = 1e-12
_TURN: Final = 2.0 * math.pi


def sky_room(world: World) -> tuple[Array, Array]:
    """Room for the caps of a place and for the arcs of one of them that others hide."""
    count = len(world.shapes) + 1
    return np.empty((count, CAP)), np.empty((2 * count, 2))


@jitable
def put_cap(caps: Array, count: int, axis: Vector, cosine: float, sine: float) -> int:
    """Add a cap unless it is there; returns how many there are, -1 where it and another hide everything."""
    for i in range(count):
        near, far = 0.0, 0.0
        for q in range(3):
            near = max(near, abs(caps[i, q] - axis[q]))
            far = max(far, abs(caps[i, q] + axis[q]))
        if near < _SAME and abs(caps[i, 9] - cosine) < _SAME:
            return count
        if far < _SAME and abs(caps[i, 9] + cosine) < _SAME:
            return -1
    row = caps[count]
    a = (1.0, 0.0, 0.0) if abs(axis[1]) >= 0.9 else (0.0, 1.0, 0.0)
    f = (axis[1] * a[2] - axis[2] * a[1], axis[2] * a[0] - axis[0] * a[2], axis[0] * a[1] - axis[1] * a[0])
    size = math.sqrt(dot(f, f))
    f = (f[0] / size, f[1] / size, f[2] / size)
    row[0], row[1], row[2] = axis
    row[3], row[4], row[5] = f
    row[6] = axis[1] * f[2] - axis[2] * f[1]
    row[7] = axis[2] * f[0] - axis[0] * f[2]
    row[8] = axis[0] * f[1] - axis[1] * f[0]
    row[9], row[10] = cosine, sine
    return count + 1


@jitable
def gather_caps(world: World, own: int, place: Vector, normal: Vector, caps: Array) -> int:
    """List what hides the sky from a place of shape ``own``; returns how many caps, -1 where all of it is hidden."""
    count = put_cap(caps, 0, (-normal[0], -normal[1], -normal[2]), 0.0, 1.0)
    for j in range(world.shapes.shape[0]):
        if j == own:
            continue
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            offset = minus(vector(shape.place), place)
            if leaves.sphere_power(*offset, shape.radius) <= 0.0:
                return -1
            x, y, z, cosine, sine = leaves.sphere_cap(*offset, shape.radius)
            count = put_cap(caps, count, (x, y, z), cosine, sine)
        else:
            frame = world.frames[j]
            up = vector(frame.up)
            side = -1.0 if leaves.height(*place, *vector(frame.origin), *up) >= 0.0 else 1.0
            count = put_cap(caps, count, (side * up[0], side * up[1], side * up[2]), 0.0, 1.0)
        if count < 0:
            return -1
    return count


@jitable
def hide(arcs: Array, count: int, begin: float, end: float) -> int:
    """Add an arc of [0, 2 pi] to those that are hidden, sorted by where they begin; returns how many there are."""
    i = count
    while i > 0 and arcs[i - 1, 0] > begin:
        arcs[i, 0], arcs[i, 1] = arcs[i - 1, 0], arcs[i - 1, 1]
        i -= 1
    arcs[i, 0], arcs[i, 1] = begin, end
    return count + 1


@inlined
def level_about(c: Array, o: Array) -> tuple[float, float, float]:
    """(A, B, C): along circle c, at angle t, A + B cos t + C sin t is positive inside cap o."""
    return leaves.cap_level(
        c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9], c[10], o[0], o[1], o[2], o[9]
    )  # fmt: skip


@jitable
def hidden_arcs(caps: Array, count: int, own: int, arcs: Array) -> int:
    """List the arcs of circle ``own`` that lie in other caps; returns how many, -1 where all of it does.

    Where two circles cross is a root of one discriminant, B^2 + C^2 - A^2 of the smaller: both circles take the same,
    so that an arc ends where the other's begins even where they all but touch, as a ball on a floor does the horizon.
    """
    found = 0
    c = caps[own]
    for j in range(count):
        if j == own:
            continue
        o = caps[j]
        middle, first, second = level_about(c, o)
        cut = first * first + second * second - middle * middle
        if o[10] < c[10] or (o[10] == c[10] and j < own):
            m, f, s = level_about(o, c)
            cut = f * f + s * s - m * m
        if cut <= 0.0:
            if middle > 0.0:
                return -1
            continue
        half = math.atan2(math.sqrt(cut), -middle)
        at = math.atan2(second, first)
        begin, end = at - half, at + half
        if begin < 0.0:
            begin, end = begin + _TURN, end + _TURN
        if end > _TURN:
            found = hide(arcs, found, 0.0, min(end - _TURN, _TURN))
            end = _TURN
        found = hide(arcs, found, min(begin, _TURN), end)
    return found


@inlined
def add_arc(cap: Array, begin: float, end: float, flux: Vector) -> Vector:
    """``flux`` and that of an arc."""
    x, y, z = leaves.arc_flux(
        cap[0], cap[1], cap[2], cap[3], cap[4], cap[5], cap[6], cap[7], cap[8], cap[9], cap[10], begin, end
    )
    return (flux[0] + x, flux[1] + y, flux[2] + z)


@jitable
def gather_light(
    world: World, own: int, front: bool, emitter: int, place: Vector, normal: Vector, caps: Array
) -> int:  # fmt: skip
    """List all that is not sphere ``emitter`` as a place sees it, as ``gather_caps`` lists what is not sky.

    The sphere crosses no other shape. Of two spheres apart from each other the one of less power is before the other,
    for what lies between them is the plane of equal powers.
    """
    lamp = world.shapes[emitter]
    offset = minus(vector(lamp.place), place)
    whole = leaves.sphere_power(*offset, lamp.radius)
    if whole <= 0.0 or own == emitter:
        return -1
    x, y, z, cosine, sine = leaves.sphere_cap(*offset, lamp.radius)
    count = put_cap(caps, 0, (-normal[0], -normal[1], -normal[2]), 0.0, 1.0)
    count = put_cap(caps, count, (-x, -y, -z), -cosine, sine)
    for j in range(world.shapes.shape[0]):
        if count < 0 or j == emitter:
            continue
        shape = world.shapes[j]
        if shape.kind == SPHERE:
            way = minus(vector(shape.place), place)
            power = leaves.sphere_power(*way, shape.radius)
            encloses = leaves.sphere_power(*minus(vector(shape.place), vector(lamp.place)), shape.radius) < 0.0
            inside = not front if j == own else power < 0.0
            if encloses != inside:
                return -1
            if j != own and not encloses and power < whole:
                x, y, z, cosine, sine = leaves.sphere_cap(*way, shape.radius)
                count = put_cap(caps, count, (x, y, z), cosine, sine)
        elif j != own:
            frame = world.frames[j]
            up = vector(frame.up)
            here = leaves.height(*place, *vector(frame.origin), *up)
            if here * leaves.height(*vector(lamp.place), *vector(frame.origin), *up) < 0.0:
                return -1
    return count


@jitable
def sky_irradiance(world: World, own: int, place: Vector, normal: Vector, caps: Array, arcs: Array) -> float:
    """Irradiance of a place by a sky of radiance 1, pi where nothing hides it."""
    return open_irradiance(caps, gather_caps(world, own, place, normal, caps), normal, arcs)


@jitable
def area_irradiance(
    world: World, own: int, front: bool, emitter: int, place: Vector, normal: Vector, caps: Array, arcs: Array
) -> float:  # fmt: skip
    """Irradiance of a place by sphere ``emitter``, of radiance 1."""
    return open_irradiance(caps, gather_light(world, own, front, emitter, place, normal, caps), normal, arcs)


@jitable
def open_irradiance(caps: Array, count: int, normal: Vector, arcs: Array) -> float:
    """Irradiance by radiance 1 from outside the first ``count`` caps, one the horizon; 0 of a negative count."""
    if count < 0:
        return 0.0
    flux = (0.0, 0.0, 0.0)
    for i in range(count):
        found = hidden_arcs(caps, count, i, arcs)
        if found < 0:
            continue
        open_from = 0.0
        for a in range(found):
            if arcs[a, 0] > open_from:
                flux = add_arc(caps[i], open_from, arcs[a, 0], flux)
            open_from = max(open_from, arcs[a, 1])
        if open_from < _TURN:
            flux = add_arc(caps[i], open_from, _TURN, flux)
    # caps are what is not seen, so their contours are run through backwards
    return max(0.0, -0.5 * dot(normal, flux))
