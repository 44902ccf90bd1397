"""Rectangles, triangles, disks and boxes of a pbrt file: meshes, and its disk."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.scene.mitsuba.flats import (
    AGREE,
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

_KINDS: Final = {3: "triangle", 4: "rectangle", 8: "box"}
"""What meshes are read, by their number of corners."""


def mesh(parameters: Parameters, at: Transform) -> tuple[dict[str, Any], Array, tuple[float, ...]]:
    """(entry, corners, chart or nothing) of a trianglemesh that is a triangle, a rectangle or a box."""
    indices = parameters.take("indices", "integer")
    given = parameters.take("P", "point3")
    charted = parameters.take("uv", "point2")
    parameters.done("indices, P and uv")
    numbers = given.numbers if given else ()
    if not numbers or len(numbers) % 3:
        raise parameters.wrong(
            "P" if given else "", f"must have P, places of three numbers, got {len(numbers)} numbers"
        )
    places = np.array([at.place((x, y, z)) for x, y, z in zip(*(numbers[k::3] for k in range(3)), strict=True)])
    kind = _KINDS.get(len(places), "")
    around = indices.numbers if indices else tuple(map(float, mesh_indices(3)))
    if not kind or around != tuple(map(float, mesh_indices(len(places)))):
        raise parameters.wrong(
            "indices" if indices else "",
            "must be one triangle (0 1 2), one parallelogram (0 1 2 0 2 3), or a box with a comment `symrender box`: "
            "other meshes are not read",
        )
    entry = _told(parameters, at, kind, places) or _derived(parameters, kind, places)
    return entry, places, charted.numbers if charted else ()


def _told(parameters: Parameters, at: Transform, kind: str, places: Array) -> dict[str, Any] | None:
    """The shape that a comment names, refused where the mesh says another one; None where there is no comment."""
    told = told_shape(parameters.directive.comments, kind)
    if told is None:
        return None
    due = np.array(corners_of(told))
    size = np.abs(due - due.mean(axis=0)).max()
    if not at.plain or (np.abs(places - due) > AGREE * (np.abs(due) + size)).any():
        raise parameters.wrong("P", f"must be the corners of the {kind} that its comment names")
    return {"type": kind, **fields_of(told)}


def _derived(parameters: Parameters, kind: str, places: Array) -> dict[str, Any]:
    if kind == "box":
        raise parameters.wrong("", "must have a comment `symrender box`: other meshes are not read")
    if kind == "triangle":
        return {"type": kind, "vertices": places.tolist()}
    a, b, c, d = places
    if (np.abs(a + c - b - d) > ROUNDING * np.abs(places).max()).any():
        raise parameters.wrong("P", "must be the corners of a parallelogram, one after the other")
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
