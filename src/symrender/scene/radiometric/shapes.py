"""Shapes of radiometric scenes: each has a material, and reflects on the side of its normal."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from symrender.scene.directions import check_frame
from symrender.scene.values import Length, Part, PartName, Point3


class Plane(Part):
    """An endless plane; opaque from both sides."""

    type: Literal["plane"] = "plane"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    point: Annotated[Point3, Field(description="a point of the plane, origin of its texture")]
    normal: Annotated[Point3, Field(description="the side it reflects on, of any length")]
    along: Annotated[Point3, Field(description="direction of the texture's x, less its part along the normal")] = (
        1.0,
        0.0,
        0.0,
    )
    material: Annotated[PartName, Field(description="name of one of the materials")]

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.normal, self.along)
        return self


class Sphere(Part):
    """A sphere; its normal points outward."""

    type: Literal["sphere"] = "sphere"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    center: Annotated[Point3, Field(description="centre")]
    radius: Annotated[Length, Field(description="radius")]
    material: Annotated[PartName, Field(description="name of one of the materials")]


Shape = Annotated[Plane | Sphere, Field(discriminator="type")]
