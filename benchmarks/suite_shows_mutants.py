"""Scenes of the truth suite show mistakes planted in a path tracer, after so many samples a pixel.

Every mistake is rendered in every scene and audited; the tracer without it must pass. A mistake that changes no bit of
an image does not touch that scene. With ``--update`` the table is kept in the package, and told in ``suite.json``.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from measure import Report, arguments
from mutants import MUTANTS, Mutant, planted, rendered

import symrender as sr
from symrender.images.image import Image
from symrender.scene.radiometric.lights import Area, Sky
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.suite.write import MECHANISMS, scene_of

SIZE = (16, 12)
SAMPLES = (16, 64)
LEVEL = 0.001
TABLE = Path(__file__).resolve().parents[1] / "src" / "symrender" / "suite" / "mistakes.json"


def is_exact(scene: RadiometricScene) -> bool:
    """Whether chance has no part in an image of it."""
    return scene.bounces == 0 and not any(isinstance(light, Sky | Area) for light in scene.lights)


def shown(mutant: Mutant | None, scene: RadiometricScene, true: Image, right: Image, most: int) -> int:
    """Samples after which an audit fails; 0 if none does, -1 where the mistake changes no bit."""
    exact = is_exact(scene)
    with planted(mutant):
        first = rendered(scene, SIZE, 1, 5, plain=True)
        if mutant is not None and np.array_equal(first.radiance, right.radiance):
            return -1
        for samples in (1,) if exact else [n for n in SAMPLES if n <= most]:
            image = first if exact else rendered(scene, SIZE, samples, 11, plain=True)
            # the tracer computes in 64 bits, so that nothing is set aside
            double = Image(image.layers, {"precision": "double"})
            found = sr.audit(double, scene, truth=true, samples=samples, noise_free=exact, level=LEVEL, explain=False)
            if found.verdict == "failed":
                return samples
    return 0


def main() -> None:
    options = arguments(__doc__, flags={"--update": "keep the table in the package"})
    mutants, most = (MUTANTS[::6], SAMPLES[0]) if options.quick else (MUTANTS, SAMPLES[-1])
    report = Report(
        "suite_shows_mutants", f"{len(mutants)} mistakes, {len(MECHANISMS)} scenes, {SIZE[0]} x {SIZE[1]} pixels."
    )
    scenes = {name: scene_of(name) for name in MECHANISMS}
    truths = {name: sr.truth(scene, size=SIZE, tol=1e-7) for name, scene in scenes.items()}
    right = {name: rendered(scene, SIZE, 1, 5, plain=True) for name, scene in scenes.items()}
    wrongly = sum(shown(None, scenes[name], truths[name], right[name], most) > 0 for name in scenes)
    table: dict[str, dict[str, int]] = {}
    rows, missed, alarmed = [], [], []
    for mutant in mutants:
        found = {name: shown(mutant, scenes[name], truths[name], right[name], most) for name in scenes}
        table[mutant.name] = {name: n for name, n in found.items() if n > 0}
        told = ", ".join(f"{name} {n}" for name, n in table[mutant.name].items())
        rows.append((mutant.name, told or "none", ", ".join(name for name, n in found.items() if n == 0)))
        touched = any(n >= 0 for n in found.values())
        if touched and not mutant.same and not table[mutant.name]:
            missed.append(mutant.name)
        if mutant.same and table[mutant.name]:
            alarmed.append(mutant.name)
    report.table(("mistake", "shown by, after samples a pixel", "touched and not shown"), rows)
    nowhere = [name for name, by in table.items() if not by and name not in missed]
    report.say(f"Shown by no scene: {', '.join(nowhere) or 'none'}.")
    report.claim_number("scenes whose right image fails", wrongly, 0)
    report.claim_number(
        f"mistakes that touch a scene, move a mean and are not shown ({', '.join(missed)})", len(missed), 2
    )
    report.claim_number(f"changes that move no mean and fail ({', '.join(alarmed)})", len(alarmed), 0)
    if options.update:
        TABLE.write_text(json.dumps(table, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    report.leave()


if __name__ == "__main__":
    main()
