"""Circles on the sphere of directions, in arcs: the caps that bound cones, and where one of them crosses another.

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
from symrender.jit import moving
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table, table
from symrender.leaves import radiometric as leaves
from symrender.limits import MAX_TERMS
from symrender.radiometric.vectors import Array, Vector, cross, dot, vector

TURN: Final = 2.0 * math.pi
TURN_REST: Final = 2.4492935982947064e-16
"""2 pi less the double nearest to it."""
_SAME: Final = 1e-12
"""By how much circles differ that are the same but for roundings; of circles narrower than ``_THIN`` a part of it."""
_THIN: Final = 1e-3
_ROUNDED: Final = 4e-16
"""By how much the components of a unit vector are rounded."""
_NARROW: Final = 0.5
"""Cosine of the angle within which a cap is narrow."""
TOUCHING: Final = 1e-13
"""Circles whose discriminant is less touch but for roundings: how far they cross has no slope."""


class Room(NamedTuple):
    """Scratch of one place.

    Cone 0 is the light's, cone 1 + j that of piece j. ``side`` says of a listed piece whether its normal shows to the
    place (1 or -1), of others it is 0; the pieces with one are in ``listed``. ``arcs`` are those of all cones, ``used``
    of them so far, those of a cone one after another from its ``begin`` to its ``stop``; a listed polygon all of whose
    edges are inner ones has none before an arc comes near it. ``crossings`` are those of one arc, ``caps`` how many
    caps each cone has and ``within`` how many of them the arc is in; they hold for the cones in ``touched``. ``nodes``
    says of the bounds whether they hold a listed piece, or are ``WHOLE``, and last whether one is. ``heights`` holds
    those of a bump and their gradients, a row a term.
    """

    arcs: Table[Arc]
    crossings: Table[Crossing]
    begin: Array
    stop: Array
    side: Array
    listed: Array
    used: Array
    caps: Array
    within: Array
    touched: Array
    nodes: Array
    heights: Array


def make_room(cones: int, arcs: int, nodes: int) -> Room:
    """Room for so many cones, arcs and bounds."""
    shapes: list[int | tuple[int, int]] = [*[cones] * 8, nodes + 1, (MAX_TERMS, 4)]
    return Room(table(Arc, arcs), table(Crossing, 4 * arcs), *map(np.zeros, shapes))


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
    arc.inner, arc.beside, arc.edge = 0.0, -1.0, -1.0
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
    arc.inner, arc.beside, arc.edge = 0.0, -1.0, -1.0
    return count + 1


@jitable
def put_edge(room: Room, count: int, cone: int, start: Vector, edge: Vector, inner: bool) -> int:
    """Add the arc in which an edge of a polygon is seen, its inside on the left; returns how many arcs there are.

    Of an ``inner`` one, which bounds nothing, only the cap is had.
    """
    arc = room.arcs[count]
    ax, ay, az, fx, fy, fz, sx, sy, sz = leaves.edge_circle(*start, *edge)
    arc.axis[0], arc.axis[1], arc.axis[2] = ax, ay, az
    arc.cosine, arc.sine, arc.end = 0.0, 1.0, 0.0
    arc.cone, arc.linked, arc.rim = 1.0 * cone, 1.0, 0.0
    arc.inner, arc.beside, arc.edge = 0.0, -1.0, -1.0
    if inner:
        arc.inner = 1.0
        return count + 1
    stop = (start[0] + edge[0], start[1] + edge[1], start[2] + edge[2])
    arc.first[0], arc.first[1], arc.first[2] = fx, fy, fz
    arc.second[0], arc.second[1], arc.second[2] = sx, sy, sz
    arc.end = leaves.angle_on(*stop, fx, fy, fz, sx, sy, sz)
    return count + 1


@jitable
def level_about(c: Arc, o: Arc) -> tuple[float, float, float]:
    """(A, B, C): along circle c, at angle t, A + B cos t + C sin t is positive inside the cap of o.

    Of narrow caps near each other they come from differences of axes and of sines: those of cosines lose all digits.
    """
    a, b = vector(c.axis), vector(o.axis)
    apart = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    square = dot(apart, apart)
    if min(c.cosine, o.cosine) > _NARROW and square < 1.0 - _NARROW:
        gap = (o.sine - c.sine) * (o.sine + c.sine) / (c.cosine + o.cosine)
        along, across = dot(vector(c.first), apart), dot(vector(c.second), apart)
        return gap - 0.5 * c.cosine * square, c.sine * along, c.sine * across
    return leaves.cap_level(
        *vector(c.axis), *vector(c.first), *vector(c.second), c.cosine, c.sine, *vector(o.axis), o.cosine
    )


@jitable
def pivot(a: Vector) -> Vector:
    """A direction across a unit vector, the same for its opposite."""
    x, y, z = abs(a[0]), abs(a[1]), abs(a[2])
    largest = a[0] if x >= y and x >= z else (a[1] if y >= z else a[2])
    sign = 1.0 if largest > 0.0 else -1.0
    beside = (0.0, 0.0, sign) if z <= min(x, y) else ((0.0, sign, 0.0) if y <= x else (sign, 0.0, 0.0))
    return cross(a, beside)


@jitable
def between(a: Vector, b: Vector) -> Vector:
    """Where two great circles with these axes cross: a x b, however little they differ, to a part of itself.

    Any number of circles that all but coincide so have crossings of one picture. Circles that are the same are taken
    to be turned about ``pivot``, each by a little more than those before it.
    """
    if dot(a, b) > 0.0:
        # a difference of near numbers is exact
        x = cross((a[0] - b[0], a[1] - b[1], a[2] - b[2]), b)
        if x[0] == 0.0 and x[1] == 0.0 and x[2] == 0.0:
            x = pivot(a)
    else:
        x = cross((a[0] + b[0], a[1] + b[1], a[2] + b[2]), b)
        if x[0] == 0.0 and x[1] == 0.0 and x[2] == 0.0:
            u = pivot(a)
            x = (-u[0], -u[1], -u[2])
    return x


@jitable
def great_crossing(c: Arc, o: Arc, first: bool) -> float:
    """Angle along great circle c at which it enters the cap of great circle o; c is the ``first`` of both in order."""
    x = between(vector(c.axis), vector(o.axis)) if first else between(vector(o.axis), vector(c.axis))
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
    apart = max(abs(c.cosine - o.cosine), abs(c.sine - o.sine))
    for q in range(3):
        apart = max(apart, abs(c.axis[q] - o.axis[q]))
    return apart < max(_SAME * min(1.0, c.sine / _THIN), _ROUNDED)


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
    root = math.sqrt(cut)
    if cut < TOUCHING * min(1.0, across * across + along * along):
        # what is seen grows with the power 3/2 beyond a touch, and the ends of both arcs move alike
        root = moving.held(root)
    half = math.atan2(root, -middle)
    return math.atan2(along, across) - half, 2.0 * half


@jitable
def put_crossing(room: Room, count: int, angle: float, rest: float, step: float, cone: float) -> int:
    """Add a crossing to those of an arc, sorted by angle; returns how many there are."""
    i = count
    while i > 0 and room.crossings[i - 1].angle > angle:
        room.crossings[i].angle = room.crossings[i - 1].angle
        room.crossings[i].rest = room.crossings[i - 1].rest
        room.crossings[i].step = room.crossings[i - 1].step
        room.crossings[i].cone = room.crossings[i - 1].cone
        i -= 1
    room.crossings[i].angle, room.crossings[i].rest = angle, rest
    room.crossings[i].step, room.crossings[i].cone = step, cone
    return count + 1


@inlined
def rest_of_sum(a: float, b: float) -> float:
    """a + b less the double that it is rounded to (Knuth)."""
    whole = a + b
    part = whole - a
    return (a - (whole - part)) + (b - part)
