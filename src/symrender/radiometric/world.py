"""The world the symbolic kernels of radiometric scenes see, and its camera."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pieces import Piece, laid_pieces
from symrender.radiometric.vectors import Array
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.scene.radiometric.records import Light, Material
from symrender.scene.records import Camera


class World(NamedTuple):
    """The records of a scene, its shapes as what they are made of."""

    materials: Table[Material]
    pieces: Table[Piece]
    lights: Table[Light]


def make_world(arrays: RadiometricArrays) -> World:
    """World of a scene."""
    return World(arrays.materials, laid_pieces(arrays.shapes, arrays.frames), arrays.lights)


class Seen(NamedTuple):
    """A world and who looks at it: what the kernel of an image takes; of slopes their twin."""

    world: World
    eye: Array
    window: Array


def seen(arrays: RadiometricArrays, width: int, height: int) -> Seen:
    """A scene as its kernel takes it."""
    eye = np.ascontiguousarray(arrays.camera.eye)
    return Seen(make_world(arrays), eye, camera_window(arrays.camera, width, height))


def camera_window(camera: Camera, width: int, height: int) -> Array:
    """(3, 3): forward, right and up; the last two reach from the middle to the edges of the window at distance 1."""
    axes = np.array(leaves.perspective_axes(*camera.eye, *camera.target, *camera.up)).reshape(3, 3)
    half = math.tan(math.radians(float(camera.fov)) / 2)
    axes[1] *= half * width / height
    axes[2] *= half
    return axes
