"""No derivative of a mean over a pixel of bounced light is beyond 1.5 times what it states.

    python benchmarks/swept_pixels_are_stated.py [--quick] [SEED [COUNT]]

The hostile pixels of ``pixels_are_stated.py`` with ``bounces: 1``, under every filter, by a place or a radius of a
shape, a lamp's place or the eye's. Each is judged by extrapolated differences of the means themselves; where a second
step tells of something that a wall enters within the step, they are no judge, and that is counted.
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
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays

PIXELS, QUICK = 1_000, 12
TOL = 3e-2
"""Over the brightest light of a scene and the size of what moves."""
STEP = 2e-3
"""Over the size of what moves."""
FILTERS = ("box", "box", "tent", "gaussian", "mitchell")
BUDGET = 300_000


def moved(scene: Any, rng: np.random.Generator) -> tuple[str, float]:
    """(name of a number of the scene, the size of what it moves)."""
    balls = [shape for shape in scene.shapes if shape.type == "sphere"]
    ball = balls[rng.integers(len(balls))]
    names = [f"shapes.{ball.name}.{what}" for what in ("radius", "center.x", "center.z")]
    names += [f"camera.eye.{axis}" for axis in "xyz"]
    if scene.lights[0].type == "point":
        names.append("lights.P.position.x")
    return names[rng.integers(len(names))], float(ball.radius)


def differences(scene: Any, name: str, kind: str, step: float, tol: float) -> tuple[Any, float, bool]:
    """(derivative of the indirect light of the one pixel, what it may be off by, whether it is known)."""
    value, found, stated = float(get(scene, name)), [], []
    for each in (step, 2 * step):
        pair = [
            sr.truth(
                scene.replace({name: value + side * each}), size=1, tol=tol, filter=kind, budget=BUDGET, threads=1,
                tile=1,
            )
            for side in (1, -1)
        ]  # fmt: skip
        found.append((pair[0].layer("indirect") - pair[1].layer("indirect"))[0, 0] / (2 * each))
        stated.append(float(sum(image.layer("error")[0, 0] for image in pair)) / (2 * each))
    near, far = found
    bent = float(np.abs(near - far).max())
    known = bent <= 0.05 * float(np.abs(near).max()) + sum(stated)
    return (4 * near - far) / 3, (4 * stated[0] + stated[1]) / 3 + 0.5 * bent, known


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("swept_pixels_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else PIXELS)
    refused = met = judged = told = beyond = unknown = 0
    seconds = 0.0
    for seed in range(first, first + count):
        rng, kind = np.random.default_rng([seed, 7]), FILTERS[seed // 4 % len(FILTERS)]
        try:
            scene = hostile(seed).replace({"bounces": 1})
            name, size = moved(scene, rng)
            bright = brightest(seen(radiometric_arrays(scene), 1, 1))
            begun = time.process_time()
            tol = float(np.clip(TOL * bright / size, 1e-13, 1.0))
            image = sr.gradient(scene, [name], size=1, tol=tol, filter=kind, budget=BUDGET, threads=1, tile=1)[name]
            seconds += time.process_time() - begun
            value, stated = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
            met += not image.layer("status").any()
            if not np.isfinite(stated):
                unknown += 1
                continue
            finest = float(np.clip(1e-5 * bright, 1e-13, 1.0))
            expected, doubt, known = differences(scene, name, kind, STEP * size, finest)
        except (SceneError, Unsupported):
            refused += 1
            continue
        if not known:
            unknown += 1
            continue
        judged += 1
        most = float(np.abs(expected).max())
        told += doubt + stated < 0.1 * most
        if np.abs(value - expected).max() > 1.5 * stated + doubt + 1e-12 * bright / size:
            beyond += 1
            report.say(
                f"seed {seed}, {kind}, {name}: {value} stated {stated:.3g}, differences {expected} +- {doubt:.3g}"
            )
    report.say(
        f"{judged} derivatives judged, {refused} refused, {unknown} of which differences or the rule say nothing, "
        f"{met} that meet {TOL:g} of the brightest light over the size, {told} told to a tenth of themselves; "
        f"{seconds / max(1, judged + unknown):.3g} CPU s each"
    )
    report.claim_number("derivatives beyond 1.5 times what they state", beyond, 0)
    report.leave()


if __name__ == "__main__":
    main()
