"""The world a kernel sees: the scene's arrays and what is worked out from them once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.numeric.lights import light_points
from symrender.numeric.lobe import lobe_rows
from symrender.scene.arrays import BRDF_NORMALISED, UNITS, Array, SceneArrays


class World(NamedTuple):
    """Arrays of a scene under one disk rule; all C-contiguous.

    ``spheres``, ``floor``, ``lights``, ``shading`` as in ``SceneArrays``; ``points`` (p, 3), ``first`` (m + 1,) and
    ``axes`` (m, 6) as in ``light_points``; ``lobes`` (1 + n, LOBE_COLUMNS): the floor's, then each sphere's.
    """

    spheres: Array
    floor: Array
    lights: Array
    shading: Array
    points: Array
    first: npt.NDArray[np.int64]
    axes: Array
    lobes: Array


def make_world(arrays: SceneArrays, disk_order: int) -> World:
    """World of a scene; ``disk_order`` is K of the K x K disk rule or ``EXACT_DISK``."""

    def plain(values: Array) -> Any:
        return np.ascontiguousarray(values, dtype=np.float64)

    points, first, axes = light_points(arrays.lights, disk_order)
    brdf = bool(arrays.shading[UNITS] == BRDF_NORMALISED)
    lobes = lobe_rows(np.vstack([arrays.floor[None, 11:14], arrays.spheres[:, 11:14]]), brdf=brdf)
    return World(
        plain(arrays.spheres),
        plain(arrays.floor),
        plain(arrays.lights),
        plain(arrays.shading),
        points,
        first,
        axes,
        lobes,
    )
