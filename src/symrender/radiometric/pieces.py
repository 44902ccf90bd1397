"""What the shapes of a scene are made of: planes, spheres, polygons and disks, a box of six polygons.

Kernels see pieces alone. A piece of a flat shape knows its frame and its corners; neighbouring faces of a box have
corners of the same bits, so that a ray between them meets one of both.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Record, Table, Three, table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.vectors import Array, Vector, minus, vector
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import BOX, DISK, RECTANGLE, SPHERE
from symrender.scene.radiometric.records import Shape
from symrender.scene.records import Frame

# kinds of a piece, beside PLANE, SPHERE and DISK
POLYGON: Final = 3

FACES: Final = 6
CORNERS: Final = 4
"""Most corners of a piece."""


class Piece(Record):
    """A PLANE, a SPHERE, a POLYGON of ``corners`` or a DISK; ``owner`` is the shape it belongs to.

    ``place`` is the origin of the texture, of a sphere and a disk the centre; ``up``, ``east`` and ``north`` are the
    unit axes of what is flat. The ``count`` corners of a polygon, three numbers each, go counter-clockwise about up.
    """

    kind: float
    owner: float
    material: float
    place: Three
    up: Three
    east: Three
    north: Three
    radius: float
    count: float
    corners: Annotated[Array, 12]


def piece_count(shapes: Table[Shape]) -> int:
    """How many pieces shapes are made of."""
    return sum(FACES if shape.kind == BOX else 1 for shape in shapes)


def laid_pieces(shapes: Table[Shape], frames: Table[Frame]) -> Table[Piece]:
    """The pieces of shapes, in their order; row j of ``frames`` says where a plane or a disk lies."""
    pieces = table(Piece, piece_count(shapes))
    _kernel()(shapes, frames, pieces)
    return pieces


@lru_cache(maxsize=1)
def _kernel() -> Any:
    # the kernel only borrows arrays
    return compiled(lay_pieces, _nrt=False)


@inlined
def put(three: Array, v: Vector) -> None:
    """Write a vector of a record."""
    three[0], three[1], three[2] = v


@jitable
def put_corner(corners: Array, k: int, v: Vector) -> None:
    """Write a corner of a polygon."""
    corners[3 * k], corners[3 * k + 1], corners[3 * k + 2] = v


@inlined
def corner(piece: Piece, k: int) -> Vector:
    """A corner of a polygon."""
    return (piece.corners[3 * k], piece.corners[3 * k + 1], piece.corners[3 * k + 2])


@jitable
def lay_frame(piece: Piece) -> None:
    """Write frame and origin of a polygon from its first, second and last corner."""
    a, b, c = corner(piece, 0), corner(piece, 1), corner(piece, int(piece.count) - 1)
    x, y, z, ex, ey, ez, nx, ny, nz = leaves.flat_frame(*minus(b, a), *minus(c, a))
    put(piece.place, a)
    put(piece.up, (x, y, z))
    put(piece.east, (ex, ey, ez))
    put(piece.north, (nx, ny, nz))


@jitable
def lay_face(shape: Shape, face: int, piece: Piece) -> None:
    """Write a face of a box: its right, left, far, near, upper and lower one, along x, y and z of the box."""
    ax, ay, az, bx, by, bz = leaves.box_axes(shape.rotation)
    axis = face // 2
    side = 0.5 if face % 2 == 0 else -0.5
    piece.count = 4.0
    for k in range(4):
        # from the corner of the texture's origin, counter-clockwise as seen from outside
        u = 0.5 if k == 1 or k == 2 else -0.5
        v = 0.5 if k >= 2 else -0.5
        if axis == 0:
            place = (side, 2.0 * side * u, v)
        elif axis == 1:
            place = (-2.0 * side * u, side, v)
        else:
            place = (2.0 * side * u, v, side)
        x, y, z = leaves.box_corner(*vector(shape.place), *vector(shape.second), ax, ay, az, bx, by, bz, *place)
        put_corner(piece.corners, k, (x, y, z))
    lay_frame(piece)


def lay_pieces(shapes: Table[Shape], frames: Table[Frame], pieces: Table[Piece]) -> None:
    """Write the pieces of all shapes."""
    k = 0
    for j in range(shapes.shape[0]):
        shape = shapes[j]
        for face in range(FACES if shape.kind == BOX else 1):
            piece = pieces[k]
            piece.owner, piece.material = 1.0 * j, shape.material
            if shape.kind == SPHERE:
                piece.kind, piece.radius = SPHERE, shape.radius
                put(piece.place, vector(shape.place))
            elif shape.kind == PLANE or shape.kind == DISK:
                frame = frames[j]
                piece.kind, piece.radius = shape.kind, shape.radius
                put(piece.place, vector(frame.origin))
                put(piece.up, vector(frame.up))
                put(piece.east, vector(frame.east))
                put(piece.north, vector(frame.north))
            else:
                piece.kind = POLYGON
                a, b, c = vector(shape.place), vector(shape.second), vector(shape.third)
                if shape.kind == BOX:
                    lay_face(shape, face, piece)
                else:
                    put_corner(piece.corners, 0, a)
                    if shape.kind == RECTANGLE:
                        x, y, z = leaves.opposite_corner(*a, *b, *c)
                        put_corner(piece.corners, 1, (a[0] + b[0], a[1] + b[1], a[2] + b[2]))
                        put_corner(piece.corners, 2, (x, y, z))
                        put_corner(piece.corners, 3, (a[0] + c[0], a[1] + c[1], a[2] + c[2]))
                    else:
                        put_corner(piece.corners, 1, b)
                        put_corner(piece.corners, 2, c)
                    piece.count = 4.0 if shape.kind == RECTANGLE else 3.0
                    lay_frame(piece)
            k += 1


def owners(pieces: Table[Piece]) -> np.ndarray[Any, np.dtype[np.int64]]:
    """The shape that every piece belongs to."""
    return np.asarray(pieces["owner"]).astype(np.int64)
