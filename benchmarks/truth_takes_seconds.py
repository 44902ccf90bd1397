"""An image with an error below 1e-6 in every pixel takes seconds, for which sampling would need months.

``chapter8`` and ``gloss`` on two threads (targets: 15 and 60 s at 256 x 256), every pixel's status, and the stated
errors against an image a thousand times tighter at 32 x 32. The rival is the numeric pipeline's jittered lobe at the
same size: its time and its RMSE in the gloss of pixels that have some.
"""

from __future__ import annotations

import time

import numpy as np
from measure import Report, arguments

import symrender as sr

TOL, LOBE = 1e-6, 16
TARGETS = {"chapter8": 15.0, "gloss": 60.0}


def clocks() -> np.ndarray:
    return np.array([time.perf_counter(), time.process_time()])


def main() -> None:
    quick = arguments(__doc__).quick
    size = 64 if quick else 256
    report = Report("truth_takes_seconds", f"Truth to {TOL:g} in every pixel of {size} x {size}, two threads.")
    rows = []
    for name, target in TARGETS.items():
        scene = sr.load(name)
        sr.truth(scene, size=4, tol=TOL, threads=2)
        begun = clocks()
        truth = sr.truth(scene, size=size, tol=TOL, threads=2)
        wall, cpu = clocks() - begun
        missed = int((truth.layers["status"] != 0).sum())

        def jittered(scene: sr.Scene = scene) -> np.ndarray:
            pair = sr.render(scene, size=size, lobe=LOBE, numeric="jittered", symbolic="none", threads=2)
            assert pair.numeric is not None
            return np.asarray(pair.numeric.layers["gloss"])

        jittered()
        begun = clocks()
        sampled = jittered()
        sampling = (clocks() - begun)[1]
        gloss = truth.layers["gloss"]
        lit = gloss.max(axis=-1) > 0.0
        signal = float(np.sqrt((gloss[lit] ** 2).mean()))
        rmse = float(np.sqrt(((sampled - gloss)[lit] ** 2).mean()))

        small, tight = (sr.truth(scene, size=32, tol=tol, threads=2) for tol in (TOL, 1e-3 * TOL))
        known = tight.layers["status"] == 0
        away = np.abs(small.layers["radiance"] - tight.layers["radiance"]).max(axis=-1)
        worst = float((away / np.maximum(small.layers["error"], 1e-300))[known].max())
        rows.append([name, wall, cpu, float(truth.layers["error"].max()), missed, worst, int(known.sum())])
        report.say(
            f"{name}: {int(lit.sum())} pixels with gloss, RMS {signal:.3g}, largest {gloss.max():.3g}; jittered, "
            f"{LOBE} x {LOBE} directions: {sampling:.3g} CPU s, RMSE {rmse:.3g} ({rmse / signal:.3g} of the black "
            f"image's); at half an order of convergence {TOL:g} would take it {sampling * (rmse / TOL) ** 2:.2g} s."
        )
        report.claim_number(f"pixels of {name} that miss their tolerance", missed, 0)
        report.claim_number(f"true over stated error in {name}, at worst", worst, 1)
        if not quick:
            report.claim_time(f"wall seconds of {name}", wall, 0, target)
    report.table(
        ["scene", "wall s", "CPU s", "largest stated error", "pixels missed", "worst true/stated", "of pixels"], rows
    )
    report.leave()


if __name__ == "__main__":
    main()
