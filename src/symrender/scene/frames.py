"""Where the planes of a scene lie: an orthonormal frame each, and how it moves with a parameter."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Grid, Table, grid, table
from symrender.scene.records import Floor, Frame, Plane

Array = npt.NDArray[np.float64]


def floor_of(plane: Plane) -> Table[Floor]:
    """What a plane is made of, as the one record of a table: the floor of its own coordinates."""
    rows = table(Floor, 1)
    row = rows[0]
    row.present, row.kind, row.cell = 1.0, plane.kind, plane.cell
    row.bright[:], row.dark[:], row.offset[:] = plane.bright, plane.dark, plane.offset
    row.weight, row.exponent, row.theta_max = plane.weight, plane.exponent, plane.theta_max
    return rows


def frames(planes: Table[Plane]) -> Table[Frame]:
    """The frame of every plane: up = unit(normal), east = unit(along - (along.up) up), north = up x east."""
    rows = table(Frame, len(planes))
    for row, plane in zip(rows, planes, strict=True):
        row.origin[:] = plane.point
        row.up[:] = up = _unit(plane.normal)
        row.east[:] = east = _unit(plane.along - (plane.along @ up) * up)
        row.north[:] = np.cross(up, east)
    return rows


def frame_moves(planes: Table[Plane], moves: Grid[Plane]) -> Grid[Frame]:
    """Derivatives of the frames in Q parameters, of planes that move by ``moves`` (Q, k)."""
    count = moves.shape[0]
    rows = grid(Frame, count, len(planes))
    for k, frame in enumerate(frames(planes)):
        plane = planes[k]
        for q in range(count):
            move, row = moves[q, k], rows[q, k]
            row.origin[:] = move.point
            row.up[:] = up = turned(plane.normal, move.normal)
            level = plane.along @ frame.up
            flat = plane.along - level * frame.up
            slope = move.along @ frame.up + plane.along @ up
            row.east[:] = east = turned(flat, move.along - slope * frame.up - level * up)
            row.north[:] = np.cross(up, frame.east) + np.cross(frame.up, east)
    return rows


def _unit(v: Array) -> Array:
    v = v / np.abs(v).max()
    return np.asarray(v / np.sqrt(v @ v))


def turned(v: Array, move: Array) -> Array:
    """Derivative of unit(v) where v moves."""
    size, unit = float(np.sqrt(v @ v)), _unit(v)
    return np.asarray((move - (move @ unit) * unit) / size)
