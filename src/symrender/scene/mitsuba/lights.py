"""Lights of a Mitsuba file that are no shapes."""

from __future__ import annotations

from typing import Any, Final

from symrender.scene.document import Mark
from symrender.scene.mitsuba.properties import Properties, numbers

_KINDS: Final = {
    "point": ("point", {"position": "point", "intensity": "rgb"}),
    "directional": ("directional", {"direction": "vector", "irradiance": "rgb"}),
    "constant": ("sky", {"radiance": "rgb"}),
}
"""Emitters by their type: what it is here, and the tags of its fields."""


def light(properties: Properties, kind: str, name: str) -> tuple[dict[str, Any], dict[str, Mark]]:
    """The entry of an emitter of this type, and where its fields stand."""
    if kind == "spot":
        return _spot(properties, name), {}
    if kind not in _KINDS:
        raise properties.wrong("no such emitter here; known are point, spot, directional and constant")
    ours, fields = _KINDS[kind]
    entry: dict[str, Any] = {"type": ours, "name": name}
    marks = {}
    for field, tag in fields.items():
        entry[field], marks[field] = properties.triple(field, tag)
    properties.done(", ".join(fields))
    return entry, marks


def _spot(properties: Properties, name: str) -> dict[str, Any]:
    """The entry of a spot, which is turned about the origin and then moved."""
    transform = properties.take("to_world", "transform")
    parts = transform.children if transform is not None else []
    if transform is None or [part.tag for part in parts] != ["lookat", "translate"]:
        raise properties.wrong("to_world must be a lookat from 0, 0, 0 and a translate", transform)
    origin, target = (numbers(parts[0], parts[0].attributes.get(key, ""), 3) for key in ("origin", "target"))
    if any(origin):
        raise properties.wrong("its lookat must have the origin 0, 0, 0", parts[0])
    place = numbers(parts[1], " ".join(parts[1].attributes.get(axis, "0") for axis in "xyz"), 3)
    cutoff = properties.number("cutoff_angle", 20.0)
    beam = properties.number("beam_width", 0.75 * cutoff)
    entry = {"type": "spot", "name": name, "position": place, "direction": target, "beam": beam, "cutoff": cutoff}
    entry["intensity"] = properties.triple("intensity", "rgb")[0]
    properties.done("to_world, intensity, cutoff_angle and beam_width")
    return entry
