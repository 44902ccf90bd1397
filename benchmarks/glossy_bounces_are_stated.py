"""No bounced light between rough surfaces is beyond what it states.

    python benchmarks/glossy_bounces_are_stated.py [--quick] [SEED [COUNT]]

The crowds of ``bounced_light_is_stated.py`` with conductors of alpha .001 to 1 and phong materials among their
surfaces, what is met first as well as what it sees, and rays that graze; some lamps are spots. The judge is
``tests/radiometric/rough_lattice.py``: lattices of directions towards highlights and the places under lamps, with
formulas of its own, of more and more points until their standard error is less than half of what is stated and a tenth
of the light, or there are no more: then they tell nothing. What looks beyond is judged by the most points.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from bounced_light_is_stated import SURE, TOLERANCES, Judged, Scene, answered, count_and_tell, drawn

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

BUDGET = 500_000
SEEN = 0.1
"""Share of the light that the judge's standard error may be: of what few directions meet it knows neither."""
LEAST = 1e-12
"""No tolerance is smaller."""
LOOKS = ((2584, 1597), (10946, 6765), (46368, 28657), (196418, 121393))
"""Points of lattices and their generators by which one look after the other judges."""


def rough(rng: np.random.Generator) -> Scene:
    """A conductor or a phong material."""
    shade: Any = rng.choice([0.0, 0.3, 1.0], 3, p=[0.2, 0.4, 0.4]).tolist() if rng.random() < 0.4 else [1.0, 1.0, 1.0]
    both = {"reflectance": shade, "two_sided": bool(rng.random() < 0.2)}
    if rng.random() < 0.25:
        return {"type": "phong", "exponent": float(10.0 ** rng.uniform(0.0, 4.0))} | both
    alpha = float(rng.choice([0.3, 0.1, 0.03, 10.0 ** rng.uniform(-3, 0)]))
    eta, k = rng.uniform(0.1, 3, 3).tolist(), rng.choice([0.0, 0.5, 3.0], 3).tolist()
    masking = str(rng.choice(["separable", "correlated"]))
    kind = str(rng.choice(["ggx", "beckmann"], p=[0.75, 0.25]))
    return {"type": "conductor", "distribution": kind, "alpha": alpha, "eta": eta, "k": k, "masking": masking} | both


def spotted(lights: list[Scene], rng: np.random.Generator) -> None:
    """Make spots of some of the points among lights."""
    for light in lights:
        if light["type"] == "point" and rng.random() < 0.4:
            axis = -np.array(light["position"]) + rng.normal(size=3)
            beam = float(rng.choice([0.0, 5.0, 30.0, 60.0]))
            cutoff = beam + float(rng.choice([1e-3, 1.0, 20.0, 60.0]))
            light |= {"type": "spot", "direction": axis.tolist(), "beam": beam, "cutoff": cutoff,
                      "falloff": str(rng.choice(["linear", "smooth"]))}  # fmt: skip


def crowd(seed: int) -> tuple[Scene, np.ndarray, np.ndarray]:
    """A scene, and the origin and direction of a ray towards one of its shapes."""
    rng = np.random.default_rng(seed)
    scene, origin, direction = drawn(rng)
    for name, material in scene["materials"].items():
        if rng.random() < 0.6:
            made = rough(rng)
            on_plane = any(s["type"] == "plane" and s["material"] == name for s in scene["shapes"])
            if isinstance(material["reflectance"], dict) and not on_plane:
                made["reflectance"] = material["reflectance"]
            scene["materials"][name] = made
    spotted(scene["lights"], rng)
    if rng.random() < 0.2:
        # seen from almost nowhere above what it meets
        direction[2] *= 1e-3
    return scene, origin, direction


def judged(seeds: range) -> list[Judged]:
    """Rays of these seeds."""
    from tests.radiometric import rough_lattice

    found = []
    for seed in seeds:
        rng = np.random.default_rng([seed, 1])
        scene, origin, direction = crowd(seed)
        judge = rough_lattice.world(scene)
        known = rough_lattice.bounced(judge, origin, direction, rng)
        light = float(known.indirect.max())
        if light == 0.0:
            found.append(Judged(seed, "dark", 0.0, 0.0, 0.0, False, 0))
            if rng.random() < 0.8:
                continue
        tol = max(LEAST, float(rng.choice(TOLERANCES)) * (light or 1e-3))
        seen = answered(seed, scene, (origin, direction), known.shape, light, tol, BUDGET)
        if isinstance(seen, Judged):
            found.append(seen)
            continue
        stated, spent = float(seen.error[0]), int(seen.evaluations[0])
        for look in (*LOOKS[1:], None):
            off = float((np.abs(seen.indirect[0] - known.indirect) - SURE * known.sigma).max())
            light = float(known.indirect.max())
            told = known.sigma.max() < min(0.5 * max(stated, tol), SEEN * light)
            if look is None or (told and off <= stated):
                break
            known = rough_lattice.bounced(judge, origin, direction, rng, *look)
        found.append(Judged(seed, "told" if told else "not told", off, stated, light, bool(seen.status[0] == 0), spent))
    return found


def main() -> None:
    claim = "One bounce of light between rough surfaces is as near as it states."
    count_and_tell("glossy_bounces_are_stated", claim, judged, BUDGET, 1)


if __name__ == "__main__":
    main()
