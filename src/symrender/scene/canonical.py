"""The canonical form of a scene and its hash."""

from __future__ import annotations

import hashlib
import json
from typing import Any, Final

from symrender.scene.pictures import KINDS, digest
from symrender.scene.values import Part

_OF_VERTICES: Final = ("uv", "uv_faces", "normals", "normal_faces")
"""Fields of a mesh that are empty where its file says nothing of them."""
_CORNERS: Final = ("faces", "uv_faces", "normal_faces")
_NUMBERS: Final = ("vertices", *_CORNERS, "uv", "normals")
"""Fields of a mesh that hold numbers alone."""


def _canonical(value: Any) -> Any:
    if isinstance(value, float):
        return (value + 0.0).hex()  # -0.0 + 0.0 is 0.0
    if isinstance(value, dict):
        # millions of whole numbers are as they are
        return {key: entry if key in _CORNERS else _canonical(entry) for key, entry in value.items()}
    return [_canonical(entry) for entry in value] if isinstance(value, tuple) else value


def _said(value: Any) -> Any:
    """``value`` without notes, and without what is not there: lens, motion, bumps, coordinates and normals of vertices.

    An image file is its SHA-256.
    """
    if isinstance(value, tuple):
        return tuple(map(_said, value))
    if not isinstance(value, dict):
        return value
    sharp = value.get("aperture") == 0.0
    still = {name for name in ("velocity", "shutter") if name in value and not any(value[name])}
    flat = {"bump"} if value.get("bump", 0) is None else set()
    bare = {name for name in _OF_VERTICES if value.get(name) == ()}
    bare |= {"shading_normals"} if value.get("shading_normals") == "ignore" else set()
    left = {"notes"} | still | flat | bare | ({"aperture", "focus"} if sharp else set())
    said = {key: entry if key in _NUMBERS else _said(entry) for key, entry in value.items() if key not in left}
    return said | {"data": digest(value["data"])} if value.get("type") in KINDS else said


def canonical(scene: Part) -> str:
    """``scene`` as text that depends on its values alone: keys sorted, defaults filled in, floats in hexadecimal.

    ``name``, ``description``, ``film`` and the notes of meshes are left out, for no image depends on them. -0.0 is 0.0.
    A scene
    without planes says nothing of them, as before there were any, nor does one of what does not move, a lens without a
    width, no exposure, and one without a bump no bump.
    """
    data = _said(scene.model_dump(mode="python", exclude={"name", "description", "film"}))
    if not data.get("planes"):
        data.pop("planes", None)
    return json.dumps(_canonical(data), sort_keys=True, separators=(",", ":"), ensure_ascii=True)


def scene_hash(scene: Part) -> str:
    """SHA-256 of :func:`canonical`, 64 hexadecimal digits: equal hashes, equal images."""
    return hashlib.sha256(canonical(scene).encode("ascii")).hexdigest()
