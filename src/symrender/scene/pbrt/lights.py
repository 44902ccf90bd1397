"""Lights of a pbrt file: numbers of rgb are those of the film, other colours have luminance 1 times their scale."""

from __future__ import annotations

from typing import Any

import numpy as np

from symrender.scene.document import Mark
from symrender.scene.pbrt.materials import Shelf
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import Transform
from symrender.scene.printable import printable

_ORIGIN = (0.0, 0.0, 0.0)
_WHITE = (1.0, 1.0, 1.0)


def _strength(parameters: Parameters, name: str, shelf: Shelf) -> list[float]:
    scale = parameters.number("scale", 1.0)
    colour = parameters.colour(name, "emits", shelf.opener, _WHITE) or _WHITE
    return [scale * c for c in colour]


def area(parameters: Parameters, shelf: Shelf) -> dict[str, Any]:
    """The entry of what a shape emits, without name and shape."""
    (kind,) = parameters.directive.strings
    parameters.must("", kind, "diffuse")
    if parameters.given("power"):
        raise parameters.wrong("power", "must be left out: a light is as strong as L times scale says")
    if parameters.given("filename"):
        raise parameters.wrong("filename", "must be left out: a shape emits alike everywhere")
    parameters.must("twosided", parameters.word("twosided", "false", "bool"), "false", "a shape emits on one side")
    radiance = _strength(parameters, "L", shelf)
    parameters.done("L, scale and twosided")
    return {"type": "area", "radiance": radiance}


def _spot(parameters: Parameters, at: Transform) -> dict[str, Any]:
    """The entry of a spot without its name and its strength."""
    begin = parameters.triple("from", "point3", _ORIGIN)
    end = parameters.triple("to", "point3", (0.0, 0.0, 1.0))
    x, y, z = (b - a for a, b in zip(begin, end, strict=True))
    cutoff, fall = parameters.number("coneangle", 30.0), parameters.number("conedeltaangle", 5.0)
    entry: dict[str, Any] = {"type": "spot", "position": list(at.place(begin)), "direction": list(at.vector((x, y, z)))}
    return entry | {"beam": cutoff - fall, "cutoff": cutoff, "falloff": "smooth"}


def light(parameters: Parameters, at: Transform, shelf: Shelf) -> tuple[dict[str, Any], dict[str, Mark]]:
    """The entry of a light without its name, and where its fields stand."""
    (kind,) = parameters.directive.strings
    for name in ("power", "illuminance"):
        if parameters.given(name):
            raise parameters.wrong(name, "must be left out: a light is as strong as I or L times scale says")
    match kind:
        case "point":
            strength, given = "I", "intensity"
            entry: dict[str, Any] = {
                "type": "point",
                "position": list(at.place(parameters.triple("from", "point3", _ORIGIN))),
            }
        case "spot":
            strength, given = "I", "intensity"
            entry = _spot(parameters, at)
        case "distant":
            strength, given = "L", "irradiance"
            begin = parameters.triple("from", "point3", _ORIGIN)
            end = parameters.triple("to", "point3", (0.0, 0.0, 1.0))
            x, y, z = (b - a for a, b in zip(begin, end, strict=True))
            entry = {"type": "directional", "direction": list(at.vector((x, y, z)))}
        case "infinite":
            strength, given = "L", "radiance"
            if parameters.given("filename"):
                return _environment(parameters, at, shelf), {}
            entry = {"type": "sky"}
        case _:
            raise parameters.wrong(
                "", f"must be point, spot, distant or infinite, got {printable(kind)}, a light not read"
            )
    entry[given] = _strength(parameters, strength, shelf)
    known = {
        "point": "I, scale and from",
        "spot": "I, scale, from, to, coneangle and conedeltaangle",
        "distant": "L, scale, from and to",
    }
    parameters.done(known.get(kind, "L and scale"))
    return entry, {
        given: parameters.where(strength),
        "position": parameters.where("from"),
        "direction": parameters.where("to"),
    }


def _environment(parameters: Parameters, at: Transform, shelf: Shelf) -> dict[str, Any]:
    """The entry of an equal-area image of the sky."""
    scale = parameters.number("scale", 1.0)
    path = shelf.path(parameters, "filename", parameters.word("filename", ""))
    parameters.done("filename and scale")
    size = at.scale()
    if size is None:
        raise parameters.wrong("", "must be turned only, or mirrored")
    rows = at.matrix[:3, :3] / size
    entry: dict[str, Any] = {"type": "environment", "file": path, "layout": "equal_area", "scale": [scale] * 3}
    return entry | {"to_world": [[float(x) for x in row] for row in np.asarray(rows)]}
