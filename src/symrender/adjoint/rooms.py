"""How a scene moves in the coordinates of one of its planes, which move themselves.

With the frame's unit vectors e and its origin o a point x has the coordinates e.(x - o) and a direction v the
coordinates e.v, so that

    d(e.(x - o)) = e.(dx - do) + de.(x - o),        d(e.v) = e.dv + de.v.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.adjoint.walls import AT_POINT, AXIS, EYE, HORIZON_NORMAL, LIGHTS, plane_columns
from symrender.chambers.work import Frames, View
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Grid
from symrender.scene.records import Frame

Array = npt.NDArray[np.float64]


@inlined
def turned_move(v: Array, move: Array, frame: Frame, turn: Frame, out: Array) -> None:
    """How the coordinates of a direction move, as it does by ``move`` and the frame by ``turn``."""
    x, y, z, dx, dy, dz = v[0], v[1], v[2], move[0], move[1], move[2]
    e, de = frame.east, turn.east
    out[0] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z
    e, de = frame.north, turn.north
    out[1] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z
    e, de = frame.up, turn.up
    out[2] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z


@inlined
def carried_move(p: Array, move: Array, frame: Frame, turn: Frame, out: Array) -> None:
    """The same of a point."""
    o, do = frame.origin, turn.origin
    x, y, z = p[0] - o[0], p[1] - o[1], p[2] - o[2]
    dx, dy, dz = move[0] - do[0], move[1] - do[1], move[2] - do[2]
    e, de = frame.east, turn.east
    out[0] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z
    e, de = frame.north, turn.north
    out[1] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z
    e, de = frame.up, turn.up
    out[2] = e[0] * dx + e[1] * dy + e[2] * dz + de[0] * x + de[1] * y + de[2] * z


@inlined
def disk_turn_move(omega: Array, frame: Frame, turn: Frame, out: Array) -> None:
    """The turn of a disk's frame, which turns by ``omega``, in coordinates that turn themselves."""
    x, y, z = omega[0], omega[1], omega[2]
    e, n, u = frame.east, frame.north, frame.up
    out[0] = e[0] * x + e[1] * y + e[2] * z + turn.up[0] * n[0] + turn.up[1] * n[1] + turn.up[2] * n[2]
    out[1] = n[0] * x + n[1] * y + n[2] * z + turn.east[0] * u[0] + turn.east[1] * u[1] + turn.east[2] * u[2]
    out[2] = u[0] * x + u[1] * y + u[2] * z + turn.north[0] * e[0] + turn.north[1] * e[1] + turn.north[2] * e[2]


@inlined
def side_moves(q: int, turns: Grid[Frame], frames: Frames, planes: Array) -> None:
    """How the planes move with parameter ``q``: of each the normal's three columns and the level's."""
    for k in range(frames.axes.shape[0]):
        frame, turn = frames.axes[k], turns[q, k]
        level = 0.0
        for a in range(3):
            planes[4 * k + a] = turn.up[a]
            level += turn.up[a] * frame.origin[a] + frame.up[a] * turn.origin[a]
        planes[4 * k + 3] = level


@jitable
def moves_in_frame(
    k: int, point: Array, normal: Array, lobe: Array, view: View, turns: Grid[Frame], frames: Frames, moves: Array,
    framed: Array,
) -> None:  # fmt: skip
    """Fill ``framed`` (Q, columns): ``moves``, how columns of the adjoint move, in the coordinates of plane ``k``.

    ``point``, ``normal``, ``lobe`` and ``view`` are the world's.
    """
    lights, spheres = view.points.shape[0], view.spheres.shape[0]
    planes = plane_columns(view)
    disks = planes + 4 * view.sides.shape[0]
    frame = frames.axes[k]
    for q in range(moves.shape[0]):
        row, out, turn = moves[q], framed[q], turns[q, k]
        for c in range(row.shape[0]):
            out[c] = row[c]
        carried_move(point, row[AT_POINT:], frame, turn, out[AT_POINT:])
        carried_move(view.eye, row[EYE:], frame, turn, out[EYE:])
        turned_move(normal, row[HORIZON_NORMAL:], frame, turn, out[HORIZON_NORMAL:])
        turned_move(lobe, row[AXIS:], frame, turn, out[AXIS:])
        for l in range(lights):
            c = LIGHTS + 6 * l
            carried_move(view.points[l].position, row[c:], frame, turn, out[c:])
            if disks < row.shape[0]:
                c = disks + 4 * l + 1
                disk_turn_move(row[c:], frame, turn, out[c:])
        for j in range(spheres):
            c = LIGHTS + 6 * lights + 4 * j
            carried_move(view.spheres[j].center, row[c:], frame, turn, out[c:])
        for side in range(view.sides.shape[0]):
            c = planes + 4 * side
            if side == k:
                # in its own coordinates a plane stands still
                out[c] = out[c + 1] = out[c + 2] = out[c + 3] = 0.0
                continue
            up = view.sides[side].up
            turned_move(up, row[c:], frame, turn, out[c:])
            for a in range(3):
                out[c + 3] -= row[c + a] * frame.origin[a] + up[a] * turn.origin[a]
