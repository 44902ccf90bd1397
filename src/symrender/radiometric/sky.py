"""What a place sees of a constant sky and of shapes that emit: the cones of directions of the light and what hides it.

All directions above the horizon are the sky's, and every other shape hides it. Of a shape that emits only what lies
before it hides it: of a polygon what lies on the place's side of its plane, of a sphere what lies before the plane of
the circle in which it is seen, for nothing crosses the sphere. Which of two planes is met first changes across a plane
through the place, so what a flat shape hides of another is its own cone cut by one more hemisphere.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room, make_room, put_circle
from symrender.radiometric.bounds import held_by, inside_of, is_listed, next_over, outside_before
from symrender.radiometric.cones import bounds_nothing, edge_on, put_nearer, put_polygon, toward_plane
from symrender.radiometric.pieces import CORNERS, FACES, POLYGON, Piece, corner, same
from symrender.radiometric.region import open_irradiance
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Vector, cross, dot, minus, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK, SPHERE

_CLEAR: Final = 1e-9
"""Sine below the horizon beyond which a direction is below it, whatever was rounded."""
_HIDDEN: Final = -1
"""What stands for the count of arcs where nothing is seen."""


def sky_room(world: World) -> Room:
    """Room for what a place sees of a light."""
    polygons = sum(1 for piece in world.pieces if piece.kind == POLYGON)
    count = len(world.pieces) + 1
    # a sphere that emits has its own circle and two horizons
    return make_room(count, 2 * count + CORNERS * (polygons + 1) + 2, len(world.bounds))


@jitable
def faces_away(world: World, own: int, front: bool, place: Vector, j: int) -> bool:
    """Whether other faces of the box that face j belongs to hide all that it hides."""
    if turned_away(world, own, front, j):
        return True
    piece = world.pieces[j]
    if piece.solid == 0.0 or height_over(piece, place) >= 0.0:
        return False
    first = j - int(piece.face)
    before = False
    for k in range(first, first + FACES):
        before = before or (k != own and height_over(world.pieces[k], place) > 0.0)
    return before


@jitable
def sunk(world: World, own: int, place: Vector, normal: Vector, piece: Piece) -> bool:
    """Whether a polygon is below the horizon but for vertices that it shares with the polygon ``own``."""
    left = world.pieces[own]
    for k in range(int(piece.count)):
        there, shared = corner(piece, k), False
        for m in range(int(left.count)):
            shared = shared or same(there, corner(left, m))
        at = minus(there, place)
        if not (shared or dot(normal, at) < -_CLEAR * (abs(at[0]) + abs(at[1]) + abs(at[2]))):
            return False
    return piece.count > 0.0


@jitable
def shows(
    world: World, own: int, front: bool, place: Vector, normal: Vector, j: int, far: float, direction: Vector
) -> int:  # fmt: skip
    """Which side of flat piece j shows to a place, 1 that of its normal and -1 the other; 0 where it hides nothing.

    What lies in, or on, the plane ``far`` along ``direction`` is what may be hidden.
    """
    piece = world.pieces[j]
    if piece.kind != PLANE and (
        (height_over(piece, place) < 0.0 and outside_before(piece, place, far, direction))
        or sunk(world, own, place, normal, piece)
        or edge_on(piece, place)
        or faces_away(world, own, front, place, j)
    ):
        return 0
    return 1 if height_over(piece, place) > 0.0 else -1


@jitable
def begin_listing(room: Room, count: int) -> None:
    """Forget what was listed; the first ``count`` arcs are those of the light."""
    for c in range(room.side.shape[0]):
        room.side[c], room.begin[c], room.stop[c] = 0.0, 0.0, 0.0
    room.stop[0] = 1.0 * count


@jitable
def end_listing(world: World, room: Room, count: int) -> None:
    """Note how many arcs there are, and which bounds hold listed pieces."""
    room.used[0] = 1.0 * count
    last = world.bounds.shape[0] - 1
    for back in range(last + 1):
        k = last - back
        room.nodes[k] = 1.0 if is_listed(world.bounds, k, room.side, room.nodes) else 0.0


@inlined
def mark(room: Room, listed: int, j: int, side: int) -> int:
    """List piece j, unless its ``side`` is 0; returns how many are listed."""
    if side == 0:
        return listed
    room.side[1 + j], room.listed[listed] = 1.0 * side, 1.0 * j
    return listed + 1


@jitable
def put_piece(world: World, j: int, place: Vector, room: Room, count: int) -> int:
    """Add the arcs that bound the cone of listed piece j; returns how many arcs there are."""
    piece = world.pieces[j]
    if piece.kind == SPHERE:
        x, y, z, cosine, sine = leaves.sphere_cap(*minus(vector(piece.place), place), piece.radius)
        return put_circle(room, count, 1 + j, (x, y, z), cosine, sine)
    if piece.kind == PLANE:
        _, way = toward_plane(piece, place)
        return put_circle(room, count, 1 + j, way, 0.0, 1.0)
    return put_polygon(room, count, 1 + j, piece, place)


@inlined
def is_bumped(world: World, own: int) -> bool:
    """Whether a piece's material turns its normals."""
    return world.materials[int(world.pieces[own].material)].terms != 0.0


@jitable
def gather_sky(
    world: World, own: int, front: bool, place: Vector, normal: Vector, turned: Vector, room: Room
) -> int:  # fmt: skip
    """List the sky and what hides it from a place of piece ``own``; returns how many arcs.

    The count is negative where all of the sky is hidden.
    """
    count, listed, none = put_circle(room, 0, 0, normal, 0.0, 1.0), 0, (0.0, 0.0, 0.0)
    if is_bumped(world, own):
        count = put_circle(room, count, 0, turned, 0.0, 1.0)
    begin_listing(room, count)
    node = next_over(world.pieces, world.bounds, 0, place, normal, none, -1.0, 0.0, math.inf, none)
    while node < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, node)):
            j = held_by(world.bounds, node, m)
            piece = world.pieces[j]
            if piece.kind == SPHERE:
                if j == own:
                    if not front:
                        return _HIDDEN
                    continue
                if leaves.sphere_power(*minus(vector(piece.place), place), piece.radius) <= 0.0:
                    return _HIDDEN
                listed = mark(room, listed, j, 1)
            elif j != own:
                listed = mark(room, listed, j, shows(world, own, front, place, normal, j, math.inf, none))
        node = next_over(world.pieces, world.bounds, node + 1, place, normal, none, -1.0, 0.0, math.inf, none)
    for k in range(listed):
        j = int(room.listed[k])
        if not bounds_nothing(room, j, world.pieces[j]):
            room.begin[1 + j] = 1.0 * count
            count = put_piece(world, j, place, room, count)
            room.stop[1 + j] = 1.0 * count
    end_listing(world, room, count)
    return count


@jitable
def sides(piece: Piece, place: Vector, direction: Vector, far: float) -> tuple[bool, bool]:
    """Whether some of a polygon or a disk lies before the plane ``far`` along a direction, and some beyond it."""
    if piece.kind == DISK:
        middle = dot(minus(vector(piece.place), place), direction)
        across = cross(vector(piece.up), direction)
        reach = piece.radius * math.sqrt(dot(across, across))
        return middle - reach < far, middle + reach >= far
    before, beyond = False, False
    for k in range(int(piece.count)):
        if dot(minus(corner(piece, k), place), direction) < far:
            before = True
        else:
            beyond = True
    return before, beyond


@jitable
def shows_before(
    world: World, own: int, front: bool, place: Vector, normal: Vector, j: int, far: float, direction: Vector
) -> int:  # fmt: skip
    """``shows`` of what flat piece j hides of what lies in, or on, the plane ``far`` along a unit ``direction``."""
    piece = world.pieces[j]
    if piece.kind != PLANE:
        before, _ = sides(piece, place, direction, far)
        if not before:
            return 0
    return shows(world, own, front, place, normal, j, far, direction)


@jitable
def put_before(
    world: World, j: int, place: Vector, far: float, direction: Vector, ball: bool, room: Room, count: int
) -> int:  # fmt: skip
    """Add the arcs that bound what listed piece j hides of what lies in the plane ``far`` along a unit ``direction``.

    Of a ``ball``, which no sphere crosses, whole spheres hide.
    """
    piece, cone = world.pieces[j], 1 + j
    if piece.kind == SPHERE:
        offset = minus(vector(piece.place), place)
        count = put_piece(world, j, place, room, count)
        if not ball and dot(offset, direction) - far > -piece.radius:
            way = vector(room.arcs[count - 1].axis)
            near = leaves.polar_distance(dot(offset, offset), piece.radius)
            count = put_nearer(room, count, cone, near, way, far, direction)
        return count
    near, way = toward_plane(piece, place)
    if piece.kind == PLANE:
        return put_nearer(room, count, cone, near, way, far, direction)
    count = put_polygon(room, count, cone, piece, place)
    _, beyond = sides(piece, place, direction, far)
    if beyond:
        count = put_nearer(room, count, cone, near, way, far, direction)
    return count


@jitable
def put_all(
    world: World, listed: int, place: Vector, far: float, direction: Vector, ball: bool, room: Room, count: int
) -> int:  # fmt: skip
    """Add the arcs of all listed pieces; returns how many arcs there are."""
    for k in range(listed):
        j = int(room.listed[k])
        if bounds_nothing(room, j, world.pieces[j]):
            _, beyond = sides(world.pieces[j], place, direction, far)
            if not beyond:
                continue
        room.begin[1 + j] = 1.0 * count
        count = put_before(world, j, place, far, direction, ball, room, count)
        room.stop[1 + j] = 1.0 * count
    end_listing(world, room, count)
    return count


@jitable
def some_place(piece: Piece) -> Vector:
    """A place of a polygon or a disk."""
    if piece.kind == DISK:
        return vector(piece.place)
    return corner(piece, 0)


@jitable
def cone_of(piece: Piece, place: Vector) -> tuple[Vector, float, float]:
    """(unit axis, cosine, sine) of a cone in which a polygon or a disk is seen; the cosine is -1 if there is none."""
    middle = vector(piece.place)
    for k in range(int(piece.count)):
        if k == 0:
            middle = (0.0, 0.0, 0.0)
        c, share = corner(piece, k), 1.0 / piece.count
        middle = (middle[0] + share * c[0], middle[1] + share * c[1], middle[2] + share * c[2])
    reach = piece.radius * piece.radius
    for k in range(int(piece.count)):
        out = minus(corner(piece, k), middle)
        reach = max(reach, dot(out, out))
    way = minus(middle, place)
    far = dot(way, way)
    if reach >= far:
        return (0.0, 0.0, 0.0), -1.0, 0.0
    size = math.sqrt(far)
    return (way[0] / size, way[1] / size, way[2] / size), math.sqrt((far - reach) / far), math.sqrt(reach / far)


@jitable
def gather_polygon(
    world: World, own: int, front: bool, lamp: int, place: Vector, normal: Vector, turned: Vector, room: Room
) -> int:  # fmt: skip
    """List the polygon or disk ``lamp`` and what hides it, as ``gather_sky`` lists the sky.

    No sphere meets it. One that crosses its plane hides the part of its circle that lies before the plane.
    """
    light = world.pieces[lamp]
    if height_over(light, place) <= 0.0 or edge_on(light, place) or light.owner == world.pieces[own].owner:
        return _HIDDEN
    far, direction = toward_plane(light, place)
    above, below = sides(light, place, minus_of(normal), 0.0)
    if not above:
        return _HIDDEN
    count, listed = put_polygon(room, 0, 0, light, place), 0
    if below:
        count = put_circle(room, count, 0, normal, 0.0, 1.0)
    if is_bumped(world, own):
        above, below = sides(light, place, minus_of(turned), 0.0)
        if not above:
            return _HIDDEN
        if below:
            count = put_circle(room, count, 0, turned, 0.0, 1.0)
    begin_listing(room, count)
    axis, cosine, sine = cone_of(light, place)
    node = next_over(world.pieces, world.bounds, 0, place, normal, axis, cosine, sine, far, direction)
    while node < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, node)):
            j = held_by(world.bounds, node, m)
            piece = world.pieces[j]
            if piece.kind == SPHERE:
                offset = minus(vector(piece.place), place)
                power = leaves.sphere_power(*offset, piece.radius)
                encloses = leaves.sphere_power(*minus(vector(piece.place), some_place(light)), piece.radius) < 0.0
                inside = not front if j == own else power < 0.0
                if encloses != inside:
                    return _HIDDEN
                if j != own and not encloses and dot(offset, direction) - far < piece.radius:
                    listed = mark(room, listed, j, 1)
            elif j != own and piece.owner != light.owner:
                listed = mark(room, listed, j, shows_before(world, own, front, place, normal, j, far, direction))
        node = next_over(world.pieces, world.bounds, node + 1, place, normal, axis, cosine, sine, far, direction)
    return put_all(world, listed, place, far, direction, False, room, count)


@jitable
def gather_sphere(
    world: World, own: int, front: bool, lamp: int, place: Vector, normal: Vector, turned: Vector, room: Room
) -> int:  # fmt: skip
    """List sphere ``lamp`` and what hides it, as ``gather_sky`` lists the sky.

    The sphere crosses no other shape. Of two spheres apart from each other the one of less power is before the other,
    for what lies between them is the plane of equal powers.
    """
    light = world.pieces[lamp]
    offset = minus(vector(light.place), place)
    whole = leaves.sphere_power(*offset, light.radius)
    if whole <= 0.0 or own == lamp:
        return _HIDDEN
    x, y, z, cosine, sine = leaves.sphere_cap(*offset, light.radius)
    direction = (x, y, z)
    far = leaves.polar_distance(dot(offset, offset), light.radius)
    count, listed = put_circle(room, 0, 0, normal, 0.0, 1.0), 0
    count = put_circle(room, count, 0, direction, cosine, sine)
    if is_bumped(world, own):
        count = put_circle(room, count, 0, turned, 0.0, 1.0)
    begin_listing(room, count)
    node = next_over(world.pieces, world.bounds, 0, place, normal, direction, cosine, sine, far, direction)
    while node < world.bounds.shape[0]:
        for m in range(inside_of(world.bounds, node)):
            j = held_by(world.bounds, node, m)
            piece = world.pieces[j]
            if j == lamp:
                continue
            if piece.kind == SPHERE:
                power = leaves.sphere_power(*minus(vector(piece.place), place), piece.radius)
                apart = minus(vector(piece.place), vector(light.place))
                encloses = leaves.sphere_power(*apart, piece.radius) < 0.0
                inside = not front if j == own else power < 0.0
                if encloses != inside:
                    return _HIDDEN
                if j != own and not encloses and power < whole:
                    listed = mark(room, listed, j, 1)
            elif j != own and piece.kind == PLANE:
                if height_over(piece, place) * height_over(piece, vector(light.place)) < 0.0:
                    return _HIDDEN
            elif j != own:
                listed = mark(room, listed, j, shows_before(world, own, front, place, normal, j, far, direction))
        node = next_over(world.pieces, world.bounds, node + 1, place, normal, direction, cosine, sine, far, direction)
    return put_all(world, listed, place, far, direction, True, room, count)


@inlined
def counting(world: World, own: int, normal: Vector, turned: Vector) -> Vector:
    """The normal by whose cosine light counts that arrives at a piece."""
    return normal if world.materials[int(world.pieces[own].material)].geometric != 0.0 else turned


@jitable
def sky_irradiance(
    world: World, own: int, front: bool, place: Vector, normal: Vector, turned: Vector, room: Room
) -> float:  # fmt: skip
    """Irradiance of a place by a sky of radiance 1, pi where nothing hides it."""
    count = gather_sky(world, own, front, place, normal, turned, room)
    return open_irradiance(world, room, place, count, counting(world, own, normal, turned))


@jitable
def area_irradiance(
    world: World, own: int, front: bool, emitter: int, place: Vector, normal: Vector, turned: Vector, room: Room
) -> float:  # fmt: skip
    """Irradiance of a place by shape ``emitter``, of radiance 1."""
    total, upward = 0.0, counting(world, own, normal, turned)
    for lamp in range(world.pieces.shape[0]):
        light = world.pieces[lamp]
        if int(light.owner) != emitter:
            continue
        if light.kind == SPHERE:
            count = gather_sphere(world, own, front, lamp, place, normal, turned, room)
        else:
            count = gather_polygon(world, own, front, lamp, place, normal, turned, room)
        total += open_irradiance(world, room, place, count, upward)
    return total
