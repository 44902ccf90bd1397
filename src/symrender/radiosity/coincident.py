"""Faces that lie in one plane and overlap: which of them is seen is not decided by the scene."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.radiometric.pieces import CORNERS, POLYGON, Piece, owners
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import TOUCH, corners_of
from symrender.scene.radiometric.arrays import DISK, SPHERE, RadiometricArrays

_PARALLEL: Final = 0.5
"""Cosine between normals from which faces may lie in one plane: of needles normals are rounded."""
_LEAST: Final = 1e-9
"""Area, in parts of the smaller face's, up to which faces do not overlap."""


def coincident(arrays: RadiometricArrays, world: World) -> tuple[int, int] | None:
    """Two shapes, or one twice, of which faces in one plane overlap and are seen, None where there are none.

    A face of a box or of a closed mesh against another's is not seen, and one that stands on a face is not if nothing
    is behind that.
    """
    disks = np.array([shape.kind == DISK for shape in arrays.shapes])
    for i, j in _pairs(world, disks):
        a, b = world.pieces[i], world.pieces[j]
        if not _in_one_plane(a, b) or not _overlap(a, b):
            continue
        if float(a.up @ b.up) < 0.0:
            bodies = [each.solid != 0.0 or each.reach > 0.0 for each in (a, b)]
            if all(bodies) or (any(bodies) and not _is_seen_behind(world, b if bodies[0] else a)):
                continue
        return int(a.owner), int(b.owner)
    return None


def _pairs(world: World, disks: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Pairs of polygons whose bounds meet and whose normals are about parallel: no others lie in one plane.

    Those of the net of one of the shapes that are ``disks`` overlap nowhere.
    """
    some = np.flatnonzero(np.asarray(world.pieces["kind"]) == POLYGON)
    ups, counts = np.asarray(world.pieces["up"])[some], np.asarray(world.pieces["count"])[some]
    corners = np.asarray(world.pieces["corners"])[some].reshape(-1, CORNERS, 3)
    inside = (np.arange(corners.shape[1]) < counts[:, None])[..., None]
    size = TOUCH * np.abs(corners).max(initial=0.0)
    low, high = np.where(inside, corners, np.inf).min(axis=1), np.where(inside, corners, -np.inf).max(axis=1)
    belongs = owners(world.pieces)[some]
    found = []
    for k in range(len(some)):
        near = (low[:k] <= high[k] + size).all(axis=1) & (high[:k] >= low[k] - size).all(axis=1)
        apart = (belongs[:k] != belongs[k]) | ~disks[belongs[k]]
        for i in np.flatnonzero(near & apart & (np.abs(ups[:k] @ ups[k]) > _PARALLEL)).tolist():
            found.append((int(some[i]), int(some[k])))
    return found


def _size(*pieces: Piece) -> float:
    return float(max(np.abs(corners_of(piece)).max() for piece in pieces))


def _in_one_plane(a: Piece, b: Piece) -> bool:
    heights = (corners_of(b) - a.place) @ a.up
    return bool(np.abs(heights).max() <= TOUCH * _size(a, b))


def _is_seen_behind(world: World, face: Piece) -> bool:
    """Whether a corner of any piece is behind a face."""
    for piece in world.pieces:
        if piece.kind == SPHERE:
            low, size = float((piece.place - face.place) @ face.up) - piece.radius, np.abs(piece.place).max()
        else:
            low, size = float(((corners_of(piece) - face.place) @ face.up).min()), _size(face, piece)
        if low < -TOUCH * size:
            return True
    return False


def _overlap(a: Piece, b: Piece) -> bool:
    """Whether two polygons of one plane share an area."""
    part = corners_of(b)
    corners = corners_of(a)
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        across = np.cross(a.up, q - p)
        heights = (part - p) @ across / np.sqrt(across @ across)
        kept: list[Array] = []
        for u, v, g, h in zip(part, np.roll(part, -1, axis=0), heights, np.roll(heights, -1), strict=True):
            if g >= 0.0:
                kept.append(u)
            if g * h < 0.0:
                kept.append(u + g / (g - h) * (v - u))
        if len(kept) < 3:
            return False
        part = np.array(kept)
    return _area(part) > _LEAST * min(_area(corners), _area(corners_of(b)))


def _area(corners: Array) -> float:
    edges = corners[1:] - corners[0]
    crossed = np.cross(edges[:-1], edges[1:]).sum(axis=0)
    return 0.5 * float(np.sqrt(crossed @ crossed))
