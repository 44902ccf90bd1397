"""Cameras. Row 0 of an image is on top; pixel (i, j) is column i, row j, of W x H."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from symrender.scene.values import FieldOfView, Length, Part, Point2, Point3


class PlaneCamera(Part):
    """The floor is the image plane: pixel (i, j) looks from ``eye`` to the floor point (x, y, 0).

    x = window_center.x + window_half (2 (i + 1/2)/W - 1), y = window_center.y + window_half (1 - 2 (j + 1/2)/H).
    Pixels are axis-aligned rectangles of the floor, so a box filter over a pixel is a box filter over the floor.
    """

    type: Literal["plane"] = "plane"
    eye: Annotated[Point3, Field(description="where the camera stands")]
    window_half: Annotated[Length, Field(description="half the width of the floor window")]
    window_center: Annotated[Point2, Field(description="middle of the floor window")] = (0.0, 0.0)


class LookAtCamera(Part):
    """Perspective camera; ``fov`` is the vertical field of view in degrees, pixels are square.

    With forward f = unit(target - eye), right r = unit(f x up), true up u = r x f and h = tan(fov/2), pixel (i, j)
    looks along f + h (W/H) (2 (i + 1/2)/W - 1) r + h (1 - 2 (j + 1/2)/H) u.
    """

    type: Literal["look_at"] = "look_at"
    eye: Annotated[Point3, Field(description="where the camera stands")]
    target: Annotated[Point3, Field(description="the point in the middle of the image")] = (0.0, 0.0, 0.0)
    up: Annotated[Point3, Field(description="any vector not along the view")] = (0.0, 0.0, 1.0)
    fov: Annotated[FieldOfView, Field(description="vertical field of view")] = 40.0


Camera = Annotated[PlaneCamera | LookAtCamera, Field(discriminator="type")]
