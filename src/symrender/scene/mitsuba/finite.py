"""A flat shape that ends, of a Mitsuba file: by its comment where its matrix agrees, else by its matrix."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from symrender.scene.mitsuba.flats import AGREE, NO_BOX, agrees, derived, fields_of, told_shape
from symrender.scene.mitsuba.properties import Properties


def flat_fields(
    properties: Properties, comments: Sequence[str], kind: str, rows: Sequence[float]
) -> dict[str, Any] | None:
    """The fields of a rectangle, disk or box whose matrix has these rows; None of a cube that is no such box."""
    matrix = np.array(rows).reshape(4, 4)
    shape = told_shape(comments, kind)
    if shape is None:
        made = derived(kind, matrix)
        if isinstance(made, str) and kind == "box" and made.endswith(NO_BOX):
            return None
        if isinstance(made, str):
            raise properties.wrong(made)
        return made
    if not agrees(shape, matrix):
        raise properties.wrong(f"its to_world is not that of the {kind} that its comment names")
    return fields_of(shape)


def check_chart(
    properties: Properties, kind: str, fields: dict[str, Any], scales: Sequence[float], cell: float
) -> None:  # fmt: skip
    """Refuse a checker whose chart on this shape is another in a scene."""
    if kind != "rectangle":
        raise properties.wrong(f"a checker on a {kind} has another chart here")
    u, v = (np.array(fields[edge]) for edge in ("edge_u", "edge_v"))
    sides = float(np.linalg.norm(u)), float(np.linalg.norm(v))
    if abs(u @ v) > AGREE * sides[0] * sides[1]:
        raise properties.wrong("a checker needs edges at right angles: it has another chart here")
    if any(abs(x * 2.0 * cell - side) > AGREE * side for x, side in zip(scales, sides, strict=True)):
        raise properties.wrong("its to_uv is not that of a checker of the cell that its comment names")
