"""Bumps: a height over a surface, of which only the normal is seen."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from symrender.limits import MAX_COORDINATE
from symrender.scene.formula import Formula
from symrender.scene.values import Part

Amplitude = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, json_schema_extra={"unit": "length"})]


class Bump(Part):
    """A height h over the surface, along its normal N: its gradient along the surface turns N to unit(N - grad h).

    The surface itself stays where it is: silhouettes and shadows are those without a bump. Light counts that comes from
    above both horizons, that of N and that of the turned normal; where the eye is below the turned one it is black.
    """

    height: Annotated[Formula, Field(description="the height, a formula of x, y and z")]
    amplitude: Annotated[Amplitude, Field(description="length by which the formula is multiplied")] = 1.0
    coordinates: Annotated[
        Literal["world", "own"],
        Field(description="what x, y, z are: those of the scene, or the surface's own: of what is flat those of its "
              "texture, z being 0, of a sphere those about its centre, all of them lengths"),
    ] = "world"  # fmt: skip
    normals: Annotated[
        Literal["shading", "geometric"],
        Field(description="by the cosine of which normal light arrives: the turned one, or the surface's"),
    ] = "shading"
