"""No value of direct light over a bump lies beyond one and a half times the error stated.

    python benchmarks/bumps_are_stated.py [--quick] [FIRST [COUNT]]

Skies and lamps: the contacts of ``polygons_are_stated``, whose floor has a slope, of none to steep and along the edges
of other shapes, against meridians cut by the second horizon (``tests/radiometric/meridians.py``), by both conventions.
Suns: random formulas on a ball and a floor against differences of the raised surface in 60 digits
(``tests/radiometric/heights.py``), scaled from 1e-4 to 1e3.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import mpmath
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.radiometric import flats, heights, meridians

import symrender as sr
from symrender.errors import Unsupported

JUDGE = 1e-9
"""What is allowed meridians beyond the difference of their last two sums."""
CONVENTIONS = ("shading", "geometric")


def sloped(seed: int) -> tuple[float, float, float, bool] | None:
    """(value, stated, off beyond the judge's own error, whether it is lit) under a sky or a lamp; None if refused."""
    scene, own, place, normal, lamp = flats.contact(seed)
    rng = np.random.default_rng([seed, 4])
    slope = rng.normal(size=2) * float(rng.choice([1e-12, 1e-9, 1e-3, 0.3, 0.7, 2.0, 30.0])) * rng.choice([0, 1, 1], 2)
    form = {"add": [{"mul": [float(slope[0]), "x"]}, {"mul": [float(slope[1]), "y"]}]}
    normals = CONVENTIONS[seed % 2]
    for name in ("white", "both"):
        scene["materials"][name] = scene["materials"][name] | {"bump": {"height": form, "normals": normals}}
    toward = np.array([-0.2 * slope[0], -0.2 * slope[1], 1.0])
    size = max(abs(place).max(), 1e-4)
    try:
        found = sr.probe(scene, rays=(place + 1e-7 * size * toward, -toward), tol=1e-6)
    except Unsupported:
        return None
    if found.shape[0] != f"shapes.{own}":
        return None
    turned = np.array([-slope[0], -slope[1], 1.0]) / math.sqrt(1 + slope @ slope)
    by, other = (turned, normal) if normals == "shading" else (normal, turned)
    true, known = (x / math.pi for x in meridians.irradiance(scene["shapes"], own, place, by, lamp, other))
    off = abs(float(found.direct[0, 0]) - true) - known - JUDGE
    return float(found.direct[0, 0]), float(found.error[0]), off, true > 1e-6


def raised(seed: int) -> tuple[float, float, float, bool] | None:
    """The same of a random formula under a sun."""
    rng = np.random.default_rng([seed, 6])
    scale, normals = float(10.0 ** rng.uniform(-4, 3)), CONVENTIONS[seed % 2]
    # a formula of places in units of the scale
    formula = scaled(heights.varied(rng, 5), scale)
    bump = {"height": formula, "amplitude": scale * float(10 ** rng.uniform(-2, 1)), "normals": normals}
    material = flats.WHITE | {"bump": bump}
    centre, radius = rng.normal(size=3) * scale, scale * float(rng.uniform(0.3, 2.0))
    shape = flats.ball("ball", centre, radius)
    outward = rng.normal(size=3)
    outward /= np.linalg.norm(outward)
    eye = centre + radius * outward + radius * (outward + 0.4 * rng.normal(size=3))
    way = centre + radius * outward - eye
    sun = outward + 0.7 * rng.normal(size=3)
    light = {"type": "directional", "name": "sun", "direction": (-sun).tolist(), "irradiance": math.pi}
    camera = {"type": "look_at", "eye": eye.tolist(), "target": centre.tolist()}
    scene = flats.world(shape, lights=[light], materials={"white": material}, camera=camera)
    found = sr.probe(scene, rays=(eye, way), tol=1e-6)
    if found.shape[0] == "nothing":
        return None
    with mpmath.workdps(heights.DIGITS):
        w = heights.unit(heights.exact(way))
        offset = [a - b for a, b in zip(heights.exact(eye), heights.exact(shape["center"]), strict=True)]
        b, c = heights.dot(offset, w), heights.dot(offset, offset) - mpmath.mpf(radius) ** 2
        reach = -b - mpmath.sqrt(b * b - c)
        at = [o + reach * d for o, d in zip(heights.exact(eye), w, strict=True)]
        normal = heights.unit([p - q for p, q in zip(at, heights.exact(shape["center"]), strict=True)])
        n = heights.raised_normal(bump, at, normal, None, mpmath.mpf(scale))
        toward = heights.unit(heights.exact(sun))
        one, two, seen = heights.dot(n, toward), heights.dot(normal, toward), -heights.dot(n, w)
        true = float((one if normals == "shading" else two) if one > 0 and two > 0 and seen > 0 else 0)
    value = float(found.direct[0, 0])
    return value, float(found.error[0]), abs(value - true) - 1e-15, true > 1e-6


def scaled(formula: Any, scale: float) -> Any:
    """The formula of places in units of ``scale``."""
    if isinstance(formula, str):
        return {"mul": [1.0 / scale, formula]}
    if not isinstance(formula, dict):
        return formula
    ((name, given),) = formula.items()
    if name == "distance":
        return {"mul": [1.0 / scale, {"distance": [scale * c for c in given]}]}
    if name == "pow":
        return {name: [scaled(given[0], scale), given[1]]}
    if name in ("sin", "cos", "exp"):
        return {name: scaled(given, scale)}
    return {name: [scaled(part, scale) for part in given]}


def main() -> int:
    """Print what was judged, and every value beyond; 1 where there is one."""
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (*words[:2], *(0, 40 if "--quick" in sys.argv else 2000)[len(words) :])
    bad = 0
    for name, judge in (("skies and lamps", sloped), ("suns", raised)):
        judged = lit = met = skipped = beyond = 0
        for seed in range(first, first + count):
            found = judge(seed)
            if found is None:
                skipped += 1
                continue
            value, stated, off, bright = found
            judged, lit, met = judged + 1, lit + bright, met + (stated <= 1e-6)
            if off > 1.5 * stated:
                beyond += 1
                print(f"{name}, seed {seed}: {value:.12g} is off by {off:.2g}, stated {stated:.2g}", flush=True)
        print(f"{name}: {judged} judged, {lit} lit, {met} met 1e-6, {skipped} refused or hidden, {beyond} beyond")
        bad += beyond + (lit < judged // 5)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
