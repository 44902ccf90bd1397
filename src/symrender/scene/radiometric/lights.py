"""Lights of radiometric scenes."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.scene.directions import coincide
from symrender.scene.radiometric.textures import Pictured
from symrender.scene.radiometric.values import Angle, Intensities, Irradiances, Radiances, Rotation, Velocity
from symrender.scene.root import wrong
from symrender.scene.values import Part, PartName, Point3, listed

LEAST_FALLOFF: Final = 1e-6
"""Degrees over which a spot falls off, at least: what is thinner is an edge to rounding."""
ORTHOGONAL: Final = 1e-5
"""How far products of the rows of a rotation may be from 0 and 1: files write six digits."""
LEAST_ROWS: Final = 2
"""Rows of an environment's image: between two of them there is a direction."""


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


class Environment(Pictured):
    """Light from all directions by an image of them, longitude along its rows; seen where a ray meets nothing.

    In the coordinates of the map, whose z points up, column i of w stands for azimuth 2 pi (i + 1/2)/w from y towards
    x: a direction is (sin phi sin theta, cos phi sin theta, cos theta). With ``rows: corners`` the first row is
    theta = 0 and the last theta = pi, as of Mitsuba's ``envmap``, else row j of h is theta = pi (j + 1/2)/h. Between
    these radiance is linear in phi and theta. ``layout: equal_area`` is the square octahedral map of pbrt-v4, whose
    pixels are parts of the sphere of one size and one radiance (``filter: nearest``). The map
    is turned by ``rotation`` about its z, then by ``to_world``, and its radiance is multiplied by ``scale``.
    """

    type: Literal["environment"] = "environment"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    scale: Annotated[Radiances, Field(description="factor of its radiance, a number or three")] = (1.0, 1.0, 1.0)
    rotation: Annotated[Rotation, Field(description="by how much it is turned about its z, counter-clockwise")] = 0.0
    to_world: Annotated[
        tuple[Point3, Point3, Point3],
        Field(description="rows of the matrix that turns directions of the map, so rotated, into the world"),
        BeforeValidator(listed),
    ] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    rows: Annotated[
        Literal["corners", "centres"], Field(description="whether the first row is the zenith, or half a row from it")
    ] = "corners"
    filter: Annotated[Literal["bilinear", "nearest"], Field(description="between centres of pixels")] = "bilinear"
    layout: Annotated[
        Literal["latlong", "equal_area"], Field(description="longitude and latitude, or pbrt's octahedral map")
    ] = "latlong"

    @model_validator(mode="after")
    def _turns(self) -> Self:
        rows = self.to_world
        products = (sum(x * y for x, y in zip(a, b, strict=True)) for a in rows for b in rows)
        if any(abs(c - float(k % 4 == 0)) > ORTHOGONAL for k, c in enumerate(products)):
            raise wrong("must be a rotation: rows of length 1 at right angles to each other", "to_world")
        return self

    def _check_values(self, values: Any) -> None:
        super()._check_values(values)
        height, width, _ = values.shape
        if self.layout == "equal_area" and self.filter != "nearest":
            raise wrong("an equal-area map is known with filter: nearest alone", "filter")
        if self.layout == "equal_area" and height != width:
            raise wrong(f"an equal-area map must be a square, got {width} x {height} pixels", "file")
        if self.layout == "latlong" and height < LEAST_ROWS:
            raise wrong(f"must have at least {LEAST_ROWS} rows, got {height}", "file")


class Area(Part):
    """A shape that emits the same radiance from every place of it, in every direction on the side of its normal."""

    type: Literal["area"] = "area"
    name: Annotated[PartName, Field(description="its part in dotted names: lights.NAME")]
    shape: Annotated[
        PartName,
        Field(description="name of the shape that emits, any but a plane"),
    ]
    radiance: Annotated[Radiances, Field(description="radiance, a number or three")]


Light = Annotated[Point | Directional | Spot | Sky | Environment | Area, Field(discriminator="type")]
