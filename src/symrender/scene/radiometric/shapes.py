"""Shapes of radiometric scenes: each has a material, and reflects on the side of its normal."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_TRIANGLES
from symrender.scene.directions import Triple, along, check_frame, coincide, collinear, minus
from symrender.scene.radiometric.values import Corners, Rotation, Size3, Velocity
from symrender.scene.root import wrong
from symrender.scene.values import Length, Part, PartName, Point2, Point3, at_most, listed

_AXES: Final = 3
# ``has_own_coordinates`` says whether a bump may have its heights in those of the shape's texture


class Plane(Part):
    """An endless plane; opaque from both sides."""

    has_own_coordinates: ClassVar[bool] = True
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

    has_own_coordinates: ClassVar[bool] = True
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

    has_own_coordinates: ClassVar[bool] = True
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

    has_own_coordinates: ClassVar[bool] = True
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

    has_own_coordinates: ClassVar[bool] = True
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
        return _beside(data, "normal")

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.normal, self.along)
        return self


class Cylinder(Part):
    """The side of a cylinder, with or without the two disks that close it; its normals point outward.

    Of the texture x is the angle about the axis from ``along``, plus a half turn, in half turns, so that it runs from 0
    to 2; y runs from 0 at the base to 1 at the top, on the disks from 0 on the axis to 1 at the rim.
    """

    has_own_coordinates: ClassVar[bool] = False
    type: Literal["cylinder"] = "cylinder"
    name: Annotated[PartName, Field(description="its part in dotted names: shapes.NAME")]
    base: Annotated[Point3, Field(description="centre of its base")]
    axis: Annotated[Point3, Field(description="from the centre of its base to that of its top")]
    radius: Annotated[Length, Field(description="radius")]
    caps: Annotated[bool, Field(description="whether disks close it at both ends")] = False
    along: Annotated[Point3, Field(description="where angles of the texture begin, less its part along the axis")] = (
        1.0,
        0.0,
        0.0,
    )
    material: Annotated[PartName, Field(description="name of one of the materials")]
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second")] = (0.0, 0.0, 0.0)

    @model_validator(mode="before")
    @classmethod
    def _along_is_beside(cls, data: Any) -> Any:
        """Without ``along``, the axis that is farther from the cylinder's."""
        return _beside(data, "axis")

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        check_frame(self.axis, self.along, "axis")
        return self


class Box(Part):
    """A box, turned about the vertical; its normals point outward.

    Each face has a texture of its own: x and y run along its edges from one of its corners.
    """

    has_own_coordinates: ClassVar[bool] = False
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
    then holds its vertices and faces. Next to ``file`` may stand ``to_world`` (16 numbers, row by row), ``flip_faces``,
    and ``part``, which mesh of a serialized file it is. A vertex v stands at ``position`` + ``scale`` v, turned about
    z. Each face has a texture of its own, from its first vertex along its first edge; textures in (u, v) follow those
    of the vertices. With ``shading_normals: use`` it reflects by the normals of its vertices, interpolated over each
    face; where there are none they are the sums of those of the faces about a vertex, each times its angle.
    """

    has_own_coordinates: ClassVar[bool] = False
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
    uv: Annotated[
        tuple[Point2, ...],
        Field(description="texture coordinates, in the order of the vertices or of what uv_faces names"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    uv_faces: Annotated[
        tuple[Corners, ...],
        Field(description="three texture coordinates each, by their places in uv; empty: those of its vertices"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    normals: Annotated[
        tuple[Point3, ...],
        Field(description="shading normals, in the order of the vertices or of what normal_faces names, of any length"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    normal_faces: Annotated[
        tuple[Corners, ...],
        Field(description="three normals each, by their places in normals; empty: those of its vertices"),
        BeforeValidator(at_most(MAX_TRIANGLES)),
    ] = ()
    shading_normals: Annotated[
        Literal["ignore", "use"],
        Field(description="whether it reflects by the normals of its vertices, computed if it has none"),
    ] = "ignore"
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
        self._check_faces()
        self._check_vertices("uv", self.uv, self.uv_faces)
        self._check_vertices("normals", self.normals, self.normal_faces)
        return self

    def _check_faces(self) -> None:
        """Raise PydanticCustomError for the first face that has no vertices or no area, or lies in another."""
        from symrender.scene.meshes.many import sound

        if sound(self.vertices, self.faces):
            return
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

    def _check_vertices(self, field: str, values: tuple[Any, ...], corners: tuple[tuple[int, int, int], ...]) -> None:
        """Raise PydanticCustomError where what vertices have is not there for all corners of all faces."""
        faces = f"{field.removesuffix('s')}_faces"
        if corners and len(corners) != len(self.faces):
            raise wrong(f"must hold one entry for each of the {len(self.faces)} faces, got {len(corners)}", faces)
        if values and not corners and len(values) != len(self.vertices):
            raise wrong(f"must hold one entry for each of the {len(self.vertices)} vertices, got {len(values)}", field)
        if corners and max(map(max, corners)) >= len(values):
            raise wrong(f"there are {len(values)} {field}, from 0, got {max(map(max, corners))}", faces)


def _beside(data: Any, key: str) -> Any:
    """The fields of a shape with ``along`` y where none is given and the direction ``key`` is closest to x."""
    normal = data.get(key) if isinstance(data, dict) else None
    if not isinstance(normal, list | tuple) or len(normal) != _AXES or "along" in data:
        return data
    if all(isinstance(c, int | float) for c in normal) and abs(normal[0]) > max(abs(normal[1]), abs(normal[2])):
        return {**data, "along": (0.0, 1.0, 0.0)}
    return data


def _check_edges(u: Triple, v: Triple, first: str, second: str) -> None:
    """Raise PydanticCustomError where two edges span no area."""
    for name, edge in ((first, u), (second, v)):
        if coincide(edge, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", f"{name} must be longer than zero")
    if along(u, v):
        raise PydanticCustomError("scene", f"{first} must not be parallel to {second}: the shape would have no area")


Shape = Annotated[Plane | Sphere | Rectangle | Triangle | Disk | Cylinder | Box | Mesh, Field(discriminator="type")]
