"""Direct light of disks at given points: what a camera ray sees, with its error."""

from __future__ import annotations

import functools
import math
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, PARTLY, light_state
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.rooms import carry, enter_room, turn
from symrender.chambers.work import Frames, View, Work, begin_counts, scene_frames, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.marks import jitable
from symrender.jit.moving import moved, moves
from symrender.quadrature.disk_curves import TERMINATOR, disk_curves
from symrender.quadrature.disk_node import TAME_LOG, chorded, is_tame
from symrender.quadrature.disk_refined import SAFETY, refined_term
from symrender.quadrature.disk_term import disk_term as mean_over_disk
from symrender.quadrature.gauss import LEVELS, gauss_table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.paces import felt, gap
from symrender.quadrature.panel_rule import stretched
from symrender.quadrature.split_line import kinked
from symrender.scene.arrays import FIRST_SPHERE, OPEN, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

KINKED_STEPS: Final = 3
"""Steps between the two orders compared where a kink may lie in the disk."""
KINKED_SAFETY: Final = 3.0
"""Error stated there over the change between them: it falls with a power of the order only."""
MOST_LABOUR: Final = 1 << 40
"""A pixel's disks end by their own limits."""
ROUNDING: Final = 1e-14
"""Relative error that doubles leave, of the light of a whole disk."""


@jitable
def stand_at(point: Array, normal: Array, incoming: Array, j: int, home: int, view: View, work: Work) -> bool:
    """Tell ``work`` that the lit point is on sphere ``j`` or else on plane ``home``; whether it is seen from within.

    From within the sphere, that is. Of a plane, ``view`` and all arguments are in its coordinates.
    """
    chart = work.chart
    chart.shape_index, chart.plane, chart.home = j, home, home
    for a in range(3):
        chart.point[a] = point[a]
    enter_room(view, work)
    if home >= 0:
        work.room[home] = chart.side = 1.0 if incoming[2] < 0.0 else -1.0
    lift = 0.0
    if j >= 0:
        for a in range(3):
            lift += (point[a] - view.spheres[j].center[a]) * normal[a]
    return bool(lift < 0.0)


@jitable
def cast_by_all(i: int, j: int, view: View, work: Work) -> None:
    """List every sphere but ``j`` as one that may hide some of disk ``i``."""
    count = 0
    for h in range(view.spheres.shape[0]):
        if h != j:
            work.casters[count].light, work.casters[count].ball = i, h
            count += 1
    work.counts.casters = count


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


@jitable
def toleranced(
    i: int, state: int, q: LitPoint, step: int, lambert: float, shine: float, tol: float, view: View, work: Work,
    table: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s, error of lambert times the first plus shine times the second) of a disk.

    Two orders where they agree within ``tol`` and the disk is tame, else what ``refined_term`` makes of it.
    """
    p = view.points[i]
    gleaming = shine != 0.0
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    n, lifted = 0, yx * q.nx + yy * q.ny + yz * q.nz > 0.0
    if state >= PARTLY:
        n, lifted = disk_curves(i, q.x, q.y, q.z, q.nx, q.ny, q.nz, view, work)
    if n < 0:
        return 0.0, 0.0, 0.0
    if not chorded(p, n, yx, yy, yz, work) and is_tame(p, q, gleaming, TAME_LOG, view):
        first, second = compared_step(step, 0, view), compared_step(step, 1, view)
        d0, s0 = mean_over_disk(i, state, q, first, gleaming, view, work, table)
        d, s = mean_over_disk(i, state, q, second, gleaming, view, work, table)
        change = SAFETY * (stretched(lambert) * gap(d - d0) + stretched(shine) * gap(s - s0))
        if felt(change, work) <= tol:
            return d, s, change
        if state >= PARTLY:
            n, lifted = disk_curves(i, q.x, q.y, q.z, q.nx, q.ny, q.nz, view, work)
    banded = n > 0 and work.curves[n - 1].bounds == TERMINATOR
    if not (lifted or banded or (gleaming and view.shading.terminator == OPEN)):
        return 0.0, 0.0, 0.0
    share = tol / max(1e-300, lambert + shine)
    d, s, e = refined_term(p, n, lifted or banded, q, gleaming, min(0.1, 0.1 * share), view, work, table)
    return d, s, (lambert + shine) * e


def direct_kernel(
    points: Array, normals: Array, incoming: Array, surface: Ints, albedo: Array, step: int, tol: float, view: View,
    work: Work, table: Array, framed: Array, frames: Frames, direct: Array, error: Array,
) -> None:  # fmt: skip
    """Fill ``direct`` (N, 3) and ``error`` (N,); see ``disk_direct``. ``framed`` (3, 3) is scratch.

    Many arguments because a kernel takes arrays: what is asked, what it is asked of, and all that it writes into.
    """
    for k in range(points.shape[0]):
        home = frames.homes[surface[k]]
        if home < 0:
            j = surface[k] - FIRST_SPHERE
            error[k] = disks_at(
                points[k], normals[k], incoming[k], j, home, albedo[k], step, tol, view, work, table, direct[k]
            )
            continue
        carry(points[k], home, frames, framed[0])
        turn(normals[k], home, frames, framed[1])
        turn(incoming[k], home, frames, framed[2])
        error[k] = disks_at(
            framed[0], framed[1], framed[2], -1, home, albedo[k], step, tol, frames.views[home], work,
            table, direct[k],
        )  # fmt: skip


@jitable
def disks_at(
    point: Array, normal: Array, incoming: Array, j: int, home: int, albedo: Array, step: int, tol: float, view: View,
    work: Work, table: Array, direct: Array,
) -> float:  # fmt: skip
    """Add to ``direct`` (3,) what all disks add at a point; the error. ``stand_at`` says where ``j`` and ``home`` are.

    Many arguments because spheres and, in their own coordinates, planes ask alike, with all that a point is.
    """
    ks, error = view.shading.ks, 0.0
    qx, qy, qz = point[0], point[1], point[2]
    nx, ny, nz = normal[0], normal[1], normal[2]
    vx, vy, vz = -incoming[0], -incoming[1], -incoming[2]
    inside = stand_at(point, normal, incoming, j, home, view, work)
    for i in range(view.points.shape[0]):
        p = view.points[i]
        if not p.radius > 0.0:
            continue
        if inside:
            # a wall of a ball from within is no chart's: no value is claimed
            return moved(math.inf, math.inf) if moves(qx) else math.inf
        begin_counts(MOST_LABOUR, work)
        cast_by_all(i, j, view, work)
        state = light_state(i, qx, qy, qz, nx, ny, nz, view, work)
        if state == DARK:
            continue
        most = max(p.color[0], p.color[1], p.color[2])
        lambert = 0.0
        for c in range(3):
            lambert = max(lambert, view.shading.kd * albedo[c] * p.color[c])
        q = LitPoint(qx, qy, qz, nx, ny, nz, vx, vy, vz)
        share = tol / view.points.shape[0]
        d, s, change = toleranced(i, state, q, step, lambert, ks * most, share, view, work, table)
        for c in range(3):
            direct[c] += view.shading.kd * albedo[c] * p.color[c] * d + ks * p.color[c] * s
        if moves(change):
            # what the light of the disk changes by is rounded, too
            error += change + ROUNDING * (stretched(lambert) + stretched(ks * most))
            if work.counts.refused != 0:
                return moved(math.inf, math.inf)
        else:
            error += change + ROUNDING * (lambert + ks * most)
    return error


@functools.lru_cache(maxsize=1)
def direct_compiled() -> Any:
    """``direct_kernel``, compiled."""
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
    hit classes. ``tol`` is absolute, of the radiance. The estimated error is inf on the inside of a sphere, where there
    is no value; it exceeds ``tol`` where the chords of one disk did not suffice. ``scratch``: ``work_arrays`` and
    ``gauss_table`` of the caller's thread.
    """
    rows = light_rows(arrays, EXACT_DISK)
    view = scene_view(arrays, rows)
    n = len(points)
    direct, error = np.zeros((n, 3)), np.zeros(n)
    given = [np.ascontiguousarray(x, dtype=np.float64) for x in (points, normals, incoming)]
    direct_compiled()(
        *given, np.ascontiguousarray(surface, dtype=np.int64), np.ascontiguousarray(albedo), disk_step(tol), tol,
        view, *(scratch or (work_arrays(len(arrays.spheres), len(rows)), gauss_table())), np.zeros((3, 3)),
        scene_frames(arrays, view), direct, error,
    )  # fmt: skip
    return direct, error
