"""What of a chart moves with the parameters asked for, so that the rest need not be visited."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.adjoint.walls import HORIZON_NORMAL, LIGHTS, RIM, SHADING, plane_columns
from symrender.chambers.walls import FLOOR_CUT, HORIZON, SHADOW_EDGE, SILHOUETTE, TERMINATOR, TEXTURE_EDGE
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@jitable
def any_moves(moves: Array, first: int, last: int) -> bool:
    """Whether some parameter moves one of the columns first..last - 1."""
    for p in range(moves.shape[0]):
        for k in range(first, last):
            if moves[p, k] != 0.0:
                return True
    return False


@jitable
def used_columns(moves: Array, columns: Ints) -> int:
    """Number the columns that some parameter moves; how many they are."""
    n = 0
    for k in range(moves.shape[1]):
        if any_moves(moves, k, k + 1):
            columns[n] = k
            n += 1
    return n


@jitable
def what_moves(moves: Array, disks: bool, view: View, work: Work, moving: Array) -> tuple[bool, bool]:
    """Whether the radiance or density at fixed places of the chart changes, and whether any wall moves across them.

    ``moves`` (parameters, columns) is how everything moves. ``moving`` gets 1 for every row of the wall table that
    moves, and in its last place for the lobe's rim. Where places, density and light stand still, a wall only moves with
    the sphere it belongs to.
    """
    balls = LIGHTS + 6 * view.points.shape[0]
    last = moving.shape[0] - 1
    # what an exact disk sheds changes with every ball that hides a part of it
    nodes = any_moves(moves, 0, RIM) or any_moves(moves, SHADING, balls)
    planes = plane_columns(view)
    nodes = nodes or any_moves(moves, planes + 4 * view.sides.shape[0], moves.shape[1])
    nodes = nodes or (disks and any_moves(moves, balls, moves.shape[1]))
    moving[last] = 1.0 if nodes or any_moves(moves, RIM, RIM + 1) else 0.0
    horizon = any_moves(moves, HORIZON_NORMAL, HORIZON_NORMAL + 3)
    some = moving[last] != 0.0
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        tag, shape = work.walls[i].tag, work.walls[i].shape_index
        moved = True
        if not nodes:
            if tag in (SILHOUETTE, SHADOW_EDGE):
                moved = any_moves(moves, balls + 4 * shape, balls + 4 * shape + 4)
            elif tag == HORIZON:
                moved = horizon
            elif tag == FLOOR_CUT:
                moved = any_moves(moves, planes + 4 * shape, planes + 4 * shape + 4)
            elif tag in (TERMINATOR, TEXTURE_EDGE):
                moved = False
        moving[i] = 1.0 if moved else 0.0
        some = some or moved
    return nodes, some


@inlined
def wall_moves(wall: int, moving: Array) -> bool:
    """Whether the wall at the end of a cell, the lobe's rim where it is negative, is ``moving``."""
    return bool(moving[wall // 4 if wall >= 0 else moving.shape[0] - 1] != 0.0)


@jitable
def pace(row: Array) -> float:
    """The fastest motion of a parameter."""
    most = 0.0
    for k in range(row.shape[0]):
        most = max(most, abs(row[k]))
    return most


@jitable
def fastest_of(moves: Array) -> float:
    """The fastest motion of all parameters, no less than 1."""
    most = 1.0
    for p in range(moves.shape[0]):
        most = max(most, pace(moves[p]))
    return most
