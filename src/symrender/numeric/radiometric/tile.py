"""The kernel of the path tracer: it fills a tile of pixels."""

from __future__ import annotations

from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.numeric.filters import CENTRE, tap
from symrender.numeric.radiometric.emitters import shining
from symrender.numeric.radiometric.environment import beyond
from symrender.numeric.radiometric.hits import first_hit
from symrender.numeric.radiometric.path import from_points, path, plus, scaled, shows, surface
from symrender.numeric.radiometric.shot import Shot, lens_place, lens_ray, put_moved
from symrender.numeric.radiometric.world import World
from symrender.numeric.random import Key, pixel_key, uniforms
from symrender.numeric.rays import window_direction
from symrender.numeric.samplers import INDEPENDENT
from symrender.numeric.vectors import Vector, unit
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import FIRST_SHAPE

_SHIFT: Final = 1 << 30
_PLACE: Final = _SHIFT + 1
_LENS: Final = _SHIFT + 2
_TIME: Final = _SHIFT + 3
"""Dimensions of random numbers that no path reaches."""

Sight = tuple[int, Vector, Vector, Vector, int]
"""Hit class, emitted, direct, indirect, rays spent."""


@inlined
def along_ray(world: World, eye: Vector, d: Vector, sampler: int, order: int, key: Key) -> Sight:
    """What comes back along a unit ray, the mean of order x order paths where chance has a part in it."""
    black = (0.0, 0.0, 0.0)
    hit = first_hit(world, eye, d, -1, -1, False)
    if hit.own < 0:
        return 0, beyond(world, d), black, black, 1
    emitted = shining(world, hit)
    if not shows(world, hit):
        return FIRST_SHAPE + hit.own, emitted, black, black, 1
    at = surface(world, hit, d)
    direct, indirect, spent = from_points(world, at), black, 1
    if world.extended or world.bounces > 0:
        count = order * order
        near, later = black, black
        for index in range(count):
            some, other, rays = path(world, at, sampler, order, key, index)
            near, later, spent = plus(near, some), plus(later, other), spent + rays
        direct = plus(direct, (near[0] / count, near[1] / count, near[2] / count))
        indirect = (later[0] / count, later[1] / count, later[2] / count)
    return FIRST_SHAPE + hit.own, emitted, direct, indirect, spent


@jitable
def step_of(u: float, count: int) -> int:
    """A step by chance, u in [0, 1), that has no factor in common with ``count``: it leads through all strata."""
    step = 1 + int(u * count)
    while True:
        a, b = step, count
        while b != 0:
            a, b = b, a % b
        if a == 1:
            return step
        step += 1


@jitable
def spread_out(
    world: World, shot: Shot, frame: Array, width: int, height: int, i: int, j: int, sampler: int, order: int, key: Key
) -> Sight:  # fmt: skip
    """The mean over a pixel's filter, the lens and the shutter: order x order paths, each through strata of its own.

    Strata of pixel, lens and time are taken in orders of their own, by chance, and so meet each other and those of the
    paths' first choices all over: shifts alone would pair the same ones however many paths there are. The hit class is
    that of the centre as the shutter opens.
    """
    count = order * order
    first, second = uniforms(key, 0, _SHIFT)
    third, fourth = uniforms(key, 1, _SHIFT)
    fifth, sixth = uniforms(key, 2, _SHIFT)
    by_place, by_lens, by_time = step_of(fourth, count), step_of(fifth, count), step_of(sixth, count)
    emitted, direct, indirect, spent = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1
    for index in range(count):
        a, b = uniforms(key, index, _PLACE)
        p, q = uniforms(key, index, _LENS)
        t, _ = uniforms(key, index, _TIME)
        if sampler != INDEPENDENT:
            stratum = (index * by_place + int(first * count)) % count
            a, b = (stratum // order + a) / order, (stratum % order + b) / order
            stratum = (index * by_lens + int(second * count)) % count
            p, q = (stratum % order + p) / order, (stratum // order + q) / order
            t = ((index * by_time + int(third * count)) % count + t) / count
        x, heavy = tap(shot.filter, shot.reach, a)
        y, other = tap(shot.filter, shot.reach, b)
        weight = heavy * other
        here = world
        if shot.moves:
            put_moved(world, shot, t)
            here = shot.world
        u, v = lens_place(shot.aperture, p, q)
        a, b = 2.0 * (i + 0.5 + x) / width - 1.0, 1.0 - 2.0 * (j + 0.5 + y) / height
        eye, d = lens_ray(frame, shot, t, a, b, u, v)
        hit = first_hit(here, eye, d, -1, -1, False)
        spent += 1
        share = (weight, weight, weight)
        if hit.own < 0:
            if world.sky >= 0:
                emitted = plus(emitted, scaled(beyond(world, d), share, 1.0))
            continue
        emitted = plus(emitted, scaled(shining(here, hit), share, 1.0))
        if not shows(here, hit):
            continue
        at = surface(here, hit, d)
        direct = plus(direct, scaled(from_points(here, at), share, 1.0))
        if world.extended or world.bounces > 0:
            near, later, rays = path(here, at, sampler, order, key, index)
            direct, indirect = plus(direct, scaled(near, share, 1.0)), plus(indirect, scaled(later, share, 1.0))
            spent += rays
    d = unit(window_direction(frame, 2.0 * (i + 0.5) / width - 1.0, 1.0 - 2.0 * (j + 0.5) / height))
    own = first_hit(world, (frame[1], frame[2], frame[3]), d, -1, -1, False).own
    share = (1.0 / count, 1.0 / count, 1.0 / count)
    return (
        FIRST_SHAPE + own if own >= 0 else 0,
        scaled(emitted, share, 1.0), scaled(direct, share, 1.0), scaled(indirect, share, 1.0), spent,
    )  # fmt: skip


def fill_tile(
    world: World, shot: Shot, frame: Array, width: int, height: int, x0: int, y0: int, x1: int, y1: int, sampler: int,
    order: int, seed: int, emitted: Array, direct: Array, indirect: Array, hit_class: Array,
) -> int:  # fmt: skip
    """Fill columns x0:x1 of rows y0:y1 of the full-frame layers; returns the rays that took.

    Arguments are many because a kernel takes numbers and arrays.
    """
    spent = 0
    eye = (frame[1], frame[2], frame[3])
    for j in range(y0, y1):
        for i in range(x0, x1):
            key = pixel_key(seed, i, j)
            if shot.filter != CENTRE or shot.moves or shot.aperture > 0.0:
                own, light, near, later, rays = spread_out(world, shot, frame, width, height, i, j, sampler, order, key)
            else:
                d = unit(window_direction(frame, 2.0 * (i + 0.5) / width - 1.0, 1.0 - 2.0 * (j + 0.5) / height))
                own, light, near, later, rays = along_ray(world, eye, d, sampler, order, key)
            hit_class[j, i] = own
            spent += rays
            for c in range(3):
                emitted[j, i, c] = light[c]
                direct[j, i, c] = near[c]
                indirect[j, i, c] = later[c]
    return spent


def fill_rays(
    world: World, origins: Array, directions: Array, sampler: int, order: int, seed: int, emitted: Array,
    direct: Array, indirect: Array, hit_class: Array,
) -> None:  # fmt: skip
    """Answer for every unit ray, a row of the arrays each."""
    for k in range(origins.shape[0]):
        eye = (origins[k, 0], origins[k, 1], origins[k, 2])
        d = (directions[k, 0], directions[k, 1], directions[k, 2])
        own, shining, near, later, _ = along_ray(world, eye, d, sampler, order, pixel_key(seed, k, 0))
        hit_class[k] = own
        for c in range(3):
            emitted[k, c] = shining[c]
            direct[k, c] = near[c]
            indirect[k, c] = later[c]
