"""Second derivatives against differences of values: nothing of gradients is asked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from .case import Case
from .families import generate
from .world import Array

FAMILIES = ("anything", "buried", "open", "touching", "sharp", "symmetric", "odd lights", "grazing", "textures")
STEPS = (2.0**-7, 2.0**-8, 2.0**-9, 2.0**-10)


@dataclass(frozen=True)
class Wrong:
    """A second derivative beyond its stated error."""

    case: Case
    name: str
    said: Array
    stated: float
    found: Array
    doubt: float


@dataclass
class Count:
    """Derivatives judged, those with signal, those refused, those the differences could have told ten per cent of."""

    judged: int = 0
    signal: int = 0
    refused: int = 0
    told: int = 0


def parameters(case: Case, rng: np.random.Generator) -> str:
    """One number of the case's scene to move."""
    sphere = case.scene["spheres"][int(rng.integers(len(case.scene["spheres"])))]["name"]
    names = [f"spheres.{sphere}.center.x", f"spheres.{sphere}.center.z", f"spheres.{sphere}.radius", "camera.eye.z"]
    if case.scene["lights"]:
        names.append(f"lights.{case.scene['lights'][0]['name']}.position.x")
    return str(rng.choice(names))


def differences(case: Case, name: str) -> tuple[Array, float]:
    """Second derivative (3,) of the value at the case's point, extrapolated over halved steps, and its doubt."""
    import symrender as sr

    base = sr.load(case.scene)
    value = _number(case.scene, name)

    def at(shift: float) -> tuple[Array, float]:
        found = sr.probe(
            base.replace({name: value + shift}), case.points, surface=case.surface, tol=1e-12, disk=case.disk, threads=1
        )
        return found.gloss[0], float(found.error[0])

    middle = at(0.0)
    rows: list[Array] = []
    noise = 0.0
    for h in STEPS:
        (up, e1), (down, e2) = at(h), at(-h)
        rows.append((up - 2.0 * middle[0] + down) / (h * h))
        noise = (e1 + e2 + 2.0 * middle[1] + 4e-16 * float(np.abs(up).max())) / (h * h)
    once = [(4.0 * b - a) / 3.0 for a, b in pairwise(rows)]
    twice = [(16.0 * b - a) / 15.0 for a, b in pairwise(once)]
    apart = max(float(np.abs(twice[1] - twice[0]).max()), float(np.abs(twice[1] - once[2]).max()))
    return twice[1], 4.0 * apart + 4.0 * noise


def _number(scene: dict[str, Any], name: str) -> float:
    parts = name.split(".")
    if parts[0] == "camera":
        return float(scene["camera"]["eye"][2])
    shape = next(s for s in scene[parts[0]] if s["name"] == parts[1])
    found = shape[parts[2]]
    return float(found if len(parts) == 3 else found["xyz".index(parts[3])])


def judge_hessian(seed: int, count: Count) -> Wrong | None:
    """Judge one second derivative of one case."""
    import symrender as sr
    from symrender.errors import SymrenderError

    case = generate(FAMILIES[seed % len(FAMILIES)], 900_000 + seed)
    case = replace(case, points=case.points[:1])
    name = parameters(case, np.random.default_rng((seed, 3)))
    try:
        said = sr.hessian(case.scene, [name], case.points, surface=case.surface, tol=1e-10, disk=case.disk)
        found, doubt = differences(case, name)
    except SymrenderError:
        count.refused += 1
        return None
    value, stated = said.values[0, 0, 0], float(said.error[0, 0, 0])
    count.judged += 1
    count.signal += bool(np.abs(found).max() > 10.0 * doubt)
    count.told += bool(doubt < 0.1 * np.abs(found).max())
    if np.isfinite(stated) and np.abs(value - found).max() > 3.0 * stated + doubt:
        return Wrong(case, name, value, stated, found, doubt)
    return None
