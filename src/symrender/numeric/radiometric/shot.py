"""Where a path of an image begins: its place in the pixel, in the lens, and its instant, drawn at random."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import copied
from symrender.numeric.filters import FILTERS
from symrender.numeric.radiometric.world import World
from symrender.numeric.rays import window_direction
from symrender.numeric.vectors import Vector, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import POINT, SPOT, TRIANGLE, RadiometricArrays
from symrender.settings import Settings


class Shot(NamedTuple):
    """What an image is a mean over beside paths; ``world`` is written anew at the instant of every path."""

    filter: int
    reach: float
    aperture: float
    focus: float
    moves: bool
    world: World
    shapes: Array
    lights: Array
    camera: Array


def make_shot(arrays: RadiometricArrays, world: World, settings: Settings) -> Shot:
    """The shot of a scene, with a world of its own; velocities become ways while the shutter is open."""
    exposure = arrays.exposure
    own = world._replace(shapes=copied(world.shapes), frames=copied(world.frames), lights=copied(world.lights))
    ways = (np.ascontiguousarray(v * exposure.duration) for v in (exposure.shapes, exposure.lights, exposure.camera))
    return Shot(FILTERS[settings.filter], settings.reach, exposure.aperture, exposure.focus, exposure.moves, own, *ways)


@jitable
def put_moved(world: World, shot: Shot, t: float) -> None:
    """Write where shapes and lights are when the share ``t`` of the time has passed."""
    there = shot.world
    for j in range(world.shapes.shape[0]):
        for c in range(3):
            way = t * shot.shapes[j, c]
            there.shapes[j].place[c] = world.shapes[j].place[c] + way
            there.frames[j].origin[c] = world.frames[j].origin[c] + way
            if world.shapes[j].kind == TRIANGLE:
                there.shapes[j].second[c] = world.shapes[j].second[c] + way
                there.shapes[j].third[c] = world.shapes[j].third[c] + way
    for i in range(world.lights.shape[0]):
        kind = world.lights[i].kind
        if kind in (POINT, SPOT):
            for c in range(3):
                there.lights[i].place[c] = world.lights[i].place[c] + t * shot.lights[i, c]


@inlined
def lens_place(aperture: float, a: float, b: float) -> tuple[float, float]:
    """A place of the lens, uniform over its area."""
    radius = aperture * math.sqrt(a)
    return radius * math.cos(2.0 * math.pi * b), radius * math.sin(2.0 * math.pi * b)


@jitable
def lens_ray(
    frame: Array, shot: Shot, t: float, a: float, b: float, x: float, y: float
) -> tuple[Vector, Vector]:  # fmt: skip
    """(origin, unit direction) of the ray from a place of the lens to where (a, b) of the window is sharp."""
    way = window_direction(frame, a, b)
    wide = math.sqrt(frame[7] ** 2 + frame[8] ** 2 + frame[9] ** 2)
    tall = math.sqrt(frame[10] ** 2 + frame[11] ** 2 + frame[12] ** 2)
    shift = (
        x * frame[7] / wide + y * frame[10] / tall,
        x * frame[8] / wide + y * frame[11] / tall,
        x * frame[9] / wide + y * frame[12] / tall,
    )  # fmt: skip
    origin = (
        frame[1] + t * shot.camera[0] + shift[0],
        frame[2] + t * shot.camera[1] + shift[1],
        frame[3] + t * shot.camera[2] + shift[2],
    )  # fmt: skip
    d = (shot.focus * way[0] - shift[0], shot.focus * way[1] - shift[1], shot.focus * way[2] - shift[2])
    return origin, unit(d)
