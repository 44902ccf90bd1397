"""A scene with some of its values changed, by dotted name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from symrender.scene.document import Document, Path
from symrender.scene.names import resolve
from symrender.scene.plain import plain
from symrender.scene.validate import validated
from symrender.scene.values import Part

_P = TypeVar("_P", bound=Part)


def replace(scene: _P, changes: Mapping[str, object]) -> _P:
    """``scene`` with ``changes``, validated as a whole; SceneError for an unknown name or a wrong value.

    Keys are dotted names (``spheres.B.radius``, ``spheres[1].radius``), values are numbers, vectors, choices, text,
    whole parts as dicts or parts, or None: ``{"floor.lobe.exponent": 64, "camera.eye": (3, -3, 2),
    "floor.lobe": None}``. Changes are applied in order, so a later name may lie inside an earlier part. A name that
    no longer holds after a change (a renamed sphere) is unknown.
    """
    data = scene.model_dump(mode="python")
    data = plain(data)
    labels: dict[Path, str] = {}
    for name, change in changes.items():
        path, _ = resolve(type(scene), data, name)
        holder = data
        for step in path[:-1]:
            holder = holder[step]
        holder[path[-1]] = plain(change, name)
        labels[path] = name
    return validated(type(scene), Document(data, labels=labels))
