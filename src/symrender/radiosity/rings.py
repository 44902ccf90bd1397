"""Spheres before faces: the circles in which a place sees them, and what of a part of a cell lies about one.

A part that a circle passes through is taken along rays from the circle's middle: between the angles of corners and
those at which edges cross the circle, every ray runs from one edge, or from the circle, to another, and all is smooth.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pieces import put
from symrender.radiometric.reflection import reflected
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.lobes import angle_between
from symrender.radiosity.parts import cut, part_corner, range_over, sent_from_middle, with_sent
from symrender.radiosity.records import FREE, MANY, WORK, Cell, Receiver, Ring, Scratch
from symrender.scene.radiometric.arrays import DIFFUSE, SPHERE
from symrender.scene.radiometric.records import Material

TURN: Final = 2.0 * math.pi
_FLAT: Final = 1e-12
"""Distance from the plane of a circle, in parts of its own, within which a corner lies in it."""
_POINT: Final = 3e-9
"""Angle between corners up to which they are one."""
_THROUGH: Final = 1e-13
"""Angle from an axis up to which an edge passes through it."""
_REACH: Final = 12.0
"""Ratio of the largest and the least angle of an edge from an axis up to which rules see it."""
_ONE: Final = (1.0, 1.0, 1.0)
_FEW = np.stack(np.polynomial.legendre.leggauss(3), axis=1)
_MORE = np.stack(np.polynomial.legendre.leggauss(5), axis=1)


@jitable
def put_ring(ring: Ring, offset: Vector, radius: float, piece: int, inside: float) -> None:
    """Write the circle in which a sphere is seen from outside, its centre at ``offset``."""
    x, y, z, cosine, sine = leaves.sphere_cap(*offset, radius)
    axis = (x, y, z)
    a = (1.0, 0.0, 0.0) if abs(y) >= 0.9 else (0.0, 1.0, 0.0)
    f = cross(axis, a)
    size = math.sqrt(dot(f, f))
    f = (f[0] / size, f[1] / size, f[2] / size)
    put(ring.axis, axis)
    put(ring.first, f)
    put(ring.second, cross(axis, f))
    ring.cosine, ring.sine, ring.angle = cosine, sine, math.atan2(sine, cosine)
    ring.far = leaves.polar_distance(dot(offset, offset), radius)
    ring.inside, ring.piece = inside, 1.0 * piece


@jitable
def put_rings(world: World, at: Receiver, scratch: Scratch) -> int:
    """List the spheres above the horizon of a place, but its own; returns how many."""
    found = 0
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind != SPHERE or j == at.own:
            continue
        offset = minus(vector(piece.place), at.place)
        # within roundings of a sphere a place lies on it
        if leaves.sphere_power(*offset, piece.radius) <= 0.0 or dot(at.normal, offset) <= -piece.radius:
            continue
        put_ring(scratch.circles[found], offset, piece.radius, j, 0.0)
        found += 1
    return found


@jitable
def is_point(a: Vector, b: Vector, crossed: float) -> bool:
    """Whether two corners are one but for roundings: the plane through both is not told by them."""
    return crossed <= _POINT * math.sqrt(dot(a, a) * dot(b, b))


@jitable
def lies_about(scratch: Scratch, part: int, ring: Ring) -> tuple[bool, bool]:
    """Whether a part lies within a circle, and whether it is apart from it: all of it outside.

    The cap of a circle is convex, so corners tell the first; the second is told by the nearest place of every edge.
    """
    axis = vector(ring.axis)
    count = scratch.sizes[part]
    within, apart, middle = True, True, (0.0, 0.0, 0.0)
    for k in range(count):
        w = part_corner(scratch, part, k)
        if dot(axis, w) < ring.cosine * math.sqrt(dot(w, w)):
            within = False
        else:
            apart = False
        middle = (middle[0] + w[0], middle[1] + w[1], middle[2] + w[2])
    if within or not apart:
        return within, False
    holds = True
    last = part_corner(scratch, part, count - 1)
    for k in range(count):
        here = part_corner(scratch, part, k)
        p = cross(last, here)
        size = math.sqrt(dot(p, p))
        if is_point(last, here, size):
            last = here
            continue
        out = dot(p, axis) if dot(p, middle) > 0.0 else -dot(p, axis)
        holds = holds and out > 0.0
        if abs(out) <= ring.sine * size:
            # the place of the edge's great circle nearest the axis, if it lies on the edge
            toward = cross(cross(p, axis), p)
            if dot(cross(last, toward), p) >= 0.0 and dot(cross(toward, here), p) >= 0.0:
                return False, False
        last = here
    return False, not holds


@jitable
def is_near(scratch: Scratch, part: int, ring: Ring) -> bool:
    """Whether an edge of a part passes much nearer the axis of a ring than it reaches away, within or beside the ring.

    Where it does, rays meet it at angles that change within a small part of a turn, which no rule would see.
    """
    axis = vector(ring.axis)
    count = scratch.sizes[part]
    last = part_corner(scratch, part, count - 1)
    far = math.sqrt(dot(last, last))
    before = angle_between((last[0] / far, last[1] / far, last[2] / far), axis)
    for k in range(count):
        here = part_corner(scratch, part, k)
        far = math.sqrt(dot(here, here))
        after = angle_between((here[0] / far, here[1] / far, here[2] / far), axis)
        low, high = min(before, after), max(before, after)
        p = cross(last, here)
        size = math.sqrt(dot(p, p))
        if not is_point(last, here, size):
            toward = cross(cross(p, axis), p)
            if dot(cross(last, toward), p) >= 0.0 and dot(cross(toward, here), p) >= 0.0:
                low = math.asin(min(1.0, abs(dot(p, axis)) / size))
        if ring.inside != 0.0:
            high = min(high, ring.angle)
        else:
            low = max(low, ring.angle)
        if low > _THROUGH and _REACH * low < high:
            return True
        last, before = here, after
    return False


@jitable
def surround(scratch: Scratch, part: int, b: int, r: int) -> int:
    """Put what circle r, occluder b, leaves of the last part that waits in its place; returns how many parts wait.

    What may be passed through by the circle keeps it as its ring.
    """
    ring = scratch.circles[r]
    axis = vector(ring.axis)
    low, high = range_over(scratch, part, axis, -ring.far)
    flat = _FLAT * ring.far
    if ring.inside == 0.0:
        if high <= flat:
            scratch.done[part] = b + 1
            return part + 1
        if low < -flat:
            beyond = part + 1
            scratch.sizes[beyond] = cut(scratch, part, beyond, axis, -ring.far, 1.0)
            before = beyond + 1
            scratch.sizes[before] = cut(scratch, part, before, axis, -ring.far, -1.0)
            for i in range(3 * scratch.sizes[before]):
                scratch.corners[part, i] = scratch.corners[before, i]
            scratch.sizes[part] = scratch.sizes[before]
            scratch.done[beyond], scratch.rings[beyond] = b, scratch.rings[part]
            scratch.done[part] = b + 1
            return beyond + 1
    within, apart = lies_about(scratch, part, ring)
    if (within and ring.inside == 0.0) or (apart and ring.inside != 0.0):
        return part
    if not within and not apart:
        scratch.rings[part] = r if scratch.rings[part] == FREE else MANY
    scratch.done[part] = b + 1
    return part + 1


@jitable
def put_levels(scratch: Scratch, part: int, ring: Ring) -> tuple[int, int]:
    """Write the planes of a part's edges in the frame of a ring, and the angles where rays turn; returns how many."""
    axis, first, second = vector(ring.axis), vector(ring.first), vector(ring.second)
    count, found, edges = scratch.sizes[part], 0, 0
    middle = (0.0, 0.0, 0.0)
    for k in range(count):
        w = part_corner(scratch, part, k)
        middle = (middle[0] + w[0], middle[1] + w[1], middle[2] + w[2])
    last = part_corner(scratch, part, count - 1)
    for k in range(count):
        here = part_corner(scratch, part, k)
        found = put_turn(scratch, found, math.atan2(dot(here, second), dot(here, first)))
        p = cross(last, here)
        if is_point(last, here, math.sqrt(dot(p, p))):
            last = here
            continue
        sign = 1.0 if dot(p, middle) > 0.0 else -1.0
        out, across, along = sign * dot(p, axis), sign * dot(p, first), sign * dot(p, second)
        scratch.levels[edges, 0], scratch.levels[edges, 1], scratch.levels[edges, 2] = out, across, along
        edges += 1
        # where the edge crosses the circle: out cos a + (across cos t + along sin t) sin a = 0
        size, level = math.hypot(across, along) * ring.sine, -out * ring.cosine
        if abs(level) < size:
            middle_turn, half = math.atan2(along, across), math.acos(level / size)
            found = put_turn(scratch, found, middle_turn - half)
            found = put_turn(scratch, found, middle_turn + half)
        last = here
    return edges, found


@jitable
def put_turn(scratch: Scratch, count: int, angle: float) -> int:
    """Add an angle in [0, 2 pi) to those that are sorted; returns how many there are."""
    if angle < 0.0:
        angle += TURN
    if angle >= TURN:
        angle -= TURN
    i = count
    while i > 0 and scratch.turns[i - 1] > angle:
        scratch.turns[i] = scratch.turns[i - 1]
        i -= 1
    scratch.turns[i] = angle
    return count + 1


@jitable
def limits(scratch: Scratch, count: int, ring: Ring, across: float, along: float) -> tuple[float, float]:
    """(least, largest) angle from the axis of what a ray from the middle of a ring meets of a part beside the ring."""
    low, high = (0.0, ring.angle) if ring.inside != 0.0 else (ring.angle, math.pi)
    for k in range(count):
        out = scratch.levels[k, 0]
        rise = scratch.levels[k, 1] * across + scratch.levels[k, 2] * along
        if out >= 0.0:
            high = min(high, math.atan2(out, -rise))
        else:
            low = max(low, math.atan2(-out, rise))
    return low, high


@jitable
def on_ray(ring: Ring, turn: float, angle: float) -> Vector:
    """The direction at an angle from the axis of a ring, on the ray of angle ``turn``."""
    axis, first, second = vector(ring.axis), vector(ring.first), vector(ring.second)
    c, s = math.cos(angle), math.sin(angle)
    x, y = s * math.cos(turn), s * math.sin(turn)
    return (
        c * axis[0] + x * first[0] + y * second[0],
        c * axis[1] + x * first[1] + y * second[1],
        c * axis[2] + x * first[2] + y * second[2],
    )


@jitable
def share_beside(scratch: Scratch, count: int, turns: int, ring: Ring, normal: Vector) -> float:
    """Form factor of a part beside a ring, in closed form: Lambert's terms of edges and the flux of the circle."""
    total = 0.0
    for k in range(turns):
        begin = scratch.turns[k]
        end = scratch.turns[k + 1] if k + 1 < turns else scratch.turns[0] + TURN
        if end <= begin:
            continue
        middle = 0.5 * (begin + end)
        low, high = limits(scratch, count, ring, math.cos(middle), math.sin(middle))
        if high <= low:
            continue
        first_low, first_high = limits(scratch, count, ring, math.cos(begin), math.sin(begin))
        last_low, last_high = limits(scratch, count, ring, math.cos(end), math.sin(end))
        outer = (on_ray(ring, begin, first_high), on_ray(ring, end, last_high))
        total += leaves.edge_share(*outer[0], *outer[1], *normal)
        if low > ring.angle:
            inner = (on_ray(ring, begin, first_low), on_ray(ring, end, last_low))
            total -= leaves.edge_share(*inner[0], *inner[1], *normal)
        else:
            x, y, z = leaves.arc_flux(
                *vector(ring.axis), *vector(ring.first), *vector(ring.second), ring.cosine, ring.sine, middle,
                end - begin, 2.0 * math.sin(0.5 * (end - begin)) if turns > 1 else 0.0,
            )  # fmt: skip
            total -= dot(normal, (x, y, z)) / TURN
    return max(0.0, total)


@jitable
def ring_sum(
    scratch: Scratch, count: int, turns: int, ring: Ring, rule: Array, material: Material, at: Receiver, cell: Cell,
    way: Vector, level: float,
) -> tuple[Vector, float]:  # fmt: skip
    """(what is reflected channel by channel, the lobe's own integral) over a part beside a ring, by one Gauss rule.

    ``way`` leads from the cell's middle to the place, and the plane of the cell is at ``level`` along its normal.
    """
    axis, first, second = vector(ring.axis), vector(ring.first), vector(ring.second)
    u_way, v_way = vector(cell.across), vector(cell.along)
    up = cross(u_way, v_way)
    total, whole = (0.0, 0.0, 0.0), 0.0
    for k in range(turns):
        begin = scratch.turns[k]
        end = scratch.turns[k + 1] if k + 1 < turns else scratch.turns[0] + TURN
        if end <= begin:
            continue
        middle = 0.5 * (begin + end)
        low, high = limits(scratch, count, ring, math.cos(middle), math.sin(middle))
        if high <= low:
            continue
        for i in range(rule.shape[0]):
            turn = middle + 0.5 * (end - begin) * rule[i, 0]
            x, y = math.cos(turn), math.sin(turn)
            low, high = limits(scratch, count, ring, x, y)
            if high <= low:
                continue
            for j in range(rule.shape[0]):
                angle = 0.5 * (low + high) + 0.5 * (high - low) * rule[j, 0]
                c, s = math.cos(angle), math.sin(angle)
                weight = 0.25 * (end - begin) * (high - low) * rule[i, 1] * rule[j, 1] * s
                w = (
                    c * axis[0] + s * (x * first[0] + y * second[0]),
                    c * axis[1] + s * (x * first[1] + y * second[1]),
                    c * axis[2] + s * (x * first[2] + y * second[2]),
                )
                f = reflected(material, _ONE, at.normal, at.view, w)
                u = v = 0.0
                if cell.spread > 0.0:
                    t = level / dot(up, w)
                    o = (t * w[0] + way[0], t * w[1] + way[1], t * w[2] + way[2])
                    u, v = dot(u_way, o), dot(v_way, o)
                whole += weight * max(f[0], f[1], f[2])
                total = with_sent(total, weight, f, cell, u, v)
    return total, whole


@jitable
def beside_ring(
    scratch: Scratch, part: int, ring: Ring, material: Material, at: Receiver, cell: Cell, way: Vector, allowed: float,
    sums: Array,
) -> tuple[Vector, float, float]:  # fmt: skip
    """(what is reflected, the lobe's own integral, what both may be off) of a part beside the circle of a sphere.

    The form factor of a diffuse place is a closed form, and rules tell of what is sent on average alone.
    """
    count, turns = put_levels(scratch, part, ring)
    share = share_beside(scratch, count, turns, ring, at.normal) if material.kind == DIFFUSE else 0.0
    if material.kind == DIFFUSE and share * cell.spread <= allowed:
        red, green, blue = sent_from_middle(scratch, part, cell, way)
        sums[WORK] += 1.0 * turns
        return (share * red, share * green, share * blue), share, share * cell.spread
    level = dot(cross(vector(cell.across), vector(cell.along)), part_corner(scratch, part, 0))
    few, less = ring_sum(scratch, count, turns, ring, _FEW, material, at, cell, way, level)
    more, whole = ring_sum(scratch, count, turns, ring, _MORE, material, at, cell, way, level)
    sums[WORK] += 34.0 * turns
    if material.kind == DIFFUSE and less > 0.0 and whole > 0.0:
        a, b = share / whole, share / less
        more, few = (a * more[0], a * more[1], a * more[2]), (b * few[0], b * few[1], b * few[2])
        whole = share
    off = max(abs(more[0] - few[0]), abs(more[1] - few[1]), abs(more[2] - few[2]))
    return more, whole, off
