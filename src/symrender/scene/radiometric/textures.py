"""Textures in the (u, v) coordinates of shapes, and what holds an image file."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from symrender.errors import ImageError
from symrender.scene.pictures import picture
from symrender.scene.radiometric.values import Rotation, Shares
from symrender.scene.root import wrong
from symrender.scene.values import Part, Point2

_DATA = "bytes of the image file in base64; written when the file is read"


class Pictured(Part):
    """Base of what holds an image file: PNG, JPEG, OpenEXR or Radiance HDR."""

    file: Annotated[
        str, Field(exclude=True, description="PNG, JPEG, EXR or HDR file next to the scene's, read when it is loaded")
    ] = ""
    data: Annotated[str, Field(description=_DATA)] = ""

    @model_validator(mode="after")
    def _is_an_image(self) -> Self:
        if self.file:
            raise wrong("is read where a scene is loaded; a scene holds the bytes as data", "file")
        if not self.data:
            raise wrong("missing, a PNG, JPEG, EXR or HDR file must be named", "file")
        try:
            values, _ = picture(self.data)
        except ImageError as error:
            raise wrong(str(error), "data") from None
        self._check_values(values)
        return self

    def _check_values(self, values: Any) -> None:
        """Raise PydanticCustomError where the pixels (h, w, 3) are none of what this may hold."""
        if values.min() < 0.0:
            raise wrong(f"its values must not be negative, the least is {values.min():g}", "file")


class Placed(Part):
    """Base of textures in the (u, v) of a shape: turned, then multiplied by ``scale``, then moved."""

    scale: Annotated[Point2, Field(description="factors of u and v: how often the texture stands in them")] = (1.0, 1.0)
    offset: Annotated[Point2, Field(description="what is added to u and v after scale and rotation")] = (0.0, 0.0)
    rotation: Annotated[Rotation, Field(description="by how much u and v are turned about 0 before scale")] = 0.0


class Checkerboard(Placed):
    """Four fields in the unit square of (u, v), bright where floor(2 u) + floor(2 v) is even.

    It is the ``checkerboard`` of Mitsuba, with its colours.
    """

    type: Literal["checkerboard"] = "checkerboard"
    bright: Annotated[Shares, Field(description="reflectance of the fields at (0, 0)")] = (0.4, 0.4, 0.4)
    dark: Annotated[Shares, Field(description="reflectance of the others")] = (0.2, 0.2, 0.2)


class Image(Placed, Pictured):
    """An image over the (u, v) of a shape: u grows along its rows, v down its columns, from the upper left corner.

    Pixels are squares of the unit square: the centre of column i of w is u = (i + 1/2)/w. Shapes have the (u, v) of
    Mitsuba: a rectangle its edges, a sphere azimuth/2 pi and polar angle/pi, a disk radius and azimuth/2 pi, a box each
    face, a mesh what its file says, a triangle and a mesh without them the barycentric coordinates of the second and
    third corner, a plane metres.
    """

    type: Literal["image"] = "image"
    filter: Annotated[Literal["bilinear", "nearest"], Field(description="between centres of pixels")] = "bilinear"
    wrap: Annotated[Literal["repeat", "clamp", "mirror"], Field(description="what stands beyond the unit square")] = (
        "repeat"
    )
    encoding: Annotated[
        Literal["srgb", "raw"],
        Field(description="of PNG and JPEG: sRGB codes, or reflectances as they are; EXR and HDR are linear"),
    ] = "srgb"

    def _check_values(self, values: Any) -> None:
        super()._check_values(values)
        if values.max() > 1.0:
            raise wrong(f"reflectances must be at most 1, the largest of its pixels is {values.max():g}", "file")
