"""What only the path tracer reads of a scene: images of textures and skies, and what vertices of meshes have.

The (u, v) of a texture and the directions of a map are turned into the coordinates of an image by a ``Picture``, whose
texels stand in one list of all images. Images are stored once, whatever number of textures and lights show them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Final

import numpy as np
import numpy.typing as npt

from symrender.images.srgb import decode_srgb
from symrender.jit.records import Record, Table, table
from symrender.scene.pictures import picture
from symrender.scene.radiometric.lights import Environment
from symrender.scene.radiometric.shapes import Mesh
from symrender.scene.radiometric.shapes import Shape as ShapePart
from symrender.scene.radiometric.textures import Checkerboard, Image

Array = npt.NDArray[np.float64]

# between centres of pixels
NEAREST: Final = 0
BILINEAR: Final = 1

# beyond the unit square
REPEAT: Final = 0
CLAMP: Final = 1
MIRROR: Final = 2
_WRAPS: Final = {"repeat": REPEAT, "clamp": CLAMP, "mirror": MIRROR}

# grids of a map of directions
CORNERS: Final = 0
CENTRES: Final = 1
EQUAL_AREA: Final = 2


class Picture(Record):
    """An image of ``wide`` x ``high`` texels from ``start`` of the list on, row by row, and how it is asked.

    Of a texture ``affine`` takes (u, v, 1) to its coordinates, two rows of three; of a map of directions ``turn`` takes
    directions of the world to its own, three rows of three, and ``grid`` says where its texels lie.
    """

    start: float
    wide: float
    high: float
    filter: float
    wrap: float
    grid: float
    affine: Annotated[Array, 6]
    turn: Annotated[Array, 9]


@dataclass(frozen=True)
class Detail:
    """Pictures, the texels (T, 3) of their images, and of every facet (F) coordinates (F, 6) and normals (F, 9).

    Coordinates and normals are those of the three corners, in the mesh's own coordinates. They have no rows where no
    mesh has any; a mesh without normals has zeros, one without coordinates barycentric ones.
    """

    pictures: Table[Picture] = field(default_factory=lambda: table(Picture, 0))
    texels: Array = field(default_factory=lambda: np.zeros((0, 3)))
    coordinates: Array = field(default_factory=lambda: np.zeros((0, 6)))
    normals: Array = field(default_factory=lambda: np.zeros((0, 9)))


class Gallery:
    """Pictures in the order in which they are hung, and the images they show."""

    def __init__(self) -> None:
        self._rows: list[Table[Picture]] = []
        self._images: dict[tuple[str, bool], tuple[int, Array]] = {}
        self._count = 0

    def hang(self, part: Image | Environment | Checkerboard) -> int:
        """Add the picture of a texture or a light, and return its index."""
        row = table(Picture, 1)
        it = row[0]
        if not isinstance(part, Checkerboard):
            start, image = self._image(part.data, isinstance(part, Environment) or part.encoding == "srgb")
            it.start, it.high, it.wide = start, image.shape[0], image.shape[1]
            it.filter = NEAREST if part.filter == "nearest" else BILINEAR
        if isinstance(part, Environment):
            it.grid = EQUAL_AREA if part.layout == "equal_area" else CENTRES if part.rows == "centres" else CORNERS
            it.turn[:] = turned(part).T.ravel()
        else:
            it.wrap = _WRAPS[part.wrap] if isinstance(part, Image) else REPEAT
            angle = math.radians(part.rotation)
            c, s = math.cos(angle), math.sin(angle)
            (p, q), (x, y) = part.scale, part.offset
            it.affine[:] = (p * c, -p * s, x, q * s, q * c, y)
        self._rows.append(row)
        return len(self._rows) - 1

    def _image(self, data: str, decoded: bool) -> tuple[int, Array]:
        values, coded = picture(data)
        key = (data, decoded and coded)
        if key not in self._images:
            image = decode_srgb(values) if key[1] else values
            self._images[key] = (self._count, image)
            self._count += image.shape[0] * image.shape[1]
        return self._images[key]

    def detail(self, shapes: Sequence[ShapePart], facets: int) -> Detail:
        """All of it, with what the vertices of meshes have, ``facets`` of them in all."""
        pictures = table(Picture, len(self._rows))
        for k, row in enumerate(self._rows):
            pictures[k] = row[0]
        texels = [image.reshape(-1, 3) for _, image in self._images.values()]
        return Detail(
            pictures, np.concatenate(texels) if texels else np.zeros((0, 3)), *of_vertices(shapes, facets)
        )  # fmt: skip


def turned(part: Environment) -> Array:
    """The rotation (3, 3) that takes directions of a map to the world: the nearest one to what is written."""
    u, _, v = np.linalg.svd(np.array(part.to_world))
    angle = math.radians(part.rotation)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(u @ v @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def of_vertices(shapes: Sequence[ShapePart], facets: int) -> tuple[Array, Array]:
    """Coordinates and normals of the corners of all facets, without rows where no mesh has any."""
    meshes = [shape for shape in shapes if isinstance(shape, Mesh)]
    coordinates = np.zeros((facets if any(mesh.uv for mesh in meshes) else 0, 6))
    normals = np.zeros((facets if any(mesh.shading_normals == "use" for mesh in meshes) else 0, 9))
    coordinates[:] = (0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
    start = 0
    for mesh in meshes:
        here = slice(start, start + len(mesh.faces))
        start += len(mesh.faces)
        if mesh.uv:
            coordinates[here] = np.array(mesh.uv)[np.array(mesh.uv_faces or mesh.faces)].reshape(-1, 6)
        if mesh.shading_normals == "use" and mesh.normals:
            normals[here] = np.array(mesh.normals)[np.array(mesh.normal_faces or mesh.faces)].reshape(-1, 9)
        elif mesh.shading_normals == "use":
            normals[here] = _computed(mesh)
    return coordinates, normals


def _computed(mesh: Mesh) -> Array:
    """Normals (F, 9) of the corners of faces: sums of those about a vertex, each times its angle, as Mitsuba's.

    Vertices of one place are two where their texture coordinates differ.
    """
    faces = np.array(mesh.faces)
    if mesh.uv_faces:
        pairs = np.stack([faces.ravel(), np.array(mesh.uv_faces).ravel()], axis=1)
        faces = np.unique(pairs, axis=0, return_inverse=True)[1].reshape(-1, 3)
    corners = np.array(mesh.vertices)[np.array(mesh.faces)]
    ahead = np.roll(corners, -1, axis=1) - corners
    ahead /= np.linalg.norm(ahead, axis=2, keepdims=True)
    back = -np.roll(ahead, 1, axis=1)
    across = np.cross(ahead[:, 0], back[:, 0])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    # the angle of two unit vectors without the loss of an arc cosine
    angles = 2.0 * np.arctan2(np.linalg.norm(ahead - back, axis=2), np.linalg.norm(ahead + back, axis=2))
    sums = np.zeros((int(faces.max()) + 1, 3))
    np.add.at(sums, faces.ravel(), (angles[..., None] * across[:, None]).reshape(-1, 3))
    return np.asarray(sums[faces].reshape(-1, 9))
