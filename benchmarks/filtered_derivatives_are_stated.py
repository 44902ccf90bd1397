"""No derivative of a mean over a pixel of direct light is beyond 1.5 times what it states.

    python benchmarks/filtered_derivatives_are_stated.py [--quick] [SEED [COUNT]]

The hostile pixels of ``pixels_are_stated.py`` under every filter, by a place or a radius of a shape, by a lamp, the eye
or its target. Each is judged by extrapolated central differences of means, which share nothing with derivatives but
where walls are; what the differences may be off by is what they change from one step to the next and what means state
over the step. Pixels of which differences tell nothing are counted.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from measure import Report
from pixels_are_stated import hostile

from symrender import gradient
from symrender.errors import SceneError, SymrenderError, Unsupported
from symrender.jit.records import Array
from symrender.radiometric.world import seen
from symrender.runtimes.pixels import brightest, check_pixels, prepare_means
from symrender.runtimes.radiometric import check
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Filter, Settings

PIXELS, QUICK = 2_000, 12
FILTERS: tuple[Filter, ...] = ("box", "box", "box", "tent", "gaussian", "mitchell")
TOL = 1e-3
"""Of the brightest light over the distance from the eye to its target."""
STEPS = (1e-4, 1e-5)
"""Over that distance."""
FINEST = 1e-10
BUDGET = 300_000


def names_of(scene: RadiometricScene) -> list[str]:
    """Numbers of a scene that may move."""
    found = ["camera.eye.x", "camera.eye.y", "camera.eye.z", "camera.target.x", "camera.target.z"]
    for shape in scene.shapes:
        own = f"shapes.{shape.name}"
        if shape.type in ("sphere", "disk", "box"):
            found += [f"{own}.center.{axis}" for axis in "xyz"]
        if shape.type in ("sphere", "disk"):
            found.append(f"{own}.radius")
        if shape.type == "plane":
            found.append(f"{own}.point.z")
        if shape.type == "rectangle":
            found.append(f"{own}.corner.x")
    for light in scene.lights:
        if light.type in ("point", "spot"):
            found += [f"lights.{light.name}.position.{axis}" for axis in "xyz"]
        if light.type == "directional":
            found.append(f"lights.{light.name}.direction.x")
    return found


def mean(scene: RadiometricScene, kind: Filter, tol: float) -> tuple[Array, float]:
    """(radiance, stated error) of the one pixel."""
    settings = Settings(width=1, height=1, tol=float(np.clip(tol, 1e-13, 1.0)), filter=kind, budget=4 * BUDGET)
    emitted, direct, error, _ = prepare_means(radiometric_arrays(scene), settings)(0, 0, 1, 1)
    return (emitted + direct)[0, 0], float(error[0, 0])


def differences(scene: RadiometricScene, name: str, kind: Filter, step: float, tol: float) -> tuple[Array, float]:
    """(derivative, what it may be off by) of two central differences of means, extrapolated."""
    value, found, rounded = float(get(scene, name)), [], 0.0
    for part in (1.0, 0.5):
        sides = [mean(scene.replace({name: value + side * part * step}), kind, tol) for side in (1.0, -1.0)]
        found.append((sides[0][0] - sides[1][0]) / (2.0 * part * step))
        rounded = (sides[0][1] + sides[1][1]) / (2.0 * part * step)
    far, near = found
    return (4.0 * near - far) / 3.0, float(np.abs(near - far).max()) + 2.0 * rounded


def case(seed: int) -> dict[str, Any]:
    """What became of one pixel."""
    rng, kind = np.random.default_rng([seed, 19]), FILTERS[seed % len(FILTERS)]
    try:
        scene = hostile(seed)
        arrays = radiometric_arrays(scene)
        check(arrays)
        check_pixels(arrays)
        names = names_of(scene)
        name = names[rng.integers(len(names))]
        far = float(np.linalg.norm(np.array(scene.camera.target) - np.array(scene.camera.eye)))
        bright = brightest(seen(arrays, 1, 1))
        begun = time.process_time()
        tol = float(np.clip(TOL * bright / far, 1e-13, 1.0))
        image = gradient(scene, [name], size=1, tol=tol, filter=kind, budget=BUDGET, threads=1, tile=1)[name]
        seconds = time.process_time() - begun
    except (SceneError, Unsupported):
        return {"refused": True}
    value, stated = image.radiance[0, 0], float(image.layer("error")[0, 0])
    found = {"seconds": seconds, "met": image.layer("status")[0, 0] == 0}
    if not np.isfinite(stated):
        return found | {"unknown": True}
    best, doubt = np.zeros(3), np.inf
    for step in STEPS:
        try:
            expected, off = differences(scene, name, kind, step * far, FINEST * bright)
        except SymrenderError:
            # a radius or a distance may not become nothing
            continue
        if off < doubt:
            best, doubt = expected, off
    if not np.isfinite(doubt):
        return found | {"unknown": True}
    gap, most = float(np.abs(value - best).max()), float(np.abs(best).max())
    least = 1e-9 * bright / far
    return found | {
        "judged": True,
        "moves": most > 1e-3 * bright / far,
        "told": most > least and doubt + stated < 0.1 * most,
        "close": doubt < 0.5 * max(stated, tol),
        "beyond": gap > 1.5 * stated + 2.0 * doubt + least,
        "said": f"seed {seed}, {kind}, {name}: {value} stated {stated:.3g}, differences {best} +- {doubt:.3g}",
    }


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("filtered_derivatives_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else PIXELS)
    names = ("judged", "refused", "unknown", "met", "moves", "told", "close", "beyond")
    sums, seconds = dict.fromkeys(names, 0), 0.0
    for seed in range(first, first + count):
        row = case(seed)
        seconds += row.get("seconds", 0.0)
        for name in names:
            sums[name] += bool(row.get(name))
        if row.get("beyond"):
            report.say(row["said"])
    report.say(
        f"{sums['judged']} derivatives judged, {sums['refused']} refused, {sums['unknown']} unknown, {sums['met']} "
        f"that meet what is asked, {sums['moves']} larger than a thousandth of the brightest light, "
        f"{sums['told']} told to a tenth of themselves, {sums['close']} by differences closer than half "
        "of what is stated or asked; "
        f"{seconds / max(1, sums['judged'] + sums['unknown']):.3g} CPU s each"
    )
    report.claim_number("derivatives beyond 1.5 times what they state", sums["beyond"], 0)
    report.leave()


if __name__ == "__main__":
    main()
