"""Exact lobe shares of circles of directions: how much of a lobe a disc, or what a horizon leaves, fills."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined, jitable
from symrender.leaves import values

Array = npt.NDArray[np.float64]

_ORDER: Final = 24
_PIECES: Final = 8
NODES: Final = _ORDER * _PIECES
"""Rings of a sum over those a circle crosses."""
RINGS_ROW: Final = 3
RINGS_FROM: Final = _ORDER * (_ORDER + 1) // 2
"""Where ``gauss_table()`` has the places of the rings' nodes, behind all Gauss rules; their weights are a row below."""
ROUNDED_SHARE: Final = 3e-14
"""What rounding and ``NODES`` rings may leave of a share."""


@jitable
def ring_share(n: float, low: float, high: float, theta_max: float) -> float:
    """Lobe share of the ring low <= theta <= high: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1."""
    return values.ring_share(values.log_rim(low), values.log_rim(high), values.log_rim(theta_max), n)


@jitable
def last_ring(n: float, low: float, high: float) -> float:
    """``high``, or the angle beyond which the rings from ``low`` on hold less than 1e-18 of the lobe."""
    u = n + 1.0
    reach = 2.0 * math.asin(math.sqrt(min(1.0, -math.expm1(-42.0 / u)) * 0.5))
    return min(high, max(reach, low + 42.0 / (u * max(math.tan(min(low, 1.5)), 1e-9))))


@jitable
def tilt_of(axis: Array, normal: Array) -> float:
    """Angle between two unit vectors, with all digits where they are nearly one."""
    x = axis[1] * normal[2] - axis[2] * normal[1]
    y = axis[2] * normal[0] - axis[0] * normal[2]
    z = axis[0] * normal[1] - axis[1] * normal[0]
    along = axis[0] * normal[0] + axis[1] * normal[1] + axis[2] * normal[2]
    return math.atan2(math.sqrt(x * x + y * y + z * z), along)


def graded_rule(nodes: Array, weights: Array) -> Array:
    """(2, ``NODES``): nodes of [0, 1] and their weights, of this Gauss rule on pieces, mapped at both ends.

    The map is of fourth order there. It makes the square root smooth by which the arc of a circle begins or ends, and
    leaves of a fractional power, as of cos^n at a right angle, what rounding hides: sin^2 of sin^2.
    """
    x = ((np.arange(_PIECES)[:, None] + nodes) / _PIECES).ravel()
    half = 0.5 * math.pi
    inner = np.sin(half * x) ** 2
    slope = half * half * np.sin(math.pi * inner) * np.sin(math.pi * x)
    return np.stack([np.sin(half * inner) ** 2, np.tile(weights, _PIECES) / _PIECES * slope])


@inlined
def graded(node: int, gauss: Array) -> tuple[float, float]:
    """One of ``NODES`` nodes of [0, 1] and its weight, of ``graded_rule``."""
    return float(gauss[RINGS_ROW, RINGS_FROM + node]), float(gauss[RINGS_ROW + 1, RINGS_FROM + node])


@jitable
def ring_node(node: int, low: float, high: float, n: float, gauss: Array) -> tuple[float, float, float, float]:
    """Weight cos^n theta sin theta dtheta, theta, its sine and cosine of one of ``NODES`` rings between two."""
    at, weight = graded(node, gauss)
    theta = low + (high - low) * at
    st, ct = math.sin(theta), math.cos(theta)
    density = values.angle_power(theta, n) if ct > 0.0 else 0.0
    return weight * (high - low) * density * st, theta, st, ct


@jitable
def cap_share(n: float, theta_max: float, beta: float, alpha: float, gauss: Array) -> float:
    """Share of the lobe cos^n theta (theta <= theta_max) inside the cap of angular radius ``alpha`` at angle ``beta``.

    On the ring theta the cap covers the half-arc A with cos A = (cos alpha - cos theta cos beta)/(sin theta sin beta),
    taken from half angles, tan^2(A/2) = sin(s - theta) sin(s - beta)/(sin s sin(s - alpha)) with 2 s the sum, so that
    narrow lobes and discs keep their digits; its square-root ends are removed by ``graded_rule``, and the ring's weight
    is integrated exactly where the whole ring lies inside. A horizon is the cap alpha = pi/2 about the normal.
    ``gauss`` is ``gauss_table()``.
    """
    full = alpha - beta
    share = 0.0
    if full > 0.0:
        share = ring_share(n, 0.0, min(full, theta_max), theta_max)
    low, high = abs(full), min(theta_max, alpha + beta, 2.0 * math.pi - alpha - beta)
    high = last_ring(n, low, high)
    high = min(high, theta_max)
    if not low < high:
        return share
    scale = 1.0 / values.normaliser(values.log_rim(theta_max), n)
    for node in range(NODES):
        weight, theta, _, _ = ring_node(node, low, high, n, gauss)
        opposite = math.sin(0.5 * (alpha + beta - theta)) * math.sin(0.5 * (alpha + theta - beta))
        beside = math.sin(0.5 * (alpha + beta + theta)) * math.sin(0.5 * (beta + theta - alpha))
        arc = 2.0 * math.atan2(math.sqrt(max(0.0, opposite)), math.sqrt(max(0.0, beside)))
        share += weight * scale * 2.0 * arc
    return share


@jitable
def facing_mass(n: float, theta_max: float, beta: float, gauss: Array) -> float:
    """Mean of max(0, w.N) under the lobe cos^n theta (theta <= theta_max) whose axis stands at ``beta`` to N.

    On a ring wholly above the horizon the mean is cos theta cos beta, whose integral is closed; on one that crosses it,
    with half-arc a above, it is (cos theta cos beta a + sin theta sin beta sin a)/pi. Nodes as in ``cap_share``.
    """
    u = n + 1.0
    mc = values.log_rim(theta_max)
    mass = values.lobe_mass(mc, n)
    full = 0.5 * math.pi - beta
    cb, sb = math.cos(beta), math.sin(beta)
    share = 0.0
    if full > 0.0:
        share = ring_share(n + 1.0, 0.0, min(full, theta_max), theta_max) * values.lobe_mass(mc, n + 1.0)
        share *= cb * u / ((u + 1.0) * mass)
    low, high = abs(full), theta_max
    high = last_ring(n, low, high)
    if not low < high:
        return share
    for node in range(NODES):
        weight, _, st, ct = ring_node(node, low, high, n, gauss)
        arc = math.acos(max(-1.0, min(1.0, -ct * cb / max(st * sb, 1e-300))))
        share += weight * u / mass * (ct * cb * arc + st * sb * math.sin(arc)) / math.pi
    return share
