"""Light past a ball that is sunk into a checker is as near as it states.

    python benchmarks/sunk_balls_are_stated.py [--quick] [SEED [COUNT]]

A wall sees a checkered floor past a black ball that the floor cuts, or that stands on it. Where it is cut, the
outlines of what it hides and shades touch the circle of the cut. What is missing of the light, without the ball less
with it, is an integral over the hidden and the shaded part of the floor in polar coordinates about the ball
(``tests/radiometric/test_touching_outlines.py``), of two numbers of azimuths, which say what it may be off.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.radiometric.test_touching_outlines import RADIUS, Case, missing, scene

COUNT, QUICK = 200, 12
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
AZIMUTHS = (2000, 3000)
"""Pieces of the circle of azimuths; kinks fall into some of them."""
DOUBT = 5.0
"""What two numbers of them differ by, times this, the judge may be off."""
TOLD = 0.25
"""Share of what is stated that the judge may be off and tell."""
LOOSEST = 1.5


def drawn(seed: int) -> Case:
    """Cell and turn of the checker, the ball's height and the light's place."""
    rng = np.random.default_rng([seed, 31])
    cell, turn = float(rng.choice([0.3, 0.7, 1.5, 3.0])), float(rng.choice([0.0, rng.uniform(0.0, 1.57)]))
    height = float(rng.choice([rng.uniform(-0.48, 0.48), rng.uniform(-0.48, 0.48), RADIUS]))
    # higher than the ball by enough that its shadow ends near by
    light = (
        float(rng.uniform(-1.5, 1.5)),
        float(rng.uniform(-1.5, 1.5)),
        height + RADIUS + float(rng.uniform(0.2, 0.9)),
    )
    return cell, turn, height, light


def main() -> None:
    import symrender as sr
    from symrender.scene.load import load_any

    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), QUICK if "--quick" in sys.argv else COUNT
    count = seeds[1] if len(seeds) > 1 else count
    report = Report("sunk_balls_are_stated", "Light past a ball that is sunk into a checker is as near as it states.")
    told, met, sunk, judged, beyond = 0, 0, 0, [], []
    for seed in range(first, first + count):
        case = drawn(seed)
        sunk += abs(case[2]) < RADIUS
        coarse, hidden = (missing(*case, pieces=pieces) for pieces in AZIMUTHS)
        worlds = [load_any(scene(ball, *case)) for ball in (False, True)]
        for tol in TOLERANCES:
            without, beside = (sr.truth(each, size=1, tol=tol, threads=1, tile=1) for each in worlds)
            stated = float(without.layer("error")[0, 0] + beside.layer("error")[0, 0])
            if DOUBT * abs(hidden - coarse) > TOLD * stated:
                continue
            told += 1
            met += int(without.layer("status")[0, 0] == 0 and beside.layer("status")[0, 0] == 0)
            off = abs(float((without.layer("indirect") - beside.layer("indirect"))[0, 0, 0]) - hidden)
            judged.append(max(0.0, off - DOUBT * abs(hidden - coarse)) / stated)
            if judged[-1] > 1.0:
                beyond.append((seed, tol, off, stated, hidden))
    report.say(
        f"{count} worlds of seeds from {first} on, {sunk} of them cut by the floor: of {len(TOLERANCES) * count} "
        f"differences of two values the judge tells {told}, {met} of them met. The largest error is "
        f"{max(judged):.2g} of what is stated; beyond: {len(beyond)}."
    )
    report.table(["seed", "tolerance", "off", "stated", "missing light"], beyond[:12])
    report.claim_number("differences more than 1.5 times beyond", sum(each > LOOSEST for each in judged), 0)
    report.leave()


if __name__ == "__main__":
    main()
