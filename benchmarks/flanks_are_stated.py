"""No value that is nothing but the flank of a highlight of a disk is beyond what it states.

    python benchmarks/flanks_are_stated.py [--quick]

A disk's rule of few points sees too little of a highlight that most of the disk is on the flank of, and how far wrong
it is hardly shows in the errors of the lines that it is asked on. So these scenes have no other light: no ambient, no
diffuse term, a black background, and a lobe of the floor at a sphere that shines by less than a thousandth of the peak
of its highlight. Each point is asked tolerances from its value down to a hundredth of it. Judged by long lattices of
the adversary, which share nothing with the package, where these know the value to a fiftieth of itself.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report, arguments

import symrender as sr
from symrender.settings import MIN_TOLERANCE

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from adversary.judge import by_lattice, lobe_of, world_of

SCENES, QUICK = 160, 12
FIRST, LOOKS, MORE_LOOKS = 256, 4096, 65_536
"""Directions of a lattice that finds flanks, of one that judges, and of one that has the last word."""
FAINTEST, BRIGHTEST, KNOWN = 1e-12, 1e-3, 0.02
SHARES = (1.0, 0.3, 0.1, 0.03, 0.01)
FACTOR = 1.5


def flank(rng: np.random.Generator) -> dict[str, Any]:
    """A sphere over a floor under one disk light, of which highlights are all that is seen."""

    def between(low: float, high: float) -> float:
        return math.exp(rng.uniform(math.log(low), math.log(high)))

    def above(least: float) -> np.ndarray:
        found = rng.normal(size=3)
        found[2] = abs(found[2]) + least
        return found / np.linalg.norm(found)

    center, radius, shininess = np.array([0.0, 0.0, 0.7]), between(0.2, 2.0), between(3.0, 400.0)
    lobe = {"weight": 0.8, "exponent": between(30.0, 3000.0), "theta_max": 1.0}
    return {
        "name": "flank",
        "camera": {"type": "look_at", "eye": (4.0 * above(0.3)).tolist(), "target": [0, 0, 0.5], "up": [0, 0, 1],
                   "fov": 40},
        "spheres": [{"name": "A", "center": center.tolist(), "radius": 0.5, "color": [1, 1, 1]}],
        "floor": {"texture": {"type": "solid", "color": [0.5, 0.5, 0.5]}, "lobe": lobe},
        "lights": [{"name": "k", "type": "disk", "radius": radius, "target": center.tolist(), "color": [1, 1, 1],
                    "position": (center + radius * between(1.5, 8.0) * above(0.2)).tolist()}],
        "ambient": [0, 0, 0],
        "background": [0, 0, 0],
        "shading": {"model": str(rng.choice(["blinn", "phong"])), "ka": 0.0, "kd": 0.0, "ks": 1.0,
                    "shininess": float(round(shininess)) if rng.random() < 0.3 else shininess},
    }  # fmt: skip


def main() -> None:
    wanted = QUICK if arguments(__doc__).quick else SCENES
    report = Report("flanks_are_stated", "No value that is nothing but a highlight's flank is beyond what it states.")
    rng, found = np.random.default_rng(11), 0
    told, beyond, worst = (np.zeros(len(SHARES)) for _ in range(3))
    while found < wanted:
        scene = flank(rng)
        world, point = world_of(scene, "exact"), [*rng.uniform(-1.5, 1.5, 2).tolist(), 0.0]
        lobe = lobe_of(scene, "floor", point)
        if not FAINTEST < by_lattice(world, lobe, FIRST, found, careful=False).value.max() < BRIGHTEST:
            continue
        judge = by_lattice(world, lobe, LOOKS, found, careful=False)
        value, doubt = judge.value.max(), judge.doubt.max()
        if doubt > KNOWN * value:
            continue
        found += 1
        for k, share in enumerate(SHARES):
            tol = max(share * value, MIN_TOLERANCE)
            said = sr.probe(scene, [point], surface="floor", tol=tol, disk="exact", threads=1)
            stated = float(said.error[0])
            off = float(np.abs(said.gloss[0] - judge.value).max())
            if off > stated + doubt:
                last = by_lattice(world, lobe, MORE_LOOKS, found + 1, careful=False)
                off, doubt = float(np.abs(said.gloss[0] - last.value).max()), float(last.doubt.max())
            told[k] += doubt <= (FACTOR - 1.0) * stated
            beyond[k] += off > stated + doubt
            worst[k] = max(worst[k], (off - doubt) / stated)
    report.say(f"{found} scenes; values between {FAINTEST:g} and {BRIGHTEST:g} of a highlight's peak.")
    report.table(
        ("tolerance over the value", f"told at {FACTOR}x", "beyond", "most off, of what is stated"),
        [[share, int(told[k]), int(beyond[k]), worst[k]] for k, share in enumerate(SHARES)],
    )
    report.claim_number("values beyond their stated error", int(beyond.sum()), 0)
    report.claim_number("share of values nobody can tell", 1.0 - float(told.sum()) / (found * len(SHARES)), 0.6)
    report.leave()


if __name__ == "__main__":
    main()
