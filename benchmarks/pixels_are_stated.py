"""No mean over a pixel of a radiometric scene is beyond 1.5 times what it states.

    python benchmarks/pixels_are_stated.py [--quick] [SEED [COUNT]]

Pixels of random hostile scenes: spheres that touch, cross and stand on planes, polygons, disks and boxes, textures,
suns, lamps near and far, skies, sizes from 1e-4 to 1e3, cameras that graze. Each is judged by a run that asks for
twenty times less, and by samples of it in strata that are halved where they differ (``refined_samples.py``), of the
conventional tracer where lights are points and directions, else of our own single rays. What samples do not meet they
miss: highlights and slivers of a millionth of a pixel are to be looked at by hand.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from measure import Report
from refined_samples import refined_mean

from symrender.errors import SceneError, Unsupported
from symrender.jit.compiled import compiled
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric import tile
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import make_world, seen
from symrender.runtimes.pixels import brightest, check_pixels, prepare_means
from symrender.runtimes.radiometric import check
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import AREA, SKY, RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Settings

PIXELS, QUICK = 5_000, 20
FIRST, MOST = 48, 120_000
"""Strata of a side at first, and samples of a pixel."""
TOL = 1e-5
"""Over the brightest light of a scene."""


def unit(v: Any) -> Any:
    return v / np.linalg.norm(v)


def texture(rng: np.random.Generator, cell: float) -> Any:
    kind = rng.choice(["", "", "", "checker", "stripes", "marble"])
    return {"type": str(kind), "cell": cell, "bright": 0.8, "dark": [0.1, 0, 0.3]} if kind else [0.6, 0.5, 0.0]


def materials(rng: np.random.Generator, size: float, *, glossy: bool) -> dict[str, Any]:
    found: dict[str, Any] = {
        "flat": {"type": "diffuse", "reflectance": texture(rng, float(rng.choice([0.3, 1.0])) * size)},
        "round": {"type": "diffuse", "reflectance": texture(rng, 0.25), "two_sided": bool(rng.random() < 0.4)},
    }
    if glossy:
        density = str(rng.choice(["ggx", "beckmann"]))
        alpha = float(rng.choice([0.02, 0.05, 0.3]))
        found["metal"] = {"type": "conductor", "distribution": density, "alpha": alpha, "eta": 0.9, "k": [3, 2, 1]}
        found["gloss"] = {"type": "phong", "exponent": float(rng.choice([5, 100, 1000])), "reflectance": 0.5}
    return found


def crowd(rng: np.random.Generator, normal: Any, kinds: list[str], *, flat: bool) -> tuple[list[Any], list[Any]]:
    """Shapes of a scene of size 1, and the balls among them as (centre, radius)."""
    gaps = (1.0, 1.0, 1 + 1e-9, 1 + 1e-4, 1.1, 0.9, 1 - 1e-3)
    radius = float(10 ** rng.uniform(-1, 0.3))
    balls = [(normal * radius * float(rng.choice(gaps)), radius)]
    for _ in range(int(rng.integers(0, 4))):
        center, beside = balls[rng.integers(len(balls))]
        radius, way = beside * float(10 ** rng.uniform(-1.5, 0.5)), unit(rng.normal(size=3))
        way = way if way @ normal > 0 else -way
        balls.append((center + way * (beside + radius) * float(rng.choice(gaps)), radius))
    shapes: list[Any] = [
        {"type": "sphere", "center": c, "radius": r, "material": str(rng.choice(kinds))} for c, r in balls
    ]
    if rng.random() < 0.3:
        shapes.append({"type": "plane", "point": np.array([0, 3.0, 0]), "normal": [0, -1, 0], "material": "flat"})
    if flat and rng.random() < 0.6:
        at, one, two = rng.normal(size=(3, 3))
        at = at + normal * (1 - min(0.0, at @ normal))
        parts: dict[str, Any] = {
            "rectangle": {"corner": at, "edge_u": one, "edge_v": np.cross(one, two)},
            "triangle": {"vertices": np.array([at, at + one, at + two])},
            "disk": {"center": at, "normal": one.tolist(), "radius": 0.6},
            "box": {"center": at, "size": np.abs(two) + 0.1},
        }
        kind = str(rng.choice(list(parts)))
        shapes.append({"type": kind, "material": "round"} | parts[kind])
    return shapes, balls


def lights(rng: np.random.Generator, kind: str, normal: Any, balls: list[Any]) -> tuple[list[Any], list[Any]]:
    """Lights of a scene of size 1, and the shapes they need."""
    at = unit(rng.normal(size=3) + 1.5 * normal)
    if kind == "sky":
        return [{"type": "sky", "name": "Y", "radiance": 1.0}], []
    if kind == "area":
        lamp = {"type": "sphere", "name": "lamp", "center": at * float(rng.uniform(4, 8)), "material": "round",
                "radius": float(10 ** rng.uniform(-2, 0))}  # fmt: skip
        return [{"type": "area", "name": "L", "shape": "lamp", "radiance": [1, 3, 10]}], [lamp]
    center, radius = balls[0]
    place = center + at * radius * 1.01 if rng.random() < 0.2 else at * float(10 ** rng.uniform(-0.3, 1))
    found: list[Any] = [{"type": "point", "name": "P", "position": place, "intensity": [5.0, 2.0, 0.0]}]
    if rng.random() < 0.5:
        found.append({"type": "directional", "name": "D", "direction": (-at).tolist(), "irradiance": [0, 1, 2]})
    return found, []


def hostile(seed: int) -> RadiometricScene:
    """A scene whose one pixel looks at a rim, a contact, the horizon, or anywhere."""
    rng, kind = np.random.default_rng(seed), ("points", "points", "sky", "area")[seed % 4]
    size = float(10 ** rng.uniform(-4, 3))
    normal = unit(np.array([0, 0, 1.0]) + 0.3 * rng.normal(size=3) * rng.integers(2))
    held = materials(rng, size, glossy=kind == "points")
    shapes, balls = crowd(rng, normal, [k for k in held if k != "flat"], flat=kind == "points")
    lit, more = lights(rng, kind, normal, balls)
    floor = {"type": "plane", "point": np.zeros(3), "normal": normal.tolist(), "material": "flat"}
    slant, side = float(10 ** rng.uniform(-2.5, 0.5)), unit(np.cross(normal, rng.normal(size=3)))
    eye = balls[0][0] + unit(side + slant * normal) * float(rng.uniform(2, 6))
    eye = eye + normal * max(0.0, 0.02 - eye @ normal)
    center, radius = balls[rng.integers(len(balls))]
    toward = unit(eye - center)
    rim = center + radius * unit(np.cross(toward, rng.normal(size=3)))
    aims = (
        rim,
        center - normal * radius,
        eye - side,
        center + radius * toward,
        center + radius * unit(rng.normal(size=3)),
    )
    target = aims[rng.integers(5)]

    def sized(part: dict[str, Any], index: int) -> dict[str, Any]:
        """The part in units of the scene: what is an array is a length, and so is a radius."""
        grown = {k: (np.asarray(v) * size).tolist() if isinstance(v, np.ndarray) else v for k, v in part.items()}
        if "radius" in grown:
            grown["radius"] *= size
        if "intensity" in grown:
            grown["intensity"] = (np.array(grown["intensity"]) * size**2).tolist()
        return {"name": f"part{index}"} | grown

    camera = {"type": "look_at", "eye": (eye * size).tolist(), "target": (target * size).tolist(), "up": [0.1, 0.2, 1],
              "fov": float(10 ** rng.uniform(-2, 1.5))}  # fmt: skip
    made = load_any({
        "units": "radiometric", "name": "hostile", "bounces": 0, "camera": camera, "materials": held,
        "shapes": [sized(part, k) for k, part in enumerate([floor, *shapes, *more])],
        "lights": [sized(part, k) for k, part in enumerate(lit)],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def sampled(arrays: RadiometricArrays, most: int, within: float, seed: int) -> tuple[Any, Any]:
    """(mean over the pixel, its standard error) by about ``most`` samples, in strata that are halved where they differ.

    Rays are those of the conventional tracer where lights are points and directions, else our own.
    """
    view, ours = seen(arrays, 1, 1), any(light.kind in (SKY, AREA) for light in arrays.lights)
    world, (forward, right, up) = make_world(arrays), view.window

    def look(places: Any) -> Any:
        sent = forward + (2 * places[:, :1] - 1) * right + (1 - 2 * places[:, 1:]) * up
        sent = np.ascontiguousarray(sent / np.linalg.norm(sent, axis=1, keepdims=True))
        eyes = np.tile(view.eye, (len(sent), 1))
        if ours:
            room = np.zeros((len(sent), 3)), np.zeros((len(sent), 3)), np.zeros(len(sent))
            compiled(tile.fill_rays, _nrt=False)(world, eyes, sent, sky_room(view.world), *room)
            return room[0] + room[1]
        emitted, direct, _, _ = numeric_rays(arrays, eyes, sent)
        return emitted + direct

    return refined_mean(look, np.random.default_rng(seed), FIRST, most, within)


def main() -> None:
    quick = "--quick" in sys.argv
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("pixels_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if quick else PIXELS)
    judged = lit = cut = missed = told = signal = refused = beyond = apart = 0
    seconds = 0.0
    for seed in range(first, first + count):
        try:
            arrays = radiometric_arrays(hostile(seed))
            check(arrays)
            check_pixels(arrays)
        except (SceneError, Unsupported):
            refused += 1
            continue
        bright = brightest(seen(arrays, 1, 1))
        found = []
        for tol in (TOL, TOL / 20):
            begun = time.process_time()
            settings = Settings(width=1, height=1, tol=float(np.clip(tol * bright, 1e-13, 1.0)), filter="box")
            emitted, direct, error, spent = prepare_means(arrays, settings)(0, 0, 1, 1)
            found.append(((emitted + direct)[0, 0], float(error[0, 0]), spent))
            seconds += (time.process_time() - begun) * (tol == TOL)
        (value, stated, spent), (finer, rest, _) = found
        enough = max(stated, TOL * bright)
        expected, sigma = sampled(arrays, MOST, 0.1 * enough, seed)
        judged += 1
        lit += expected.max() > 1e-4 * bright
        cut += spent > 100
        missed += stated > TOL * bright
        if (np.abs(value - finer) > 1.5 * (stated + rest) + 1e-14 * bright).any():
            beyond += 1
            report.say(f"seed {seed}: beyond, {value} stated {stated:.3g}, finer {finer} stated {rest:.3g}")
        if (np.abs(value - expected) > 1.5 * stated + 5 * sigma + 1e-12 * bright).any():
            # few samples may have missed a highlight, and then their scatter has too
            again = np.array([sampled(arrays, 10 * MOST, 0.0, seed + 1 + k)[0] for k in range(8)])
            expected, sigma = again.mean(axis=0), again.std(axis=0, ddof=1) / np.sqrt(8)
        signal += bool((5 * sigma <= 0.01 * expected.max()).all() and expected.max() > 10 * enough)
        told += bool(expected.max() > 10 * enough and (sigma <= 0.3 * enough).all())
        if (np.abs(value - expected) > 1.5 * stated + 5 * sigma + 1e-12 * bright).any():
            apart += 1
            report.say(f"seed {seed}: {value} stated {stated:.3g}, samples {expected} +- {sigma}")
    report.say(
        f"{judged} pixels, {refused} refused, {lit} lit, {cut} with walls, {missed} that miss 1e-5 of the "
        f"brightest light and say so, {signal} that samples tell to a hundredth "
        f"of themselves, {told} to .3 of what is stated or asked; {1e3 * seconds / max(1, judged):.3g} ms each, scenes "
        "laid out"
    )
    report.claim_number("pixels beyond 1.5 times what both runs state", beyond, 0)
    # five standard errors of a scatter that is itself sampled
    report.claim_number("pixels apart from samples, share", apart / max(1, judged), 2e-3)
    report.leave()


if __name__ == "__main__":
    main()
