"""Textures: what multiplies, or is, the albedo of a shape."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from symrender.scene.values import Albedo, Frequency, Length, Part, Point2, Share


class Solid(Part):
    """The albedo as it is."""

    type: Literal["solid"] = "solid"


class Checker(Part):
    """Checker on the chart (u, v): albedo times 1 where sin(pi u ku) sin(pi v kv) >= 0, else times ``dark``."""

    type: Literal["checker"] = "checker"
    ku: Annotated[Frequency, Field(description="half-periods around the axis")] = 8.0
    kv: Annotated[Frequency, Field(description="half-periods from pole to pole")] = 4.0
    dark: Annotated[Share, Field(description="factor of the dark fields")] = 0.2


class Stripes(Part):
    """Meridian stripes: albedo times 1 where sin(pi u ku) >= 0, else times ``dark``."""

    type: Literal["stripes"] = "stripes"
    ku: Annotated[Frequency, Field(description="half-periods around the axis")] = 8.0
    dark: Annotated[Share, Field(description="factor of the dark stripes")] = 0.2


class Marble(Part):
    """Smooth veins: albedo times .55 + .45 m, m = (1 + sin(2 pi (ku u + .35 sin(3 pi kv v)))) / 2."""

    type: Literal["marble"] = "marble"
    ku: Annotated[Frequency, Field(description="veins around the axis")] = 8.0
    kv: Annotated[Frequency, Field(description="waves from pole to pole")] = 4.0


SphereTexture = Annotated[Solid | Checker | Stripes | Marble, Field(discriminator="type")]


class FloorSolid(Part):
    """A floor of one albedo."""

    type: Literal["solid"] = "solid"
    color: Annotated[Albedo, Field(description="albedo")] = (0.5, 0.5, 0.5)


class FloorChecker(Part):
    """Checkered floor: ``bright`` where sin(pi (x - ox)/cell) sin(pi (y - oy)/cell) >= 0, else ``dark``."""

    type: Literal["checker"] = "checker"
    bright: Annotated[Albedo, Field(description="albedo of the bright fields")] = (0.6375, 0.6375, 0.85)
    dark: Annotated[Albedo, Field(description="albedo of the dark fields")] = (0.1125, 0.1125, 0.15)
    cell: Annotated[Length, Field(description="side of a field")] = 1.0
    offset: Annotated[Point2, Field(description="a corner of the checker")] = (0.0, 0.0)


FloorTexture = Annotated[FloorSolid | FloorChecker, Field(discriminator="type")]
