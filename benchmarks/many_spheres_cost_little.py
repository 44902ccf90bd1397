"""Time a pixel grows slower than the number of spheres: 4 to 256 of them, spread over a checkered floor.

The floor grows with the spheres, and so does the camera's distance; every surface is glossy and five light points
shadow all of them. Time is of one processor and of whole images. Points on both kinds of surface are judged by the
evaluator of the adversary, which shares nothing with the package: what a chart leaves out must be nowhere in its lobe.
Larger crowds, up to as many spheres as a scene may hold, are timed without a claim. Walls are those that some line met.

    python benchmarks/many_spheres_cost_little.py [--quick]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report, arguments, cpu_seconds

import symrender as sr
from symrender.images.image import Image
from symrender.scene.scene import Scene

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from adversary.case import Case
from adversary.judge import judge, summed
from quadrature.spread import spread

TOL, SIZE, JUDGED, BUDGET = 1e-4, 12, 10, 4_000_000
COUNTS, QUICK, CROWDS = (4, 16, 64, 256), (4, 16), (1024, 4096)
EXPONENT = 0.5
"""Wanted of the growth from one count to the next."""


def places(scene: dict[str, Any], count: int) -> list[tuple[str, list[float]]]:
    """Random points of the floor and of spheres that face the eye."""
    rng, eye = np.random.default_rng(1), np.array(scene["camera"]["eye"])
    side = 0.5 * math.isqrt(len(scene["spheres"]))
    found: list[tuple[str, list[float]]] = []
    while len(found) < count:
        if len(found) % 2 == 0:
            p = np.append(rng.uniform(-side, side, 2), 0.0)
            if all(math.dist(p, s["center"]) > s["radius"] for s in scene["spheres"]):
                found.append(("floor", p.tolist()))
            continue
        sphere = scene["spheres"][int(rng.integers(len(scene["spheres"])))]
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        if n[2] > -0.9 and (eye - sphere["center"]) @ n > 1.1 * sphere["radius"]:
            found.append((f"spheres.{sphere['name']}", n.tolist()))
    return found


def main() -> None:
    quick = arguments(__doc__).quick
    judged_counts = QUICK if quick else COUNTS
    counts = QUICK if quick else (*COUNTS, *CROWDS)
    report = Report("many_spheres_cost_little", "Time a pixel grows slower than the number of spheres.")
    rows: list[list[object]] = []
    beyond, told, before, worst = 0.0, 0.0, math.nan, 0.0
    for count in counts:
        data = spread(count)
        scene = sr.load(data)
        sr.truth(scene, size=2, tol=TOL, threads=1)
        images: list[Image] = []

        def drawn(scene: Scene = scene, images: list[Image] = images) -> None:
            images.append(sr.truth(scene, size=SIZE, tol=TOL, threads=1))

        seconds = min(cpu_seconds(drawn) for _ in range(1 if count > 64 else 2))
        image = images[0]
        unmet = int((image.layers["status"] != 0).sum())
        gloss = image.layers["gloss"]
        verdicts = [
            v
            for surface, p in (places(data, JUDGED) if count in judged_counts else [])
            for v in judge(Case("spread", count, data, surface, [p], disk="2x2", tol=TOL, budget=BUDGET))
        ]
        judged = summed(verdicts)
        crossings = image.layers["crossings"]
        growth = math.log(seconds / before) / math.log(4.0) if before == before else math.nan
        worst = max(worst, growth) if growth == growth and count in judged_counts else worst
        rows.append(
            [count, 1e3 * seconds / SIZE**2, growth, float(crossings.mean()), float(np.sqrt((gloss**2).mean())), unmet,
             int(judged["values"]), int(judged["told at 1.5x"]), int(judged["beyond"])]
        )  # fmt: skip
        beyond, told, before = beyond + judged["beyond"], told + judged["told at 1.5x"], seconds
    report.say(f"{SIZE} x {SIZE} pixels to {TOL:g}; {JUDGED} points of each scene judged.")
    report.table(
        ("spheres", "CPU ms a pixel", "growth", "walls", "RMS gloss", "unmet", "judged", "told at 1.5x", "beyond"), rows
    )
    report.claim_number("values beyond their stated error", beyond, 0)
    report.claim_number("share of judged values nobody can tell", 1.0 - told / (JUDGED * len(judged_counts)), 0.5)
    report.claim_time("largest exponent of growth from one count to the next", worst, 0, EXPONENT)
    report.leave()


if __name__ == "__main__":
    main()
