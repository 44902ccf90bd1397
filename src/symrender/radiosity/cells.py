"""Cells as arrays: where they are sampled, the cubics through the samples, how they are cut."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from symrender.radiometric.vectors import Array
from symrender.radiosity.records import CHANNELS, TERMS, Ints

_LEGENDRE: Final = np.polynomial.legendre.leggauss(4)
_GAUSS: Final = 0.5 + 0.5 * _LEGENDRE[0]
_CHECKED: Final = np.array([0.02, 0.5, 0.98])
NODES: Final = 16
"""Places at which a cell is sampled for its cubic; the others are for checking it alone."""
PLACES: Final = NODES + 9
EVEN: Final = 0.25
"""The most that deviations come to on a mean, in parts of the largest."""
PASSED: Final = 0.08
"""What they may come to where rules tell nothing of it, in parts of the largest."""
_STEEP: Final = 3.0
"""Ratio of its sides from which a cell is halved across the longer one."""
_SLIVER: Final = 1e-9
"""Distance from a line, in parts of a cell's size, within which the line does not cut it."""
_ONE: Final = 1e-12
"""Distance in the same parts within which corners are one, or lie on a line."""


@dataclass(frozen=True)
class Quads:
    """N cells: ``face`` and ``side``, ``count`` of corners, ``corners`` (N, 4, 3), the last of a triangle twice."""

    face: Ints
    side: Array
    count: Ints
    corners: Array

    def __len__(self) -> int:
        return len(self.face)

    def some(self, which: Ints) -> Quads:
        """Those of ``which``."""
        return Quads(self.face[which], self.side[which], self.count[which], self.corners[which])


def joined(parts: list[Quads]) -> Quads:
    """All of them, in order."""
    return Quads(
        np.concatenate([part.face for part in parts]), np.concatenate([part.side for part in parts]),
        np.concatenate([part.count for part in parts]), np.concatenate([part.corners for part in parts]),
    )  # fmt: skip


def sampled_places(quads: Quads) -> Array:
    """(N, PLACES, 3): the places of every cell at which it is sampled."""
    s, t = _square_places().T
    weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
    return np.asarray(np.einsum("pk,nkc->npc", weights, quads.corners))


@dataclass(frozen=True)
class Frames:
    """Variables of N cells: ``middle``, ``across`` and ``along`` (N, 3), ``reach`` and ``area`` (N,)."""

    middle: Array
    across: Array
    along: Array
    reach: Array
    area: Array

    def some(self, which: Ints) -> Frames:
        """Those of ``which``."""
        return Frames(*(each[which] for each in (self.middle, self.across, self.along, self.reach, self.area)))


def frames_of(quads: Quads, ups: Array) -> Frames:
    """Variables of cells; ``ups`` (N, 3) are the normals of their faces."""
    corners = quads.corners
    last = np.where(quads.count == 3, 2, 3)
    middle = corners[:, :3].sum(axis=1) + np.where(quads.count[:, None] == 4, corners[:, 3], 0.0)
    middle /= quads.count[:, None]
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.argmax((edges**2).sum(axis=2), axis=1)
    first = edges[np.arange(len(quads)), longest]
    first /= np.sqrt((first**2).sum(axis=1, keepdims=True))
    second = np.cross(ups, first)
    away = corners - middle[:, None]
    scales = [np.abs(np.einsum("nkc,nc->nk", away, e)).max(axis=1, keepdims=True) for e in (first, second)]
    # a sliver without width has a variable across it all the same
    scales[1] = np.maximum(scales[1], _SLIVER * scales[0])
    diagonal, other = corners[:, 2] - corners[:, 0], corners[np.arange(len(quads)), last] - corners[:, 1]
    crossed = np.cross(diagonal, other)
    area = 0.5 * np.sqrt((crossed**2).sum(axis=1))
    return Frames(middle, first / scales[0], second / scales[1], np.sqrt((away**2).sum(axis=2)).max(axis=1), area)


def monomials(frames: Frames, places: Array) -> Array:
    """(N, P, TERMS): the terms of a cubic at places (N, P, 3)."""
    away = places - frames.middle[:, None]
    u, v = np.einsum("npc,nc->np", away, frames.across), np.einsum("npc,nc->np", away, frames.along)
    one = np.ones_like(u)
    return np.stack([one, u, v, u * u, u * v, v * v, u**3, u * u * v, u * v * v, v**3], axis=-1)


def node_weights(quads: Quads) -> Array:
    """(N, NODES): what the places of a cell that are nodes weigh in a mean over its area."""
    pairs = np.stack(np.meshgrid(_GAUSS, _GAUSS, indexing="ij"), axis=-1).reshape(-1, 2)
    s, t = pairs[:, :1], pairs[:, 1:]
    c = quads.corners[:, :, None]
    by_s = (1 - t) * (c[:, 1] - c[:, 0]) + t * (c[:, 2] - c[:, 3])
    by_t = (1 - s) * (c[:, 3] - c[:, 0]) + s * (c[:, 2] - c[:, 1])
    crossed = np.cross(by_s, by_t)
    weights = np.outer(_LEGENDRE[1], _LEGENDRE[1]).ravel() * np.sqrt((crossed**2).sum(axis=2))
    # a cell without an area has nodes that weigh alike
    return np.asarray(weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-300) + 1e-9)


def fitting(powers: Array, weights: Array) -> Array:
    """(N, TERMS, NODES): what makes terms of samples at nodes.

    By least squares with the weights of Gauss's rule, so that what is left has by this rule no mean, times any cubic.
    """
    roots = np.sqrt(weights)[:, None]
    return np.asarray(np.linalg.pinv(powers[:, :NODES] * roots.transpose(0, 2, 1), rcond=1e-9) * roots)


def deviations(powers: Array, fit: Array, left: Array) -> tuple[Array, Array, Array]:
    """(largest, mean modulus, what they come to on a mean with cubics about 1) (N,) of ``left`` (N, PLACES, CHANNELS).

    The mean modulus is the larger of those at nodes and at the other places. The last is what by Gauss's rule is a
    cubic, all its terms, twice what another rule of degree 4 finds beside it, and, for what passes both, ``PASSED`` of
    the largest; but no more than ``EVEN`` of it beside the cubic.
    """
    sizes = np.abs(left)
    most = sizes.max(axis=(1, 2), initial=0.0)
    bulk = np.maximum(
        np.einsum("p,npc->nc", _NODES_WEIGH, sizes[:, :NODES]), np.einsum("p,npc->nc", _CHECKED_WEIGH, sizes[:, NODES:])
    ).max(axis=1, initial=0.0)
    cubic = fit @ left[:, :NODES]
    low = np.abs(cubic).sum(axis=1).max(axis=1, initial=0.0)
    rest = left - powers @ cubic
    other = np.abs(np.einsum("p,npc->nc", _OTHER, rest)).max(axis=1, initial=0.0)
    return most, bulk, np.minimum(most, low + np.minimum(EVEN * most, PASSED * most + 2.0 * other))


def _other_rule() -> Array:
    """(PLACES,): a rule of all places, exact for polynomials of degree 4 on a square, less Gauss's."""
    s, t = 2.0 * _square_places().T - 1.0
    pairs = [(i, j) for i in range(5) for j in range(5 - i)]
    means = np.array([0.0 if i % 2 or j % 2 else 1.0 / ((i + 1) * (j + 1)) for i, j in pairs])
    rule = np.linalg.lstsq(np.array([s**i * t**j for i, j in pairs]), means, rcond=None)[0]
    rule[:NODES] -= _NODES_WEIGH
    return np.asarray(rule)


def _simpson() -> Array:
    """(PLACES - NODES,): what places that are no nodes weigh in a mean over a square, as in Simpson's rule."""
    return np.outer([1.0, 4.0, 1.0], [1.0, 4.0, 1.0]).ravel() / 36.0


def _square_places() -> Array:
    """(PLACES, 2): where cells are sampled, in the unit square."""
    pairs = [np.stack(np.meshgrid(one, one, indexing="ij"), axis=-1).reshape(-1, 2) for one in (_GAUSS, _CHECKED)]
    return np.concatenate(pairs)


_NODES_WEIGH: Final = 0.25 * np.outer(_LEGENDRE[1], _LEGENDRE[1]).ravel()
_CHECKED_WEIGH: Final = _simpson()
_OTHER: Final = _other_rule()


def constants(values: Array) -> Array:
    """(N, CHANNELS, TERMS): cubics that are constant."""
    terms = np.zeros((*values.shape, TERMS))
    terms[..., 0] = values
    return terms


def halves(quads: Quads, values: Array) -> tuple[Quads, Quads]:
    """Both halves of every cell, cut across its longer side or, where none is, across that along which it is rougher.

    ``values`` (N, PLACES, CHANNELS) are its samples. A triangle is cut from the middle of its longest edge.
    """
    c = quads.corners.copy()
    grid = values[:, :NODES].reshape(-1, 4, 4, CHANNELS)
    rough_s = np.abs(np.diff(grid, 2, axis=1)).max(axis=(1, 2, 3), initial=0.0)
    rough_t = np.abs(np.diff(grid, 2, axis=2)).max(axis=(1, 2, 3), initial=0.0)
    lengths = np.sqrt(((np.roll(c, -1, axis=1) - c) ** 2).sum(axis=2))
    long_s, long_t = np.maximum(lengths[:, 0], lengths[:, 2]), np.maximum(lengths[:, 1], lengths[:, 3])
    across_s = np.where(long_s > _STEEP * long_t, True, np.where(long_t > _STEEP * long_s, False, rough_s >= rough_t))
    three = quads.count == 3
    if three.any():
        edges = np.where(three[:, None], lengths, 0.0)[:, [0, 1, 3]]
        # corners turned so that the longest edge of a triangle leads from its first to its second
        turn = np.argmax(edges, axis=1)
        turned = np.stack([c[np.arange(len(c)), (turn + k) % 3] for k in range(3)], axis=1)
        c[three, :3], c[three, 3] = turned[three], turned[three, 2]
        across_s = across_s | three
    c[~across_s] = np.roll(c[~across_s], -1, axis=1)
    low, high = 0.5 * (c[:, 0] + c[:, 1]), np.where(three[:, None], c[:, 2], 0.5 * (c[:, 2] + c[:, 3]))
    one = np.stack([c[:, 0], low, high, np.where(three[:, None], high, c[:, 3])], axis=1)
    two = np.stack([low, c[:, 1], c[:, 2], high], axis=1)
    return (
        Quads(quads.face, quads.side, quads.count, one),
        Quads(quads.face, quads.side, quads.count, two),
    )


def cut_along(corners: Array, segment: Array, up: Array) -> list[Array] | None:
    """Convex parts (n, 3) of a convex polygon on both sides of a segment's line; None where the segment misses it."""
    a, b = segment
    way = b - a
    across = np.cross(up, way)
    size = np.sqrt(max(float(across @ across), 1e-300))
    # from the nearer end, for the other may be so far away that all is rounding
    near = min((a, b), key=lambda end: float(((end - corners[0]) ** 2).sum()))
    heights = (corners - near) @ across / size
    extent = float(np.sqrt(((corners - corners.mean(axis=0)) ** 2).sum(axis=1).max()))
    if heights.max() <= _SLIVER * extent or heights.min() >= -_SLIVER * extent:
        return None
    # the line bends through corners that lie on it but for roundings: nothing is lost
    heights[np.abs(heights) <= _ONE * extent] = 0.0
    signs = np.sign(heights[heights != 0.0])
    if (signs != np.roll(signs, 1)).sum() > 2:
        # a needle whose sides cross but for roundings
        return None
    sides: tuple[list[Array], list[Array]] = ([], [])
    met = []
    for p, q, g, h in zip(corners, np.roll(corners, -1, axis=0), heights, np.roll(heights, -1), strict=True):
        if g >= 0.0:
            sides[0].append(p)
        if g <= 0.0:
            sides[1].append(p)
        if g == 0.0:
            met.append(p)
        if g * h < 0.0:
            place = p + g / (g - h) * (q - p)
            sides[0].append(place)
            sides[1].append(place)
            met.append(place)
    along = [float((place - a) @ way) for place in met]
    length = float(way @ way)
    if not met or max(along) <= 0.0 or min(along) >= length:
        return None
    return [part for part in (_distinct(np.array(each), _ONE * extent) for each in sides) if len(part) > 2]


def _distinct(corners: Array, size: float) -> Array:
    """Corners of a polygon but for those that lie within ``size`` of the one before."""
    steps = corners - np.roll(corners, 1, axis=0)
    return np.asarray(corners[(steps**2).sum(axis=1) > size * size])
