"""One symbol for every real number of a scene, named by place, never by what a scene calls it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from symrender.errors import SceneError
from symrender.expression.vectors import Vec3
from symrender.scene.scene import Scene

_SHORT: Mapping[str, str] = {
    "center": "C",
    "radius": "r",
    "color": "a",
    "position": "L",
    "target": "T",
    "exponent": "n",
    "weight": "k",
    "theta_max": "theta",
    "eye": "E",
    "point": "O",
    "normal": "U",
    "along": "A",
}
_UNSAID = ("spheres", "planes", "lights", "camera", "lobe", "texture", "shading")


@dataclass(frozen=True)
class ParameterTable:
    """The real numbers of a scene: dotted name to symbol and value."""

    symbols: Mapping[str, sp.Symbol]
    values: Mapping[str, float]

    def symbol(self, name: str) -> sp.Symbol:
        """Symbol of a dotted name; SceneError if the scene has no such number."""
        if name not in self.symbols:
            raise SceneError(f"{name!r}: not a real number of this scene; `symrender params` lists them")
        return self.symbols[name]

    def vector(self, name: str, axes: str = "xyz") -> Vec3:
        """Symbols of a point or a colour."""
        return Vec3(*(self.symbols[f"{name}.{axis}"] for axis in axes))


def parameter_table(scene: Scene) -> ParameterTable:
    """Symbols such as ``C1_x`` (centre of sphere 1), ``L0_z`` (light 0), ``a1_g`` (albedo), ``O_p0_x`` (plane 0)."""
    places = {f"spheres.{sphere.name}": f"spheres.{k}" for k, sphere in enumerate(scene.spheres)}
    places |= {f"planes.{plane.name}": f"planes.{k}" for k, plane in enumerate(scene.planes)}
    places |= {f"lights.{light.name}": f"lights.{k}" for k, light in enumerate(scene.lights)}
    symbols: dict[str, sp.Symbol] = {}
    values: dict[str, float] = {}
    for parameter in scene.parameters():
        part = ".".join(parameter.name.split(".")[:2])
        rest = parameter.name.removeprefix(part)
        symbols[parameter.name] = sp.Symbol(_symbol_name(places.get(part, part) + rest), real=True)
        values[parameter.name] = float(parameter.value)
    return ParameterTable(symbols, values)


def _symbol_name(path: str) -> str:
    parts = path.split(".")
    index = {"spheres": parts[1], "lights": parts[1], "planes": f"_p{parts[1]}"}.get(parts[0], "")
    if parts[0] == "lights":
        parts = ["c" if p == "color" else "rho" if p == "radius" else p for p in parts]
    words = [_SHORT.get(p, p) for p in parts if p not in _UNSAID]
    if index:
        words = [words[1] + index, *words[2:]]
    name = "_".join(words)
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise ValueError(f"{path} gives no safe symbol")
    return name
