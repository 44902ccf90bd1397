"""Direct light of disks at given points, differentiated: ``quadrature/disk_direct.py`` with exact slopes."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import (
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
from symrender.adjoint.point_moves import point_moves
from symrender.adjoint.rooms import moves_in_frame
from symrender.adjoint.walls import (
    AT_POINT,
    AXIS,
    HORIZON_NORMAL,
    LIGHTS,
    SHADING,
    adjoint_columns,
    plane_columns,
)
from symrender.adjoint.work import Tangents
from symrender.chambers.labels import DARK, light_state
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.rooms import carry, turn
from symrender.chambers.work import Frames, View, Work, scene_frames, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.marks import jitable
from symrender.quadrature.disk_direct import KINKED_SAFETY, cast_by_all, compared_step, disk_step, stand_at
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_line import kinked
from symrender.scene.arrays import FIRST_SPHERE, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@jitable
def mean_slope(i: int, which: int, row: Array, view: View, work: Work, table: Array) -> float:
    """How a mean over disk ``i`` moves as columns of the adjoint do by ``row``, those of the axis as the ray does."""
    rows = table[functional(which, table) :]
    balls, planes = LIGHTS + 6 * view.points.shape[0], plane_columns(view)
    light = LIGHTS + 6 * i
    disk = planes + 4 * view.sides.shape[0] + 4 * i
    slope = rows[NUMBERS, 0] * row[disk] + rows[NUMBERS, 1] * row[SHADING + 3]
    for a in range(3):
        slope += rows[PLACE, a] * row[light + a] + rows[TURN, a] * row[disk + 1 + a]
        slope += rows[AT_Q, a] * row[AT_POINT + a] + rows[NORMAL, a] * row[HORIZON_NORMAL + a]
        slope -= rows[VIEW, a] * row[AXIS + a]
    for c in range(work.counts.casters):
        ball = work.casters[c].ball
        for a in range(3):
            slope += rows[BALLS + 2 * ball, a] * row[balls + 4 * ball + a]
        slope += rows[BALLS + 2 * ball + 1, 0] * row[balls + 4 * ball + 3]
    for k in range(view.sides.shape[0]):
        at = BALLS + 2 * (view.spheres.shape[0] + k)
        for a in range(3):
            slope += rows[at, a] * row[planes + 4 * k + a]
        slope += rows[at + 1, 0] * row[planes + 4 * k + 3]
    return float(slope)


def direct_gradient_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, albedo: Array, albedo_moves: Array,
    tangents: Tangents, step: int, view: View, work: Work, gauss: Array, table: Array, coarse: Array, moves: Array,
    framed: Array, place: Array, frames: Frames, gradient: Array, error: Array,
) -> None:  # fmt: skip
    """Fill ``gradient`` (Q, N, 3) and ``error`` (Q, N); see ``direct_gradients``.

    ``moves`` and ``framed`` (Q, columns) and ``place`` (3, 3) are scratch. Many arguments because a kernel takes
    arrays: what is asked, what it is asked of, and all that it writes into.
    """
    for k in range(points.shape[0]):
        home = frames.homes[surface[k]]
        point_moves(k, tangents, frames, moves)
        for q in range(moves.shape[0]):
            for a in range(3):
                moves[q, AXIS + a] = tangents.incoming[q, k, a]
        if home < 0:
            j = surface[k] - FIRST_SPHERE
            disk_slopes(
                k, points[k], normals[k], incoming[k], j, home, albedo, albedo_moves, moves, tangents, step, view, work,
                gauss, table, coarse, gradient, error,
            )  # fmt: skip
            continue
        moves_in_frame(home, points[k], normals[k], incoming[k], view, tangents.turns, frames, moves, framed)
        carry(points[k], home, frames, place[0])
        turn(normals[k], home, frames, place[1])
        turn(incoming[k], home, frames, place[2])
        disk_slopes(
            k, place[0], place[1], place[2], -1, home, albedo, albedo_moves, framed, tangents, step,
            frames.views[home], work, gauss, table, coarse, gradient, error,
        )  # fmt: skip


@jitable
def disk_slopes(
    k: int, point: Array, n: Array, d: Array, j: int, home: int, albedo: Array, albedo_moves: Array, moves: Array,
    tangents: Tangents, step: int, view: View, work: Work, gauss: Array, table: Array, coarse: Array, gradient: Array,
    error: Array,
) -> None:  # fmt: skip
    """Fill the derivatives of what all disks add at point ``k``, in the coordinates in which it is given.

    Many arguments because spheres and, in their own coordinates, planes ask alike, with all that a point is.
    """
    flag = table[table.shape[0] - 1]
    kd, ks = view.shading.kd, view.shading.ks
    inside = stand_at(point, n, d, j, home, view, work)
    flag[0] = 0.0
    for q in range(gradient.shape[0]):
        coarse[q, 0] = coarse[q, 1] = coarse[q, 2] = 0.0
    for i in range(view.points.shape[0]):
        p = view.points[i]
        if not p.radius > 0.0 or inside:
            continue
        cast_by_all(i, j, view, work)
        state = light_state(i, point[0], point[1], point[2], n[0], n[1], n[2], view, work)
        if state == DARK:
            continue
        for finer in range(2):
            order = compared_step(step, finer, view)
            place = LitPoint(point[0], point[1], point[2], n[0], n[1], n[2], -d[0], -d[1], -d[2])
            cosine, gleam, _ = disk_gradient(i, state, place, order, True, view, work, gauss, table)
            for q in range(gradient.shape[0]):
                by_cosine = mean_slope(i, 0, moves[q], view, work, table)
                by_gleam = mean_slope(i, 1, moves[q], view, work, table)
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
    frames = scene_frames(arrays, view)
    planes = len(frames.axes)
    count, n = tangents.place.shape[:2]
    gradient, error = np.zeros((count, n, 3)), np.zeros((count, n))
    given = [np.ascontiguousarray(x, dtype=np.float64) for x in (points, normals, incoming)]
    _kernel()(
        *given, np.ascontiguousarray(surface, dtype=np.int64), np.ascontiguousarray(albedo),
        np.ascontiguousarray(albedo_moves), tangents, disk_step(tol), view,
        *(scratch or (work_arrays(len(arrays.spheres), len(rows)), gauss_table())),
        np.zeros((disk_rows(len(arrays.spheres), planes), 3)), np.zeros((count, 3)),
        *np.zeros((2, count, adjoint_columns(len(rows), len(arrays.spheres), planes, True))), np.zeros((3, 3)), frames,
        gradient, error,
    )  # fmt: skip
    return gradient, error
