"""Which numbers of a radiometric scene's records a parameter moves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from symrender.jit.records import flat
from symrender.scene.moves import Move, components, stepped
from symrender.scene.radiometric.arrays import DIRECTIONAL, SPOT, Array, RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

MOVED: Final = ("materials", "terms", "shapes", "facets", "lights", "directions", "camera")
"""Fields of ``RadiometricArrays`` that parameters move; the others follow from them."""


def radiometric_moves(scene: RadiometricScene, names: Iterable[str]) -> tuple[Move, ...]:
    """What each of ``names`` moves in ``RadiometricArrays``, vectors written out; SceneError for what is no number."""
    return tuple((name, _moved(scene, name)) for name in components(scene, names))


def numbers(arrays: RadiometricArrays, name: str) -> Array:
    """The numbers of a field of ``MOVED``, a row an entry; without those that follow from others."""
    if name == "directions":
        return arrays.directions
    if name != "lights":
        return flat(getattr(arrays, name))
    lights = arrays.lights.copy()  # type: ignore[attr-defined]
    for row in lights:
        if row.kind == DIRECTIONAL:
            row.place[:] = 0.0
        if row.kind == SPOT:
            row.axis[:] = 0.0
    return flat(lights)


def _moved(scene: RadiometricScene, name: str) -> tuple[tuple[str, tuple[int, ...]], ...]:
    here = radiometric_arrays(scene)
    _, _, there = stepped(scene, name, radiometric_arrays)
    found: list[tuple[str, tuple[int, ...]]] = []
    for part in MOVED:
        changed = np.nonzero(numbers(here, part) != numbers(there, part))
        found += [(part, tuple(int(k) for k in index)) for index in zip(*changed, strict=True)]
    return tuple(found)
