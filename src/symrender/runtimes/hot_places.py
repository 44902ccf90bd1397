"""Lists the hot places of a scene (``radiometric/pixels/hot.py``)."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.runtimes.pixels import shapes_met
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, POINT, SPHERE, SPOT

_WIDEST: Final = 60.0
"""Half angle in degrees from which on a spot is no beam."""
_LIFT: Final = 1e-9
_MOST: Final = 64
"""Shapes beyond which feet on faces are not listed: a mesh has too many to ask of every cell."""


def hot_places(world: World) -> Array:
    """(N, 5) hot places: where, their size, and the shape they are of.

    The foot of every point, spot and ball that emits on every shape, as large as it is far; the disc that a spot's beam
    lights, as metals send it on; and every ball.
    """
    rows: list[list[float]] = []
    for piece in world.pieces:
        if piece.kind == SPHERE:
            rows.append([*piece.place, piece.radius, piece.owner])
    for light in world.lights:
        if light.kind in (POINT, SPOT):
            rows += _feet(world, np.array(light.place), -1.0)
        if light.kind == AREA:
            for piece in world.pieces:
                if piece.owner == light.emitter and piece.kind == SPHERE:
                    rows += _feet(world, np.array(piece.place), piece.owner)
        if light.kind == SPOT and light.cutoff < _WIDEST:
            rows += _beam(world, np.array(light.place), np.array(light.axis), math.tan(math.radians(light.cutoff)))
    return np.array(rows, np.float64).reshape(-1, 5)


def _feet(world: World, at: Array, own: float) -> list[list[float]]:
    """Where each shape but ``own`` comes nearest to a place."""
    rows = []
    for piece in world.pieces:
        if piece.owner == own:
            continue
        if piece.kind == SPHERE:
            away = at - piece.place
            far = float(np.linalg.norm(away))
            if far > 0.0:
                rows.append([*(piece.place + piece.radius / far * away), abs(far - piece.radius), piece.owner])
        elif piece.kind == PLANE or len(world.pieces) <= _MOST:
            gap = float((at - piece.place) @ piece.up)
            rows.append([*(at - gap * np.array(piece.up)), abs(gap), piece.owner])
    return rows


def _beam(world: World, at: Array, axis: Array, slope: float) -> list[list[float]]:
    """The disc that a beam about a unit axis lights, and where its image in a metal falls, which is of the metal."""
    met = shapes_met(world, at[None], axis[None])
    shape, place, normal = float(met.shape[0]), met.place[0], met.normal[0]
    if shape < 0.0:
        return []
    length = float(np.linalg.norm(place - at))
    rows = [[*place, slope * length, shape]]
    if next(world.materials[int(p.material)].kind for p in world.pieces if p.owner == shape) != DIFFUSE:
        mirrored = axis - 2.0 * (axis @ normal) * normal
        # off the surface it leaves
        met = shapes_met(world, (place + _LIFT * length * mirrored)[None], mirrored[None])
        if met.shape[0] >= 0:
            rows.append([*met.place[0], slope * (length + float(np.linalg.norm(met.place[0] - place))), shape])
    return rows
