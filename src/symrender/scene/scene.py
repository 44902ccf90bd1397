"""Scene: everything an image depends on, as validated immutable numbers with units."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from symrender.limits import MAX_LIGHTS, MAX_PLANES, MAX_SPHERES
from symrender.scene.camera import Camera
from symrender.scene.light import Light
from symrender.scene.root import Root, check_names
from symrender.scene.shading import Shading
from symrender.scene.shape import Floor, Plane, Sphere
from symrender.scene.values import Colour, at_most


class Scene(Root):
    """A camera, spheres, at most one floor, planes, lights; right-handed, z up, lengths and radiance in scene units."""

    camera: Annotated[Camera, Field(description="who looks")]
    spheres: Annotated[
        tuple[Sphere, ...],
        Field(max_length=MAX_SPHERES, description="the spheres"),
        BeforeValidator(at_most(MAX_SPHERES)),
    ] = ()
    floor: Annotated[Floor | None, Field(description="the plane z = 0, or none")] = None
    planes: Annotated[
        tuple[Plane, ...], Field(max_length=MAX_PLANES, description="the planes"), BeforeValidator(at_most(MAX_PLANES))
    ] = ()
    lights: Annotated[
        tuple[Light, ...], Field(max_length=MAX_LIGHTS, description="the lights"), BeforeValidator(at_most(MAX_LIGHTS))
    ] = ()
    ambient: Annotated[Colour, Field(description="ambient radiance, weighted by ka")] = (0.0, 0.0, 0.0)
    background: Annotated[Colour, Field(description="radiance where nothing is hit")] = (0.0, 0.0, 0.0)
    shading: Annotated[Shading, Field(description="how lit points are shaded, for the whole scene")] = Shading()

    @model_validator(mode="after")
    def _has_unique_names(self) -> Self:
        for field, parts in (("spheres", self.spheres), ("planes", self.planes), ("lights", self.lights)):
            check_names(field, parts)
        return self
