"""Where outlines cross in up to four places: the rim of a disk and that of another, or the circle of a sphere.

Along the base curve, a rim q(t), a quadratic form of q is positive in the double cone of the other: a trigonometric
polynomial of degree 2. Its sign changes are found on dyadic pieces of the turn, each proved to hold none or one by the
bounds of slopes; the last steps are Newton's, so that a crossing moves as its curves do. The other curve takes the same
crossings, turned round: where one convex cone's outline enters another cone, the other's outline leaves the first.
"""

from __future__ import annotations

import math
from typing import Final, TypeAlias

from symrender.chambers.caps import Arc
from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import TURN, Room, put_crossing
from symrender.radiometric.vectors import Vector, cross, dot, minus, vector

Form: TypeAlias = tuple[float, float, float, float, float]
"""(constant, cos t, sin t, cos 2t, sin 2t) of a trigonometric polynomial."""
_FIXED: Final = 2.0**49
"""Angles as whole numbers are in parts of this."""
_DEPTH: Final = 30
"""Halvings of the turn after which two crossings are too near each other to matter."""
_SAME: Final = 1e-13
"""Size of a form, in parts of what it is made of, at which two curves are the same."""
_NONE: Final = -1


@inlined
def is_conic(c: Arc, o: Arc) -> bool:
    """Whether two curves may cross in four places: a rim, and a rim or the circle of a sphere."""
    return (c.rim != 0.0 and (o.rim != 0.0 or o.cosine != 0.0)) or (o.rim != 0.0 and c.cosine != 0.0)


@jitable
def form_value(f: Form, t: float) -> float:
    """Value at an angle."""
    c, s = math.cos(t), math.sin(t)
    return f[0] + f[1] * c + f[2] * s + f[3] * (c * c - s * s) + f[4] * (2.0 * s * c)


@jitable
def form_slope(f: Form, t: float) -> float:
    """Slope at an angle."""
    c, s = math.cos(t), math.sin(t)
    return f[2] * c - f[1] * s + 2.0 * (f[4] * (c * c - s * s) - f[3] * (2.0 * s * c))


@jitable
def sign_change(a: float, b: float, c: float, d: float, e: float, number: int) -> int:
    """Where a form changes its sign for the time ``number``, from 0 on, as a whole number; _NONE if it does not."""
    f = (a, b, c, d, e)
    bend = math.sqrt(b * b + c * c) + 4.0 * math.sqrt(d * d + e * e)
    depth, place, seen = 0, 0, 0
    half = 0.5 * TURN
    while True:
        low = 2.0 * half * place
        middle = low + half
        high = 2.0 * half * (place + 1)
        here, steep = form_value(f, middle), abs(form_slope(f, middle))
        if abs(here) <= half * (steep + 0.5 * bend * half):
            alone = steep > bend * half or depth >= _DEPTH
            if not alone:
                depth, place, half = depth + 1, 2 * place, 0.5 * half
                continue
            first = form_value(f, low) >= 0.0
            if first != (form_value(f, high if high < TURN else 0.0) >= 0.0):
                if seen == number:
                    for _ in range(60):
                        mid = 0.5 * (low + high)
                        if (form_value(f, mid) >= 0.0) == first:
                            low = mid
                        else:
                            high = mid
                    return int(0.5 * (low + high) * _FIXED)
                seen += 1
        place += 1
        while depth > 0 and place % 2 == 0:
            depth, place, half = depth - 1, place // 2, 2.0 * half
        if depth == 0:
            return _NONE


@jitable
def crossing_angle(f: Form, near: float) -> float:
    """A root near an angle, by two steps of Newton's, which move as the form does."""
    t = near
    for _ in range(2):
        slope = form_slope(f, t)
        bend = abs(f[1]) + abs(f[2]) + 4.0 * (abs(f[3]) + abs(f[4]))
        step = form_value(f, t) / slope if slope != 0.0 else 0.0
        # two crossings that all but coincide have no slope to go by
        if abs(slope) > 1e-7 * bend and abs(step) < 1e-6:
            t = t - step
    return t


@jitable
def product(x: Vector, y: Vector) -> Form:
    """The product of two forms of degree 1, each (constant, cos t, sin t)."""
    return (
        x[0] * y[0] + 0.5 * (x[1] * y[1] + x[2] * y[2]), x[0] * y[1] + x[1] * y[0], x[0] * y[2] + x[2] * y[0],
        0.5 * (x[1] * y[1] - x[2] * y[2]), 0.5 * (x[1] * y[2] + x[2] * y[1]),
    )  # fmt: skip


@inlined
def added(f: Form, share: float, g: Form) -> Form:
    """f + share g."""
    return (
        f[0] + share * g[0], f[1] + share * g[1], f[2] + share * g[2], f[3] + share * g[3], f[4] + share * g[4],
    )  # fmt: skip


@jitable
def along_rim(rim: Arc, a: Vector) -> Vector:
    """(constant, cos t, sin t) of the inner product of a rim's place with a vector."""
    return dot(a, vector(rim.middle)), dot(a, vector(rim.first)), dot(a, vector(rim.second))


@jitable
def less_squares(square: Form, share: float, m: Vector, f: Vector, s: Vector) -> Form:
    """A form less ``share`` times the square of the length of m + f cos t + s sin t."""
    x, y, z = (m[0], f[0], s[0]), (m[1], f[1], s[1]), (m[2], f[2], s[2])
    square = added(square, -share, product(x, x))
    square = added(square, -share, product(y, y))
    return added(square, -share, product(z, z))


@jitable
def in_circle(rim: Arc, o: Arc) -> tuple[Form, float]:
    """(form that is positive along a rim in the double cone of a sphere's circle, what it is made of)."""
    a, m, f, s = vector(o.axis), vector(rim.middle), vector(rim.first), vector(rim.second)
    size = dot(m, m) + dot(f, f)
    square = (0.0, 0.0, 0.0, 0.0, 0.0)
    if o.sine < 0.7:
        # of a small circle its sine squared, less that of the place
        square = less_squares(square, 1.0, cross(a, m), cross(a, f), cross(a, s))
        return less_squares(square, -o.sine * o.sine, m, f, s), o.sine * o.sine * size
    ahead = along_rim(rim, a)
    square = added(square, 1.0, product(ahead, ahead))
    return less_squares(square, o.cosine * o.cosine, m, f, s), size


@inlined
def apart(height: float, x: Vector, ahead: float, middle: Vector) -> Vector:
    """height x - ahead middle."""
    return (
        height * x[0] - ahead * middle[0], height * x[1] - ahead * middle[1], height * x[2] - ahead * middle[2],
    )  # fmt: skip


@jitable
def in_rim(rim: Arc, o: Arc) -> tuple[Form, float]:
    """(form that is positive along a rim in the double cone of another, what it is made of)."""
    way, middle = vector(o.axis), vector(o.middle)
    height = dot(way, middle)
    ahead = along_rim(rim, way)
    first = vector(o.first)
    radius = math.sqrt(dot(first, first))
    one = product(ahead, ahead)
    square = added((0.0, 0.0, 0.0, 0.0, 0.0), radius * radius, one)
    m, f, s = vector(rim.middle), vector(rim.first), vector(rim.second)
    square = less_squares(
        square, 1.0, apart(height, m, ahead[0], middle), apart(height, f, ahead[1], middle),
        apart(height, s, ahead[2], middle),
    )  # fmt: skip
    return square, radius * radius * (ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2])


@jitable
def in_cone(rim: Arc, o: Arc) -> tuple[Form, float]:
    """The same in the double cone of any curve."""
    if o.rim != 0.0:
        return in_rim(rim, o)
    return in_circle(rim, o)


@jitable
def curve_place(c: Arc, t: float) -> Vector:
    """A place, or direction, of a curve at an angle."""
    x, y = math.cos(t), math.sin(t)
    if c.rim != 0.0:
        return leaves.disk_point(*vector(c.middle), *vector(c.first), *vector(c.second), x, y)
    axis = vector(c.axis)
    at = (c.cosine * axis[0], c.cosine * axis[1], c.cosine * axis[2])
    f, s, k = vector(c.first), vector(c.second), c.sine
    return leaves.disk_point(*at, k * f[0], k * f[1], k * f[2], k * s[0], k * s[1], k * s[2], x, y)


@jitable
def level_in(o: Arc, q: Vector) -> float:
    """Positive where a direction lies in the cone of a curve, in parts of the direction's length and the cone's."""
    size = math.sqrt(dot(q, q))
    ahead = dot(vector(o.axis), q)
    if o.rim == 0.0:
        return ahead / size - o.cosine
    if ahead <= 0.0:
        return -1.0
    middle, first = vector(o.middle), vector(o.first)
    share = dot(vector(o.axis), middle) / ahead
    out = minus((share * q[0], share * q[1], share * q[2]), middle)
    return 1.0 - math.sqrt(dot(out, out) / dot(first, first))


@jitable
def lies_in(c: Arc, o: Arc) -> bool:
    """Whether a curve that does not cross another lies in its cone: told where it is the farthest from the other."""
    best = 0.0
    for k in range(4):
        level = level_in(o, curve_place(c, 0.25 * TURN * k))
        if abs(level) > abs(best):
            best = level
    return best > 0.0


@jitable
def angle_along(o: Arc, q: Vector) -> float:
    """Angle along a curve of the direction of a place."""
    if o.rim != 0.0:
        share = dot(vector(o.axis), vector(o.middle)) / dot(vector(o.axis), q)
        q = minus((share * q[0], share * q[1], share * q[2]), vector(o.middle))
    return leaves.angle_on(*q, *vector(o.first), *vector(o.second))


@jitable
def cross_conic(room: Room, i: int, k: int, found: int) -> tuple[int, bool]:
    """List where curve i crosses curve k; returns (how many crossings are listed, whether i begins in the cone of k).

    Of both the base is the rim, of two rims the one that is earlier in the list.
    """
    arc, other = room.arcs[i], room.arcs[k]
    based = arc.rim != 0.0 and (other.rim == 0.0 or i < k)
    one, two = (i, k) if based else (k, i)
    base, cone = room.arcs[one], room.arcs[two]
    form, size = in_cone(base, cone)
    most = max(abs(form[0]), abs(form[1]), max(abs(form[2]), abs(form[3]), abs(form[4])))
    if most <= _SAME * size:
        return found, i > k
    crossings, earliest, begins = 0, 2.0 * TURN, False
    for number in range(4):
        code = sign_change(form[0], form[1], form[2], form[3], form[4], number)
        if code < 0:
            break
        t = crossing_angle(form, code / _FIXED)
        q = curve_place(base, t)
        if dot(vector(cone.axis), q) <= 0.0:
            # it meets the other half of the double cone
            continue
        step = 1.0 if form_slope(form, t) > 0.0 else -1.0
        if not based:
            t, step = angle_along(arc, q), -step
        if t < 0.0:
            t = t + TURN
        if t >= TURN:
            t = t - TURN
        crossings += 1
        if t < earliest:
            earliest, begins = t, step < 0.0
        found = put_crossing(room, found, t, 0.0, step, other.cone)
    if crossings == 0:
        begins = lies_in(arc, other)
    return found, begins
