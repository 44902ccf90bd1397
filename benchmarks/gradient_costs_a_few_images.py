"""The gradient of an image in a sphere's three coordinates, edges included, costs no more than 3.5 of its images.

The ``gloss`` scene at 64 x 64 with sphere B's centre as parameters, one thread, against central differences of images
(which cost six images, and are only as exact as their step allows). With --peers, the folder of rival programs, the
same question is put to Dr.Jit, differentiating through samples, and to Mitsuba's ``prb_projective``, each about its own
version of ``chapter8``; --peer-python is an interpreter that has them, DRJIT_LIBLLVM_PATH their LLVM (17 or later).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from pathlib import Path

import numpy as np
from measure import Report, cpu_seconds

import symrender as sr
from symrender.scene.parameters import get

TOL = 1e-4
STEP = 1e-4


def peer(words: list[str]) -> tuple[dict[str, object], str]:
    """The last JSON line a rival prints, empty where it does not run, and then its last words."""
    done = subprocess.run(words, capture_output=True, text=True, timeout=1500)
    # a rival's coloured log may end on the line of its result
    lines = [line[line.index("{") :] for line in done.stdout.splitlines() if line.endswith("}") and "{" in line]
    if lines:
        return json.loads(lines[-1]), ""
    return {}, (done.stderr.strip().splitlines() or [f"exit {done.returncode}"])[-1]


def interior_and_whole(report: Report, python: str, folder: Path, samples: str) -> None:
    """Dr.Jit's gradient of the picture's sum through samples, beside the exact one, and both cost ratios."""
    scene = sr.load("chapter8")
    names = [f"spheres.B.center.{axis}" for axis in "xyz"]
    value: list[sr.Image] = []
    slopes: list[dict[str, sr.Image]] = []
    image_s = cpu_seconds(lambda: value.append(sr.truth(scene, size=64, tol=1e-6, threads=1)))
    gradient_s = cpu_seconds(lambda: slopes.append(sr.gradient(scene, names, size=64, tol=1e-5, threads=1)))
    floor = value[0].layer("hit_class") == 1
    true = np.array([slopes[0][name].layer("gloss")[floor].sum() for name in names])
    stated = max(float(slopes[0][name].layer("error")[floor].max()) for name in names)
    rows: list[tuple[object, ...]] = [("symrender", gradient_s, gradient_s / image_s, *true, f"{stated:.0e} a pixel")]
    for program, extra in (("drjit_lobe.py", ["--S", samples]), ("mitsuba_scene.py", ["--spp", samples])):
        common = [python, str(folder / program), *extra, "--reps", "3"]
        plain, _ = peer([*common])
        through = [*common, "--grad", "1" if program.startswith("drjit") else "prb_projective"]
        found, why = peer(through) if plain else ({}, "nor did its image")
        if not found:
            report.say(f"{program} did not run here: {why}")
            continue
        ratio = float(found["cpu_s"]) / float(plain["cpu_s"])
        theirs = np.array(found["grad"], dtype=float)
        if program.startswith("drjit"):
            error = f"{float(np.abs(theirs - true).max() / np.abs(true).max()):.2g} of the largest"
        else:
            spread = np.array(found["grad_sd"], dtype=float) / np.abs(theirs)
            error = f"noise {float(spread.max()):.1e} of itself"
        rows.append((f"{program}, {samples} samples", float(found["cpu_s"]), ratio, *theirs, error))
    report.table(("program", "gradient CPU s", "over its image", "d/dx", "d/dy", "d/dz", "error"), rows)
    report.say(
        "d of the sum of the gloss of all floor pixels and channels (symrender, Dr.Jit: the same scene; Dr.Jit "
        "differentiates through its samples, without boundary terms). Mitsuba's scene has other lights and another "
        "highlight, and its figure is the mean over the picture: only its cost and its noise compare."
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--peers", type=Path, help="folder with drjit_lobe.py and mitsuba_scene.py")
    parser.add_argument("--peer-python", default=os.environ.get("PEER_PYTHON", "python3"))
    options = parser.parse_args()
    size = 12 if options.quick else 64
    report = Report(
        "gradient_costs_a_few_images", f"Scene gloss, {size} x {size}, tol {TOL:g}, one thread, sphere B's centre."
    )
    scene = sr.load("gloss")
    names = [f"spheres.B.center.{axis}" for axis in "xyz"]
    sr.truth(scene, size=2, tol=TOL, threads=1)
    sr.gradient(scene, names, size=2, tol=TOL, threads=1)
    kept: list[dict[str, sr.Image]] = []
    ratios, rows = [], []
    for _ in range(1 if options.quick else 2):
        image_s = cpu_seconds(lambda: sr.truth(scene, size=size, tol=TOL, threads=1))
        gradient_s = cpu_seconds(lambda: kept.append(sr.gradient(scene, names, size=size, tol=TOL, threads=1)))
        ratios.append(gradient_s / image_s)
        rows.append((image_s, gradient_s, gradient_s / image_s))
    report.table(("image CPU s", "gradient CPU s", "ratio"), rows)
    slopes = kept[-1]
    table, worst = [], 0.0
    for name in names[: 1 if options.quick else 3]:
        at = float(get(scene, name))
        sides = [
            sr.truth(scene.replace({name: at + s * STEP}), size=size, tol=1e-7, threads=1)
            for s in (1.0, -1.0, 2.0, -2.0)
        ]
        for layer in ("direct", "gloss"):
            fine, coarse = (
                (sides[k].layer(layer) - sides[k + 1].layer(layer)) / (2 * STEP * (1 + k // 2)) for k in (0, 2)
            )
            expected = (4 * fine - coarse) / 3
            exact = slopes[name].layer(layer)
            largest = float(np.abs(exact).max())
            smooth = np.abs(fine - coarse).max(axis=-1) < 1e-2 * largest
            gap = float(np.abs(exact - expected).max(axis=-1)[smooth].max()) / max(largest, 1e-300)
            table.append((name, layer, largest, int((~smooth).sum()), gap))
            worst = max(worst, gap)
    report.table(("parameter", "layer", "largest derivative", "pixels with an event within the step", "gap"), table)
    if options.peers:
        interior_and_whole(report, options.peer_python, options.peers, "256")
    report.claim_number("gap to differences, over the largest derivative", worst, 1e-3)
    report.claim_time("gradient over image", min(ratios), 0, 3.5)
    report.leave()


if __name__ == "__main__":
    main()
