"""Shapes that lie in each other but for roundings, so that nobody can say which of them is seen.

Two surfaces are told apart where they are further from each other than double precision moves them. Where they are
not, a ray meets the one or the other by the last bits of its sums, and a value that is stated to 1e-5 may be that of
the wrong shape. Such a patch is harmless while it is small: spheres that touch share one of some 1e-7 of their radius.
A patch that the eye would see larger than ``PATCH`` makes the scene undecided.

A sphere equal to an earlier one is not there (``scene/arrays.py``), so equal spheres are decided.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.limits import MIN_LENGTH
from symrender.scene.arrays import scene_arrays
from symrender.scene.scene import Scene

ROUNDINGS: Final = 16.0
"""Largest distance of two surfaces that is not told, in roundings of the largest number of the place."""
PATCH: Final = 1e-3
"""Largest patch in doubt, as seen from the eye, radians."""

Array = npt.NDArray[np.float64]


def undecided(scene: Scene) -> str:
    """Which two shapes of a scene are one but for roundings, as words for a message; empty if none are."""
    arrays = scene_arrays(scene)
    spheres, planes = arrays.spheres, arrays.planes
    centre = np.array([sphere.center for sphere in spheres]).reshape(-1, 3)
    radius = np.array([sphere.radius for sphere in spheres])
    there = radius > MIN_LENGTH
    normal = np.array([plane.normal for plane in planes]).reshape(-1, 3)
    point = np.array([plane.point for plane in planes]).reshape(-1, 3)
    surfaces = [f"planes.{plane.name}" for plane in scene.planes]
    if arrays.floor.present:
        normal, point = np.vstack([normal, [0.0, 0.0, 1.0]]), np.vstack([point, np.zeros(3)])
        surfaces.append("the floor")
    normal = normal / np.abs(normal).max(axis=1, keepdims=True, initial=0.0)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    eye = np.array(arrays.camera.eye)
    away = np.linalg.norm(centre - eye, axis=1)
    unsure = ROUNDINGS * np.finfo(np.float64).eps * (np.abs(centre).max(axis=1, initial=0.0) + radius + away)
    for j in range(len(radius)):
        if not there[j]:
            continue
        name = f"spheres.{scene.spheres[j].name}"
        patch, place = _spheres_in_one(centre[:j], radius[:j], centre[j], radius[j], unsure[j])
        # a circle of crossing is somewhere on the sphere
        far = np.where(np.isfinite(place).all(axis=1), np.linalg.norm(place - eye, axis=1), abs(away[j] - radius[j]))
        for i in np.flatnonzero(there[:j] & (patch > PATCH * far)):
            return _words(name, f"spheres.{scene.spheres[i].name}")
        height = ((centre[j] - point) * normal).sum(axis=1)
        far = np.linalg.norm(centre[j] - height[:, None] * normal - eye, axis=1)
        for i in np.flatnonzero(_ball_on_plane(np.abs(height), radius[j], unsure[j]) > PATCH * far):
            return _words(name, surfaces[i])
    for j in range(len(surfaces)):
        for k in range(j):
            between = np.linalg.norm(point[j] - point[k])
            reach = np.abs(point[j]).max() + between + np.linalg.norm(point[j] - eye)
            doubt = ROUNDINGS * np.finfo(np.float64).eps * reach
            sine = np.linalg.norm(np.cross(normal[j], normal[k]))
            # crossing planes are apart by their angle times the distance from where they cross
            if sine * reach * PATCH <= doubt and abs((point[j] - point[k]) @ normal[k]) <= doubt + sine * between:
                return _words(surfaces[j], surfaces[k])
    return ""


def check_decided(scene: Scene) -> None:
    """Raise Unsupported where rounding decides which of two shapes is seen."""
    words = undecided(scene)
    if words:
        raise Unsupported(words)


def _words(one: str, other: str) -> str:
    return f"{one} and {other} are one surface but for roundings, which decide which is seen; move or remove one"


def _spheres_in_one(centres: Array, radius: Array, centre: Array, own: float, unsure: float) -> tuple[Array, Array]:
    """Radius of the patch in which spheres are nearer than ``unsure`` to one sphere, and its place, NaN of a circle."""
    apart = centre - centres
    distance = np.linalg.norm(apart, axis=1)
    differ = np.abs(radius - own)
    inside, outside = differ - distance, distance - (radius + own)
    with np.errstate(divide="ignore", invalid="ignore"):
        # within each other the gap is inside + distance (1 - cos)
        share = np.where(distance > 0, 2.0 * (unsure - inside) / distance, np.inf)
        within = np.where(inside < unsure, own * np.sqrt(np.clip(share, 0.0, 1.0)), 0.0)
        touching = np.sqrt(2.0 * np.maximum(unsure - outside, 0.0) * radius * own / (radius + own))
        # twice the area of the triangle of both radii and the distance, over the product of the radii
        area = (distance**2 - differ**2) * ((radius + own) ** 2 - distance**2)
        crossing = unsure * 2.0 * radius * own / np.sqrt(np.maximum(area, 0.0))
        ahead = np.where(outside >= 0.0, -1.0, np.where(radius > own, 1.0, -1.0))
        place = centre + (ahead * own / distance)[:, None] * apart
    place[(inside < 0.0) & (outside < 0.0)] = np.nan
    patch = np.where(inside >= 0.0, within, np.where(outside >= 0.0, touching, np.minimum(crossing, own)))
    return np.asarray(patch), place


def _ball_on_plane(height: Array, radius: float, unsure: float) -> Array:
    """Radius of the patch in which a sphere is nearer than ``unsure`` to planes its centre is ``height`` away from."""
    with np.errstate(divide="ignore", invalid="ignore"):
        gap = height - radius
        touching = np.sqrt(2.0 * np.maximum(unsure - gap, 0.0) * radius)
        crossing = unsure / np.sqrt(np.maximum(1.0 - (height / radius) ** 2, 0.0))
    return np.where(gap >= 0.0, touching, np.minimum(crossing, touching))
