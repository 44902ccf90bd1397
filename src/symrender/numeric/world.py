"""The world a kernel sees: the scene's arrays and what is worked out from them once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table, table
from symrender.numeric.lights import light_points
from symrender.numeric.lobe import lobe_rows
from symrender.scene.arrays import BRDF_NORMALISED, Array, SceneArrays, lobes_of
from symrender.scene.frames import frames
from symrender.scene.records import Floor, Frame, Light, Plane, Shading, Sphere


class World(NamedTuple):
    """A scene under one disk rule: its records, ``points`` (p, 3), ``first`` (m + 1,) and
    ``axes`` (m, 6) as in ``light_points``; ``lobes`` (1 + n + k, LOBE_COLUMNS): the floor's, then each sphere's and
    each plane's. ``frames`` (k,) say where the planes lie, ``floors`` (k,) what they are as floors of their frames.
    """

    spheres: Table[Sphere]
    floor: Floor
    lights: Table[Light]
    shading: Shading
    points: Array
    first: npt.NDArray[np.int64]
    axes: Array
    lobes: Array
    frames: Table[Frame]
    floors: Table[Floor]


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
        frames(arrays.planes),
        _floors(arrays.planes),
    )


def _floors(planes: Table[Plane]) -> Table[Floor]:
    floors = table(Floor, len(planes))
    for floor, plane in zip(floors, planes, strict=True):
        for name in Floor.names():
            setattr(floor, name, 1.0 if name == "present" else getattr(plane, name))
    return floors
