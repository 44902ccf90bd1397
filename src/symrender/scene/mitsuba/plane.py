"""An endless plane as Mitsuba is told of it: a large square, and a comment that says which plane it stands for.

The square says nothing that the comment does not: who reads one computes it again from the other.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from symrender.jit.records import table
from symrender.scene.frames import frames
from symrender.scene.radiometric.shapes import Plane
from symrender.scene.records import Plane as PlaneRecord

Triple = tuple[float, float, float]

_NUMBER: Final = r"(-?[0-9]{1,25}(?:[.][0-9]{0,25})?(?:e[-+]?[0-9]{1,3})?)"
_SAID: Final = re.compile(
    rf"symrender plane: point {_NUMBER} {_NUMBER} {_NUMBER}; normal {_NUMBER} {_NUMBER} {_NUMBER}; "
    rf"along {_NUMBER} {_NUMBER} {_NUMBER}"
)
_CELL: Final = re.compile(rf"symrender cell: {_NUMBER}")


def frame_of(plane: Plane) -> tuple[Triple, Triple, Triple]:
    """Unit vectors (east, north, up) of a plane."""
    row = table(PlaneRecord, 1)
    row[0].point[:], row[0].normal[:], row[0].along[:] = plane.point, plane.normal, plane.along
    (frame,) = frames(row)
    east, north, up = (tuple(float(x) for x in v) for v in (frame.east, frame.north, frame.up))
    return east, north, up  # type: ignore[return-value]


def square(plane: Plane, half: float) -> tuple[float, ...]:
    """The matrix, row by row, that makes of Mitsuba's rectangle the square of half a side ``half`` about the point."""
    east, north, up = (np.array(v) for v in frame_of(plane))
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = half * east, half * north, up, plane.point
    return tuple(float(x) for x in matrix.ravel())


def said(plane: Plane) -> str:
    """The comment that names a plane."""
    point, normal, along = (" ".join(repr(float(x)) for x in v) for v in (plane.point, plane.normal, plane.along))
    return f"symrender plane: point {point}; normal {normal}; along {along}"


def told(comment: str) -> dict[str, list[float]] | None:
    """Point, normal and along of the plane a comment names; None if it names none."""
    match = _SAID.fullmatch(comment.strip())
    if match is None:
        return None
    numbers = [float(x) for x in match.groups()]
    return {"point": numbers[:3], "normal": numbers[3:6], "along": numbers[6:]}


def said_cell(cell: float) -> str:
    """The comment that names the cell of a checker, which a scale of (u, v) says only to rounding."""
    return f"symrender cell: {float(cell)!r}"


def told_cell(comment: str) -> float | None:
    """The cell a comment names; None if it names none."""
    match = _CELL.fullmatch(comment.strip())
    return float(match[1]) if match else None
