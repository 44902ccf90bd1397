"""Which numbers of a radiometric scene's records a parameter moves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.records import flat
from symrender.scene.moves import Move, components, stepped
from symrender.scene.radiometric.arrays import DIRECTIONAL, SPOT, Array, RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

MOVED: Final = ("materials", "terms", "shapes", "facets", "lights", "directions", "camera")
"""Fields of ``RadiometricArrays`` that parameters move one for one; ``frames`` follow from them."""


def radiometric_moves(scene: RadiometricScene, names: Iterable[str]) -> tuple[Move, ...]:
    """What each of ``names`` moves in ``RadiometricArrays``, vectors written out; SceneError for what is no number.

    Unsupported for what moves the exposure, or the records otherwise than one for one, as velocities do.
    """
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


def _details(arrays: RadiometricArrays) -> tuple[Array, ...]:
    """Numbers of what the path tracer alone reads, but texels, which no parameter moves."""
    return flat(arrays.detail.pictures), arrays.detail.coordinates, arrays.detail.normals


def _moved(scene: RadiometricScene, name: str) -> tuple[tuple[str, tuple[int, ...]], ...]:
    here = radiometric_arrays(scene)
    value, other, there = stepped(scene, name, radiometric_arrays)
    if there.exposure.spreads and not here.exposure.spreads:
        raise Unsupported(
            f"{name}: beside {value:g} the image is a mean over a lens or over time, which is not yet differentiated"
        )
    if any((a != b).any() for a, b in zip(_details(here), _details(there), strict=True)):
        raise Unsupported(f"{name}: is not yet differentiated, as it moves an image, or normals or coordinates of it")
    found: list[tuple[str, tuple[int, ...]]] = []
    for part in MOVED:
        a, b = numbers(here, part), numbers(there, part)
        changed = a != b
        # a sum may round
        rounded = 4.0 * np.spacing(np.maximum(np.abs(a), np.abs(b)) + abs(value))
        if (np.abs((b - a) - (other - value)) > rounded)[changed].any():
            raise Unsupported(f"{name}: is not yet differentiated where it does not move the {part} one for one")
        found += [(part, tuple(int(k) for k in index)) for index in zip(*np.nonzero(changed), strict=True)]
    return tuple(found)
