"""Cells that are too large for what is near them: samples might pass it by.

What a polygon changes in the light of a face has the size of its distance or of its width, whichever is larger. A cell
much larger than both need not have a sample in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import corners_of
from symrender.radiosity.cells import Frames, Quads
from symrender.scene.radiometric.arrays import AREA, POINT, SKY, SPHERE, SPOT

_LARGE: Final = 1.5
"""Reach of a cell, in parts of what is near it, from which it is too large."""


@dataclass(frozen=True)
class Thing:
    """A polygon, a point or a sphere that lights or darkens: its corners, width and area; ``piece`` or -1.

    A sphere is its centre and its ``radius``.
    """

    corners: Array
    width: float
    area: float
    piece: int
    radius: float = 0.0


def pieces_of(world: World) -> list[Thing]:
    """All pieces."""
    return [thing_of(piece, j) for j, piece in enumerate(world.pieces)]


def lamps(world: World) -> list[Thing]:
    """What emits, points too; under a sky all pieces, which take of its light wherever they are near."""
    owners = np.asarray(world.pieces["owner"]).astype(int)
    found = []
    for light in world.lights:
        if light.kind in (POINT, SPOT):
            found.append(Thing(np.array([light.place]), 0.0, 0.0, -1))
        elif light.kind == AREA:
            shining = np.flatnonzero(owners == int(light.emitter)).tolist()
            found += [thing_of(world.pieces[j], j) for j in shining]
        elif light.kind == SKY:
            found += pieces_of(world)
    return found


def thing_of(piece: Piece, index: int) -> Thing:
    """A piece, of the number ``index``, as what is near a cell."""
    if piece.kind == SPHERE:
        size = float(piece.radius)
        return Thing(np.array([piece.place]), 2.0 * size, float(np.pi) * size * size, index, size)
    corners = corners_of(piece)
    fan = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
    area = 0.5 * float(np.sqrt(fan @ fan))
    longest = max(float(np.sqrt(((corners - corner) ** 2).sum(axis=1)).max()) for corner in corners)
    return Thing(corners, area / longest, area, index)


def distances(places: Array, corners: Array) -> Array:
    """(N,) distances of places from a convex polygon or a point."""
    if len(corners) == 1:
        return np.asarray(np.sqrt(((places - corners[0]) ** 2).sum(axis=1)))
    up = np.cross(corners[1] - corners[0], corners[-1] - corners[0])
    up /= np.sqrt(up @ up)
    heights = (places - corners[0]) @ up
    flat = places - heights[:, None] * up
    beside, inside = np.full(len(places), np.inf), np.ones(len(places), dtype=bool)
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        edge = q - p
        share = np.clip((flat - p) @ edge / (edge @ edge), 0.0, 1.0)
        beside = np.minimum(beside, np.sqrt(((p + share[:, None] * edge - flat) ** 2).sum(axis=1)))
        inside &= (flat - p) @ np.cross(up, edge) >= 0.0
    return np.asarray(np.hypot(heights, np.where(inside, 0.0, beside)))


def too_large(things: list[Thing], quads: Quads, frames: Frames) -> tuple[npt.NDArray[np.bool_], Array]:
    """(whether a cell is too large for a thing near it, the part of its area that such things may cover) (N,)."""
    large, covered = np.zeros(len(quads), dtype=bool), np.zeros(len(quads))
    for thing in things:
        gap = np.maximum(distances(frames.middle, thing.corners) - thing.radius - frames.reach, 0.0)
        some = (frames.reach > _LARGE * np.maximum(thing.width, gap)) & (quads.face != thing.piece)
        large |= some
        # within its own size of a thing light changes by as much as there is
        size = thing.area + np.pi * gap**2
        covered += np.where(some, np.minimum(1.0, size / np.maximum(frames.area, 1e-300)), 0.0)
    return large, np.minimum(covered, 1.0)
