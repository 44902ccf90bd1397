"""Lights of a Mitsuba file that are no shapes."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.scene.document import Mark
from symrender.scene.mitsuba.colours import EMITTED, REFLECTED, Reader
from symrender.scene.mitsuba.properties import Properties, numbers
from symrender.scene.mitsuba.textures import colour_of
from symrender.scene.mitsuba.transforms import Array, taken_transform, uniform_scale

_KNOWN: Final = "point, spot, directional, constant, envmap and area"
_STRENGTHS: Final = {"point": "intensity", "spot": "intensity", "directional": "irradiance", "constant": "radiance"}


def light(properties: Properties, kind: str, name: str, reader: Reader) -> tuple[dict[str, Any], dict[str, Mark]]:
    """The entry of an emitter of this type, and where its fields stand."""
    properties.pop("sampling_weight", "id")
    marks = {field: child.mark for field, child in properties.named.items()}
    if kind == "envmap":
        return _environment(properties, name, reader), marks
    if kind not in _STRENGTHS:
        raise properties.wrong(f"no such emitter here; known are {_KNOWN}")
    strength = _STRENGTHS[kind]
    colour = colour_of(properties, strength, 1.0, reader, EMITTED)
    look = _one_look(properties)
    given = taken_transform(properties)
    outer = reader.outer
    matrix = outer if given is None else outer @ given
    entry: dict[str, Any] = {"type": kind, "name": name}
    match kind:
        case "point":
            if given is not None and "position" in properties.named:
                raise properties.wrong("position and to_world: one of them says where it is")
            place = properties.place("position", (0.0, 0.0, 0.0))
            entry["position"] = _column(matrix, 3) if given is not None else _turned(outer, place)
        case "spot":
            entry |= _spot(properties, matrix) | ({"direction": _turned(outer, look)} if look is not None else {})
        case "directional":
            if "direction" in properties.named:
                if given is not None:
                    raise properties.wrong("direction and to_world: one of them says where it goes")
                entry["direction"] = _turned(outer, properties.place("direction"))
            else:
                entry["direction"] = _column(matrix, 2)
        case _:
            entry["type"] = "sky"
    entry[strength] = colour
    properties.done(f"{strength} and what says where it is")
    return entry, marks


def _column(matrix: Array, column: int) -> list[float]:
    return [float(x) for x in matrix[:3, column]]


def _turned(outer: Array, place: list[float]) -> list[float]:
    return [float(x) + 0.0 for x in outer[:3, :3] @ place]


def _one_look(properties: Properties) -> list[float] | None:
    """From origin to target, where ``to_world`` is one lookat and moves: exactly what the file says."""
    transform = properties.named.get("to_world")
    parts = transform.children if transform is not None else []
    if not parts or parts[0].tag != "lookat" or any(part.tag != "translate" for part in parts[1:]):
        return None
    eye, target = (numbers(parts[0], parts[0].attributes.get(name, ""), 3) for name in ("origin", "target"))
    return [b - a for a, b in zip(eye, target, strict=True)]


def _spot(properties: Properties, whole: Array) -> dict[str, Any]:
    """Place, direction and cone of a spot."""
    if "texture" in properties.named:
        raise properties.wrong("a texture is not supported", properties.named["texture"])
    cutoff = properties.number("cutoff_angle", 20.0)
    beam = properties.number("beam_width", 0.75 * cutoff)
    return {"position": _column(whole, 3), "direction": _column(whole, 2), "beam": beam, "cutoff": cutoff}


def _environment(properties: Properties, name: str, reader: Reader) -> dict[str, Any]:
    """The entry of an image of the sky: Mitsuba's has y up, and z where azimuth begins."""
    file = properties.word("filename", "")
    if not file:
        raise properties.wrong("needs a filename")
    entry: dict[str, Any] = {"type": "environment", "name": name, "file": reader.path(properties.element, file)}
    given = properties.named.get("scale")
    scale = reader.taken(properties, "scale", 1.0, REFLECTED) if given is not None else [1.0] * 3
    entry["scale"] = scale
    matrix = taken_transform(properties)
    whole = np.eye(4) if matrix is None else matrix
    size = uniform_scale(whole)
    if size is None:
        raise properties.wrong("to_world must turn or mirror, and not scale by unequal factors")
    # x, y, z of the map here are x, z, y there: z up, and azimuth from y towards x
    turned = reader.outer[:3, :3] @ whole[:3, :3] / size @ _TO_Y_UP
    entry["to_world"] = [[float(x) for x in row] for row in turned]
    properties.pop("gamma", "cache", "mis_compensation", "raw")
    properties.done("filename, scale and to_world")
    return entry


_TO_Y_UP: Final = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
