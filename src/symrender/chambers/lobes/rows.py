"""A lobe's density in rows of nodes."""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.leaf_rows import lobe_density_rows
from symrender.chambers.lobes.record import Lobe
from symrender.chambers.records import NODES, Nodes
from symrender.chambers.row_powers import powers
from symrender.kernel_cache import inlined

MOST_WHOLE: Final = 1024.0
NOISE: Final = 4e-15
"""Lobe exponents up to ``MOST_WHOLE`` are taken by squaring cos theta, where coefficients need not fall below ``NOISE``
times the exponent: that is what rounding leaves of them."""


@inlined
def densities(m: int, fall: float, nodes: Nodes, lobe: Lobe) -> None:
    """Multiply ``weight`` by the density at ``chord``: cos^n theta / W, of 1 - cos theta without cancellation.

    ``power`` gets the density. ``fall`` is that of the rule the nodes are of.
    """
    m = min(m, NODES)
    n, log_w = lobe.exponent, lobe.log_normaliser
    if n <= MOST_WHOLE and n == math.floor(n) and NOISE * n < fall:
        for i in range(m):
            nodes.radix[i] = max(0.0, 1.0 - 0.5 * nodes.chord[i])
        powers(0, m, nodes, n)
        if n == 0.0:
            # nothing is reflected below the plane across the axis
            for i in range(m):
                nodes.power[i] = 1.0 if nodes.chord[i] < 2.0 else 0.0
        scale = math.exp(-log_w)
        for i in range(m):
            nodes.power[i] *= scale
            nodes.weight[i] *= nodes.power[i]
        return
    lobe_density_rows(m, n, log_w, nodes)


@inlined
def falls(m: int, nodes: Nodes, lobe: Lobe) -> None:
    """``power`` = density over that of another direction, whose cosine to the axis is ``radix`` times smaller."""
    powers(0, m, nodes, lobe.exponent)
