"""Cuts beat Sobol' points at equal CPU time over pixel and shutter or pixel and lens; over all three they lose.

    python benchmarks/products_converge.py [--quick] [--plot FILE]

Three products: pixel x shutter (three dimensions), pixel x lens (four) and pixel x lens x shutter (five), of pixels
with silhouettes, shadow edges and blur. Sobol' points (``scipy.stats.qmc``, scrambled) and random ones are places of
all dimensions at once, at which the conventional tracer looks along one ray each; the split rule is asked for less and
less. All are judged by the split rule asked for ten times less than its last row, and it by its own statement.
"""

from __future__ import annotations

import sys
import time
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from measure import Report
from scipy.stats import qmc

import symrender as sr
from symrender.jit.compiled import compiled
from symrender.numeric.radiometric.hits import first_hit
from symrender.numeric.radiometric.path import from_points, shows, surface
from symrender.numeric.radiometric.shot import Shot, lens_place, lens_ray, make_shot, put_moved
from symrender.numeric.radiometric.world import World, make_world
from symrender.numeric.rays import camera_frame
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
SIDE: Final = 3
SCENE: dict[str, Any] = {
    "name": "product", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 2], "target": [-0.25, -0.8, 0.5], "fov": 8},
    "materials": {
        "floor": {"type": "diffuse", "reflectance": 0.6},
        "clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3]},
        "slate": {"type": "diffuse", "reflectance": [0.3, 0.4, 0.7]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
        {"type": "sphere", "name": "near", "center": [-0.6, -2, 0.4], "radius": 0.4, "material": "clay"},
        {"type": "sphere", "name": "far", "center": [0.5, 1, 0.9], "radius": 0.9, "material": "slate"},
    ],
    "lights": [{"type": "point", "name": "lamp", "position": [3, -3, 5], "intensity": 90}],
}  # fmt: skip
LENS: dict[str, Any] = {"camera.aperture": 0.1, "camera.focus": 6.5}
MOTION: dict[str, Any] = {"shutter": [0.0, 1.0], "shapes.near.velocity": [0.3, 0.0, 0.1]}
PRODUCTS: Final = {
    "pixel x shutter": (MOTION, (1e-2, 1e-3, 1e-4)),
    "pixel x lens": (LENS, (1e-1, 1e-2, 1e-3)),
    "pixel x lens x shutter": (LENS | MOTION, (1e-1, 1e-2)),
}


def look(world: World, shot: Shot, frame: Array, side: int, points: Array, total: Array) -> None:
    """Add what comes back to every pixel along a ray through each row of ``points``: two of it, two of the lens, t."""
    for k in range(points.shape[0]):
        if shot.moves:
            put_moved(world, shot, points[k, 4])
        there = shot.world if shot.moves else world
        u, v = lens_place(shot.aperture, points[k, 2], points[k, 3])
        for j in range(side):
            for i in range(side):
                a, b = 2.0 * (i + points[k, 0]) / side - 1.0, 1.0 - 2.0 * (j + points[k, 1]) / side
                eye, d = lens_ray(frame, shot, points[k, 4], a, b, u, v)
                hit = first_hit(there, eye, d, -1, -1, False)
                if hit.own >= 0 and shows(there, hit):
                    light = from_points(there, surface(there, hit, d))
                    for c in range(3):
                        total[j, i, c] += light[c]


@lru_cache(maxsize=1)
def _kernel() -> Any:
    return compiled(look, _nrt=False)


def sampled(scene: Any, points: Array) -> Array:
    """Mean of what the points see, in all pixels; those of dimensions that are not there are passed over."""
    arrays = radiometric_arrays(scene)
    world = make_world(arrays)
    shot = make_shot(arrays, world, Settings(width=SIDE, height=SIDE, filter="box"))
    total = np.zeros((SIDE, SIDE, 3))
    _kernel()(world, shot, camera_frame(arrays.camera, SIDE, SIDE), SIDE, np.ascontiguousarray(points), total)
    return total / len(points)


def priced(work: Any) -> tuple[Any, float]:
    begun = time.process_time()
    found = work()
    return found, time.process_time() - begun


def rms(values: Array, true: Array) -> float:
    return float(np.sqrt(((values - true) ** 2).mean()))


def rows_of(
    scene: Any, tolerances: tuple[float, ...], powers: range, report: Report, name: str
) -> list[list[tuple[float, float]]]:
    """(CPU seconds, RMS error) of the split rule, of Sobol' points and of random ones."""
    true, spent = priced(lambda: sr.truth(scene, size=SIDE, tol=tolerances[-1] / 10, filter="box"))
    report.say(f"{name}: the judge took {spent:.3g} CPU s and states {true.layer('error').max():.2g}")
    split, sobol, chance, rows = [], [], [], []
    for tol in tolerances:
        image, spent = priced(lambda tol=tol: sr.truth(scene, size=SIDE, tol=tol, filter="box"))
        apart = np.abs(image.radiance - true.radiance).max(axis=2)
        beyond = int((apart > 1.5 * (image.layer("error") + true.layer("error"))).sum())
        report.claim_number(f"{name} at {tol:g}: pixels of {SIDE * SIDE} beyond 1.5 times what is stated", beyond, 0)
        split.append((spent, rms(image.radiance, true.radiance)))
        rows.append([f"split, {tol:g}", *split[-1], int((image.layer("status") == 0).sum())])
    for power in powers:
        for kind, found in (("Sobol'", sobol), ("random", chance)):
            draw = np.random.default_rng(power).random((1 << power, 5))
            if kind == "Sobol'":
                draw = qmc.Sobol(5, scramble=True, seed=power).random_base2(power)
            values, spent = priced(lambda draw=draw: sampled(scene, draw))
            found.append((spent, rms(values, true.radiance)))
            rows.append([f"{kind}, 2^{power}", *found[-1], ""])
    report.table(("method", "CPU s", "RMS error", f"met of {SIDE * SIDE}"), rows)
    return [split, sobol, chance]


def at_equal_time(split: list[tuple[float, float]], other: list[tuple[float, float]]) -> float:
    """Error of a sampler at the time of the last row of the split rule, by its own last halvings, over that row's."""
    seconds, errors = np.log(np.array(other)).T
    slope, start = np.polyfit(seconds, errors, 1)
    return float(np.exp(start + slope * np.log(split[-1][0])) / max(split[-1][1], 1e-16))


def main() -> None:
    quick = "--quick" in sys.argv
    report = Report("products_converge", __doc__.split("\n")[0])
    figures = {}
    sampled(sr.load(SCENE), np.full((1, 5), 0.5))
    for name, (changes, tolerances) in PRODUCTS.items():
        scene = sr.load(SCENE).replace(changes)
        sr.truth(scene, size=1, tol=1.0, filter="box")
        figures[name] = rows_of(
            scene, tolerances[: 1 if quick else None], range(8, 14 if quick else 21, 2), report, name
        )
        report.say(f"{name}: Sobol' points are {at_equal_time(*figures[name][:2]):.3g} times as far off at equal time")
    if "--plot" in sys.argv:
        draw(figures, sys.argv[sys.argv.index("--plot") + 1])
    report.leave()


def draw(figures: dict[str, list[list[tuple[float, float]]]], path: str) -> None:
    """A picture of all products."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(figures), figsize=(11, 3.6), layout="constrained", sharey=True)
    for axis, (name, lines) in zip(axes, figures.items(), strict=True):
        for line, label, color in zip(
            lines, ("split", "Sobol'", "random"), ("#3aa05a", "#3867b0", "#d9622b"), strict=True
        ):
            axis.loglog(*zip(*line, strict=True), "o-", color=color, label=label)
        axis.set(title=name, xlabel="CPU seconds")
    axes[0].set_ylabel("RMS error")
    axes[0].legend()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
