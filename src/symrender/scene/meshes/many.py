"""Questions about all triangles of a mesh at once, as ``directions.py`` answers them one by one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from symrender.limits import MIN_LENGTH
from symrender.scene.directions import PARALLEL

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def flat_ones(corners: Array) -> npt.NDArray[np.bool_]:
    """Which of the triangles (n, 3, 3) have no area in double precision."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    w = corners[:, 2] - corners[:, 1]
    short = np.min([np.abs(edge).max(axis=1) for edge in (u, v, w)], axis=0) < MIN_LENGTH
    with np.errstate(invalid="ignore", divide="ignore"):
        units = []
        for edge in (u, v, w):
            edge = edge / np.abs(edge).max(axis=1, keepdims=True)
            units.append(edge / np.sqrt((edge**2).sum(axis=1, keepdims=True)))
        one, other = (np.cross(units[0], each) for each in units[1:])
        thin = np.minimum((one**2).sum(axis=1), (other**2).sum(axis=1)) < PARALLEL**2
    return np.asarray(short | thin)


def first_alike(vertices: Sequence[Sequence[float]], faces: Ints) -> Ints:
    """(n,) the first of the triangles that have the same corners, of equal places, in whatever order."""
    # zeros of both signs are equal
    names = np.unique(np.array(vertices) + 0.0, axis=0, return_inverse=True)[1].reshape(-1)
    _, first, which = np.unique(np.sort(names[faces], axis=1), axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[which.reshape(-1)], dtype=np.int64)


def sound(vertices: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]) -> bool:
    """Whether triangles name vertices that there are, have an area each, and no two of them lie in each other."""
    own = np.array(faces, dtype=np.int64)
    if own.max() >= len(vertices):
        return False
    alike = first_alike(vertices, own)
    return bool((alike == np.arange(len(own))).all()) and not flat_ones(np.array(vertices)[own]).any()
