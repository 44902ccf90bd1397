"""No value or derivative of a radiometric scene in closed form is beyond what it states.

    python benchmarks/roundings_are_stated.py [--quick] [SEED]

Scenes are those of ``tests/radiometric/hostile.py``: crowds of all materials, lights and textures, and rays beside
contacts, horizons, edges of shadows and lamps, a million units from the origin. The judge is the kernel's own text in
50 digits, so that it tells what rounding did and nothing else; formulas are judged by other tests.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from measure import Report

ROOT = Path(__file__).resolve().parents[1]
VALUES, SLOPES, QUICK = 20_000, 3_000, 50
KINDS = ("crowd", "sky", "area", "points")
BATCH = 50
SMALLEST = float(np.finfo(float).tiny)


class Judged(NamedTuple):
    """Of one value or derivative: how far off it is, what is stated, and its size."""

    kind: str
    seed: int
    name: str
    off: float
    stated: float
    size: float


def judged(kind: str, seeds: range, *, sloped: bool) -> list[Judged]:
    """Of the one pixel of every scene its value, or its derivative by one parameter; none of what is refused."""
    sys.path.insert(0, str(ROOT))
    from tests.radiometric import hostile, many_digits

    import symrender as sr
    from symrender.errors import SymrenderError
    from symrender.radiometric.slopes import seen_moves
    from symrender.radiometric.world import seen
    from symrender.scene.parameters import parameters
    from symrender.scene.radiometric.arrays import radiometric_arrays
    from symrender.scene.radiometric.moves import radiometric_moves

    found = []
    for seed in seeds:
        scene = hostile.scene(seed) if kind == "crowd" else hostile.beside_walls(seed, kind)
        rng = np.random.default_rng([seed, zlib.crc32(kind.encode())])
        name = str(rng.choice([each.name for each in parameters(scene)])) if sloped else "camera.fov"
        try:
            image = sr.gradient(scene, [name], size=1)[name] if sloped else sr.truth(scene, size=1)
        except SymrenderError:
            continue
        stated = float(image.layer("error")[0, 0])
        if not np.isfinite(stated):
            continue
        arrays = radiometric_arrays(scene)
        (move,) = radiometric_moves(scene, [name])
        value, _, slope = many_digits.value_and_slope(seen(arrays, 1, 1), seen_moves(arrays, move, 1, 1))
        exact = slope if sloped else value
        off = max(abs(float(a - b)) for a, b in zip(exact, image.radiance[0, 0], strict=True))
        found.append(Judged(kind, seed, name, off, stated, float(abs(image.radiance).max())))
    return found


def batches(total: int, first: int) -> Iterator[tuple[str, range]]:
    """``total`` seeds from ``first`` on, shared out among the kinds of scenes."""
    each = -(-total // len(KINDS))
    for start in range(first, first + each, BATCH):
        for kind in KINDS:
            yield kind, range(start, min(start + BATCH, first + each))


def tell(report: Report, what: str, found: list[Judged], loosest: float) -> None:
    """Counts of a population, its worst, and the claim that none is ``loosest`` times beyond what it states."""
    # what is smaller than the smallest normal number has no digits to lose
    ratio = [0.0 if x.off < SMALLEST else x.off / x.stated if x.stated > 0.0 else np.inf for x in found]
    lost = sum(x.off > 1e-12 * x.size > 0.0 for x in found)
    torn = sum(x.off > 0.1 * x.size > 0.0 for x in found)
    report.say(
        f"{len(found)} {what}, {sum(x.size > 0.0 for x in found)} of them not 0, {lost} that lose more than four "
        f"digits, {torn} that jump within roundings; beyond what is stated: {sum(r > 1.0 for r in ratio)}."
    )
    worst = sorted(zip(ratio, found, strict=True), key=lambda pair: -pair[0])[:5]
    report.table(
        ["kind", "seed", "by", "off", "stated", "ratio"],
        [[x.kind, x.seed, x.name, x.off, x.stated, float(r)] for r, x in worst],
    )
    report.claim_number(f"{what} more than {loosest:g} times beyond", sum(r > loosest for r in ratio), 0)


def main() -> None:
    quick = "--quick" in sys.argv
    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first = seeds[0] if seeds else 1_000_000
    report = Report("roundings_are_stated", "Values and derivatives in closed form are as near as they state.")
    with ProcessPoolExecutor(2) as pool:
        for what, total, sloped, loosest in (("values", VALUES, False, 1.5), ("derivatives", SLOPES, True, 3.0)):
            jobs = [
                pool.submit(judged, kind, part, sloped=sloped)
                for kind, part in batches(QUICK if quick else total, first)
            ]
            tell(report, what, [x for job in jobs for x in job.result()], loosest)
    report.leave()


if __name__ == "__main__":
    main()
