"""Scenes of flat shapes for the tests: crowds of everything, and single parts by name."""

from __future__ import annotations

from typing import Any

import numpy as np

Scene = dict[str, Any]
WHITE = {"type": "diffuse", "reflectance": 1}


def rectangle(name: str, corner: Any, u: Any, v: Any, material: str = "white") -> Scene:
    parts = {"corner": corner, "edge_u": u, "edge_v": v}
    return {"type": "rectangle", "name": name, "material": material} | {k: _list(p) for k, p in parts.items()}


def triangle(name: str, vertices: Any, material: str = "white") -> Scene:
    return {"type": "triangle", "name": name, "vertices": [_list(v) for v in vertices], "material": material}


def disk(name: str, center: Any, normal: Any, radius: float, material: str = "white") -> Scene:
    shape = {"type": "disk", "name": name, "radius": radius, "material": material}
    return shape | {"center": _list(center), "normal": _list(normal)}


def box(name: str, center: Any, size: Any, rotation: float = 0.0, material: str = "white") -> Scene:
    shape = {"type": "box", "name": name, "rotation": rotation, "material": material}
    return shape | {"center": _list(center), "size": _list(size)}


def ball(name: str, center: Any, radius: float, material: str = "white") -> Scene:
    return {"type": "sphere", "name": name, "center": _list(center), "radius": radius, "material": material}


def plane(name: str, point: Any, normal: Any, material: str = "white") -> Scene:
    along = [1, 0, 0] if abs(normal[0]) < max(abs(normal[1]), abs(normal[2])) else [0, 1, 0]
    shape = {"type": "plane", "name": name, "along": along, "material": material}
    return shape | {"point": _list(point), "normal": _list(normal)}


def world(*shapes: Scene, lights: list[Scene] | tuple[Scene, ...] = (), **more: Any) -> Scene:
    """A white world, one- and two-sided."""
    materials = {"white": WHITE, "both": WHITE | {"two_sided": True}}
    return {
        "units": "radiometric", "name": "flats", "bounces": 0, "materials": materials,
        "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.5]},
        "shapes": list(shapes), "lights": list(lights),
    } | more  # fmt: skip


def area(shape: str, radiance: Any = 1.0, name: str = "L") -> Scene:
    return {"type": "area", "name": name, "shape": shape, "radiance": radiance}


SKY: Scene = {"type": "sky", "name": "sky", "radiance": 1.0}


def _list(v: Any) -> list[float]:
    return [float(x) for x in v]


def one_of(rng: np.random.Generator, kind: str, name: str, material: str, spread: float = 2.0) -> Scene:
    """A random shape of a kind about the origin."""
    at = rng.uniform(-spread, spread, 3)
    if kind == "rectangle":
        return rectangle(name, at, rng.normal(size=3), rng.normal(size=3), material)
    if kind == "triangle":
        return triangle(name, at + rng.normal(size=(3, 3)), material)
    if kind == "disk":
        return disk(name, at, rng.normal(size=3), float(rng.uniform(0.3, 1.2)), material)
    if kind == "box":
        return box(name, at, rng.uniform(0.3, 1.5, 3), float(rng.uniform(-180, 180)), material)
    if kind == "plane":
        return plane(name, 2.5 * rng.normal(size=3), rng.normal(size=3), material)
    return ball(name, at, float(rng.uniform(0.2, 0.9)), material)


KINDS = ("rectangle", "triangle", "disk", "box", "sphere", "plane")


def crowd(seed: int, kinds: tuple[str, ...] = KINDS, lights: list[Scene] | None = None) -> Scene:
    """Shapes of all kinds in and through each other, textures, materials of one side and two, three lights."""
    rng = np.random.default_rng(seed)
    texture = {"bright": [0.9, 0.8, 0.7], "dark": [0.1, 0.2, 0.3]}
    metal = {"type": "conductor", "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1]}
    materials = {
        "checker": {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.37} | texture, "two_sided": True},
        "stripes": {"type": "phong", "exponent": 40, "reflectance": {"type": "stripes", "cell": 0.25} | texture},
        "marble": metal | {"alpha": 0.3, "reflectance": {"type": "marble", "cell": 0.5} | texture, "two_sided": True},
        "rough": metal | {"alpha": 0.5, "distribution": "beckmann", "masking": "correlated"},
        "plain": {"type": "diffuse", "reflectance": [0.2, 0.5, 0.9]},
    }
    names = list(materials)
    shapes = [one_of(rng, kind, f"{kind}{k}", names[(k + seed) % 5]) for k in range(2) for kind in kinds
              if kind != "plane" or k == 0]  # fmt: skip
    if lights is None:
        lights = [
            {"type": "point", "name": "key", "position": _list(rng.uniform(-2, 2, 3)), "intensity": [9, 5, 2]},
            {"type": "point", "name": "fill", "position": _list(rng.uniform(-2, 2, 3)), "intensity": [1, 5, 7]},
            {"type": "directional", "name": "sun", "direction": _list(rng.normal(size=3)), "irradiance": [1, 2, 3]},
        ]
    return world(*shapes, lights=lights, materials=materials)
