"""Second derivatives of the light of one plane in many digits, which share nothing with the package.

A random plane, diffuse, phong or GGX, plain, textured or with a bump, under a point light or a sun, at any size and
place. Its radiance is a closed form, written here once more, and differentiated by differences of 120 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

DIGITS = 120
STEP = mpmath.mpf(10) ** -30
"""Of the differences, over the smallest length of the scene: they are off by its square."""
RAYS = 3
KINDS = ("diffuse", "marble", "checker", "stripes", "bump", "phong", "ggx")
Numbers = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """A scene, ``rays`` (origins, directions), the numbers that the closed form takes, and which of them may move.

    ``steps`` are their steps in the judge's differences, over ``STEP``.
    """

    scene: dict[str, Any]
    rays: tuple[Any, Any]
    numbers: dict[str, float]
    steps: dict[str, float]
    radiance: Callable[[Numbers, Any, Any], Any]


def dot(a: Any, b: Any) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True)), mpmath.mpf(0))


def unit(a: Any) -> Any:
    size = mpmath.sqrt(dot(a, a))
    return [x / size for x in a]


def vector(numbers: Numbers, name: str) -> list[Any]:
    return [numbers[f"{name}.{axis}"] for axis in "xyz"]


def fresnel(cosine: Any, eta: Any, k: Any) -> Any:
    """Unpolarised reflectance of a conductor, of the complex refractive index."""
    index = mpmath.mpc(eta, k)
    inside = mpmath.sqrt(1 - (1 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return (abs(across) ** 2 + abs(along) ** 2) / 2


def texture(kind: str, numbers: Numbers, x: Any, y: Any) -> Any:
    """Reflectance at (x, y) of the plane's own coordinates."""
    material = "materials.m.reflectance"
    if kind not in ("marble", "checker", "stripes"):
        return numbers[f"{material}.color.r"]
    x, y = x / numbers[f"{material}.cell"], y / numbers[f"{material}.cell"]
    bright, dark = numbers[f"{material}.bright.r"], numbers[f"{material}.dark.r"]
    if kind == "marble":
        vein = (1 + mpmath.sin(2 * mpmath.pi * (x + mpmath.mpf(0.35) * mpmath.sin(3 * mpmath.pi * y)))) / 2
        return dark + vein * (bright - dark)
    field = mpmath.floor(x) + (mpmath.floor(y) if kind == "checker" else 0)
    return bright if field % 2 == 0 else dark


def reflected(kind: str, numbers: Numbers, normal: Any, view: Any, to: Any) -> Any:
    """BRDF over the reflectance."""
    if kind == "phong":
        n = numbers["materials.m.exponent"]
        mirror = [2 * dot(normal, view) * a - b for a, b in zip(normal, view, strict=True)]
        cosine = dot(mirror, to)
        return (n + 2) / (2 * mpmath.pi) * cosine**n if cosine > 0 else mpmath.mpf(0)
    if kind == "ggx":
        alpha, half = numbers["materials.m.alpha"], unit([a + b for a, b in zip(view, to, strict=True)])
        cosine = dot(normal, half)
        density = alpha**2 / (mpmath.pi * (cosine**2 * (alpha**2 - 1) + 1) ** 2)
        for way in (view, to):
            z = dot(normal, way)
            density *= 2 / (1 + mpmath.sqrt(1 + alpha**2 * (1 / z**2 - 1)))
        index = numbers["materials.m.eta.r"], numbers["materials.m.k.r"]
        return density * fresnel(dot(half, to), *index) / (4 * dot(normal, view) * dot(normal, to))
    return 1 / mpmath.pi


def radiance_of(kind: str, sun: bool, waves: str) -> Callable[[Numbers, Any, Any], Any]:
    """The closed form."""

    def radiance(numbers: Numbers, origin: Any, direction: Any) -> Any:
        point, normal = vector(numbers, "shapes.f.point"), unit(vector(numbers, "shapes.f.normal"))
        way = unit(direction)
        away = dot([p - o for p, o in zip(point, origin, strict=True)], normal) / dot(way, normal)
        place = [o + away * w for o, w in zip(origin, way, strict=True)]
        own = [a - b for a, b in zip(place, point, strict=True)]
        view = [-w for w in way]
        if sun:
            to = unit([-c for c in vector(numbers, "lights.k.direction")])
            arrives = numbers["lights.k.irradiance.r"]
        else:
            gap = [a - b for a, b in zip(vector(numbers, "lights.k.position"), place, strict=True)]
            to, arrives = unit(gap), numbers["lights.k.intensity.r"] / dot(gap, gap)
        turned = normal
        if waves:
            # of a level plane alone, so that its own coordinates are those of the scene
            amplitude, pace = numbers["materials.m.bump.amplitude"], numbers[waves]
            turned = unit([-amplitude * pace * mpmath.cos(pace * own[0]), mpmath.mpf(0), mpmath.mpf(1)])
        facing = [dot(n, v) for n in (normal, turned) for v in (to, view)]
        if min(facing) <= 0:
            return mpmath.mpf(0)
        share = texture(kind, numbers, own[0], own[1])
        return share * reflected(kind, numbers, turned, view, to) * arrives * dot(turned, to)

    return radiance


def case(seed: int) -> Case:
    """A random scene of one plane, whose lengths are of size 1e-6 to 1e6, and up to 1e5 of that from the origin."""
    rng = np.random.default_rng([seed, 51])
    kind, sun = KINDS[seed % len(KINDS)], bool(rng.integers(2))
    size = float(10.0 ** rng.uniform(-6, 6))
    shift = size * np.array([float(10.0 ** rng.uniform(-1, 5)) * rng.choice([0, 0, 1]), 0.0, 0.0])
    fine = size * float(10.0 ** rng.uniform(-3, 0))
    normal = rng.normal(size=2) * 0.3 if kind in ("diffuse", "phong", "ggx") else np.zeros(2)
    point = shift + size * np.array([*rng.uniform(-0.2, 0.2, 2), 0.0])
    origins = shift + size * np.column_stack([rng.uniform(-1, 1, (RAYS, 2)), rng.uniform(0.6, 1.5, RAYS)])
    aims = shift + size * np.column_stack([rng.uniform(-0.7, 0.7, (RAYS, 2)), np.zeros(RAYS)])
    directions = aims - origins
    if seed % 3 == 0:
        directions[:] = [0.0, 0.0, -1.0]
    material: dict[str, Any] = {"type": kind if kind == "phong" else "diffuse", "reflectance": 0.5}
    numbers: dict[str, float] = {"materials.m.reflectance.color.r": 0.5}
    steps = {"materials.m.reflectance.color.r": 1.0}
    wide, waves = 1.0, ""
    if kind in ("marble", "checker", "stripes"):
        bright, dark = float(rng.uniform(0.5, 0.9)), float(rng.uniform(0.0, 0.4))
        material["reflectance"] = {"type": kind, "bright": bright, "dark": dark, "cell": fine}
        numbers = {"materials.m.reflectance." + name: value for name, value in
                   (("bright.r", bright), ("dark.r", dark), ("cell", fine))}  # fmt: skip
        steps = {"materials.m.reflectance.bright.r": 1.0}
        if kind == "marble":
            steps["materials.m.reflectance.cell"] = fine * fine / size
    if kind == "bump":
        pace = 2.0 * np.pi / fine
        amplitude = float(rng.uniform(0.02, 0.4)) / pace
        waves = "materials.m.bump.height.sin.mul[0]"
        material["bump"] = {
            "amplitude": amplitude, "height": {"sin": {"mul": [pace, "x"]}}, "coordinates": "own",
        }  # fmt: skip
        numbers |= {"materials.m.bump.amplitude": amplitude, waves: pace}
        steps |= {"materials.m.bump.amplitude": amplitude, waves: 1.0 / size}
    if kind == "phong":
        exponent = float(10.0 ** rng.uniform(0.3, 4))
        material["exponent"], wide = exponent, min(1.0, exponent**-0.5)
        numbers["materials.m.exponent"], steps["materials.m.exponent"] = exponent, exponent
    if kind == "ggx":
        alpha, eta, k = float(10.0 ** rng.uniform(-2.5, 0)), float(rng.uniform(0.2, 3)), float(rng.uniform(0.1, 4))
        material |= {"type": "conductor", "distribution": "ggx", "alpha": alpha, "eta": eta, "k": k}
        numbers |= {"materials.m.alpha": alpha, "materials.m.eta.r": eta, "materials.m.k.r": k}
        steps |= {"materials.m.alpha": alpha, "materials.m.eta.r": eta, "materials.m.k.r": k}
        wide = alpha
    # the light is near the mirror direction of the first ray, as near as the lobe is wide
    up = np.array([*normal, 1.0]) / np.linalg.norm([*normal, 1.0])
    way = directions[0] / np.linalg.norm(directions[0])
    place = origins[0] + way * ((point - origins[0]) @ up) / (way @ up)
    mirror = way - 2.0 * (way @ up) * up if kind in ("phong", "ggx") else np.array([0.2, 0.1, 1.0])
    toward = mirror + min(wide, 0.5) * rng.normal(size=3) * 0.7
    toward[2] = max(abs(toward[2]), 0.2)
    if sun:
        light = {"type": "directional", "direction": (-toward).tolist(), "irradiance": 2.0}
        numbers["lights.k.irradiance.r"] = 2.0
    else:
        position = place + size * float(rng.uniform(0.3, 1.5)) * toward / np.linalg.norm(toward)
        light = {"type": "point", "position": position.tolist(), "intensity": min(2.0 * size**2, 1e12)}
        numbers["lights.k.intensity.r"] = light["intensity"]
    aimed, lamp = ("direction", -toward) if sun else ("position", position)
    for name, whole, step in (
        ("shapes.f.point", point, fine * wide),
        ("shapes.f.normal", [*normal, 1.0], wide * fine / size),
        (f"lights.k.{aimed}", lamp, wide if sun else wide * size),
    ):
        for axis, value in zip("xyz", whole, strict=True):
            numbers[f"{name}.{axis}"] = float(value)
            # a bump and a texture follow a plane that turns: the closed form keeps it level
            if not (name.endswith("normal") and (axis == "z" or kind not in ("diffuse", "phong", "ggx"))):
                steps[f"{name}.{axis}"] = step
    scene = {
        "name": "plane", "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": origins[0].tolist(), "target": place.tolist(), "fov": 30,
                   "up": [0, 1, 0.1]},
        "materials": {"m": material},
        "shapes": [{"type": "plane", "name": "f", "point": point.tolist(), "normal": [*normal, 1.0], "material": "m"}],
        "lights": [{"name": "k"} | light],
    }  # fmt: skip
    return Case(scene, (origins, directions), numbers, steps, radiance_of(kind, sun, waves))


def second(made: Case, names: tuple[str, str], ray: int) -> float:
    """Second derivative in two numbers of the light along a ray."""
    with mpmath.workdps(DIGITS):
        exact = {name: mpmath.mpf(value) for name, value in made.numbers.items()}
        origin, direction = ([mpmath.mpf(float(c)) for c in part[ray]] for part in made.rays)
        steps = [STEP * mpmath.mpf(made.steps[name]) for name in names]

        def at(*shifts: int) -> Any:
            moved = dict(exact)
            for name, step, shift in zip(names, steps, shifts, strict=True):
                moved[name] += shift * step
            return made.radiance(moved, origin, direction)

        if names[0] == names[1]:
            return float((at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / steps[0] ** 2)
        return float((at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * steps[0] * steps[1]))


def value(made: Case, ray: int) -> float:
    """The light along a ray."""
    with mpmath.workdps(DIGITS):
        origin, direction = ([mpmath.mpf(float(c)) for c in part[ray]] for part in made.rays)
        return float(made.radiance({n: mpmath.mpf(v) for n, v in made.numbers.items()}, origin, direction))
