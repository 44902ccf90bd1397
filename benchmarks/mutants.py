"""Mistakes planted in the path tracer, each one line of it changed, and the scenes that show them.

A mutant is the text of a function with some of it replaced; it is executed in the function's own module and takes its
place wherever that is imported, as plain Python, until the block ends.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from symrender.images.image import Image
from symrender.numeric.radiometric import hits, path, pictures, tile
from symrender.numeric.radiometric.bsdfs import choice, conductor, diffuse, dispatch, facets, fresnel, phong
from symrender.numeric.radiometric.pipeline import rays
from symrender.numeric.radiometric.world import make_world
from symrender.numeric.rays import camera_frame, window_direction
from symrender.numeric.samplers import CODES
from symrender.numeric.vectors import along, unit
from symrender.scene.arrays import Array
from symrender.scene.load import AnyScene, load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

MODULES = (hits, choice, facets, fresnel, diffuse, conductor, phong, dispatch, pictures, path, tile)
CAMERA = {"type": "look_at", "eye": [0.3, -5.6, 2.5], "target": [-0.15, 0, 0.55], "fov": 31}
FLOOR = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "tiles"}
BALLS = [
    {"type": "sphere", "name": "A", "center": [-0.78, 0.1, 0.85], "radius": 0.85, "material": "a"},
    {"type": "sphere", "name": "B", "center": [0.72, -0.22, 0.6], "radius": 0.6, "material": "b"},
]
TILES = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.8, "dark": [0.1, 0.2, 0.3], "cell": 0.7}}
LAMP = {"type": "point", "name": "lamp", "position": [-2.6, -2.2, 2.4], "intensity": [20, 25, 30]}
SUN = {"type": "directional", "name": "sun", "direction": [-0.84, 0.3, -0.8], "irradiance": [1.6, 1.3, 0.8]}
SCENES: Mapping[str, Mapping[str, Any]] = {
    "bounce": {
        "units": "radiometric", "name": "bounce", "bounces": 1, "camera": CAMERA, "shapes": [FLOOR, *BALLS],
        "materials": {
            "tiles": TILES,
            "a": {"type": "diffuse", "reflectance": [0.82, 0.3, 0.2]},
            "b": {"type": "diffuse", "reflectance": 0.85},
        },
        "lights": [LAMP, SUN],
    },
    "sky": {
        "units": "radiometric", "name": "sky", "bounces": 0, "camera": CAMERA, "shapes": [FLOOR, *BALLS],
        "materials": {
            "tiles": TILES, "a": {"type": "diffuse", "reflectance": 0.6}, "b": {"type": "diffuse", "reflectance": 0.85},
        },
        "lights": [{"type": "sky", "name": "dome", "radiance": [0.5, 0.7, 1.0]}],
    },
    "metal": {
        "units": "radiometric", "name": "metal", "bounces": 0, "camera": CAMERA, "shapes": [FLOOR, *BALLS],
        "materials": {
            "tiles": {"type": "phong", "exponent": 12, "reflectance": 0.5},
            "a": {"type": "conductor", "distribution": "ggx", "alpha": 0.4, "eta": [0.16, 0.42, 1.47], "k": 3.9},
            "b": {"type": "conductor", "distribution": "beckmann", "alpha": 0.5, "eta": 1.5, "k": 3, "g1": "exact"},
        },
        "lights": [LAMP, SUN],
    },
}  # fmt: skip
NOISE_FREE = ("metal",)


@dataclass(frozen=True)
class Mutant:
    """A mistake: in ``scene``, each (function, text, text in its place) of ``changes``; ``same``: it moves no mean.

    A function whose name several modules have is called ``module.function``.
    """

    name: str
    scene: str
    changes: tuple[tuple[str, str, str], ...]
    same: bool = False


def _one(name: str, scene: str, function: str, old: str, new: str, *, same: bool = False) -> Mutant:
    return Mutant(name, scene, ((function, old, new),), same)


_LATER = "indirect = plus(indirect, scaled(through, from_points(world, at), 1.0))"
_LAMBERT = "share = wi[2] / math.pi"
_WEIGHT = "1.0 / (chance + own)"
_OTHER = "weight = 1.0 / (chance + (sky_chance(world, d) if shared and above else 0.0))"
MUTANTS = (
    _one("missing cosine", "bounce", "diffuse.value", _LAMBERT, "share = 1.0 / math.pi"),
    _one("cosine squared", "bounce", "diffuse.value", _LAMBERT, "share = wi[2] * wi[2] / math.pi"),
    _one("1/pi missing", "bounce", "diffuse.value", _LAMBERT, "share = wi[2]"),
    _one("1/pi twice", "bounce", "diffuse.value", _LAMBERT, "share = wi[2] / math.pi**2"),
    Mutant(
        "terminator of the wrong sign",
        "bounce",
        (
            ("scattered", "    if wi[2] <= 0.0:", "    if wi[2] <= -2.0:"),
            ("diffuse.value", _LAMBERT, "share = abs(wi[2]) / math.pi"),
            ("from_points", " and reaches(world, at.hit, toward, limit, goes_inside(at, wi))", ""),
        ),
    ),
    _one("fall-off 1/r", "bounce", "from_points", "1.0 / (limit * limit)", "1.0 / limit"),
    _one("no fall-off", "bounce", "from_points", "unit(way), 1.0 / (limit * limit)", "unit(way), 1.0"),
    _one(
        "no shadow rays", "bounce", "from_points", " and reaches(world, at.hit, toward, limit, goes_inside(at, wi))", ""
    ),
    _one("shadow bias .1", "bounce", "reaches", "hit.place, toward", "along(hit.place, 0.1, hit.outward), toward"),
    _one("shadows from behind the light", "bounce", "from_points", "toward, limit, ", "toward, math.inf, ", same=True),
    _one("no bounced light", "bounce", "path", "depth > world.bounces or", "depth >= world.bounces or"),
    _one("last bounce lit twice", "bounce", "path", _LATER, _LATER.replace("1.0", "2.0")),
    _one(
        "fireflies clamped at .2",
        "bounce",
        "path",
        _LATER,
        _LATER.replace("1.0))", "1.0)); indirect = (min(indirect[0], .2), min(indirect[1], .2), min(indirect[2], .2))"),
    ),
    _one("density left out", "bounce", "path", "scaled(through, share, 1.0 / chance)", "scaled(through, share, 1.0)"),
    _one(
        "density halved",
        "bounce",
        "path",
        "scaled(through, share, 1.0 / chance)",
        "scaled(through, share, 2.0 / chance)",
    ),
    _one(
        "uniform density for cosine directions",
        "bounce",
        "diffuse.density",
        "return wi[2] / math.pi",
        "return 0.5 / math.pi",
    ),
    _one(
        "uniform directions of cosine density",
        "bounce",
        "by_cosine",
        "turn, r = 2.0",
        "a = a * (2.0 - a); turn, r = 2.0",
    ),
    _one("half of the azimuths", "bounce", "by_cosine", "turn, r = 2.0 * math.pi * b", "turn, r = math.pi * b"),
    _one(
        "bounced rays start .1 off",
        "bounce",
        "path",
        "world, at.hit.place, d",
        "world, along(at.hit.place, 0.1, at.normal), d",
    ),
    _one(
        "bounced rays start 1e-6 off",
        "bounce",
        "path",
        "world, at.hit.place, d",
        "world, along(at.hit.place, 1e-6, at.normal), d",
        same=True,
    ),
    _one(
        "bounced albedo of the first hit",
        "bounce",
        "path",
        "at = surface(world, hit, d)",
        "at = surface(world, hit, d)._replace(reflectance=at.reflectance)",
    ),
    _one(
        "checker off by half a cell",
        "bounce",
        "albedo",
        "x, y = chart_place(world, hit, material.cell)",
        "x, y = chart_place(world, hit, material.cell); x = x + 0.5",
    ),
    _one(
        "checker's colours exchanged",
        "bounce",
        "albedo",
        "odd_field(x) != odd_field(y)",
        "odd_field(x) == odd_field(y)",
    ),
    _one(
        "checker's cells doubled",
        "bounce",
        "albedo",
        "chart_place(world, hit, material.cell)",
        "chart_place(world, hit, 2.0 * material.cell)",
    ),
    _one(
        "weights squared on one side",
        "sky",
        "from_sky",
        _WEIGHT,
        "chance / (chance**2 + own**2)",
    ),
    Mutant(
        "weights squared on both sides",
        "sky",
        (
            ("from_sky", _WEIGHT, "chance / (chance**2 + own**2)"),
            ("path", _OTHER, "weight = chance / (chance**2 + sky_chance(world, d) ** 2) if both else 1.0 / chance"),
        ),
        same=True,
    ),
    _one("sky counted by both, unweighted", "sky", "path", _OTHER, "weight = 1.0 / chance"),
    _one(
        "sky not hidden",
        "sky",
        "from_sky",
        "if not reaches(world, at.hit, d, math.inf, goes_inside(at, wi))",
        "if False",
    ),
    _one("sky by half of the azimuths", "sky", "from_sky", "2.0 * math.pi * b", "math.pi * b"),
    _one("sky below the horizon", "sky", "from_sky", "max(0.0, 1.0 - a * a)", "1.0 - a"),
    _one("alpha squared", "metal", "facets", "material.alpha * material.alpha", "material.alpha**4"),
    _one("D without 1/pi", "metal", "facets", "(math.pi * material.alpha", "(material.alpha"),
    _one(
        "Beckmann and GGX exchanged", "metal", "facets", "material.density == BECKMANN", "material.density != BECKMANN"
    ),
    _one("no masking", "metal", "hidden", "if slope == 0.0:", "if True:"),
    _one("masking without alpha", "metal", "hidden", "material.alpha * math.sqrt", "math.sqrt"),
    _one(
        "correlated for separable masking",
        "metal",
        "facets.seen",
        "material.correlated != 0.0",
        "material.correlated == 0.0",
    ),
    _one("Walter's fit for exact masking", "metal", "hidden", "material.walter != 0.0", "material.walter == 0.0"),
    _one(
        "Schlick for Fresnel",
        "metal",
        "fresnel",
        "n = (eta, k)",
        "f0 = ((eta - 1) ** 2 + k * k) / ((eta + 1) ** 2 + k * k)\n"
        "    return f0 + (1 - f0) * (1 - cosine) ** 5\n    n = (eta, k)",
    ),
    _one("eta and k exchanged", "metal", "fresnel", "n = (eta, k)", "n = (k, eta)"),
    _one("n = eta - i k", "metal", "fresnel", "n = (eta, k)", "n = (eta, -k)", same=True),
    _one("no Fresnel", "metal", "fresnel", "n = (eta, k)", "return 1.0\n    n = (eta, k)"),
    _one("a quarter left out", "metal", "conductor.value", "0.25 * facets", "facets"),
    _one("wo and wi exchanged", "metal", "conductor.value", "wi) / wo[2]", "wi) / wi[2]"),
    _one("(n + 1) for (n + 2)", "metal", "phong.value", "(n + 2.0)", "(n + 1.0)"),
    _one("lobe about the normal", "metal", "phong.value", "mirrored(wo), n) * wi[2]", "(0.0, 0.0, 1.0), n) * wi[2]"),
    _one(
        "pixels half a column off",
        "metal",
        "along_ray",
        "black = (0.0, 0.0, 0.0)",
        "black = (0.0, 0.0, 0.0); d = unit((d[0] + 0.01, d[1], d[2]))",
    ),
)


@contextmanager
def planted(mutant: Mutant | None) -> Iterator[None]:
    """The tracer with the mistake in it; AssertionError where the text that is to change is not there."""
    before = {module: dict(vars(module)) for module in MODULES}
    texts: dict[str, str] = {}
    for name, old, new in mutant.changes if mutant else ():
        text = texts.get(name) or inspect.getsource(getattr(_home(name), name.split(".")[-1]))
        assert old in text, f"{name} no longer reads {old!r}"
        texts[name] = text.replace(old, new)
    try:
        for full, text in texts.items():
            home, name = _home(full), full.split(".")[-1]
            original = getattr(home, name)
            for word, value in (("unit", unit), ("along", along)):
                vars(home).setdefault(word, value)
            exec(compile(text, f"<{mutant.name if mutant else ''}>", "exec"), vars(home))  # noqa: S102  a mutant is code
            for module in MODULES:
                if getattr(module, name, None) is original:
                    setattr(module, name, getattr(home, name))
        yield
    finally:
        for module, names in before.items():
            vars(module).clear()
            vars(module).update(names)


def _home(name: str) -> ModuleType:
    """The module that a function of the tracer is written in."""
    module, _, function = name.rpartition(".")
    written = [m for m in MODULES if getattr(getattr(m, function, None), "__module__", "") == m.__name__]
    return next(m for m in written if not module or m.__name__.endswith(f".{module}"))


def scene_of(name: str) -> AnyScene:
    """The scene called ``name``."""
    return load_any(dict(SCENES[name]))


def rendered(scene: AnyScene, size: tuple[int, int], samples: int, seed: int, *, plain: bool) -> Image:
    """Means and second moments of ``samples`` paths a pixel, by the compiled tracer or as ``plain`` Python."""
    arrays = radiometric_arrays(scene)
    (width, height), frame = size, camera_frame(arrays.camera, *size)
    grid = [(2 * (i + 0.5) / width - 1, 1 - 2 * (j + 0.5) / height) for j in range(height) for i in range(width)]
    directions = np.repeat(np.array([unit(window_direction(frame, a, b)) for a, b in grid]), samples, axis=0)
    origins = np.ascontiguousarray(np.broadcast_to(np.array(frame[1:4]), directions.shape))
    if plain:
        found: tuple[Array, Array, Array, Array] = (
            *(np.zeros((len(directions), 3)) for _ in range(3)), np.zeros(len(directions)),
        )  # fmt: skip
        tile.fill_rays(make_world(arrays), origins, directions, CODES["jittered"], 1, seed, *found)
    else:
        found = rays(arrays, origins, directions, seed=seed)
    values = (found[0] + found[1] + found[2]).reshape(height, width, samples, 3)
    return Image({"radiance": values.mean(axis=2), "m2_radiance": (values**2).mean(axis=2)})
