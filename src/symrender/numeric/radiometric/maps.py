"""Maps of all directions: charts of the sphere, and the sums by which directions are chosen of an image."""

from __future__ import annotations

import math

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.vectors import Vector
from symrender.scene.arrays import Array
from symrender.scene.radiometric.detail import BILINEAR, CORNERS, EQUAL_AREA, NEAREST, Picture


@inlined
def luminance(c: Vector) -> float:
    """Luminance of a colour of sRGB's primaries."""
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]


@inlined
def polar(way: Vector) -> float:
    """The angle of a direction of a map from its zenith."""
    return math.atan2(math.sqrt(way[0] * way[0] + way[1] * way[1]), way[2])


@jitable
def square_of(way: Vector) -> tuple[float, float]:
    """The place in the unit square of a direction (P. Clarberg, "Fast equal-area mapping of the (hemi)sphere")."""
    x, y, z = abs(way[0]), abs(way[1]), abs(way[2])
    r = math.sqrt((x * x + y * y) / (1.0 + z))
    share = 2.0 / math.pi * math.atan2(y, x) if r > 0.0 else 0.0
    v = share * r
    u = r - v
    if way[2] < 0.0:
        u, v = 1.0 - v, 1.0 - u
    return 0.5 * (math.copysign(u, way[0]) + 1.0), 0.5 * (math.copysign(v, way[1]) + 1.0)


@jitable
def way_of(p: float, q: float) -> Vector:
    """The direction of a place in the unit square."""
    u, v = 2.0 * p - 1.0, 2.0 * q - 1.0
    rest = 1.0 - (abs(u) + abs(v))
    r = 1.0 - abs(rest)
    angle = ((abs(v) - abs(u)) / r + 1.0) * math.pi / 4.0 if r > 0.0 else 0.0
    wide = r * math.sqrt(2.0 - r * r)
    return (
        math.copysign(math.cos(angle) * wide, u),
        math.copysign(math.sin(angle) * wide, v),
        math.copysign(1.0 - r * r, rest),
    )


@inlined
def row_step(picture: Picture) -> float:
    """The angle between two rows of a map by longitude and latitude."""
    return math.pi / (picture.high - 1.0 if picture.grid == CORNERS else picture.high)


@inlined
def row_shift(picture: Picture) -> float:
    """Where the first band of rows that are interpolated alike begins, in rows before the zenith."""
    return 0.5 if (picture.grid == CORNERS) == (picture.filter == NEAREST) else 0.0


@inlined
def band_edges(picture: Picture, k: float) -> tuple[float, float]:
    """The polar angles between which a band lies."""
    step, shift = row_step(picture), row_shift(picture)
    return max(0.0, (k - shift) * step), min(math.pi, (k + 1.0 - shift) * step)


@inlined
def band_share(low: float, high: float) -> float:
    """The difference of the cosines of two angles."""
    return 2.0 * math.sin(0.5 * (low + high)) * math.sin(0.5 * (high - low))


@jitable
def chosen_cell(sums: Array, x: float) -> int:
    """The k for which sums[k] <= x < sums[k + 1]; sums rise from 0."""
    low, high = 0, sums.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if sums[middle] <= x:
            low = middle
        else:
            high = middle
    return low


@inlined
def linear_place(a: float, first: float, last: float) -> float:
    """A place in [0, 1] by a number of [0, 1), the density of which goes from ``first`` to ``last``."""
    size = first + math.sqrt(first * first + a * (last * last - first * first))
    return min(a * (first + last) / size, 1.0) if size > 0.0 else a


def sky_tables(picture: Picture, texels: Array) -> tuple[Array, Array]:
    """Sums, over bands and over the columns of each, of luminance times solid angle."""
    wide, high, start = int(picture.wide), int(picture.high), int(picture.start)
    level = (texels[start : start + wide * high] @ np.array([0.2126, 0.7152, 0.0722])).reshape(high, wide)
    if picture.filter == BILINEAR:
        across = 0.5 * (level + np.roll(level, -1, axis=1))
        rows = across if picture.grid == CORNERS else np.concatenate([across[:1], across, across[-1:]])
        level = 0.5 * (rows[:-1] + rows[1:])
    if picture.grid == EQUAL_AREA:
        shares = np.ones(high)
    else:
        edges = [band_edges(picture, float(k)) for k in range(len(level))]
        shares = np.array([band_share(*pair) for pair in edges])
    columns = np.concatenate([np.zeros((len(level), 1)), np.cumsum(level, axis=1)], axis=1)
    return np.concatenate([[0.0], np.cumsum(shares * columns[:, -1])]), columns
