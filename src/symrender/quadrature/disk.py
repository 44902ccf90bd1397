"""Rules over a disk light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.jit.records import Table
from symrender.limits import MAX_LIGHT_POINTS
from symrender.scene import arrays as at
from symrender.scene.records import Light

Array = npt.NDArray[np.float64]


def centroids(k: int) -> Array:
    """(u, v) of the K x K strata's middles, (K K, 2): u slowest."""
    middle = (np.arange(k) + 0.5) / k
    return np.stack(np.meshgrid(middle, middle, indexing="ij"), axis=-1).reshape(-1, 2)


def light_points(lights: Table[Light], k: int, place: Callable[..., tuple[float, float, float]]) -> Array:
    """Every light as points, (q, 6): position and the light's colour over the number of its points.

    A disk becomes the K x K centroids of its strata, a point stays one point.
    ``place(center, target, radius, u, v)``, flattened, is the formula of a disk's point.
    """
    count = sum(k * k if light.kind == at.DISK else 1 for light in lights)
    if count > MAX_LIGHT_POINTS:
        raise OptionError(f"disk: {count} light points exceed {MAX_LIGHT_POINTS}; use a smaller K or fewer disk lights")
    rows: list[tuple[float, ...]] = []
    for light in lights:
        position, color = light.position.tolist(), light.color.tolist()
        if light.kind == at.DISK:
            share = [c / (k * k) for c in color]
            disk = (*position, *light.target.tolist(), float(light.radius))
            rows += [(*place(*disk, u, v), *share) for u, v in centroids(k).tolist()]
        else:
            rows.append((*position, *color))
    return np.array(rows).reshape(-1, 6)
