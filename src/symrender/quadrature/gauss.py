"""Gauss-Legendre rules of 1 to ``MAX_ORDER`` nodes on [0, 1], in one flat table kernels can index."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.kernel_cache import jitable

Array = npt.NDArray[np.float64]

MAX_ORDER: Final = 24

LEVELS: Final = (1.0, 2.7, 4.7, 7.0, 10.0, 13.5, 17.5, 22.0, 27.0, 33.0)
"""Aimed-at error exponents of the successive orders of a piece."""


def gauss_table() -> Array:
    """Nodes and weights (2, MAX_ORDER (MAX_ORDER + 1)/2) on [0, 1]; the rule of n nodes starts at n (n - 1)/2.

    Exact to degree 2n - 1 up to rounding.
    """
    table = np.empty((2, MAX_ORDER * (MAX_ORDER + 1) // 2))
    for n in range(1, MAX_ORDER + 1):
        x, w = np.polynomial.legendre.leggauss(n)
        start = n * (n - 1) // 2
        table[0, start : start + n] = 0.5 * (1.0 + x)
        table[1, start : start + n] = 0.5 * w
    return table


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
