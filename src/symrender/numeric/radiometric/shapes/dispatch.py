"""What a tracer asks of any shape but a mesh, a line for each question and shape (``docs/adding-a-shape.md``).

``part`` is what of a shape was met, for shapes that need to know it where a ray leaves them; -1 of others.
"""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.numeric.planes import carried
from symrender.numeric.radiometric.shapes.box import box_area, box_distance, box_normal, box_place, box_point
from symrender.numeric.radiometric.shapes.corners import (
    corner_area,
    corner_distance,
    corner_normal,
    corner_place,
    corner_point,
)
from symrender.numeric.radiometric.shapes.cylinder import (
    cylinder_area,
    cylinder_chart,
    cylinder_distance,
    cylinder_hit,
    cylinder_point,
)
from symrender.numeric.radiometric.shapes.disk import disk_distance, disk_point, level
from symrender.numeric.radiometric.shapes.sphere import sphere_distance
from symrender.numeric.rays import sphere_offset
from symrender.numeric.vectors import Vector, along, dot, minus, triple
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import BOX, CYLINDER, DISK, MESH, RECTANGLE, SPHERE, TRIANGLE
from symrender.scene.radiometric.records import Shape
from symrender.scene.records import Frame


@jitable
def distance_to(
    shape: Shape, frame: Frame, origin: Vector, d: Vector, leaves: bool, part: int, inside: bool
) -> tuple[float, int, bool]:  # fmt: skip
    """(distance along a unit ray or inf, the part met, whether from inside) of a shape.

    A ray that ``leaves`` the shape starts on its ``part``, on the ``inside`` or not: what it starts from it does not
    meet again, whatever roundings say.
    """
    if shape.kind == SPHERE:
        reach, far = sphere_distance(shape, origin, d, leaves, inside)
        return reach, -1, far
    if shape.kind == BOX:
        if leaves and not inside:
            return math.inf, -1, False
        reach, far = box_distance(shape, origin, d, leaves)
        return reach, -1, far
    if shape.kind == CYLINDER:
        return cylinder_distance(shape, frame, origin, d, leaves, part, inside)
    if leaves or shape.kind == MESH:
        return math.inf, -1, False
    if shape.kind == PLANE:
        return level(frame, origin, d), -1, False
    if shape.kind == DISK:
        return disk_distance(frame, shape.radius, origin, d), -1, False
    return corner_distance(shape, origin, d), -1, False


@jitable
def place_at(
    shape: Shape, frame: Frame, origin: Vector, d: Vector, distance: float, part: int, far: bool
) -> tuple[Vector, Vector, bool]:  # fmt: skip
    """(place, outward unit normal, whether the ray came from behind it) of what ``distance_to`` found."""
    if shape.kind == SPHERE:
        n = sphere_offset(minus(origin, triple(shape.place)), d, shape.radius, far)
        return along(triple(shape.place), shape.radius, n), n, far
    if shape.kind == CYLINDER:
        return *cylinder_hit(shape, frame, origin, d, distance, part, far), far
    p = along(origin, distance, d)
    if shape.kind == BOX:
        return p, box_normal(shape, p), far
    if shape.kind == RECTANGLE or shape.kind == TRIANGLE:
        n = corner_normal(shape)
    else:
        n = triple(frame.up)
    return p, n, dot(n, d) > 0.0


@jitable
def texture_place(
    shape: Shape, frame: Frame, place: Vector, normal: Vector, part: int, cell: float
) -> tuple[float, float]:  # fmt: skip
    """(x, y) of the texture of a shape at a place of it, counted in cells."""
    if shape.kind == SPHERE:
        x = (math.pi + math.atan2(normal[1], normal[0])) / (math.pi * cell)
        y = math.atan2(math.sqrt(normal[0] * normal[0] + normal[1] * normal[1]), normal[2]) / (math.pi * cell)
        return x, y
    if shape.kind == BOX:
        x, y = box_place(shape, place, normal)
    elif shape.kind == CYLINDER:
        x, y = cylinder_chart(shape, frame, place, part)
    elif shape.kind == RECTANGLE or shape.kind == TRIANGLE:
        x, y = corner_place(shape, place)
    else:
        p = carried(frame, place)
        x, y = p[0], p[1]
    return x / cell, y / cell


@jitable
def area_of(shape: Shape) -> float:
    """Area of a shape that ends, other than a sphere."""
    if shape.kind == DISK:
        return math.pi * shape.radius * shape.radius
    if shape.kind == BOX:
        return box_area(shape)
    if shape.kind == CYLINDER:
        return cylinder_area(shape)
    return corner_area(shape)


@jitable
def point_on(shape: Shape, frame: Frame, a: float, b: float) -> tuple[Vector, Vector]:
    """(place, outward unit normal) on a shape that ends, other than a sphere, uniform by area."""
    if shape.kind == BOX:
        at = box_point(shape, a, b)
        return at, box_normal(shape, at)
    if shape.kind == CYLINDER:
        return cylinder_point(shape, frame, a, b)
    if shape.kind == DISK:
        return disk_point(frame, shape.radius, a, b), triple(frame.up)
    return corner_point(shape, a, b), corner_normal(shape)
