"""Shapes: spheres, the floor plane z = 0, planes anywhere."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from symrender.scene.directions import check_frame
from symrender.scene.lobe import Lobe
from symrender.scene.texture import FloorChecker, FloorTexture, Solid, SphereTexture
from symrender.scene.values import Albedo, Length, Part, PartName, Point3


class Sphere(Part):
    """A sphere; what is below the floor is invisible from above."""

    name: Annotated[PartName, Field(description="its part in dotted names: spheres.NAME")]
    center: Annotated[Point3, Field(description="centre")]
    radius: Annotated[Length, Field(description="radius")]
    color: Annotated[Albedo, Field(description="albedo, before the texture")] = (0.5, 0.5, 0.5)
    texture: Annotated[SphereTexture, Field(description="what multiplies the albedo")] = Solid()
    lobe: Annotated[Lobe | None, Field(description="what it reflects, or nothing")] = None


class Floor(Part):
    """The plane z = 0, seen from above; from below it is black."""

    texture: Annotated[FloorTexture, Field(description="the albedo")] = FloorChecker()
    lobe: Annotated[Lobe | None, Field(description="what it reflects, or nothing")] = None


class Plane(Part):
    """A plane through ``point``, seen from the side its ``normal`` shows to; from behind it is black.

    Its texture is the floor's, in coordinates (x, y) whose origin is ``point``: x runs along the part of ``along`` that
    lies in the plane, y along normal x x. Planes are endless and hide what is behind them, so that a point sees no
    further than the room of half-spaces it lies in.
    """

    name: Annotated[PartName, Field(description="its part in dotted names: planes.NAME")]
    point: Annotated[Point3, Field(description="a point of the plane, origin of its texture")]
    normal: Annotated[Point3, Field(description="the side it reflects on, of any length")]
    along: Annotated[Point3, Field(description="direction of the texture's x, less its part along the normal")] = (
        1.0,
        0.0,
        0.0,
    )
    texture: Annotated[FloorTexture, Field(description="the albedo")] = FloorChecker()
    lobe: Annotated[Lobe | None, Field(description="what it reflects, or nothing")] = None

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.normal, self.along)
        return self
