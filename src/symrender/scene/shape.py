"""Shapes: spheres and the floor plane z = 0."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

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
