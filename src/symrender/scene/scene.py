"""Scene: everything an image depends on, as validated immutable numbers with units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_LIGHTS, MAX_NAME, MAX_PLANES, MAX_SPHERES
from symrender.scene.camera import Camera
from symrender.scene.canonical import scene_hash
from symrender.scene.light import Light
from symrender.scene.parameters import Parameter, parameters
from symrender.scene.replace import replace
from symrender.scene.shading import Shading
from symrender.scene.shape import Floor, Plane, Sphere
from symrender.scene.table import html
from symrender.scene.values import Colour, Part, at_most


class Scene(Part):
    """A camera, spheres, at most one floor, planes, lights; right-handed, z up, lengths and radiance in scene units."""

    name: Annotated[str, Field(max_length=MAX_NAME, description="what files and pages call it")] = "scene"
    description: Annotated[str, Field(max_length=4000, description="a sentence for those who open it")] = ""
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
            first: dict[str, int] = {}
            for index, part in enumerate(parts):
                if part.name in first:
                    context: dict[str, Any] = {"path": (field, index, "name")}
                    other = f"{field}[{first[part.name]}]"
                    raise PydanticCustomError("scene", f"must be unique, {other} is '{part.name}' too", context)
                first[part.name] = index
        return self

    @property
    def hash(self) -> str:
        """SHA-256 of the scene's values; see :func:`symrender.scene.canonical.scene_hash`."""
        return scene_hash(self)

    def parameters(self) -> tuple[Parameter, ...]:
        """Every real number of the scene; see :func:`symrender.scene.parameters.parameters`."""
        return parameters(self)

    def replace(self, changes: Mapping[str, object]) -> Scene:
        """This scene with values changed by dotted name; see :func:`symrender.scene.replace.replace`."""
        return replace(self, changes)

    def _repr_html_(self) -> str:
        return html(self.name, self.parameters())
