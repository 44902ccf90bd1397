"""Shapes of a Mitsuba file: spheres, cylinders, flat ones, cubes, and meshes by the file that holds them.

A comment of symrender says in full what a matrix says to rounding, and which square stands for an endless plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from symrender.scene.mitsuba.colours import Reader
from symrender.scene.mitsuba.finite import check_chart, flat_fields
from symrender.scene.mitsuba.flats import fields_of, mesh_indices, told_shape
from symrender.scene.mitsuba.plane import square, told
from symrender.scene.mitsuba.properties import Properties
from symrender.scene.mitsuba.transforms import ROUNDING, Array, taken_transform, uniform_scale
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.radiometric.shapes import Plane

FLATS: Final = {"rectangle": "rectangle", "disk": "disk", "cube": "box"}
"""Flat shapes and what they are called here."""
MESHES: Final = ("ply", "obj", "serialized")
"""Shapes that are files of meshes."""
KNOWN: Final = "sphere, rectangle, disk, cube, cylinder, obj, ply, serialized, instance and shapegroup"
_UNIT: Final = np.eye(4)


@dataclass(frozen=True)
class Made:
    """A shape as fields without name and material, and of a sphere or plane the scales of a checker of cell 1."""

    fields: dict[str, Any]
    due: tuple[float, float] | None = None


@dataclass(frozen=True)
class Dress:
    """The material of a shape: its name, its entry, and the scales of a checker with a comment."""

    name: str
    material: dict[str, Any]
    scales: list[float] | None

    @property
    def cell(self) -> float:
        """Side of a field of its checker."""
        return float(self.material["reflectance"]["cell"])


def made(properties: Properties, dress: Dress, reader: Reader, outer: Array, lit: bool) -> Made:
    """The shape of a plugin; ``outer`` (4, 4) leads from its group to the world, ``lit`` says whether it emits."""
    element = properties.element
    kind = str(element.attributes.get("type"))
    matrix = taken_transform(properties)
    whole = outer @ (_UNIT if matrix is None else matrix)
    plane = next((found for comment in element.comments if (found := told(comment))), None)
    flip = properties.flag("flip_normals", False)
    properties.pop("id", "silhouette_sampling_weight")
    if kind == "sphere":
        return _sphere(properties, whole, dress, flip != reader.mirrored, lit)
    if kind == "rectangle" and plane is not None:
        return _plane(properties, whole, plane)
    if kind in FLATS:
        return _flat(properties, element, FLATS[kind], whole, dress, flip)
    if kind == "cylinder":
        return _cylinder(properties, whole, dress, flip, lit)
    if kind == "ply" and (triangle := told_shape(element.comments, "triangle", "t")) is not None:
        # the file beside this one is not opened: it says what the comment says, in single precision
        properties.pop("filename", "face_normals")
        properties.done("filename, face_normals and bsdf")
        return Made({"type": "triangle", **fields_of(triangle)})
    if kind in MESHES:
        return _mesh(properties, kind, whole, reader, flip)
    raise properties.wrong(f"no such shape here; known are {KNOWN}")


def _sphere(properties: Properties, matrix: Array, dress: Dress, flip: bool, lit: bool) -> Made:
    center, radius = properties.place("center", (0.0, 0.0, 0.0)), properties.number("radius", 1.0)
    properties.done("center, radius, to_world and bsdf")
    scale = uniform_scale(matrix)
    if scale is None:
        raise properties.wrong("to_world must turn, move and scale alike in all directions: no scene has ellipsoids")
    mirrored = bool(np.linalg.det(matrix[:3, :3]) < 0.0)
    if flip != mirrored:
        _needs_no_side(properties, dress, lit)
    placed = matrix[:3, :3] @ center + matrix[:3, 3] if (matrix != _UNIT).any() else np.array(center)
    if dress.scales is not None:
        half_turn = np.diag([-scale, -scale, scale])
        if np.abs(matrix[:3, :3] - half_turn).max() > 1e-12 * scale or any(center):
            raise properties.wrong(
                "a checker with a comment needs the to_world of half a turn about z, -r 0 0 x 0 -r 0 y 0 0 r z 0 0 0 1"
            )
    elif _is_textured(dress.material) and np.abs(matrix[:3, :3] - scale * np.eye(3)).max() > ROUNDING * scale:
        raise properties.wrong("a texture on a sphere that to_world turns is not supported")
    fields = {"type": "sphere", "center": [float(x) for x in placed], "radius": radius * scale}
    return Made(fields, (1.0, 0.5))


def _needs_no_side(properties: Properties, dress: Dress, lit: bool) -> None:
    """Refuse a round shape with its normal inside, where that is seen."""
    if lit or not dress.material.get("two_sided"):
        raise properties.wrong("its normals point inward, which is supported with a bsdf twosided alone")


def _is_textured(material: dict[str, Any]) -> bool:
    textures = (material.get(field) for field in ("reflectance", "diffuse"))
    return any(isinstance(texture, dict) and texture["type"] != "solid" for texture in textures)


def _cylinder(properties: Properties, matrix: Array, dress: Dress, flip: bool, lit: bool) -> Made:
    ends = [properties.place(name, default) for name, default in (("p0", (0.0, 0.0, 0.0)), ("p1", (0.0, 0.0, 1.0)))]
    radius = properties.number("radius", 1.0)
    properties.done("p0, p1, radius, to_world and bsdf")
    scale = uniform_scale(matrix)
    if scale is None:
        axis = np.array(ends[1]) - ends[0]
        scale = _across(matrix, axis)
        if scale is None:
            raise properties.wrong("to_world must leave the circle of a cylinder a circle")
    if flip:
        _needs_no_side(properties, dress, lit)
    if _is_textured(dress.material):
        raise properties.wrong("a texture on a cylinder is not supported")
    base, top = (matrix[:3, :3] @ end + matrix[:3, 3] for end in ends)
    fields = {"type": "cylinder", "base": base.tolist(), "axis": (top - base).tolist(), "radius": radius * scale}
    return Made(fields | {"caps": False})


def _across(matrix: Array, axis: Array) -> float | None:
    """The factor by which a matrix scales circles about an axis; None where they do not stay circles about it."""
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        return None
    unit = axis / length
    first = np.cross(unit, np.eye(3)[int(np.argmin(np.abs(unit)))])
    first /= np.linalg.norm(first)
    u, v, w = (matrix[:3, :3] @ direction for direction in (first, np.cross(unit, first), unit))
    size = float(np.linalg.norm(u))
    skewed = (abs(u @ v) / size**2, abs(u @ w) / (size * np.linalg.norm(w)), abs(np.linalg.norm(v) / size - 1.0))
    return size if all(float(x) <= ROUNDING for x in skewed) else None


def _plane(properties: Properties, matrix: Array, plane: dict[str, list[float]]) -> Made:
    """A plane by its comment, refused where the square says another one, and half a side of the square."""
    properties.done("to_world and bsdf")
    rows = [float(x) for x in matrix.ravel()]
    half = sum(x * x for x in rows[0:9:4]) ** 0.5
    try:
        fields: Any = {key: tuple(value) for key, value in plane.items()}
        due = square(Plane(name="plane", material="m", **fields), half)
    except ValueError:
        raise properties.wrong("its comment names no plane") from None
    sizes = [half, half, 1.0, 1.0] * 4
    if not all(abs(a - b) <= 1e-12 * (abs(b) + size) for a, b, size in zip(rows, due, sizes, strict=True)):
        raise properties.wrong("its to_world is not a square of the plane that its comment names")
    return Made({"type": "plane", **plane}, (half, half))


def _flat(properties: Properties, element: Element, kind: str, matrix: Array, dress: Dress, flip: bool) -> Made:
    properties.done("to_world and bsdf")
    fields = flat_fields(properties, element.comments, kind, [float(x) for x in matrix.ravel()])
    if fields is None:
        return Made(_as_mesh(properties, matrix, dress, flip))
    if dress.scales is not None:
        check_chart(properties, kind, fields, dress.scales, dress.cell)
    if not flip:
        return Made({"type": kind, **fields})
    match kind:
        case "rectangle":
            if _is_textured(dress.material):
                raise properties.wrong("flip_normals with a texture is not supported")
            fields["edge_u"], fields["edge_v"] = fields["edge_v"], fields["edge_u"]
        case "disk":
            fields["normal"] = [-x for x in fields["normal"]]
        case _:
            return Made(_as_mesh(properties, matrix, dress, flip))
    return Made({"type": kind, **fields})


def _as_mesh(properties: Properties, matrix: Array, dress: Dress, flip: bool) -> dict[str, Any]:
    """A cube that no box is, as twelve triangles whose normals point outward, or inward."""
    if _is_textured(dress.material):
        raise properties.wrong("a texture on a cube that is no box about the vertical is not supported")
    corners = [[1.0 if k >> axis & 1 else -1.0 for axis in range(3)] for k in range(8)]
    vertices = np.array(corners) @ matrix[:3, :3].T + matrix[:3, 3]
    around = mesh_indices(8)
    faces = [list(around[k : k + 3]) for k in range(0, len(around), 3)]
    if flip != bool(np.linalg.det(matrix[:3, :3]) < 0.0):
        faces = [face[::-1] for face in faces]
    return {"type": "mesh", "vertices": vertices.tolist(), "faces": faces}


def _mesh(properties: Properties, kind: str, matrix: Array, reader: Reader, flip: bool) -> Made:
    name = properties.word("filename", "")
    if not name:
        raise properties.wrong("needs a filename")
    fields: dict[str, Any] = {"type": "mesh", "file": reader.path(properties.element, name), "format": kind}
    if (matrix != _UNIT).any():
        fields["to_world"] = [float(x) for x in matrix.ravel()]
    fields["vertex_normals"] = "none" if properties.flag("face_normals", False) else "smooth"
    if kind == "serialized":
        fields["part"] = int(properties.number("shape_index", 0.0))
    if properties.flag("flip_tex_coords", kind == "obj") != (kind == "obj"):
        fields["flip_v"] = True
    if flip:
        fields["flip_faces"] = True
    if reader.mirrored:
        fields["turn_bare"] = True
    angle = properties.number("max_smooth_angle", 0.0)
    if angle:
        raise properties.wrong("max_smooth_angle is not supported")
    properties.done("filename, shape_index, to_world, face_normals, flip_normals and bsdf")
    return Made(fields)
