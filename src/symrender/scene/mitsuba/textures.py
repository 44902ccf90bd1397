"""Textures of a Mitsuba file: reflectances, in the fields of a checkerboard or of an image."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.scene.mitsuba.colours import COLOURS, REFLECTED, Convert, Reader
from symrender.scene.mitsuba.plane import told_cell
from symrender.scene.mitsuba.properties import Properties, numbers
from symrender.scene.mitsuba.transforms import ROUNDING, Array, taken_transform
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.printable import printable

_WRAPS: Final = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp"}
_FILTERS: Final = {"bilinear": "bilinear", "nearest": "nearest", "trilinear": "bilinear", "ewa": "bilinear"}
TEXTURED: Final = (*COLOURS, "texture", "ref")


def texture_of(properties: Properties, name: str, reader: Reader) -> Any | None:
    """A reflectance as the field of a material, which may have a comment's ``scales``; None where it is not given."""
    found = properties.take(name, *TEXTURED)
    if found is None:
        return None
    return read_texture(properties, found, reader)


def colour_of(properties: Properties, name: str, default: float | None, reader: Reader, convert: Convert) -> Any:
    """A colour that may not be a texture."""
    given = properties.named.get(name)
    if given is not None and given.tag == "texture":
        # a constant texture is a colour
        made = texture_of(properties, name, reader)
        if isinstance(made, dict) and made.get("type") == "solid":
            return made["color"]
        raise properties.wrong(f"{name} must be one colour: a texture there is not supported", given)
    return reader.taken(properties, name, default, convert)


def read_texture(properties: Properties, found: Element, reader: Reader) -> Any:
    """What an element says of a reflectance."""
    if found.tag in COLOURS:
        return {"type": "solid", "color": reader.of(found, REFLECTED)}
    inner = Properties(found)
    match found.attributes.get("type"):
        case "checkerboard":
            return _checkerboard(inner, found, reader)
        case "bitmap":
            return _bitmap(inner, found, reader)
        case "uniform" | "rgb" | "srgb" | "d65" | "irregular" | "regular":
            return {
                "type": "solid",
                "color": reader.of(Element("spectrum", found.attributes, found.mark, found.children), REFLECTED),
            }
        case _:
            raise inner.wrong("no such texture here; known are checkerboard and bitmap")


def _checkerboard(inner: Properties, found: Element, reader: Reader) -> dict[str, Any]:
    tones = []
    for name, default in (("color0", 0.4), ("color1", 0.2)):
        tones.append(colour_of(inner, name, default, reader, REFLECTED))
    cell = next((cell for comment in found.comments if (cell := told_cell(comment))), None)
    transform = inner.named.get("to_uv")
    matrix = taken_transform(inner, "to_uv")
    inner.done("color0, color1 and to_uv")
    if cell is None:
        return {"type": "checkerboard", "bright": tones[0], "dark": tones[1], **placed(inner, matrix)}
    if transform is None or len(transform.children) != 1 or transform.children[0].tag != "scale":
        raise inner.wrong("to_uv must be one scale", transform)
    scales = numbers(transform, " ".join(transform.children[0].attributes.get(axis, "1") for axis in "xy"), 2)
    return {"type": "checker", "bright": tones[0], "dark": tones[1], "cell": cell, "scales": scales}


def _bitmap(inner: Properties, found: Element, reader: Reader) -> dict[str, Any]:
    name = inner.word("filename", "")
    if not name:
        raise inner.wrong("needs a filename")
    picture: dict[str, Any] = {"type": "image", "file": reader.path(found, name)}
    kind = inner.word("filter_type", "bilinear").lower()
    if kind not in _FILTERS:
        raise inner.wrong(f"filter_type must be bilinear or nearest, got {printable(kind)}")
    picture["filter"] = _FILTERS[kind]
    both = inner.word("wrap_mode", "repeat").lower()
    across, down = (inner.word(f"wrap_mode_{axis}", both).lower() for axis in "uv")
    if across != down or across not in _WRAPS:
        raise inner.wrong(f"wrap_mode must be repeat, mirror or clamp, in u as in v, got {printable(across)}")
    picture["wrap"] = _WRAPS[across]
    gamma = inner.number("gamma", -1.0)
    if gamma not in (-1.0, 1.0, 2.2):
        raise inner.wrong(f"gamma must be -1, 1 or 2.2 (taken for sRGB), got {gamma:g}")
    if inner.flag("raw", False) or gamma == 1.0:
        picture["encoding"] = "raw"
    matrix = taken_transform(inner, "to_uv")
    inner.pop("accel", "format", "max_anisotropy", "cache", "id")
    inner.done("filename, filter_type, wrap_mode, raw and to_uv")
    return picture | placed(inner, matrix)


def placed(inner: Properties, matrix: Array | None) -> dict[str, Any]:
    """Scale, rotation and offset of (u, v), where they are not those by default."""
    if matrix is None:
        return {}
    linear, offset = matrix[:2, :2], matrix[:2, 3]
    sizes = np.linalg.norm(linear, axis=1)
    if not (sizes > 0.0).all() or abs(float(linear[0] @ linear[1])) > ROUNDING * sizes[0] * sizes[1]:
        raise inner.wrong("to_uv must turn (u, v), scale and move, in this order")
    side = 1.0 if np.linalg.det(linear) > 0.0 else -1.0
    angle = math.degrees(math.atan2(-linear[0, 1], linear[0, 0]))
    put: dict[str, Any] = {"scale": [float(sizes[0]), side * float(sizes[1])]}
    if abs(abs(angle) - 180.0) < 1e-9:
        put["scale"], angle = [-x for x in put["scale"]], 0.0
    if angle:
        put["rotation"] = angle
    if offset.any():
        put["offset"] = [float(x) for x in offset]
    return put
