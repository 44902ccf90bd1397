"""Irradiance of uniform radiance from a region of directions, in closed form: arcs of circles bound it.

The region is what a place sees of a light: one cone of directions, the light's, less other cones, those of what hides
it. A cone is convex, the intersection of caps: a sphere is one cap, a plane a hemisphere, a polygon as many
hemispheres as it has corners; a disk is the cone over its rim. Along each arc that bounds a cone it is counted, from
crossing to crossing, which cones it is in; what lies in the light's and in no other bounds the region, and contributes
``arc_flux`` or ``rim_flux``.

Two circles take the places where they cross from one computation, so that one arc ends where the other begins even
where both all but coincide: edges that shapes share, walls on a floor, spheres that touch the horizon. Which side of a
crossing lies in the other cap follows from the order of the two, so of circles that coincide to the last bit one half
is within the other, and the other half without.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from symrender.chambers.caps import Arc, Crossing
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table, table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.vectors import Array, Vector, cross, dot, vector

TURN: Final = 2.0 * math.pi
_SAME: Final = 1e-12
_NOTHING: Final = 1e-30
"""Square of the sine below which two great circles are taken to cross at the first direction of one of them."""


class Room(NamedTuple):
    """Scratch of one place: the arcs of all cones, the crossings of one arc, caps of each cone and those it is in."""

    arcs: Table[Arc]
    crossings: Table[Crossing]
    caps: Array
    within: Array


def make_room(cones: int, arcs: int) -> Room:
    """Room for so many cones and arcs."""
    return Room(table(Arc, arcs), table(Crossing, 2 * arcs), np.zeros(cones), np.zeros(cones))


@jitable
def put_circle(room: Room, count: int, cone: int, axis: Vector, cosine: float, sine: float) -> int:
    """Add the whole circle of a cap to a cone; returns how many arcs there are."""
    arc = room.arcs[count]
    a = (1.0, 0.0, 0.0) if abs(axis[1]) >= 0.9 else (0.0, 1.0, 0.0)
    f = cross(axis, a)
    size = math.sqrt(dot(f, f))
    f = (f[0] / size, f[1] / size, f[2] / size)
    arc.axis[0], arc.axis[1], arc.axis[2] = axis
    arc.first[0], arc.first[1], arc.first[2] = f
    arc.second[0], arc.second[1], arc.second[2] = cross(axis, f)
    arc.cosine, arc.sine, arc.end = cosine, sine, TURN
    arc.cone, arc.linked, arc.rim = 1.0 * cone, 0.0, 0.0
    return count + 1


@jitable
def put_rim(room: Room, count: int, cone: int, middle: Vector, way: Vector, first: Vector, radius: float) -> int:
    """Add the rim of a disk whose plane is met along ``way``, across which ``first`` is unit; returns how many arcs."""
    arc = room.arcs[count]
    second = cross(way, first)
    arc.axis[0], arc.axis[1], arc.axis[2] = way
    arc.middle[0], arc.middle[1], arc.middle[2] = middle
    arc.first[0], arc.first[1], arc.first[2] = radius * first[0], radius * first[1], radius * first[2]
    arc.second[0], arc.second[1], arc.second[2] = radius * second[0], radius * second[1], radius * second[2]
    arc.cosine, arc.sine, arc.end = 0.0, 1.0, TURN
    arc.cone, arc.linked, arc.rim = 1.0 * cone, 0.0, 1.0
    return count + 1


@jitable
def put_edge(room: Room, count: int, cone: int, start: Vector, edge: Vector) -> int:
    """Add the arc in which an edge of a polygon is seen, its inside on the left; returns how many arcs there are."""
    arc = room.arcs[count]
    ax, ay, az, fx, fy, fz, sx, sy, sz = leaves.edge_circle(*start, *edge)
    stop = (start[0] + edge[0], start[1] + edge[1], start[2] + edge[2])
    arc.axis[0], arc.axis[1], arc.axis[2] = ax, ay, az
    arc.first[0], arc.first[1], arc.first[2] = fx, fy, fz
    arc.second[0], arc.second[1], arc.second[2] = sx, sy, sz
    arc.cosine, arc.sine = 0.0, 1.0
    arc.end = leaves.angle_on(*stop, fx, fy, fz, sx, sy, sz)
    arc.cone, arc.linked, arc.rim = 1.0 * cone, 1.0, 0.0
    return count + 1


@inlined
def level_about(c: Arc, o: Arc) -> tuple[float, float, float]:
    """(A, B, C): along circle c, at angle t, A + B cos t + C sin t is positive inside the cap of o."""
    return leaves.cap_level(
        *vector(c.axis), *vector(c.first), *vector(c.second), c.cosine, c.sine, *vector(o.axis), o.cosine
    )


@jitable
def great_crossing(c: Arc, o: Arc, first: bool) -> float:
    """Angle along great circle c at which it enters the cap of great circle o; c is the ``first`` of both in order."""
    a, b = vector(c.axis), vector(o.axis)
    if not first:
        a, b = b, a
    x = cross(a, b)
    out = dot(x, a)
    x = (x[0] - out * a[0], x[1] - out * a[1], x[2] - out * a[2])
    if dot(x, x) < _NOTHING:
        x = vector(c.first) if first else vector(o.first)
    at = leaves.angle_on(*x, *vector(c.first), *vector(c.second))
    return at - math.pi if first else at


@jitable
def rim_stretch(rim: Arc, o: Arc) -> tuple[float, float]:
    """(begin, span) of the stretch of a disk's rim in the cap of a great circle."""
    a = vector(o.axis)
    middle, across, along = dot(a, vector(rim.middle)), dot(a, vector(rim.first)), dot(a, vector(rim.second))
    cut = across * across + along * along - middle * middle
    if cut <= 0.0:
        return 0.0, (TURN if middle > 0.0 else 0.0)
    half = math.atan2(math.sqrt(cut), -middle)
    return math.atan2(along, across) - half, 2.0 * half


@jitable
def angle_of(rim: Arc, at: float, c: Arc) -> float:
    """Angle along a great circle of the place at angle ``at`` of a disk's rim."""
    place = leaves.disk_point(*vector(rim.middle), *vector(rim.first), *vector(rim.second), math.cos(at), math.sin(at))
    return leaves.angle_on(*place, *vector(c.first), *vector(c.second))


@jitable
def stretch_in_disk(c: Arc, rim: Arc) -> tuple[float, float]:
    """(begin, span) of the stretch of great circle c in a disk: it enters where the rim leaves the cap of c."""
    enters, inside = rim_stretch(rim, c)
    if inside == 0.0 or inside == TURN:
        return 0.0, 0.0
    begin = angle_of(rim, enters + inside, c)
    span = angle_of(rim, enters, c) - begin
    if span < 0.0:
        span = span + TURN
    if span > math.pi:
        # the circle all but touches the rim
        return 0.0, 0.0
    return begin, span


@jitable
def coincide(c: Arc, o: Arc) -> bool:
    """Whether two circles are the same but for roundings."""
    apart = abs(c.cosine - o.cosine)
    for q in range(3):
        apart = max(apart, abs(c.axis[q] - o.axis[q]))
    return apart < _SAME


@jitable
def stretch(c: Arc, o: Arc, first: bool) -> tuple[float, float]:
    """(begin, span) of the stretch of circle c in the cap of o; the span is 0 where there is none, a turn where all is.

    Where the circles cross is a root of one discriminant, B^2 + C^2 - A^2 of the smaller, the same for both.
    """
    if c.rim != 0.0:
        return rim_stretch(c, o)
    if o.rim != 0.0:
        return stretch_in_disk(c, o)
    if c.cosine == 0.0 and o.cosine == 0.0:
        return great_crossing(c, o, first), math.pi
    middle, across, along = level_about(c, o)
    cut = across * across + along * along - middle * middle
    if o.sine < c.sine or (o.sine == c.sine and not first):
        m, f, s = level_about(o, c)
        cut = f * f + s * s - m * m
    if coincide(c, o):
        return 0.0, (0.0 if first else TURN)
    if cut <= 0.0:
        return 0.0, (TURN if middle > 0.0 else 0.0)
    half = math.atan2(math.sqrt(cut), -middle)
    return math.atan2(along, across) - half, 2.0 * half


@jitable
def put_crossing(room: Room, count: int, angle: float, step: float, cone: float) -> int:
    """Add a crossing to those of an arc, sorted by angle; returns how many there are."""
    i = count
    while i > 0 and room.crossings[i - 1].angle > angle:
        room.crossings[i].angle = room.crossings[i - 1].angle
        room.crossings[i].step = room.crossings[i - 1].step
        room.crossings[i].cone = room.crossings[i - 1].cone
        i -= 1
    room.crossings[i].angle, room.crossings[i].step, room.crossings[i].cone = angle, step, cone
    return count + 1


@jitable
def gather_crossings(room: Room, count: int, i: int) -> int:
    """List where arc i crosses the caps of other arcs, and the caps each cone has and those the arc begins in."""
    arc = room.arcs[i]
    found = 0
    for k in range(count):
        other = room.arcs[k]
        if k == i or (other.cone == arc.cone and other.linked != 0.0 and arc.linked != 0.0):
            continue
        cone = int(other.cone)
        room.caps[cone] += 1.0
        begin, span = stretch(arc, other, i < k)
        if span == 0.0:
            continue
        if span == TURN:
            room.within[cone] += 1.0
            continue
        if begin < 0.0:
            begin = begin + TURN
        leave = begin + span
        if leave >= TURN:
            room.within[cone] += 1.0
            leave = leave - TURN
        if begin < arc.end:
            found = put_crossing(room, found, begin, 1.0, other.cone)
        if leave < arc.end:
            found = put_crossing(room, found, leave, -1.0, other.cone)
    return found


@jitable
def add_arc(arc: Arc, begin: float, end: float, sign: float, flux: Vector) -> Vector:
    """``flux`` and that of a stretch of an arc, of the sign given."""
    if arc.rim != 0.0:
        x, y, z = leaves.rim_flux(*vector(arc.middle), *vector(arc.first), *vector(arc.second), begin, end)
    else:
        x, y, z = leaves.arc_flux(
            *vector(arc.axis), *vector(arc.first), *vector(arc.second), arc.cosine, arc.sine, begin, end
        )
    return (flux[0] + sign * x, flux[1] + sign * y, flux[2] + sign * z)


@jitable
def wrong_cones(room: Room, cones: int, own: int) -> int:
    """How many cones are in the way of an arc of cone ``own``: in others it must not be, in its own and the light's."""
    wrong = 0
    for c in range(cones):
        inside = room.within[c] == room.caps[c]
        if inside != (c == own or c == 0):
            wrong += 1
    return wrong


@jitable
def open_irradiance(room: Room, count: int, cones: int, normal: Vector) -> float:
    """Irradiance by radiance 1 from cone 0 less all others, bounded by ``count`` arcs; 0 of a negative count."""
    if count < 0:
        return 0.0
    flux = (0.0, 0.0, 0.0)
    for i in range(count):
        arc = room.arcs[i]
        own = int(arc.cone)
        for c in range(cones):
            room.caps[c], room.within[c] = 0.0, 0.0
        found = gather_crossings(room, count, i)
        wrong = wrong_cones(room, cones, own)
        sign = 1.0 if own == 0 else -1.0
        begin = 0.0
        for k in range(found):
            crossing = room.crossings[k]
            if wrong == 0 and crossing.angle > begin:
                flux = add_arc(arc, begin, crossing.angle, sign, flux)
            begin = crossing.angle
            c = int(crossing.cone)
            before = room.within[c] == room.caps[c]
            room.within[c] += crossing.step
            after = room.within[c] == room.caps[c]
            if before != after:
                wrong += 1 if after != (c == own or c == 0) else -1
        if wrong == 0 and arc.end > begin:
            flux = add_arc(arc, begin, arc.end, sign, flux)
    return max(0.0, 0.5 * dot(normal, flux))
