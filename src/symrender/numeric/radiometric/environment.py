"""What comes from where a ray meets nothing: a sky of one radiance, or an image of all directions.

Directions of an image are chosen by its luminance, bilinear between pixels as its radiance is, times the solid angle of
the cell: between four centres of pixels of a map by longitude and latitude, a pixel where there is no interpolation.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.radiometric.maps import (
    band_edges,
    band_share,
    chosen_cell,
    linear_place,
    luminance,
    polar,
    row_shift,
    row_step,
    square_of,
    way_of,
)
from symrender.numeric.radiometric.pictures import colour, texel, turn_of, wrapped
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, triple
from symrender.scene.radiometric.arrays import SKY
from symrender.scene.radiometric.detail import BILINEAR, CENTRES, CLAMP, EQUAL_AREA, REPEAT, Picture

UNIFORM: Final = 1.0 / (2.0 * math.pi)
"""Density of a direction of the hemisphere."""


@inlined
def own_way(picture: Picture, d: Vector) -> Vector:
    """A direction of the world in the coordinates of a map."""
    t = picture.turn
    return (
        t[0] * d[0] + t[1] * d[1] + t[2] * d[2],
        t[3] * d[0] + t[4] * d[1] + t[5] * d[2],
        t[6] * d[0] + t[7] * d[1] + t[8] * d[2],
    )


@inlined
def world_way(picture: Picture, d: Vector) -> Vector:
    """A direction of the coordinates of a map in the world."""
    t = picture.turn
    return (
        t[0] * d[0] + t[3] * d[1] + t[6] * d[2],
        t[1] * d[0] + t[4] * d[1] + t[7] * d[2],
        t[2] * d[0] + t[5] * d[1] + t[8] * d[2],
    )


@jitable
def map_colour(world: World, picture: Picture, way: Vector) -> Vector:
    """The colour of a map in a direction of its own."""
    if picture.grid == EQUAL_AREA:
        p, q = square_of(way)
        return colour(world, picture, p * picture.wide - 0.5, q * picture.high - 0.5, CLAMP, CLAMP)
    x = turn_of(way[1], way[0]) * picture.wide - 0.5
    y = polar(way) / row_step(picture)
    return colour(world, picture, x, y - 0.5 if picture.grid == CENTRES else y, REPEAT, CLAMP)


@jitable
def map_density(world: World, picture: Picture, way: Vector) -> float:
    """Density, per solid angle, with which a direction of a map is chosen."""
    bands = world.sky_rows.shape[0] - 1
    total: float = world.sky_rows[bands]
    if total <= 0.0:
        return 0.0
    level: float = luminance(map_colour(world, picture, way)) / total
    if picture.grid == EQUAL_AREA:
        return level * picture.wide * picture.high / (4.0 * math.pi)
    angle = polar(way)
    k = min(np.floor(angle / row_step(picture) + row_shift(picture)), bands - 1.0)
    low, high = band_edges(picture, k)
    wide = max((high - low) * math.sin(angle), 1e-300)
    return level * band_share(low, high) * picture.wide / (2.0 * math.pi * wide)


@jitable
def map_sample(world: World, picture: Picture, a: float, b: float) -> Vector:
    """A direction of a map, in its coordinates, by two numbers of [0, 1)."""
    bands = world.sky_rows.shape[0] - 1
    x = a * world.sky_rows[bands]
    row = chosen_cell(world.sky_rows, x)
    a = (x - world.sky_rows[row]) / (world.sky_rows[row + 1] - world.sky_rows[row])
    sums = world.sky_columns[row]
    x = b * sums[sums.shape[0] - 1]
    column = chosen_cell(sums, x)
    b = (x - sums[column]) / (sums[column + 1] - sums[column])
    if picture.grid == EQUAL_AREA:
        return way_of((column + b) / picture.wide, (row + a) / picture.high)
    low, high = band_edges(picture, 1.0 * row)
    f, g = b, a
    if picture.filter == BILINEAR:
        upper = 1.0 * row - (1.0 if picture.grid == CENTRES else 0.0)
        above, below = wrapped(upper, picture.high, CLAMP), wrapped(upper + 1.0, picture.high, CLAMP)
        left, right = 1.0 * column, wrapped(column + 1.0, picture.wide, REPEAT)
        p, q = luminance(texel(world, picture, left, above)), luminance(texel(world, picture, right, above))
        r, s = luminance(texel(world, picture, left, below)), luminance(texel(world, picture, right, below))
        g = linear_place(a, p + q, r + s)
        f = linear_place(b, p + g * (r - p), q + g * (s - q)) + 0.5
    angle, turn = low + g * (high - low), 2.0 * math.pi * (column + f) / picture.wide
    return (math.sin(turn) * math.sin(angle), math.cos(turn) * math.sin(angle), math.cos(angle))


@jitable
def beyond(world: World, d: Vector) -> Vector:
    """What comes from where a unit ray meets nothing."""
    if world.sky < 0:
        return (0.0, 0.0, 0.0)
    light = world.lights[world.sky]
    if light.kind == SKY:
        return triple(light.emitted)
    picture = world.pictures[int(light.emitter)]
    c = map_colour(world, picture, own_way(picture, d))
    return (light.emitted[0] * c[0], light.emitted[1] * c[1], light.emitted[2] * c[2])


@jitable
def sky_chance(world: World, d: Vector) -> float:
    """Density of a direction: uniform in a hemisphere of a sky, by the image of an environment."""
    light = world.lights[world.sky]
    if light.kind == SKY:
        return UNIFORM
    picture = world.pictures[int(light.emitter)]
    return map_density(world, picture, own_way(picture, d))


@jitable
def sky_way(world: World, a: float, b: float) -> Vector:
    """A direction of an environment, by two numbers of [0, 1)."""
    picture = world.pictures[int(world.lights[world.sky].emitter)]
    if world.sky_rows[world.sky_rows.shape[0] - 1] <= 0.0:
        return world_way(picture, (0.0, 0.0, 1.0))
    return world_way(picture, map_sample(world, picture, a, b))
