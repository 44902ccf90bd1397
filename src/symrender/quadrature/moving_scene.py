"""A scene as the split rule takes it, moving with up to four of its parameters at once.

What kernels read is derived of the scene's records by a kernel itself, given records that move: points that stand for
lights, frames of planes, and all that is carried into these.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import DISTANT, INVERSE_SQUARE, LightPoint, Side
from symrender.chambers.work import Frames, View
from symrender.jit.call import racked
from symrender.jit.compiled import compiled
from symrender.jit.marks import jitable
from symrender.jit.moving import held
from symrender.jit.records import Table
from symrender.jit.twins import moving_by
from symrender.jit.types import LANES, SEVERAL
from symrender.leaves.values import disk_frame
from symrender.quadrature.split_scene import SplitScene
from symrender.scene import arrays as at
from symrender.scene.arrays import DISK, FALLING, FIRST_SPHERE, SceneArrays
from symrender.scene.moves import SceneMoves
from symrender.scene.records import Frame, Light, Plane, Sphere
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

UP_IS_Y: Final = 0.9
"""Largest height of the direction a disk faces along up to which its frame is turned about y."""


@dataclass(frozen=True)
class MovingScene:
    """What kernels are given of a scene that moves with the parameters ``first`` to ``stop`` - 1.

    ``pace`` (``LANES``,) is how fast the scene's numbers move with each parameter, at most. ``stirs``: whether lights,
    the eye, planes or what shapes share move.
    """

    first: int
    stop: int
    view: View
    frames: Frames
    lobes: Any
    pace: Array
    stirs: bool


def moving_scenes(arrays: SceneArrays, split: SplitScene, moved: SceneMoves, disk_order: int) -> list[MovingScene]:
    """``arrays``, made ready as ``split``, moving with all parameters of ``moved``, some at a time."""
    count = len(moved.floor)
    return [
        _moving(arrays, split, moved, range(first, min(first + LANES, count)), disk_order)
        for first in range(0, count, LANES)
    ]


def _moving(arrays: SceneArrays, split: SplitScene, moved: SceneMoves, part: range, disk_order: int) -> MovingScene:
    still, first = split.view, 1 if arrays.floor.present else 0

    def moves(name: str) -> Sequence[Any]:
        return [getattr(moved, name)[q] for q in part]

    spheres, planes = moving_by(arrays.spheres, moves("spheres")), moving_by(arrays.planes, moves("planes"))
    lights, floor = moving_by(arrays.lights, moves("lights")), moving_by(arrays.floor, moves("floor"))
    shading = moving_by(arrays.shading, moves("shading"))
    eye = moving_by(still.eye, [np.ascontiguousarray(moved.camera["eye"][q]) for q in part])
    axes, points, sides = (moving_by(each, ()) for each in (split.frames.axes, split.lights, still.sides))
    _axes_kernel()(planes, axes[first:], sides)
    _points_kernel()(lights, disk_order, points)
    classes = FIRST_SPHERE + len(spheres) + len(planes)
    lobes = np.zeros((classes, 2), SEVERAL)
    for row, name in enumerate(("exponent", "theta_max")):
        lobes[1, row] = np.asarray(floor)[name]
        lobes[FIRST_SPHERE : FIRST_SPHERE + len(spheres), row] = spheres[name]
        lobes[FIRST_SPHERE + len(spheres) :, row] = planes[name]
    view = still._replace(spheres=spheres, floor=floor, points=points, shading=shading, eye=eye, sides=sides)
    views = []
    for k, own in enumerate(split.frames.views):
        framed = [moving_by(each, ()) for each in (own.spheres, own.points, own.sides, own.eye)]
        _carry_kernel()(axes[k], k, own.over[k], spheres, points, sides, eye, *framed)
        ground = floor
        if k >= first:
            ground = moving_by(own.floor, ())
            for name in ("cell", "bright", "dark", "offset", "weight", "exponent", "theta_max"):
                ground[name] = planes[k - first][name]
        views.append(view._replace(spheres=framed[0], floor=ground, points=framed[1], sides=framed[2], eye=framed[3]))
    pace = np.zeros(LANES)
    for lane, q in enumerate(part):
        pace[lane] = max(_fastest(getattr(moved, name)[q]) for name in moved.__dataclass_fields__)
    shared = any(
        _fastest(getattr(moved, name)[part.start : part.stop]) > 0.0 for name in ("lights", "shading", "camera")
    )
    stirs = shared or any(
        _fastest(moved.planes[name][part.start : part.stop]) > 0.0 for name in ("point", "normal", "along")
    )
    return MovingScene(
        part.start, part.stop, view, Frames(axes, split.frames.homes, racked(view, views)), lobes, pace, stirs
    )


def _fastest(rows: Any) -> float:
    """The largest magnitude of numbers, or of records of them."""
    whole = np.asarray(rows).reshape(-1)
    columns = [whole] if whole.dtype.names is None else [whole[name] for name in whole.dtype.names]
    return max(float(np.abs(column).max(initial=0.0)) for column in columns)


def lay_axes(planes: Table[Plane], axes: Table[Frame], sides: Table[Side]) -> None:
    """The frames of planes, up = unit(normal), east = unit(along - (along.up) up), north = up x east; all sides."""
    first = sides.shape[0] - planes.shape[0]
    for k in range(planes.shape[0]):
        plane, row = planes[k], axes[k]
        level = 0.0
        unit(plane.normal, row.up)
        for a in range(3):
            row.origin[a] = plane.point[a]
            level += plane.along[a] * row.up[a]
        for a in range(3):
            row.north[a] = plane.along[a] - level * row.up[a]
        unit(row.north, row.east)
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            row.north[a] = row.up[b] * row.east[c] - row.up[c] * row.east[b]
        side = sides[first + k]
        side.level = 0.0
        for a in range(3):
            side.up[a] = row.up[a]
            side.level += row.up[a] * row.origin[a]


@jitable
def unit(v: Array, out: Array) -> None:
    """The unit vector along ``v``."""
    most = max(abs(v[0]), abs(v[1]), abs(v[2]))
    x, y, z = v[0] / most, v[1] / most, v[2] / most
    size = math.sqrt(x * x + y * y + z * z)
    out[0], out[1], out[2] = x / size, y / size, z / size


def lay_points(lights: Table[Light], order: int, points: Table[LightPoint]) -> None:
    """The points that stand for lights, exact disks behind all others."""
    n = 0
    for turn in range(2):
        for l in range(lights.shape[0]):
            light = lights[l]
            exact = light.kind == DISK and order == EXACT_DISK
            if exact != (turn == 1):
                continue
            if light.kind != DISK:
                for a in range(3):
                    points[n].position[a], points[n].color[a] = light.position[a], light.color[a]
                fall = INVERSE_SQUARE if light.kind == FALLING else 0.0
                points[n].fall = DISTANT if light.kind == at.DISTANT else fall
                n += 1
                continue
            p, t = light.position, light.target
            dx, dy, dz = t[0] - p[0], t[1] - p[1], t[2] - p[2]
            level = 1.0 if abs(dy) < UP_IS_Y * math.sqrt(dx * dx + dy * dy + dz * dz) else 0.0
            found = disk_frame(p[0], p[1], p[2], t[0], t[1], t[2], 1.0 - level, level, 0.0)
            if exact:
                row = points[n]
                row.radius = light.radius
                for a in range(3):
                    row.position[a], row.color[a] = p[a], light.color[a]
                    row.axis[a], row.e1[a], row.e2[a] = -found[a], found[3 + a], found[6 + a]
                n += 1
                continue
            for r in range(order):
                away = light.radius * math.sqrt((r + 0.5) / order)
                for q in range(order):
                    angle = 2.0 * math.pi * ((q + 0.5) / order)
                    c, s = away * math.cos(angle), away * math.sin(angle)
                    for a in range(3):
                        points[n].position[a] = p[a] + (c * found[3 + a] + s * found[6 + a])
                        points[n].color[a] = light.color[a] / (order * order)
                    n += 1


@jitable
def turned(v: Array, axis: Frame, out: Array) -> None:
    """A vector in the coordinates of a plane."""
    x, y, z = v[0], v[1], v[2]
    out[0] = axis.east[0] * x + axis.east[1] * y + axis.east[2] * z
    out[1] = axis.north[0] * x + axis.north[1] * y + axis.north[2] * z
    out[2] = axis.up[0] * x + axis.up[1] * y + axis.up[2] * z


@jitable
def carried(place: Array, axis: Frame, out: Array) -> None:
    """A place in the coordinates of a plane."""
    for a in range(3):
        out[a] = place[a] - axis.origin[a]
    turned(out, axis, out)


def carry_view(
    axis: Frame, own: int, over: Ints, spheres: Table[Sphere], points: Table[LightPoint], sides: Table[Side],
    eye: Array, spheres_in: Table[Sphere], points_in: Table[LightPoint], sides_in: Table[Side], eye_in: Array,
) -> None:  # fmt: skip
    """Write what kernels read of a scene into the tables of plane ``own``, in its coordinates.

    Many arguments because a kernel takes arrays: what is carried, and what it is written into.
    """
    for j in range(spheres.shape[0]):
        spheres_in[j] = spheres[j]
        carried(spheres[j].center, axis, spheres_in[j].center)
    for i in range(points.shape[0]):
        points_in[i] = points[i]
        place = points_in[i].position
        carried(points[i].position, axis, place)
        if over[i] == 0:
            # on the side that every other frame has it on
            place[2] = place[2] - held(place[2])
        turned(points[i].e1, axis, points_in[i].e1)
        turned(points[i].e2, axis, points_in[i].e2)
        turned(points[i].axis, axis, points_in[i].axis)
    for k in range(sides.shape[0]):
        turned(sides[k].up, axis, sides_in[k].up)
        sides_in[k].level = sides[k].level
        for a in range(3):
            sides_in[k].level -= sides[k].up[a] * axis.origin[a]
    # the plane's own, without rounding
    sides_in[own].up[0] = sides_in[own].up[1] = sides_in[own].level = 0.0
    sides_in[own].up[2] = 1.0
    carried(eye, axis, eye_in)


@functools.lru_cache(maxsize=1)
def _axes_kernel() -> Any:
    return compiled(lay_axes, _nrt=False)


@functools.lru_cache(maxsize=1)
def _points_kernel() -> Any:
    return compiled(lay_points, _nrt=False)


@functools.lru_cache(maxsize=1)
def _carry_kernel() -> Any:
    return compiled(carry_view, _nrt=False)
