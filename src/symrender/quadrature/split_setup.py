"""What the split rule and its derivative set up alike before they integrate a point."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.walls import BETA_MAX, LOBE_BETA, POINT, RATIO, SIDE, STRIP, SURFACE_NORMAL
from symrender.chambers.work import View
from symrender.kernel_cache import jitable
from symrender.scene.arrays import FLOOR_BRIGHT, FLOOR_DARK, KU, KV, MARBLE, TEXTURE

Array = npt.NDArray[np.float64]

MET: Final = 0
"""The error estimate is within the tolerance."""
CAPPED: Final = 1
"""The evaluations or the panels ran out first; the error estimate says how far it got."""
NEAR_TANGENT: Final = 2
"""A piece too thin to be cut further stayed unresolved; the error estimate bounds it."""
UNSUPPORTED: Final = 3
"""The point lies inside another sphere; no value is given and the error is infinite."""


@jitable
def place_point(point: Array, normal: Array, incoming: Array, lobe: Array, geo: Array) -> None:
    """Write the point, its normal and its side of the floor into ``geo`` and the axis of its lobe into ``lobe``."""
    d = incoming[0] * normal[0] + incoming[1] * normal[1] + incoming[2] * normal[2]
    size = 0.0
    for a in range(3):
        geo[POINT + a] = point[a]
        geo[SURFACE_NORMAL + a] = normal[a]
        lobe[a] = incoming[a] - 2.0 * d * normal[a]
        size += lobe[a] * lobe[a]
    for a in range(3):
        lobe[a] /= math.sqrt(size)
    geo[SIDE] = 1.0 if point[2] >= 0.0 else -1.0


@jitable
def inside_another(point: Array, own: int, spheres: Array) -> bool:
    """Whether the point lies inside a sphere that is not ``own``."""
    for j in range(spheres.shape[0]):
        x, y, z = point[0] - spheres[j, 0], point[1] - spheres[j, 1], point[2] - spheres[j, 2]
        if j != own and x * x + y * y + z * z <= spheres[j, 3] ** 2:
            return True
    return False


@jitable
def sphere_strips(j: int, n: float, view: View, geo: Array) -> None:
    """How far off the real line the integrand of charted sphere ``j`` stays tame, under a lobe of exponent ``n``."""
    k = geo[RATIO]
    geo[STRIP] = min(0.3, 1.4 / (math.sqrt(n + 1e-9) * k))
    reach = math.sin(geo[LOBE_BETA]) * math.sin(min(geo[LOBE_BETA], geo[BETA_MAX]))
    geo[STRIP + 1] = min(0.5, 1.4 / math.sqrt(n * reach + 1e-9))
    if view.spheres[j, TEXTURE] == MARBLE:
        vein = 3.0 / (view.spheres[j, KU] + 6.6 * view.spheres[j, KV])
        geo[STRIP], geo[STRIP + 1] = min(geo[STRIP], vein), min(geo[STRIP + 1], vein)
    geo[STRIP + 2] = 0.9 * math.acosh(1.0 / k)


@jitable
def floor_strips(n: float, view: View, geo: Array) -> None:
    """The same of the floor's chart; then its mean albedo."""
    geo[STRIP] = min(0.3, 1.4 / math.sqrt(n + 1e-9))
    geo[STRIP + 1] = min(0.5, 1.4 / math.sqrt(n * math.sin(geo[LOBE_BETA]) + 1e-9))
    for a in range(3):
        geo[STRIP + 3 + a] = 0.5 * (view.floor[FLOOR_BRIGHT + a] + view.floor[FLOOR_DARK + a])
