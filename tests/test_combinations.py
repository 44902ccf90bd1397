"""No combination of what a radiometric scene may hold is refused: its image is computed, and what its lights add to it.

Combinations are drawn from the whole product of shapes, materials, lights, bounces, filters, lens and shutter.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.images.exr import encode

WAVES = {"sin": {"mul": [5, "x"]}}
CHECKER = {"type": "checker", "bright": 0.7, "dark": 0.2, "cell": 0.3}


def pixels(high: int, wide: int) -> str:
    """An image file as a scene holds it."""
    values = np.random.default_rng(12).random((high, wide, 3)) * 0.9
    return base64.b64encode(encode({"radiance": values}, {})).decode("ascii")


MATERIALS: dict[str, dict[str, Any]] = {
    "clay": {"type": "diffuse", "reflectance": 0.6, "two_sided": True},
    "tiles": {"type": "diffuse", "reflectance": CHECKER, "two_sided": True},
    "stone": {"type": "diffuse", "reflectance": CHECKER | {"type": "marble"}, "two_sided": True},
    "board": {"type": "diffuse", "reflectance": {"type": "checkerboard", "scale": [3, 3]}, "two_sided": True},
    "picture": {"type": "diffuse", "reflectance": {"type": "image", "data": pixels(3, 4)}, "two_sided": True},
    "waves": {"type": "diffuse", "reflectance": 0.6, "bump": {"height": WAVES, "amplitude": 0.05}, "two_sided": True},
    "ggx": {"type": "conductor", "alpha": 0.3, "eta": 1.5, "k": 3, "two_sided": True},
    "beckmann": {"type": "conductor", "distribution": "beckmann", "alpha": 0.3, "eta": 1.5, "k": 3, "two_sided": True},
    "phong": {"type": "phong", "exponent": 20, "reflectance": 0.5, "two_sided": True},
    "mirror": {"type": "conductor", "material": "Cr", "alpha": 0, "two_sided": True},
    "glass": {"type": "dielectric", "ior": 1.5, "reflectance": CHECKER},
    "pane": {"type": "dielectric", "ior": 1.5, "thin": True, "transmittance": 0.9},
    "frosted": {"type": "dielectric", "ior": 1.5, "alpha": 0.2},
    "plastic": {"type": "plastic", "ior": 1.5, "diffuse": CHECKER, "two_sided": True},
    "worn": {"type": "plastic", "ior": 1.5, "alpha": 0.2, "bump": {"height": WAVES, "amplitude": 0.05}},
}
SHAPES: dict[str, dict[str, Any]] = {
    "sphere": {"type": "sphere", "center": [0, 0, 0.5], "radius": 0.5},
    "rectangle": {"type": "rectangle", "corner": [-1, 0.5, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 1]},
    "triangle": {"type": "triangle", "vertices": [[-1, 0.5, 0.1], [1, 0.5, 0.1], [0, 0.5, 1.5]]},
    "disk": {"type": "disk", "center": [0, 0.5, 0.6], "normal": [0, -1, 0], "radius": 0.5},
    "tube": {"type": "cylinder", "base": [0, 0, 0.1], "axis": [0.1, 0.2, 0.9], "radius": 0.4},
    "can": {"type": "cylinder", "base": [0, 0, 0.1], "axis": [0.1, 0.2, 0.9], "radius": 0.4, "caps": True},
    "box": {"type": "box", "center": [0, 0, 0.5], "size": [0.8, 0.8, 0.8]},
    "mesh": {
        "type": "mesh",
        "vertices": [[-0.6, 0, 0.1], [0.6, 0, 0.1], [0, 0.6, 0.1], [0, 0.2, 1.1]],
        "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    },
    "smooth": {
        "type": "mesh",
        "vertices": [[-0.6, 0, 0.1], [0.6, 0, 0.1], [0, 0.6, 0.1], [0, 0.2, 1.1]],
        "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        "uv": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "shading_normals": "use",
    },
    "plane": {"type": "plane", "point": [0, 2, 0], "normal": [0, -1, 0]},
}
LAMPS: dict[str, dict[str, Any] | None] = {
    "point": {"type": "point", "position": [-2, -3, 4], "intensity": 50},
    "spot": {"type": "spot", "position": [-2, -3, 4], "direction": [2, 3, -4], "intensity": 9, "beam": 9, "cutoff": 30},
    "sun": {"type": "directional", "direction": [1, 1, -2], "irradiance": 2},
    "sky": {"type": "sky", "radiance": 0.5},
    "surroundings": {"type": "environment", "data": pixels(4, 8), "rotation": 20, "scale": 0.5},
    "globe": None,
    "panel": None,
    "lamp": None,
}  # fmt: skip
EMITTERS: dict[str, dict[str, Any]] = {
    "globe": {"type": "sphere", "center": [-2, -2, 3], "radius": 0.4},
    "panel": {"type": "rectangle", "corner": [-1, -1, 4], "edge_u": [0, 2, 0], "edge_v": [2, 0, 0]},
    "lamp": {"type": "cylinder", "base": [-1, -2, 3], "axis": [2, 0, 0], "radius": 0.2},
}
SENT = {"point": "intensity", "spot": "intensity", "sun": "irradiance", "sky": "radiance", "surroundings": "scale"}


SAMPLED = {
    "board", "picture", "smooth", "surroundings", "mirror", "glass", "pane", "frosted", "plastic", "worn", "tube",
    "can", "lamp",
}  # fmt: skip
"""What quadrature declines whatever else there is."""
OLD, SEEDS = 40, 60


def drawn(seed: int) -> tuple[dict[str, Any], dict[str, Any], str]:
    """A scene, options of its image, and the name of a number that a light of it sends."""
    rng = np.random.default_rng([seed, 44])
    # the first seeds draw from what quadrature knows
    pick = lambda names: str(rng.choice(sorted({*names} - (SAMPLED if seed < OLD else set()))))  # noqa: E731
    lamps = [pick(LAMPS) for _ in range(int(rng.integers(1, 3)))]
    if {*lamps} == {"sky", "surroundings"}:
        # a scene has one of both
        lamps = lamps[:1]
    shapes = [{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}] if rng.random() < 0.7 else []
    shapes += [SHAPES[pick(SHAPES)] for _ in range(int(rng.integers(1, 3)))]
    shapes = [each | {"name": f"S{k}", "material": pick(MATERIALS)} for k, each in enumerate(shapes)]
    lights: list[dict[str, Any]] = []
    for k, lamp in enumerate(dict.fromkeys(lamps)):
        made = LAMPS[lamp]
        if made is None:
            shapes.append(EMITTERS[lamp] | {"name": lamp, "material": "clay"})
            made = {"type": "area", "shape": lamp, "radiance": 5}
        lights.append(made | {"name": f"L{k}"})
    camera: dict[str, Any] = {"type": "look_at", "eye": [0.3, -6, 2.5], "target": [0, 0, 0.4], "fov": 10}
    if rng.random() < 0.4:
        camera |= {"aperture": 0.05, "focus": 6.0}
    if rng.random() < 0.4:
        camera |= {"velocity": [0.1, 0, 0]}
    scene = {
        "units": "radiometric", "name": "drawn", "camera": camera, "materials": MATERIALS, "shapes": shapes,
        "lights": lights, "bounces": [0, 1, 2, "all"][int(rng.integers(4))],
        "gloss": pick(["every_hit", "first_hit"]), "shutter": [0, 0.5] if "velocity" in camera else [0, 0],
    }  # fmt: skip
    first = SENT.get(lamps[0], "radiance")
    return scene, {"filter": pick(["centre", "box", "tent", "gaussian"])}, f"lights.L0.{first}.g"


@pytest.mark.parametrize("seed", range(SEEDS))
def test_every_combination_has_an_image_and_derivatives_by_its_lights(seed: int) -> None:
    scene, options, name = drawn(seed)
    image = sr.truth(scene, size=1, tol=0.05, budget=3_000, threads=1, **options)
    value, error = image.radiance[0, 0], image.layer("error")[0, 0]
    assert np.isfinite(value).all() and 0.0 <= error < np.inf
    slope = sr.gradient(scene, [name], size=1, tol=0.05, budget=3_000, threads=1, **options)[name]
    assert np.isfinite(slope.radiance).all() and np.isfinite(slope.layer("error")).all()
    # other lights add light, none takes any
    sent = next(float(scene["lights"][0][each]) for each in SENT.values() if each in scene["lights"][0])
    more = sent * (slope.radiance[0, 0, 1] - slope.layer("error")[0, 0])
    assert more <= value[1] + error + 1e-12


def test_the_combinations_hold_what_quadrature_refuses() -> None:
    refused = lit = 0
    asked: dict[str, Any] = {"size": 1, "tol": 0.05, "budget": 3_000, "threads": 1, "method": "quadrature"}
    for seed in range(OLD):
        scene, options, _ = drawn(seed)
        try:
            lit += int(sr.truth(scene, **asked, **options).radiance.max() > 0.0)
        except Unsupported:
            refused += 1
    assert refused >= 20 and lit >= 3


def test_the_combinations_hold_what_paths_alone_know() -> None:
    held = set()
    for seed in range(OLD, SEEDS):
        scene, _, _ = drawn(seed)
        held |= {shape["material"] for shape in scene["shapes"]} | {light["type"] for light in scene["lights"]}
        held |= {"smooth" for shape in scene["shapes"] if "shading_normals" in shape}
    assert held >= {"board", "picture", "smooth", "environment", "mirror", "glass", "plastic"}
