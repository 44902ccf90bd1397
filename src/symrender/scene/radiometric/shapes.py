"""Shapes of radiometric scenes: each has a material, and reflects on the side of its normal."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_TRIANGLES
from symrender.scene.directions import Triple, along, check_frame, coincide, collinear, minus
from symrender.scene.radiometric.values import Corners, Rotation, Size3, Velocity
from symrender.scene.root import wrong
from symrender.scene.values import Length, Part, PartName, Point3, at_most, listed

_AXES: Final = 3


class Plane(Part):
    """An endless plane; opaque from both sides."""

    type: Literal["plane"] = "plane"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    point: Annotated[Point3, Field(description="a point of the plane, origin of its texture")]
    normal: Annotated[Point3, Field(description="the side it reflects on, of any length")]
    along: Annotated[Point3, Field(description="direction of the texture's x, less its part along the normal")] = (
        1.0,
        0.0,
        0.0,
    )
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.normal, self.along)
        return self


class Sphere(Part):
    """A sphere; its normal points outward."""

    type: Literal["sphere"] = "sphere"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    center: Annotated[Point3, Field(description="centre")]
    radius: Annotated[Length, Field(description="radius")]
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)


class Rectangle(Part):
    """A corner and the two edges that leave it; its normal is edge_u x edge_v.

    The edges need not be at right angles. The texture's x runs along ``edge_u`` from the corner, y across it.
    """

    type: Literal["rectangle"] = "rectangle"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    corner: Annotated[Point3, Field(description="a corner, origin of its texture")]
    edge_u: Annotated[Point3, Field(description="edge from the corner, along the texture's x")]
    edge_v: Annotated[Point3, Field(description="the other edge from the corner; the normal is edge_u x edge_v")]
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_an_area(self) -> Self:
        _check_edges(self.edge_u, self.edge_v, "edge_u", "edge_v")
        return self


class Triangle(Part):
    """Three vertices, counter-clockwise about the normal; the texture's x runs from the first to the second."""

    type: Literal["triangle"] = "triangle"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    vertices: Annotated[
        tuple[Point3, Point3, Point3],
        Field(description="the three vertices, counter-clockwise as seen from the side of the normal"),
        BeforeValidator(listed),
    ]
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_an_area(self) -> Self:
        a, b, c = self.vertices
        names = "vertices[1] - vertices[0]", "vertices[2] - vertices[0]"
        _check_edges(minus(b, a), minus(c, a), *names)
        _check_edges(minus(c, b), minus(b, a), "vertices[2] - vertices[1]", names[0])
        return self


class Disk(Part):
    """A flat disk."""

    type: Literal["disk"] = "disk"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    center: Annotated[Point3, Field(description="centre, origin of its texture")]
    normal: Annotated[Point3, Field(description="the side it reflects on, of any length")]
    radius: Annotated[Length, Field(description="radius")]
    along: Annotated[Point3, Field(description="direction of the texture's x, less its part along the normal")] = (
        1.0,
        0.0,
        0.0,
    )
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="before")
    @classmethod
    def _along_is_beside(cls, data: Any) -> Any:
        """Without ``along``, the axis that is farther from the normal: x, or y beside it."""
        normal = data.get("normal") if isinstance(data, dict) else None
        if not isinstance(normal, list | tuple) or len(normal) != _AXES or "along" in data:
            return data
        if all(isinstance(c, int | float) for c in normal) and abs(normal[0]) > max(abs(normal[1]), abs(normal[2])):
            return {**data, "along": (0.0, 1.0, 0.0)}
        return data

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.normal, self.along)
        return self


class Box(Part):
    """A box, turned about the vertical; its normals point outward.

    Each face has a texture of its own: x and y run along its edges from one of its corners.
    """

    type: Literal["box"] = "box"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    center: Annotated[Point3, Field(description="centre")]
    size: Annotated[Size3, Field(description="lengths of its edges")]
    rotation: Annotated[Rotation, Field(description="by how much it is turned about z, counter-clockwise")] = 0.0
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)


class Mesh(Part):
    """Triangles that share vertices, counter-clockwise about their normals; opaque from both sides.

    A file of the ending .obj, .ply or .serialized is read when the scene is loaded, beside which it lies: the scene
    then holds its vertices and faces. Beside ``file`` may stand ``to_world`` (16 numbers, row by row), ``flip_faces``,
    and ``part``, which mesh of a serialized file it is. A vertex v stands at ``position`` + ``scale`` v, turned about
    z. Each face has a texture of its own, from its first vertex along its first edge.
    """

    type: Literal["mesh"] = "mesh"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    file: Annotated[
        str, Field(exclude=True, description="OBJ or PLY file that holds vertices and faces, beside the scene's")
    ] = ""
    vertices: Annotated[
        tuple[Point3, ...],
        Field(description="the vertices, in the mesh's own coordinates"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    faces: Annotated[
        tuple[Corners, ...],
        Field(description="three vertices each by their places in the list, from 0, counter-clockwise from outside"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    notes: Annotated[
        str, Field(max_length=1000, description="what of its file is not used; written when the file is read")
    ] = ""
    position: Annotated[Point3, Field(description="where the mesh's origin stands")] = (0.0, 0.0, 0.0)
    scale: Annotated[Length, Field(description="factor of its lengths")] = 1.0
    rotation: Annotated[Rotation, Field(description="by how much it is turned about z, counter-clockwise")] = 0.0
    material: Annotated[PartName, Field(description="name of one of the materials")]

    @model_validator(mode="after")
    def _is_made_of_triangles(self) -> Self:
        if self.file:
            raise wrong("is read where a scene is loaded; a Mesh holds vertices and faces", "file")
        if not self.faces:
            raise wrong("must hold at least one face, or be read from a file", "faces")
        known: dict[frozenset[Triple], int] = {}
        for index, face in enumerate(self.faces):
            if max(face) >= len(self.vertices):
                raise wrong(f"there are {len(self.vertices)} vertices, from 0, got {max(face)}", "faces", index)
            corners = [self.vertices[k] for k in face]
            if collinear(*corners):
                raise wrong("its vertices lie on one line: it has no area", "faces", index)
            other = known.setdefault(frozenset(corners), index)
            if other != index:
                raise wrong(
                    f"lies in faces[{other}], and which of them is seen is not decided; two_sided shows both sides",
                    "faces", index,
                )  # fmt: skip
        return self


def _check_edges(u: Triple, v: Triple, first: str, second: str) -> None:
    """Raise PydanticCustomError where two edges span no area."""
    for name, edge in ((first, u), (second, v)):
        if coincide(edge, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", f"{name} must be longer than zero")
    if along(u, v):
        raise PydanticCustomError("scene", f"{first} must not be parallel to {second}: the shape would have no area")


Shape = Annotated[Plane | Sphere | Rectangle | Triangle | Disk | Box | Mesh, Field(discriminator="type")]
