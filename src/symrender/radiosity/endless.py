"""Planes as nets of triangles: squares about the middle of a scene, each ``GROWTH`` times as wide as the one within.

Tables hold what faces send on cells, and a plane has no end. Beyond the last square, ``WIDTH`` times as far out as
anything else of the scene, it is left out: what a place at a height h above the plane, so far from the middle as h
itself, sees of the rest is a share of some h over the half-width, of the brightest that anything sends there.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from symrender.jit.records import copied, flat, table
from symrender.radiometric.vectors import Array
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import MESH, SPHERE, RadiometricArrays
from symrender.scene.radiometric.records import Facet

GROWTH: Final = 6.0
RINGS: Final = 7
WIDTH: Final = GROWTH**RINGS
"""Half-width of the last square, in parts of that of the first, which holds the scene."""


def has_planes(arrays: RadiometricArrays) -> bool:
    """Whether some shape has no end."""
    return any(shape.kind == PLANE for shape in arrays.shapes)


def middle_of(arrays: RadiometricArrays) -> tuple[Array, float]:
    """(middle, half-width of a cube about it) of all shapes with an end, and of lights that have a place."""
    places = []
    for shape in arrays.shapes:
        if shape.kind == SPHERE:
            places += [shape.place - shape.radius, shape.place + shape.radius]
        elif shape.kind == MESH:
            corners = flat(arrays.facets)[int(shape.start) : int(shape.start + shape.faces)].reshape(-1, 3)
            reach = shape.radius * float(np.sqrt((corners**2).sum(axis=1)).max())
            places += [shape.place - reach, shape.place + reach]
        elif shape.kind != PLANE:
            # of a box its size, of others two edges or vertices
            size = np.sqrt((shape.second**2).sum()) + np.sqrt((shape.third**2).sum())
            places += [shape.place - size, shape.place + size, shape.second, shape.third] if size else [shape.place]
    low, high = np.min(places, axis=0), np.max(places, axis=0)
    return 0.5 * (low + high), 0.5 * float((high - low).max())


def netted(arrays: RadiometricArrays) -> RadiometricArrays:
    """The scene with a net of triangles in the place of every plane."""
    if not has_planes(arrays):
        return arrays
    middle, half = middle_of(arrays)
    shapes, nets = copied(arrays.shapes), [flat(arrays.facets).reshape(-1, 9)]
    start = len(arrays.facets)
    for shape, frame in zip(shapes, arrays.frames, strict=True):
        if shape.kind != PLANE:
            continue
        height = float((middle - frame.origin) @ frame.up)
        foot = middle - height * np.asarray(frame.up)
        net = _net(foot, np.asarray(frame.east), np.asarray(frame.north), 2.0 * (half + abs(height)))
        shape.kind, shape.place[:], shape.radius, shape.rotation = MESH, 0.0, 1.0, 0.0
        shape.start, shape.faces = start, len(net)
        start += len(net)
        nets.append(net)
    facets = table(Facet, start)
    flat(facets)[:] = np.concatenate(nets).reshape(flat(facets).shape)
    return replace(arrays, shapes=shapes, facets=facets)


def _net(foot: Array, east: Array, north: Array, half: float) -> Array:
    """(N, 9) triangles of the squares about ``foot``, counter-clockwise about the normal."""
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    rings = [
        foot + half * GROWTH**k * (signs[:, :1] * east + signs[:, 1:] * north) for k in range(RINGS + 1)
    ]  # fmt: skip
    found = [[rings[0][0], rings[0][1], rings[0][2]], [rings[0][0], rings[0][2], rings[0][3]]]
    for inner, outer in pairwise(rings):
        for k in range(4):
            m = (k + 1) % 4
            found += [[outer[k], outer[m], inner[m]], [outer[k], inner[m], inner[k]]]
    return np.array(found).reshape(len(found), 9)


def beyond(arrays: RadiometricArrays, places: Array) -> Array:
    """(N,) most that places see of what is left out, as a share of all they see; 1 where they lie there themselves."""
    if not has_planes(arrays):
        return np.zeros(len(places))
    middle, half = middle_of(arrays)
    away = np.sqrt(((places - middle) ** 2).sum(axis=1)) + half
    found = np.zeros(len(places))
    for shape, frame in zip(arrays.shapes, arrays.frames, strict=True):
        if shape.kind == PLANE:
            reach = 2.0 * WIDTH * (half + abs(float((middle - frame.origin) @ frame.up)))
            found += np.where(away < 0.01 * reach, 4.0 * away / reach, 1.0)
    return np.minimum(found, 1.0)
