"""Direct light, pixel by pixel: what ``truth`` says of its own direct layer against a tracer that shares nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .disk import disk_mean
from .families import FAMILIES, USUAL, Rng, Scene, _scene
from .light import albedo, nearest, outward_normal, seen, view_of
from .world import KD, KS, SHININESS, Array, World, world_of

SIZE = 5
_NEAR = 1e-9


@dataclass(frozen=True)
class Look:
    """One scene and how its image is asked for."""

    name: str
    scene: Scene
    disk: str
    tol: float


def hostile(seed: int) -> Look:
    """Scene ``seed``: lobes weigh nothing, lights and balls are where the rules of direct light change."""
    rng = np.random.default_rng((17, seed))
    family = str(rng.choice(["anything", "open", "buried", "touching", "textures", "odd lights", "odd disks", "exact",
                             "symmetric", "scales", "sharp", "grazing"]))  # fmt: skip
    knobs: dict[str, Any] = {**USUAL, "symmetric": [False], "aimed": ["usual", "edge", "random"], **FAMILIES[family]}
    knobs["lights"] = [1, 1, 2]
    if family not in ("odd lights", "odd disks", "open"):
        knobs["where"] = ["above", "above", "back", "low", "below", "inside", "plane", "through", "contact"]
    if rng.random() < 0.6:
        knobs["light"] = ["disk"]

    def pick(name: str) -> Any:
        options = knobs[name]
        return options[int(rng.integers(len(options)))]

    scene = _scene(rng, pick)
    for shape in [*scene["spheres"], *([scene["floor"]] if "floor" in scene else [])]:
        shape["lobe"]["weight"] = 0.0
    _turn_camera(rng, scene)
    return Look(f"{family}#{seed}", scene, str(rng.choice(["1x1", "2x2", "3x3", "exact", "exact", "exact"])),
                float(rng.choice([1e-4, 1e-6, 1e-8])))  # fmt: skip


def _turn_camera(rng: Rng, scene: Scene) -> None:
    """Cameras that face a ball closely, stand in one, below the floor or on a surface."""
    sphere = scene["spheres"][int(rng.integers(len(scene["spheres"])))]
    center, radius = np.array(sphere["center"]), float(sphere["radius"])
    camera = scene["camera"]
    kind = rng.random()
    if kind < 0.55:
        camera["target"] = (center + 0.5 * radius * rng.normal(size=3)).tolist()
        far = float(np.linalg.norm(center - camera["eye"]))
        camera["fov"] = float(np.clip(math.degrees(3.0 * radius / max(far, 1e-9)), 1.0, 120.0))
    elif kind < 0.62:
        camera["eye"] = (center + radius * rng.uniform(-0.5, 0.5, 3)).tolist()
        camera["fov"] = 120.0
    elif kind < 0.68:
        camera["eye"][2] = -camera["eye"][2]
    elif kind < 0.72:
        # on a surface, or as near as an eye may come to it without the last bits deciding on which side it is
        away = rng.normal(size=3)
        camera["eye"] = (center + radius * (1.0 + rng.choice([-1e-9, 1e-9])) * away / np.linalg.norm(away)).tolist()
        camera["fov"] = 120.0
    if np.linalg.norm(np.subtract(camera["eye"], camera["target"])) < 1e-6 * max(1.0, np.abs(camera["eye"]).max()):
        camera["target"] = np.add(camera["eye"], (0.3, 0.4, -0.2)).tolist()


def ray(scene: Scene, i: int, j: int, width: int, height: int) -> Array:
    """Unit direction through the centre of a pixel of a ``look_at`` camera."""
    camera = scene["camera"]
    eye, target = np.array(camera["eye"], float), np.array(camera.get("target", (0.0, 0.0, 0.0)), float)
    f = (target - eye) / np.linalg.norm(target - eye)
    r = np.cross(f, np.array(camera.get("up", (0.0, 0.0, 1.0)), float))
    r /= np.linalg.norm(r)
    u = np.cross(r, f)
    h = math.tan(0.5 * math.radians(camera.get("fov", 40.0)))
    d = f + h * (width / height) * (2.0 * (i + 0.5) / width - 1.0) * r + h * (1.0 - 2.0 * (j + 0.5) / height) * u
    along: Array = d / np.linalg.norm(d)
    return along


@dataclass(frozen=True)
class Light:
    """Radiance (3,) of a ray, its doubt, the hit class and whether a ball was met from inside."""

    value: Array
    doubt: float
    shape: int
    inside: bool


def light_along(world: World, eye: Array, direction: Array, tol: float, turn: float = 0.4) -> Light:
    """Direct light of what a ray from the eye meets: point lights literally, whole disks line by line."""
    o, d = tuple(eye.tolist()), tuple(direction.tolist())
    dark = World(world.spheres, world.floor, world.points, world.disks[:0], world.rules)
    rgb, bases = np.zeros(3), np.zeros(len(world.points))
    seen(dark, -1, o, d, np.empty(0), bases, rgb)
    shape, inside, t = nearest(dark, -1, o, d)
    if shape < 0 or (shape == 0 and d[2] > 0.0):
        return Light(rgb, 0.0, shape, inside)
    q, n = (o[0] + t * d[0], o[1] + t * d[1], 0.0), (0.0, 0.0, 1.0)
    if shape > 0:
        s = world.spheres[shape - 1]
        n = outward_normal(world.spheres, shape - 1, o, d, inside)
        q = (s[0] + s[3] * n[0], s[1] + s[3] * n[1], s[2] + s[3] * n[2])
    color = np.array(albedo(dark, shape, q, n)[:3])
    towards = (-n[0], -n[1], -n[2]) if inside else n
    doubt = 0.0
    for row in world.disks:
        c, s_, e = disk_mean(dark, shape, inside, q, towards, view_of(dark, q, d), row, turn, tol)
        rgb += row[9:] * (world.rules[KD] * color * c + world.rules[KS] * s_)
        doubt += float(row[9:].max()) * (world.rules[KD] + world.rules[KS]) * e
    return Light(rgb, doubt, shape, inside)


@dataclass(frozen=True)
class Contradiction:
    """A pixel whose direct light is not what it is said to be."""

    look: Look
    pixel: tuple[int, int]
    said: Array
    stated: float
    status: int
    found: Array
    doubt: float

    @property
    def off(self) -> float:
        """The largest difference over the channels."""
        return float(np.abs(self.said - self.found).max())


@dataclass
class Count:
    """What was looked at: pixels, those with light, those of whole disks cut by something, those without a value."""

    pixels: int = 0
    lit: int = 0
    disks: int = 0
    unsupported: int = 0
    edges: int = 0


def judge_direct(look: Look, count: Count, size: int = SIZE) -> list[Contradiction]:
    """Judge every pixel of an image of ``size``."""
    import symrender as sr

    image = sr.truth(look.scene, size=size, tol=look.tol, disk=look.disk, aa="none", threads=1)
    world = world_of(look.scene, look.disk)
    eye = np.array(look.scene["camera"]["eye"], float)
    wrong = []
    for j in range(size):
        for i in range(size):
            said, stated = image.layers["direct"][j, i], float(image.layers["error"][j, i])
            status = int(image.layers["status"][j, i])
            count.pixels += 1
            if status == 3:
                count.unsupported += 1
                continue
            d = ray(look.scene, i, j, size, size)
            found = light_along(world, eye, d, 0.01 * look.tol if len(world.disks) else 1e-12)
            count.lit += bool(found.value.max() > 0.0)
            count.disks += bool(len(world.disks) and found.shape >= 0)
            doubt = found.doubt + 1e-12 * (1.0 + float(np.abs(found.value).max()))
            doubt += 4e-15 * float(world.rules[SHININESS]) * float(np.abs(found.value).max())
            if np.abs(said - found.value).max() <= stated + doubt:
                continue
            # beside an edge, where the last bits decide, the doubt is what a step aside changes
            for k in range(3):
                for sign in (_NEAR, -_NEAR):
                    aside = d.copy()
                    aside[k] += sign
                    other = light_along(world, eye, aside / np.linalg.norm(aside), 0.01 * look.tol)
                    doubt = max(doubt, float(np.abs(other.value - found.value).max()))
            again = light_along(world, eye, d, 0.001 * look.tol, turn=1.3)
            doubt += float(np.abs(again.value - found.value).max())
            if np.abs(said - again.value).max() <= stated + doubt:
                count.edges += 1
                continue
            wrong.append(Contradiction(look, (i, j), said, stated, status, again.value, doubt))
    return wrong
