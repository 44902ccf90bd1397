"""Direct light of disks at given points, differentiated: ``quadrature/disk_direct.py`` with exact slopes."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, light_state
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.kernel_cache import compiled, jitable
from symrender.quadrature.disk_direct import KINKED_SAFETY, cast_by_all, compared_step, disk_step, stand_at
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_line import kinked
from symrender.quadrature.tangent_disk import (
    AT_Q,
    BALLS,
    NORMAL,
    NUMBERS,
    PLACE,
    TURN,
    VIEW,
    disk_gradient,
    disk_rows,
    functional,
)
from symrender.quadrature.tangent_point import Tangents
from symrender.scene.arrays import FIRST_SPHERE, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@jitable
def mean_slope(q: int, k: int, i: int, which: int, tangents: Tangents, work: Work, table: Array) -> float:
    """How a mean over disk ``i`` at point ``k`` moves with parameter ``q``."""
    rows = table[functional(which, table) :]
    light = tangents.points[q, i]
    slope = rows[NUMBERS, 0] * light.radius + rows[NUMBERS, 1] * tangents.shading[q].shininess
    for a in range(3):
        slope += rows[PLACE, a] * light.position[a] + rows[TURN, a] * light.turn[a]
        slope += rows[AT_Q, a] * tangents.place[q, k, a] + rows[NORMAL, a] * tangents.normal[q, k, a]
        slope -= rows[VIEW, a] * tangents.incoming[q, k, a]
    for c in range(work.counts.casters):
        ball = work.casters[c].ball
        for a in range(3):
            slope += rows[BALLS + 2 * ball, a] * tangents.spheres[q, ball].center[a]
        slope += rows[BALLS + 2 * ball + 1, 0] * tangents.spheres[q, ball].radius
    return float(slope)


def direct_gradient_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, albedo: Array, albedo_moves: Array,
    tangents: Tangents, step: int, view: View, work: Work, gauss: Array, table: Array, coarse: Array, gradient: Array,
    error: Array,
) -> None:  # fmt: skip
    """Fill ``gradient`` (Q, N, 3) and ``error`` (Q, N); see ``direct_gradients``."""
    flag = table[table.shape[0] - 1]
    kd, ks = view.shading.kd, view.shading.ks
    for k in range(points.shape[0]):
        j = surface[k] - FIRST_SPHERE
        n, d = normals[k], incoming[k]
        inside = stand_at(points[k], n, d, j, view, work)
        flag[0] = 0.0
        for q in range(gradient.shape[0]):
            coarse[q, 0] = coarse[q, 1] = coarse[q, 2] = 0.0
        for i in range(view.points.shape[0]):
            p = view.points[i]
            if not p.radius > 0.0 or inside:
                continue
            cast_by_all(i, j, view, work)
            state = light_state(i, points[k, 0], points[k, 1], points[k, 2], n[0], n[1], n[2], view, work)
            if state == DARK:
                continue
            for finer in range(2):
                order = compared_step(step, finer, view)
                cosine, gleam, _ = disk_gradient(
                    i, state, points[k, 0], points[k, 1], points[k, 2], n[0], n[1], n[2], -d[0], -d[1], -d[2],
                    order, True, view, work, gauss, table,
                )  # fmt: skip
                for q in range(gradient.shape[0]):
                    by_cosine = mean_slope(q, k, i, 0, tangents, work, table)
                    by_gleam = mean_slope(q, k, i, 1, tangents, work, table)
                    dkd, dks = tangents.shading[q].kd, tangents.shading[q].ks
                    for c in range(3):
                        moved = p.color[c] * (
                            dkd * albedo[k, c] * cosine
                            + kd * (albedo_moves[q, k, c] * cosine + albedo[k, c] * by_cosine)
                            + dks * gleam
                            + ks * by_gleam
                        ) + tangents.points[q, i].color[c] * (kd * albedo[k, c] * cosine + ks * gleam)
                        if finer == 1:
                            gradient[q, k, c] += moved
                        else:
                            coarse[q, c] += moved
        for q in range(gradient.shape[0]):
            most = 0.0
            for c in range(3):
                change = (KINKED_SAFETY if kinked(view) else 1.0) * abs(gradient[q, k, c] - coarse[q, c])
                most = max(most, change + 1e-15 * abs(gradient[q, k, c]))
            # on the inside of a sphere, and where a ball touches a disk, nothing is claimed
            error[q, k] = math.inf if inside or flag[0] != 0.0 else most


@functools.lru_cache(maxsize=1)
def _kernel() -> Any:
    return compiled(direct_gradient_kernel, _nrt=False)


def direct_gradients(
    arrays: SceneArrays,
    points: Array,
    normals: Array,
    incoming: Array,
    surface: Ints,
    albedo: Array,
    albedo_moves: Array,
    tangents: Tangents,
    tol: float,
    scratch: tuple[Work, Array] | None = None,
) -> tuple[Array, Array]:
    """(Q, N, 3) derivatives of what ``disk_direct`` adds to N seen points, and (Q, N) their estimated errors.

    ``tangents`` tells how the points, their normals, the rays and the scene move, ``albedo_moves`` (Q, N, 3) how the
    albedo does; the other arguments are those of ``disk_direct``. An error is inf where no derivative is given: on the
    inside of a sphere, and where a ball touches a disk.
    """
    rows = light_rows(arrays, EXACT_DISK)
    view = scene_view(arrays, rows)
    count, n = tangents.place.shape[:2]
    gradient, error = np.zeros((count, n, 3)), np.zeros((count, n))
    given = [np.ascontiguousarray(x, dtype=np.float64) for x in (points, normals, incoming)]
    _kernel()(
        *given, np.ascontiguousarray(surface, dtype=np.int64), np.ascontiguousarray(albedo),
        np.ascontiguousarray(albedo_moves), tangents, disk_step(tol), view,
        *(scratch or (work_arrays(len(arrays.spheres), len(rows)), gauss_table())),
        np.zeros((disk_rows(len(arrays.spheres)), 3)), np.zeros((count, 3)), gradient, error,
    )  # fmt: skip
    return gradient, error
