"""Hostile scenes of endless planes among flat faces, for the tests and the programs that judge what they gather."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric import nets
from tests.radiometric.flats import SKY, box, plane, rectangle, triangle, world
from tests.radiosity.rooms import MATERIALS, Scene, grow, lamp, net

Array = np.ndarray[Any, np.dtype[np.float64]]
COLOURS = ("white", "both", "grey", "red")
LIGHT = (0.9, 0.5, 0.2)
LOWEST, HIGHEST = -6.0, 3.0
"""Powers of ten of heights over planes."""
FARTHEST = 7.0
"""The same of how far out on a plane places lie."""


def _turned(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def _about(rng: np.random.Generator, normal: Array, angle: float) -> Array:
    """A unit vector at an angle to another."""
    side = np.cross(normal, _turned(rng))
    side /= np.linalg.norm(side)
    return np.asarray(math.cos(angle) * normal + math.sin(angle) * side)


def _on(rng: np.random.Generator, normal: Array, point: Array, reach: float) -> Array:
    """A place of a plane, no farther than ``reach`` from ``point``."""
    side = np.cross(normal, _turned(rng))
    return np.asarray(point + reach * rng.random() * side / np.linalg.norm(side))


def _planes(rng: np.random.Generator) -> list[tuple[Array, Array]]:
    """(point, normal) of one to three planes, level or not: parallel, all but parallel, across each other."""
    first = np.array([0.0, 0.0, 1.0]) if rng.random() < 0.6 else _turned(rng)
    found = [(np.zeros(3) if rng.random() < 0.7 else rng.uniform(-0.3, 0.3, 3), first)]
    while len(found) < 3 and rng.random() < 0.55:
        point, normal = found[0]
        kind = int(rng.integers(4))
        high = 10.0 ** rng.uniform(-1.0, HIGHEST)
        if kind == 0:
            found.append((point + high * normal, -normal))
        elif kind == 1:
            found.append((point + high * normal, -_about(rng, normal, 10.0 ** rng.uniform(-6, -1))))
        elif kind == 2:
            found.append((rng.uniform(-1, 1, 3), _about(rng, normal, float(rng.uniform(0.2, 2.9)))))
        else:
            away = _about(rng, normal, 0.5 * math.pi)
            found.append((point + high * away, -away))
    return found


def _shapes(rng: np.random.Generator, planes: list[tuple[Array, Array]]) -> list[Scene]:
    """Faces in the air, on planes, a little above them, and through them."""
    shapes: list[Scene] = []
    for k in range(int(rng.integers(1, 4))):
        material = COLOURS[int(rng.integers(4))]
        point, normal = planes[int(rng.integers(len(planes)))]
        high = 0.0 if rng.random() < 0.2 else 10.0 ** rng.uniform(LOWEST, 0.3 if rng.random() < 0.85 else HIGHEST)
        foot = _on(rng, normal, point, 1.0)
        at, kind = foot + high * normal, int(rng.integers(6))
        u = _about(rng, normal, 0.5 * math.pi)
        v = np.cross(normal, u)
        a, b = rng.uniform(0.2, 1.2, 2)
        if kind == 0:
            size = rng.uniform(0.1, 0.9, 3)
            if abs(normal[2]) > 0.99:
                at = at + 0.5 * size[2] * normal
            shapes.append(box(f"o{k}", at, size, float(rng.uniform(-90, 90)), material))
        elif kind == 1:
            # level with the plane, from which it is apart
            lifted = foot + max(high, 1e-6) * normal
            shapes.append(rectangle(f"o{k}", lifted, a * u, b * v * (1 if rng.random() < 0.5 else -1), material))
        elif kind == 2:
            # upright on it, or leaning over it
            shapes.append(rectangle(f"o{k}", at, a * u, b * _about(rng, normal, float(rng.uniform(0, 1.5))), material))
        elif kind == 3:
            # through it
            shapes.append(rectangle(f"o{k}", foot - 0.3 * normal, a * _turned(rng), normal + 0.4 * u, material))
        elif kind == 4:
            shapes.append(triangle(f"o{k}", foot + rng.uniform(-0.6, 0.6, (3, 3)) + 0.5 * normal, material))
        else:
            size = float(rng.uniform(0.1, 0.4))
            more = {"position": (at + size * normal).tolist(), "scale": size, "rotation": float(rng.uniform(0, 90))}
            shapes.append(nets.mesh(f"o{k}", net(rng, int(rng.integers(4))), material, **more))
    return shapes


def _light(rng: np.random.Generator, planes: list[tuple[Array, Array]], shapes: list[Scene], lit: bool) -> Scene:
    """A sun that grazes or has set, a point or a spot near a plane or far away, a lamp at a plane, a sky.

    Where much is to be ``lit`` the sun is up, and what is near stands well over its plane.
    """
    point, normal = planes[int(rng.integers(len(planes)))]
    kind = int(rng.choice([0, 2, 3, 4, 5])) if lit else int(rng.integers(8))
    side = _about(rng, normal, 0.5 * math.pi)
    if kind < 2:
        height = float(rng.choice([-1.0, 1.0, 1.0])) * 10.0 ** rng.uniform(-9, -1) if kind else rng.uniform(0.1, 3.0)
        return {"type": "directional", "direction": (-side - height * normal).tolist(), "irradiance": list(LIGHT)}
    if kind == 2:
        return SKY | {"radiance": list(LIGHT)}
    if kind == 3:
        foot = point + 10.0 ** rng.uniform(LOWEST, 0.3) * normal
        a, b = rng.uniform(0.1, 0.8, 2)
        turn = normal if rng.random() < 0.5 else np.cross(normal, side)
        shapes.append(rectangle("glow", foot, a * side, b * turn * rng.choice([-1.0, 1.0]), "grey"))
        return lamp(shapes[-1], list(LIGHT))
    high = 10.0 ** rng.uniform(-0.7 if lit else -4.0, 0.3)
    far = 0.0 if kind < 6 else 10.0 ** rng.uniform(1.0, FARTHEST - 1.0)
    at = _on(rng, normal, point, 0.7) + far * side + high * normal * (-1.0 if rng.random() < 0.1 and not lit else 1.0)
    light: Scene = {"position": at.tolist(), "intensity": [c * (1.0 + far) ** 2 for c in LIGHT]}
    if kind in (5, 7):
        aim = -_about(rng, side if far else normal, float(rng.uniform(0.0, 1.4)))
        cutoff = float(rng.choice([5.0, 30.0, 70.0]))
        return light | {"type": "spot", "direction": aim.tolist(), "cutoff": cutoff, "beam": 0.6 * cutoff}
    return light | {"type": "point"}


def plains(
    seed: int, scale: float, count: int, bounces: Any = 1, lit: bool = False
) -> tuple[Scene, Array, Array]:  # fmt: skip
    """(scene, origins, unit directions of ``count`` rays): some towards faces, some far out on planes.

    Where much is to be ``lit`` faces show both sides, lights are not hidden by planes, and few places are far out.
    """
    rng = np.random.default_rng([seed, 4711])
    planes = _planes(rng)
    shapes = _shapes(rng, planes)
    if lit:
        shapes = [shape | {"material": "both"} for shape in shapes]
    light = {"name": "key"} | _light(rng, planes, shapes, lit)
    made = [plane(f"p{k}", p, n, COLOURS[int(rng.integers(4))]) for k, (p, n) in enumerate(planes)]
    if rng.random() < 0.5:
        shapes = [*made, *shapes]
    else:
        shapes = [*shapes, *made]
    origins, directions = [], []
    for _ in range(count):
        point, normal = planes[int(rng.integers(len(planes)))]
        if rng.random() < (0.05 if lit else 0.25):
            target = _on(rng, normal, point, 10.0 ** rng.uniform(0.0, FARTHEST))
            eye = target + 10.0 ** rng.uniform(-1, 2) * _about(rng, normal, float(rng.uniform(0, 1.4)))
        else:
            target = _on(rng, normal, point, 1.0) + 0.4 * normal
            eye = target + 10.0 ** rng.uniform(-0.5, 1.0) * _about(rng, normal, float(rng.uniform(0, 1.5)))
        way = target - eye + 0.05 * _turned(rng) * (rng.random() < 0.5)
        origins.append(scale * eye)
        directions.append(way / np.linalg.norm(way))
    grow(shapes, scale)
    for shape in made:
        shape["point"] = [scale * c for c in shape["point"]]
    if "position" in light:
        light["position"] = [scale * c for c in light["position"]]
        light["intensity"] = [min(1e12, scale * scale * c) for c in light["intensity"]]
    return world(*shapes, lights=[light], materials=MATERIALS, bounces=bounces), np.array(origins), np.array(directions)
