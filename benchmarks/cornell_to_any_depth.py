"""The Cornell box with all bounces takes minutes, and is what paths find.

    python benchmarks/cornell_to_any_depth.py [--quick]

The gallery's ``cornell`` at 256 x 256: one bounce to 1e-4 and all bounces to 1e-3, absolute, of radiances whose root
mean square is about .9. CPU time is that of all threads, compilation left out. The path tracer of the numeric pipeline
draws the same pixels at 24 x 24; its standard error is that of eight seeds, and what is compared is the mean of the
reflected light over each shape.
"""

from __future__ import annotations

import math

import numpy as np
from measure import Report, arguments, cpu_seconds

import symrender as sr
from symrender.images.image import Image
from symrender.scene.load import AnyScene

GOALS: tuple[tuple[int | str, float, float], ...] = ((1, 1e-4, 360.0), ("all", 1e-3, 1200.0))
"""Bounces, tolerance, CPU seconds: three and ten minutes on two cores."""
QUICK: tuple[tuple[int | str, float, float], ...] = ((1, 2e-3, 60.0), ("all", 2e-2, 60.0))
SEEDS = 8
SURE = 5.0


class Drawn:
    """An image that is made when it is asked for."""

    def __init__(self, scene: AnyScene, size: int, tol: float) -> None:
        self.scene, self.size, self.tol = scene, size, tol
        self.image: Image | None = None

    def draw(self) -> None:
        """Make it."""
        self.image = sr.truth(self.scene, size=self.size, tol=self.tol)

    def layer(self, name: str) -> np.ndarray:
        """A layer of it."""
        assert self.image is not None
        return self.image.layer(name)


def main() -> None:
    given = arguments(__doc__)
    report = Report("cornell_to_any_depth", "The Cornell box with all bounces takes minutes, and is what paths find.")
    rows = []
    for bounces, tol, goal in QUICK if given.quick else GOALS:
        scene = sr.load("cornell").replace({"bounces": bounces})
        # kernels are compiled before the clock runs, and a table of another tolerance is of no use
        sr.truth(scene, size=8, tol=30 * tol)
        image = Drawn(scene, 32 if given.quick else 256, tol)
        seconds = cpu_seconds(image.draw)
        status, error = image.layer("status"), image.layer("error")
        rows.append((bounces, tol, seconds, float((status == 0).mean()), float(np.median(error)), float(error.max())))
        report.claim_time(f"CPU seconds of bounces {bounces} to {tol:g}", seconds, 0, goal)
        report.claim_number("share of pixels above their tolerance", float((status != 0).mean()), 0.02)
        paths(report, scene, tol)
    report.table(("bounces", "tolerance", "CPU s", "met", "median error", "largest"), rows)
    report.leave()


def paths(report: Report, scene: AnyScene, tol: float) -> None:
    """Hold the means over shapes against the path tracer."""
    true = sr.truth(scene, size=24, tol=tol)
    runs = [sr.render(scene, size=24, lobe=20, seed=seed, symbolic="none").numeric for seed in range(SEEDS)]
    drawn = np.array([run.layer("indirect") for run in runs if run is not None])
    worst, shapes = 0.0, 0
    for shape in np.unique(true.layer("hit_class")):
        where = true.layer("hit_class") == shape
        if shape == 0 or true.layer("indirect")[where].max() == 0.0:
            continue
        means = drawn[:, where].mean(axis=1)
        wide = means.std(axis=0, ddof=1) / math.sqrt(SEEDS)
        stated = true.layer("error")[where].mean()
        off = np.abs(means.mean(axis=0) - true.layer("indirect")[where].mean(axis=0))
        worst, shapes = max(worst, float((off / (wide + stated / SURE)).max())), shapes + 1
    report.say(f"Reflected light of {shapes} shapes, {SEEDS} seeds of 400 paths a pixel.")
    report.claim_number("largest difference in standard errors, less what is stated", worst, SURE)


if __name__ == "__main__":
    main()
