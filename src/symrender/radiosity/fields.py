"""Textures of faces: the lines in which their fields end, at which cells are cut, and how many fields there are."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.radiometric.pieces import POLYGON
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import corners_of
from symrender.scene.arrays import CHECKER, SOLID
from symrender.scene.radiometric.arrays import DIFFUSE

MOST_FIELDS: Final = 1000
"""Most fields of the textures of all faces of a scene."""


def field_lines(world: World, own: int) -> list[Array]:
    """Segments (2, 3) in which fields of face ``own`` end: all lines of a checker, those across stripes."""
    piece = world.pieces[own]
    material = world.materials[int(piece.material)]
    if material.texture == SOLID:
        return []
    axes = np.array([piece.east, piece.north])
    low, high = _extent(world, own)
    found = []
    for k in (0, 1) if material.texture == CHECKER else (0,):
        begin, end = (piece.place + material.cell * at[1 - k] * axes[1 - k] for at in (low - 1.0, high + 1.0))
        for line in range(math.ceil(low[k]), math.floor(high[k]) + 1):
            aside = line * material.cell * axes[k]
            found.append(np.array([begin + aside, end + aside]))
    return found


def _extent(world: World, own: int) -> tuple[Array, Array]:
    """Least and largest texture coordinates of a face, in fields."""
    piece = world.pieces[own]
    away = corners_of(piece) - piece.place
    at = np.column_stack([away @ piece.east, away @ piece.north]) / float(world.materials[int(piece.material)].cell)
    return at.min(axis=0), at.max(axis=0)


def too_many_fields(world: World) -> int:
    """The shape with which diffuse faces have more than ``MOST_FIELDS`` fields, -1 if they have not."""
    fields = 0.0
    for j, piece in enumerate(world.pieces):
        material = world.materials[int(piece.material)]
        if piece.kind != POLYGON or material.kind != DIFFUSE or material.texture == SOLID:
            continue
        low, high = _extent(world, j)
        counts, sides = np.ceil(high) - np.floor(low), 2.0 if material.two_sided else 1.0
        fields += sides * float(counts.prod() if material.texture == CHECKER else counts[0])
        if fields > MOST_FIELDS:
            return int(piece.owner)
    return -1
