"""A scene as plain numbers, read from a plain dict by the documented rules; nothing of the package is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Case = Mapping[str, Any]

SOLID: Final = 0
CHECKER: Final = 1
STRIPES: Final = 2
MARBLE: Final = 3

# columns of World.rules
KA: Final = 0
KD: Final = 1
KS: Final = 2
SHININESS: Final = 3
PHONG: Final = 4
FROM_EYE: Final = 5
OPEN: Final = 6
AMBIENT: Final = 7
BACKGROUND: Final = 10
EYE: Final = 13
RULES: Final = 16

# columns of a lobe: where it stands, its normal and mirror direction, its law, the surface it leaves (0 the floor,
# 1 + j sphere j), whether in BRDF units, 1 - cos theta_max, 1 - cos^(n+1) theta_max, two directions across the mirror's
PLACE: Final = 0
NORMAL: Final = 3
MIRROR: Final = 6
EXPONENT: Final = 9
THETA_MAX: Final = 10
SURFACE: Final = 11
BRDF: Final = 12
HEIGHT: Final = 13
MASS: Final = 14
ACROSS: Final = 15
LOBE: Final = 21


class World(NamedTuple):
    """``spheres`` (n, 11): centre, radius, colour, texture, ku, kv, dark; radius 0 where it stands for none.

    ``floor`` (11,): present, checkered, bright, dark, cell, offset. ``points`` (p, 6): place and colour of point
    lights. ``disks`` (m, 12): centre, two half-axes, colour, of disks taken whole. ``rules`` (RULES,).
    """

    spheres: Array
    floor: Array
    points: Array
    disks: Array
    rules: Array


def world_of(scene: Case, disk: str) -> World:
    """The numbers of a scene; ``disk`` is ``exact`` or ``KxK``."""
    return World(_spheres(scene), _floor(scene), *_lights(scene, disk), _rules(scene))


def _spheres(scene: Case) -> Array:
    rows = np.zeros((len(scene.get("spheres", ())), 11))
    seen: set[tuple[float, ...]] = set()
    for row, sphere in zip(rows, scene.get("spheres", ()), strict=True):
        place = (*map(float, sphere["center"]), float(sphere["radius"]))
        row[:4], row[4:7] = place, sphere.get("color", (0.5, 0.5, 0.5))
        if place in seen:
            row[3] = 0.0
        seen.add(place)
        texture = sphere.get("texture", {"type": "solid"})
        kind = ("solid", "checker", "stripes", "marble").index(texture["type"])
        row[7:] = kind, texture.get("ku", 8.0), texture.get("kv", 4.0), texture.get("dark", 0.2)
    return rows


def _floor(scene: Case) -> Array:
    row = np.zeros(11)
    floor = scene.get("floor")
    if floor is None:
        return row
    texture = floor.get("texture", {"type": "checker"})
    row[0], row[8] = 1.0, 1.0
    if texture["type"] == "solid":
        row[2:5] = row[5:8] = texture.get("color", (0.5, 0.5, 0.5))
    else:
        row[1] = 1.0
        row[2:5], row[5:8] = texture.get("bright", (0.6375, 0.6375, 0.85)), texture.get("dark", (0.1125, 0.1125, 0.15))
        row[8], row[9:11] = texture.get("cell", 1.0), texture.get("offset", (0.0, 0.0))
    return row


def _unit(v: Array) -> Array:
    return v / math.hypot(*v.tolist())


def _axes(light: Case) -> tuple[Array, Array, Array]:
    center = np.array(light["position"], float)
    w = _unit(np.array(light.get("target", (0.0, 0.0, 0.0)), float) - center)
    up = np.array([0.0, 1.0, 0.0] if abs(w[1]) < 0.9 else [1.0, 0.0, 0.0])
    e1 = _unit(np.cross(w, up))
    return center, light["radius"] * e1, light["radius"] * np.cross(w, e1)


def _lights(scene: Case, disk: str) -> tuple[Array, Array]:
    points: list[list[float]] = []
    disks: list[list[float]] = []
    for light in scene.get("lights", ()):
        color = np.array(light.get("color", (1.0, 1.0, 1.0)), float)
        if light.get("type", "point") == "point" or light["radius"] == 0.0:
            points.append([*light["position"], *color])
            continue
        center, a, b = _axes(light)
        if disk == "exact":
            disks.append([*center, *a, *b, *color])
            continue
        order = int(disk.partition("x")[0])
        for i in range(order):
            for j in range(order):
                r, turn = math.sqrt((i + 0.5) / order), 2.0 * math.pi * (j + 0.5) / order
                at = center + r * (math.cos(turn) * a + math.sin(turn) * b)
                points.append([*at, *(color / order**2)])
    return np.array(points, float).reshape(-1, 6), np.array(disks, float).reshape(-1, 12)


def _rules(scene: Case) -> Array:
    shading = scene.get("shading", {})
    rules = np.zeros(RULES)
    rules[:4] = [
        shading.get(k, v) for k, v in (("ka", 0.1), ("kd", 0.7), ("ks", 0.5), ("shininess", 32.0))
    ]  # the documented defaults
    rules[PHONG] = shading.get("model", "blinn") == "phong"
    rules[FROM_EYE] = shading.get("highlight_view", "ray") == "eye"
    rules[OPEN] = shading.get("specular_terminator", "cut") == "open"
    rules[AMBIENT : AMBIENT + 3] = scene.get("ambient", (0.0, 0.0, 0.0))
    rules[BACKGROUND : BACKGROUND + 3] = scene.get("background", (0.0, 0.0, 0.0))
    rules[EYE:] = scene["camera"]["eye"]
    return rules


def lobe_of(scene: Case, surface: str, point: Any) -> Array:
    """The lobe of ``surface`` at a point of the floor, or where its unit normal is ``point``."""
    given = np.array(point, float)
    if surface == "floor":
        place, normal, own, shape = np.array([given[0], given[1], 0.0]), np.array([0.0, 0.0, 1.0]), 0, scene["floor"]
    else:
        index = [f"spheres.{s['name']}" for s in scene["spheres"]].index(surface)
        shape = scene["spheres"][index]
        # equal spheres are one: what leaves the later leaves the first
        places = [(*map(float, s["center"]), float(s["radius"])) for s in scene["spheres"]]
        own = 1 + places.index(places[index])
        normal = _unit(given)
        place = np.array(shape["center"], float) + shape["radius"] * normal
    law = shape["lobe"]
    theta_max = 0.0 if law.get("mirror", False) else law.get("theta_max", math.pi / 3)
    exponent = law.get("exponent", 16.0)
    incoming = _unit(place - np.array(scene["camera"]["eye"], float))
    mirror = _unit(incoming - 2.0 * (incoming @ normal) * normal)
    least = int(np.argmin(np.abs(mirror)))
    across = _unit(np.cross(mirror, np.eye(3)[least]))
    height = min(1.0, 2.0 * math.sin(theta_max / 2.0) ** 2)
    mass = 1.0 if height == 1.0 else -math.expm1((exponent + 1.0) * math.log1p(-height))
    brdf = scene.get("shading", {}).get("lobe_units", "lobe_average") == "brdf_normalised"
    lobe = np.zeros(LOBE)
    lobe[PLACE:EXPONENT] = (*place, *normal, *mirror)
    lobe[EXPONENT:ACROSS] = exponent, theta_max, own, brdf, height, mass
    lobe[ACROSS:] = (*across, *np.cross(mirror, across))
    return lobe
