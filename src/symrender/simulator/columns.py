"""Where each number of a scene stands in the tables: what lets a page change it without compiling anything."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symrender.scene import arrays as at
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, Marble, Solid, Stripes

_SPHERE = {
    "center.x": 0,
    "center.y": 1,
    "center.z": 2,
    "radius": at.RADIUS,
    "color.r": at.COLOR,
    "color.g": at.COLOR + 1,
    "color.b": at.COLOR + 2,
    "texture.ku": at.KU,
    "texture.kv": at.KV,
    "texture.dark": at.DARK,
    "lobe.weight": at.LOBE,
    "lobe.exponent": at.LOBE + 1,
    "lobe.theta_max": at.LOBE + 2,
}
_FLOOR = {
    **{f"texture.bright.{c}": at.FLOOR_BRIGHT + k for k, c in enumerate("rgb")},
    **{f"texture.dark.{c}": at.FLOOR_DARK + k for k, c in enumerate("rgb")},
    **{f"texture.color.{c}": at.FLOOR_BRIGHT + k for k, c in enumerate("rgb")},
    "texture.cell": at.FLOOR_CELL,
    "texture.offset.x": at.FLOOR_OFFSET,
    "texture.offset.y": at.FLOOR_OFFSET + 1,
    "lobe.weight": at.FLOOR_LOBE,
    "lobe.exponent": at.FLOOR_LOBE + 1,
    "lobe.theta_max": at.FLOOR_LOBE + 2,
}
_LIGHT = {
    **{f"position.{c}": 1 + k for k, c in enumerate("xyz")},
    "radius": 4,
    **{f"color.{c}": 5 + k for k, c in enumerate("rgb")},
    **{f"target.{c}": 8 + k for k, c in enumerate("xyz")},
}
_SHADING = {
    "shading.ka": 0,
    "shading.kd": 1,
    "shading.ks": 2,
    "shading.shininess": 3,
    **{f"ambient.{c}": at.AMBIENT + k for k, c in enumerate("rgb")},
    **{f"background.{c}": at.BACKGROUND + k for k, c in enumerate("rgb")},
}
_CAMERA = {
    **{f"eye.{c}": 1 + k for k, c in enumerate("xyz")},
    **{f"target.{c}": 4 + k for k, c in enumerate("xyz")},
    **{f"up.{c}": 7 + k for k, c in enumerate("xyz")},
    "fov": 10,
    "window_half": 4,
    "window_center.x": 5,
    "window_center.y": 6,
}
_TEXTURES = (Solid(), Checker(), Stripes(), Marble())


def place(scene: Scene, name: str) -> tuple[str, int]:
    """(array, flat index) of the number a dotted name stands for."""
    if name in _SHADING:
        return "shading", _SHADING[name]
    kind, _, rest = name.partition(".")
    if kind in ("spheres", "lights"):
        part, _, rest = rest.partition(".")
        rows = [entry.name for entry in getattr(scene, kind)]
        columns, width = (_SPHERE, at.SPHERE_COLUMNS) if kind == "spheres" else (_LIGHT, at.LIGHT_COLUMNS)
        return kind, rows.index(part) * width + columns[rest]
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
    for name, column, choices, value in (
        ("shading.model", 4, ("blinn", "phong"), s.model),
        ("shading.highlight_view", 5, ("ray", "eye"), s.highlight_view),
        ("shading.specular_terminator", 6, ("cut", "open"), s.specular_terminator),
    ):
        yield {"name": name, "value": value, "choices": choices, "at": ("shading", column)}
    kinds = [texture.type for texture in _TEXTURES]
    for j, sphere in enumerate(scene.spheres):
        index = j * at.SPHERE_COLUMNS + at.TEXTURE
        name = f"spheres.{sphere.name}.texture.type"
        yield {"name": name, "value": sphere.texture.type, "choices": kinds, "at": ("spheres", index)}
