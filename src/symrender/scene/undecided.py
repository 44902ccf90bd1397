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


def one_surface(centre: Array, radius: Array, point: Array, normal: Array, eye: Array) -> tuple[int, int] | None:
    """Two of the spheres and planes that are one but for roundings, by their places among both; None if none are.

    ``centre`` (S, 3) and ``radius`` (S,) are of the spheres, ``point`` and ``normal`` (P, 3) of the planes after them.
    """
    count = len(radius)
    normal = normal / np.abs(normal).max(axis=1, keepdims=True, initial=0.0)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    away = np.linalg.norm(centre - eye, axis=1)
    unsure = ROUNDINGS * np.finfo(np.float64).eps * (np.abs(centre).max(axis=1, initial=0.0) + radius + away)
    height = ((centre[:, None] - point) * normal).sum(axis=2)
    far = np.linalg.norm(centre[:, None] - height[..., None] * normal - eye, axis=2)
    on_planes = np.argwhere(_ball_on_plane(np.abs(height), radius[:, None], unsure[:, None]) > PATCH * far).tolist()
    axes = np.ascontiguousarray(centre.T)
    for j in range(count):
        # what is further away than both radii shares nothing
        x, y, z = np.abs(axes[:, :j] - axes[:, j, None])
        some = np.flatnonzero(np.maximum(np.maximum(x, y), z) <= radius[:j] + radius[j] + unsure[j])
        if len(some):
            patch, place = _spheres_in_one(centre[some], radius[some], centre[j], radius[j], unsure[j])
            # a circle of crossing is somewhere on the sphere
            known = np.isfinite(place).all(axis=1)
            far = np.where(known, np.linalg.norm(place - eye, axis=1), abs(away[j] - radius[j]))
            for i in some[patch > PATCH * far]:
                return j, int(i)
        if on_planes and on_planes[0][0] == j:
            return j, count + on_planes[0][1]
    for j in range(len(point)):
        for k in range(j):
            between = np.linalg.norm(point[j] - point[k])
            reach = np.abs(point[j]).max() + between + np.linalg.norm(point[j] - eye)
            doubt = ROUNDINGS * np.finfo(np.float64).eps * reach
            sine = np.linalg.norm(np.cross(normal[j], normal[k]))
            # crossing planes are apart by their angle times the distance from where they cross
            if sine * reach * PATCH <= doubt and abs((point[j] - point[k]) @ normal[k]) <= doubt + sine * between:
                return count + j, count + k
    return None


def undecided(scene: Scene) -> str:
    """Which two shapes of a scene are one but for roundings, as words for a message; empty if none are."""
    arrays = scene_arrays(scene)
    there = [j for j, sphere in enumerate(arrays.spheres) if sphere.radius > MIN_LENGTH]
    names = [f"spheres.{scene.spheres[j].name}" for j in there] + [f"planes.{plane.name}" for plane in scene.planes]
    point, normal = ([list(getattr(plane, key)) for plane in arrays.planes] for key in ("point", "normal"))
    if arrays.floor.present:
        names, point, normal = [*names, "the floor"], [*point, [0.0, 0.0, 0.0]], [*normal, [0.0, 0.0, 1.0]]
    pair = one_surface(
        np.array([arrays.spheres[j].center for j in there]).reshape(-1, 3),
        np.array([arrays.spheres[j].radius for j in there]),
        np.array(point).reshape(-1, 3), np.array(normal).reshape(-1, 3), np.array(arrays.camera.eye),
    )  # fmt: skip
    return one_but_for_roundings(names[pair[0]], names[pair[1]]) if pair else ""


def one_but_for_roundings(one: str, other: str) -> str:
    """Words for two shapes that are one surface."""
    return f"{one} and {other} are one surface but for roundings, which decide which is seen; move or remove one"


def check_decided(scene: Scene) -> None:
    """Raise Unsupported where rounding decides which of two shapes is seen."""
    words = undecided(scene)
    if words:
        raise Unsupported(words)


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


def _ball_on_plane(height: Array, radius: Array, unsure: Array) -> Array:
    """Radius of the patch in which spheres are nearer than ``unsure`` to planes whose ``height`` over them is given."""
    with np.errstate(divide="ignore", invalid="ignore"):
        gap = height - radius
        touching = np.sqrt(2.0 * np.maximum(unsure - gap, 0.0) * radius)
        crossing = unsure / np.sqrt(np.maximum(1.0 - (height / radius) ** 2, 0.0))
    return np.where(gap >= 0.0, touching, np.minimum(crossing, touching))
