"""Lights. Neither falls off with distance: ``color`` is the arriving radiance scale, in scene units."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.scene.directions import coincide
from symrender.scene.values import Colour, Extent, Part, PartName, Point3


class PointLight(Part):
    """A light at one point."""

    type: Literal["point"] = "point"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    position: Annotated[Point3, Field(description="where the light is")]
    color: Annotated[Colour, Field(description="arriving radiance scale")] = (1.0, 1.0, 1.0)


class DiskLight(Part):
    """A disk of ``radius`` about ``position`` facing ``target``; its effect is the mean over its area.

    Radius 0 is the point light, bit for bit.
    """

    type: Literal["disk"] = "disk"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    position: Annotated[Point3, Field(description="centre of the disk")]
    radius: Annotated[Extent, Field(description="radius of the disk")]
    target: Annotated[Point3, Field(description="the point the disk faces")] = (0.0, 0.0, 0.0)
    color: Annotated[Colour, Field(description="arriving radiance scale")] = (1.0, 1.0, 1.0)

    @model_validator(mode="after")
    def _faces_somewhere(self) -> Self:
        if self.radius > 0 and coincide(self.position, self.target):
            raise PydanticCustomError("scene", "position and target of a disk must differ, got the same point for both")
        return self


Light = Annotated[PointLight | DiskLight, Field(discriminator="type")]
