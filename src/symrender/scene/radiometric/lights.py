"""Lights of radiometric scenes."""

from __future__ import annotations

from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.scene.directions import coincide
from symrender.scene.radiometric.values import Angle, Intensities, Irradiances, Radiances, Velocity
from symrender.scene.values import Part, PartName, Point3

LEAST_FALLOFF: Final = 1e-6
"""Degrees over which a spot falls off, at least: what is thinner is an edge to rounding."""


class Point(Part):
    """A light at one point: the irradiance across its rays is intensity/r^2."""

    type: Literal["point"] = "point"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    position: Annotated[Point3, Field(description="where the light is")]
    intensity: Annotated[Intensities, Field(description="radiant intensity, a number or three")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)


class Directional(Part):
    """Parallel light from infinity."""

    type: Literal["directional"] = "directional"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    direction: Annotated[Point3, Field(description="direction in which the light travels, of any length")]
    irradiance: Annotated[Irradiances, Field(description="irradiance across its rays, a number or three")]

    @model_validator(mode="after")
    def _goes_somewhere(self) -> Self:
        if coincide(self.direction, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", "direction must be longer than zero")
        return self


class Spot(Part):
    """A light at one point that shines along a direction and less and less, or not at all, away from it.

    Where the angle from ``direction`` is up to ``beam`` the irradiance across its rays is intensity/r^2, from
    ``cutoff`` on nothing. Between the two it falls with the angle (``linear``), or with the cosine c of the angle like
    t^2 (3 - 2t), t = (c - cos cutoff)/(cos beam - cos cutoff) (``smooth``).
    """

    type: Literal["spot"] = "spot"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    position: Annotated[Point3, Field(description="where the light is")]
    direction: Annotated[Point3, Field(description="middle of its beam, the way light travels, of any length")]
    intensity: Annotated[Intensities, Field(description="radiant intensity within the beam, a number or three")]
    beam: Annotated[Angle, Field(description="angle from the direction up to which it is as bright")]
    cutoff: Annotated[Angle, Field(description="angle from the direction from which on it is dark, larger than beam")]
    falloff: Annotated[
        Literal["linear", "smooth"], Field(description="between them: linear in the angle, or smooth in its cosine")
    ] = "linear"
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _narrows(self) -> Self:
        if coincide(self.direction, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", "direction must be longer than zero")
        if not self.cutoff - self.beam > LEAST_FALLOFF:
            raise PydanticCustomError(
                "scene", "cutoff must be larger than beam by {least} degrees at least", {"least": LEAST_FALLOFF}
            )
        return self


class Sky(Part):
    """The same radiance from every direction in which nothing is met; seen where a ray meets nothing."""

    type: Literal["sky"] = "sky"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    radiance: Annotated[Radiances, Field(description="radiance, a number or three")]


class Area(Part):
    """A shape that emits the same radiance from every place of it, in every direction on the side of its normal."""

    type: Literal["area"] = "area"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    shape: Annotated[
        PartName,
        Field(description="name of the shape that emits, any but a plane"),
    ]
    radiance: Annotated[Radiances, Field(description="radiance, a number or three")]


Light = Annotated[Point | Directional | Spot | Sky | Area, Field(discriminator="type")]
