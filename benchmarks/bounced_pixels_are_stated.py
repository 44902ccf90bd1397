"""No mean over a pixel of a radiometric scene whose light bounces is beyond 1.5 times what it states.

    python benchmarks/bounced_pixels_are_stated.py [--quick] [SEED [COUNT]]

The hostile pixels of ``pixels_are_stated.py`` with ``bounces: 1``, under every filter. Each is judged by a run that
asks for twenty times less, and by paths of the conventional tracer through places of its support drawn at random.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from measure import Report
from pixels_are_stated import hostile

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.radiometric.world import seen
from symrender.runtimes.pixels import brightest
from symrender.scene.radiometric.arrays import radiometric_arrays

PIXELS, QUICK = 2_000, 12
TOL = 1e-2
"""Over the brightest light of a scene."""
FILTERS = ("box", "box", "tent", "gaussian", "mitchell")
LOBE, SEEDS = 64, 8
BUDGET = 300_000


def paths(scene: Any, kind: str, first: int) -> tuple[Any, Any]:
    """(mean of the pixel by paths, its standard error), of independent runs."""
    runs = [
        sr.render(scene, size=1, numeric="jittered", symbolic="none", lobe=LOBE, filter=kind, seed=first + k).numeric
        for k in range(SEEDS)
    ]
    found = np.array([image.radiance[0, 0] for image in runs if image is not None])
    assert len(found) == SEEDS
    return found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(SEEDS)


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("bounced_pixels_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else PIXELS)
    judged = lit = signal = met = refused = beyond = apart = 0
    seconds = 0.0
    for seed in range(first, first + count):
        kind = FILTERS[seed // 4 % len(FILTERS)]
        try:
            scene = hostile(seed).replace({"bounces": 1})
            bright = brightest(seen(radiometric_arrays(scene), 1, 1))
            found = []
            for part in (1.0, 0.05):
                begun = time.process_time()
                tol = float(np.clip(part * TOL * bright, 1e-13, 1.0))
                image = sr.truth(scene, size=1, tol=tol, filter=kind, budget=BUDGET, threads=1)
                seconds += (time.process_time() - begun) * (part == 1.0)
                found.append((image.radiance[0, 0], float(image.layer("error")[0, 0]), image.layer("status")[0, 0]))
        except (SceneError, Unsupported):
            refused += 1
            continue
        indirect = float(image.layers["indirect"].max())
        (value, stated, status), (finer, rest, _) = found
        judged += 1
        lit += indirect > 1e-4 * bright
        met += status == 0
        signal += stated < 0.1 * indirect
        if (np.abs(value - finer) > 1.5 * (stated + rest) + 1e-14 * bright).any():
            beyond += 1
            report.say(f"seed {seed}, {kind}: beyond, {value} stated {stated:.3g}, finer {finer} stated {rest:.3g}")
        expected, sigma = paths(scene, kind, 1000 * seed)
        if (np.abs(value - expected) > 1.5 * stated + 6 * sigma + 1e-12 * bright).any():
            # few paths may have missed what is bright and small
            again = [paths(scene, kind, 1000 * seed + 100 + SEEDS * k)[0] for k in range(24)]
            expected, sigma = np.mean(again, axis=0), np.std(again, axis=0, ddof=1) / np.sqrt(24)
        if (np.abs(value - expected) > 1.5 * stated + 6 * sigma + 1e-12 * bright).any():
            apart += 1
            report.say(f"seed {seed}, {kind}: {value} stated {stated:.3g}, paths {expected} +- {sigma}")
    report.say(
        f"{judged} pixels, {refused} refused, {lit} with bounced light, {met} that meet {TOL:g} of the brightest "
        f"light, {signal} that state less than a tenth of what bounces; {seconds / max(1, judged):.3g} CPU s each"
    )
    report.claim_number("pixels beyond 1.5 times what both runs state", beyond, 0)
    report.claim_number("pixels apart from paths, share", apart / max(1, judged), 2e-3)
    report.leave()


if __name__ == "__main__":
    main()
