"""Which shapes may be seen in a cell, by intervals: what lies behind a shape that fills it does not cut it."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pieces import POLYGON, Piece, corner
from symrender.radiometric.pixels.cells import DISK, Cell, Eye
from symrender.radiometric.pixels.curves import put_form, spread
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import SPHERE

_MARGIN = 1e-12


@inlined
def linear_range(n: Vector, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float]:
    """Least and largest n.v in a cell."""
    middle, half = dot(n, v), abs(dot(n, vx)) + abs(dot(n, vy))
    return middle - half, middle + half


@jitable
def form_range(form: Array) -> tuple[float, float]:
    """Least and largest value of a curve in its cell, by its coefficients."""
    half = spread(form)
    return form[0] - half, form[0] + half


@jitable
def sphere_reach(c: Vector, radius: float, v: Vector, vx: Vector, vy: Vector, work: Array) -> tuple[float, float]:
    """(nearest, farthest) t at which rays t v of a cell meet a sphere: inf where none does, where not all do."""
    low, high = linear_range(c, v, vx, vy)
    power = leaves.sphere_power(*c, radius)
    square = dot(v, v)
    spread = math.sqrt(dot(vx, vx)) + math.sqrt(dot(vy, vy))
    size = math.sqrt(square)
    if power <= 0.0:
        # from inside every ray meets it
        far = size + spread
        near = max(size - spread, 1e-300)
        root = math.sqrt(max(high * high, low * low) - power * far * far)
        return 0.0, (abs(high) + root) / (near * near)
    if high <= 0.0:
        return math.inf, math.inf
    xx, yy, zz, xy, xz, yz = leaves.silhouette_conic(*c, radius)
    form = work[7]
    form[0], form[1], form[2], form[3], form[4], form[5] = xx, yy, zz, xy, xz, yz
    curve = work[6]
    put_form(form, v, vx, vy, curve)
    least, most = form_range(curve)
    if most < 0.0:
        return math.inf, math.inf
    nearest = power / (high + math.sqrt(most))
    if least <= 0.0 or low <= 0.0:
        return nearest, math.inf
    return nearest, power / (low + math.sqrt(least))


@jitable
def plane_depths(up: Vector, height: float, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float]:
    """The same of a plane that the eye is at a height over."""
    if height == 0.0:
        return math.inf, math.inf
    low, high = linear_range((-up[0] / height, -up[1] / height, -up[2] / height), v, vx, vy)
    if high <= 0.0:
        return math.inf, math.inf
    return 1.0 / high, 1.0 / low if low > 0.0 else math.inf


@jitable
def least_depth(piece: Piece, at: Vector, v: Vector, vx: Vector, vy: Vector) -> float:
    """Least q at which rays at + (q - 1) v may meet a piece, by how far from their beginnings it is; inf for never."""
    longest = math.sqrt(dot(v, v)) + math.sqrt(dot(vx, vx)) + math.sqrt(dot(vy, vy))
    if piece.kind == PLANE:
        low, high = linear_range(vector(piece.up), v, vx, vy)
        height = height_over(piece, at)
        first, last = height - high, height - low
        away = 0.0 if first <= 0.0 <= last else min(abs(first), abs(last))
        return away / max(abs(low), abs(high)) if away > 0.0 else 0.0
    center, radius = vector(piece.place), piece.radius
    if piece.kind == POLYGON:
        x, y, z = 0.0, 0.0, 0.0
        for k in range(int(piece.count)):
            a, b, c = corner(piece, k)
            x, y, z = x + a / piece.count, y + b / piece.count, z + c / piece.count
        center, radius = (x, y, z), 0.0
        for k in range(int(piece.count)):
            way = minus(corner(piece, k), center)
            radius = max(radius, math.sqrt(dot(way, way)))
    way = minus(center, at)
    _, high = linear_range(way, v, vx, vy)
    if high + longest * (longest + radius) <= 0.0:
        # behind the lens
        return math.inf
    way = (way[0] + v[0], way[1] + v[1], way[2] + v[2])
    wide = math.sqrt(dot(vx, vx)) + math.sqrt(dot(vy, vy))
    return max(0.0, math.sqrt(dot(way, way)) - wide - radius) / longest


@jitable
def lens_depths(piece: Piece, at: Vector, v: Vector, vx: Vector, vy: Vector, work: Array) -> tuple[float, float]:
    """(nearest, farthest) q at which rays at + (q - 1) v of a lens meet a piece, that of a flat one its plane.

    They begin at q = 0, so that what lies before ``at`` is met too.
    """
    least = least_depth(piece, at, v, vx, vy)
    if least == math.inf:
        return math.inf, math.inf
    if piece.kind == SPHERE:
        c = minus(vector(piece.place), at)
        near, far = sphere_reach(c, piece.radius, v, vx, vy, work)
        low, _ = linear_range(c, v, vx, vy)
        if near < math.inf and (low > 0.0 or leaves.sphere_power(*c, piece.radius) <= 0.0):
            return max(least, near + 1.0 if near > 0.0 else 0.0), far + 1.0
        # it may lie between the lens and ``at``, unless all of it is beyond
        return least if low <= 0.0 else math.inf, math.inf
    up, height = vector(piece.up), height_over(piece, at)
    low, high = linear_range(up, v, vx, vy)
    if low <= 0.0 <= high:
        return least, math.inf
    first, last = 1.0 - height / low, 1.0 - height / high
    first, last = min(first, last), max(first, last)
    if last <= 0.0:
        return math.inf, math.inf
    return (max(first, least), last) if first > 0.0 else (least, math.inf)


@jitable
def is_turned_away(world: World, j: int, at: Vector) -> bool:
    """Whether a piece is a face of a box that a place outside of the box sees from behind: never."""
    piece = world.pieces[j]
    if piece.solid == 0.0 or height_over(piece, at) > 0.0:
        return False
    for k in range(world.pieces.shape[0]):
        other = world.pieces[k]
        if other.owner == piece.owner and height_over(other, at) > 0.0:
            return True
    return False


@jitable
def within_edges(
    world: World, j: int, at: Vector, near: float, far: float, cell: Cell, work: Array
) -> tuple[float, float]:  # fmt: skip
    """The same of a flat piece that ends, ``near`` and ``far`` being those of its plane.

    It is nowhere in a cell that lies beyond one of its edges, and everywhere in one that is within all of them.
    """
    piece, v, vx, vy = world.pieces[j], cell.v, cell.vx, cell.vy
    if is_turned_away(world, j, at):
        return math.inf, math.inf
    if piece.kind != POLYGON:
        first, _ = sphere_reach(minus(vector(piece.place), at), piece.radius, v, vx, vy, work)
        return (math.inf if first == math.inf else near), math.inf
    way = 1.0 if height_over(piece, at) > 0.0 else -1.0
    last = minus(corner(piece, int(piece.count) - 1), at)
    for k in range(int(piece.count)):
        here = minus(corner(piece, k), at)
        low, high = linear_range(cross(last, here), v, vx, vy)
        # seen from above the corners go counter-clockwise, and the rays go down
        if max(-way * low, -way * high) < 0.0:
            return math.inf, math.inf
        if min(-way * low, -way * high) < 0.0:
            far = math.inf
        last = here
    return near, far


@jitable
def put_reach(eye: Eye, cell: Cell, room: Room) -> float:
    """Where every shape may be met in a cell, in ``room.reach``; returns the depth behind which nothing is seen."""
    limit = math.inf
    v, vx, vy = cell.v, cell.vx, cell.vy
    for j in range(eye.world.pieces.shape[0]):
        piece = eye.world.pieces[j]
        if eye.lobe is not None and j == eye.lobe.own:
            # a convex piece never sees itself
            room.reach[j, 0], room.reach[j, 1] = math.inf, math.inf
            continue
        if eye.domain == DISK:
            near, far = lens_depths(piece, eye.place, v, vx, vy, room.work)
        elif piece.kind == SPHERE:
            c = minus(vector(piece.place), eye.place)
            near, far = sphere_reach(c, piece.radius, v, vx, vy, room.work)
        else:
            near, far = plane_depths(vector(piece.up), height_over(piece, eye.place), v, vx, vy)
        if piece.kind not in (SPHERE, PLANE):
            if eye.lobe is not None:
                near, far = within_edges(eye.world, j, eye.place, near, far, cell, room.work)
            else:
                far = math.inf
        room.reach[j, 0], room.reach[j, 1] = near, far
        limit = min(limit, far)
    return limit * (1.0 + _MARGIN)


@inlined
def may_show(room: Room, shape: float, limit: float) -> bool:
    """Whether a shape may be seen in the cell; of none (-1) it is."""
    return shape < 0.0 or (room.reach[int(shape), 0] <= limit and room.reach[int(shape), 0] < math.inf)
