"""How a radiometric world moves with a parameter, and the kernel that pushes an image forward."""

from __future__ import annotations

import math
from functools import lru_cache
from types import ModuleType
from typing import NamedTuple

import numpy as np

from symrender.jit.generated import load_module
from symrender.jit.records import copied, flat, grid, record, table
from symrender.leaves import radiometric as leaves
from symrender.radiometric import direct, tile
from symrender.radiometric.pushforward import pushed
from symrender.radiometric.world import Array, World, camera_window, make_world
from symrender.scene.arrays import PLANE
from symrender.scene.frames import frame_moves, turned
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import DIRECTIONAL, RadiometricArrays, laid_out, plane_record
from symrender.scene.radiometric.records import Light, Material, Shape
from symrender.scene.records import Camera, Frame, Plane

SHAKE = 2.0**-46
"""Relative size of what the numbers of a scene are shaken by, 64 roundings."""


class Seen(NamedTuple):
    """A world and who looks at it: what the kernel of an image takes; of slopes their twin."""

    world: World
    eye: Array
    window: Array


@lru_cache(maxsize=1)
def pushed_text() -> str:
    """Text of the kernel ``fill_tile_dot``, and of what turns with the camera."""
    passive = (direct.sharpness, direct.vein_blur, direct.largest)
    return pushed((tile.fill_tile, leaves.perspective_axes), passive)


def pushed_module() -> ModuleType:
    """The module that ``pushed_text`` is the text of."""
    return load_module(pushed_text())


def seen(arrays: RadiometricArrays, width: int, height: int) -> Seen:
    """A scene as its kernel takes it."""
    eye = np.ascontiguousarray(arrays.camera.eye)
    return Seen(make_world(arrays), eye, camera_window(arrays.camera, width, height))


def seen_moves(arrays: RadiometricArrays, move: Move, width: int, height: int) -> Seen:
    """How that moves with the parameter of ``move``."""
    materials, shapes = table(Material, len(arrays.materials)), table(Shape, len(arrays.shapes))
    lights, directions = table(Light, len(arrays.lights)), np.zeros_like(arrays.directions)
    camera = record(Camera)
    parts = {"materials": flat(materials), "shapes": flat(shapes), "lights": flat(lights), "camera": flat(camera)}
    for name, index in move[1]:
        (parts | {"directions": directions})[name][index] = 1.0
    places = table(Frame, len(shapes))
    for j, shape in enumerate(arrays.shapes):
        if shape.kind == PLANE and flat(shapes)[j].any():
            moving = grid(Plane, 1, 1)
            moving[0][0] = plane_record(shapes[j])[0]
            places[j] = frame_moves(plane_record(shape), moving)[0, 0]
    for i, light in enumerate(arrays.lights):
        if light.kind == DIRECTIONAL:
            lights[i].place[:] = turned(arrays.directions[i], directions[i])
    window = _window_moves(arrays.camera, camera, width, height)
    return Seen(World(materials, shapes, places, lights), np.ascontiguousarray(camera.eye), window)


def _window_moves(camera: Camera, moves: Camera, width: int, height: int) -> Array:
    """How ``camera_window`` moves."""
    given = (*camera.eye, *camera.target, *camera.up, *moves.eye, *moves.target, *moves.up)
    axes, turns = pushed_module().perspective_axes_dot(*map(float, given))
    half = math.tan(math.radians(float(camera.fov)) / 2)
    wider = (1.0 + half * half) * math.radians(float(moves.fov)) / 2
    rows, turned_rows = np.array(axes).reshape(3, 3), np.array(turns).reshape(3, 3)
    aspect = np.array([[width / height], [1.0]])
    turned_rows[1:] = aspect * (half * turned_rows[1:] + wider * rows[1:])
    return turned_rows


def shaken(arrays: RadiometricArrays, number: int) -> RadiometricArrays:
    """The scene with every number moved by up to ``SHAKE`` of its size: what roundings could have made of it.

    Places are moved by that part of the largest coordinate of the scene, in which the way of a ray is rounded.
    """
    rng = np.random.default_rng(number)
    size = max(
        [1e-300, float(np.abs(arrays.camera.eye).max()), float(np.abs(arrays.camera.target).max())]
        + [float(np.abs(shape.place).max()) for shape in arrays.shapes]
    )

    def moved(v: Array, by: float) -> Array:
        return np.asarray(v + SHAKE * by * rng.uniform(-1.0, 1.0, np.shape(v)))

    materials, shapes, lights = copied(arrays.materials), copied(arrays.shapes), copied(arrays.lights)
    for material in materials:
        for name in ("bright", "dark", "eta", "k"):
            v = getattr(material, name)
            v[:] = v * moved(np.ones(3), 1.0)
        for name in ("cell", "alpha", "exponent"):
            setattr(material, name, getattr(material, name) * float(moved(np.ones(()), 1.0)))
    for shape in shapes:
        shape.place[:] = moved(shape.place, size)
        shape.radius *= float(moved(np.ones(()), 1.0))
        for v in (shape.normal, shape.along):
            v[:] = moved(v, float(np.abs(v).max()))
    for light in lights:
        light.place[:] = moved(light.place, max(size, float(np.abs(light.place).max())))
        light.emitted[:] = light.emitted * moved(np.ones(3), 1.0)
    directions = np.array([moved(v, float(np.abs(v).max())) for v in arrays.directions]).reshape(-1, 3)
    camera = record(Camera)
    flat(camera)[:] = flat(arrays.camera)
    camera.eye[:], camera.target[:] = moved(camera.eye, size), moved(camera.target, size)
    camera.up[:] = moved(camera.up, float(np.abs(camera.up).max()))
    camera.fov = camera.fov * float(moved(np.ones(()), 1.0))
    return laid_out(materials, shapes, lights, directions, camera, arrays.bounces)
