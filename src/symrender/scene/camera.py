"""Cameras. Row 0 of an image is on top; pixel (i, j) is column i, row j, of W x H."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.scene.directions import coincide, parallel
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

    @model_validator(mode="after")
    def _stands_off_the_floor(self) -> Self:
        if self.eye[2] == 0:
            raise PydanticCustomError(
                "scene", "eye must be off the plane z = 0, which window_half is measured on, got z = 0"
            )
        return self


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

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        if coincide(self.eye, self.target):
            raise PydanticCustomError("scene", "eye and target must differ, got the same point for both")
        if coincide(self.up, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", "up must be longer than zero")
        if parallel(self.up, self.eye, self.target):
            raise PydanticCustomError("scene", "up must not be parallel to the view from eye to target")
        return self


Camera = Annotated[PlaneCamera | LookAtCamera, Field(discriminator="type")]
