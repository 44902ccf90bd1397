"""Textures: what multiplies, or is, the albedo of a shape."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from symrender.scene.values import Albedo, Frequency, Length, Part, Point2, Share


class Solid(Part):
    """The albedo as it is."""

    type: Literal["solid"] = "solid"


class Checker(Part):
    """Chessboard on the chart (u, v): albedo times 1 where sin(pi u ku) sin(pi v kv) >= 0, else times ``dark``."""

    type: Literal["checker"] = "checker"
    ku: Frequency = 8.0
    kv: Frequency = 4.0
    dark: Share = 0.2


class Stripes(Part):
    """Meridian stripes: albedo times 1 where sin(pi u ku) >= 0, else times ``dark``."""

    type: Literal["stripes"] = "stripes"
    ku: Frequency = 8.0
    dark: Share = 0.2


class Marble(Part):
    """Smooth veins: albedo times .55 + .45 m, m = (1 + sin(2 pi (ku u + .35 sin(3 pi kv v)))) / 2."""

    type: Literal["marble"] = "marble"
    ku: Frequency = 8.0
    kv: Frequency = 4.0


SphereTexture = Annotated[Solid | Checker | Stripes | Marble, Field(discriminator="type")]


class FloorSolid(Part):
    """A floor of one albedo."""

    type: Literal["solid"] = "solid"
    color: Albedo = (0.5, 0.5, 0.5)


class FloorChecker(Part):
    """Chessboard floor: ``bright`` where sin(pi (x - ox)/cell) sin(pi (y - oy)/cell) >= 0, else ``dark``."""

    type: Literal["checker"] = "checker"
    bright: Albedo = (0.6375, 0.6375, 0.85)
    dark: Albedo = (0.1125, 0.1125, 0.15)
    cell: Length = 1.0
    offset: Point2 = (0.0, 0.0)


FloorTexture = Annotated[FloorSolid | FloorChecker, Field(discriminator="type")]
