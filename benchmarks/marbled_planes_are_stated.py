"""Light that bounces off marbled planes is as near as it states.

    python benchmarks/marbled_planes_are_stated.py [--quick] [SEED [COUNT]]

The hostile balls and planes of ``tolerances_agree.py``, all of them diffuse, the planes with marble of cells from a
twentieth to five of the scene's units, some seen from behind; points, spots and suns. Of a scene two
places are asked, at three tolerances each. The judge halves rules over single rays of direct light until they agree,
which knows neither waves nor walls (``tests/radiometric/seen_nested.py``).
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from measure import Report
from tolerances_agree import points_of, ray_to, shapes_of

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

Scene = dict[str, Any]
COUNT, QUICK, PLACES = 200, 3, 2
TOLERANCES = (1e-2, 1e-4, 1e-6)
"""Of the light that arrives, as a first look finds it."""
BUDGET = 400_000
CLOSER = 0.02
"""Share of the least error stated that the judge asks of every piece of its own."""
TOLD = 0.25
"""Share of what is stated that the judge may be off and tell."""
LOOSEST = 1.5
CLOSE = 0.1
"""Lights are no nearer to shapes: what a spot lights of one from close by may lie between all rays of the judge."""


class Value(NamedTuple):
    """A value that was judged: how far off it is beside what is stated; the light there, and what the judge misses."""

    seed: int
    place: int
    tol: float
    off: float
    stated: float
    light: float
    doubt: float
    met: bool


def nearest(place: np.ndarray, shapes: list[Scene]) -> float:
    """Distance to the nearest shape."""
    apart = [abs(np.linalg.norm(place - shape["center"]) - shape["radius"]) for shape in shapes if "center" in shape]
    flat = [shape for shape in shapes if "normal" in shape]
    apart += [abs((place - shape["point"]) @ shape["normal"]) / np.linalg.norm(shape["normal"]) for shape in flat]
    return float(min(apart))


def drawn(seed: int) -> tuple[Scene, list[tuple[np.ndarray, np.ndarray]]]:
    """A scene with a marbled plane at least, and rays to its shapes."""
    rng = np.random.default_rng([seed, 41])
    names = ["chalk", "vein0", "vein1"]
    shapes: list[Scene] = []
    while not any(shape["type"] == "plane" for shape in shapes):
        shapes = shapes_of(rng, names, 1.0)
    for shape in shapes:
        shape["material"] = str(rng.choice(names[1:] if shape["type"] == "plane" else names))
    materials: Scene = {"chalk": {"type": "diffuse", "reflectance": 0.8, "two_sided": bool(rng.random() < 0.3)}}
    for name in names[1:]:
        bright, dark = (rng.choice([0.0, 0.3, 1.0], 3, p=[0.15, 0.35, 0.5]).tolist() for _ in range(2))
        cell = float(10.0 ** rng.uniform(-1.3, 0.7))
        marble = {"type": "marble", "bright": bright, "dark": dark, "cell": cell}
        materials[name] = {"type": "diffuse", "reflectance": marble, "two_sided": bool(rng.random() < 0.5)}
    lights = points_of(rng, shapes)
    while any("position" in light and nearest(np.array(light["position"]), shapes) < CLOSE for light in lights):
        lights = points_of(rng, shapes)
    scene = {
        "units": "radiometric",
        "name": f"veins {seed}",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -9, 1], "target": [0, 0, 0]},
        "materials": materials,
        "shapes": shapes,
        "lights": lights,
    }
    return scene, [ray_to(rng, shapes) for _ in range(PLACES)]


def judged(seed: int, refused: list[str]) -> list[Value]:
    """All values of a scene of which the judge tells."""
    from tests.radiometric.seen_nested import gathered

    import symrender as sr
    from symrender.errors import SymrenderError
    from symrender.radiometric.world import make_world
    from symrender.runtimes.bounce import hits
    from symrender.scene.load import load_any
    from symrender.scene.radiometric.arrays import radiometric_arrays

    scene, rays = drawn(seed)
    found: list[Value] = []
    try:
        made = load_any(scene)
    except SymrenderError as reason:
        refused.append(str(reason)[:70])
        return found
    for place, (origin, direction) in enumerate(rays):
        ray = (origin[None], direction[None])
        hit = hits(make_world(radiometric_arrays(made)), *ray)
        try:
            first = sr.probe(made, rays=ray, tol=1e-3, budget=BUDGET)
            light = float(first.indirect.max())
            if hit.shape[0] < 0 or light == 0.0 or not np.isfinite(first.error[0]):
                continue
            answers = [sr.probe(made, rays=ray, tol=tol * light, budget=BUDGET) for tol in TOLERANCES]
        except SymrenderError as reason:
            refused.append(str(reason)[:70])
            continue
        most = float(hit.albedo[0].max())
        least = min(float(answer.error[0]) for answer in answers)
        normal = hit.normal[0] * (1.0 if hit.normal[0] @ direction < 0.0 else -1.0)
        known = gathered(scene, hit.place[0], normal, CLOSER * max(least, 1e-9 * light) / most)
        truth, doubt = hit.albedo[0] * known.light, most * known.error
        for tol, answer in zip(TOLERANCES, answers, strict=True):
            stated = float(answer.error[0])
            if doubt <= TOLD * stated:
                off = float(np.abs(answer.indirect[0] - truth).max()) - doubt
                met = bool(answer.status[0] == 0)
                found.append(Value(seed, place, tol, off, stated, light, doubt, met))
    return found


def main() -> None:
    words = sys.argv[1:]
    seeds = [int(word) for word in words if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), (seeds[1] if len(seeds) > 1 else QUICK if "--quick" in words else COUNT)
    report = Report("marbled_planes_are_stated", "Light that bounces off marbled planes is as near as it states.")
    values: list[Value] = []
    refused: list[str] = []
    for seed in range(first, first + count):
        more = judged(seed, refused)
        for value in more:
            if value.off > value.stated:
                print("beyond", *value, flush=True)
        values += more
    beyond = [value for value in values if value.off > value.stated]
    met = [value for value in values if value.met]
    share = sorted(max(0.0, value.off) / value.stated for value in values)
    report.say(
        f"{count} scenes from seed {first}, {len(refused)} places or scenes refused; of {len(values)} values the judge "
        f"tells, {len(met)} of these met; errors are {np.median(share) if share else 0.0:.1e} of what is stated in the "
        f"median, {share[-1] if share else 0.0:.2f} at most; beyond: {len(beyond)}."
    )
    report.table(
        ["seed", "place", "tol", "off", "stated", "light", "judge", "met"], [list(each) for each in beyond[:20]]
    )
    for reason in sorted(set(refused)):
        report.say(f"- refused, {refused.count(reason)}: {reason}")
    report.claim_number(
        f"values more than {LOOSEST:g} times beyond", sum(each.off > LOOSEST * each.stated for each in beyond), 0
    )
    report.leave()


if __name__ == "__main__":
    main()
