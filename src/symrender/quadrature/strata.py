"""Rules over a lobe: K rings by K sectors, exact or midpoint weights, four kinds of node, three partitions.

A rule is directions in the frame (u1, u2, m) about the mirror direction and weights that sum to one, so a lobe
average is their dot product with radiance. Nothing of these has textbook order once a wall crosses the lobe: the
error falls about as N^-0.8 in the number of directions whatever the weights; ``chambers`` splits instead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from symrender.settings import Nodes, Partition, Weights

Array = npt.NDArray[np.float64]

NARROWEST: Final = 1e-150
"""Half-angle below which a lobe is its mirror direction: the square of anything narrower is not a normal number."""


class LobeFormulas(Protocol):
    """The formulas of ``kernel/strata.py`` as callables; angles in radians, u = n + 1."""

    def ring_weight(self, a: float, b: float, u: float) -> float:
        """Integral of cos^n t sin t over [a, b]."""
        ...

    def ring_barycentre(self, a: float, b: float, u: float) -> float:
        """Angle of the mean cosine over [a, b] under the weight."""
        ...

    def share_angle(self, share: float, theta_max: float, u: float) -> float:
        """Half-angle of the cone holding a share of the lobe."""
        ...

    def cap_angle(self, share: float, theta_max: float) -> float:
        """Half-angle of the cone holding a share of the solid angle."""
        ...

    def log_weight(self, t: float, n: float) -> float:
        """log(cos^n t sin t)"""
        ...


@dataclass(frozen=True)
class Rings:
    """The rings of a partition: K + 1 edges, K nodes (radians), K weights summing to about one.

    ``weights`` are the ring's share of the lobe, its exact integral over W or the midpoint value over W.
    """

    edges: Array
    nodes: Array
    weights: Array


@dataclass(frozen=True)
class Rule:
    """Directions (m, 3) in the lobe's frame and weights (m,); ``sum(weights)`` is 1 for a ratio estimator."""

    directions: Array
    weights: Array


def edges(formulas: LobeFormulas, exponent: float, theta_max: float, k: int, partition: Partition) -> Array:
    """K + 1 polar angles from 0 to theta_max: equal steps of angle, of solid angle, or of lobe weight."""
    shares = np.arange(1, k) / k
    if partition == "equal_angle":
        inner = (shares * theta_max).tolist()
    elif partition == "equal_solid_angle":
        inner = [formulas.cap_angle(s, theta_max) for s in shares.tolist()]
    else:
        inner = [formulas.share_angle(s, theta_max, exponent + 1) for s in shares.tolist()]
    return np.array([0.0, *inner, theta_max])


def rings(
    formulas: LobeFormulas,
    exponent: float,
    theta_max: float,
    k: int,
    *,
    weights: Weights = "exact",
    nodes: Nodes = "midpoint",
    partition: Partition = "equal_angle",
) -> Rings:
    """Rings of a lobe.

    ``exact`` weights are the closed integral of cos^n over the ring, ``midpoint`` ones the value at its middle times
    its width (the source chapter's centroid weights). Nodes: ``midpoint`` of the angle (what the chapter calls the
    centroid), ``barycentre`` (mean cosine under the weight; exact for radiance linear in cos t), or ``gauss``
    (Gauss-Legendre in cos^(n+1) t with its own weights; needs ``equal_weight``, of which it is the smooth limit).
    """
    u = exponent + 1
    total = formulas.ring_weight(0.0, theta_max, u)
    if nodes == "gauss":
        points, gauss = np.polynomial.legendre.leggauss(k)
        bounds = edges(formulas, exponent, theta_max, k, "equal_weight")
        angles = np.array([formulas.share_angle((1 + x) / 2, theta_max, u) for x in points])
        return Rings(bounds, angles, gauss / 2)
    bounds = edges(formulas, exponent, theta_max, k, partition)
    pairs = list(zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True))
    if nodes == "midpoint":
        angles = (bounds[:-1] + bounds[1:]) / 2
    else:
        angles = np.array([formulas.ring_barycentre(a, b, u) for a, b in pairs])
    if weights == "midpoint":
        middles = (bounds[:-1] + bounds[1:]) / 2
        logs = np.array([formulas.log_weight(t, exponent) for t in middles.tolist()]) + np.log(np.diff(bounds))
        shares = np.exp(logs - math.log(total))
        # a needle between the nodes: only their ratios are left of the weights
        if not shares.sum() > 0:
            shares = np.exp(logs - logs.max())
    elif partition == "equal_weight":
        shares = np.full(k, 1.0 / k)
    else:
        shares = np.array([formulas.ring_weight(a, b, u) for a, b in pairs]) / total
    return Rings(bounds, angles, shares)


def rule(ring: Rings, *, sectors: int, normalised: bool) -> Rule:
    """Rings times equal sectors, ring by ring outwards, directions at the middle of each sector.

    ``normalised`` leaves the weights relative to the closed-form W; otherwise they are divided by their own sum, the
    ratio estimator.
    """
    azimuths = (np.arange(sectors) + 0.5) / sectors * (2 * math.pi)
    sine, cosine = np.sin(ring.nodes)[:, None], np.cos(ring.nodes)[:, None]
    directions = np.stack(
        np.broadcast_arrays(sine * np.cos(azimuths), sine * np.sin(azimuths), cosine), axis=-1
    ).reshape(-1, 3)
    weights = np.repeat(ring.weights / sectors, sectors)
    if not normalised:
        weights = weights / math.fsum(weights)
    return Rule(np.ascontiguousarray(directions), weights)


def mirror_rule() -> Rule:
    """The one direction of a mirror."""
    return Rule(np.array([[0.0, 0.0, 1.0]]), np.ones(1))
