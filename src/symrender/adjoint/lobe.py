"""A lobe differentiated: its density's logarithm in places, in its axis and in its own numbers."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.moves import fastest_of, pace
from symrender.adjoint.walls import EXPONENT, LOG_NORMALISER, RIM
from symrender.chambers.lobes.density import density_of
from symrender.chambers.lobes.record import Lobe
from symrender.chambers.lobes.setup import FLAT, lobe_setup
from symrender.jit.marks import inlined, jitable
from symrender.scene.records import Floor, Sphere

Array = npt.NDArray[np.float64]

NEEDLE = 2.0
"""Exponent from which on a lobe's far tail falls off in value and slope, and may be cut off."""


@inlined
def log_density_at(versine: float, lobe: Lobe) -> tuple[float, float, float]:
    """cos(theta), its logarithm and the density cos^n(theta)/W where 1 - cos(theta) is ``versine``."""
    if versine >= 1.0:
        return 0.0, 0.0, 0.0
    log = math.log1p(-versine)
    return 1.0 - versine, log, density_of(log, lobe)


@inlined
def pull(weight: float, cosine: float, lobe: Lobe) -> float:
    """``weight`` times the slope of the density's logarithm in cos(theta)."""
    return weight * lobe.exponent / max(cosine, 1e-300)


@inlined
def add_own(weight: float, log: float, out: Array) -> None:
    """Add ``weight`` times the slopes of the density's logarithm in the lobe's own numbers to their columns."""
    add_own_sums(weight, weight * log, out)


@inlined
def add_own_sums(weights: float, logs: float, out: Array) -> None:
    """``add_own`` of nodes of which the weights, and the weights times the logarithms, are summed up."""
    out[EXPONENT] += logs
    out[LOG_NORMALISER] -= weights


@inlined
def own_moves(row: Sphere | Floor) -> tuple[float, float]:
    """How a surface's exponent and rim angle move."""
    return row.exponent, row.theta_max


@inlined
def fill_own(by_n: float, by_theta: float, theta_max: float, dn: float, dt: float, row: Array) -> None:
    """Fill the columns of ``row`` that belong to the lobe's own numbers; slopes are those of ``normaliser_slopes``."""
    row[EXPONENT] = dn
    row[LOG_NORMALISER] = by_n * dn + by_theta * dt
    row[RIM] = -math.sin(theta_max) * dt


@jitable
def gradient_rim(
    n: float, theta_max: float, tol: float, bound: float, shininess: float, lobe: Lobe, moves: Array, beyond: Array
) -> float:  # fmt: skip
    """Set the lobe up for derivatives; ``beyond`` gets what lies beyond its effective rim, a parameter at a time.

    A derivative of the share that is cut off may be larger than the share, by the slope of the density's logarithm;
    blunt lobes and rims that move and are felt stay whole. Returns what lies there may change by as the looks of shapes
    do, of which ``moves`` knows nothing yet.
    """
    u = n + 1.0
    cosine = max(math.cos(theta_max), 0.0)
    fastest, rim = fastest_of(moves), 0.0
    for p in range(moves.shape[0]):
        rim = max(rim, abs(moves[p, RIM]))
    at_rim = u * cosine**n * bound
    trim = n >= NEEDLE and at_rim * rim <= 1e-3 * tol
    share = lobe_setup(n, theta_max, 3.0 * tol / (u * fastest) if trim else 0.0, bound, lobe)
    is_cut = lobe.rim_cos > cosine + FLAT
    steep = math.sqrt(shininess) + (n * lobe.rim_sin / max(lobe.rim_cos, FLAT) if is_cut else 0.0)
    for p in range(moves.shape[0]):
        beyond[p] = 0.0
        if share > 0.0:
            spread = (2.0 - math.log(share)) / u
            beyond[p] = bound * share * (abs(moves[p, EXPONENT]) * spread + (1.0 + steep) * pace(moves[p]))
        if is_cut:
            beyond[p] += at_rim * abs(moves[p, RIM])
            moves[p, RIM] = 0.0
    return float(bound * share * (1.0 + steep))


@inlined
def steepness(least: float, lobe: Lobe) -> float:
    """``least`` and what slopes in places and in the lobe's numbers are larger by than what they are of."""
    return least + lobe.exponent
