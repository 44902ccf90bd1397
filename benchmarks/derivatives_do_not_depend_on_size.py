"""Derivatives of a scene at four sizes and three tolerances agree within what they state.

    python benchmarks/derivatives_do_not_depend_on_size.py [--quick] [SEED [COUNT]]

The crowds of ``bounced_derivatives_are_stated.py``, each beside copies of itself at other sizes. They differ in
roundings and in all that has a size of its own, thresholds, tolerances and units, so that what was integrated by other
pieces, or left out, shows. All twelve derivatives of a number are held against the one that states least. This is no
judge of what all of them get wrong.
"""

from __future__ import annotations

import copy
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from bounced_derivatives_are_stated import DIM, acts, lit, resize
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

Scene = dict[str, Any]
COUNT, QUICK = 400, 4
SIZES = (1e-4, 1e-2, 1.0, 30.0)
TOLERANCES = (1e-2, 1e-4, 1e-6)
"""Of derivatives in numbers of order one, of light of order one."""
EACH = 8
"""Parameters of a scene."""
BUDGET = 300_000
LOOSEST = 1.5
ONE_SIDED = 4
LENGTHS = frozenset(("center", "point", "radius", "eye", "target", "position"))
ON_PLANE = "on_plane_"


class Asked(NamedTuple):
    """A derivative at one size: as at size 1, and what is stated of it."""

    size: float
    tol: float
    slope: np.ndarray
    stated: float
    status: int


def scaled(scene: Scene, size: float) -> Scene:
    """The scene at another size; fields of spheres are angles, and have none."""
    made = copy.deepcopy(scene)
    resize(made, size, {name for name in made["materials"] if name.startswith(ON_PLANE)})
    for key in ("eye", "target"):
        made["camera"][key] = (size * np.array(made["camera"][key])).tolist()
    return made


def power_of(name: str) -> int:
    """The power of the size by which a number of the scene grows."""
    words = name.split(".")
    if "intensity" in words:
        return 2
    return int(bool(LENGTHS & set(words)) or (words[-1] == "cell" and words[1].startswith(ON_PLANE)))


def drawn(seed: int) -> Scene | None:
    """The scene of a seed, lit to 1, of a size near 1, with materials of planes of their own; or None."""
    scene, light = lit(seed, 1e-5, BUDGET)
    if light <= DIM:
        return None
    for shape in scene["shapes"]:
        if shape["type"] == "plane":
            name = shape["material"]
            scene["materials"][ON_PLANE + name] = copy.deepcopy(scene["materials"][name])
            shape["material"] = ON_PLANE + name
    return scaled(scene, 2.0 ** -round(np.log2(np.abs(scene["camera"]["eye"]).max())))


def asked(scene: Scene, name: str) -> list[Asked]:
    """The derivatives in one number, at all sizes and tolerances."""
    import symrender as sr
    from symrender.errors import SymrenderError
    from symrender.scene.load import load_any

    found = []
    for size in SIZES:
        loaded, unit = load_any(scaled(scene, size)), size ** power_of(name)
        for tol in TOLERANCES:
            try:
                asked_for = min(1.0, tol / unit)
                image = sr.gradient(loaded, [name], size=1, tol=asked_for, threads=1, tile=1, budget=BUDGET)[name]
            except SymrenderError:
                continue
            stated, status = unit * float(image.layer("error")[0, 0]), int(image.layer("status")[0, 0])
            if np.isfinite(stated):
                found.append(Asked(size, tol, unit * image.layer("indirect")[0, 0], stated, status))
    return found


def main() -> None:
    from symrender.errors import SymrenderError
    from symrender.scene.load import load_any
    from symrender.scene.parameters import parameters

    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), QUICK if "--quick" in sys.argv else COUNT
    count = seeds[1] if len(seeds) > 1 else count
    report = Report("derivatives_do_not_depend_on_size", "Derivatives at several sizes agree within what they state.")
    scenes = values = met = moving = one_sided = 0
    beyond = []
    for seed in range(first, first + count):
        try:
            scene = drawn(seed)
            loaded = None if scene is None else load_any(scene)
        except SymrenderError:
            continue
        if scene is None or loaded is None:
            continue
        scenes += 1
        free = [each.name for each in parameters(loaded) if each.low <= each.value < each.high and acts(each.name)]
        for name in np.random.default_rng([seed, 31]).permutation(np.array(free))[:EACH]:
            every = asked(scene, str(name))
            # of what is not one number none is held against another
            found = [each for each in every if each.status != ONE_SIDED]
            one_sided += len(every) - len(found)
            if not found:
                continue
            values += len(found)
            met += sum(each.status == 0 for each in found)
            best = min(found, key=lambda each: each.stated)
            most = float(np.abs(best.slope).max())
            moving += int(most > 0.0)
            for each in found:
                off = float(np.abs(each.slope - best.slope).max())
                if off > LOOSEST * (each.stated + best.stated) + 1e-12 * max(1.0, most):
                    beyond.append((seed, str(name), each.size, each.tol, off, each.stated, best.stated, most))
    report.say(
        f"{scenes} scenes of seeds from {first} on: {values} derivatives, {met} met, of {moving} numbers in which "
        f"light changes; {one_sided} more are one-sided and not compared. Farther from the one that states least than "
        f"1.5 times what both state: {len(beyond)}."
    )
    report.table(["seed", "name", "size", "tolerance", "apart", "stated", "least stated", "derivative"], beyond[:12])
    report.claim_number("derivatives that do not agree", len(beyond), 0)
    report.claim_number("share of seeds without a lit scene", 1.0 - scenes / count, 0.5)
    report.leave()


if __name__ == "__main__":
    main()
