"""Time a pixel grows slower than the number of spheres: 4 to 256 of them, spread over a checkered floor.

The floor grows with the spheres, and so does the camera's distance; every surface is glossy and five light points
shadow all of them. Time is of one processor and of whole images. Points on both kinds of surface are judged by long
lattices of the adversary, which share nothing with the package: what a chart leaves out must be nowhere in its lobe.
They are asked a coarser tolerance than images are, of which the lattices tell more than half. Larger crowds, up to as
many spheres as a scene may hold, are timed without a claim. Walls are those that some line met.

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

from adversary.judge import by_lattice, lobe_of, world_of
from quadrature.spread import spread

TOL, SIZE = 1e-4, 24
JUDGED, JUDGED_TOL, FACTOR = 10, 1e-3, 1.5
LOOKS, MORE_LOOKS = 65_536, 262_144
"""Directions of a lattice, of which there are sixteen, and of one that has the last word on a value called beyond."""
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


def judged(data: dict[str, Any], count: int) -> tuple[int, int]:
    """Of ``JUDGED`` points, of how many ``FACTOR`` times the stated error would be seen, and at how many it is."""
    world, told, beyond = world_of(data, "2x2"), 0, 0
    for surface, point in places(data, JUDGED):
        said = sr.probe(data, [point], surface=surface, tol=JUDGED_TOL, disk="2x2", threads=1)
        stated, lobe = float(said.error[0]), lobe_of(data, surface, point)
        for looks in (LOOKS, MORE_LOOKS):
            found = by_lattice(world, lobe, looks, count)
            off = float((np.abs(said.gloss[0] - found.value) - found.doubt).max())
            if off <= stated:
                break
        told += float(found.doubt.max()) <= (FACTOR - 1.0) * stated
        beyond += off > stated
    return told, beyond


def main() -> None:
    quick = arguments(__doc__).quick
    judged_counts = QUICK if quick else COUNTS
    counts = QUICK if quick else (*COUNTS, *CROWDS)
    report = Report("many_spheres_cost_little", "Time a pixel grows slower than the number of spheres.")
    rows: list[list[object]] = []
    beyond, told, before, worst = 0, 0, math.nan, 0.0
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
        told_here, beyond_here = judged(data, count) if count in judged_counts else (0, 0)
        crossings = image.layers["crossings"]
        growth = math.log(seconds / before) / math.log(4.0) if before == before else math.nan
        worst = max(worst, growth) if growth == growth and count in judged_counts else worst
        rows.append(
            [count, 1e3 * seconds / SIZE**2, growth, float(crossings.mean()), float(np.sqrt((gloss**2).mean())), unmet,
             JUDGED if count in judged_counts else 0, told_here, beyond_here]
        )  # fmt: skip
        beyond, told, before = beyond + beyond_here, told + told_here, seconds
    report.say(f"{SIZE} x {SIZE} pixels to {TOL:g}; {JUDGED} points of each scene, asked {JUDGED_TOL:g}, are judged.")
    told_name = f"told at {FACTOR}x"
    report.table(
        ("spheres", "CPU ms a pixel", "growth", "walls", "RMS gloss", "unmet", "judged", told_name, "beyond"), rows
    )
    report.claim_number("values beyond their stated error", beyond, 0)
    report.claim_number("share of judged values nobody can tell", 1.0 - told / (JUDGED * len(judged_counts)), 0.5)
    report.claim_time("largest exponent of growth from one count to the next", worst, 0, EXPONENT)
    report.leave()


if __name__ == "__main__":
    main()
