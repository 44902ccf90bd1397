"""A scene as the split rule takes it: its lights, views and bounds, made ready once for many points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symrender.chambers.cones import scene_cones
from symrender.chambers.lobes.record import Conductor, Sender
from symrender.chambers.lobes.sending import largest_sent
from symrender.chambers.lobes.units import is_brdf, lobe_scale
from symrender.chambers.records import INVERSE_SQUARE, LightPoint
from symrender.chambers.work import Frames, View, scene_frames, scene_view
from symrender.errors import Unsupported
from symrender.jit.records import Table
from symrender.quadrature.fall_off import TOUCHING, glow_bound
from symrender.quadrature.light_points import light_rows
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, SceneArrays, lobes_of
from symrender.scene.frames import frames, heights
from symrender.scene.radiometric.records import Glow
from symrender.scene.radiometric.records import Light as Beam

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SplitScene:
    """What kernels of the split rule are given of a scene; they read it only.

    ``lobes`` (classes, 2) are exponents and half-angles of hit classes, ``scales`` (classes,) what the averages over
    them are multiplied by, ``bound`` an upper bound of the radiance that a lobe can meet.
    """

    lights: Table[LightPoint]
    view: View
    frames: Frames
    lobes: Array
    scales: Array
    bound: float


def split_scene(
    arrays: SceneArrays, disk_order: int, conductors: Table[Conductor] | None = None,
    senders: Table[Sender] | None = None, emitted: Array | None = None, spots: Table[Beam] | None = None,
    glows: Table[Glow] | None = None,
) -> SplitScene:  # fmt: skip
    """``arrays`` made ready; the others are as of ``gloss_points``."""
    lights = light_rows(arrays, disk_order, spots)
    cones = None
    if glows is not None or (lights["spot"] != 0.0).any():
        cones = scene_cones(arrays.spheres, lights, glows is not None)
    view = scene_view(arrays, lights, conductors, senders, emitted, cones, glows)
    lobes = np.zeros((FIRST_SPHERE + len(arrays.spheres) + len(arrays.planes), 2))
    lobes[FLOOR:] = lobes_of(arrays)[:, 1:]
    scales = np.array([lobe_scale(arrays, exponent, theta_max) for exponent, theta_max in lobes.tolist()])
    bound = radiance_bound(arrays, lights, senders, emitted) + glow_bound(arrays, glows)
    return SplitScene(lights, view, scene_frames(arrays, view), lobes, scales, bound)


def alike(rows: Array) -> Ints:
    """A number of every hit class, the same of those that have the same column of ``rows`` (k, classes).

    Points of classes of one weight and one scale can be asked together: a tolerance of all is one of each lobe.
    """
    return np.unique(rows, axis=1, return_inverse=True)[1].reshape(-1)


def nearest_squares(arrays: SceneArrays, points: Table[LightPoint]) -> Array:
    """(L,) squared distance of every light that falls off from the nearest surface it lights, 1 of the others."""
    squares = np.ones(len(points))
    planes = frames(arrays.planes)
    over = heights(points["position"], planes["origin"], planes["up"])
    for i in np.flatnonzero(points["fall"] == INVERSE_SQUARE).tolist():
        place = points[i].position
        apart = [math.dist(place, sphere.center) - sphere.radius for sphere in arrays.spheres]
        apart += over[i].tolist()
        apart += [float(place[2])] if arrays.floor.present else []
        # what it is inside of or behind is not lit by it
        squares[i] = max(min((a for a in apart if a > 0.0), default=1.0) ** 2, TOUCHING)
    return squares


def radiance_bound(
    arrays: SceneArrays, points: Table[LightPoint], senders: Table[Sender] | None = None, emitted: Array | None = None
) -> float:  # fmt: skip
    """An upper bound of the radiance a lobe can meet, and of its distance from the background."""
    lit = arrays.shading.ka * arrays.shading.ambient
    color = points["color"] / nearest_squares(arrays, points)[:, None]
    lit = lit + color.sum(axis=0) * (arrays.shading.kd * largest_sent(senders) + arrays.shading.ks)
    shining = 0.0 if emitted is None else float(emitted.max(initial=0.0))
    return float(max(lit.max(), arrays.shading.background.max(), 1e-300) + shining)


def refuse_conductors(arrays: SceneArrays, conductors: Table[Conductor], surface: Ints) -> None:
    """Raise ``Unsupported``, by name, for what is not integrated under the lobe of a conductor."""
    classes = FIRST_SPHERE + len(arrays.spheres) + len(arrays.planes)
    if len(conductors) != classes:
        raise ValueError(f"conductors: {classes} rows are asked for, one a hit class; {len(conductors)} were given")
    if not ((conductors["alpha"] >= 0.0) & (conductors["alpha"] <= 1.0)).all():
        raise ValueError("conductors: alpha must be in [0, 1], 0 where a surface is no conductor")
    if not len(surface) or not (conductors["alpha"][surface] > 0.0).any():
        return
    if is_brdf(arrays):
        raise Unsupported("shading.lobe_units: brdf_normalised says nothing of a conductor; choose lobe_average")
