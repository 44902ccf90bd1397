"""Rooms of flat shapes for the tests, and one bounce of light in them by lattices and the other pipeline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric import nets
from tests.radiometric.flats import SKY, box, disk, rectangle, triangle, world

from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

Scene = dict[str, Any]
Array = np.ndarray[Any, np.dtype[np.float64]]
MATERIALS = {
    "white": {"type": "diffuse", "reflectance": [0.8, 0.7, 0.9]},
    "both": {"type": "diffuse", "reflectance": [0.5, 0.6, 0.4], "two_sided": True},
    "grey": {"type": "diffuse", "reflectance": 0.4},
    "red": {"type": "diffuse", "reflectance": [0.9, 0.0, 0.1]},
}
SHIFTS = 4


def closed(size: float = 1.0, at: tuple[float, float, float] = (0.0, 0.0, 0.0), material: str = "white") -> list[Scene]:
    """The six walls of a cube, seen from inside."""
    x, y, z, s = *at, size
    return [
        rectangle("floor", [x, y, z], [s, 0, 0], [0, s, 0], material),
        rectangle("ceiling", [x, y, z + s], [0, s, 0], [s, 0, 0], material),
        rectangle("back", [x, y + s, z], [s, 0, 0], [0, 0, s], material),
        rectangle("front", [x, y, z], [0, 0, s], [s, 0, 0], material),
        rectangle("left", [x, y, z], [0, s, 0], [0, 0, s], material),
        rectangle("right", [x + s, y, z], [0, 0, s], [0, s, 0], material),
    ]


def lamp(shape: Scene, radiance: Any = 1.0) -> Scene:
    return {"type": "area", "name": f"of_{shape['name']}", "shape": shape["name"], "radiance": radiance}


def hostile(seed: int, scale: float) -> Scene:
    """A room of coloured walls with a point light and shapes that touch, cross, all but touch, or are needles."""
    rng = np.random.default_rng(seed)
    shapes = closed(1.0, material="grey")
    shapes[2]["material"], shapes[4]["material"] = "red", "both"
    for k in range(3):
        material = ["white", "both", "grey", "red"][int(rng.integers(4))]
        gap = 10.0 ** -float(rng.integers(2, 7))
        shapes.append(
            [
                box(f"o{k}", [0.1, 0.5, 0.15], [0.2, 0.3, 0.3], 0.0, material),
                box(
                    f"o{k}", rng.uniform(0.2, 0.8, 3), rng.uniform(0.05, 0.5, 3), float(rng.uniform(-90, 90)), material
                ),
                box(f"o{k}", [0.5, 0.5, 0.3], [gap, 0.4, 0.3], 20.0, material),
                rectangle(f"o{k}", [0.3, 0.3, gap], [0.4, 0, 0], [0, 0.3, 0], material),
                rectangle(f"o{k}", [0.3, 0, 0], [0, 1, 0], [0, 0, 0.6], material),
                triangle(f"o{k}", [[0.1, 0.1, 0.3], [0.9, 0.8, 0.4], [0.9, 0.8 + gap, 0.4]], material),
                triangle(f"o{k}", rng.uniform(0.05, 0.95, (3, 3)), material),
            ][(seed + 3 * k) % 7]
        )
    grow(shapes, scale)
    key = {
        "type": "point",
        "name": "key",
        "position": [scale * c for c in rng.uniform(0.3, 0.7, 3)],
        "intensity": [scale * scale * c for c in (0.9, 0.5, 0.2)],
    }
    return world(*shapes, lights=[key], materials=MATERIALS, bounces=1)


def with_disks(seed: int, scale: float) -> Scene:
    """A room with disks in any position: large and tiny, a little over walls, in a box, through each other and walls.

    Under a point, a spot, a sun through an open side, or, one of them, under a sky, a rectangle or a disk that emits.
    """
    rng = np.random.default_rng([seed, 99])
    shapes = closed(1.0, material="grey")
    shapes[2]["material"], shapes[4]["material"] = "red", "both"
    kind = int(rng.integers(6))
    if kind in (2, 3):
        del shapes[int(rng.choice([1, 3]))]
    for k in range(int(rng.integers(1, 4)) if kind < 3 else 1):
        material = ["white", "both", "both", "red"][int(rng.integers(4))]
        radius, gap = 10.0 ** rng.uniform(-2.5, -0.4), 10.0 ** -float(rng.integers(1, 7))
        middle, way = rng.uniform(0.2, 0.8, 3), rng.normal(size=3)
        way /= np.sqrt((way**2).sum())
        where = int(rng.integers(5))
        if where == 0:
            # over the floor, as level as it or all but
            middle[2], way = gap, np.array([0.0, 0.0, 1.0]) + gap * way * (rng.random() < 0.5)
            middle[2] += gap * radius
        elif where == 1:
            # through a wall
            middle[int(rng.integers(3))] = float(rng.choice([0.0, 1.0]))
        elif where == 2 and k:
            # through the one before, or level with it
            middle = np.array(shapes[-1].get("center", middle)) + gap * way
        elif where == 3:
            # its rim on a wall
            middle[0] = radius * float(np.sqrt(max(0.0, 1.0 - way[0] ** 2)))
        shapes.append(disk(f"o{k}", middle, way, radius, material))
    if rng.random() < 0.5:
        shapes.append(box("b", rng.uniform(0.3, 0.7, 3), rng.uniform(0.1, 0.4, 3), float(rng.uniform(0, 90)), "white"))
    glow = (
        rectangle("glow", [0.3, 0.3, 0.999], [0, 0.3, 0], [0.3, 0, 0], "grey")
        if rng.random() < 0.5
        else disk("glow", [0.5, 0.5, 0.98], [*rng.uniform(-0.2, 0.2, 2), -1.0], float(rng.uniform(0.02, 0.3)), "grey")
    )
    light: Scene = {"type": "point", "name": "key", "intensity": [scale * scale * c for c in (0.9, 0.5, 0.2)]}
    light["position"] = [scale * c for c in rng.uniform(0.3, 0.7, 3)]
    if kind == 1:
        light |= {"type": "spot", "direction": rng.normal(size=3).tolist(), "cutoff": 50.0, "beam": 20.0}
    elif kind == 2:
        light = {"type": "directional", "name": "key", "direction": [0.2, 0.5, -0.9], "irradiance": [2.0, 1.5, 1.0]}
    elif kind == 3:
        light = SKY | {"radiance": [0.9, 0.5, 0.2]}
    elif kind > 3:
        shapes.append(glow)
        light = lamp(glow, [6.0, 4.0, 2.0])
    grow(shapes, scale)
    return world(*shapes, lights=[light], materials=MATERIALS, bounces=1)


def grow(shapes: list[Scene], scale: float) -> None:
    """Make flat shapes larger, about the origin."""
    for shape in shapes:
        for key in ("corner", "edge_u", "edge_v", "center", "size", "position"):
            if key in shape:
                shape[key] = [scale * c for c in shape[key]]
        if shape["type"] == "disk":
            shape["radius"] *= scale
        if shape["type"] == "mesh":
            shape["scale"] *= scale
        elif "vertices" in shape:
            shape["vertices"] = [[scale * c for c in v] for v in shape["vertices"]]


def net(rng: np.random.Generator, kind: int) -> nets.Net:
    """A mesh of some ten faces: with dents, open and turned over, in folds of needles, closed and convex."""
    if kind == 0:
        return nets.bent(nets.ball(3, 5), rng, 0.4)
    if kind == 1:
        return nets.opened(nets.bent(nets.ball(3, 4), rng, 0.3), rng)
    if kind == 2:
        return folds(6, float(rng.uniform(0.05, 1.5)))
    return nets.ball(3, 4)


def folds(count: int, height: float) -> nets.Net:
    """A strip that goes up and down, so that its folds hide each other."""
    places = [[2.0 * k / count - 1.0, y, height * (k % 2)] for k in range(count + 1) for y in (-1.0, 1.0)]
    faces = [f for k in range(0, 2 * count, 2) for f in ([k, k + 2, k + 3], [k, k + 3, k + 1])]
    return places, faces


def crowded(seed: int, scale: float) -> Scene:
    """A room with meshes, textures and a spot, a sky through a window, a lamp or a point."""
    rng = np.random.default_rng([seed, 77])
    shapes = closed(1.0, material="grey")
    tiles = {"type": "diffuse", "two_sided": bool(rng.integers(2))}
    kind, cell = ("checker", "stripes")[int(rng.integers(2))], scale * float(rng.choice([0.5, 0.3, 0.17]))
    tiles["reflectance"] = {"type": kind, "bright": [0.8, 0.1, 0.5], "dark": [0.1, 0.6, 0.5], "cell": cell}
    for wall in rng.choice(6, 2, replace=False):
        shapes[wall]["material"] = "tiles"
    for k in range(2):
        material = ["white", "both", "grey", "red", "tiles"][int(rng.integers(5))]
        size, at = float(rng.uniform(0.08, 0.25)), rng.uniform(0.2, 0.8, 3)
        if rng.random() < 0.3:
            at[2] = size
        if k == 1 and rng.random() < 0.4:
            shapes.append(box(f"o{k}", at, rng.uniform(0.05, 0.5, 3), float(rng.uniform(-90, 90)), material))
            continue
        more = {"position": at.tolist(), "scale": size, "rotation": float(rng.uniform(0, 90))}
        shapes.append(nets.mesh(f"o{k}", net(rng, (seed + k) % 4), material, **more))
    light: Scene = {"name": "key", "position": [scale * c for c in rng.uniform(0.25, 0.75, 3)]}
    light["intensity"] = [scale * scale * c for c in (0.9, 0.5, 0.2)]
    if seed % 4 == 0:
        light["type"] = "point"
    elif seed % 4 == 1:
        light |= {"type": "spot", "direction": rng.normal(size=3).tolist()}
        light["cutoff"] = float(rng.choice([15.0, 40.0, 70.0, 85.0]))
        light["beam"] = float(rng.choice([0.0, 0.6, 0.99])) * light["cutoff"]
        light["falloff"] = ("linear", "smooth")[int(rng.integers(2))]
    elif seed % 4 == 2:
        light = SKY | {"radiance": [0.9, 0.5, 0.2]}
        del shapes[1 + int(rng.integers(5))]
    else:
        x, y = rng.uniform(0.1, 0.6, 2)
        shapes.append(rectangle("glow", [x, y, 0.97], [0, 0.3, 0], [0.3, 0, 0], "grey"))
        light = lamp(shapes[-1], [0.9, 0.5, 0.2])
    grow(shapes, scale)
    return world(*shapes, lights=[light], materials=MATERIALS | {"tiles": tiles}, bounces=1)


def hemisphere(normal: Array, count: int, shift: Array) -> Array:
    """Directions of a lattice above a surface, a cosine weighs them."""
    k = np.arange(count)[:, None]
    u = np.mod(k * np.array([0.7548776662466927, 0.5698402909980532]) + shift, 1.0)
    first = np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.7 else [0, 1.0, 0])
    first /= np.linalg.norm(first)
    r, turn = np.sqrt(u[:, :1]), 2 * math.pi * u[:, 1:]
    flat = r * np.cos(turn) * first + r * np.sin(turn) * np.cross(normal, first)
    return flat + np.sqrt(1 - u[:, :1]) * normal


def reflected_once(scene: Scene, place: Array, normal: Array, count: int, seed: int) -> tuple[Array, Array]:
    """(mean over directions of the direct light that a place sees, standard error) by the numeric pipeline."""
    arrays = radiometric_arrays(load_any(scene | {"bounces": 0}))  # type: ignore[arg-type]
    means = []
    for shift in range(SHIFTS):
        directions = hemisphere(normal, count, np.random.default_rng([seed, shift]).random(2))
        origins = np.tile(place + 1e-10 * np.abs(place).max() * normal, (count, 1))
        means.append(numeric_rays(arrays, origins, directions)[1].mean(axis=0))
    found = np.array(means)
    return found.mean(axis=0), found.std(axis=0, ddof=1) / math.sqrt(SHIFTS)
