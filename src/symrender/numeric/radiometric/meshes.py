"""Meshes: their triangles in the world, in groups that a ray passes by or not, and where a ray meets one."""

from __future__ import annotations

import math
from typing import Annotated, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import jitable
from symrender.jit.records import Record, Table, Three, flat, table
from symrender.numeric.vectors import Vector, cross, dot, minus, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import MESH, RadiometricArrays

Ints = npt.NDArray[np.int64]

_GROUP: Final = 16
"""About how many triangles make a group."""
_LOOSE: Final = 1.0 + 1e-6
_FAR: Final = 1e-9
"""How much wider groups are taken to be than they are, by their size and by their distance."""


class Face(Record):
    """A triangle in the world, three numbers a corner."""

    corners: Annotated[Array, 9]


class Group(Record):
    """Faces from ``begin`` to ``stop`` of the mesh ``owner``, all within ``radius`` of ``center``."""

    center: Three
    radius: float
    begin: float
    stop: float
    owner: float


def laid_meshes(arrays: RadiometricArrays) -> tuple[Table[Face], Table[Group]]:
    """The faces of all meshes, those near each other one after another, and their groups."""
    corners, bundles = [np.zeros((0, 3, 3))], list[tuple[Array, float, int, int, int]]()
    count = 0
    for j, shape in enumerate(arrays.shapes):
        if shape.kind != MESH:
            continue
        own = flat(arrays.facets)[int(shape.start) : int(shape.start + shape.faces)].reshape(-1, 3)
        turn = math.radians(float(shape.rotation))
        rows = np.array(
            [[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0.0, 0.0, 1.0]]
        )
        placed = (shape.radius * (own @ rows.T) + shape.place).reshape(-1, 3, 3)
        for members in _bundled(placed.mean(axis=1), np.arange(len(placed), dtype=np.int64)):
            near = placed[members].reshape(-1, 3)
            middle = near.mean(axis=0)
            radius = float(np.sqrt(((near - middle) ** 2).sum(axis=1)).max())
            bundles.append((middle, radius, count, count + len(members), j))
            corners.append(placed[members])
            count += len(members)
    faces, groups = table(Face, count), table(Group, len(bundles))
    flat(faces)[:] = np.concatenate(corners).reshape(-1, 9)
    for group, (middle, radius, begin, stop, owner) in zip(groups, bundles, strict=True):
        group.center[:], group.radius = middle, radius
        group.begin, group.stop, group.owner = begin, stop, owner
    return faces, groups


def _bundled(places: Array, own: Ints) -> list[Ints]:
    """``own`` in parts of near places, halved across the axis along which they reach farthest."""
    if len(own) <= _GROUP:
        return [own]
    axis = int(np.argmax(np.ptp(places[own], axis=0)))
    order = own[np.argsort(places[own, axis], kind="stable")]
    half = len(order) // 2
    return [*_bundled(places, order[:half]), *_bundled(places, order[half:])]


@jitable
def passes_by(group: Group, origin: Vector, d: Vector, limit: float) -> bool:
    """Whether a unit ray meets no face of a group before ``limit``."""
    f = (group.center[0] - origin[0], group.center[1] - origin[1], group.center[2] - origin[2])
    ahead, off = dot(f, d), cross(f, d)
    wide = group.radius * _LOOSE + _FAR * (abs(f[0]) + abs(f[1]) + abs(f[2]))
    return bool(dot(off, off) > wide * wide or ahead < -wide or ahead > limit + wide)


@jitable
def sides(face: Face) -> tuple[Vector, Vector, Vector]:
    """(first corner, the two edges that leave it)."""
    c = face.corners
    a = (c[0], c[1], c[2])
    return a, minus((c[3], c[4], c[5]), a), minus((c[6], c[7], c[8]), a)


@jitable
def face_normal(face: Face) -> Vector:
    """Unit normal of a face."""
    _, u, v = sides(face)
    return unit(cross(unit(u), unit(v)))


@jitable
def face_place(face: Face, place: Vector) -> tuple[float, float]:
    """(x, y) of a place along the first edge of a face, and across it."""
    a, u, v = sides(face)
    x = unit(u)
    offset = minus(place, a)
    return dot(offset, x), dot(offset, cross(unit(cross(x, unit(v))), x))
