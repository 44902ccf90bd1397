"""What a lattice of directions about a lobe's axis is laid out by (``quadrature/lattice_sphere.py``)."""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.lobes.density import density_of
from symrender.chambers.lobes.record import Lobe
from symrender.jit.marks import inlined
from symrender.leaves import values

SHARPEST: Final = 1e6
"""Exponent above which the lobe's power has lost digits."""


@inlined
def is_sharp(lobe: Lobe) -> bool:
    """Whether a lattice declines a lobe as too narrow."""
    return bool(lobe.exponent > SHARPEST)


@inlined
def map_rate(lobe: Lobe) -> float:
    """Rate r of a density (1 + r s)^-5 close to the lobe's, s = 1 - cos theta beyond the nearest direction."""
    return 0.2 * lobe.exponent


@inlined
def density_at(versine: float, lobe: Lobe) -> float:
    """The density where 1 - cos theta is ``versine``."""
    return density_of(math.log1p(-versine), lobe)


@inlined
def ring_mass(top: float, rest: float, span: float, lobe: Lobe) -> float:
    """Share of the lobe in a ring.

    It begins where the density is ``top`` and the cosine ``rest``, and ends where that has fallen by ``span`` of it.
    """
    return top * rest * values.normaliser(values.log_left(span), lobe.exponent)
