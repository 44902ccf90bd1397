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


HALVES = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])


def _lattice(rng: np.random.Generator, low: float = 0.0) -> Any:
    at = rng.choice(HALVES, 3)
    at[2] = max(low, at[2] + 1.0)
    return at


def _contact(rng: np.random.Generator, name: str, material: str) -> Scene:
    """A shape whose corners, faces and radii are halves, so that it touches others in faces, edges and corners."""
    kind = rng.choice(["rectangle", "triangle", "box", "sphere", "needle", "free"])
    if kind == "free":
        return one_of(rng, str(rng.choice(["rectangle", "triangle", "box"])), name, material, 1.0)
    at = _lattice(rng)
    if kind == "sphere":
        radius = float(rng.choice([0.25, 0.5]))
        at[2] = max(at[2], radius)
        return ball(name, at, radius, material)
    if kind == "box":
        size = rng.choice([0.5, 1.0], 3)
        at[2] = max(at[2], 0.5 * size[2])
        return box(name, at, size, float(rng.choice([0.0, 0.0, 45.0, 90.0, 30.0])), material)
    axes = rng.permutation(np.eye(3))[:2] * rng.choice([-1.0, 1.0], (2, 1))
    u, v = axes[0] * rng.choice([0.5, 1.0, 2.0]), axes[1] * rng.choice([0.5, 1.0, 2.0])
    if kind == "rectangle":
        return rectangle(name, at, u, v, material)
    if kind == "needle":
        return triangle(name, [at, at + u, at + u + v * 10.0 ** -rng.uniform(2, 8)], material)
    return triangle(name, [at, at + u, at + v], material)


def contact(seed: int) -> tuple[Scene, str, Any, Any, str | None]:
    """(scene, shape, place of it, normal there, lamp or None for the sky): shapes that touch, lie in planes of others,
    share edges and corners; places in their planes; at scales from 1e-4 to 1e3, near the origin or not."""
    rng = np.random.default_rng([seed, 11])
    shapes = [_contact(rng, f"S{k}", "both" if rng.random() < 0.5 else "white") for k in range(rng.integers(1, 4))]
    walls = [
        rectangle("W0", [-1, 1, 0], [2, 0, 0], [0, 0, 2]), rectangle("W1", [-1, -1, 0], [0, 2, 0], [0, 0, 2]),
        plane("W2", [0, 0, 2], [0, 0, -1]), rectangle("W3", [-1, -1, 2], [0, 2, 0], [2, 0, 0]),
    ]  # fmt: skip
    shapes += [wall for wall in walls if rng.random() < 0.3]
    lamp = None
    if rng.random() < 0.7:
        lamp = "lamp"
        shape = _contact(rng, lamp, "white")
        if rng.random() < 0.3:
            shape = rectangle(lamp, [-0.5, -0.5, 2], [0, 1, 0], [1, 0, 0])
        shapes.append(shape)
    own = rectangle("floor", [-1, -1, 0], [2, 0, 0], [0, 2, 0], "both")
    if rng.random() < 0.3:
        own = plane("floor", [0, 0, 0], [0, 0, 1], "both")
    place = np.array([*rng.uniform(-1, 1, 2), 0.0])
    if rng.random() < 0.3:
        place[:2] = rng.choice([-0.75, -0.5, 0.0, 0.25, 0.5], 2)
    if rng.random() < 0.2:
        place[:2] = [1.0 - 10.0 ** -rng.uniform(3, 9), rng.uniform(-1, 1)]
    shapes = [own, *shapes]
    scale = float(10.0 ** rng.uniform(-4, 3)) if rng.random() < 0.5 else 1.0
    offset = rng.normal(size=3) * scale * rng.choice([0.0, 0.0, 1.0, 30.0])
    moved = [_scaled(shape, scale, offset) for shape in shapes]
    camera = {"type": "look_at", "eye": _list(offset + scale * np.array([0, -3, 1])), "target": _list(offset)}
    lights = [SKY] if lamp is None else [area(lamp)]
    return world(*moved, lights=lights, camera=camera), "floor", place * scale + offset, np.array([0, 0, 1.0]), lamp


def _scaled(shape: Scene, scale: float, offset: Any) -> Scene:
    lengths, places = ("edge_u", "edge_v", "size", "radius"), ("corner", "center", "point")
    found = dict(shape)
    for key in lengths:
        if key in shape:
            found[key] = _list(scale * np.array(shape[key])) if key != "radius" else scale * shape[key]
    for key in places:
        if key in shape:
            found[key] = _list(scale * np.array(shape[key]) + offset)
    if "vertices" in shape:
        found["vertices"] = [_list(scale * np.array(v) + offset) for v in shape["vertices"]]
    return found
