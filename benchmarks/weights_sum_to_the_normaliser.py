"""The weights of the strata sum to the lobe's normaliser, for any number of rings and any exponent.

Ring weights (cos^u a - cos^u b)/u, u = n + 1, of the lobe of half-angle pi/3, against 50 digits.
"""

from __future__ import annotations

import math
import sys
from itertools import pairwise

import mpmath
from measure import Report, arguments

from symrender.quadrature.strata import edges
from symrender.runtimes import numba

THETA_MAX = math.pi / 3
PARTITIONS = ("equal_angle", "equal_solid_angle", "equal_weight")


def exact(a: float, b: float, u: mpmath.mpf) -> mpmath.mpf:
    """int_a^b cos^n t sin t dt to the working precision."""
    return (mpmath.cos(a) ** u - mpmath.cos(b) ** u) / u


def main() -> None:
    options = arguments(__doc__)
    counts = (1, 4, 64) if options.quick else (1, 2, 4, 16, 64, 256, 1024)
    exponents = (0.0, 16.0, 1e12) if options.quick else (0.0, 0.5, 1.0, 16.0, 256.0, 4096.0, 1e6, 1e9, 1e12)
    report = Report("weights_sum_to_the_normaliser", f"Three partitions, K of {counts}, n of {exponents}.")
    formulas = numba.plain(numba.image_text())
    rows, ulps, worst, negative, checked = [], 0.0, 0.0, 0, 0
    with mpmath.workdps(50 + 20):
        for n in exponents:
            row: list[object] = [f"{n:g}"]
            for k in counts:
                here_ulps, here = 0.0, 0.0
                for partition in PARTITIONS:
                    bounds = edges(formulas, n, THETA_MAX, k, partition).tolist()
                    u = mpmath.mpf(n) + 1
                    weights = [formulas.ring_weight(a, b, n + 1) for a, b in pairwise(bounds)]
                    total = exact(0.0, THETA_MAX, u)
                    here_ulps = max(here_ulps, float(abs(math.fsum(weights) - total) / math.ulp(float(total))))
                    negative += sum(w < 0 for w in weights)
                    for a, b, w in zip(bounds[:-1], bounds[1:], weights, strict=True):
                        true = exact(a, b, u)
                        if true > sys.float_info.min:
                            checked += 1
                            here = max(here, float(abs(w - true) / true))
                row.append(f"{here_ulps:.1f} ulp, {here:.1e}")
                ulps, worst = max(ulps, here_ulps), max(worst, here)
            rows.append(tuple(row))
    report.table(("n", *(f"K = {k}" for k in counts)), rows)
    report.say(
        f"Each cell: error of the sum against the closed form, and the worst relative error of one weight, the "
        f"larger of {', '.join(PARTITIONS)}; {checked} weights above the smallest normal number. A black image would "
        "be 100 % off."
    )
    assert checked > 50, "too few weights to speak of"
    report.claim_number("sum of the weights, ulp", ulps, 4)
    report.claim_number("worst relative error of a weight", worst, 1e-12)
    report.claim_number("negative weights", negative, 0)
    report.leave()


if __name__ == "__main__":
    main()
