"""Meshes: their triangles in the world, their normals and the places of their textures."""

from __future__ import annotations

import math
from typing import Annotated, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import jitable
from symrender.jit.records import Record, Table, flat, table
from symrender.numeric.radiometric.hierarchy import STACK, Blade, Pairs, laid_hierarchy
from symrender.numeric.radiometric.shapes.corners import edge_shares
from symrender.numeric.vectors import Vector, cross, dot, minus, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import MESH, RadiometricArrays

Ints = npt.NDArray[np.int64]

_GROUP: Final = 16
"""Faces that follow each other in the order of their file."""
_SORTED: Final = 100_000
"""Most faces of a mesh that are put in an order of places, which takes 20 s for 10^6; the hierarchy needs none."""


class Face(Record):
    """A triangle in the world, three numbers a corner, of the shape ``owner``."""

    corners: Annotated[Array, 9]
    owner: float


def laid_meshes(arrays: RadiometricArrays) -> tuple[Table[Face], Table[Blade], Pairs, Array, Array, Array, Array]:
    """The faces of all meshes, their hierarchy, what a walk notes, and coordinates and normals of their corners."""
    count = len(arrays.facets)
    faces, placed, order = table(Face, count), np.zeros((count, 3, 3)), np.zeros(count, np.int64)
    normals = arrays.detail.normals
    turned = np.zeros_like(normals)
    for j, shape in enumerate(arrays.shapes):
        if shape.kind != MESH:
            continue
        here = slice(int(shape.start), int(shape.start + shape.faces))
        turn = math.radians(float(shape.rotation))
        rows = np.array(
            [[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0.0, 0.0, 1.0]]
        )
        own = flat(arrays.facets)[here].reshape(-1, 3)
        there = (shape.radius * (own @ rows.T) + shape.place).reshape(-1, 3, 3)
        near = _by_place(there.mean(axis=1))
        placed[here], order[here] = there[near], here.start + near
        flat(faces)[here, 9] = j
        if len(normals):
            turned[here] = (normals[order[here]].reshape(-1, 3) @ rows.T).reshape(-1, 9)
    flat(faces)[:, :9] = placed.reshape(-1, 9)
    coordinates = arrays.detail.coordinates
    return (
        faces, *laid_hierarchy(placed), np.zeros((STACK, 3)),
        coordinates[order] if len(coordinates) else coordinates, turned,
    )  # fmt: skip


def _by_place(places: Array) -> Ints:
    """The order of faces in which near ones follow each other: halved over and over across the longest axis."""
    if len(places) > _SORTED:
        return np.arange(len(places), dtype=np.int64)
    parts, found = [np.arange(len(places), dtype=np.int64)], list[Ints]()
    while parts:
        own = parts.pop()
        if len(own) <= _GROUP:
            found.append(own)
            continue
        axis = int(np.argmax(np.ptp(places[own], axis=0)))
        order = own[np.argsort(places[own, axis], kind="stable")]
        half = len(order) // 2
        parts += [order[half:], order[:half]]
    return np.concatenate(found)


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


@jitable
def smooth_normal(face: Face, normals: Array, place: Vector, facing: Vector) -> Vector:
    """Unit normal between those of the corners of a face, ``facing`` where they are zero."""
    corner, u, v = sides(face)
    a, b = edge_shares(corner, u, v, place)
    c = 1.0 - a - b
    n = (
        c * normals[0] + a * normals[3] + b * normals[6],
        c * normals[1] + a * normals[4] + b * normals[7],
        c * normals[2] + a * normals[5] + b * normals[8],
    )
    return unit(n) if dot(n, n) > 0.0 else facing
