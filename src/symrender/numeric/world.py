"""The world a kernel sees: the scene's arrays and what is worked out from them once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.numeric.lights import light_points
from symrender.numeric.lobe import lobe_rows
from symrender.records import Table
from symrender.scene.arrays import BRDF_NORMALISED, Array, SceneArrays, lobes_of
from symrender.scene.records import Floor, Light, Shading, Sphere


class World(NamedTuple):
    """A scene under one disk rule: its records, ``points`` (p, 3), ``first`` (m + 1,) and
    ``axes`` (m, 6) as in ``light_points``; ``lobes`` (1 + n, LOBE_COLUMNS): the floor's, then each sphere's.
    """

    spheres: Table[Sphere]
    floor: Floor
    lights: Table[Light]
    shading: Shading
    points: Array
    first: npt.NDArray[np.int64]
    axes: Array
    lobes: Array


def make_world(arrays: SceneArrays, disk_order: int) -> World:
    """World of a scene; ``disk_order`` is K of the K x K disk rule or ``EXACT_DISK``."""
    points, first, axes = light_points(arrays.lights, disk_order)
    brdf = bool(arrays.shading.units == BRDF_NORMALISED)
    lobes = lobe_rows(lobes_of(arrays), brdf=brdf)
    return World(
        arrays.spheres,
        arrays.floor,
        arrays.lights,
        arrays.shading,
        points,
        first,
        axes,
        lobes,
    )
