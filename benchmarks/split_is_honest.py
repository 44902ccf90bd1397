"""The split rule's error estimate holds: random scenes, points and exponents against references of two kinds.

The first reference is the rule itself, a hundred times tighter. It shares the charts and the walls, so a wall nobody
drew would go unseen; hence the second, on a part of the lobes: midpoints of 200 x 400 directions with visibility and
shading written out literally (``tests/quadrature/brute_lobe.py``), itself good to a few thousandths.

Lattices of directions, which do the spheres at loose tolerances where chambers need not be counted, are judged at
``LOOSER`` times the tolerance against the tight value.

    python benchmarks/split_is_honest.py [--quick] [FIRST]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from measure import Report, cpu_seconds

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.quadrature.random_lobe import RandomLobe, random_lobe

LOBES, QUICK, BRUTE, LOOSER = 10_000, 300, 40, 100.0
"""Lobes, lobes of a quick run, one lobe of how many is also done by brute force, and how much looser lattices are."""


def brute_disagrees(lobe: RandomLobe, value: np.ndarray, error: float) -> bool:
    """Whether brute force contradicts a value and its error, beyond three times what its own refinement moved."""
    coarse, fine = lobe.brute(100), lobe.brute(200)
    return bool(np.abs(value - fine).max() > error + 3 * np.abs(fine - coarse).max() + 3e-3 * fine.max() + 1e-4)


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--quick"]
    count = QUICK if "--quick" in sys.argv else LOBES
    first = int(words[0]) if words else 0
    report = Report("split_is_honest", "The true error is within the reported one for at least 99.9 % of random lobes.")
    judged = signal = met = contradicted = compared = on_lattices = 0
    dishonest: list[list[object]] = []
    dishonest_lattices: list[list[object]] = []
    seconds = 0.0
    # the first call may compile
    random_lobe(first).split(1.0)
    for seed in range(first, first + count):
        lobe = random_lobe(seed)
        found = []
        seconds += cpu_seconds(lambda lobe=lobe, found=found: found.append(lobe.split(lobe.tol)))
        value, error = found[0].gloss[0], float(found[0].error[0])
        met += found[0].status[0] == 0
        tight = lobe.split(max(0.01 * lobe.tol, 1e-11))
        away = float(np.abs(value - tight.gloss[0]).max())
        if away > error and tight.error[0] > 0.5 * away:
            # the reference cannot tell
            continue
        judged += 1
        loose = lobe.split(LOOSER * lobe.tol, walled=False)
        beyond = float(np.abs(loose.gloss - tight.gloss).max())
        if loose.evaluations[0] > 0 and loose.chambers[0] == 0:
            on_lattices += 1
        if beyond > loose.error[0] + tight.error[0]:
            dishonest_lattices.append([seed, lobe.surface, lobe.exponent, lobe.theta_max, loose.error[0], beyond])
        signal += bool(tight.gloss.max() > 10 * lobe.tol)
        if away > error:
            dishonest.append([seed, lobe.surface, lobe.exponent, lobe.theta_max, lobe.tol, error, away])
        if seed % BRUTE == 0:
            compared += 1
            contradicted += brute_disagrees(lobe, value, error)
    report.say(
        f"{count} lobes from seed {first}, {judged} with a reference that could tell, {signal} brighter than ten "
        f"tolerances, {met} met their tolerance; {1e3 * seconds / count:.3g} ms a lobe; {compared} by brute force."
    )
    if dishonest:
        report.table(["seed", "surface", "n", "theta_max", "tol", "stated", "true"], dishonest)
    report.say(f"{LOOSER:g} times looser and uncounted, {on_lattices} lobes were done on lattices alone.")
    if dishonest_lattices:
        report.table(["seed", "surface", "n", "theta_max", "stated", "true"], dishonest_lattices)
    report.claim_number("lobes left unjudged, per lobe", 1 - judged / count, 0.02)
    report.claim_number("true error beyond the stated one, per lobe", len(dishonest) / judged, 1e-3)
    report.claim_number("the same with lattices, per lobe", len(dishonest_lattices) / judged, 1e-3)
    report.claim_number("contradicted by brute force", contradicted, 0)
    report.leave()


if __name__ == "__main__":
    main()
