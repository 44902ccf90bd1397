"""A scene in radiometric units: metre and watt, colours channel by channel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_LIGHTS, MAX_NAME, MAX_SHAPES
from symrender.scene.camera import LookAtCamera
from symrender.scene.canonical import scene_hash
from symrender.scene.nearest import did_you_mean
from symrender.scene.parameters import Parameter, parameters
from symrender.scene.radiometric.due import LIGHTS_DUE, SHAPES_DUE, not_yet
from symrender.scene.radiometric.lights import Light, Sky
from symrender.scene.radiometric.materials import Material
from symrender.scene.radiometric.shapes import Shape
from symrender.scene.replace import replace
from symrender.scene.table import html
from symrender.scene.values import Held, Part, PartName, at_most


def _no_truth(value: Any) -> Any:
    if isinstance(value, bool):
        raise PydanticCustomError("scene", f"must be 0 or 1 or all, got {str(value).lower()}")
    return value


class RadiometricScene(Part):
    """A camera, materials by name, shapes and lights; lengths in metres, powers in watts, rgb channel by channel.

    ``bounces`` 0 is emission and direct light, 1 adds one more reflection at the first hit, ``all`` all of them.
    """

    units: Annotated[Literal["radiometric"], Field(description="tells these scenes from those in units: series")]
    name: Annotated[str, Field(max_length=MAX_NAME, description="what files and pages call it")] = "scene"
    description: Annotated[str, Field(max_length=4000, description="a sentence for those who open it")] = ""
    bounces: Annotated[
        Literal[0, 1, "all"], Field(description="reflections beyond the direct light"), BeforeValidator(_no_truth)
    ]
    camera: Annotated[LookAtCamera, Field(description="who looks")]
    materials: Annotated[
        dict[PartName, Material], AfterValidator(Held), Field(description="what surfaces are made of, by name")
    ]
    shapes: Annotated[
        tuple[Shape, ...],
        Field(max_length=MAX_SHAPES, description="the shapes"),
        BeforeValidator(not_yet(SHAPES_DUE, "plane and sphere", at_most(MAX_SHAPES))),
    ] = ()
    lights: Annotated[
        tuple[Light, ...],
        Field(max_length=MAX_LIGHTS, description="the lights, at most one of them a sky"),
        BeforeValidator(not_yet(LIGHTS_DUE, "point, directional and sky", at_most(MAX_LIGHTS))),
    ] = ()

    @model_validator(mode="after")
    def _hangs_together(self) -> Self:
        for field, parts in (("shapes", self.shapes), ("lights", self.lights)):
            first: dict[str, int] = {}
            for index, part in enumerate(parts):
                if part.name in first:
                    other = f"{field}[{first[part.name]}]"
                    raise _wrong(f"must be unique, {other} is '{part.name}' too", field, index, "name")
                first[part.name] = index
        for index, shape in enumerate(self.shapes):
            if shape.material not in self.materials:
                known = list(self.materials)
                guess = did_you_mean(shape.material, known) or f", known are {', '.join(known[:12]) or 'none'}"
                raise _wrong(f"unknown material '{shape.material}'{guess}", "shapes", index, "material")
        skies = [index for index, light in enumerate(self.lights) if isinstance(light, Sky)]
        if len(skies) > 1:
            raise _wrong(f"at most one light is a sky, lights[{skies[0]}] is one too", "lights", skies[1], "type")
        return self

    @property
    def hash(self) -> str:
        """SHA-256 of the scene's values; see :func:`symrender.scene.canonical.scene_hash`."""
        return scene_hash(self)

    def parameters(self) -> tuple[Parameter, ...]:
        """Every real number of the scene; see :func:`symrender.scene.parameters.parameters`."""
        return parameters(self)

    def replace(self, changes: Mapping[str, object]) -> RadiometricScene:
        """This scene with values changed by dotted name; see :func:`symrender.scene.replace.replace`."""
        return replace(self, changes)

    def _repr_html_(self) -> str:
        return html(self.name, self.parameters())


def _wrong(message: str, *path: str | int) -> PydanticCustomError:
    context: dict[str, Any] = {"path": path}
    return PydanticCustomError("scene", message, context)
