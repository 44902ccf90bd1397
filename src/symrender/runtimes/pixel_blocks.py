"""Means over pixels of squares that no curve enters, of one polynomial a square.

What nodes of a square see is interpolated; its means over the pixels of the square are theirs. The last coefficients
say what is missed, as the difference from the polynomial of one degree less, and ones before them that the last are
not small by chance. What is not known well enough so is left to the pixels themselves.
"""

from __future__ import annotations

import math
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

SQUARES: Final = (
    (8, 8), (8, 10), (8, 12), (4, 6), (8, 14), (4, 8), (8, 16), (8, 18), (4, 10), (4, 12), (2, 6), (2, 8),
)  # fmt: skip
"""Sides of squares, in pixels, and how many nodes they take along each, in the order in which they are tried: fewer
nodes a pixel first."""
BLOCK: Final = 8
"""Side of the largest square."""
INNER: Final = 0.65
"""Part of the tolerance that means may be off by, for what single rays are."""
_SHARES: Final = (1.0, 0.3, 0.09)
"""Parts of the coefficients of the last degree, of that before it, and so on, that polynomials may miss: those of a
kink wander about what they fall to."""
_SLOWEST: Final = 0.8
"""The most that coefficients are expected to be of those of one degree less."""
_HOPE: Final = 0.4
"""Part of the tolerance that a square may be expected to miss for it to be tried."""
_DENSE: Final = 2.5
"""Nodes along a side over which those of a rule are as far apart at most as two in a cell of this part of it."""


@dataclass(frozen=True)
class Rule:
    """Of one side of a square: ``nodes`` (n,) on [0, 1], ``means`` (side, n) over its pixels, ``series`` (n, n) the
    coefficients in Legendre's polynomials, from what nodes see. A mean over a pixel of the square is off by at most
    ``spread`` times what its nodes are."""

    nodes: Array
    means: Array
    series: Array
    spread: float


@lru_cache(maxsize=8)
def rule_of(side: int, order: int) -> Rule:
    """The rule of ``order`` Gauss nodes for ``side`` pixels."""
    x, w = np.polynomial.legendre.leggauss(order)
    powers = np.polynomial.legendre.legvander(x, order - 1)
    series = (powers * w[:, None]).T * (np.arange(order)[:, None] + 0.5)
    ends = np.linspace(-1.0, 1.0, side + 1)
    wholes = [np.polynomial.legendre.Legendre.basis(k).integ()(ends) for k in range(order)]
    means = np.diff(np.array(wholes), axis=1).T * (0.5 * side) @ series
    return Rule(0.5 * (x + 1.0), means, series, float(np.abs(means).sum(axis=1).max()) ** 2)


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

    ``hope`` (N, squares) is what each of ``SQUARES`` is expected to miss, from the last one that a pixel was tried in.
    """

    values: Array
    error: Array
    status: Ints
    evaluations: Ints
    known: npt.NDArray[np.bool_]
    hope: Array

    @classmethod
    def nothing(cls, count: int, channels: int) -> Known:
        """Of pixels that no square was tried for."""
        status, spent = (np.zeros(count, np.int64) for _ in range(2))
        values, known = np.zeros((count, channels)), np.zeros(count, np.bool_)
        return cls(values, np.zeros(count), status, spent, known, np.zeros((count, len(SQUARES))))

    def promising(self, square: int, tol: float) -> npt.NDArray[np.bool_]:
        """(N,) whether pixels are not known and nothing says that this one of ``SQUARES`` is vain."""
        return np.asarray(~self.known & (self.hope[:, square] <= _HOPE * tol))


Seen = Callable[[Array, Array, float, float], tuple[Array, Array, Ints, Ints]]
"""What places of the image, columns and rows, show, to a tolerance, so many of them a pixel: (values (N, C), error,
status, evaluations)."""


def block_means(
    picture: Picture, tile: Tile, look: Seen, tol: float, channels: int, slow: float = 1.0
) -> Known:  # fmt: skip
    """Means over the pixels of a tile that lie in smooth squares, each to ``tol``.

    ``slow`` is how many times what polynomials are seen to miss they are taken to. Squares lie at multiples of their
    side of the image, and all of one is done wherever a tile ends, so that no tile changes a byte.
    """
    x0, y0, x1, y1 = tile
    found = Known.nothing((x1 - x0) * (y1 - y0), channels)
    for square, (side, order) in enumerate(SQUARES):
        corners = _corners(picture, tile, side, found.promising(square, tol))
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
    values, error, status, spent = look(across, down, INNER * tol / rule.spread, order**2 / side**2)
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
        found.hope[which] = expected(fall[n], side)
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


def expected(fall: Array, side: int) -> Array:
    """(squares,) what each of ``SQUARES`` is expected to miss where one of this ``side`` has coefficients of sizes
    ``fall`` (n,).

    Beyond the last degree they go on to fall as those before it do, from even ones to even ones. In a square of a part
    of the side those of degree k are that part to the power k.
    """
    count = len(fall)
    most = max(order for _, order in SQUARES)
    late, early = fall[-2:].sum(), fall[-4:-2].sum()
    pace = min(_SLOWEST, math.sqrt(late / early)) if early > 0.0 else _SLOWEST
    beyond = max(fall[-1], fall[-2] * pace) * pace ** np.arange(1, most - count + 1)
    whole = np.concatenate([fall, beyond])
    rows = [missed((whole * (part / side) ** np.arange(most))[None, :order])[0] for part, order in SQUARES]
    return np.array(rows)


def missed(fall: Array) -> Array:
    """(N,) what polynomials with coefficients of these sizes, by their degree, may miss."""
    return np.asarray(np.max([share * fall[:, -1 - k] for k, share in enumerate(_SHARES)], axis=0))


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that tells smooth squares."""
    # the kernel only borrows arrays; counting references to them would cost more than the arithmetic
    return compiled(kernels.smooth_blocks, _nrt=False)
