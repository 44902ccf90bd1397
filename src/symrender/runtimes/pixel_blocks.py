"""Means over pixels of squares that no curve enters, of one polynomial a square.

What nodes of a square see is interpolated; its means over the pixels of the square are theirs. The last coefficients
say what is missed, as the difference from the polynomial of one degree less, and ones before them that the last are
not small by chance. What is not known well enough so is left to the pixels themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.radiometric.pixels import blocks as kernels
from symrender.radiometric.pixels.cells import Eye
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.vectors import Array

Ints = npt.NDArray[np.int64]
Tile = tuple[int, int, int, int]

SQUARES: Final = ((8, 8), (4, 6), (4, 8), (2, 6))
"""Sides of squares, in pixels, and how many nodes they take along each, in the order in which they are tried."""
BLOCK: Final = 8
"""Side of the largest square."""
INNER: Final = 0.3
"""Part of the tolerance that single rays take."""
_SHARES: Final = (1.0, 0.3, 0.09)
"""Parts of the coefficients of the last degree, of that before it, and so on, that polynomials may miss: those of a
kink wander about what they fall to."""
_FALL: Final = 0.3
"""What coefficients fall by from one degree to the next, about."""
_HOPE: Final = 0.4
"""Part of the tolerance that a square may be expected to miss for it to be tried."""
_DENSE: Final = 2.5
"""Nodes along a side over which those of a rule are as far apart at most as two in a cell of this part of it."""


@dataclass(frozen=True)
class Rule:
    """Of one side of a square: ``nodes`` (n,) on [0, 1], ``means`` (side, n) over its pixels, ``series`` (n, n) the
    coefficients in Legendre's polynomials, from what nodes see."""

    nodes: Array
    means: Array
    series: Array


@lru_cache(maxsize=8)
def rule_of(side: int, order: int) -> Rule:
    """The rule of ``order`` Gauss nodes for ``side`` pixels."""
    x, w = np.polynomial.legendre.leggauss(order)
    powers = np.polynomial.legendre.legvander(x, order - 1)
    series = (powers * w[:, None]).T * (np.arange(order)[:, None] + 0.5)
    ends = np.linspace(-1.0, 1.0, side + 1)
    wholes = [np.polynomial.legendre.Legendre.basis(k).integ()(ends) for k in range(order)]
    means = np.diff(np.array(wholes), axis=1).T * (0.5 * side) @ series
    return Rule(0.5 * (x + 1.0), means, series)


@dataclass(frozen=True)
class Picture:
    """An image as squares take it: what ``pixel_parts.Canvas`` says of it, and the scratch of a thread."""

    eye: Eye
    window: Array
    width: int
    height: int
    room: Room
    candidates: Ints


@dataclass
class Known:
    """Of the pixels of a tile, row by row: ``values`` (N, C), ``error``, ``status``, ``evaluations`` and whether each
    is ``known`` (N,). What was spent on those that are not known stands there too.

    ``fall`` (N,) are the coefficients of the last degree of the square that a pixel was tried in last, ``tried`` its
    side, 0 where there was none, and ``nodes`` how many it had along that.
    """

    values: Array
    error: Array
    status: Ints
    evaluations: Ints
    known: npt.NDArray[np.bool_]
    fall: Array
    tried: Ints
    nodes: Ints

    @classmethod
    def nothing(cls, count: int, channels: int) -> Known:
        """Of pixels that no square was tried for."""
        status, spent, tried, nodes = (np.zeros(count, np.int64) for _ in range(4))
        values, known = np.zeros((count, channels)), np.zeros(count, np.bool_)
        return cls(values, np.zeros(count), status, spent, known, np.zeros(count), tried, nodes)

    def promising(self, side: int, order: int, tol: float) -> npt.NDArray[np.bool_]:
        """(N,) whether pixels are not known and what they were tried in last does not say that this square is vain."""
        share = side / np.maximum(self.tried, side)
        fall = self.fall * share ** (np.minimum(self.nodes, order) - 1.0) * _FALL ** np.maximum(order - self.nodes, 0)
        return np.asarray(~self.known & (fall <= _HOPE * tol))


Seen = Callable[[Array, Array], tuple[Array, Array, Ints, Ints]]
"""What places of the image, columns and rows, show: (values (N, C), error, status, evaluations)."""


def block_means(
    picture: Picture, tile: Tile, look: Seen, tol: float, channels: int, slow: float = 1.0
) -> Known:  # fmt: skip
    """Means over the pixels of a tile that lie in smooth squares, each to ``tol``.

    ``slow`` is how many times what polynomials are seen to miss they are taken to. Squares lie at multiples of their
    side of the image, and all of one is done wherever a tile ends, so that no tile changes a byte.
    """
    x0, y0, x1, y1 = tile
    found = Known.nothing((x1 - x0) * (y1 - y0), channels)
    for side, order in SQUARES:
        corners = _corners(picture, tile, side, found.promising(side, order, tol))
        if not len(corners):
            continue
        smooth = np.zeros(len(corners), np.int64)
        _kernel()(
            picture.eye, picture.window, picture.width, picture.height, corners, side, order / _DENSE, picture.room,
            picture.candidates, smooth,
        )  # fmt: skip
        corners = corners[smooth == 1]
        if len(corners):
            _fill(tile, corners, rule_of(side, order), look, tol, slow, found)
    return found


def _corners(picture: Picture, tile: Tile, side: int, wanted: npt.NDArray[np.bool_]) -> Ints:
    """Columns and rows of the squares of the image with a pixel of the tile that is wanted."""
    x0, y0, x1, y1 = tile
    columns, rows = np.arange(x0, x1) // side, np.arange(y0, y1) // side
    which = np.flatnonzero(wanted)
    pairs = np.column_stack([np.tile(columns, y1 - y0)[which], np.repeat(rows, x1 - x0)[which]])
    squares = np.unique(pairs, axis=0) * side if len(which) else pairs
    inside = (squares[:, 0] + side <= picture.width) & (squares[:, 1] + side <= picture.height)
    return np.ascontiguousarray(squares[inside], np.int64)


def _fill(tile: Tile, corners: Ints, rule: Rule, look: Seen, tol: float, slow: float, found: Known) -> None:
    """Let nodes of squares be looked at, and write what is known well enough."""
    x0, y0, x1, y1 = tile
    count, (side, order) = len(corners), rule.means.shape
    across = np.tile(side * rule.nodes, count * order) + np.repeat(corners[:, 0], order**2)
    down = np.tile(np.repeat(side * rule.nodes, order), count) + np.repeat(corners[:, 1], order**2)
    values, error, status, spent = look(across, down)
    light = values.reshape(count, order, order, -1)
    fall = falls(np.einsum("ai,bj,njic->nbac", rule.series, rule.series, light))
    beyond = slow * missed(fall)
    means = np.einsum("pi,qj,njic->nqpc", rule.means, rule.means, light)
    size = np.abs(rule.means)
    off = np.where(np.isfinite(error), error, 1e300).reshape(count, order, order)
    off = beyond[:, None, None] + np.einsum("pi,qj,nji->nqp", size, size, off)
    worst, spent = status.reshape(count, -1).max(axis=1), spent.reshape(count, -1).sum(axis=1)
    for n, (left, top) in enumerate(corners.tolist()):
        rows, columns = np.arange(max(top, y0), min(top + side, y1)), np.arange(max(left, x0), min(left + side, x1))
        which = ((rows[:, None] - y0) * (x1 - x0) + columns - x0).ravel()
        inside = np.ix_(rows - top, columns - left)
        found.evaluations[which] += -(-spent[n] // side**2)
        found.fall[which], found.tried[which], found.nodes[which] = fall[n, -1], side, order
        # of a square all pixels or none, whichever of them the tile has
        if np.isfinite(means[n]).all() and off[n].max() <= tol:
            found.values[which] = means[n][inside].reshape(len(which), -1)
            found.error[which], found.status[which], found.known[which] = off[n][inside].ravel(), worst[n], True


def falls(series: Array) -> Array:
    """(N, n) sizes of all coefficients (N, n, n, C) of one degree along a side and no more along the other, the largest
    of the channels."""
    sizes = np.abs(series)
    every = [sizes[:, k, : k + 1].sum(axis=1) + sizes[:, :k, k].sum(axis=1) for k in range(sizes.shape[1])]
    return np.stack([each.max(axis=1) for each in every], axis=1)


def missed(fall: Array) -> Array:
    """(N,) what polynomials with coefficients of these sizes, by their degree, may miss."""
    return np.asarray(np.max([share * fall[:, -1 - k] for k, share in enumerate(_SHARES)], axis=0))


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that tells smooth squares."""
    # the kernel only borrows arrays; counting references to them would cost more than the arithmetic
    return compiled(kernels.smooth_blocks, _nrt=False)
