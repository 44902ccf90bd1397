"""No bounced light of skies, lamps and spots is beyond what it states.

    python benchmarks/skies_and_lamps_bounce_as_stated.py [--quick] [SEED [COUNT]]

The crowds of ``bounced_light_is_stated.py`` with planes of one colour, under a sky, or a ball that emits and crosses
nothing, or both, beside the lamps that are there, some of them spots. Seeds from 1,000,000 on keep the checkers of
planes, make stripes of some textures, and let some surfaces be rough where they are met first. The judge,
``tests/radiometric/seen_lattice.py``, has lattices of rays that are answered with direct light in closed form, of more
and more points until their error is less than half of what is stated, or there are no more: then they tell nothing.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from bounced_light_is_stated import SURE, TOLERANCES, Judged, Scene, answered, count_and_tell, drawn
from glossy_bounces_are_stated import LEAST, rough, spotted

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

BUDGET = 1_000_000
TEXTURED = 1_000_000
"""First seed of scenes with textures on planes and rough surfaces."""
LOOKS = ((2584, 1597), (10946, 6765), (46368, 28657))
"""Points of lattices and their generators by which one look after the other judges."""


def dress(scene: Scene, rng: np.random.Generator) -> None:
    """Make stripes of some textures, and rough of some materials, which reflect at the first hit alone."""
    scene["gloss"] = "first_hit"
    for name, material in scene["materials"].items():
        reflectance = material["reflectance"]
        if isinstance(reflectance, dict) and rng.random() < 0.4:
            reflectance["type"] = "stripes"
        if rng.random() < 0.3:
            scene["materials"][name] = rough(rng) | {"reflectance": reflectance}


def crowd(seed: int) -> tuple[Scene, np.ndarray, np.ndarray]:
    """A scene, and the origin and direction of a ray towards one of its shapes."""
    from symrender.radiometric.crossed import crossed
    from symrender.scene.load import load_any
    from symrender.scene.radiometric.arrays import radiometric_arrays

    rng = np.random.default_rng([seed, 2])
    scene, origin, direction = drawn(rng)
    flat = {shape["material"] for shape in scene["shapes"] if shape["type"] == "plane"}
    if seed >= TEXTURED:
        flat = set()
        dress(scene, np.random.default_rng([seed, 3]))
    for name in flat:
        if isinstance(scene["materials"][name]["reflectance"], dict):
            scene["materials"][name]["reflectance"] = scene["materials"][name]["reflectance"]["bright"]
    lights = [light for light in scene["lights"] if rng.random() < 0.4]
    spotted(lights, rng)
    kind = str(rng.choice(["sky", "lamp", "both"]))
    if kind != "sky":
        made = load_any(scene | {"bounces": 0})
        apart = [j for j, shape in enumerate(scene["shapes"])
                 if shape["type"] == "sphere" and crossed(radiometric_arrays(made), j) < 0]  # fmt: skip
        if apart:
            name = scene["shapes"][int(rng.choice(apart))]["name"]
            radiance = rng.uniform(0, 5, 3) * rng.choice([0, 1], 3, p=[0.2, 0.8])
            lights.append({"type": "area", "name": "lamp", "shape": name, "radiance": radiance.tolist()})
        else:
            kind = "sky"
    if kind != "lamp":
        lights.append({"type": "sky", "name": "sky", "radiance": rng.choice([0.0, 0.3, 1.0], 3).tolist()})
    return scene | {"lights": lights}, origin, direction


def judged(seeds: range) -> list[Judged]:
    """Rays of these seeds."""
    from tests.radiometric import seen_lattice

    found = []
    for seed in seeds:
        rng = np.random.default_rng([seed, 1])
        scene, origin, direction = crowd(seed)
        known = seen_lattice.bounced(scene, origin, direction, rng, *LOOKS[0])
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
            told = known.sigma.max() < 0.5 * max(stated, tol)
            if look is None or (told and off <= stated):
                break
            known = seen_lattice.bounced(scene, origin, direction, rng, *look)
        found.append(Judged(seed, "told" if told else "not told", off, stated, light, bool(seen.status[0] == 0), spent))
    return found


def main() -> None:
    claim = "One bounce of the light of skies, lamps and spots is as near as it states."
    count_and_tell("skies_and_lamps_bounce_as_stated", claim, judged, BUDGET, 1)


if __name__ == "__main__":
    main()
