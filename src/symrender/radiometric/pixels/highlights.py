"""Upper bounds of the light of points, spots and directions in a cell, and whether nodes resolve it.

Rules that agree say nothing of what lies between their nodes. The light of one lamp on one shape is a product of a lobe
and of 1/d^2. Over a cell the normal, the direction to the eye and the direction to the lamp stay within caps; these
bound the product from above, and how fast its logarithm changes. A cell in which it changes by more than ``_STEEP`` is
halved until the bound times its area is small enough to be stated as an error. The bounds hold for every cell: lobes of
any width, lamps behind the image plane, cells that a horizon or an outline crosses.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.jit.marks import jitable
from symrender.leaves import values
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import DISK, Cell, Eye
from symrender.radiometric.pixels.lobes import angle_between, density_about
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.pixels.sight import linear_range, may_show
from symrender.radiometric.pixels.turned import bump_cap
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Vector, cross, dot, minus, minus_of, vector
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE, DIRECTIONAL, POINT, SPHERE, SPOT
from symrender.scene.radiometric.records import Light, Material

_STEEP: Final = 3.0
"""Largest change of the logarithm of a factor, from the middle of a cell, that rules of few nodes resolve."""
_MASKED: Final = 6.0
"""Largest change of a cosine in a cell, over its least value plus alpha, for which they resolve masking."""
_RIGHT: Final = 0.5 * math.pi


class Cap(NamedTuple):
    """Unit directions no farther than an angle ``turn`` from the one in the middle."""

    middle: Vector
    turn: float


class Footprint(NamedTuple):
    """Where the rays of a cell meet a sphere: its ``normal`` there, a place, and how far from it all places may be."""

    normal: Cap
    place: Vector
    reach: float


@jitable
def unit_of(v: Vector) -> Vector:
    """v/|v|; of no length some unit vector."""
    size = math.sqrt(dot(v, v))
    return (v[0] / size, v[1] / size, v[2] / size) if size > 0.0 else (0.0, 0.0, 1.0)


@jitable
def directions_of(v: Vector, vx: Vector, vy: Vector) -> tuple[Cap, float, float]:
    """(cap of the directions of v + a vx + b vy, |a|, |b| <= 1, least length of these, farthest from v)."""
    size, d = math.sqrt(dot(v, v)), unit_of(v)
    a, b = dot(d, vx), dot(d, vy)
    xx, yy, xy = dot(vx, vx), dot(vy, vy), dot(vx, vy)
    along = size - abs(a) - abs(b)
    across = math.sqrt(max(xx - a * a + yy - b * b + 2.0 * abs(xy - a * b), 0.0))
    n = cross(vx, vy)
    area = math.sqrt(dot(n, n))
    away = abs(dot(v, n)) / area if area > 0.0 else 0.0
    turn = math.atan(across / along) if along > 0.0 else math.pi
    return Cap(d, turn), max(along, away), math.sqrt(xx + yy + 2.0 * abs(xy))


@jitable
def ball_footprint(eye: Eye, cell: Cell, ball: Piece, turn: float) -> tuple[Footprint, bool]:
    """(where rays no farther than ``turn`` from a cell's middle one meet a sphere, whether from inside).

    In the triangle of the sphere's centre, the eye and the place, the angle at the centre is monotone in that at the
    eye. A ``reach`` below 0 says that they miss it.
    """
    center, radius = vector(ball.place), float(ball.radius)
    back = minus(eye.place, center)
    start = minus(back, cell.v) if eye.domain == DISK else back
    far, axis, ray = math.sqrt(dot(back, back)), unit_of(back), unit_of(cell.v)
    held, within = far < radius, dot(start, start) < radius * radius
    farther = held
    # rays of a lens begin before they pass ``place``, and may meet the sphere before they do
    if eye.domain == DISK and (held != within or (not held and dot(back, ray) > 0.0)):
        ray, farther = minus_of(ray), held or not within
    off, most = angle_between(minus_of(axis), ray), math.pi if held else math.asin(radius / far)
    first, last = max(off - turn, 0.0), min(off + turn, most)
    if first > most:
        return Footprint(Cap(axis, 0.0), center, -1.0), within
    low = math.asin(min(1.0, far * math.sin(first) / radius))
    high = math.asin(min(1.0, far * math.sin(last) / radius))
    if farther:
        low, high = math.pi - last - high, math.pi - first - low
    else:
        low, high = low - first, high - last
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    round_ = math.asin(math.sin(turn) / math.sin(off)) if turn < off and off + turn < math.pi else math.pi
    along = dot(ray, axis)
    side = unit_of((ray[0] - along * axis[0], ray[1] - along * axis[1], ray[2] - along * axis[2]))
    c, s = math.cos(middle), math.sin(middle)
    out = (c * axis[0] + s * side[0], c * axis[1] + s * side[1], c * axis[2] + s * side[2])
    widest = 1.0 if low <= _RIGHT <= high else max(math.sin(low), math.sin(high))
    # |a - b|^2 = 4 sin^2 of half the difference of heights + 4 sin sin sin^2 of half the difference of turns
    chord = 2.0 * math.hypot(math.sin(0.5 * half), widest * math.sin(0.5 * min(round_, math.pi)))
    place = (center[0] + radius * out[0], center[1] + radius * out[1], center[2] + radius * out[2])
    normal = minus_of(out) if within else out
    return Footprint(Cap(normal, 2.0 * math.asin(min(1.0, 0.5 * chord))), place, radius * chord), within


@jitable
def half_off(normal: Cap, view: Cap, toward: Cap) -> tuple[float, float]:
    """(angle between normal and half vector in the middle of caps, by how much it changes in them at most)."""
    a, b = view.middle, toward.middle
    half = (a[0] + b[0], a[1] + b[1], a[2] + b[2])
    size, wide = math.sqrt(dot(half, half)), view.turn + toward.turn
    return angle_between(normal.middle, unit_of(half)), normal.turn + (
        math.asin(wide / size) if wide < size else math.pi
    )


@jitable
def mirror_off(normal: Cap, view: Cap, toward: Cap) -> tuple[float, float]:
    """The same of the mirrored direction to the eye and that to the lamp."""
    x, y, z = values.mirror_direction(*minus_of(view.middle), *normal.middle)
    return angle_between((x, y, z), toward.middle), 2.0 * normal.turn + view.turn + toward.turn


@jitable
def lobe_bound(material: Material, normal: Cap, view: Cap, toward: Cap) -> tuple[float, bool]:
    """(largest f cos_i of a material of albedo 1 for directions in caps, whether few nodes resolve its changes)."""
    inward = angle_between(normal.middle, toward.middle) - normal.turn - toward.turn
    outward = angle_between(normal.middle, view.middle) - normal.turn - view.turn
    if inward >= _RIGHT or outward >= _RIGHT:
        return 0.0, True
    most = math.cos(max(inward, 0.0))
    if material.terms != 0.0:
        # light may count by the cosine of another normal
        most = 1.0
    if material.kind == DIFFUSE:
        return most / math.pi, True
    if material.kind == CONDUCTOR:
        most = 1.0
        off, turn = half_off(normal, view, toward)
    else:
        off, turn = mirror_off(normal, view, toward)
    least, largest = max(off - turn, 0.0), max(off, turn)
    most *= density_about(material, least)
    seen, lit = 2.0 * (normal.turn + view.turn), 2.0 * (normal.turn + toward.turn)
    least_seen, least_lit = math.cos(min(outward + seen, _RIGHT)), math.cos(min(inward + lit, _RIGHT))
    if material.kind == CONDUCTOR and material.terms == 0.0:
        # G1/cos is no more than 1/cos either
        most *= min(1.0, material.alpha / ((4.0 if material.density == BECKMANN else 2.0) * max(least_seen, 1e-300)))
    if largest >= _RIGHT:
        return most, most == 0.0
    if material.kind != CONDUCTOR:
        return most, material.exponent * math.tan(largest) * turn <= _STEEP
    if material.density == BECKMANN:
        slope = math.tan(largest)
        steep = 2.0 * slope * (1.0 + slope * slope) / (material.alpha * material.alpha)
    else:
        # of 2 ln(alpha^2 cos^2 + sin^2), largest at about alpha
        at = min(max(material.alpha, least), largest)
        square = material.alpha * material.alpha + (1.0 - material.alpha * material.alpha) * math.sin(at) ** 2
        steep = 4.0 * math.sin(at) * math.cos(at) / square
    masked = max(seen / (least_seen + material.alpha), lit / (least_lit + material.alpha))
    return most, steep * turn <= _STEEP and masked <= _MASKED


@jitable
def brightest_of(lamp: Light, toward: Cap) -> float:
    """What a light emits at most towards places that see it in a cap of directions."""
    if lamp.kind == SPOT:
        off = angle_between(minus_of(vector(lamp.axis)), toward.middle) - toward.turn
        if off >= lamp.cutoff * math.pi / 180.0:
            return 0.0
    return float(max(lamp.emitted[0], max(lamp.emitted[1], lamp.emitted[2])))


@jitable
def flat_light(eye: Eye, cell: Cell, piece: Piece, lamp: Light, side: float) -> tuple[Cap, float, bool]:
    """(directions to a light from where a cell's rays meet a plane, largest irradiance across its rays, whether few
    nodes resolve the changes of 1/d^2).

    (L - E)(u.v) + h v points from the place to the light L: it is linear in the cell's coordinates, horizon or not.
    """
    at, up = vector(lamp.place), vector(piece.up)
    if lamp.kind == DIRECTIONAL:
        toward = Cap(unit_of(minus_of(at)), 0.0)
        return toward, brightest_of(lamp, toward) if side * dot(up, toward.middle) > 0.0 else 0.0, True
    if side * height_over(piece, at) <= 0.0:
        return Cap(up, 0.0), 0.0, True
    way, height = minus(at, eye.place), height_over(piece, eye.place)
    low, high = linear_range(up, cell.v, cell.vx, cell.vy)
    most = max(-side * low, -side * high)
    if most <= 0.0:
        return Cap(up, 0.0), 0.0, True
    a, b, c = -side * dot(up, cell.v), -side * dot(up, cell.vx), -side * dot(up, cell.vy)
    h, v, vx, vy = -side * height, cell.v, cell.vx, cell.vy
    toward, least, wide = directions_of(
        (a * way[0] + h * v[0], a * way[1] + h * v[1], a * way[2] + h * v[2]),
        (b * way[0] + h * vx[0], b * way[1] + h * vx[1], b * way[2] + h * vx[2]),
        (c * way[0] + h * vy[0], c * way[1] + h * vy[1], c * way[2] + h * vy[2]),
    )  # fmt: skip
    if least <= 0.0:
        return toward, math.inf, False
    return toward, brightest_of(lamp, toward) * (most / least) ** 2, 3.0 * wide <= _STEEP * least


@jitable
def ball_light(ball: Piece, lamp: Light, foot: Footprint) -> tuple[Cap, float, bool]:
    """The same of a sphere."""
    at = vector(lamp.place)
    if lamp.kind == DIRECTIONAL:
        toward = Cap(unit_of(minus_of(at)), 0.0)
        return toward, brightest_of(lamp, toward), True
    way, out = minus(at, foot.place), minus(at, vector(ball.place))
    far = math.sqrt(dot(way, way))
    near = max(far - foot.reach, abs(math.sqrt(dot(out, out)) - ball.radius))
    turn = math.asin(foot.reach / far) if foot.reach < far else math.pi
    toward = Cap(unit_of(way), turn)
    if near <= 0.0:
        return toward, math.inf, False
    return toward, brightest_of(lamp, toward) / (near * near), 2.0 * foot.reach <= _STEEP * near


@jitable
def footprint_of(eye: Eye, cell: Cell, own: int, turn: float) -> tuple[Footprint, bool]:
    """(where rays no farther than ``turn`` from a cell's middle one meet a piece, whether from behind)."""
    piece = eye.world.pieces[own]
    if piece.kind == SPHERE:
        return ball_footprint(eye, cell, piece, turn)
    start = minus(eye.place, cell.v) if eye.domain == DISK else eye.place
    behind = height_over(piece, start) < 0.0
    up = vector(piece.up)
    return Footprint(Cap(minus_of(up) if behind else up, 0.0), start, 0.0), behind


@jitable
def lamp_seen(eye: Eye, cell: Cell, own: int, light: int, foot: Footprint) -> tuple[Cap, float, bool]:
    """``ball_light`` or ``flat_light`` of a piece."""
    piece, lamp = eye.world.pieces[own], eye.world.lights[light]
    if piece.kind == SPHERE:
        return ball_light(piece, lamp, foot)
    return flat_light(eye, cell, piece, lamp, 1.0 if dot(vector(piece.up), foot.normal.middle) > 0.0 else -1.0)


@jitable
def shape_light(eye: Eye, cell: Cell, room: Room, own: int, view: Cap) -> float:
    """The largest radiance that lamps may cause on a piece in a cell and few nodes may not resolve."""
    piece = eye.world.pieces[own]
    material = eye.world.materials[int(piece.material)]
    foot, behind = footprint_of(eye, cell, own, view.turn)
    if foot.reach < 0.0 or (behind and material.two_sided == 0.0):
        return 0.0
    normal = foot.normal
    if room.models is not None and material.terms != 0.0:
        turned, wide = bump_cap(eye, cell, room, own, room.models)
        normal = Cap(minus_of(turned) if behind else turned, wide)
    albedo = max(max(material.bright[0], material.dark[0]), max(material.bright[1], material.dark[1]))
    albedo = max(albedo, max(material.bright[2], material.dark[2]))
    hidden = 0.0
    for i in range(eye.world.lights.shape[0]):
        if eye.world.lights[i].kind not in (POINT, SPOT, DIRECTIONAL):
            continue
        toward, bright, near = lamp_seen(eye, cell, own, i, foot)
        if bright == 0.0:
            continue
        most, smooth = lobe_bound(material, normal, view, toward)
        if most > 0.0 and not (smooth and near):
            hidden += albedo * most * bright
    return hidden


@jitable
def hidden_light(eye: Eye, cell: Cell, room: Room, limit: float) -> float:
    """The largest radiance of lamps that few nodes of a cell may not resolve: highlights and places near a lamp."""
    if not eye.delicate:
        return 0.0
    back, _, _ = directions_of(minus_of(cell.v), cell.vx, cell.vy)
    most = 0.0
    for j in range(eye.world.pieces.shape[0]):
        if may_show(room, float(j), limit) and (eye.lobe is None or j != eye.lobe.own):
            most = max(most, shape_light(eye, cell, room, j, back))
    return most


@jitable
def power_hidden(exponent: float, off: float, turn: float) -> float:
    """The largest cos^n of an angle within ``turn`` of one, 0 where few nodes resolve its changes."""
    least, largest = max(off - turn, 0.0), max(off, turn)
    if least >= _RIGHT or (largest < _RIGHT and exponent * math.tan(largest) * turn <= _STEEP):
        return 0.0
    return math.exp(exponent * math.log(max(math.cos(least), 1e-300)))


@jitable
def hidden_powers(eye: Eye, cell: Cell, room: Room, limit: float) -> float:
    """The same in units of the series, where highlights are powers of a cosine: part of the largest that they may be.

    The cosine is that of the half vector and the normal, or of the mirror direction and the lamp.
    """
    view, _, _ = directions_of(minus_of(cell.v), cell.vx, cell.vy)
    most = 0.0
    for j in range(eye.world.pieces.shape[0]):
        exponent = eye.world.materials[int(eye.world.pieces[j].material)].exponent
        if not may_show(room, float(j), limit):
            continue
        foot, _ = footprint_of(eye, cell, j, view.turn)
        for i in range(eye.world.lights.shape[0] if foot.reach >= 0.0 else 0):
            toward, bright, _ = lamp_seen(eye, cell, j, i, foot)
            if bright > 0.0:
                off, turn = half_off(foot.normal, view, toward)
                hidden = power_hidden(exponent, off, turn)
                off, turn = mirror_off(foot.normal, view, toward)
                most = max(most, max(hidden, power_hidden(exponent, off, turn)))
    return most
