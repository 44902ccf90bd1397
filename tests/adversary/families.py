"""Scenes chosen to be nasty: one generator whose every choice a family may replace."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from .case import Case

Rng = np.random.Generator
Scene = dict[str, Any]

USUAL: Final[Mapping[str, list[Any]]] = {
    "spheres": [1, 1, 2, 2, 3, 4],
    "place": ["free", "free", "buried", "touching", "beside", "nested", "low"],
    "radius": [0.1, 0.3, 0.5, 0.7, 1.0],
    "color": ["random", "black", "white", "one", "two"],
    "texture": ["solid", "solid", "solid", "checker", "stripes", "marble"],
    "ku": [0.0, 1.0, 2.0, 3.0, 8.0, 2.5],
    "kv": [0.0, 1.0, 2.0, 4.0, 8.0, 1.3],
    "dark": [0.0, 0.2, 0.9, 1.0],
    "exponent": [0.0, 0.3, 1.0, 2.5, 5.0, 16.0, 64.0, 300.0, 1e4, 1e6],
    "theta_max": [0.001, 0.02, 0.1, 0.5, math.pi / 3, 1.2, 1.5, math.pi / 2],
    "mirror": [False],
    "floor": ["solid", "checker", "checker", "none"],
    "cell": [0.05, 0.3, 1.0, 7.0],
    "lights": [0, 1, 1, 2, 3],
    "light": ["point", "point", "disk"],
    "where": ["above", "above", "above", "back", "low"],
    "light_radius": [0.1, 0.5, 1.0, 2.0],
    "light_color": ["white", "random", "one", "black"],
    "ambient": [(0.0, 0.0, 0.0), (0.1, 0.2, 0.3)],
    "background": [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.3, 0.2, 0.5), (0.0, 0.0, 2.0)],
    "model": ["blinn", "phong"],
    "ka": [0.0, 0.1],
    "kd": [0.0, 0.7],
    "ks": [0.0, 1.0, 0.5],
    "shininess": [0.0, 0.5, 1.0, 3.0, 8.0, 20.0, 120.0, 500.0, 1e4],
    "view": ["ray", "eye"],
    "terminator": ["cut", "open"],
    "units": ["lobe_average", "lobe_average", "lobe_average", "brdf_normalised"],
    "eye": ["usual", "usual", "grazing", "near", "above"],
    "surface": ["floor", "sphere"],
    "aim": ["sphere", "sphere", "edge", "random"],
    "disk": ["1x1", "2x2"],
    "tol": [1e-3, 1e-4, 1e-5, 1e-6],
    "points": [1, 1, 2],
    "budget": [1_000_000],
    "scale": [1.0],
}

FAMILIES: Final[Mapping[str, Mapping[str, list[Any]]]] = {
    "anything": {},
    "highlight": {
        "spheres": [1, 1, 2], "color": ["black"], "texture": ["solid"], "place": ["free"], "lights": [1],
        "light": ["point"], "light_color": ["white"], "kd": [0.0], "ka": [0.0], "ks": [1.0], "floor": ["black"],
        "ambient": [(0.0, 0.0, 0.0)],
        "background": [(0.0, 0.0, 0.0)], "shininess": [32.0, 100.0, 500.0, 2e3, 1e4, 1e5], "aim": ["sphere"],
        "exponent": [0.0, 1.0, 5.0, 16.0, 64.0], "theta_max": [0.5, math.pi / 3, 1.5, math.pi / 2], "points": [1],
        "terminator": ["cut", "cut", "open"], "where": ["above", "above", "back", "low"],
    },
    "sharp": {"shininess": [120.0, 1e3, 1e4, 1e5, 1e6], "ks": [1.0], "lights": [1, 2], "kd": [0.0, 0.7]},
    "open": {"terminator": ["open"], "ks": [1.0], "shininess": [0.0, 0.5, 3.0, 20.0, 500.0], "lights": [1, 2],
             "where": ["back", "back", "low", "above"]},
    "buried": {"place": ["buried", "buried", "low", "touching"], "spheres": [2, 3], "exponent": [0.0, 1.0, 5.0, 16.0]},
    "touching": {"place": ["touching", "beside", "beside", "nested"], "spheres": [2, 3, 4]},
    "textures": {"texture": ["checker", "stripes", "marble"], "kd": [0.7], "lights": [1, 2],
                 "ku": [0.0, 0.0, 0.5, 1.0, 3.0, 8.0, 31.0, 64.0, 2.5], "kv": [0.0, 0.0, 0.5, 1.0, 4.0, 17.0, 1.3],
                 "dark": [0.0, 0.2, 0.9]},
    "checker": {"floor": ["checker"], "cell": [0.002, 0.02, 0.05, 0.1, 0.3], "kd": [0.7], "ka": [0.1],
                "ambient": [(0.1, 0.2, 0.3)], "lights": [0, 1], "surface": ["sphere"], "spheres": [1, 2]},
    "narrow": {"exponent": [300.0, 1e4, 1e6], "theta_max": [0.001, 0.02, 0.1, math.pi / 2], "lights": [1, 2],
               "aim": ["edge", "sphere"]},
    "mirror": {"mirror": [True], "shininess": [3.0, 120.0, 1e4, 1e6], "lights": [1, 2], "aim": ["edge", "sphere"]},
    "odd lights": {"where": ["below", "inside", "plane", "center", "plane", "contact"], "lights": [1, 2]},
    "odd disks": {"where": ["plane", "through", "through", "below", "above"], "light": ["disk"], "lights": [1, 2],
                  "aimed": ["edge", "random"]},
    "exact": {"disk": ["exact"], "light": ["disk", "disk", "point"], "lights": [1, 1, 2], "tol": [1e-4, 1e-5],
              "spheres": [1, 2], "where": ["above", "above", "through", "plane", "low"], "points": [2, 3],
              "light_color": ["white", "random", "one", "two"], "aimed": ["usual", "edge", "random"]},
    "crowd": {"lights": [4, 8], "spheres": [4, 6], "disk": ["1x1", "2x2"], "tol": [1e-4, 1e-5]},
    "brdf": {"units": ["brdf_normalised"], "lights": [1, 2]},
    "symmetric": {"symmetric": [True], "lights": [1, 2], "spheres": [1, 2]},
    "scales": {"radius": [1e-4, 1e-3, 1e-2, 0.1, 1.0, 30.0, 300.0, 1e3], "lights": [1, 2]},
    "grazing": {"eye": ["grazing"], "theta_max": [0.5, 1.2, math.pi / 2], "lights": [1, 2]},
    "budget": {"budget": [2_000, 20_000, 40_000, 60_000], "tol": [1e-6, 1e-8, 1e-10], "lights": [1, 2, 3],
               "cell": [0.02, 0.05, 0.3], "disk": ["1x1", "2x2", "exact"], "light": ["disk"]},
    "far checker": {"floor": ["checker"], "cell": [0.05, 0.15, 0.3, 0.6, 1.0], "kd": [0.7], "lights": [1, 2],
                    "light": ["point"], "where": ["above", "above", "low"], "surface": ["sphere"], "spheres": [1, 2],
                    "place": ["free", "free", "beside"], "exponent": [0.0, 1.0, 4.0, 20.0, 100.0],
                    "theta_max": [0.3, 1.0, 1.3, math.pi / 2], "ambient": [(0.0, 0.0, 0.0)],
                    "background": [(0.0, 0.0, 0.0)], "aim": ["random", "edge"], "tol": [1e-4, 1e-5, 1e-6]},
}  # fmt: skip
"""What each family replaces of the usual choices."""


def generate(family: str, seed: int) -> Case:
    """Case ``seed`` of a family; the same at every call."""
    rng = np.random.default_rng((list(FAMILIES).index(family), seed))
    knobs = {**USUAL, "symmetric": [False], "aimed": ["usual"], **FAMILIES[family]}

    def pick(name: str) -> Any:
        options = knobs[name]
        return options[int(rng.integers(len(options)))]

    while True:
        scene = _scene(rng, pick)
        surface = pick("surface")
        lobes = [f"spheres.{s['name']}" for s in scene["spheres"]]
        if surface == "floor" and "floor" not in scene:
            surface = "sphere"
        if surface == "sphere":
            surface = lobes[int(rng.integers(len(lobes)))]
        points = [p for _ in range(4 * pick("points")) if (p := _point(rng, pick, scene, surface)) is not None]
        if points:
            break
    return Case(family, seed, scene, surface, points[: pick("points")], pick("disk"), pick("tol"), pick("budget"))


def _color(rng: Rng, kind: str) -> list[float]:
    match kind:
        case "black":
            return [0.0, 0.0, 0.0]
        case "white":
            return [1.0, 1.0, 1.0]
        case "one":
            return np.roll([float(rng.random()), 0.0, 0.0], int(rng.integers(3))).tolist()
        case "two":
            return np.roll([float(rng.random()), float(rng.random()), 0.0], int(rng.integers(3))).tolist()
        case _:
            return rng.random(3).tolist()


def _lobe(pick: Any) -> dict[str, Any]:
    lobe = {"weight": pick("exponent") * 0.0 + 1.0, "exponent": pick("exponent"), "theta_max": pick("theta_max")}
    return {"weight": 1.0, "mirror": True} if pick("mirror") else lobe


def _sphere(rng: Rng, pick: Any, others: list[dict[str, Any]], symmetric: bool) -> dict[str, Any]:
    radius = float(pick("radius"))
    kind = pick("place")
    if radius < 0.05 and kind in ("free", "low"):
        kind = "near"
    center = np.append(rng.uniform(-2.0, 2.0, 2), radius * (1.0 + 2.0 * rng.random()))
    if symmetric:
        center = np.array(
            [float(rng.integers(-1, 2)), float(rng.integers(-1, 2)), radius * float(rng.choice([0.0, 1.0, 1.5, 2.0]))]
        )
    elif kind == "buried":
        center[2] = float(rng.choice([0.0, 0.0, 0.5 * radius * rng.uniform(-1.0, 1.0)]))
    elif kind == "touching":
        center[2] = radius
    elif kind == "low":
        center[2] = radius * rng.uniform(-0.9, 1.0)
    if others and kind in ("beside", "nested", "near"):
        other = others[int(rng.integers(len(others)))]
        away = rng.normal(size=3)
        away /= np.linalg.norm(away)
        away[2] = abs(away[2])
        reach = other["radius"] + radius if kind == "beside" else other["radius"] * rng.uniform(0.0, 1.0)
        if kind == "near":
            reach = other["radius"] + radius * rng.uniform(1.0, 20.0)
        elif rng.random() < 0.3:
            reach *= rng.uniform(0.7, 1.0)
        center = np.array(other["center"]) + reach * away
    texture: dict[str, Any] = {"type": pick("texture")}
    if texture["type"] != "solid":
        texture["ku"] = pick("ku")
        if texture["type"] != "stripes":
            texture["kv"] = pick("kv")
        if texture["type"] != "marble":
            texture["dark"] = pick("dark")
    return {
        "name": f"S{len(others)}", "center": center.tolist(), "radius": radius, "color": _color(rng, pick("color")),
        "texture": texture, "lobe": _lobe(pick),
    }  # fmt: skip


def _light(rng: Rng, pick: Any, k: int, spheres: list[dict[str, Any]], symmetric: bool) -> dict[str, Any]:
    where = pick("where")
    turn = rng.uniform(-math.pi, math.pi)
    reach = rng.uniform(2.0, 7.0)
    place = np.array([reach * math.cos(turn), reach * math.sin(turn), rng.uniform(1.0, 8.0)])
    sphere = spheres[int(rng.integers(len(spheres)))]
    match where:
        case "back":
            place = np.array([rng.uniform(-3.0, 3.0), rng.uniform(2.0, 6.0), rng.uniform(0.1, 7.0)])
        case "low":
            place[2] = rng.uniform(0.01, 0.5)
        case "below":
            place[2] = -rng.uniform(0.01, 3.0)
        case "plane":
            place[2] = 0.0
        case "through":
            place[2] = rng.uniform(-0.4, 0.4)
        case "inside":
            place = np.array(sphere["center"]) + sphere["radius"] * rng.uniform(-0.5, 0.5, 3)
        case "center":
            place = np.array(sphere["center"])
        case "contact":
            away = rng.normal(size=3)
            place = np.array(sphere["center"]) + sphere["radius"] * away / np.linalg.norm(away) * rng.choice(
                [1.0, 1.001, 1.1]
            )
    if symmetric:
        place = np.array([float(rng.integers(-3, 4)), float(rng.integers(-3, 4)), float(rng.integers(0, 6))])
    light: dict[str, Any] = {
        "name": f"L{k}",
        "type": pick("light"),
        "position": place.tolist(),
        "color": _color(rng, pick("light_color")),
    }
    if light["type"] == "disk":
        light["radius"] = pick("light_radius")
        target = rng.uniform(-1.0, 1.0, 3)
        match pick("aimed"):
            case "edge":
                target = place + np.array([1.0, 0.0, 0.0])
            case "random":
                target = place + rng.normal(size=3)
        if np.linalg.norm(target - place) < 1e-6:
            target = place + np.array([0.0, 0.0, -1.0])
        light["target"] = target.tolist()
    return light


def _scene(rng: Rng, pick: Any) -> Scene:
    symmetric = bool(pick("symmetric"))
    spheres: list[dict[str, Any]] = []
    for _ in range(pick("spheres")):
        spheres.append(_sphere(rng, pick, spheres, symmetric))
    eye = np.array([rng.uniform(-3.5, 3.5), rng.uniform(-7.0, -4.5), rng.uniform(1.0, 4.0)])
    match pick("eye"):
        case "grazing":
            eye[2] = float(rng.choice([0.001, 0.02, 0.1, 0.3]))
        case "near":
            eye = 0.5 * eye
        case "above":
            eye = np.array([0.1 * eye[0], 0.1 * eye[1], 6.0])
    if symmetric:
        eye = np.array([0.0, -float(rng.integers(3, 8)), float(rng.integers(0, 4)) + 1.0])
    scene: Scene = {
        "camera": {"type": "look_at", "eye": eye.tolist(), "target": [0.0, 0.0, 0.3], "fov": 40.0},
        "spheres": spheres,
        "lights": [_light(rng, pick, k, spheres, symmetric) for k in range(pick("lights"))],
        "ambient": list(pick("ambient")),
        "background": list(pick("background")),
        "shading": {
            "model": pick("model"),
            "ka": pick("ka"), "kd": pick("kd"), "ks": pick("ks"), "shininess": pick("shininess"),
            "highlight_view": pick("view"), "specular_terminator": pick("terminator"), "lobe_units": pick("units"),
        },
    }  # fmt: skip
    kind = pick("floor")
    if kind == "none":
        return scene
    texture: dict[str, Any] = {"type": "solid", "color": [0.0, 0.0, 0.0] if kind == "black" else _color(rng, "random")}
    if kind == "checker":
        offset = [0.0, 0.0] if rng.random() < 0.5 else rng.uniform(-1.0, 1.0, 2).tolist()
        texture = {
            "type": "checker",
            "bright": _color(rng, "random"),
            "dark": _color(rng, "random"),
            "cell": pick("cell"),
            "offset": offset,
        }
    scene["floor"] = {"texture": texture, "lobe": _lobe(pick)}
    return scene


def _point(rng: Rng, pick: Any, scene: Scene, surface: str) -> list[float] | None:
    """A place of the surface that faces the eye, mostly one whose mirror direction meets something."""
    eye = np.array(scene["camera"]["eye"])
    aim = pick("aim")
    if surface != "floor":
        sphere = next(s for s in scene["spheres"] if f"spheres.{s['name']}" == surface)
        center, radius = np.array(sphere["center"]), sphere["radius"]
        others = [s for s in scene["spheres"] if s is not sphere]
        for _ in range(200):
            normal = rng.normal(size=3)
            if pick("symmetric"):
                normal = np.round(normal)
            size = math.hypot(*normal)
            if size == 0.0:
                continue
            normal /= size
            place = center + radius * normal
            if (eye - place) @ normal <= 1e-3 * math.dist(eye, place):
                continue
            if "floor" in scene and place[2] < 0.0 and rng.random() < 0.8:
                continue
            if any(math.dist(place, s["center"]) < s["radius"] for s in others):
                continue
            return normal.tolist()
        return None
    for _ in range(50):
        sphere = scene["spheres"][int(rng.integers(len(scene["spheres"])))]
        away = rng.normal(size=3)
        away /= np.linalg.norm(away)
        reach = sphere["radius"] * {"sphere": 0.9 * rng.random(), "edge": 1.0}.get(aim, 3.0 * rng.random())
        goal = np.array(sphere["center"]) + reach * away
        if goal[2] <= 0.0:
            continue
        t = eye[2] / (eye[2] + goal[2])
        place = eye + t * (goal - eye)
        if pick("symmetric"):
            place = np.round(place)
        place[2] = 0.0
        clear = all(math.dist(place, s["center"]) >= s["radius"] for s in scene["spheres"])
        if (clear or rng.random() < 0.05) and math.hypot(place[0], place[1]) < 1e4:
            return place.tolist()
    return None
