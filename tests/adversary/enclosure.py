"""Proved bounds against what the split rule says: an enclosure that excludes the truth is no proof."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .case import Case
from .families import generate
from .judge import contradicts
from .world import Array, lobe_of, world_of

FAMILIES = ("anything", "open", "buried", "touching", "odd lights", "symmetric", "brdf", "sharp", "scales", "textures")


BOXES = 600
"""Boxes of an enclosure: it holds after any number, and a wrong one is wrong in its first boxes."""


@dataclass(frozen=True)
class Excluded:
    """A value the enclosure leaves no room for, and what the evaluator says of both."""

    case: Case
    value: Array
    stated: float
    low: Array
    high: Array
    opinion: Array
    doubt: Array


@dataclass
class Count:
    """Points asked, those refused, those that see light, those enclosed to a tenth of their value."""

    points: int = 0
    refused: int = 0
    signal: int = 0
    narrow: int = 0


def floor_case(seed: int) -> Case | None:
    """Case ``seed`` if it is one certify takes: a point of the floor, no marble, no mirror, no whole disk."""
    case = generate(FAMILIES[seed % len(FAMILIES)], 500_000 + seed)
    marble = any(s["texture"]["type"] == "marble" for s in case.scene["spheres"])
    if case.surface != "floor" or marble or case.disk == "exact" or case.scene["camera"]["eye"][2] <= 0.0:
        return None
    return replace(case, points=case.points[:1])


def judge_enclosure(case: Case, count: Count, width: float = 1e-3) -> Excluded | None:
    """What an enclosure of the case's point excludes, or None."""
    import symrender as sr
    from symrender.certify.enclosure import certify
    from symrender.errors import SymrenderError
    from symrender.scene.arrays import scene_arrays

    try:
        value = sr.probe(case.scene, case.points, surface=case.surface, disk=case.disk, tol=1e-8, threads=1)
        point = np.array([*case.points[0][:2], 0.0])
        order = int(case.disk.partition("x")[0])
        bounds = certify(scene_arrays(sr.load(case.scene)), point, order, width, BOXES)
    except SymrenderError:
        count.refused += 1
        return None
    count.points += 1
    gloss, stated = value.gloss[0], float(value.error[0])
    count.signal += bool(gloss.max() > 0.0)
    count.narrow += bool((bounds.high - bounds.low).max() <= 0.1 * max(1e-9, float(gloss.max())))
    room = stated + 1e-12 * np.abs(gloss)
    if (gloss >= bounds.low - room).all() and (gloss <= bounds.high + room).all():
        return None
    world, lobe = world_of(case.scene, case.disk), lobe_of(case.scene, case.surface, case.points[0])
    opinion, _ = contradicts(world, lobe, gloss, stated, case.seed)
    return Excluded(case, gloss, stated, bounds.low, bounds.high, opinion.value, opinion.doubt)
