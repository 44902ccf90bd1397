"""Derivatives of a box-filtered image: ours and those of Mitsuba's projective integrators, pixel by pixel at equal CPU.

    pip install mitsuba symrender
    python projective_gradients.py [--quick]

A ball over a floor and a wall under a lamp that is a sphere: silhouettes, a penumbra and their derivatives in the
ball's place and radius. Both are asked for the same pixels; the truth is our run at a tolerance a hundred times less,
which differences of our means judge here, and Mitsuba's own differences, of which boundaries are no part. Time is CPU
time of the process after a first call, which compiles. Mitsuba's error is parted into scatter over seeds and what is
left of their mean. DRJIT_LIBLLVM_PATH may have to name LLVM's library, of version 17 or later: 14 is refused, and
under 16 Mitsuba 3.9.1 aborts, for LLVM selects no instruction for the larger of two numbers.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Final

import numpy as np

import symrender as sr

SIZE: Final = 24
RADIUS: Final = 0.7
CENTER: Final = (-0.1, 0.2, 0.9)
NAMES: Final = ("shapes.ball.center.x", "shapes.ball.radius")
KEY: Final = "shape-ball.to_world"
TOLERANCES: Final = (3e-2, 1e-2, 1e-3, 1e-4)
FINEST: Final = 1e-5
STEP: Final = 1e-4
MITSUBA_STEP: Final = 0.02
SEEDS: Final = 4
RUNS: Final = (("prb_projective", 16), ("prb_projective", 128), ("direct_projective", 16), ("direct_projective", 128))
"""Integrators and samples of a pixel; of ``direct_projective`` those of every part of the derivative."""


def scene() -> Any:
    """The scene of both."""
    camera = {"type": "look_at", "eye": [0.6, -5.2, 2.2], "target": [0.1, 0, 0.7], "fov": 34}
    return sr.load(
        {
            "name": "ball_before_a_lamp",
            "units": "radiometric",
            "bounces": 0,
            "camera": camera,
            "materials": {
                "paper": {"type": "diffuse", "reflectance": 0.8},
                "clay": {"type": "diffuse", "reflectance": [0.6, 0.4, 0.2]},
                "black": {"type": "diffuse", "reflectance": 0},
            },
            "shapes": [
                {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "paper"},
                {"type": "plane", "name": "wall", "point": [0, 3, 0], "normal": [0, -1, 0], "material": "clay"},
                {"type": "sphere", "name": "bulb", "center": [-2, -2.5, 4], "radius": 0.5, "material": "black"},
                {"type": "sphere", "name": "ball", "center": CENTER, "radius": RADIUS, "material": "clay"},
            ],
            "lights": [{"type": "area", "name": "lamp", "shape": "bulb", "radiance": 20}],
        }
    )


def ours(tol: float) -> tuple[Any, float, float, int]:
    """(derivatives (2, h, w, 3), CPU seconds, what they state at most, pixels that miss the tolerance)."""
    begun = time.process_time()
    found = sr.gradient(scene(), NAMES, size=SIZE, tol=tol, filter="box", threads=1)
    seconds = time.process_time() - begun
    stated = max(float(found[name].layer("error").max()) for name in NAMES)
    missed = sum(int((found[name].layer("status") != 0).sum()) for name in NAMES)
    return np.stack([found[name].radiance for name in NAMES]), seconds, stated, missed


def our_differences(step: float, tol: float) -> Any:
    """Central differences of our means, (2, h, w, 3)."""
    found = []
    for name, value in zip(NAMES, (CENTER[0], RADIUS), strict=True):
        high, low = (
            sr.truth(scene().replace({name: value + side * step}), size=SIZE, tol=tol, filter="box", threads=1).radiance
            for side in (1, -1)
        )
        found.append((high - low) / (2.0 * step))
    return np.stack(found)


def moved(mi: Any, shift: Any, swell: Any) -> Any:
    """Where the ball stands."""
    at = [CENTER[0] + shift, CENTER[1], CENTER[2]]
    return mi.Transform4f().translate(at) @ mi.Transform4f().scale(RADIUS + swell)


def theirs(mi: Any, dr: Any, there: Any, kind: str, samples: int, seed: int) -> Any:
    """The derivatives of one seed, (2, h, w, 3)."""
    told = {"sppc": samples, "sppp": samples, "sppi": samples}
    kinds = {"prb_projective": {"max_depth": 2}, "direct_projective": {}}
    integrator = mi.load_dict({"type": kind} | told | kinds[kind])
    found = []
    for which in range(2):
        params = mi.traverse(there)
        move = mi.Float(0.0)
        dr.enable_grad(move)
        params[KEY] = moved(mi, move if which == 0 else 0.0, move if which == 1 else 0.0)
        params.update()
        # how the ball's frame moves is known before the integrator isolates what it draws
        dr.forward(move, flags=dr.ADFlag.ClearEdges)
        image = mi.render(there, params, integrator=integrator, seed=2 * seed + which, spp=samples)
        found.append(np.array(dr.forward_to(image), dtype=np.float64))
    return np.stack(found)


def their_differences(mi: Any, there: Any, samples: int, seeds: int) -> Any:
    """Central differences of Mitsuba's own images with the same random numbers, (seeds, 2, h, w, 3)."""
    integrator, params, found = mi.load_dict({"type": "path", "max_depth": 2}), mi.traverse(there), []
    for seed in range(seeds):
        each = []
        for way in ((1, 0), (0, 1)):
            sides = []
            for side in (MITSUBA_STEP, -MITSUBA_STEP):
                params[KEY] = moved(mi, side * way[0], side * way[1])
                params.update()
                image = mi.render(there, integrator=integrator, seed=seed, spp=samples)
                sides.append(np.array(image, dtype=np.float64))
            each.append((sides[0] - sides[1]) / (2 * MITSUBA_STEP))
        found.append(each)
    return np.array(found)


def size_of(values: Any) -> float:
    """Root mean square."""
    return float(np.sqrt((values**2).mean()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="two runs, few samples")
    quick = parser.parse_args().quick
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    # threads that wait spin, which is CPU time too
    dr.set_thread_count(1)
    print("## projective_gradients\n")
    ours(1e-2)
    true, _, stated, missed = ours(1e-4 if quick else FINEST)
    scale = size_of(true)
    print(
        f"{SIZE} x {SIZE} pixels, {2 * SIZE**2} derivatives by the ball's place and radius, of RMS {scale:.4g} and at "
        f"most {np.abs(true).max():.4g}; the truth states {stated:.2g} at most, {missed} of them miss their tolerance. "
        f"Mitsuba {mi.__version__}, llvm_ad_rgb.\n"
    )
    told = our_differences(STEP, 1e-7 if quick else 1e-9)
    gap = size_of(told - true) / scale
    rows, times = [], []
    for tol in TOLERANCES[:2] if quick else TOLERANCES:
        found, seconds, most, missed = ours(tol)
        off = size_of(found - true) / scale
        rows.append(
            f"| ours, tol {tol:g} | {seconds:.3g} | {off:.2g} | | {np.abs(found - true).max():.2g} | {most:.2g} |"
        )
        times.append((f"tol {tol:g}", seconds, off))
    with tempfile.TemporaryDirectory() as folder:
        sr.export(scene(), "mitsuba", Path(folder) / "there", size=SIZE)
        there = mi.load_file(str(Path(folder) / "there" / "scene.xml"))
        slopes = their_differences(mi, there, 1 << (8 if quick else 12), 2 if quick else 4)
        expected = our_differences(MITSUBA_STEP, 1e-6)
        noise = size_of(slopes.std(axis=0, ddof=1)) / math.sqrt(len(slopes)) / scale
        apart = size_of(slopes.mean(axis=0) - expected) / scale
        equal = []
        for kind, samples in RUNS[:1] if quick else RUNS:
            theirs(mi, dr, there, kind, samples, 1000)
            begun = time.process_time()
            each = np.array([theirs(mi, dr, there, kind, samples, seed) for seed in range(2 if quick else SEEDS)])
            seconds = (time.process_time() - begun) / len(each)
            off = size_of(each - true) / scale
            scatter = size_of(each.std(axis=0, ddof=1)) / scale
            rest = size_of(each.mean(axis=0) - true) / scale
            rows.append(
                f"| `{kind}`, {samples} samples | {seconds:.3g} | {off:.2g} | {rest:.2g}, "
                f"{scatter / math.sqrt(len(each)):.2g} | {np.abs(each - true).max():.2g} | none |"
            )
            equal.append((kind, samples, seconds, off))
    print(
        "| who | CPU s | RMS error over the RMS | mean of all seeds, its scatter | largest error | stated |\n"
        "| --- | --- | --- | --- | --- | --- |"
    )
    print("\n".join(rows) + "\n")
    print("| at the CPU time of ours | ours | " + " | ".join(f"`{k}` from {s}" for k, s, _, _ in equal) + " |")
    print("| --- | --- |" + " --- |" * len(equal))
    for label, seconds, off in times:
        scaled = [f"{error * math.sqrt(cost / seconds):.2g}" for _, _, cost, error in equal]
        print(f"| {label}, {seconds:.3g} s | {off:.2g} | {' | '.join(scaled)} |")
    print("\nTheir errors are scaled by the root of the time, as those of scatter fall.\n")
    held = gap <= 1e-2 and apart <= 3.0 * noise
    print(f"- our differences of step {STEP:g} less our derivatives, RMS over RMS: {gap:.2g}, target <= 0.01")
    what = f"- Mitsuba's own differences less ours of step {MITSUBA_STEP:g}: {apart:.2g}, of which scatter {noise:.2g}"
    print(f"{what}, target <= three times that\n\n{'held' if held else 'MISSED'}")
    sys.exit(0 if held else 1)


if __name__ == "__main__":
    main()
