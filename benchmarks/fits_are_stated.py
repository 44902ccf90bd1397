"""Deviations of fits are those of repeated noise, and what a target does not determine is named.

    python benchmarks/fits_are_stated.py [--quick] [SEED [COUNT]]

Fits of images of 6 x 6 pixels, of scenes of sizes from 1e-3 to 1e3, under Gaussian noise, Student's noise of three
degrees of freedom and noise in proportion to the light (``tests/fits.py``). Of a third of them a product alone is
determined, or a ball that no ray meets is free, which is known from how the scene is made.
"""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from measure import Report
from tests import fits

import symrender as sr

FITS, QUICK = 500, 30
TOL, PRECISION = 1e-9, 1e-7


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("fits_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else FITS)
    off: dict[str, list[float]] = defaultdict(list)
    unnamed = claimed = missing = unfinished = 0
    begun = time.process_time()
    for seed in range(first, first + count):
        made = fits.case(seed)
        # the smallest light of these scenes is a hundredth of the brightest
        bright = float(np.abs(made.target.radiance).max())
        found = sr.fit(made.start, made.target, made.free, tol=max(1e-13, TOL * bright), precision=PRECISION, threads=1)
        unfinished += not found.converged
        if not fits.named(found, made.unknown):
            unnamed += 1
            report.say(f"seed {seed}: {[dict(each) for each in found.undetermined]}, is {list(made.unknown)}")
        unknown = {name for each in made.unknown for name in each}
        for name, value in made.true.items():
            infinite = not np.isfinite(found.deviations[name])
            claimed += name in unknown and not infinite
            missing += name not in unknown and infinite
            if name not in unknown and not infinite:
                off[made.noise].append((found.values[name] - value) / found.deviations[name])
    report.table(
        ("noise", "parameters", "RMS error over deviation", "within one", "within two"),
        [
            (noise, len(z), float(np.sqrt(np.mean(np.square(z)))), *(float((np.abs(z) <= k).mean()) for k in (1, 2)))
            for noise, z in off.items()
        ],
    )
    report.say(f"{count} fits, {unfinished} not converged, {(time.process_time() - begun) / count:.3g} CPU s each")
    report.claim_number("fits whose null directions are not named", unnamed, 0)
    report.claim_number("parameters that are not determined with a finite deviation", claimed, 0)
    report.claim_number("determined parameters with an infinite one", missing, 0)
    for noise, z in off.items():
        # four standard errors of a share, beside the share itself
        wide = 4.0 * float(np.sqrt(0.683 * 0.317 / len(z)))
        within = float((np.abs(z) <= 1.0).mean())
        report.claim_number(f"{noise}: off from 68.3 % within one deviation", abs(within - 0.683), wide)
    report.leave()


if __name__ == "__main__":
    main()
