"""Rectangles, disks and boxes as Mitsuba has them: a unit shape and the matrix that puts it into the world.

Mitsuba's rectangle is the square from -1 to 1, its disk that of radius 1, both with normal z, its cube that from -1
to 1. A matrix knows a shape but for roundings, so what is written also says it in a comment, which is taken where both
agree.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.scene.mitsuba.plane import frame_of
from symrender.scene.radiometric.shapes import Box, Disk, Mesh, Plane, Rectangle, Triangle

Array = npt.NDArray[np.float64]
Flat = Rectangle | Disk | Box
FIELDS: Final = {
    "rectangle": ("corner", "edge_u", "edge_v"),
    "disk": ("center", "normal", "along", "radius"),
    "box": ("center", "size", "rotation"),
    "triangle": ("vertices",),
}
"""What a comment says of a shape, in this order."""
_MODELS: Final[dict[str, type[Rectangle | Disk | Box | Triangle]]] = {
    "rectangle": Rectangle, "disk": Disk, "box": Box, "triangle": Triangle,
}  # fmt: skip
_SAID: Final = re.compile(
    r"symrender (rectangle|disk|box|triangle): ((?:[a-z_]+(?: [-+.0-9e]{1,40}){1,9}(?:; )?){1,4})"
)
_TRIANGLE: Final = (0, 1, 2)
ROUND: Final = 1e-5
"""Relative difference up to which an ellipse is a circle: files write six digits."""
_FACES: Final = ((1, 3, 7, 5), (2, 0, 4, 6), (3, 2, 6, 7), (0, 1, 5, 4), (4, 5, 7, 6), (1, 0, 2, 3))
"""Corners of the right, left, far, near, upper and lower face of a box, as seen from outside."""
NO_BOX: Final = "no scene has other boxes"
AGREE: Final = 1e-12
"""Relative difference up to which a matrix is that of a comment."""


def said_flat(shape: Flat | Triangle) -> str:
    """The comment that names a shape."""
    parts = []
    for field in FIELDS[shape.type]:
        numbers = np.ravel(getattr(shape, field))
        parts.append(" ".join([field, *(repr(float(x)) for x in numbers)]))
    return f"symrender {shape.type}: {'; '.join(parts)}"


def told_shape(comments: Sequence[str], kind: str, name: str = "shape") -> Any | None:
    """The shape of a kind that one of some comments names, None if there is none."""
    shapes = (told_flat(comment, kind, name, "m") for comment in comments)
    return next((shape for shape in shapes if shape is not None), None)


def fields_of(shape: Flat | Triangle) -> dict[str, Any]:
    """What a comment says of a shape, as plain data."""
    return {field: np.array(getattr(shape, field)).tolist() for field in FIELDS[shape.type]}


def told_flat(comment: str, kind: str, name: str, material: str) -> Any | None:
    """The shape of this kind that a comment names; None if it names none."""
    match = _SAID.fullmatch(comment.strip())
    if match is None or match[1] != kind:
        return None
    data: dict[str, Any] = {}
    for part in match[2].split("; "):
        field, *texts = part.split(" ")
        try:
            numbers = tuple(float(text) for text in texts)
        except ValueError:
            return None
        if field == "vertices":
            data[field] = tuple(numbers[k : k + 3] for k in range(0, len(numbers), 3))
        else:
            data[field] = numbers[0] if len(numbers) == 1 else numbers
    try:
        return _MODELS[kind](name=name, material=material, **data)
    except ValueError:
        return None


def matrix_of(shape: Flat) -> Array:
    """(4, 4): the matrix that makes of Mitsuba's unit shape this one."""
    matrix = np.eye(4)
    match shape:
        case Rectangle():
            u, v = 0.5 * np.array(shape.edge_u), 0.5 * np.array(shape.edge_v)
            normal = np.cross(u, v)
            columns = (u, v, normal / np.linalg.norm(normal), np.array(shape.corner) + u + v)
        case Disk():
            plane = Plane(name="p", point=shape.center, normal=shape.normal, along=shape.along, material="m")
            east, north, up = (np.array(axis) for axis in frame_of(plane))
            columns = (shape.radius * east, shape.radius * north, up, np.array(shape.center))
        case Box():
            turn = math.radians(shape.rotation)
            c, s = math.cos(turn), math.sin(turn)
            axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
            x, y, z = (0.5 * size * axis for size, axis in zip(shape.size, axes, strict=True))
            columns = (x, y, z, np.array(shape.center))
    matrix[:3] = np.column_stack(columns)
    return matrix


def corners_of(shape: Rectangle | Triangle | Box) -> list[tuple[float, float, float]]:
    """Corners around the normal; of a box all eight, the right ones at odd places."""
    if isinstance(shape, Triangle):
        return list(shape.vertices)
    if isinstance(shape, Rectangle):
        a, u, v = (np.array(x) for x in (shape.corner, shape.edge_u, shape.edge_v))
        return [(float(p[0]), float(p[1]), float(p[2])) for p in (a, a + u, a + u + v, a + v)]
    matrix = matrix_of(shape)
    found = []
    for k in range(8):
        signs = (1.0 if k & 1 else -1.0, 1.0 if k & 2 else -1.0, 1.0 if k & 4 else -1.0)
        x, y, z = (float(c) for c in matrix[:3, :3] @ signs + matrix[:3, 3])
        found.append((x, y, z))
    return found


def mesh_places(shape: Mesh) -> list[tuple[float, float, float]]:
    """The vertices of a mesh in the world."""
    turn = math.radians(shape.rotation)
    c, s = math.cos(turn), math.sin(turn)
    rows = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    places = np.array(shape.position) + shape.scale * (np.array(shape.vertices) @ rows.T)
    return [(float(x), float(y), float(z)) for x, y, z in places]


def mesh_indices(corners: int) -> tuple[int, ...]:
    """Indices of the triangles of a triangle, a quadrilateral or a box, around their normals."""
    if corners == len(_TRIANGLE):
        return _TRIANGLE
    faces = _FACES if corners == 1 << 3 else ((0, 1, 2, 3),)
    return tuple(face[k] for face in faces for k in (0, 1, 2, 0, 2, 3))


def disk_axes(shape: Disk) -> Array:
    """(4, 4): the matrix that turns and moves a disk of its size from the plane z = 0."""
    matrix = matrix_of(shape)
    matrix[:3, :2] /= shape.radius
    return matrix


def agrees(shape: Flat, matrix: Array) -> bool:
    """Whether a matrix is that of a shape."""
    due = matrix_of(shape)
    size = np.abs(due[:3]).max()
    return bool((np.abs(matrix - due)[:3] <= AGREE * (np.abs(due[:3]) + size)).all() and (matrix[3] == due[3]).all())


def derived(kind: str, matrix: Array) -> dict[str, Any] | str:
    """The fields of the shape that a matrix makes, or why no scene has it."""
    a, b, c, at = (matrix[:3, k] for k in range(4))
    if (matrix[3] != [0.0, 0.0, 0.0, 1.0]).any():
        return "to_world must have the last row 0 0 0 1"
    side = float(np.linalg.det(matrix[:3, :3]))
    if not math.isfinite(side) or side == 0.0:
        return "to_world must have a finite determinant that is not 0"
    if kind == "rectangle":
        # a matrix that mirrors turns the normal, and so do edges that change places
        u, v = (a, b) if side > 0.0 else (b, a)
        return {"corner": _list(at - a - b), "edge_u": _list(2.0 * u), "edge_v": _list(2.0 * v)}
    lengths = [float(np.linalg.norm(axis)) for axis in (a, b, c)]
    if kind == "disk":
        if abs(a @ b) > ROUND * lengths[0] * lengths[1] or abs(lengths[0] - lengths[1]) > ROUND * lengths[0]:
            return "to_world must make a circle of the unit circle: no scene has ellipses"
        normal = np.cross(a, b) / (lengths[0] * lengths[1])
        found = {"center": _list(at), "normal": _list(normal if side > 0.0 else -normal), "along": _list(a)}
        return found | {"radius": lengths[0]}
    straight = max(abs(a[2]), abs(b[2])) <= AGREE * max(lengths) and max(abs(c[0]), abs(c[1])) <= AGREE * lengths[2]
    if not straight or abs(a @ b) > AGREE * lengths[0] * lengths[1] or side < 0.0 or c[2] < 0.0:
        return f"to_world must scale, turn about z and move, in this order: {NO_BOX}"
    turn = math.degrees(math.atan2(a[1], a[0]))
    return {"center": _list(at), "size": [2.0 * length for length in lengths], "rotation": turn}


def _list(v: Array) -> list[float]:
    return [float(x) + 0.0 for x in v]
