"""How far a number of a scene may move before the scene is another one."""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.scene.parameters import get, parameters
from symrender.scene.values import Part

TURNS: Final = frozenset(("up", "normal", "along", "direction", "velocity"))
"""Vectors that are no places: their own size is the scale of their components."""


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
    if whole.rpartition(".")[2] not in TURNS:
        others = np.array([place - other for other in _places(scene) if other.shape == place.shape])
        away = np.sqrt((others.reshape(-1, len(place)) ** 2).sum(axis=1))
        if (away > 0.0).any():
            return float(np.median(away[away > 0.0]))
    return float(np.abs(place).max()) or 1.0


def _places(scene: Part) -> list[np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    """The places of a scene."""
    names = dict.fromkeys(each.name.rpartition(".")[0] for each in parameters(scene) if each.name[-2:] in (".x", ".y"))
    return [
        np.array(get(scene, name), dtype=np.float64) for name in names if name.rpartition(".")[2] not in TURNS
    ]  # fmt: skip
