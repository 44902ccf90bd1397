"""How far a number of a scene may move before the scene is another one."""

from __future__ import annotations

from collections import defaultdict
from typing import Final

import numpy as np

from symrender.scene.parameters import get, parameters
from symrender.scene.values import Part

PLACES: Final = frozenset(("eye", "target", "position", "center", "point", "corner", "vertices"))
"""Vectors that are places. All others, directions, edges and sizes, do not depend on where the origin is."""


def scale_of(scene: Part, name: str) -> float:
    """Return the scale of the real number ``name``: positive, in the unit of the number.

    Of a coordinate of a place it is the median distance to the other places of the scene (eye, target, centres,
    positions), because a place far from the origin moves no faster than one beside it. Of a component of any other
    vector it is the largest component, of a single number and a channel its size; 1 where that is zero.
    """
    whole, _, axis = name.rpartition(".")
    if axis not in ("x", "y", "z"):
        return abs(float(get(scene, name))) or 1.0
    place = np.array(get(scene, whole), dtype=np.float64)
    if _is_place(whole):
        found: dict[str, list[float]] = defaultdict(list)
        for each in parameters(scene):
            other, _, letter = each.name.rpartition(".")
            if letter in ("x", "y", "z") and _is_place(other):
                found[other].append(each.value)
        away = np.sqrt(((np.array(list(found.values())) - place) ** 2).sum(axis=1))
        if (away > 0.0).any():
            return float(np.median(away[away > 0.0]))
    return float(np.abs(place).max()) or 1.0


def _is_place(name: str) -> bool:
    """Whether a vector is a place, by the name of its field; the index of a vertex is no part of that."""
    return name.rpartition(".")[2].partition("[")[0] in PLACES
