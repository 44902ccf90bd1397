"""What the shapes of a scene are made of: planes, spheres, polygons and disks, a box of six polygons, a mesh of many.

Kernels see pieces alone. A piece of a flat shape knows its frame and its corners; neighbouring faces of a box or a mesh
have corners of the same bits, so that a ray between them meets one of both.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Record, Table, Three, table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.vectors import Array, Vector, minus, vector
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import BOX, DISK, MESH, RECTANGLE, SPHERE, RadiometricArrays
from symrender.scene.radiometric.records import Facet, Shape
from symrender.scene.records import Frame

Ints = npt.NDArray[np.int64]

# kinds of a piece, beside PLANE, SPHERE and DISK
POLYGON: Final = 3

FACES: Final = 6
CORNERS: Final = 4
"""Most corners of a piece."""
_FLAT: Final = 1e-13
"""Rise of a corner over a face, in parts of the size of a mesh, which roundings may be."""
_IN_BOX: Final = 8
"""Corners of the smallest boxes."""
_DEEP: Final = 64
"""Boxes that wait to be looked at: two a halving."""
_BITS: Final = 20
"""Bits of a coordinate that order places."""


class Piece(Record):
    """A PLANE, a SPHERE, a POLYGON of ``corners`` or a DISK; ``owner`` is the shape it belongs to.

    ``place`` is the origin of the texture, of a sphere and a disk the centre; ``up``, ``east`` and ``north`` are the
    unit axes of what is flat. The ``count`` corners of a polygon, three numbers each, go counter-clockwise about up.
    ``beside`` is, of the edge that leaves each of them, the one polygon that has the same edge the other way round, -1
    if there is none or several. Of a face of a box ``solid`` is 1 and ``face`` its number; of a disk that sends
    light ``face`` is how many corners the polygon has that stands for it. Of a face of a closed mesh
    the whole mesh lies within ``reach`` of ``middle``; of other pieces the reach is 0. Pieces of one ``body``, a number
    from 1 on, are the faces of a box or of a closed convex mesh; of others it is 0.
    """

    kind: float
    owner: float
    material: float
    place: Three
    up: Three
    count: float
    beside: Annotated[Array, 4]
    reach: float
    body: float
    solid: float
    face: float
    middle: Three
    radius: float
    east: Three
    north: Three
    corners: Annotated[Array, 12]


def piece_count(shapes: Table[Shape]) -> int:
    """How many pieces shapes are made of."""
    return sum(pieces_of(shape) for shape in shapes)


@jitable
def pieces_of(shape: Shape) -> int:
    """How many pieces a shape is made of."""
    if shape.kind == MESH:
        return int(shape.faces)
    return FACES if shape.kind == BOX else 1


def laid_pieces(arrays: RadiometricArrays) -> Table[Piece]:
    """The pieces of the shapes of a scene, in their order."""
    pieces = table(Piece, piece_count(arrays.shapes))
    _kernel()(arrays.shapes, arrays.facets, arrays.frames, pieces)
    _join(pieces)
    solid, belongs = np.asarray(pieces["solid"]) != 0.0, owners(pieces)
    np.asarray(pieces["body"])[solid] = 1.0 + belongs[solid]
    for j, shape in enumerate(arrays.shapes):
        if shape.kind == MESH:
            _enclose(pieces, np.nonzero(belongs == j)[0], 1.0 + j)
    return pieces


def _enclose(pieces: Table[Piece], own: Ints, body: float) -> None:
    """Write about what the faces ``own`` of a mesh lie, if it is closed: each of their edges is that of two of them.

    Where no corner rises over any of the faces they are those of a ``body``.
    """
    if not np.isin(np.asarray(pieces["beside"])[own, :3], own).all():
        return
    corners = np.asarray(pieces["corners"])[own].reshape(len(own), CORNERS, 3)[:, :3]
    middle = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
    np.asarray(pieces["middle"])[own] = middle
    reach = float(np.sqrt(((corners - middle) ** 2).sum(axis=2).max()))
    np.asarray(pieces["reach"])[own] = reach
    places = np.unique(corners.reshape(-1, 3), axis=0) - middle
    ups = np.asarray(pieces["up"])[own]
    levels = (ups * (corners[:, 0] - middle)).sum(axis=1)
    if _is_convex(ups, levels, places, reach):
        np.asarray(pieces["body"])[own] = body


def _is_convex(ups: Array, levels: Array, places: Array, reach: float) -> bool:
    """Whether no place rises over any of the planes.

    Places are halved over and over into boxes, and a plane is compared with those alone that may rise over it: of a
    convex mesh they are few about each face.
    """
    depth = max(0, math.ceil(math.log2(len(places) / _IN_BOX)))
    # the last place is repeated, so that all boxes of a row of the tree hold as many
    order = _by_place(places)[np.minimum(np.arange(_IN_BOX << depth), len(places) - 1)]
    filled = np.ascontiguousarray(places[order])
    low = high = filled.reshape(-1, _IN_BOX, 3)
    boxes = [np.concatenate([low.min(axis=1), high.max(axis=1)], axis=1)]
    while len(boxes[-1]) > 1:
        low, high = boxes[-1][:, :3].reshape(-1, 2, 3), boxes[-1][:, 3:].reshape(-1, 2, 3)
        boxes.append(np.concatenate([low.min(axis=1), high.max(axis=1)], axis=1))
    # node k has the children 2 k + 1 and 2 k + 2
    tree = np.concatenate(boxes[::-1])
    return not _rising_kernel()(ups, levels, tree, filled, _FLAT * reach, np.zeros(_DEEP, np.int64))


@lru_cache(maxsize=1)
def _rising_kernel() -> Any:
    return compiled(rises_over, _nrt=False)


@inlined
def height(up: Array, x: float, y: float, z: float) -> float:
    """Height of a place along a normal."""
    found: float = up[0] * x + up[1] * y + up[2] * z
    return found


def rises_over(ups: Array, levels: Array, tree: Array, places: Array, most: float, stack: Ints) -> bool:
    """Whether one of ``places`` rises over a plane by more than ``most``; ``tree`` holds the boxes about them."""
    inner = tree.shape[0] // 2
    for i in range(ups.shape[0]):
        up, level = ups[i], levels[i]
        stack[0], waiting = 0, 1
        while waiting > 0:
            waiting -= 1
            k, box = stack[waiting], tree[stack[waiting]]
            # the corner farthest along the normal; roundings are far below a quarter of ``most``
            x = box[3] if up[0] > 0.0 else box[0]
            y = box[4] if up[1] > 0.0 else box[1]
            z = box[5] if up[2] > 0.0 else box[2]
            if height(up, x, y, z) - level <= 0.75 * most:
                continue
            if k < inner:
                stack[waiting], stack[waiting + 1] = 2 * k + 1, 2 * k + 2
                waiting += 2
                continue
            for j in range(_IN_BOX * (k - inner), _IN_BOX * (k - inner + 1)):
                if height(up, places[j, 0], places[j, 1], places[j, 2]) - level > most:
                    return True
    return False


def _by_place(places: Array) -> Ints:
    """An order in which near places follow each other: along the curve of the bits of their coordinates (Z order)."""
    low = places.min(axis=0)
    wide = max(float((places.max(axis=0) - low).max()), 1e-300)
    cells = ((places - low) / wide * (2**_BITS - 1)).astype(np.int64)
    codes = np.zeros(len(places), np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            codes |= (cells[:, axis] >> bit & 1) << (3 * bit + axis)
    return np.argsort(codes, kind="stable")


def _join(pieces: Table[Piece]) -> None:
    """Write which polygons lie beside the edges of each."""
    beside, counts = np.asarray(pieces["beside"]), np.asarray(pieces["count"]).astype(np.int64)
    beside[:] = -1.0
    polygons = np.asarray(pieces["kind"]) == POLYGON
    corners = np.asarray(pieces["corners"]).reshape(-1, 3)
    # equal places, zeros of both signs too, are one vertex
    names = np.unique(corners + 0.0, axis=0, return_inverse=True)[1].reshape(-1, CORNERS)
    k = np.arange(CORNERS)
    edges = polygons[:, None] & (k < counts[:, None])
    following = np.take_along_axis(names, np.where(k + 1 < counts[:, None], k + 1, 0), axis=1)
    span = int(names.max(initial=0)) + 1
    forth, back = (names * span + following)[edges], (following * span + names)[edges]
    known, first, times = np.unique(forth, return_index=True, return_counts=True)
    at = np.minimum(np.searchsorted(known, back), max(len(known) - 1, 0))
    own = np.searchsorted(known, forth)
    single = (known[at] == back) & (times[at] == 1) & (times[own] == 1) if len(known) else np.zeros(0, np.bool_)
    owners_of = np.nonzero(edges)[0]
    beside[edges] = np.where(single, owners_of[first[at]], -1) if len(known) else beside[edges]


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


@inlined
def same(a: Vector, b: Vector) -> bool:
    """Whether two vertices are one."""
    return a[0] == b[0] and a[1] == b[1] and a[2] == b[2]


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


@jitable
def lay_facet(shape: Shape, facet: Facet, piece: Piece) -> None:
    """Write a triangle of a mesh."""
    ax, ay, az, bx, by, bz = leaves.box_axes(shape.rotation)
    size = (shape.radius, shape.radius, shape.radius)
    piece.count = 3.0
    for k in range(3):
        at = (facet.corners[3 * k], facet.corners[3 * k + 1], facet.corners[3 * k + 2])
        x, y, z = leaves.box_corner(*vector(shape.place), *size, ax, ay, az, bx, by, bz, *at)
        put_corner(piece.corners, k, (x, y, z))
    lay_frame(piece)


def lay_pieces(
    shapes: Table[Shape], facets: Table[Facet], frames: Table[Frame], pieces: Table[Piece]
) -> None:  # fmt: skip
    """Write the pieces of all shapes; row j of ``frames`` says where a plane or a disk lies."""
    k = 0
    for j in range(shapes.shape[0]):
        shape = shapes[j]
        for face in range(pieces_of(shape)):
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
                if shape.kind == MESH:
                    lay_facet(shape, facets[int(shape.start) + face], piece)
                elif shape.kind == BOX:
                    piece.solid, piece.face = 1.0, 1.0 * face
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


def owners(pieces: Table[Piece]) -> Ints:
    """The shape that every piece belongs to."""
    return np.asarray(pieces["owner"]).astype(np.int64)
