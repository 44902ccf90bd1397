"""Irradiance of uniform radiance from a region of directions, in closed form: arcs of circles bound it.

The region is what a place sees of a light: one cone of directions, the light's, less other cones, those of what hides
it. A cone is convex, the intersection of caps: a sphere is one cap, a plane a hemisphere, a polygon as many
hemispheres as it has corners; a disk is the cone over its rim. Along each arc that bounds a cone it is counted, from
crossing to crossing, which cones it is in; what lies in the light's and in no other bounds the region, and contributes
``arc_flux`` or ``rim_flux``.

An arc asks the hierarchy of bounds for the pieces near it. Edges between faces that show the same side bound nothing;
of a mesh what remains is its outline, about as many edges as the root of its faces, and most of the faces are in no arc
near it.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.chambers.caps import Arc
from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import TURN, TURN_REST, Room, put_crossing, rest_of_sum, stretch
from symrender.radiometric.bounds import WHOLE, held_by, inside_of, next_beside, take_whole
from symrender.radiometric.cones import put_polygon
from symrender.radiometric.conics import cross_conic, is_conic
from symrender.radiometric.pieces import Piece, corner, same
from symrender.radiometric.vectors import Vector, cross, dot, minus, vector
from symrender.radiometric.world import World

_CLEAR: Final = 1e-9
"""Sine beyond which a direction is outside of a hemisphere, whatever was rounded."""
_STEEP: Final = 0.9
"""Cosine to the normal beyond which a lamp is taken to be overhead."""
_NARROW: Final = 0.5
"""Cosine to the direction that fluxes are taken about, up to which a circle's axis is near it."""
_NOWHERE: Final = 0
_NEAR: Final = 1
_LEVEL: Final = 2


class About(NamedTuple):
    """The ``normal`` that light arrives at, and a direction ``near`` the light about which fluxes are taken.

    It is the axis of the light's cone (``_NEAR``), or the direction in the plane across the normal that is nearest to
    it (``_LEVEL``), and ``beside`` the third of a frame. ``_NOWHERE`` takes fluxes about the place.
    """

    normal: Vector
    near: Vector
    beside: Vector
    mode: int


@inlined
def touch(room: Room, cone: int, touched: int) -> int:
    """Begin to count the caps of a cone; returns how many cones are counted."""
    room.caps[cone], room.within[cone], room.touched[touched] = 0.0, 0.0, 1.0 * cone
    return touched + 1


@jitable
def cross_cone(room: Room, i: int, cone: int, found: int) -> int:
    """List where arc i crosses the caps of a cone, and count these and the ones the arc begins in."""
    arc = room.arcs[i]
    for k in range(int(room.begin[cone]), int(room.stop[cone])):
        other = room.arcs[k]
        if k == i or (int(arc.cone) == cone and other.linked != 0.0 and arc.linked != 0.0):
            continue
        room.caps[cone] += 1.0
        if is_conic(arc, other):
            found, begins = cross_conic(room, i, k, found)
            if begins:
                room.within[cone] += 1.0
            continue
        begin, span = stretch(arc, other, i < k)
        if span == 0.0:
            continue
        if span == TURN:
            room.within[cone] += 1.0
            continue
        rest = 0.0
        if begin < 0.0:
            rest = rest_of_sum(begin, TURN) + TURN_REST
            begin = begin + TURN
        leave, left = begin + span, rest + rest_of_sum(begin, span)
        if leave >= TURN:
            room.within[cone] += 1.0
            leave, left = leave - TURN, left - TURN_REST
        if begin < arc.end:
            found = put_crossing(room, found, begin, rest, 1.0, other.cone)
        if leave < arc.end:
            found = put_crossing(room, found, leave, left, -1.0, other.cone)
    return found


@jitable
def reach_of(arc: Arc) -> tuple[Vector, Vector, Vector, float, float]:
    """(normal of the plane of an arc, end, middle, cosine and sine of half of it): bounds of its directions.

    The normal is zero where there is no plane through the place, the cosine -1 where no narrow cone holds the arc.
    """
    none = (0.0, 0.0, 0.0)
    if arc.rim != 0.0:
        return none, none, none, -1.0, 0.0
    if arc.cosine != 0.0:
        return none, none, vector(arc.axis), arc.cosine, arc.sine
    if arc.linked == 0.0:
        return vector(arc.axis), none, none, -1.0, 0.0
    half = 0.5 * arc.end
    c, s = math.cos(half), math.sin(half)
    f, g = vector(arc.first), vector(arc.second)
    middle = (c * f[0] + s * g[0], c * f[1] + s * g[1], c * f[2] + s * g[2])
    c2, s2 = c * c - s * s, 2.0 * s * c
    return vector(arc.axis), (c2 * f[0] + s2 * g[0], c2 * f[1] + s2 * g[1], c2 * f[2] + s2 * g[2]), middle, c, s


@jitable
def aside(world: World, piece: Piece, place: Vector, arc: Arc, end: Vector) -> bool:
    """Whether a polygon is seen on one side of an edge's circle, or before its start, or beyond its end.

    By more than roundings: a cone over corners that all lie on one side of a plane does not meet it. A vertex that the
    edge shares is in the plane itself, and met at an end of the arc.
    """
    if arc.linked == 0.0 or piece.count == 0.0:
        return False
    axis, way = vector(arc.axis), vector(arc.second)
    onward = cross(axis, end)
    left, right, before, beyond, shared = True, True, True, True, 0
    for k in range(int(piece.count)):
        there = corner(piece, k)
        at = minus(there, place)
        room = _CLEAR * (abs(at[0]) + abs(at[1]) + abs(at[2]))
        before, beyond = before and dot(way, at) < -room, beyond and dot(onward, at) > room
        if left or right:
            height = dot(axis, at)
            if abs(height) > room:
                left, right = left and height > 0.0, right and height < 0.0
            elif arc.edge >= 0.0 and ends_at(world, arc, there):
                shared += 1
            else:
                left, right = False, False
        if shared > 1 or not (left or right or before or beyond):
            return False
    return True


@jitable
def ends_at(world: World, arc: Arc, vertex: Vector) -> bool:
    """Whether the edge of a listed polygon has this vertex."""
    own, k = world.pieces[int(arc.cone) - 1], int(arc.edge)
    return same(corner(own, k), vertex) or same(corner(own, (k + 1) % int(own.count)), vertex)


@jitable
def avoids(room: Room, i: int, end: Vector, cone: int) -> bool:
    """Whether an edge of a polygon is outside of a cone, by more than roundings: both of its ends are of one cap."""
    arc = room.arcs[i]
    if arc.linked == 0.0:
        return False
    start = vector(arc.first)
    for k in range(int(room.begin[cone]), int(room.stop[cone])):
        other = room.arcs[k]
        axis = vector(other.axis)
        if other.linked != 0.0 and dot(axis, start) < -_CLEAR and dot(axis, end) < -_CLEAR:
            return True
    return False


@jitable
def put_late(world: World, room: Room, place: Vector, j: int) -> None:
    """Add the arcs of a listed polygon that has none yet, all of them inner ones."""
    piece, count = world.pieces[j], int(room.used[0])
    if piece.count > 0.0:
        room.begin[1 + j] = 1.0 * count
        count = put_polygon(room, count, 1 + j, piece, place)
        room.stop[1 + j] = 1.0 * count
        room.used[0] = 1.0 * count


@jitable
def gather_crossings(world: World, room: Room, place: Vector, i: int) -> tuple[int, int]:
    """List where arc i crosses the caps of all cones it may be in; returns how many crossings and how many cones."""
    arc = room.arcs[i]
    own, beside = int(arc.cone), int(arc.beside)
    touched = touch(room, 0, 0)
    found = cross_cone(room, i, 0, 0)
    if own != 0:
        touched = touch(room, own, touched)
        found = cross_cone(room, i, own, found)
    plane, end, middle, cosine, sine = reach_of(arc)
    body = 0.0
    if own > 0 and room.stop[own] - room.begin[own] <= world.pieces[own - 1].count:
        # what is cut by the plane of a lamp is no longer of a convex body
        body = world.pieces[own - 1].body
    node = next_beside(world.bounds, room.nodes, 0, place, plane, middle, cosine, sine, body)
    while node < world.bounds.shape[0]:
        if room.nodes[node] == WHOLE:
            take_whole(world.bounds, room.nodes, node, room.side)
        for m in range(inside_of(world.bounds, node)):
            cone = 1 + held_by(world.bounds, node, m)
            if room.side[cone] == 0.0 or cone == own or cone == beside:  # noqa: SIM109
                continue
            if body != 0.0 and world.pieces[cone - 1].body == body:
                continue
            if aside(world, world.pieces[cone - 1], place, arc, end):
                continue
            if room.begin[cone] == room.stop[cone]:
                put_late(world, room, place, cone - 1)
            if room.begin[cone] == room.stop[cone] or avoids(room, i, end, cone):
                continue
            touched = touch(room, cone, touched)
            found = cross_cone(room, i, cone, found)
        node = next_beside(world.bounds, room.nodes, node + 1, place, plane, middle, cosine, sine, body)
    return found, touched


@jitable
def about_lamp(room: Room, count: int, normal: Vector) -> About:
    """Where fluxes of arcs are taken about: a direction near a lamp that is a sphere, none of other lights."""
    nowhere = (0.0, 0.0, 0.0)
    for i in range(count):
        arc = room.arcs[i]
        if arc.cone == 0.0 and arc.cosine != 0.0:
            axis = vector(arc.axis)
            height = dot(axis, normal)
            if height > _STEEP:
                return About(normal, axis, nowhere, _NEAR)
            level = minus(axis, (height * normal[0], height * normal[1], height * normal[2]))
            size = math.sqrt(dot(level, level))
            level = (level[0] / size, level[1] / size, level[2] / size)
            return About(normal, level, cross(normal, level), _LEVEL)
    return About(normal, nowhere, nowhere, _NOWHERE)


@jitable
def beyond_chord(span: float) -> float:
    """x - 2 sin(x/2)."""
    if span > 0.1:
        return span - 2.0 * math.sin(0.5 * span)
    s = span * span
    return span * s / 24.0 * (1.0 - s / 80.0 * (1.0 - s / 168.0 * (1.0 - s / 288.0)))


@jitable
def near_flux(arc: Arc, middle: float, span: float, chord: float, about: About) -> float:
    """n . integral of (w - r) x dw along an arc of a circle, r the direction that fluxes are taken about.

    Around a closed region the integral of r x dw is 0: taken about a direction near a small lamp, arcs add up to what
    is seen of it, not to differences of arcs a million times larger that end at each other but for roundings.
    With e = b cos a - r, b the axis of the circle, it is span sin^2 a n.b + n.(e x the chord).
    """
    axis, n, r, s = vector(arc.axis), about.normal, about.near, about.beside
    c, d = math.cos(middle), math.sin(middle)
    f, g = vector(arc.first), vector(arc.second)
    ahead = (c * g[0] - d * f[0], c * g[1] - d * f[1], c * g[2] - d * f[2])
    long = arc.sine * chord
    over = dot(axis, n)
    if about.mode == _NEAR:
        short = arc.sine * arc.sine / (1.0 + arc.cosine)
        e = (
            (axis[0] - r[0]) - short * axis[0], (axis[1] - r[1]) - short * axis[1], (axis[2] - r[2]) - short * axis[2],
        )  # fmt: skip
        return span * arc.sine * arc.sine * over + long * dot(n, cross(e, ahead))
    onward, sideways = dot(ahead, r), dot(ahead, s)
    if arc.cosine == 0.0:
        # of a great circle n.b and the chord's part along s are nearly the same, of the horizon both are nearly 1
        gap = over - sideways
        if over > _STEEP and sideways > _STEEP:
            gap = onward * onward / (1.0 + sideways) - (1.0 - over)
        return over * beyond_chord(span) + gap * chord if chord > 0.0 else over * span - long * sideways
    aside, along = dot(axis, s), dot(axis, r)
    off = aside * aside + over * over
    back = arc.cosine * along - 1.0
    if along > _NARROW:
        # 1 - cos a sqrt(1 - off), without the difference
        square = arc.sine * arc.sine
        back = -(square + off - square * off) / (1.0 + arc.cosine * math.sqrt(1.0 - off))
    return span * arc.sine * arc.sine * over + long * (back * sideways - arc.cosine * aside * onward)


@jitable
def rim_chord(arc: Arc, begin: float, end: float) -> Vector:
    """From where to where unit directions along the rim of a disk go."""
    f, g, middle = vector(arc.first), vector(arc.second), vector(arc.middle)
    p = leaves.disk_point(*middle, *f, *g, math.cos(begin), math.sin(begin))
    q = leaves.disk_point(*middle, *f, *g, math.cos(end), math.sin(end))
    u, v = math.sqrt(dot(p, p)), math.sqrt(dot(q, q))
    return (q[0] / v - p[0] / u, q[1] / v - p[1] / u, q[2] / v - p[2] / u)


@jitable
def add_arc(arc: Arc, begin: float, end: float, rest: float, sign: float, flux: float, about: About) -> float:
    """``flux`` and that of a stretch of an arc, of the sign given; ``rest`` is what end - begin is rounded by.

    A whole circle has no chord: the sine of the double nearest to pi is not 0, and larger than a small cap allows.
    """
    span = (end - begin) + rest
    whole = end - begin == TURN
    chord = 0.0 if whole else 2.0 * math.sin(0.5 * span)
    if about.mode != _NOWHERE and arc.rim == 0.0:
        return flux + sign * near_flux(arc, 0.5 * (begin + end), span, chord, about)
    if arc.rim != 0.0:
        x, y, z = leaves.rim_flux(
            *vector(arc.middle), *vector(arc.first), *vector(arc.second), begin, 0.0 if end == TURN else end, span
        )
    else:
        x, y, z = leaves.arc_flux(
            *vector(arc.axis),
            *vector(arc.first),
            *vector(arc.second),
            arc.cosine,
            arc.sine,
            0.5 * (begin + end),
            span,
            chord,
        )
    if about.mode != _NOWHERE and not whole:
        a, b, c = cross(about.near, rim_chord(arc, begin, end))
        x, y, z = x - a, y - b, z - c
    n = about.normal
    return flux + sign * (n[0] * x + n[1] * y + n[2] * z)


@jitable
def wrong_cones(room: Room, touched: int, own: int) -> int:
    """How many cones are in the way of an arc of cone ``own``: in others it must not be, in its own and the light's."""
    wrong = 0
    for k in range(touched):
        c = int(room.touched[k])
        inside = room.within[c] == room.caps[c]
        if inside != (c == own or c == 0):
            wrong += 1
    return wrong


@jitable
def add_bounding(room: Room, i: int, found: int, touched: int, flux: float, about: About) -> float:
    """``flux`` and that of what of arc i bounds the region, its crossings and cones being listed."""
    arc = room.arcs[i]
    own = int(arc.cone)
    wrong = wrong_cones(room, touched, own)
    sign = 1.0 if own == 0 else -1.0
    begin, rest = 0.0, 0.0
    for k in range(found):
        crossing = room.crossings[k]
        if wrong == 0:
            # a stretch without a length may grow
            flux = add_arc(arc, begin, crossing.angle, crossing.rest - rest, sign, flux, about)
        begin, rest = crossing.angle, crossing.rest
        c = int(crossing.cone)
        before = room.within[c] == room.caps[c]
        room.within[c] += crossing.step
        after = room.within[c] == room.caps[c]
        if before != after:
            wrong += 1 if after != (c == own or c == 0) else -1
    if wrong == 0 and arc.end > begin:
        flux = add_arc(arc, begin, arc.end, (TURN_REST if arc.end == TURN else 0.0) - rest, sign, flux, about)
    return flux


@jitable
def open_irradiance(world: World, room: Room, place: Vector, count: int, normal: Vector) -> float:
    """Irradiance by radiance 1 from cone 0 less all others, bounded by ``count`` arcs; 0 of a negative count."""
    if count < 0:
        return 0.0
    flux, about = 0.0, about_lamp(room, count, normal)
    for i in range(count):
        if room.arcs[i].inner == 0.0:
            found, touched = gather_crossings(world, room, place, i)
            flux = add_bounding(room, i, found, touched, flux, about)
    return max(0.0, 0.5 * flux)


@jitable
def few_irradiance(room: Room, count: int, cones: int, normal: Vector) -> float:
    """``open_irradiance`` of a few arcs, those of a cone one after another, every one of them against all others."""
    if count < 0:
        return 0.0
    for c in range(cones):
        room.begin[c], room.stop[c] = 0.0, 0.0
    for i in range(count):
        c = int(room.arcs[i].cone)
        if room.stop[c] == 0.0:
            room.begin[c] = 1.0 * i
        room.stop[c] = 1.0 * i + 1.0
    flux, about = 0.0, about_lamp(room, count, normal)
    for i in range(count):
        found = 0
        for c in range(cones):
            touch(room, c, c)
            found = cross_cone(room, i, c, found)
        flux = add_bounding(room, i, found, cones, flux, about)
    return max(0.0, 0.5 * flux)
