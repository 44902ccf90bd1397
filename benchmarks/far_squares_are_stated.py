"""The stated error holds for spheres that see endless squares: broad lobes, far checkers, walls along their rows.

Squares that go on to the horizon cancel but for a few places, and a rule that ends before one of these cannot see it.
Points are random ones of a sphere that stands on a checkered floor beside another, under one or two lights. The
reference is the rule itself, a thousand times tighter, whose tapers end some ten times as far out; what both may miss
is left to recorded cases that lattices of half a billion directions judged (``tests/adversary/known.json``).

    python benchmarks/far_squares_are_stated.py [--quick] [SEED]
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from measure import Report

from symrender.errors import SymrenderError
from symrender.probe import probe

POINTS, QUICK, TOLERANCES, BUDGET = 4000, 200, (1e-4, 1e-5, 1e-6), 20_000_000
Scene = dict[str, Any]


def drawn(rng: np.random.Generator) -> tuple[Scene, list[float]]:
    """A scene, and the direction from the sphere's centre of a point that faces the eye."""

    def one(*options: float) -> float:
        return float(rng.choice(options))

    radius, eye = one(0.2, 0.5, 1.0), [*rng.uniform(-4.0, 4.0, 2).tolist(), float(rng.uniform(0.3, 5.0))]
    lobe = {"weight": 1.0, "exponent": one(0, 1, 4, 20, 100), "theta_max": one(0.3, 1.0, 1.3, np.pi / 2)}
    plain = {"texture": {"type": "solid"}, "color": [0.5, 0.1, 0.5]}
    lights = [
        {"name": f"L{i}", "type": "point", "color": [1.0, 1.0, 1.0],
         "position": [*rng.uniform(-5.0, 5.0, 2).tolist(), float(rng.uniform(0.5, 6.0))]}
        for i in range(int(rng.integers(1, 3)))
    ]  # fmt: skip
    beside = [*rng.uniform(-2.5, 2.5, 2).tolist(), 0.4]
    texture = {"type": "checker", "bright": [1.0, 0.8, 0.5], "dark": [0.0, 0.0, 0.0],
               "cell": one(0.05, 0.15, 0.3, 0.6, 1.0), "offset": rng.uniform(0.0, 1.0, 2).tolist()}  # fmt: skip
    scene: Scene = {
        "camera": {"type": "look_at", "eye": eye, "target": [0.0, 0.0, 0.3], "fov": 40.0},
        "spheres": [
            {"name": "A", "center": [0.0, 0.0, radius], "radius": radius, "lobe": lobe, **plain},
            {"name": "B", "center": beside, "radius": 0.4, "lobe": {**lobe, "theta_max": 1.0}, **plain},
        ],
        "lights": lights,
        "ambient": [0.0, 0.0, 0.0],
        "background": [0.0, 0.0, 0.0],
        "shading": {"model": "blinn", "ka": 0.0, "kd": 1.0, "ks": 0.0, "shininess": 10.0},
        "floor": {"texture": texture, "lobe": lobe},
    }
    n = rng.normal(size=3)
    n[2] = abs(n[2]) * one(-0.5, 0.2, 0.5)
    n /= np.linalg.norm(n)
    if (np.array(eye) - [0.0, 0.0, radius] - radius * n) @ n < 0.0:
        n[:2] *= -1.0
    return scene, n.tolist()


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--quick"]
    count, seed = QUICK if "--quick" in sys.argv else POINTS, int(words[0]) if words else 0
    report = Report("far_squares_are_stated", "No value above endless squares is 1.5 times beyond what it states.")
    rng = np.random.default_rng((seed, 15))
    judged = dict.fromkeys(TOLERANCES, 0)
    beyond, rows = dict.fromkeys(TOLERANCES, 0), []
    given = signal = 0
    worst = 0.0
    for k in range(count):
        scene, n = drawn(rng)
        try:
            tight = probe(scene, [n], surface="spheres.A", tol=1e-3 * min(TOLERANCES), budget=BUDGET, threads=1)
        except SymrenderError:
            # the point is hidden from the eye, or inside the other sphere
            continue
        given += 1
        signal += bool(tight.gloss.max() > 10.0 * max(TOLERANCES))
        for tol in TOLERANCES:
            found = probe(scene, [n], surface="spheres.A", tol=tol, budget=BUDGET, threads=1)
            stated, away = float(found.error[0]), float(np.abs(found.gloss - tight.gloss).max())
            if away > stated and tight.error[0] > 0.5 * away:
                # the reference cannot tell
                continue
            judged[tol] += 1
            ratio = max(0.0, away - float(tight.error[0])) / max(stated, 1e-300)
            if away > float(tight.error[0]) + stated:
                beyond[tol] += 1
                rows.append([k, tol, stated, away, ratio])
                worst = max(worst, ratio)
    report.say(
        f"{count} points from seed {seed}, {given} seen, {signal} brighter than ten of the loosest tolerance; a "
        "reference could tell "
        + ", ".join(f"{judged[tol]} at {tol:g}" for tol in TOLERANCES)
        + "; beyond: "
        + ", ".join(f"{beyond[tol]} at {tol:g}" for tol in TOLERANCES)
        + "."
    )
    if rows:
        report.table(["point", "tol", "stated", "true", "ratio"], rows)
    report.claim_number("points left unjudged, per point", 1.0 - sum(judged.values()) / max(1, 3 * given), 0.02)
    report.claim_number("worst true error over the stated one, of those beyond", worst, 1.5)
    report.leave()


if __name__ == "__main__":
    main()
