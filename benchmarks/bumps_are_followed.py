"""No pixel over a bump, and no bounce of light off one, lies beyond one and a half times the error it states.

    python benchmarks/bumps_are_followed.py [FIRST] [COUNT] [--kind bounces|pixels] [--tol TOL] [--quick]

Random scenes of every shape but meshes, two to five of them, every material, most with a bump: random formulas in
world or own coordinates by both conventions, slopes from a thousandth to 2; points, spots and suns. ``bounces`` asks
single rays for one bounce of light, ``pixels`` asks for means over a few pixels of direct light with a filter. The
judge is the conventional tracer, which has its own normals, shapes and sampling: eight runs of stratified paths, whose
scatter says what the mean may be off by. A value is told where statement and scatter are less than a third of it, or
both are less than the tolerance and it is dark. Where all but a few paths miss what is lit their scatter is no more
than their mean, or both are nothing: what is apart from that is counted by itself, to be looked at.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bumps_are_stated import scaled
from tests.radiometric import flats, heights

import symrender as sr
from symrender.errors import SymrenderError
from symrender.numeric.radiometric.pipeline import rays as traced
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays

Array = np.ndarray[Any, np.dtype[np.float64]]

RUNS = 8
ORDER = 160
"""Paths of a run are its square."""
ROUNDED = 1e-11
"""What the judge's sums may be rounded by, in parts of what they are."""
RAYS = 6
SIDE = 3
"""Pixels of a side of an image."""
STRATA = 150
BUDGET = 1_000_000
SIGMAS = 7.0
"""Standard errors of eight runs that a value may be off by: by chance once in 5,000 (Student's t, 7 degrees)."""
KINDS = ("plane", "sphere", "rectangle", "triangle", "disk", "box")


class Judged(NamedTuple):
    """(N,) values, what they state, the judge's mean and its standard error, whether they met what was asked."""

    value: Array
    stated: Array
    mean: Array
    scatter: Array
    met: Array


def bump_of(rng: np.random.Generator, own: bool) -> dict[str, Any]:
    """A bump of a random formula whose slopes are about as large as is said."""
    formula = heights.varied(rng, int(rng.integers(2, 5)))
    wave = float(rng.choice([0.5, 1.0, 3.0, 8.0]))
    slope = float(rng.choice([1e-3, 0.05, 0.2, 0.5, 2.0]))
    return {
        "height": scaled(formula, 1.0 / wave), "amplitude": slope / wave,
        "normals": str(rng.choice(["shading", "geometric"])), "coordinates": "own" if own else "world",
    }  # fmt: skip


def material(rng: np.random.Generator) -> dict[str, Any]:
    """A random material, three in four with a bump."""
    which = int(rng.integers(5))
    made: dict[str, Any] = {"type": "diffuse", "reflectance": rng.uniform(0.2, 0.9, 3).tolist(), "two_sided": True}
    if which == 0:
        alpha = float(rng.choice([0.08, 0.2, 0.5]))
        made = {"type": "conductor", "alpha": alpha, "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1]}
        made["distribution"] = str(rng.choice(["ggx", "beckmann"]))
    elif which == 1:
        made = {"type": "phong", "exponent": float(rng.choice([5.0, 20.0, 100.0])), "reflectance": 0.6}
    elif which == 2:
        kind = str(rng.choice(["checker", "stripes"]))
        made["reflectance"] = {"type": kind, "bright": 0.8, "dark": 0.2, "cell": float(rng.choice([0.25, 0.5]))}
    if rng.random() < 0.75:
        made["bump"] = bump_of(rng, bool(rng.random() < 0.3))
    return made


def scene_of(seed: int, bounces: int) -> dict[str, Any]:
    """A random scene; own coordinates are not had of a box."""
    rng = np.random.default_rng([seed, 11])
    shapes, materials = [], {}
    for k in range(int(rng.integers(2, 6))):
        kind = "plane" if k == 0 and seed % 2 else str(rng.choice(KINDS))
        made = material(rng)
        if kind == "box" and "bump" in made:
            made["bump"]["coordinates"] = "world"
        materials[f"m{k}"] = made
        if kind == "plane":
            shapes.append(flats.plane(f"s{k}", [0, 0, -1.0 - 0.3 * k], [0.1 * rng.normal(), 0, 1], f"m{k}"))
        else:
            shapes.append(flats.one_of(rng, kind, f"s{k}", f"m{k}"))
    lights: list[dict[str, Any]] = []
    for k in range(int(rng.integers(1, 3))):
        place = rng.normal(size=3) * 2.0 + [0, 0, 3]
        kind = int(rng.integers(3))
        if kind == 0:
            lights.append({"type": "directional", "name": f"l{k}", "direction": (-place).tolist(), "irradiance": 40.0})
        else:
            lights.append({"type": "point", "name": f"l{k}", "position": place.tolist(), "intensity": 400.0})
        if kind == 2:
            way = (rng.normal(size=3) * 0.7 - place).tolist()
            lights[-1] |= {"type": "spot", "direction": way, "beam": 12.0, "cutoff": 35.0}
    eye = rng.normal(size=3) * [1.5, 1.5, 0.7] + [0, -5.0, 1.5]
    camera = {"type": "look_at", "eye": eye.tolist(), "target": [0, 0, 0], "fov": 50}
    return flats.world(*shapes, lights=lights, materials=materials, camera=camera) | {"bounces": bounces}


def judge_of(arrays: RadiometricArrays, origins: Array, ways: Array, layer: int) -> tuple[Array, Array]:
    """(mean, standard error) (N, 3) of eight runs of paths; 1 is direct light, 2 that of bounces."""
    runs = np.array([
        traced(arrays, origins, ways, order=ORDER, seed=1000 + 17 * k)[layer] for k in range(RUNS)
    ])  # fmt: skip
    return runs.mean(axis=0), runs.std(axis=0, ddof=1) / math.sqrt(RUNS)


def bounced(seed: int, tol: float) -> Judged | None:
    """Single rays of a scene with one bounce; None if it is refused."""
    scene = scene_of(seed, 1)
    rng = np.random.default_rng([seed, 12])
    eye = np.tile(np.array(scene["camera"]["eye"]), (RAYS, 1))
    ways = rng.normal(size=(RAYS, 3)) * 1.2 - eye
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    try:
        found = sr.probe(scene, rays=(eye, ways), tol=tol, budget=BUDGET)
    except SymrenderError as problem:
        return print(f"refused, seed {seed}: {str(problem)[:90]}")
    mean, scatter = judge_of(radiometric_arrays(load_any(scene)), eye, ways, 2)
    return judged(np.asarray(found.indirect), np.asarray(found.error), mean, scatter, np.asarray(found.error) <= tol)


def filtered(seed: int, tol: float) -> Judged | None:
    """A few pixels of direct light with a filter; None if it is refused."""
    scene = scene_of(seed, 0)
    rng = np.random.default_rng([seed, 13])
    scene["camera"]["fov"] = float(rng.choice([2.0, 20.0, 60.0]))
    try:
        image = sr.truth(scene, size=SIDE, tol=tol, filter="box", budget=BUDGET, threads=1)
    except SymrenderError as problem:
        return print(f"refused, seed {seed}: {str(problem)[:90]}")
    arrays, camera = radiometric_arrays(load_any(scene)), scene["camera"]
    runs = [sampled(rng, arrays, camera) for _ in range(RUNS)]
    mean, scatter = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(RUNS)
    error = image.layer("error").reshape(-1)
    return judged(image.radiance.reshape(-1, 3), error, mean, scatter, error <= tol)


def sampled(rng: np.random.Generator, arrays: RadiometricArrays, camera: dict[str, Any]) -> Array:
    """(pixels, 3) means of rays through strata of every pixel, each at random in its own."""
    eye, count = np.array(camera["eye"]), SIDE * STRATA
    forward = np.array(camera["target"]) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    half = math.tan(math.radians(camera["fov"]) / 2)
    x, y = (np.arange(count) + rng.random((2, count, count))) * 2.0 / count - 1.0
    y = -y.T
    ways = forward + half * (x.reshape(-1, 1) * right + y.reshape(-1, 1) * np.cross(right, forward))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    _, direct, _, _ = traced(arrays, np.tile(eye, (len(ways), 1)), np.ascontiguousarray(ways))
    return direct.reshape(SIDE, STRATA, SIDE, STRATA, 3).mean(axis=(1, 3)).reshape(-1, 3)


def judged(value: Array, stated: Array, mean: Array, scatter: Array, met: Array) -> Judged:
    """The channel that is off by most of every value; what scatters is that of all channels."""
    worst = np.abs(value - mean).argmax(axis=1)
    rows = np.arange(len(value))
    return Judged(value[rows, worst], stated, mean[rows, worst], scatter.max(axis=1), met)


def main() -> int:
    """Print what was judged, and every value beyond; 1 where there is one."""
    kinds = {"bounces": bounced, "pixels": filtered}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", nargs="?", type=int, default=0, help="the first seed")
    parser.add_argument("count", nargs="?", type=int, default=100, help="how many scenes of each kind")
    parser.add_argument("--kind", choices=list(kinds), help="one kind alone")
    parser.add_argument("--tol", type=float, default=3e-3)
    parser.add_argument("--quick", action="store_true", help="few scenes")
    given = parser.parse_args()
    first, count, tol = given.first, 8 if given.quick else given.count, given.tol
    chosen = [given.kind] if given.kind else list(kinds)
    bad = 0
    for name in chosen:
        scenes = refused = values = lit = told = met = beyond = apart = 0
        for seed in range(first, first + count):
            found = kinds[name](seed, tol)
            if found is None:
                refused += 1
                continue
            scenes += 1
            known = np.isfinite(found.stated)
            size = np.maximum(np.abs(found.mean), np.abs(found.value))
            values, lit, met = values + len(size), lit + int((size > tol).sum()), met + int(found.met.sum())
            told += int((known & (found.stated + SIGMAS * found.scatter < np.maximum(size / 3, tol))).sum())
            off = np.abs(found.value - found.mean)
            for k in np.flatnonzero(
                known & (off > 1.5 * found.stated + SIGMAS * found.scatter + ROUNDED * (1.0 + size))
            ):
                few = found.mean[k] <= 3.0 * found.scatter[k]
                beyond, apart = beyond + (not few), apart + few
                word = "apart" if few else "beyond"
                print(
                    f"{word}: {name}, seed {seed}, {k}: {found.value[k]:.8g} against {found.mean[k]:.8g} +- "
                    f"{found.scatter[k]:.2g}, stated {found.stated[k]:.2g}", flush=True,
                )  # fmt: skip
        print(
            f"{name}: {scenes} scenes, {refused} refused, {values} values, {lit} lit, {met} met {tol:g}, {told} told, "
            f"{beyond} beyond, {apart} apart", flush=True,
        )  # fmt: skip
        bad += beyond + (lit < values // 5) + (told < values // 4)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
