"""The world the symbolic kernels of radiometric scenes see, and its camera."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.bounds import Bound, laid_bounds
from symrender.radiometric.pieces import Piece, laid_pieces
from symrender.radiometric.vectors import Array
from symrender.scene.frames import heights
from symrender.scene.radiometric.arrays import DIRECTIONAL, POINT, SPHERE, SPOT, RadiometricArrays
from symrender.scene.radiometric.records import Light, Material, Term
from symrender.scene.records import Camera


class World(NamedTuple):
    """The records of a scene, its shapes as what they are made of, and the hierarchy of bounds over these.

    ``level`` (lights, pieces) is 1 where a point, a spot or the rays of a directional light lie in the plane of a flat
    piece, which is then seen edge-on from the light and hides nothing of it.
    """

    materials: Table[Material]
    terms: Table[Term]
    pieces: Table[Piece]
    lights: Table[Light]
    bounds: Table[Bound]
    level: Array


def make_world(arrays: RadiometricArrays, like: World | None = None) -> World:
    """World of a scene.

    Bounds and what is level are those of the same scene before it was shaken, if that is given as ``like``.
    """
    pieces = laid_pieces(arrays)
    bounds, level = (like.bounds, like.level) if like else (laid_bounds(pieces), _level(arrays, pieces))
    return World(arrays.materials, arrays.terms, pieces, arrays.lights, bounds, level)


def _level(arrays: RadiometricArrays, pieces: Table[Piece]) -> Array:
    """``level`` of a world."""
    places, ups = np.asarray(pieces["place"]), np.asarray(pieces["up"])
    lights = np.asarray(arrays.lights["place"])
    kinds = np.asarray(arrays.lights["kind"])[:, None]
    level = np.where(
        kinds == DIRECTIONAL, heights(lights, np.zeros_like(places), ups) == 0.0,
        np.isin(kinds, (POINT, SPOT)) & (heights(lights, places, ups) == 0.0),
    )  # fmt: skip
    return np.asarray(level & (np.asarray(pieces["kind"]) != SPHERE), dtype=np.float64)


def make_worlds(scenes: Sequence[RadiometricArrays]) -> list[World]:
    """Worlds of a scene and of the same scene shaken."""
    first = make_world(scenes[0])
    return [first, *(make_world(each, first) for each in scenes[1:])]


class Seen(NamedTuple):
    """A world and who looks at it: what the kernel of an image takes; of slopes their twin."""

    world: World
    eye: Array
    window: Array


def seen(arrays: RadiometricArrays, width: int, height: int, world: World | None = None) -> Seen:
    """A scene as its kernel takes it; its ``world``, if there is one already."""
    eye = np.ascontiguousarray(arrays.camera.eye)
    return Seen(world or make_world(arrays), eye, camera_window(arrays.camera, width, height))


def seen_all(scenes: Sequence[RadiometricArrays], width: int, height: int) -> list[Seen]:
    """The same of a scene and of the same scene shaken."""
    return [seen(each, width, height, world) for each, world in zip(scenes, make_worlds(scenes), strict=True)]


def camera_window(camera: Camera, width: int, height: int) -> Array:
    """(3, 3): forward, right and up; the last two reach from the middle to the edges of the window at distance 1."""
    axes = np.array(leaves.perspective_axes(*camera.eye, *camera.target, *camera.up)).reshape(3, 3)
    half = math.tan(math.radians(float(camera.fov)) / 2)
    axes[1] *= half * width / height
    axes[2] *= half
    return axes
