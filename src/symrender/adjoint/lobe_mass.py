"""How the share of a lobe above a horizon changes with the lobe and with its tilt."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.mass import NODES, graded, last_ring, ring_node
from symrender.jit.marks import jitable
from symrender.leaves import slopes, values

Array = npt.NDArray[np.float64]

_NEGLIGIBLE = 42.0
"""e to the minus this is below rounding."""


@jitable
def normaliser_slopes(n: float, theta_max: float) -> tuple[float, float]:
    """Slopes in n and in theta_max of log W, W = 2 pi (1 - cos^u theta_max)/u, u = n + 1."""
    log_rim = values.log_rim(theta_max)
    log_w, _, by_n = slopes.log_normaliser_slopes(log_rim, n)
    # W grows by its rim: of its slope in log cos theta_max a difference would leave few digits where little is there
    return by_n, 2.0 * math.pi * math.sin(theta_max) * values.power_density(log_rim, n, log_w)


@jitable
def horizon_slopes(n: float, theta_max: float, alpha: float, share: float, gauss: Array) -> tuple[float, float, float]:
    """Slopes in n, theta_max and alpha of the ``share`` of a lobe cos^n above the horizon of a normal at angle alpha.

    With the directions of the horizon at angle t from the one nearest to the axis, cos(theta) = sin(alpha) cos(t), so
    tilting the lobe by d alpha takes away the density times cos(t) along it. ``gauss`` is ``gauss_table()``.
    """
    rim = min(theta_max, 0.5 * math.pi)
    if alpha + rim <= 0.5 * math.pi:
        return 0.0, 0.0, 0.0
    by_n, by_theta = normaliser_slopes(n, theta_max)
    log_rim = values.log_rim(rim)
    scale = 1.0 / values.normaliser(log_rim, n)
    sa, ca = math.sin(alpha), math.cos(alpha)

    last = math.acos(max(0.0, min(1.0, math.cos(rim) / sa))) if rim < 1.5707963267948966 else 0.5 * math.pi
    if n > 0.0:
        last = min(last, math.acos(math.exp(-_NEGLIGIBLE / n)) if n > 0.05 else last)
    tilt = 0.0
    for node in range(NODES):
        at, weight = graded(node, gauss)
        along = math.cos(last * at)
        tilt -= 2.0 * last * weight * scale * values.cosine_power(max(sa * along, 1e-300), n) * along

    # rings below ``low`` are whole, those up to ``high`` cut by the horizon
    low, high = 0.5 * math.pi - alpha, rim
    whole = 0.0
    if low > 0.0:
        # d/dn of what they hold over the normaliser, less the normaliser's own slope
        mass, _, more = slopes.lobe_mass_slopes(values.log_rim(low), n)
        whole = (more - mass / (n + 1.0)) / values.lobe_mass(log_rim, n)
    low = abs(low)
    high = min(high, last_ring(n, low, high))
    logs = 0.0
    if low < high:
        for node in range(NODES):
            weight, _, st, ct = ring_node(node, low, high, n, gauss)
            if ct > 0.0:
                arc = math.acos(max(-1.0, min(1.0, -ct * ca / max(st * sa, 1e-300))))
                logs += weight * scale * math.log1p(-st * st / (1.0 + ct)) * 2.0 * arc
    rim_arc = math.acos(max(-1.0, min(1.0, -math.cos(rim) * ca / max(math.sin(rim) * sa, 1e-300))))
    on_rim = values.power_density(log_rim, n, values.log_normaliser(log_rim, n)) * math.sin(rim) * 2.0 * rim_arc
    return logs + whole - by_n * share, on_rim - by_theta * share, tilt
