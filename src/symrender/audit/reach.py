"""How far the truth of a pixel is decided: what it changes by within the reach of a renderer's arithmetic.

A renderer of 32 bits looks along another ray than the one through the centre of a pixel, by some of its roundings, and
many start secondary rays a stated distance off the surface. Near an edge that is another value of the same truth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.regions import filled
from symrender.errors import SymrenderError, Unsupported
from symrender.images.image import Image
from symrender.probe import probe
from symrender.runtimes.glimpse import displaced_rays, displaced_rows, places_rows, plane_apart, shaken_rows
from symrender.scene.radiometric.arrays import FIRST_SHAPE, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Plane

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SHAKE: Final = 2.0**-21
"""Relative size of what 32-bit arithmetic does to the numbers of a scene, 4 units in the last place of its largest."""
SLANT: Final = 8.0
"""Lengths along a surface over the offset from it: a shadow's edge moves so far under a light 7 degrees high."""
_PLACES: Final = 2.0**-22
"""What a place in a square is rounded by, over half its side: one unit in the last place of its coordinates."""
_TURNS: Final = 8
"""Directions in which rays are displaced."""
_UNSEEN: Final = 1e100
"""Change of a pixel that shows what the exported scene does not hold."""
_KEPT: Final = 64
"""Most pixels whose sub-pixel truth is computed."""


@dataclass(frozen=True, eq=False)
class Reach:
    """What the truth changes by within reach: ``change`` (h, w, 3), largest, and ``far`` (h, w), the reach in lengths.

    ``less`` and ``more`` (h, w, 3) are the most that light in closed form falls and rises by. ``smooth`` (h, w, 3) is
    what light without edges may differ by, which is allowed for and sets nothing aside.
    """

    change: Array
    smooth: Array
    far: Array
    less: Array
    more: Array


@dataclass(frozen=True, eq=False)
class SubPixel:
    """Sub-pixel truth of one pixel: radiance along its own ray, and the least and most within reach, (3,) each."""

    column: int
    row: int
    truth: Array
    low: Array
    high: Array


def nowhere(size: tuple[int, int]) -> Reach:
    """No reach at all."""
    width, height = size
    none = np.zeros((height, width, 3))
    return Reach(none, none, none[..., 0], none, none)


def reach(
    scene: RadiometricScene, true: Image, single: bool, offset: tuple[float, float], placed: tuple[float, ...],
    halves: dict[str, float], filtered: bool, threads: int,
) -> Reach:  # fmt: skip
    """The reach of samples of 32 bits, where they are, and of secondary rays ``a + b max |p|`` off the place p.

    ``placed`` (scale, x, y, z): the renderer has places p at scale (p - (x, y, z)), and these are what it rounds.
    ``halves`` are half sides, in those lengths, of squares that stand for planes: what is beyond them is not seen, and
    places within are rounded as their sides are.
    Where pixels are means (``filtered``) an edge moves by a part of a pixel: that part of the difference of
    neighbours.
    """
    size = (true.width, true.height)
    arrays = radiometric_arrays(scene)
    try:
        there = filled(places_rows(arrays, *size), size, threads)
        still = filled(displaced_rows(arrays, *size, np.zeros(there.shape[:2]), 0.0), size, threads, 4)
    except Unsupported:
        # light that is sampled alone: nothing is known of its edges
        return nowhere(size)
    eye, scale = arrays.camera.eye, placed[0]
    held = scale * np.abs(there - np.array(placed[1:])).max(axis=-1)
    away = np.linalg.norm(there - eye, axis=-1)
    rounded = SHAKE * (np.maximum(held, scale * np.abs(eye - np.array(placed[1:])).max()) / scale + away) * single
    off = SLANT * (offset[0] + offset[1] * held) / scale
    change, smooth, less, more = np.zeros((4, *still.shape[:2], 3))
    beyond, loose = np.zeros(away.shape, dtype=bool), np.zeros_like(away)
    for number, shape in enumerate(scene.shapes, start=FIRST_SHAPE):
        if isinstance(shape, Plane) and shape.name in halves:
            beyond |= _clipped(scene, shape, size, halves[shape.name] / scale, filtered)
            loose[still[..., 3] == number] = _PLACES * halves[shape.name] / scale
    if filtered:
        step = 2.0 * math.tan(math.radians(scene.camera.fov) / 2.0) / size[1] * np.where(away > 0.0, away, np.inf)
        share = np.minimum((rounded + off) / step, 1.0)[..., None]
        smooth = share * _steps(true.radiance)
        return Reach(np.where(beyond[..., None], _UNSEEN, 0.0) + change, smooth, rounded + off, smooth, smooth)

    def heard(look: Array, where: Mask) -> Array:
        nonlocal less, more
        delta = np.where(where[..., None], look[..., :3] - still[..., :3], 0.0)
        less, more = np.maximum(less, -delta), np.maximum(more, delta)
        return delta

    if single:
        for rows in shaken_rows(arrays, *size, SHAKE)[1:]:
            look = filled(rows, size, threads, 4)
            change = np.maximum(change, np.abs(heard(look, np.ones(away.shape, dtype=bool))))
            # what bounces changes with the shape, and more than its direct light may
            other = (look[..., 3] != still[..., 3])[..., None]
            change = np.where(other, np.maximum(change, true.layer("indirect")), change)
    loose = loose * single
    off = off + loose
    if off.any():
        for turn in (0.0, 0.5 * math.pi):
            looks = [
                filled(displaced_rows(arrays, *size, part * off, turn + side), size, threads, 4)
                for part in (0.5, 1.0)
                for side in (0.0, math.pi)
            ]
            same = np.logical_and.reduce([look[..., 3] == still[..., 3] for look in looks])
            deltas = [heard(look, same) for look in looks]
            # of smooth light the second bend is four times the first: where secondary rays start does not move it
            change = np.maximum(change, np.abs(deltas[2] + deltas[3] - 4.0 * (deltas[0] + deltas[1])))
            # a place that is rounded has the light of another place, which where it is smooth is allowed for
            share = np.where(off > 0.0, loose / np.where(off > 0.0, 0.5 * off, 1.0), 0.0)[..., None]
            smooth = smooth + share * np.minimum(np.abs(deltas[0]), np.abs(deltas[1]))
            # an edge moves over light that has a slope, of which a side tells that has none between its two rays
            most = np.max(np.abs(deltas), axis=0)
            for half in (0, 1):
                slope = np.abs(deltas[2 + half] - deltas[half])
                slope = np.where(slope < 0.25 * most, 2.0 * slope, 0.0)
                less, more = less + slope, more + slope
        if true.layer("indirect").any():
            step = 2.0 * math.tan(math.radians(scene.camera.fov) / 2.0) / size[1] * np.where(away > 0.0, away, np.inf)
            share = np.minimum(off / SLANT / step, 1.0)[..., None]
            smooth = smooth + share * _steps(true.layer("indirect"))
    change[beyond] = _UNSEEN
    return Reach(change, smooth, rounded + off, less, more)


def _clipped(scene: RadiometricScene, plane: Plane, size: tuple[int, int], half: float, filtered: bool) -> Mask:
    """(h, w): pixels that show some of a plane beyond its square, whatever is before it; of their centres or whole."""
    corners = plane_apart(scene, plane, size, not filtered)
    if not filtered:
        return np.asarray((corners > half) & np.isfinite(corners))
    parts = np.stack([corners[:-1, :-1], corners[1:, :-1], corners[:-1, 1:], corners[1:, 1:]])
    return np.asarray((parts > half).any(axis=0) & np.isfinite(parts).any(axis=0))


def _steps(values: Array) -> Array:
    """Largest difference of a pixel from a neighbour."""
    found = np.zeros_like(values)
    for axis in (0, 1):
        step = np.abs(np.diff(values, axis=axis))
        before: list[slice] = [slice(None)] * 3
        after = before.copy()
        before[axis], after[axis] = slice(0, -1), slice(1, None)
        found[tuple(before)] = np.maximum(found[tuple(before)], step)
        found[tuple(after)] = np.maximum(found[tuple(after)], step)
    return found


def sub_pixel(
    scene: RadiometricScene, true: Image, known: Reach, which: Mask, order: Array, tol: float, threads: int
) -> tuple[SubPixel, ...]:
    """The truth within reach of the pixels ``which``, of ``order`` (h, w) the largest first."""
    rows, columns = np.nonzero(which)
    first = np.argsort(-order[rows, columns], kind="stable")[:_KEPT]
    rows, columns = rows[first], columns[first]
    arrays, size = radiometric_arrays(scene), (true.width, true.height)
    found = [true.radiance[rows, columns]]
    for k in range(_TURNS):
        rays = displaced_rays(arrays, *size, columns, rows, known.far[rows, columns], 2.0 * math.pi * k / _TURNS)
        try:
            found.append(probe(scene, rays=rays, tol=tol, threads=threads).radiance)
        except SymrenderError:
            # along single rays not everything has a truth that has one as an image
            break
    low = np.minimum(np.min(found, axis=0), found[0] - known.less[rows, columns])
    high = np.maximum(np.max(found, axis=0), found[0] + known.more[rows, columns])
    return tuple(
        SubPixel(int(c), int(r), found[0][k], low[k], high[k])
        for k, (c, r) in enumerate(zip(columns, rows, strict=True))
    )
