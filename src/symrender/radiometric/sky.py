"""What a place sees of a constant sky and of shapes that emit: the cones of directions of the light and what hides it.

All directions above the horizon are the sky's, and every other shape hides it. Of a shape that emits only what lies
before it hides it: of a polygon what lies on the place's side of its plane, of a sphere what lies before the plane of
the circle in which it is seen, for nothing crosses the sphere. Which of two planes is met first changes across a plane
through the place, so what a flat shape hides of another is its own cone cut by one more hemisphere.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room, make_room, open_irradiance, put_circle, put_edge, put_rim
from symrender.radiometric.pieces import CORNERS, POLYGON, Piece, corner
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Vector, cross, dot, minus, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK, SPHERE

_HIDDEN: Final = -1
"""What stands for the count of arcs where nothing is seen."""
_EDGE_ON: Final = 1e-15
"""Height over a polygon's plane, in parts of the distance, below which it is seen edge on and hides nothing."""


def sky_room(world: World) -> Room:
    """Room for what a place sees of a light."""
    polygons = sum(1 for piece in world.pieces if piece.kind == POLYGON)
    count = len(world.pieces) + 1
    return make_room(count, 2 * count + CORNERS * (polygons + 1))


@jitable
def edge_on(piece: Piece, place: Vector) -> bool:
    """Whether a polygon or a disk is seen from its own plane."""
    far = piece.radius
    if piece.kind == DISK:
        v = minus(vector(piece.place), place)
        far = max(far, abs(v[0]), max(abs(v[1]), abs(v[2])))
    for k in range(int(piece.count)):
        v = minus(corner(piece, k), place)
        far = max(far, abs(v[0]), max(abs(v[1]), abs(v[2])))
    return abs(height_over(piece, place)) <= _EDGE_ON * far


@jitable
def put_polygon(room: Room, count: int, cone: int, piece: Piece, place: Vector) -> int:
    """Add the edges of a polygon, or the rim of a disk, to a cone; returns how many arcs there are."""
    if piece.kind == DISK:
        _, way = toward_plane(piece, place)
        return put_rim(room, count, cone, minus(vector(piece.place), place), way, vector(piece.east), piece.radius)
    above = height_over(piece, place) > 0.0
    corners = int(piece.count)
    for k in range(corners):
        here, other = corner(piece, k), corner(piece, (k + 1) % corners)
        # from above, corners that go counter-clockwise about the normal go clockwise
        if above:
            here, other = other, here
        count = put_edge(room, count, cone, minus(here, place), minus(other, here))
    return count


@jitable
def put_nearer(
    room: Room, count: int, cone: int, near: float, way: Vector, far: float, direction: Vector
) -> int:  # fmt: skip
    """Add to a cone the hemisphere that meets the plane ``near`` along ``way`` before that ``far`` along another."""
    x, y, z = leaves.nearer(near, *way, far, *direction)
    size = math.sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return count
    return put_circle(room, count, cone, (x / size, y / size, z / size), 0.0, 1.0)


@jitable
def toward_plane(piece: Piece, place: Vector) -> tuple[float, Vector]:
    """(distance, unit direction) from a place to the plane of a flat piece."""
    height = height_over(piece, place)
    up = vector(piece.up)
    return abs(height), (minus_of(up) if height >= 0.0 else up)


@jitable
def faces_away(world: World, own: int, front: bool, place: Vector, j: int) -> bool:
    """Whether other faces of the box that face j belongs to hide all that it hides."""
    if turned_away(world, own, front, j):
        return True
    piece = world.pieces[j]
    if height_over(piece, place) >= 0.0:
        return False
    for k in range(world.pieces.shape[0]):
        other = world.pieces[k]
        if other.owner == piece.owner and k != own and height_over(other, place) > 0.0:
            return True
    return False


@jitable
def gather_sky(world: World, own: int, front: bool, place: Vector, normal: Vector, room: Room) -> tuple[int, int]:
    """List the sky and what hides it from a place of piece ``own``; returns how many arcs and cones.

    The count of arcs is negative where all of the sky is hidden.
    """
    count, cones = put_circle(room, 0, 0, normal, 0.0, 1.0), 1
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if j == own:
            if piece.kind == SPHERE and not front:
                return _HIDDEN, 0
            continue
        if piece.kind == SPHERE:
            offset = minus(vector(piece.place), place)
            if leaves.sphere_power(*offset, piece.radius) <= 0.0:
                return _HIDDEN, 0
            x, y, z, cosine, sine = leaves.sphere_cap(*offset, piece.radius)
            count = put_circle(room, count, cones, (x, y, z), cosine, sine)
        elif piece.kind == PLANE:
            _, way = toward_plane(piece, place)
            count = put_circle(room, count, cones, way, 0.0, 1.0)
        else:
            if edge_on(piece, place) or faces_away(world, own, front, place, j):
                continue
            count = put_polygon(room, count, cones, piece, place)
        cones += 1
    return count, cones


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
def put_flat(
    world: World, own: int, front: bool, j: int, place: Vector, far: float, direction: Vector, room: Room, count: int,
    cone: int,
) -> int:  # fmt: skip
    """Add what flat piece j hides of what lies in, or on, the plane ``far`` along a unit ``direction``."""
    piece = world.pieces[j]
    near, way = toward_plane(piece, place)
    if piece.kind == PLANE:
        return put_nearer(room, count, cone, near, way, far, direction)
    before, beyond = sides(piece, place, direction, far)
    if not before or edge_on(piece, place) or faces_away(world, own, front, place, j):
        return count
    count = put_polygon(room, count, cone, piece, place)
    if beyond:
        count = put_nearer(room, count, cone, near, way, far, direction)
    return count


@jitable
def some_place(piece: Piece) -> Vector:
    """A place of a polygon or a disk."""
    if piece.kind == DISK:
        return vector(piece.place)
    return corner(piece, 0)


@jitable
def gather_polygon(
    world: World, own: int, front: bool, lamp: int, place: Vector, normal: Vector, room: Room
) -> tuple[int, int]:  # fmt: skip
    """List the polygon or disk ``lamp`` and what hides it, as ``gather_sky`` lists the sky.

    No sphere meets it. One that crosses its plane hides the part of its circle that lies before the plane.
    """
    light = world.pieces[lamp]
    if height_over(light, place) <= 0.0 or edge_on(light, place) or light.owner == world.pieces[own].owner:
        return _HIDDEN, 0
    far, direction = toward_plane(light, place)
    above, below = sides(light, place, minus_of(normal), 0.0)
    if not above:
        return _HIDDEN, 0
    count, cones = put_polygon(room, 0, 0, light, place), 1
    if below:
        count = put_circle(room, count, 0, normal, 0.0, 1.0)
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        before = count
        if piece.kind == SPHERE:
            offset = minus(vector(piece.place), place)
            power = leaves.sphere_power(*offset, piece.radius)
            encloses = leaves.sphere_power(*minus(vector(piece.place), some_place(light)), piece.radius) < 0.0
            inside = not front if j == own else power < 0.0
            if encloses != inside:
                return _HIDDEN, 0
            beyond = dot(offset, direction) - far
            if j == own or encloses or beyond >= piece.radius:
                continue
            x, y, z, cosine, sine = leaves.sphere_cap(*offset, piece.radius)
            count = put_circle(room, count, cones, (x, y, z), cosine, sine)
            if beyond > -piece.radius:
                near = leaves.polar_distance(dot(offset, offset), piece.radius)
                count = put_nearer(room, count, cones, near, (x, y, z), far, direction)
        elif j != own and piece.owner != light.owner:
            count = put_flat(world, own, front, j, place, far, direction, room, count, cones)
        if count > before:
            cones += 1
    return count, cones


@jitable
def gather_sphere(
    world: World, own: int, front: bool, lamp: int, place: Vector, normal: Vector, room: Room
) -> tuple[int, int]:  # fmt: skip
    """List sphere ``lamp`` and what hides it, as ``gather_sky`` lists the sky.

    The sphere crosses no other shape. Of two spheres apart from each other the one of less power is before the other,
    for what lies between them is the plane of equal powers.
    """
    light = world.pieces[lamp]
    offset = minus(vector(light.place), place)
    whole = leaves.sphere_power(*offset, light.radius)
    if whole <= 0.0 or own == lamp:
        return _HIDDEN, 0
    x, y, z, cosine, sine = leaves.sphere_cap(*offset, light.radius)
    direction = (x, y, z)
    far = leaves.polar_distance(dot(offset, offset), light.radius)
    count = put_circle(room, 0, 0, normal, 0.0, 1.0)
    count, cones = put_circle(room, count, 0, direction, cosine, sine), 1
    for j in range(world.pieces.shape[0]):
        if j == lamp:
            continue
        piece = world.pieces[j]
        before = count
        if piece.kind == SPHERE:
            way = minus(vector(piece.place), place)
            power = leaves.sphere_power(*way, piece.radius)
            encloses = leaves.sphere_power(*minus(vector(piece.place), vector(light.place)), piece.radius) < 0.0
            inside = not front if j == own else power < 0.0
            if encloses != inside:
                return _HIDDEN, 0
            if j != own and not encloses and power < whole:
                x, y, z, cosine, sine = leaves.sphere_cap(*way, piece.radius)
                count = put_circle(room, count, cones, (x, y, z), cosine, sine)
        elif j != own and piece.kind == PLANE:
            if height_over(piece, place) * height_over(piece, vector(light.place)) < 0.0:
                return _HIDDEN, 0
        elif j != own:
            count = put_flat(world, own, front, j, place, far, direction, room, count, cones)
        if count > before:
            cones += 1
    return count, cones


@jitable
def sky_irradiance(world: World, own: int, front: bool, place: Vector, normal: Vector, room: Room) -> float:
    """Irradiance of a place by a sky of radiance 1, pi where nothing hides it."""
    count, cones = gather_sky(world, own, front, place, normal, room)
    return open_irradiance(room, count, cones, normal)


@jitable
def area_irradiance(
    world: World, own: int, front: bool, emitter: int, place: Vector, normal: Vector, room: Room
) -> float:  # fmt: skip
    """Irradiance of a place by shape ``emitter``, of radiance 1."""
    total = 0.0
    for lamp in range(world.pieces.shape[0]):
        light = world.pieces[lamp]
        if int(light.owner) != emitter:
            continue
        if light.kind == SPHERE:
            count, cones = gather_sphere(world, own, front, lamp, place, normal, room)
        else:
            count, cones = gather_polygon(world, own, front, lamp, place, normal, room)
        total += open_irradiance(room, count, cones, normal)
    return total
