"""Lights as points: the disk frame, the K x K rule and points sampled on the disk."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.jit.marks import inlined
from symrender.jit.records import Table
from symrender.limits import MAX_LIGHT_POINTS
from symrender.numeric.vectors import Vector, cross, unit
from symrender.scene.arrays import DISK, Array
from symrender.scene.records import Light
from symrender.settings import EXACT_DISK


@inlined
def disk_axes(position: Vector, target: Vector) -> tuple[Vector, Vector]:
    """Orthonormal axes of the disk at ``position`` facing ``target``; a target at the position is taken below it."""
    w = unit((target[0] - position[0], target[1] - position[1], target[2] - position[2]))
    if w == (0.0, 0.0, 0.0):
        w = (0.0, 0.0, -1.0)
    up = (0.0, 1.0, 0.0) if abs(w[1]) < 0.9 else (1.0, 0.0, 0.0)
    e1 = unit(cross(w, up))
    return e1, cross(w, e1)


@inlined
def disk_point(light: Light, axes: Array, u: float, v: float) -> Vector:
    """Point of the disk that the unit square's (u, v) maps to with constant density: radius sqrt(u), turn v."""
    r = light.radius * math.sqrt(u)
    a, b = r * math.cos(2.0 * math.pi * v), r * math.sin(2.0 * math.pi * v)
    return (
        light.position[0] + a * axes[0] + b * axes[3],
        light.position[1] + a * axes[1] + b * axes[4],
        light.position[2] + a * axes[2] + b * axes[5],
    )


def _vector(values: Array) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


def light_points(lights: Table[Light], order: int) -> tuple[Array, npt.NDArray[np.int64], Array]:
    """Points that stand for the lights: (p, 3), the first index of each light (m + 1,), disk axes (m, 6).

    A point light is its point; a disk light is the ``order`` x ``order`` centroids of its strata, all of one weight,
    or no points at all under ``EXACT_DISK``, which samples it.
    """
    disks = int(np.count_nonzero(lights["kind"] == DISK))
    if disks * order * order > MAX_LIGHT_POINTS:
        raise OptionError(f"disk: {disks} lights of {order}x{order} points exceed {MAX_LIGHT_POINTS} light points")
    points: list[Vector] = []
    first = np.zeros(len(lights) + 1, dtype=np.int64)
    axes = np.zeros((len(lights), 6))
    for l, light in enumerate(lights):
        if light.kind != DISK:
            points.append(_vector(light.position))
        else:
            e1, e2 = disk_axes(_vector(light.position), _vector(light.target))
            axes[l] = (*e1, *e2)
            cells = range(order if order != EXACT_DISK else 0)
            points += [disk_point(light, axes[l], (i + 0.5) / order, (j + 0.5) / order) for i in cells for j in cells]
        first[l + 1] = len(points)
    return np.array(points, dtype=np.float64).reshape(-1, 3), first, axes
