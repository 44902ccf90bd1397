"""A million pixels are audited in at most ten seconds beyond their truth.

The truth is made first and given; what is timed is `audit` itself: reading of moments or of eight seeds that are in
memory, the regions, every test. Seconds are of the processor, all threads together, and of the clock.
"""

from __future__ import annotations

import time

import numpy as np
from measure import Report, arguments

import symrender as sr
from symrender.images.image import Image

NOISE = 0.1
SAMPLES = 64


def main() -> None:
    side = 250 if arguments(__doc__).quick else 1000
    report = Report("audits_a_million_pixels", f"`metal`, {side} x {side} pixels, noise of a tenth of the light.")
    begun = time.process_time()
    true = sr.truth("metal", size=side, tol=1e-4)
    made = time.process_time() - begun
    rng = np.random.default_rng(1)
    light = true.radiance
    sigma = NOISE * light
    moments = Image({"radiance": light + sigma * rng.standard_normal(light.shape) / SAMPLES**0.5, "variance": sigma**2})
    seeds = [Image({"radiance": light + sigma * rng.standard_normal(light.shape)}) for _ in range(8)]
    # what is compiled is compiled before
    sr.audit(moments, "metal", truth=true, samples=SAMPLES, explain=False)
    rows = []
    for name, renders in (("variances", moments), ("8 seeds", seeds)):
        cpu, clock = time.process_time(), time.perf_counter()
        samples = SAMPLES if isinstance(renders, Image) else 0
        verdict = sr.audit(renders, "metal", truth=true, samples=samples, explain=False)
        seconds = (time.process_time() - cpu, time.perf_counter() - clock)
        rows.append((name, len(verdict.regions), verdict.pixels.judged, *seconds, str(verdict.passed)))
    report.table(("noise from", "means tested", "pixels judged", "CPU s", "s", "passed"), rows)
    report.say(f"The truth took {made:.3g} CPU s.")
    report.claim_number("right images that fail", sum(row[-1] != "True" for row in rows), 0)
    report.claim_number("share of pixels not judged alone", max(1.0 - row[2] / side**2 for row in rows), 0.5)
    report.claim_time("CPU s of the slower audit", max(row[3] for row in rows), 0, 10)
    report.leave()


if __name__ == "__main__":
    main()
