"""Rays: from the camera, and where they meet a sphere or the floor."""

from __future__ import annotations

import math

import numpy as np

from symrender.errors import SceneError
from symrender.jit.marks import inlined
from symrender.numeric.vectors import Vector, along, dot, unit
from symrender.scene.arrays import PLANE, Array
from symrender.scene.records import Camera

# a camera ready for use: kind 0, eye 1:4, then forward 4:7, right 7:10, up 10:13 (LOOK_AT; right and up reach from
# the middle to the edge of the window at distance 1), or window_half 4, window_center 5:7 (PLANE)
_PARALLEL = 1e-12
_FARTHEST = 1e150


def camera_frame(camera: Camera, width: int, height: int) -> Array:
    """Camera of ``SceneArrays`` with its axes worked out for ``width`` x ``height`` square pixels.

    Raises SceneError where the camera has no direction or its up vector no say.
    """
    frame = np.zeros(13)
    frame[0], frame[1:4] = camera.kind, camera.eye
    frame[4], frame[5:7] = camera.window_half, camera.window_center
    if camera.kind == PLANE:
        return frame
    eye, target, up = camera.eye, camera.target, camera.up
    forward = target - eye
    distance = float(np.linalg.norm(forward))
    if distance == 0.0:
        raise SceneError("camera.eye, camera.target: must differ, both are the same point")
    forward = forward / distance
    right = np.cross(forward, up)
    sine = float(np.linalg.norm(right))
    if sine <= _PARALLEL * float(np.linalg.norm(up)):
        raise SceneError("camera.up: must not be zero or along the view from camera.eye to camera.target")
    right = right / sine
    half = math.tan(math.radians(float(camera.fov)) / 2)
    frame[4:7], frame[7:10], frame[10:13] = forward, right * (half * width / height), np.cross(right, forward) * half
    return frame


@inlined
def window_direction(frame: Array, a: float, b: float) -> Vector:
    """Direction (not unit) of a ``look_at`` ray through window coordinates a, b in [-1, 1], a right, b up."""
    return (
        frame[4] + a * frame[7] + b * frame[10],
        frame[5] + a * frame[8] + b * frame[11],
        frame[6] + a * frame[9] + b * frame[12],
    )


@inlined
def primary_ray(frame: Array, a: float, b: float) -> tuple[Vector, float, Vector]:
    """Unit direction from the eye, distance to the floor (inf where it is not met) and the point met there.

    The ``plane`` camera looks at the floor point itself, which is therefore exact.
    """
    eye = (frame[1], frame[2], frame[3])
    if frame[0] == PLANE:
        point = (frame[5] + frame[4] * a, frame[6] + frame[4] * b, 0.0)
        toward = (point[0] - eye[0], point[1] - eye[1], -eye[2])
        distance = math.sqrt(dot(toward, toward)) if eye[2] != 0.0 else math.inf
        return unit(toward), distance, point
    direction = unit(window_direction(frame, a, b))
    distance = floor_distance(eye[2], direction[2])
    point = along(eye, distance, direction) if distance < math.inf else eye
    return direction, distance, (point[0], point[1], 0.0)


@inlined
def floor_distance(height: float, slope: float) -> float:
    """Distance to z = 0 from ``height`` along a unit ray whose z component is ``slope``; inf where it is not met.

    Beyond 1e150, where squares overflow, it counts as not met.
    """
    if slope == 0.0:
        return math.inf
    distance = -height / slope
    return distance if 0.0 < distance < _FARTHEST else math.inf


@inlined
def sphere_roots(f: Vector, d: Vector, radius: float, power: float) -> tuple[float, float]:
    """Both distances at which the unit ray d from C + f meets the sphere (C, radius), near first; inf, inf if none.

    ``power`` is |f|^2 - radius^2. With l = f - (f.d) d the discriminant radius^2 - |l|^2 does not cancel for far or
    small spheres, nor do the roots q = -(f.d) - sign(f.d) sqrt(D) and power/q (Haines, Günther, Akenine-Möller,
    "Precision improvements for ray/sphere intersection", Ray Tracing Gems ch. 7, doi:10.1007/978-1-4842-4427-2_7).
    A tangent ray has a double root.
    """
    toward = -dot(f, d)
    l = along(f, toward, d)
    discriminant = radius * radius - dot(l, l)
    if discriminant < 0.0:
        return math.inf, math.inf
    root = math.sqrt(discriminant)
    q = toward + root if toward >= 0.0 else toward - root
    if q == 0.0:
        return 0.0, 0.0
    other = power / q
    return (other, q) if other < q else (q, other)


@inlined
def sphere_offset(f: Vector, d: Vector, radius: float, far: bool) -> Vector:
    """Unit outward normal at the near or far meeting point of the same ray and sphere."""
    l = along(f, -dot(f, d), d)
    root = math.sqrt(max(0.0, radius * radius - dot(l, l)))
    return unit(along(l, root if far else -root, d))
