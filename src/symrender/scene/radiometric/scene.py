"""A scene in radiometric units: metre and watt, colours channel by channel."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_BOUNCES, MAX_LIGHTS, MAX_SHAPES, MAX_TRIANGLES
from symrender.scene.nearest import did_you_mean
from symrender.scene.printable import shown
from symrender.scene.radiometric.camera import LensCamera
from symrender.scene.radiometric.film import Film
from symrender.scene.radiometric.lights import Area, Environment, Light, Sky
from symrender.scene.radiometric.materials import Material
from symrender.scene.radiometric.shapes import Mesh, Plane, Shape
from symrender.scene.radiometric.values import Times
from symrender.scene.root import Root, check_names, wrong
from symrender.scene.values import Held, PartName, at_most


def _reflections(value: Any) -> Any:
    if value == "all" or (type(value) is int and 0 <= value <= MAX_BOUNCES):
        return value
    raise PydanticCustomError("scene", f"must be a whole number from 0 to {MAX_BOUNCES}, or all, got {shown(value)}")


def _unknown(what: str, name: str, known: Iterable[str]) -> str:
    """What is said of a name that no part has."""
    names = list(known)
    guess = did_you_mean(name, names) or f", known are {', '.join(names[:12]) or 'none'}"
    return f"unknown {what} '{name}'{guess}"


class RadiometricScene(Root):
    """A camera, materials by name, shapes and lights; lengths in metres, powers in watts, rgb channel by channel.

    ``bounces`` 0 is emission and direct light, 1, 2, ... add as many more reflections, ``all`` all of them. With
    ``gloss: first_hit`` what is not diffuse reflects where it is seen, and is black to other surfaces.
    What has a ``velocity`` is at its place at time 0, in seconds, and the image is the mean over the times of
    ``shutter``.
    """

    units: Annotated[Literal["radiometric"], Field(description="tells these scenes from those in units: series")]
    bounces: Annotated[
        int | Literal["all"],
        Field(description="reflections beyond the direct light"),
        BeforeValidator(_reflections),
    ]
    camera: Annotated[LensCamera, Field(description="who looks")]
    film: Annotated[Film | None, Field(description="size and filter that the file of another renderer asks for")] = None
    gloss: Annotated[
        Literal["every_hit", "first_hit"],
        Field(description="where what is not diffuse reflects; after the first hit, black or not"),
    ] = "every_hit"
    shutter: Annotated[Times, Field(description="when it opens and closes: the image is the mean over that time")] = (
        0.0,
        0.0,
    )
    materials: Annotated[
        dict[PartName, Material], AfterValidator(Held), Field(description="what surfaces are made of, by name")
    ]
    shapes: Annotated[
        tuple[Shape, ...],
        Field(max_length=MAX_SHAPES, description="the shapes"),
        BeforeValidator(at_most(MAX_SHAPES)),
    ] = ()
    lights: Annotated[
        tuple[Light, ...],
        Field(max_length=MAX_LIGHTS, description="the lights, at most one of them a sky or an environment"),
        BeforeValidator(at_most(MAX_LIGHTS)),
    ] = ()

    @model_validator(mode="after")
    def _hangs_together(self) -> Self:
        if self.shutter[0] > self.shutter[1]:
            raise wrong(f"must close no sooner than it opens, got {list(self.shutter)}", "shutter")
        for field, parts in (("shapes", self.shapes), ("lights", self.lights)):
            check_names(field, parts)
        for index, shape in enumerate(self.shapes):
            if shape.material not in self.materials:
                raise wrong(_unknown("material", shape.material, self.materials), "shapes", index, "material")
        for index, shape in enumerate(self.shapes):
            bump = self.materials[shape.material].bump
            if bump is not None and bump.coordinates == "own" and not shape.has_own_coordinates:
                raise wrong(
                    f"'{shape.material}' has a bump in coordinates: own, and a {shape.type} has others at every place; "
                    "coordinates: world are known",
                    "shapes", index, "material",
                )  # fmt: skip
        triangles = 0
        for index, shape in enumerate(self.shapes):
            triangles += len(shape.faces) if isinstance(shape, Mesh) else 0
            if triangles > MAX_TRIANGLES:
                raise wrong(f"meshes may have at most {MAX_TRIANGLES} triangles together", "shapes", index, "faces")
        skies = [index for index, light in enumerate(self.lights) if isinstance(light, Sky | Environment)]
        if len(skies) > 1:
            raise wrong(
                f"at most one light is a sky or an environment, lights[{skies[0]}] is one too",
                "lights", skies[1], "type",
            )  # fmt: skip
        self._areas_emit()
        return self

    def _areas_emit(self) -> None:
        """Refuse area lights of shapes that are none, have no end, or emit already."""
        shapes, emitters = {shape.name: shape for shape in self.shapes}, dict[str, int]()
        for index, light in enumerate(self.lights):
            if not isinstance(light, Area):
                continue
            shape, where = shapes.get(light.shape), ("lights", index, "shape")
            if shape is None:
                raise wrong(_unknown("shape", light.shape, shapes), *where)
            if isinstance(shape, Plane):
                raise wrong(
                    f"must name a shape that ends, got the plane '{light.shape}'",
                    *where,
                )
            if light.shape in emitters:
                raise wrong(f"'{light.shape}' is the shape of lights[{emitters[light.shape]}] already", *where)
            emitters[light.shape] = index
