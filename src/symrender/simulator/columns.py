"""Where each number of a scene stands in the tables: what lets a page change it without compiling anything."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symrender.jit.records import Record, column, columns
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, Marble, Solid, Stripes

_LOBE = ("weight", "exponent", "theta_max")


def _parts(kind: type[Record], field: str, name: str, letters: str) -> dict[str, int]:
    """Places of a vector's numbers by their dotted names."""
    return {f"{name}.{letter}": column(kind, field) + k for k, letter in enumerate(letters)}


_SPHERE = {
    **_parts(Sphere, "center", "center", "xyz"),
    "radius": column(Sphere, "radius"),
    **_parts(Sphere, "color", "color", "rgb"),
    **{f"texture.{name}": column(Sphere, name) for name in ("ku", "kv", "dark")},
    **{f"lobe.{name}": column(Sphere, name) for name in _LOBE},
}


def _flat(kind: type[Floor | Plane]) -> dict[str, int]:
    return {
        **_parts(kind, "bright", "texture.bright", "rgb"),
        **_parts(kind, "dark", "texture.dark", "rgb"),
        **_parts(kind, "bright", "texture.color", "rgb"),
        "texture.cell": column(kind, "cell"),
        **_parts(kind, "offset", "texture.offset", "xy"),
        **{f"lobe.{name}": column(kind, name) for name in _LOBE},
    }


_FLOOR = _flat(Floor)
_PLANE = {
    **_parts(Plane, "point", "point", "xyz"),
    **_parts(Plane, "normal", "normal", "xyz"),
    **_parts(Plane, "along", "along", "xyz"),
    **_flat(Plane),
}
_LIGHT = {
    **_parts(Light, "position", "position", "xyz"),
    "radius": column(Light, "radius"),
    **_parts(Light, "color", "color", "rgb"),
    **_parts(Light, "target", "target", "xyz"),
}
_TABLES = {
    "spheres": (_SPHERE, columns(Sphere)),
    "planes": (_PLANE, columns(Plane)),
    "lights": (_LIGHT, columns(Light)),
}
_SHADING = {
    **{f"shading.{name}": column(Shading, name) for name in ("ka", "kd", "ks", "shininess")},
    **_parts(Shading, "ambient", "ambient", "rgb"),
    **_parts(Shading, "background", "background", "rgb"),
}
_CAMERA = {
    **_parts(Camera, "eye", "eye", "xyz"),
    **_parts(Camera, "target", "target", "xyz"),
    **_parts(Camera, "up", "up", "xyz"),
    "fov": column(Camera, "fov"),
    "window_half": column(Camera, "window_half"),
    **_parts(Camera, "window_center", "window_center", "xy"),
}
_TEXTURES = (Solid(), Checker(), Stripes(), Marble())


def place(scene: Scene, name: str) -> tuple[str, int]:
    """(array, flat index) of the number a dotted name stands for."""
    if name in _SHADING:
        return "shading", _SHADING[name]
    kind, _, rest = name.partition(".")
    if kind in _TABLES:
        part, _, rest = rest.partition(".")
        rows = [entry.name for entry in getattr(scene, kind)]
        places, width = _TABLES[kind]
        return kind, rows.index(part) * width + places[rest]
    return kind, (_FLOOR if kind == "floor" else _CAMERA)[rest]


def entries(scene: Scene) -> Iterator[dict[str, Any]]:
    """Every real number and every choice of a scene that a page can change, as plain data."""
    for p in scene.parameters():
        yield {
            "name": p.name,
            "value": p.value,
            "unit": p.unit,
            "low": p.low,
            "high": p.high,
            "description": p.description,
            "at": place(scene, p.name),
        }
    s = scene.shading
    for name, field, choices, value in (
        ("shading.model", "model", ("blinn", "phong"), s.model),
        ("shading.highlight_view", "highlight_view", ("ray", "eye"), s.highlight_view),
        ("shading.specular_terminator", "terminator", ("cut", "open"), s.specular_terminator),
    ):
        yield {"name": name, "value": value, "choices": choices, "at": ("shading", column(Shading, field))}
    kinds = [texture.type for texture in _TEXTURES]
    for j, sphere in enumerate(scene.spheres):
        index = j * columns(Sphere) + column(Sphere, "texture")
        name = f"spheres.{sphere.name}.texture.type"
        yield {"name": name, "value": sphere.texture.type, "choices": kinds, "at": ("spheres", index)}
