"""How a mesh's file is read, as a scene says: its matrix, its normals, which mesh of the file, which way it faces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from symrender.errors import SceneError
from symrender.scene.printable import shown

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

PLACING: Final = ("to_world", "vertex_normals", "flip_faces", "flip_v", "keeps_side", "turn_bare", "part", "format")
"""Fields next to ``file`` that say how it is read."""
_NORMALS: Final = ("none", "file", "smooth")
_MATRIX: Final = 16
_MOST: Final = 1 << 16


def checked(how: Mapping[str, Any]) -> None:
    """Raise SceneError naming the field that is wrong."""
    matrix = how.get("to_world")
    numbers = isinstance(matrix, list | tuple) and all(type(x) in (int, float) and math.isfinite(x) for x in matrix)
    if matrix is not None and not (numbers and len(matrix) == _MATRIX and list(matrix[12:]) == [0, 0, 0, 1]):
        raise SceneError("to_world: must be 16 finite numbers, row by row, the last four 0, 0, 0, 1")
    for name in ("flip_faces", "flip_v", "keeps_side", "turn_bare"):
        if type(how.get(name, False)) is not bool:
            raise SceneError(f"{name}: must be true or false, got {shown(how[name])}")
    if how.get("vertex_normals", "none") not in _NORMALS:
        raise SceneError(f"vertex_normals: must be {', '.join(_NORMALS)}, got {shown(how['vertex_normals'])}")
    part = how.get("part", 0)
    if type(part) is not int or not 0 <= part < _MOST:
        raise SceneError(f"part: must be a whole number from 0, got {shown(part)}")


def placed(fields: dict[str, Any], how: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of a mesh, as read, put where they are due."""
    if not how:
        return fields
    import numpy as np

    made = dict(fields)
    normals = np.array(made["normals"], dtype=np.float64) if made.get("normals") else None
    # faces without normals turn over in a mirror image
    turned = bool(how.get("flip_faces", False)) != (normals is None and bool(how.get("turn_bare", False)))
    if (rows := how.get("to_world")) is not None:
        matrix = np.array(rows, dtype=np.float64).reshape(4, 4)
        with np.errstate(all="ignore"):
            places = np.array(made["vertices"], dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        if not np.isfinite(places).all():
            raise SceneError("to_world: must leave coordinates finite")
        made["vertices"] = places.tolist()
        side = float(np.linalg.det(matrix[:3, :3]))
        if normals is not None and not abs(side) > 0.0:
            raise SceneError("to_world: must have a determinant that is not 0")
        # normals that the file has keep their side where a matrix mirrors, in pbrt faces too
        if normals is not None:
            normals = normals @ np.linalg.inv(matrix[:3, :3])
        if normals is not None or how.get("keeps_side"):
            turned ^= side < 0.0
    if how.get("flip_v") and made.get("uv"):
        made["uv"] = [(u, 1.0 - v) for u, v in made["uv"]]
    if turned:
        for name in ("faces", "uv_faces", "normal_faces"):
            if made.get(name):
                made[name] = [tuple(face)[::-1] for face in made[name]]
    if how.get("flip_faces") and normals is not None:
        normals = -normals
    if how.get("vertex_normals", "file") == "none":
        return made
    if normals is not None:
        made |= {"normals": normals.tolist(), "shading_normals": "use"}
    elif how.get("vertex_normals") == "smooth":
        # those of the faces about each vertex (``radiometric/detail.py``)
        made["shading_normals"] = "use"
    return made
