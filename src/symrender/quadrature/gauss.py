"""Gauss-Legendre rules on [0, 1] and rules of the unit disk, in one flat table kernels can index."""

from __future__ import annotations

import functools
import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.mass import NODES, RINGS_FROM, RINGS_ROW, graded_rule
from symrender.jit.marks import jitable

Array = npt.NDArray[np.float64]

MAX_ORDER: Final = 24
NODE_GAP: Final = 0.25 * math.pi
"""No place of a unit interval is farther than this over n from the nearest of its n Gauss nodes."""

BLOCK_LEVELS: Final = 14
"""Blocks of a checker are 2^k squares wide, k below this."""

MIDDLE: Final = 4 + BLOCK_LEVELS
"""The first of two rows of a ``gauss_table`` for the coefficients in the middle of those a rule sees."""

LEVELS: Final = (1.0, 2.7, 4.7, 7.0, 10.0, 13.5, 17.5, 22.0, 27.0, 33.0)
"""Aimed-at error exponents of the successive orders of a piece."""

FALLS: Final = tuple(math.exp(-level) for level in LEVELS)
"""The error factors of these exponents."""


DISK_DEGREES: Final = (1, 3, 5, 7, 11, 15, 19, 27)
"""Degrees of the disk rules: 1, 4, 7, 16, 36, 64, 100 and 196 points."""
DISK_STARTS: Final = (300, 301, 305, 312, 328, 364, 428, 528, 724)
"""Where each disk rule starts in the table, and where the last one ends."""


def disk_rule(degree: int) -> Array:
    """Rule (3, m) for the mean over the unit disk, exact for polynomials to ``degree``: x, y, weights of sum 1.

    From degree 7 on Gauss in u = r^2 times equispaced azimuths; below, the rules of fewest points with all of these
    symmetries (J. Radon, Monatshefte fuer Mathematik 52, 1948, doi:10.1007/BF01525334).
    """
    if degree == 1:
        return np.array([[0.0], [0.0], [1.0]])
    if degree < 7:
        turns = degree + 1
        angle = 2.0 * np.pi * (np.arange(turns) + 0.5) / turns
        if degree == 3:
            return np.stack([np.sqrt(0.5) * np.cos(angle), np.sqrt(0.5) * np.sin(angle), np.full(turns, 0.25)])
        x, y = (np.append(np.sqrt(2.0 / 3.0) * part, 0.0) for part in (np.cos(angle), np.sin(angle)))
        return np.stack([x, y, np.append(np.full(turns, 0.125), 0.25)])
    radii, weights = np.polynomial.legendre.leggauss((degree // 2 + 2) // 2)
    angle = 2.0 * np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)
    r = np.sqrt(0.5 * (1.0 + radii))[:, None]
    share = np.repeat(0.5 * weights / len(angle), len(angle))
    return np.stack([(r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel(), share])


def block_means(level: int) -> Array:
    """(MAX_ORDER,): means over [0, 1] of the Legendre polynomials times the alternating signs of 2^level equal cells.

    The first cell's sign is +1.
    """
    edges = np.linspace(-1.0, 1.0, 2**level + 1)
    signs = (-1.0) ** np.arange(2**level)
    unit = np.eye(MAX_ORDER)
    primitives = (np.polynomial.legendre.legval(edges, np.polynomial.legendre.legint(row)) for row in unit)
    return np.array([0.5 * float(signs @ np.diff(values)) for values in primitives])


@functools.lru_cache(maxsize=1)
def gauss_table() -> Array:
    """(MIDDLE + 2, DISK_STARTS[-1]): nodes, weights, tails of Gauss rules on [0, 1], then rules of the disk.

    The Gauss rule of n nodes starts at n (n - 1)/2 and is exact to degree 2n - 1 up to rounding. Its rows 2 and 3 make,
    as factors of the weights, the Legendre coefficients of degrees n - 1 and n - 2 of what the rule sees: how fast they
    fall tells the rule's error. A row is 0 where that degree would be 0 or less. Row 3 + k has the weights for 2^k
    cells of alternating sign (``block_means``). Rows ``MIDDLE`` and the next are like rows 2 and 3, of half their
    degrees, rounded down. The disk rules have x, y and weights in rows 0 to 2, below them stands ``graded_rule``.
    """
    gauss = np.zeros((MIDDLE + 2, DISK_STARTS[-1]))
    means = [block_means(level) for level in range(1, BLOCK_LEVELS)]
    for n in range(1, MAX_ORDER + 1):
        x, w = np.polynomial.legendre.leggauss(n)
        start = n * (n - 1) // 2
        gauss[0, start : start + n] = 0.5 * (1.0 + x)
        gauss[1, start : start + n] = 0.5 * w
        for row, degree in ((2, n - 1), (3, n - 2), (MIDDLE, (n - 1) // 2), (MIDDLE + 1, (n - 1) // 2 - 1)):
            if degree > 0:
                series = np.zeros(degree + 1)
                series[degree] = 2 * degree + 1
                gauss[row, start : start + n] = np.polynomial.legendre.legval(x, series)
        # int sign L_i of the Lagrange polynomials of the nodes, through their Legendre coefficients
        legendre = np.polynomial.legendre.legvander(x, n - 1) * (2.0 * np.arange(n) + 1.0)
        for level, mean in enumerate(means, 1):
            gauss[3 + level, start : start + n] = 0.5 * w * (legendre @ mean[:n])
    for degree, start, stop in zip(DISK_DEGREES, DISK_STARTS, DISK_STARTS[1:], strict=False):
        gauss[:3, start:stop] = disk_rule(degree)
    x, w = np.polynomial.legendre.leggauss(MAX_ORDER)
    for row, values in enumerate(graded_rule(0.5 * (1.0 + x), 0.5 * w)):
        gauss[RINGS_ROW + row, RINGS_FROM : RINGS_FROM + NODES] = values
    return gauss


@jitable
def step_of(fall: float) -> int:
    """The first step whose aimed-at error exponent reaches ``fall``, or the last one."""
    step = 0
    while step + 1 < len(LEVELS) and LEVELS[step] < fall:
        step += 1
    return step


@jitable
def fitting(step: int, log_rho: float) -> int:
    """Gauss nodes as of ``order``, but no more than asked: for rules inside the one whose steps are compared."""
    return max(1, min(MAX_ORDER, math.ceil(0.5 * LEVELS[step] / log_rho)))


@jitable
def nodes(step: int, log_rho: float) -> int:
    """As ``fitting``, but it may exceed ``MAX_ORDER``: the piece must then be cut."""
    return max(1, math.ceil(min(1e6, 0.5 * LEVELS[step] / log_rho)))


@jitable
def disk_level(step: int, log_rho: float) -> int:
    """Index of the disk rule for an error factor exp(-LEVELS[step]) where a chord's nearest singularity lies on rho."""
    for k in range(len(DISK_DEGREES) - 1):
        if (DISK_DEGREES[k] + 1) * log_rho >= LEVELS[step]:
            return k
    return len(DISK_DEGREES) - 1


@jitable
def order(step: int, log_rho: float) -> int:
    """Gauss nodes for an error factor exp(-LEVELS[step]) where the nearest singularity lies on ellipse rho.

    Strictly increasing in ``step``, so that two successive steps are always two different rules. May exceed
    ``MAX_ORDER``: the piece must then be cut.
    """
    scale = 0.5 / log_rho
    n = math.ceil(min(1e6, LEVELS[0] * scale))
    for i in range(1, step + 1):
        n = max(n + 1, math.ceil(min(1e6, LEVELS[i] * scale)))
    return n
