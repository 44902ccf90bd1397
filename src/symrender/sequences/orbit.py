"""A camera path: once around what the camera looks at."""

from __future__ import annotations

import math

from symrender.errors import OptionError
from symrender.scene.camera import LookAtCamera
from symrender.scene.scene import Scene
from symrender.sequences.over import MAX_FRAMES, Frame


def orbit(scene: Scene, count: int) -> list[Frame]:
    """``count`` frames of one turn of the eye about the vertical through the target, counter-clockwise from above.

    The first frame is the scene as it is, the last one step short of it, so that the sequence loops. OptionError for a
    camera without a target.
    """
    camera = scene.camera
    if not isinstance(camera, LookAtCamera):
        raise OptionError("orbit: needs a camera of type look_at, which has a target to turn about")
    if not 1 <= count <= MAX_FRAMES:
        raise OptionError(f"orbit: must be a whole number from 1 to {MAX_FRAMES}, got {count}")
    (ex, ey, ez), (tx, ty, _) = camera.eye, camera.target
    made = []
    for index in range(count):
        angle = 2 * math.pi * index / count
        c, s = math.cos(angle), math.sin(angle)
        x, y = tx + c * (ex - tx) - s * (ey - ty), ty + s * (ex - tx) + c * (ey - ty)
        eye = (ex, ey, ez) if index == 0 else (x, y, ez)
        made.append(Frame(index, (("orbit.degrees", math.degrees(angle)),), scene.replace({"camera.eye": eye})))
    return made
