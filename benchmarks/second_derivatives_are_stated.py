"""No second derivative of direct light on one plane is beyond three times what it states.

    python benchmarks/second_derivatives_are_stated.py [--quick] [SEED [COUNT]]

Planes of every material, plain, textured and with bumps, of sizes from 1e-6 to 1e6 and as far as 1e5 of their size from
the origin, under a point light or a sun (``tests/radiometric/second_order.py``). The judge differentiates the closed
form, written once more, in 120 digits.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from measure import Report
from tests.radiometric import second_order

import symrender as sr
from symrender.errors import SymrenderError

SCENES, QUICK = 175, 7
LIKELY = 1e-3
"""A second derivative is told where what it states is at most this part of it."""


def judged(seed: int, count: Counter[str], report: Report) -> None:
    """Count what became of the second derivatives in two numbers of one scene."""
    made = second_order.case(seed)
    rng = np.random.default_rng([seed, 52])
    names = sorted(made.steps)
    chosen = [names[k] for k in rng.choice(len(names), size=2, replace=False)]
    try:
        found = sr.hessian(made.scene, chosen, rays=made.rays)
    except SymrenderError as fault:
        count["refused"] += 1
        report.say(f"seed {seed}, {second_order.KINDS[seed % 7]}, {chosen}: {fault}")
        return
    for ray in range(second_order.RAYS):
        for i, j in ((0, 0), (0, 1), (1, 1)):
            true = second_order.second(made, (chosen[i], chosen[j]), ray)
            value, stated = float(found.values[i, j, ray, 0]), float(found.error[i, j, ray])
            off = abs(value - true)
            count["judged"] += 1
            count["infinite"] += not np.isfinite(stated)
            count["not zero"] += true != 0.0
            count["told"] += true != 0.0 and stated <= LIKELY * abs(true)
            count["beyond 1.0"] += off > stated
            if off > 3.0 * stated:
                count["beyond"] += 1
                report.say(
                    f"seed {seed}, {second_order.KINDS[seed % 7]}, ray {ray}, {chosen[i]}, {chosen[j]}: "
                    f"{value:.10g} +- {stated:.3g}, is {true:.10g}"
                )


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("second_derivatives_are_stated", __doc__.split("\n")[0])
    scenes = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else SCENES)
    count: Counter[str] = Counter()
    begun = time.process_time()
    for seed in range(first, first + scenes):
        judged(seed, count, report)
    report.say(
        f"{count['judged']} second derivatives of {scenes - count['refused']} scenes, {count['refused']} scenes "
        f"refused; {count['not zero']} are not zero, of which {count['told']} are told to {LIKELY:g} of themselves; "
        f"{count['infinite']} state that nothing is known; {count['beyond 1.0']} are beyond once what they state; "
        f"{(time.process_time() - begun) / scenes:.3g} CPU s a scene"
    )
    report.claim_number("second derivatives beyond 3 times what they state", count["beyond"], 0)
    report.claim_number("those not zero and not told, as a part", 1 - count["told"] / max(1, count["not zero"]), 0.1)
    report.leave()


if __name__ == "__main__":
    main()
