"""Planes anywhere: each is the floor of coordinates of its own, in which a ray meets it as it meets the floor.

Scenes without planes pay for one comparison: what planes need is called, not copied into its callers.
"""

from __future__ import annotations

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.numeric.rays import floor_distance
from symrender.numeric.vectors import Vector
from symrender.numeric.world import World
from symrender.scene.arrays import FIRST_SPHERE, LOOK_AT, PLANE, Array
from symrender.scene.records import Frame


def plane_cameras(frames: Table[Frame], camera: Array) -> Array:
    """The camera of ``camera_frame`` in the coordinates of every plane, (k, 13); what they see of a plane is a floor.

    A ``plane`` camera becomes one of kind LOOK_AT, whose window is the square of the floor it looks at.
    """
    rows = np.zeros((len(frames), 13))
    eye, axes = camera[1:4], camera[4:13].reshape(3, 3)
    if camera[0] == PLANE:
        half, (x, y) = camera[4], camera[5:7]
        axes = np.array([[x - eye[0], y - eye[1], -eye[2]], [half, 0.0, 0.0], [0.0, half, 0.0]])
    for row, frame in zip(rows, frames, strict=True):
        turn = np.array([frame.east, frame.north, frame.up])
        row[0], row[1:4] = LOOK_AT, turn @ (eye - frame.origin)
        row[4:13] = (axes @ turn.T).ravel()
    return rows


@inlined
def turned(frame: Frame, v: Vector) -> Vector:
    """A direction in the coordinates of a plane."""
    return (
        v[0] * frame.east[0] + v[1] * frame.east[1] + v[2] * frame.east[2],
        v[0] * frame.north[0] + v[1] * frame.north[1] + v[2] * frame.north[2],
        v[0] * frame.up[0] + v[1] * frame.up[1] + v[2] * frame.up[2],
    )


@inlined
def carried(frame: Frame, p: Vector) -> Vector:
    """A point in the coordinates of a plane; the third is its height."""
    return turned(frame, (p[0] - frame.origin[0], p[1] - frame.origin[1], p[2] - frame.origin[2]))


@jitable
def nearest_plane(
    frames: Table[Frame], first: int, leaves: int, origin: Vector, d: Vector, limit: float
) -> tuple[int, float]:
    """The nearest plane met before distance ``limit`` by the unit ray d (-1 for none), and its distance or ``limit``.

    Plane k has hit class ``first`` + k; that of class ``leaves`` is not met. Of equal distances the first plane counts,
    and what was met at ``limit`` before it.
    """
    best, distance = -1, limit
    for k in range(frames.shape[0]):
        if leaves == first + k:
            continue
        reach = floor_distance(carried(frames[k], origin)[2], turned(frames[k], d)[2])
        if reach < distance:
            best, distance = k, reach
    return best, distance


@jitable
def plane_point(frame: Frame, origin: Vector, d: Vector, distance: float) -> tuple[Vector, Vector, float, float]:
    """Point and unit normal where a ray meets the plane at ``distance``, and the point's coordinates x, y in it."""
    p, w = carried(frame, origin), turned(frame, d)
    x, y = p[0] + distance * w[0], p[1] + distance * w[1]
    q = (
        frame.origin[0] + x * frame.east[0] + y * frame.north[0],
        frame.origin[1] + x * frame.east[1] + y * frame.north[1],
        frame.origin[2] + x * frame.east[2] + y * frame.north[2],
    )
    return q, (frame.up[0], frame.up[1], frame.up[2]), x, y


@jitable
def planes_hide(frames: Table[Frame], first: int, own: int, q: Vector, light: Vector) -> bool:
    """Whether a plane hides a light point from q on the shape of hit class ``own``; plane k has class ``first`` + k.

    A plane is lit by what lies in front of it; other points by what is not on the other side of a plane, and what lies
    in the plane is on neither. What the planes leave is convex, so nothing else about them can be in the way.
    """
    for k in range(frames.shape[0]):
        above = carried(frames[k], light)[2]
        if own == first + k:
            if above <= 0.0:
                return True
            continue
        here = carried(frames[k], q)[2]
        if (here > 0.0 and above < 0.0) or (here < 0.0 and above > 0.0):
            return True
    return False


@inlined
def has_other(world: World, own: int) -> bool:
    """Whether a ray that leaves the shape of hit class ``own`` can meet a plane."""
    others = world.frames.shape[0]
    if own >= FIRST_SPHERE + world.spheres.shape[0]:
        others -= 1
    return others > 0


@inlined
def faces(frame: Frame, d: Vector) -> bool:
    """Whether a ray that meets the plane does so from in front."""
    return turned(frame, d)[2] < 0.0
