"""No mean over a lens, a shutter or a filter is beyond 1.5 times what it states.

    python benchmarks/lens_and_shutter_are_stated.py [--quick] [SEED [COUNT]]

The hostile pixels of ``pixels_are_stated``, seen through lenses focused on, before and behind what is met, of some
hundredths of a pixel's blur to many pixels, while shapes, lights and the camera move by as much; under all filters.
Each is judged by paths of the conventional tracer, each with a place and an instant of its own, and by a run that asks
for twenty times less.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from measure import Report
from pixels_are_stated import hostile

from symrender.errors import SceneError, SymrenderError, Unsupported
from symrender.numeric.radiometric.pipeline import prepare as paths
from symrender.radiometric.world import seen
from symrender.runtimes.exposed import check_means, is_exposed, prepare_exposed
from symrender.runtimes.pixels import brightest, prepare_means
from symrender.runtimes.radiometric import check
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Filter, Settings

CASES, QUICK, SIDE, ROUNDS = 5_000, 12, 64, 16
WAYS = ("lens", "lens", "shutter", "shutter", "filter", "lens", "shutter", "both")
FILTERS: tuple[Filter, ...] = ("centre", "box", "tent", "gaussian", "mitchell")
TOLERANCES = (1e-3, 1e-4)
"""Over the brightest light of a scene."""


def exposed(seed: int) -> tuple[RadiometricScene, Filter, float]:
    """A scene, the filter of its pixel and what is asked over its brightest light."""
    rng, how = np.random.default_rng([seed, 5]), WAYS[seed % len(WAYS)]
    scene = hostile(seed)
    eye, target = np.array(scene.camera.eye), np.array(scene.camera.target)
    far, pixel = float(np.linalg.norm(target - eye)), 2 * np.tan(np.radians(scene.camera.fov) / 2)
    changes: dict[str, Any] = {}
    if how in ("lens", "both"):
        changes["camera.aperture"] = float(far * min(0.3, pixel * 10 ** rng.uniform(-2, 1)))
        changes["camera.focus"] = float(far * rng.choice([1, 1 - 1e-9, 0.9, 1.2, 0.4, 5.0]))
    if how in ("shutter", "both"):
        changes["shutter"] = [0.0, 1.0]
        reach = far * min(0.3, pixel * float(10 ** rng.uniform(-2, 0.7)))
        for index in range(len(scene.shapes)):
            if rng.random() < 0.5:
                changes[f"shapes[{index}].velocity"] = (rng.normal(size=3) * reach).tolist()
        if rng.random() < 0.5:
            changes["camera.velocity"] = (rng.normal(size=3) * reach).tolist()
        if hasattr(scene.lights[0], "velocity") and rng.random() < 0.5:
            changes["lights[0].velocity"] = (rng.normal(size=3) * reach).tolist()
    # of a lens over time a single place of the image is refused
    filters = FILTERS[1:] if how in ("both", "filter") else FILTERS
    return scene.replace(changes), filters[rng.integers(len(filters))], TOLERANCES[seed // 8 % 2]


def mean(arrays: RadiometricArrays, filter: Filter, tol: float, budget: int) -> tuple[Any, float]:
    """(radiance, stated error) of the one pixel."""
    settings = Settings(width=1, height=1, tol=float(np.clip(tol, 1e-13, 1.0)), filter=filter, budget=budget)
    means = (prepare_exposed if is_exposed(arrays) else prepare_means)(arrays, settings)
    emitted, direct, error, _ = means(0, 0, 1, 1)
    return (emitted + direct)[0, 0], float(error[0, 0])


def sampled(arrays: RadiometricArrays, filter: Filter, side: int, seed: int) -> tuple[Any, Any]:
    """(mean, its standard error) of ``ROUNDS`` renders of side x side paths."""
    found = []
    for turn in range(ROUNDS):
        settings = Settings(
            width=1, height=1, lobe=side, numeric="jittered", filter=filter, seed=ROUNDS * seed + turn
        )  # fmt: skip
        layers = {name: np.zeros((1, 1, 3)) for name in ("emitted", "direct", "indirect", "radiance")}
        paths(arrays, settings)(0, 0, 1, 1, layers | {"hit_class": np.zeros((1, 1))})
        found.append(layers["radiance"][0, 0])
    return np.mean(found, axis=0), np.std(found, axis=0, ddof=1) / np.sqrt(ROUNDS)


def main() -> None:
    quick = "--quick" in sys.argv
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = words[0] if words else 0, words[1] if len(words) > 1 else (QUICK if quick else CASES)
    report = Report("lens_and_shutter_are_stated", __doc__.split("\n")[0])
    judged = lit = told = met = sharp = refused = beyond = apart = 0
    seconds = 0.0
    for seed in range(first, first + count):
        try:
            scene, filter, tol = exposed(seed)
            arrays = radiometric_arrays(scene)
            check(arrays)
            check_means(arrays, Settings(width=1, height=1, filter=filter))
        except (SceneError, SymrenderError, Unsupported):
            refused += 1
            continue
        bright = brightest(seen(arrays, 1, 1))
        begun = time.process_time()
        value, stated = mean(arrays, filter, tol * bright, 200_000)
        seconds += time.process_time() - begun
        finer, rest = mean(arrays, filter, tol * bright / 20, 1_000_000)
        expected, sigma = sampled(arrays, filter, SIDE, seed)
        judged += 1
        lit += expected.max() > 1e-4 * bright
        told += stated < 0.1 * expected.max()
        met += stated <= tol * bright
        if (np.abs(value - finer) > 1.5 * (stated + rest) + 1e-14 * bright).any():
            beyond += 1
            report.say(f"seed {seed} {filter}: beyond, {value} stated {stated:.3g}, finer {finer} stated {rest:.3g}")
        if (np.abs(value - expected) > 1.5 * stated + 5 * sigma + 1e-12 * bright).any():
            # few paths may have missed what is small, and then their scatter has too
            expected, sigma = sampled(arrays, filter, 4 * SIDE, seed + CASES)
        sharp += bool((sigma <= 0.3 * max(stated, tol * bright)).all())
        if (np.abs(value - expected) > 1.5 * stated + 5 * sigma + 1e-12 * bright).any():
            apart += 1
            report.say(f"seed {seed} {filter}, {tol:g} asked: {value} stated {stated:.3g}, paths {expected} +- {sigma}")
    report.say(
        f"{judged} pixels, {refused} refused, {lit} lit, {told} that state less than a tenth of themselves, {met} that "
        f"meet what is asked, {sharp} that paths tell to .3 of it; {seconds / max(1, judged):.3g} CPU s "
        "each, scenes laid out"
    )
    report.claim_number("pixels beyond 1.5 times what both runs state", beyond, 0)
    # five standard errors of a scatter that is itself sampled
    report.claim_number("pixels apart from paths, share", apart / max(1, judged), 2e-3)
    report.leave()


if __name__ == "__main__":
    main()
