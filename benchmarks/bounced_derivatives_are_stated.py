"""No derivative of bounced light is beyond what it states.

    python benchmarks/bounced_derivatives_are_stated.py [--quick] [SEED [COUNT]]

The crowds of ``bounced_light_is_stated.py``, half of them with the conductors and phong materials of
``glossy_bounces_are_stated.py``, at sizes from 1e-4 to 1e3, with planes that lie on each other's checkers and balls
that touch; of each one pixel, and of it the derivatives in six of the scene's numbers, chosen at random. The judge is
differences of ``truth`` at a part in 1e11 of the light, extrapolated, from steps of up to four sizes; it tells where
two steps agree.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from bounced_light_is_stated import Scene, drawn
from glossy_bounces_are_stated import crowd
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

COUNT, QUICK, BATCH = 1_000, 6, 5
EACH = 6
"""Parameters of a scene."""
TOLERANCES = (1e-3, 1e-5, 1e-7)
"""Of the largest derivative, roughly: of the light over the parameter's size."""
STEPS = (1e-1, 1e-2, 1e-3, 1e-4)
"""Of a tenth of what a number is measured by."""
JUDGED = 1e-11
"""Tolerance of the values that are judged by, of the light."""
TRUST = 0.1
"""Share of what those values state that is taken to differ between two of them."""
ZERO = 1e-8
"""Slope, of the light over what a number is measured by, that the judge need not tell from none."""
DIM = 1e-7
"""Light that is taken for none."""
DRAWS = 10
"""Scenes drawn for one that is lit."""
LOOSEST = 1.5
BUDGET = 2_000_000


def resize(scene: Scene, size: float, on_planes: set[str]) -> None:
    """Bring shapes, lights and the fields of these materials to another size; fields of spheres are angles."""
    for shape in scene["shapes"]:
        for key in ("point", "center"):
            if key in shape:
                shape[key] = (size * np.array(shape[key])).tolist()
        if "radius" in shape:
            shape["radius"] *= size
    for light in scene["lights"]:
        if "position" in light:
            light["position"] = (size * np.array(light["position"])).tolist()
            light["intensity"] = (size * size * np.array(light["intensity"])).tolist()
    for name in on_planes:
        reflectance = scene["materials"][name]["reflectance"]
        if isinstance(reflectance, dict):
            reflectance["cell"] *= size


def scaled(scene: Scene, origin: np.ndarray, direction: np.ndarray, size: float) -> Scene:
    """The scene at another size, seen along a ray."""
    on_planes = {s["material"] for s in scene["shapes"] if s["type"] == "plane"}
    on_spheres = {s["material"] for s in scene["shapes"] if s["type"] == "sphere"}
    resize(scene, size, on_planes - on_spheres)
    up = [0.0, 0.0, 1.0] if abs(direction[2]) < 0.9 * np.linalg.norm(direction) else [0.0, 1.0, 0.0]
    target = origin + direction / np.linalg.norm(direction)
    scene["camera"] = {"type": "look_at", "eye": (size * origin).tolist(), "target": (size * target).tolist(),
                       "up": up, "fov": 40.0}  # fmt: skip
    return scene


def scene_of(seed: int) -> Scene:
    """The scene of a seed."""
    rng = np.random.default_rng([seed, 7])
    scene, origin, direction = crowd(seed) if rng.random() < 0.5 else drawn(np.random.default_rng(seed))
    planes = [shape for shape in scene["shapes"] if shape["type"] == "plane"]
    if len(planes) > 1 and rng.random() < 0.3:
        # a wall on a line of the floor's checker, as rooms have it
        planes[0].update(normal=[0, 0, 1], along=[1, 0, 0], point=[0, 0, 0])
        planes[1].update(normal=[1, 0, 0], along=[0, 1, 0], point=[-1.0, 0, 0])
    return scaled(scene, origin, direction, float(rng.choice([1.0, 1.0, 1e-4, 1e-2, 1e3])))


def lit(seed: int, tol: float, budget: int) -> tuple[Scene, float]:
    """The first scene of a seed that sends light where the pixel looks, so that it is 1 there, and what it was.

    Raises ``SymrenderError`` for a scene that is refused.
    """
    import symrender as sr

    data, light = {}, 0.0
    for drawn_ in range(DRAWS):
        # most scenes of a crowd send nothing where the pixel looks
        data = scene_of(DRAWS * seed + drawn_)
        if any(lamp["type"] not in ("point", "directional") for lamp in data["lights"]):
            continue
        seen = sr.truth(data, size=1, tol=tol, threads=1, tile=1, budget=budget)
        light = float(seen.layer("indirect").max())
        if light > DIM:
            break
    if light > DIM:
        # tolerances of a part in 1e12 have room in numbers of order one only
        for lamp in data["lights"]:
            for key in {"intensity", "irradiance"} & lamp.keys():
                lamp[key] = (np.array(lamp[key]) / light).tolist()
    return data, light


class Judged(NamedTuple):
    """Of one derivative: what came of it, how far off it is beyond the judge's doubt, what is stated, its size."""

    seed: int
    name: str
    verdict: str
    off: float
    stated: float
    size: float
    relative: float
    status: int


def acts(name: str) -> bool:
    """Whether a number has a say without a shutter."""
    return "velocity" not in name and not name.startswith("shutter")


def judged(seeds: range) -> list[Judged]:
    """Derivatives of these seeds."""
    import symrender as sr
    from symrender.errors import SymrenderError
    from symrender.scene.load import load_any
    from symrender.scene.parameters import parameters

    found = []
    for seed in seeds:
        rng, light = np.random.default_rng([seed, 11]), 0.0
        try:
            data, light = lit(seed, 1e-6, BUDGET)
            scene = load_any(data)
            here = sr.truth(scene, size=1, tol=1e-6, threads=1, tile=1, budget=BUDGET)
        except SymrenderError as reason:
            found.append(Judged(seed, "", f"refused: {str(reason)[:60]}", 0.0, 0.0, 0.0, 0.0, 0))
            continue
        light = float(here.layer("indirect").max())
        if not (light > 1e-3 and np.isfinite(here.layer("error")[0, 0])):
            found.append(Judged(seed, "", "dark", 0.0, 0.0, 0.0, 0.0, 0))
            continue
        extent = float(max(np.abs(scene.camera.eye).max(), 1e-4))
        free = [each for each in parameters(scene) if each.low <= each.value < each.high and acts(each.name)]
        for each in rng.permutation(np.array(free, dtype=object))[:EACH]:
            length = each.unit == "length"
            unit = max(abs(each.value), extent if length and "direction" not in each.name else 1.0)
            unit = abs(each.value) if each.name.endswith(("radius", "alpha", "cell", "exponent")) else unit
            tol = min(1.0, float(rng.choice(TOLERANCES)) * light / unit)
            found.append(one(scene, seed, each.name, each.value, 0.1 * unit, light, tol))
    return found


def one(scene: Any, seed: int, name: str, value: float, unit: float, light: float, tol: float) -> Judged:
    """One derivative."""
    import symrender as sr
    from symrender.errors import SymrenderError

    try:
        image = sr.gradient(scene, [name], size=1, tol=tol, threads=1, tile=1, budget=BUDGET)[name]
    except SymrenderError as reason:
        return Judged(seed, name, f"refused: {str(reason)[:60]}", 0.0, 0.0, 0.0, 0.0, 0)
    slope, stated = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
    status = int(image.layer("status")[0, 0])
    if not np.isfinite(stated):
        return Judged(seed, name, "unsupported", 0.0, stated, 0.0, 0.0, status)

    def values(step: float) -> tuple[np.ndarray, float]:
        seen = sr.truth(
            scene.replace({name: value + step}), size=1, tol=JUDGED * light, threads=1, tile=1, budget=BUDGET
        )
        return seen.layer("indirect")[0, 0], float(seen.layer("error")[0, 0])

    best, doubt, before = np.zeros(3), np.inf, None
    try:
        middle = values(0.0)
        for share in STEPS:
            h = share * unit
            (a, b), (c, d) = ((values(step), values(-step)) for step in (h, 0.5 * h))
            twice = (8.0 * (c[0] - d[0]) - (a[0] - b[0])) / (6.0 * h)
            stated_there = max(each[1] for each in (a, b, c, d))
            # a kink has central differences that agree, and second differences that fall no faster than the step
            bent = [float(np.abs(x[0] + y[0] - 2.0 * middle[0]).max()) for x, y in ((a, b), (c, d))]
            unsure = TRUST * stated_there / h + (2.0 * bent[1] / h if bent[1] > 0.4 * bent[0] else 0.0)
            if before is not None:
                apart = float(np.abs(twice - before).max()) + unsure
                if apart < doubt:
                    best, doubt = twice, apart
                if doubt < max(0.1 * stated, 1e-10 * float(np.abs(best).max())):
                    break
            before = twice
    except SymrenderError as reason:
        return Judged(seed, name, f"no room: {str(reason)[:60]}", 0.0, stated, 0.0, 0.0, status)
    size = float(max(np.abs(best).max(), np.abs(slope).max()))
    off = float(np.abs(slope - best).max())
    told = doubt < max(0.3 * stated, 1e-9 * size, ZERO * light / unit if not slope.any() else 0.0)
    verdict = "one-sided" if status == 4 else "told" if told else "not told"
    return Judged(seed, name, verdict, off - doubt, stated, size, off / max(size, 1e-300), status)


def main() -> None:
    quick = "--quick" in sys.argv
    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), (seeds[1] if len(seeds) > 1 else QUICK if quick else COUNT)
    report = Report("bounced_derivatives_are_stated", "A derivative of bounced light is as near as it states.")
    with ProcessPoolExecutor(1) as pool:
        jobs = [
            pool.submit(judged, range(s, min(s + BATCH, first + count))) for s in range(first, first + count, BATCH)
        ]
        found = [x for job in jobs for x in job.result()]
    told = [x for x in found if x.verdict == "told"]
    met = [x for x in told if x.status == 0]
    acting = [x for x in told if x.size > 0.0]
    beyond = sorted((x for x in told if x.off > x.stated), key=lambda x: -x.off / max(x.stated, 1e-300))
    kinds = ("dark", "unsupported", "one-sided", "not told")
    counts = ", ".join(f"{sum(x.verdict == kind for x in found)} {kind}" for kind in kinds)
    refused = [x for x in found if x.verdict.startswith(("refused", "no room"))]
    relative = sorted(x.relative for x in acting if x.status == 0)
    report.say(
        f"{count} scenes from seed {first}: {counts}, {len(refused)} refused; of {len(told)} derivatives the "
        f"differences tell, {len(met)} of these met and {len(acting)} not zero; beyond what is stated: {len(beyond)}. "
        f"Relative errors: median {np.median(relative) if relative else 0.0:.1e}."
    )
    report.table(
        ["seed", "name", "off", "stated", "size", "status"],
        [[x.seed, x.name, x.off, x.stated, x.size, x.status] for x in beyond[:12]],
    )
    for x in refused[:6]:
        report.say(f"- seed {x.seed} {x.name}: {x.verdict}")
    for x in [x for x in found if x.verdict == "not told"][:6]:
        report.say(f"- seed {x.seed} {x.name}: not told, {x.off:.1e} beyond, {x.stated:.1e} stated of {x.size:.1e}")
    report.claim_number(
        f"derivatives more than {LOOSEST:g} times beyond", sum(x.off > LOOSEST * x.stated for x in told), 0
    )
    report.leave()


if __name__ == "__main__":
    main()
