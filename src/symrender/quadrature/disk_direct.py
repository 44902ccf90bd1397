"""Direct light of disks at given points: what a camera ray sees, with its error."""

from __future__ import annotations

import functools
import math
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, light_state
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.walls import POINT, SHAPE_INDEX, SIDE
from symrender.chambers.work import CASTERS, View, Work, work_arrays
from symrender.kernel_cache import compiled, jitable
from symrender.quadrature.disk_term import disk_term as mean_over_disk
from symrender.quadrature.gauss import LEVELS, gauss_table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_line import kinked
from symrender.scene.arrays import FIRST_SPHERE, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

KINKED_STEPS: Final = 3
"""Steps between the two orders compared where a kink may lie in the disk."""
KINKED_SAFETY: Final = 3.0
"""Error stated there over the change between them: it falls with a power of the order only."""


@jitable
def stand_at(point: Array, normal: Array, incoming: Array, j: int, view: View, work: Work) -> bool:
    """Tell ``work`` that the lit point is on sphere ``j``, -1 the floor; whether it is seen from within the sphere."""
    work.geo[SHAPE_INDEX] = j
    for a in range(3):
        work.geo[POINT + a] = point[a]
    work.geo[SIDE] = 1.0 if j >= 0 or incoming[2] < 0.0 else -1.0
    lift = 0.0
    if j >= 0:
        for a in range(3):
            lift += (point[a] - view.spheres[j, a]) * normal[a]
    return bool(lift < 0.0)


@jitable
def cast_by_all(i: int, j: int, view: View, work: Work) -> None:
    """List every sphere but ``j`` as one that may hide some of disk ``i``."""
    count = 0
    for h in range(view.spheres.shape[0]):
        if h != j:
            work.casters[count, 0], work.casters[count, 1] = i, h
            count += 1
    work.counts[CASTERS] = count


def disk_step(tol: float) -> int:
    """Step of the orders whose disk rules err by about a tenth of ``tol``."""
    step = 0
    while step + 2 < len(LEVELS) and math.exp(-LEVELS[step]) > 0.1 * tol:
        step += 1
    return step


@jitable
def compared_step(step: int, finer: int, view: View) -> int:
    """Step of the coarser (0) or finer (1) order compared: ``step`` and the next, three apart for blunt highlights.

    A kink knows nothing of how far off the integrand is tame, and two successive steps may ask for one rule.
    """
    apart = KINKED_STEPS if kinked(view) else 1
    return min(step, len(LEVELS) - 1 - apart) + finer * apart


def direct_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, albedo: Array, step: int, view: View, work: Work,
    table: Array, direct: Array, error: Array,
) -> None:  # fmt: skip
    """Fill ``direct`` (N, 3) and ``error`` (N,); see ``disk_direct``."""
    ks = view.shading[2]
    for k in range(points.shape[0]):
        qx, qy, qz = points[k, 0], points[k, 1], points[k, 2]
        nx, ny, nz = normals[k, 0], normals[k, 1], normals[k, 2]
        vx, vy, vz = -incoming[k, 0], -incoming[k, 1], -incoming[k, 2]
        j = surface[k] - FIRST_SPHERE
        inside = stand_at(points[k], normals[k], incoming[k], j, view, work)
        for i in range(view.points.shape[0]):
            p = view.points[i]
            if not p[DISK_RADIUS] > 0.0:
                continue
            if inside:
                # a wall of a ball from within is no chart's: no value is claimed
                error[k] = math.inf
                continue
            cast_by_all(i, j, view, work)
            state = light_state(i, qx, qy, qz, nx, ny, nz, view, work)
            if state == DARK:
                continue
            d = s = d0 = s0 = 0.0
            for finer in range(2):
                d0, s0 = d, s
                order = compared_step(step, finer, view)
                d, s = mean_over_disk(
                    i, state, qx, qy, qz, nx, ny, nz, vx, vy, vz, order, ks != 0.0, view, work, table
                )  # fmt: skip
            change = 0.0
            for c in range(3):
                lambert, shine = view.shading[1] * albedo[k, c] * p[3 + c], ks * p[3 + c]
                direct[k, c] += lambert * d + shine * s
                change = max(change, lambert * abs(d - d0) + shine * abs(s - s0))
            error[k] += (KINKED_SAFETY if kinked(view) else 1.0) * change + 1e-15


@functools.lru_cache(maxsize=1)
def _kernel() -> Any:
    return compiled(direct_kernel, _nrt=False)


def disk_direct(
    arrays: SceneArrays,
    points: Array,
    normals: Array,
    incoming: Array,
    surface: Ints,
    albedo: Array,
    tol: float,
    scratch: tuple[Work, Array] | None = None,
) -> tuple[Array, Array]:
    """(N, 3) radiance that the disk lights add to points seen along ``incoming``, and (N,) its estimated error.

    sum over disks of colour (kd albedo mean(V max(0, N.l)) + ks mean(V s)), means over the disk's area. ``points``,
    unit ``normals`` towards the viewer, unit ``incoming`` directions and ``albedo`` are (N, 3); ``surface`` (N,) are
    hit classes. Two orders tell the error, which is inf on the inside of a sphere, where there is no value.
    ``tol`` (absolute, radiance) chooses the orders. ``scratch``: ``work_arrays`` and ``gauss_table`` of the caller's
    thread.
    """
    rows = light_rows(arrays, EXACT_DISK)
    view = View(arrays.spheres, arrays.floor, rows, arrays.shading, np.ascontiguousarray(arrays.camera[1:4]))
    n = len(points)
    direct, error = np.zeros((n, 3)), np.zeros(n)
    given = [np.ascontiguousarray(x, dtype=np.float64) for x in (points, normals, incoming)]
    _kernel()(
        *given, np.ascontiguousarray(surface, dtype=np.int64), np.ascontiguousarray(albedo), disk_step(tol), view,
        *(scratch or (work_arrays(len(arrays.spheres), len(rows)), gauss_table())), direct, error,
    )  # fmt: skip
    return direct, error
