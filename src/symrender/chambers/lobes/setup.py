"""A lobe from what the scene says of it: density, rim, and what lies beyond."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import CONDUCTOR, CORRELATED, NO_RIM, POWER, Conductor, Lobe
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.jit.records import Table
from symrender.leaves.radiometric import walter_masking
from symrender.leaves.values import log_normaliser, log_rim, seen_area, smith_root

Array = npt.NDArray[np.float64]

FLAT: Final = 1e-7
"""Cosine of theta_max below which the rim's cone is taken to be a plane: its quadratic could not be told from one."""

ALIGNED: Final = 1e-12
"""Two unit vectors that differ by less are one."""


@jitable
def lobe_setup(n: float, theta_max: float, tol: float, bound: float, lobe: Lobe) -> float:
    """Exponent, normaliser and effective rim of a lobe; returns the lobe share that lies beyond the effective rim.

    Beyond the effective rim lies less than a tenth of ``tol/bound`` of the lobe, so a needle is integrated where it is.
    A rim within 1e-7 of the plane across the axis is taken to be there.
    """
    u = n + 1.0
    log_c = log_rim(theta_max)
    beyond = math.exp(u * log_c)
    lobe.kind, lobe.exponent = POWER, n
    lobe.facing[0] = lobe.facing[1] = lobe.facing[2] = 0.0
    lobe.facing_level = 1.0
    lobe.log_normaliser = log_normaliser(log_c, n)
    cut = 0.1 * tol / bound
    lobe.rim_cos = math.cos(theta_max)
    lobe.rim_sin = math.sin(theta_max)
    moved = 0.0
    if lobe.rim_cos < FLAT:
        # a rim that moves comes in from there
        lobe.rim_cos, lobe.rim_sin = lobe.rim_cos - held(lobe.rim_cos), 1.0
        moved = beyond
    if cut < 1.0 and beyond < cut:
        # 1 - cos of the effective rim
        versine = -math.expm1(math.log(cut) / u)
        if versine < 1.0 - max(FLAT, lobe.rim_cos):
            lobe.rim_cos = 1.0 - versine
            lobe.rim_sin = math.sqrt(versine * (2.0 - versine))
            return cut - beyond
    return moved


@inlined
def end_at_horizon(normal: Array, axis: Array, lobe: Lobe) -> None:
    """Leave out the rim of a half space about the surface normal itself: it is the horizon, which is a wall anyway."""
    apart = 0.0
    for a in range(3):
        apart = max(apart, abs(axis[a] - normal[a]))
    if lobe.rim_cos == 0.0 and apart < ALIGNED:
        lobe.rim_cos, lobe.rim_sin = NO_RIM, 0.0


@jitable
def is_conductor(surface: int, conductors: Table[Conductor] | None) -> bool:
    """Whether the surface of this hit class is a conductor."""
    if conductors is None:
        return False
    return conductors[surface].alpha > 0.0


@jitable
def conductor_setup(surface: int, axis: Array, normal: Array, conductors: Table[Conductor] | None, lobe: Lobe) -> None:
    """The lobe of a conductor about the mirror direction ``axis``: it has no rim, so nothing lies beyond."""
    if conductors is None:
        return
    conductor = conductors[surface]
    lobe.kind, lobe.conductor, lobe.alpha = CONDUCTOR, surface, conductor.alpha
    lobe.rim_cos, lobe.rim_sin = NO_RIM, 0.0
    lobe.exponent = lobe.log_normaliser = 0.0
    lobe.facing[0] = lobe.facing[1] = lobe.facing[2] = 0.0
    lobe.facing_level = 1.0
    cosine = axis[0] * normal[0] + axis[1] * normal[1] + axis[2] * normal[2]
    lobe.beckmann, lobe.correlated = int(conductor.beckmann), conductor.masking
    lobe.outward = cosine / seen_area(cosine, conductor.alpha)
    lobe.walter = int(conductor.walter)
    if lobe.walter == 1:
        lobe.outward = walter_masking(cosine, conductor.alpha)
    root = smith_root(cosine, conductor.alpha)
    lobe.cos_view = cosine
    lobe.by_cosine = lobe.by_root = cosine + root
    if conductor.masking == CORRELATED:
        lobe.by_cosine, lobe.by_root = 2.0 * root, 2.0 * cosine


@inlined
def mirror_setup(lobe: Lobe) -> None:
    """A lobe of density 1, of which one direction is asked."""
    lobe.kind, lobe.exponent, lobe.log_normaliser = POWER, 0.0, 0.0
    lobe.rim_cos, lobe.rim_sin = NO_RIM, 0.0
    lobe.facing[0] = lobe.facing[1] = lobe.facing[2] = 0.0
    lobe.facing_level = 1.0


@inlined
def weigh_by_cosine(normal: Array, lobe: Lobe) -> None:
    """Let every direction count with its cosine to ``normal``, as in BRDF units."""
    lobe.facing_level = 0.0
    for a in range(3):
        lobe.facing[a] = normal[a]
