"""Rectangles, triangles, disks and boxes of a pbrt file: meshes, and its disk."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.scene.mitsuba.flats import (
    AGREE,
    ROUND,
    Array,
    corners_of,
    derived,
    disk_axes,
    fields_of,
    mesh_indices,
    told_shape,
)  # fmt: skip
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import ROUNDING, Transform

Ints = npt.NDArray[np.int64]
_FEW: Final = 64
"""Most faces of a mesh whose normals are compared with them."""
_STRAIGHT: Final = 1e-6
_KINDS: Final = {3: "triangle", 4: "rectangle", 8: "box"}
"""What meshes are read, by their number of corners."""


@dataclass(frozen=True)
class Triangles:
    """A mesh as it stands in the world: corners (n, 3), faces (m, 3), and (u, v) and normals of corners, or None."""

    places: Array
    faces: Ints
    chart: Array | None = None
    normals: Array | None = None

    def entry(self) -> dict[str, Any]:
        """As fields of a mesh."""
        made: dict[str, Any] = {"type": "mesh", "vertices": self.places.tolist(), "faces": self.faces.tolist()}
        if self.chart is not None:
            made["uv"] = self.chart.tolist()
        if self.normals is not None:
            made |= {"normals": self.normals.tolist(), "shading_normals": "use"}
        return made


def read_triangles(parameters: Parameters, at: Transform, turned: bool) -> Triangles:
    """The mesh of a trianglemesh or a bilinearmesh, its faces around the side that pbrt takes for outside."""
    quads = parameters.directive.strings[0] == "bilinearmesh"
    numbers = _rows(parameters, "P", 3, "point3", "point")
    if numbers is None:
        raise parameters.wrong("", "must have P, places of three numbers")
    chart = next(
        (rows for name in ("uv", "st") if (rows := _rows(parameters, name, 2, "point2", "float")) is not None), None
    )
    normals = _rows(parameters, "N", 3, "normal", "normal3")
    _rows(parameters, "S", 3, "vector3", "vector")
    alpha = parameters.directive.parameters.get("alpha")
    if alpha is not None and alpha.numbers == (1.0,):
        parameters.passed("alpha")
    parameters.passed("faceIndices", "emissionfilename")
    given = parameters.take("indices", "integer")
    parameters.done("indices, P, N and uv")
    corners = 4 if quads else 3
    around = given.numbers if given else tuple(map(float, range(corners)))
    if len(around) % corners or not around:
        raise parameters.wrong("indices", f"must be {corners} a face, got {len(around)}")
    if min(around) < 0.0 or max(around) >= len(numbers):
        raise parameters.wrong("indices", f"must name some of the {len(numbers)} places, from 0")
    faces = np.array(around, dtype=np.int64).reshape(-1, corners)
    with np.errstate(all="ignore"):
        places = numbers @ at.matrix[:3, :3].T + at.matrix[:3, 3] if not at.plain else numbers
    if quads:
        faces = _halved(parameters, faces, places)
    if normals is not None:
        normals = _turned_normals(parameters, normals, at, turned)
        normals = None if _are_flat(places, faces, normals) else normals
    if (normals is None) and turned != at.mirrors:
        faces = faces[:, ::-1]
    elif normals is not None:
        arms = places[faces]
        outside = np.cross(arms[:, 1] - arms[:, 0], arms[:, 2] - arms[:, 0])
        back = (outside * normals[faces].sum(axis=1)).sum(axis=1) < 0.0
        faces = np.where(back[:, None], faces[:, ::-1], faces)
    for rows, name in ((chart, "uv"), (normals, "N")):
        if rows is not None and len(rows) != len(places):
            raise parameters.wrong(name, f"must be one for each of {len(places)} places, got {len(rows)}")
    return Triangles(places, faces, chart, normals)


def _rows(parameters: Parameters, name: str, width: int, *kinds: str) -> Array | None:
    found = parameters.take(name, *kinds)
    if found is None:
        return None
    if not found.numbers or len(found.numbers) % width:
        raise parameters.wrong(name, f"must be rows of {width} numbers, got {len(found.numbers)} numbers")
    return np.array(found.numbers).reshape(-1, width)


def _turned_normals(parameters: Parameters, normals: Array, at: Transform, turned: bool) -> Array:
    try:
        made: Array = normals @ np.linalg.inv(at.matrix[:3, :3])
    except np.linalg.LinAlgError:
        raise parameters.wrong("", "must stand where a transform can be undone") from None
    return -made if turned else made


def _are_flat(places: Array, faces: Ints, normals: Array) -> bool:
    """Whether normals are those of the faces, so that they say nothing but on which side these are."""
    if len(normals) != len(places) or len(faces) > _FEW:
        return False
    arms = places[faces]
    with np.errstate(all="ignore"):
        outside = np.cross(arms[:, 1] - arms[:, 0], arms[:, 2] - arms[:, 0])
        outside /= np.linalg.norm(outside, axis=1, keepdims=True)
        unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        cosine = np.einsum("fi,fki->fk", outside, unit[faces])
    return bool((cosine > 1.0 - _STRAIGHT).all())


def _halved(parameters: Parameters, faces: Ints, places: Array) -> Ints:
    """Two triangles for each patch of four corners, which must be flat."""
    a, b, c, d = (places[faces[:, k]] for k in range(4))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    off = np.abs(((d - a) * normal).sum(axis=1))
    if (off > ROUND * size * np.sqrt(size)).any():
        raise parameters.wrong("P", "must be flat patches: bilinear ones that bend are not read")
    halves: Ints = np.concatenate([faces[:, (0, 1, 3)], faces[:, (0, 3, 2)]])
    return halves


def as_flat(parameters: Parameters, at: Transform, mesh: Triangles) -> dict[str, Any] | None:
    """The triangle, rectangle or box that a mesh is, by its comment, or by its corners; None where it is none."""
    kind = _KINDS.get(len(mesh.places), "")
    faces = [*mesh.faces.ravel().tolist()]
    turned = [*mesh.faces[:, ::-1].ravel().tolist()]
    if not kind or mesh.normals is not None or list(mesh_indices(len(mesh.places))) not in (faces, turned):
        return None
    told = told_shape(parameters.directive.comments, kind)
    if told is not None:
        due = np.array(corners_of(told))
        size = np.abs(due - due.mean(axis=0)).max()
        if not at.plain or (np.abs(mesh.places - due) > AGREE * (np.abs(due) + size)).any():
            raise parameters.wrong("P", f"must be the corners of the {kind} that its comment names")
        return {"type": kind, **fields_of(told)}
    if kind == "triangle":
        return {"type": kind, "vertices": mesh.places[mesh.faces[0]].tolist()}
    a, b, c, d = mesh.places[:4]
    if kind == "box" or (np.abs(a + c - b - d) > ROUNDING * np.abs(mesh.places).max()).any():
        return None
    if faces == turned or list(mesh_indices(4)) == turned:
        b, d = d, b
    return {"type": kind, "corner": a.tolist(), "edge_u": (b - a).tolist(), "edge_v": (d - a).tolist()}


def disk(parameters: Parameters, at: Transform) -> dict[str, Any]:
    """The entry of a whole disk."""
    radius, height = parameters.number("radius", 1.0), parameters.number("height", 0.0)
    parameters.must("innerradius", parameters.number("innerradius", 0.0), 0.0, "rings are not read")
    parameters.must("phimax", parameters.number("phimax", 360.0), 360.0, "parts of disks are not read")
    parameters.done("radius and height")
    told = told_shape(parameters.directive.comments, "disk")
    if told is not None:
        due = disk_axes(told)
        near = np.abs(at.matrix - due) <= AGREE * (np.abs(due) + 1.0)
        if height != 0.0 or radius != told.radius or not near.all():
            raise parameters.wrong("", "must be the disk that its comment names")
        return {"type": "disk", **fields_of(told)}
    matrix = at.matrix.copy()
    matrix[:3, 3] += height * matrix[:3, 2]
    matrix[:3, :2] *= radius
    found = derived("disk", matrix) if math.isfinite(radius) and radius > 0.0 else "must have a radius > 0 and finite"
    if isinstance(found, str):
        raise parameters.wrong("", found.replace("to_world ", ""))
    return {"type": "disk", **found}
