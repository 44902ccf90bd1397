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
from symrender.radiometric.bounds import clear_within, held_by, inside_of, next_over
from symrender.radiometric.cones import bounds_nothing, edge_on, put_convex, put_nearer, put_polygon, toward_plane
from symrender.radiometric.listing import begin_listing, end_leaf, end_listing, list_beside, mark, shows_in, sides
from symrender.radiometric.pieces import CORNERS, POLYGON, Piece, corner
from symrender.radiometric.region import open_irradiance
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Vector, dot, minus, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK, SPHERE

_HIDDEN: Final = -1
"""What stands for the count of arcs where nothing is seen."""


def sky_room(world: World) -> Room:
    """Room for what a place sees of a light."""
    polygons = sum(1 for piece in world.pieces if piece.kind == POLYGON)
    count = len(world.pieces) + 1
    # a sphere that emits has its own circle and two horizons; what bounds a body may be had twice
    return make_room(count, 2 * count + 2 * CORNERS * (polygons + 1) + 2, len(world.bounds))


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
    node = next_over(world.pieces, world.bounds, room.nodes, 0, place, normal, none, -1.0, 0.0, math.inf, none)
    while node < world.bounds.shape[0]:
        clear, before = clear_within(world.pieces, world.bounds, node, place, normal, math.inf, none), listed
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
                listed = mark(room, listed, j, shows_in(world, own, front, place, normal, j, clear, math.inf, none))
        end_leaf(room, node, listed - before)
        node = next_over(
            world.pieces, world.bounds, room.nodes, node + 1, place, normal, none, -1.0, 0.0, math.inf, none
        )
    listed = list_beside(world, own, front, place, normal, room, listed, math.inf, none)
    for k in range(listed):
        j = int(room.listed[k])
        if world.pieces[j].body != 0.0:
            count = put_convex(room, count, 1 + j, world.pieces[j], place)
        elif not bounds_nothing(room, j, world.pieces[j]):
            room.begin[1 + j] = 1.0 * count
            count = put_piece(world, j, place, room, count)
            room.stop[1 + j] = 1.0 * count
    end_listing(world, room, count)
    return count


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
        body = world.pieces[j].body != 0.0
        if body or bounds_nothing(room, j, world.pieces[j]):
            _, beyond = sides(world.pieces[j], place, direction, far)
            if not beyond:
                if body:
                    count = put_convex(room, count, 1 + j, world.pieces[j], place)
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


@inlined
def one_body(world: World, j: int, k: int) -> bool:
    """Whether two pieces are faces of one box or one closed convex mesh, of which none sees or hides another."""
    return world.pieces[j].body != 0.0 and world.pieces[j].body == world.pieces[k].body


@jitable
def gather_polygon(
    world: World, own: int, front: bool, lamp: int, place: Vector, normal: Vector, turned: Vector, room: Room
) -> int:  # fmt: skip
    """List the polygon or disk ``lamp`` and what hides it, as ``gather_sky`` lists the sky.

    No sphere meets it. One that crosses its plane hides the part of its circle that lies before the plane.
    """
    light = world.pieces[lamp]
    if height_over(light, place) <= 0.0 or edge_on(light, place) or own == lamp or one_body(world, own, lamp):
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
    node = next_over(world.pieces, world.bounds, room.nodes, 0, place, normal, axis, cosine, sine, far, direction)
    while node < world.bounds.shape[0]:
        clear, before = clear_within(world.pieces, world.bounds, node, place, normal, far, direction), listed
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
            elif j != own and j != lamp and not one_body(world, j, lamp):
                listed = mark(room, listed, j, shows_in(world, own, front, place, normal, j, clear, far, direction))
        end_leaf(room, node, listed - before)
        node = next_over(
            world.pieces, world.bounds, room.nodes, node + 1, place, normal, axis, cosine, sine, far, direction
        )
    listed = list_beside(world, own, front, place, normal, room, listed, far, direction)
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
    node = next_over(world.pieces, world.bounds, room.nodes, 0, place, normal, direction, cosine, sine, far, direction)
    while node < world.bounds.shape[0]:
        clear, before = clear_within(world.pieces, world.bounds, node, place, normal, far, direction), listed
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
                listed = mark(room, listed, j, shows_in(world, own, front, place, normal, j, clear, far, direction))
        end_leaf(room, node, listed - before)
        node = next_over(
            world.pieces, world.bounds, room.nodes, node + 1, place, normal, direction, cosine, sine, far, direction
        )
    listed = list_beside(world, own, front, place, normal, room, listed, far, direction)
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
