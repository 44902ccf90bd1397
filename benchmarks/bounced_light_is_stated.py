"""No bounced light of a radiometric scene is beyond what it states.

    python benchmarks/bounced_light_is_stated.py [--quick] [SEED [COUNT]]

Scenes are crowds of balls and planes that touch, cross and hide each other, of sizes over four orders of magnitude,
diffuse, solid or checkered, on one side or on both, with channels of nothing, under points of light near surfaces and
suns. The judge is ``tests/radiometric/lattice.py``: shifted lattices that share nothing with the package. Where a
lamp stands so near a surface that its light falls between their points they tell nothing, and their standard error
does not know that: such rays are counted, not judged. What looks beyond is judged again by sixteen times as many
shifts.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from measure import Report

if TYPE_CHECKING:
    from symrender.probe_rays import RayProbe

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

COUNT, QUICK, BATCH = 20_000, 40, 40
TOLERANCES = (1e-2, 1e-3, 1e-4)
"""Of the light that is there, as the lattices found it."""
SURE = 6.0
"""Standard errors of the judge that count for nothing."""
LOOSEST = 1.5
ENOUGH = 50.0
"""Directions of a lattice into the brightest place under a lamp from which on it tells what is there."""
BUDGET = 3_000_000
Scene = dict[str, Any]


def drawn(rng: np.random.Generator) -> tuple[Scene, np.ndarray, np.ndarray]:
    """A scene, and the origin and direction of a ray towards one of its shapes."""

    def unit() -> np.ndarray:
        v = rng.normal(size=3)
        return np.asarray(v / np.linalg.norm(v))

    def colour() -> list[float]:
        return rng.choice([0.0, 0.2, 0.5, 0.9], 3, p=[0.15, 0.25, 0.3, 0.3]).tolist()

    materials: Scene = {}
    for k in range(4):
        reflectance: Any = colour()
        if rng.random() < 0.4:
            cell = float(rng.choice([0.11, 0.25, 0.5, 1.3]))
            reflectance = {"type": "checker", "bright": colour(), "dark": colour(), "cell": cell}
        materials[f"m{k}"] = {"type": "diffuse", "reflectance": reflectance, "two_sided": bool(rng.random() < 0.3)}
    shapes: list[Scene] = []
    for k in range(int(rng.integers(0, 3))):
        tilt = unit() * float(rng.choice([0.0, 0.3]))
        normal = np.array([[0, 0, 1], [1, 0, 0], [0, -1, 0]][k]) + tilt
        point = -normal * float(rng.choice([0.0, 1.0, 2.0]))
        shapes.append({"type": "plane", "name": f"P{k}", "point": point.tolist(), "normal": normal.tolist(),
                       "along": unit().tolist(), "material": f"m{rng.integers(4)}"})  # fmt: skip
    balls: list[tuple[np.ndarray, float]] = []
    for k in range(int(rng.integers(1, 5))):
        radius = float(10.0 ** rng.uniform(-2, 0.3))
        center = rng.normal(size=3) * [1.0, 1.0, 0.6]
        how = rng.choice(["free", "floor", "buried", "touch", "nested"])
        if how == "floor":
            center[2] = radius
        elif how == "buried":
            center[2] = radius * rng.uniform(-0.9, 0.9)
        elif how in ("touch", "nested") and balls:
            other, size = balls[int(rng.integers(len(balls)))]
            center = other + unit() * (size + radius if how == "touch" else abs(size - radius) * rng.uniform(0, 1))
        balls.append((center, radius))
        shapes.append({"type": "sphere", "name": f"S{k}", "center": center.tolist(), "radius": radius,
                       "material": f"m{rng.integers(4)}"})  # fmt: skip
    lights: list[Scene] = []
    for k in range(int(rng.integers(1, 4))):
        if rng.random() < 0.3:
            lights.append({"type": "directional", "name": f"L{k}", "direction": (unit() - [0, 0, 1.0]).tolist(),
                           "irradiance": colour()})  # fmt: skip
            continue
        place = rng.normal(size=3) * 2.0 + [0, 0, 1.0]
        if rng.random() < 0.3:
            center, radius = balls[int(rng.integers(len(balls)))]
            place = center + unit() * radius * (1.0 + float(rng.choice([-0.3, 0.05, 0.3, 1.0])))
        lights.append({"type": "point", "name": f"L{k}", "position": place.tolist(),
                       "intensity": [3.0 * c for c in colour()]})  # fmt: skip
    center, radius = balls[int(rng.integers(len(balls)))]
    aim = center + unit() * radius * rng.uniform(0, 1) if rng.random() < 0.6 else rng.normal(size=3) * [1.5, 1.5, 0.1]
    origin = aim + unit() * float(10.0 ** rng.uniform(-0.5, 1.0))
    scene = {
        "units": "radiometric", "name": "crowd", "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
        "materials": materials, "shapes": shapes, "lights": lights,
    }  # fmt: skip
    return scene, origin, aim - origin


class Judged(NamedTuple):
    """Of one ray: what came of it, how far off it is beyond the judge's doubt, what is stated, its light, the cost."""

    seed: int
    verdict: str
    off: float
    stated: float
    light: float
    met: bool
    evaluations: int


def answered(
    seed: int, scene: Scene, ray: tuple[np.ndarray, np.ndarray], shape: int, light: float, tol: float, budget: int
) -> RayProbe | Judged:
    """What ``probe`` says of a ray that the judge saw meet ``shape``; or why there is no value to be judged."""
    import symrender as sr
    from symrender.errors import SymrenderError

    try:
        seen = sr.probe(scene, rays=ray, tol=tol, budget=budget)
    except SymrenderError as reason:
        return Judged(seed, f"refused: {str(reason)[:60]}", 0.0, 0.0, light, False, 0)
    if seen.shape[0] != (f"shapes.{scene['shapes'][shape]['name']}" if shape >= 0 else "nothing"):
        return Judged(seed, "another shape", 0.0, 0.0, light, False, 0)
    if not np.isfinite(seen.error[0]):
        return Judged(seed, "unsupported", 0.0, float(seen.error[0]), light, False, int(seen.evaluations[0]))
    return seen


def judged(seeds: range) -> list[Judged]:
    """Rays of these seeds."""
    from tests.radiometric import lattice

    found = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        scene, origin, direction = drawn(rng)
        judge = lattice.world(scene)
        known = lattice.bounced(judge, origin, direction, rng)
        light = float(known.indirect.max())
        if light == 0.0:
            found.append(Judged(seed, "dark", 0.0, 0.0, 0.0, False, 0))
            if rng.random() < 0.8:
                continue
        tol = float(rng.choice(TOLERANCES)) * (light or 1e-3)
        seen = answered(seed, scene, (origin, direction), known.shape, light, tol, BUDGET)
        if isinstance(seen, Judged):
            found.append(seen)
            continue
        stated, spent = float(seen.error[0]), int(seen.evaluations[0])
        off = float((np.abs(seen.indirect[0] - known.indirect) - SURE * known.sigma).max())
        if off > stated:
            again = [lattice.bounced(judge, origin, direction, rng) for _ in range(16)]
            mean = np.mean([x.indirect for x in again], axis=0)
            sigma = np.std([x.indirect for x in again], axis=0, ddof=1) / 4.0
            off = float((np.abs(seen.indirect[0] - mean) - SURE * sigma).max())
        told = known.sigma.max() < 0.5 * max(stated, tol) and known.glare >= ENOUGH
        found.append(Judged(seed, "told" if told else "not told", off, stated, light, bool(seen.status[0] == 0), spent))
    return found


def count_and_tell(name: str, claim: str, judge: Callable[[range], list[Judged]], budget: int, workers: int) -> None:
    """Judge the rays that the command line names, and print what came of them."""
    quick = "--quick" in sys.argv
    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), (seeds[1] if len(seeds) > 1 else QUICK if quick else COUNT)
    report = Report(name, claim)
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(judge, range(s, min(s + BATCH, first + count))) for s in range(first, first + count, BATCH)]
        found = [x for job in jobs for x in job.result()]
    refused = [x for x in found if x.verdict.startswith("refused")]
    values = [x for x in found if x.verdict in ("told", "not told")]
    told = [x for x in values if x.verdict == "told"]
    met = [x for x in told if x.met]
    beyond = sorted((x for x in told if x.off > x.stated), key=lambda x: -x.off / max(x.stated, 1e-300))
    others = {kind: sum(x.verdict == kind for x in found) for kind in ("another shape", "unsupported")}
    most = max((x.evaluations for x in values), default=0)
    report.say(
        f"{count} rays from seed {first}: {sum(x.verdict == 'dark' for x in found)} without bounced light, "
        f"{len(refused)} refused, {others['unsupported']} unsupported, {others['another shape']} where rounding has "
        f"the ray meet another shape; {len(values)} values, {sum(x.met for x in values)} met, "
        f"{sum(x.light > 0.0 for x in values)} where the lattices found light; of {len(told)} the "
        f"lattices tell, with a standard error below half the tolerance, {len(met)} of these met; beyond what is "
        f"stated: {len(beyond)}. Evaluations: {sum(x.evaluations for x in values)}, at most {most} of one."
    )
    report.table(
        ["seed", "off", "stated", "light", "met"], [[x.seed, x.off, x.stated, x.light, str(x.met)] for x in beyond[:8]]
    )
    for x in refused[:4]:
        report.say(f"- seed {x.seed}: {x.verdict}")
    report.claim_number("refused", len(refused), 0)
    report.claim_number(f"values more than {LOOSEST:g} times beyond", sum(x.off > LOOSEST * x.stated for x in told), 0)
    report.claim_number("most evaluations over the budget", most / budget, 2.0)
    report.leave()


def main() -> None:
    count_and_tell("bounced_light_is_stated", "One bounce of light is as near as it states.", judged, BUDGET, 2)


if __name__ == "__main__":
    main()
