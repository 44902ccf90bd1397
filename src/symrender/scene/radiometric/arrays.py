"""A radiometric scene as records: the only thing kernels see. Nothing is computed but frames and unit vectors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table, copied, flat, record, table
from symrender.scene.arrays import CHECKER, LOOK_AT, MARBLE, PLANE, SOLID, STRIPES
from symrender.scene.formula import Step, steps_of
from symrender.scene.frames import frames
from symrender.scene.radiometric import lights, shapes
from symrender.scene.radiometric.detail import Detail, Gallery
from symrender.scene.radiometric.exposure import Exposure, exposure_of
from symrender.scene.radiometric.materials import (
    Checker,
    Conductor,
    Dielectric,
    Diffuse,
    Marble,
    Phong,
    Plastic,
    Reflectance,
    Solid,
)
from symrender.scene.radiometric.materials import Material as MaterialPart
from symrender.scene.radiometric.records import Facet, Light, Material, Shape, Term
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Shape as ShapePart
from symrender.scene.radiometric.textures import Checkerboard, Image
from symrender.scene.records import Camera, Frame
from symrender.scene.records import Plane as PlaneRecord

Array = npt.NDArray[np.float64]

# kinds of a material
DIFFUSE: Final = 0
CONDUCTOR: Final = 1
PHONG: Final = 2
DIELECTRIC: Final = 3
PLASTIC: Final = 4
SAMPLED_MATERIALS: Final = {CONDUCTOR: "a smooth conductor", DIELECTRIC: "a dielectric", PLASTIC: "plastic"}
"""Kinds of materials that quadrature does not know, in words."""

# densities of facet normals
GGX: Final = 0
BECKMANN: Final = 1

# kinds of a shape; a plane is PLANE
SPHERE: Final = 1
RECTANGLE: Final = 3
TRIANGLE: Final = 4
DISK: Final = 5
BOX: Final = 6
MESH: Final = 7
CYLINDER: Final = 8
SAMPLED_SHAPES: Final = {CYLINDER: "a cylinder"}
"""Kinds of shapes that quadrature does not know, in words."""

# textures in the (u, v) of shapes, beside SOLID, CHECKER, STRIPES and MARBLE
IMAGE: Final = 4
CHECKERBOARD: Final = 5

# kinds of a light; a point is POINT
POINT: Final = 0
DIRECTIONAL: Final = 1
SKY: Final = 2
AREA: Final = 3
SPOT: Final = 4
ENVIRONMENT: Final = 5
EXTENDED: Final = {SKY: "a sky", AREA: "an area light", ENVIRONMENT: "an environment"}
"""Kinds of lights that leave penumbrae, in words."""

# kinds of a term of a height field
NUMBER: Final = 0
ALONG_X: Final = 1
ALONG_Y: Final = 2
ALONG_Z: Final = 3
SUM: Final = 4
DIFFERENCE: Final = 5
PRODUCT: Final = 6
SINE: Final = 7
COSINE: Final = 8
EXPONENTIAL: Final = 9
POWER: Final = 10
DISTANCE: Final = 11
_STEPS: Final = ("number", "x", "y", "z", "add", "sub", "mul", "sin", "cos", "exp", "pow", "distance")
"""What a scene calls them, in the order of their kinds."""

FIRST_SHAPE: Final = 1
"""Shape j of the scene has hit class ``FIRST_SHAPE + j``; 0 is nothing."""

ALL: Final = 1 << 30
"""``bounces`` of a scene that asks for all of them."""


@dataclass(frozen=True)
class RadiometricArrays:
    """The numbers of a scene as records, in the order of its lists.

    ``frames`` say where planes, disks and cylinders lie.

    ``directions`` (lights, 3) are those of directional lights and spots, of any length: ``place`` of the first and
    ``axis`` of the others is its unit vector. ``facets`` are those of all meshes, ``terms`` those of the heights of all
    bumps. Places are those of the time at which the shutter opens; ``exposure`` is what an image is the mean over
    beside its pixels.
    """

    materials: Table[Material]
    terms: Table[Term]
    shapes: Table[Shape]
    facets: Table[Facet]
    frames: Table[Frame]
    lights: Table[Light]
    directions: Array
    camera: Camera
    bounces: int
    exposure: Exposure
    first_gloss: bool = False
    """Whether conductors and phong materials reflect at the first hit alone, and are black to other surfaces."""
    detail: Detail = field(default_factory=Detail)
    """Images, and what vertices of meshes have, which the path tracer alone reads."""


def radiometric_arrays(scene: RadiometricScene) -> RadiometricArrays:
    """Lay ``scene`` out as records."""
    materials = table(Material, len(scene.materials))
    names = {name: index for index, name in enumerate(scene.materials)}
    steps: list[Step] = []
    gallery = Gallery()
    for index, material in enumerate(scene.materials.values()):
        _lay_material(material, materials[index], gallery)
        _lay_bump(material, materials[index], steps)
    rows = table(Shape, len(scene.shapes))
    for j, shape in enumerate(scene.shapes):
        row = rows[j]
        row.material = names[shape.material]
        _lay_shape(shape, row)
    facets = _lay_facets(scene.shapes, rows)
    lit = table(Light, len(scene.lights))
    directions = np.zeros((len(scene.lights), 3))
    places = {shape.name: j for j, shape in enumerate(scene.shapes)}
    for light_row, travel, light in zip(lit, directions, scene.lights, strict=True):
        match light:
            case lights.Point():
                light_row.kind = POINT
                light_row.place[:], light_row.emitted[:] = light.position, light.intensity
            case lights.Directional():
                light_row.kind = DIRECTIONAL
                travel[:] = light.direction
                light_row.emitted[:] = light.irradiance
            case lights.Spot():
                light_row.kind = SPOT
                light_row.place[:], light_row.emitted[:] = light.position, light.intensity
                travel[:] = light.direction
                light_row.beam, light_row.cutoff, light_row.smooth = light.beam, light.cutoff, light.falloff == "smooth"
            case lights.Sky():
                light_row.kind = SKY
                light_row.emitted[:] = light.radiance
            case lights.Environment():
                light_row.kind, light_row.emitter = ENVIRONMENT, gallery.hang(light)
                light_row.emitted[:] = light.scale
            case lights.Area():
                light_row.kind, light_row.emitter = AREA, places[light.shape]
                light_row.emitted[:] = light.radiance
    camera = record(Camera)
    camera.kind, camera.fov = LOOK_AT, scene.camera.fov
    camera.eye[:], camera.target[:], camera.up[:] = scene.camera.eye, scene.camera.target, scene.camera.up
    bounces, exposure = ALL if scene.bounces == "all" else scene.bounces, exposure_of(scene)
    _carry(rows, lit, camera, exposure)
    laid = laid_out(
        materials, _terms(steps), rows, facets, lit, directions, camera, bounces, exposure, scene.gloss == "first_hit"
    )
    return replace(laid, detail=gallery.detail(scene.shapes, len(facets)))


def _carry(shapes: Table[Shape], lights: Table[Light], camera: Camera, exposure: Exposure) -> None:
    """Move all to where it is when the shutter opens."""
    for shape, velocity in zip(shapes, exposure.shapes * exposure.opens, strict=True):
        for vertex in (shape.place, shape.second, shape.third) if shape.kind == TRIANGLE else (shape.place,):
            vertex[:] += velocity
    for light, velocity in zip(lights, exposure.lights * exposure.opens, strict=True):
        light.place[:] += velocity
    for place in (camera.eye, camera.target):
        place[:] += exposure.camera * exposure.opens


def laid_out(
    materials: Table[Material], terms: Table[Term], shapes: Table[Shape], facets: Table[Facet], lights: Table[Light],
    directions: Array, camera: Camera, bounces: int, exposure: Exposure, first_gloss: bool,
) -> RadiometricArrays:  # fmt: skip
    """The records of a scene, and what follows: frames of planes, disks and cylinders, unit vectors of lights."""
    places, lit = table(Frame, len(shapes)), copied(lights)
    for j, row in enumerate(shapes):
        if row.kind in (PLANE, DISK, CYLINDER):
            places[j] = frames(plane_record(row))[0]
    for i, light in enumerate(lit):
        if light.kind in (DIRECTIONAL, SPOT):
            direction = directions[i] / np.abs(directions[i]).max()
            unit = light.place if light.kind == DIRECTIONAL else light.axis
            unit[:] = direction / np.sqrt(direction @ direction)
    return RadiometricArrays(
        materials, terms, shapes, facets, places, lit, directions, camera, bounces, exposure, first_gloss
    )  # fmt: skip


def plane_record(shape: Shape) -> Table[PlaneRecord]:
    """Where a plane, a disk or a cylinder lies, as the one record of a table."""
    one = table(PlaneRecord, 1)
    one[0].point[:], one[0].normal[:], one[0].along[:] = shape.place, shape.normal, shape.along
    return one


def _lay_shape(shape: ShapePart, row: Shape) -> None:
    match shape:
        case shapes.Sphere():
            row.kind, row.radius = SPHERE, shape.radius
            row.place[:] = shape.center
        case shapes.Plane():
            row.kind = PLANE
            row.place[:], row.normal[:], row.along[:] = shape.point, shape.normal, shape.along
        case shapes.Disk():
            row.kind, row.radius = DISK, shape.radius
            row.place[:], row.normal[:], row.along[:] = shape.center, shape.normal, shape.along
        case shapes.Cylinder():
            row.kind, row.radius, row.caps = CYLINDER, shape.radius, shape.caps
            row.place[:], row.normal[:], row.along[:] = shape.base, shape.axis, shape.along
        case shapes.Rectangle():
            row.kind = RECTANGLE
            row.place[:], row.second[:], row.third[:] = shape.corner, shape.edge_u, shape.edge_v
        case shapes.Triangle():
            row.kind = TRIANGLE
            row.place[:], row.second[:], row.third[:] = shape.vertices
        case shapes.Box():
            row.kind, row.rotation = BOX, shape.rotation
            row.place[:], row.second[:] = shape.center, shape.size
        case shapes.Mesh():
            row.kind, row.radius, row.rotation = MESH, shape.scale, shape.rotation
            row.place[:] = shape.position


def _lay_facets(parts: tuple[ShapePart, ...], rows: Table[Shape]) -> Table[Facet]:
    """The facets of all meshes, and in their rows where each mesh's begin and how many they are."""
    corners = [np.zeros((0, 9))]
    start = 0
    for shape, row in zip(parts, rows, strict=True):
        if isinstance(shape, shapes.Mesh):
            corners.append(np.array(shape.vertices)[np.array(shape.faces)].reshape(-1, 9))
            row.start, row.faces = start, len(shape.faces)
            start += len(shape.faces)
    facets = table(Facet, start)
    flat(facets)[:] = np.concatenate(corners)
    return facets


def _lay_material(material: MaterialPart, row: Material, gallery: Gallery) -> None:
    row.two_sided = material.two_sided
    _lay_reflectance(material.reflectance, row, gallery)
    match material:
        case Diffuse():
            row.kind = DIFFUSE
        case Conductor():
            row.kind = CONDUCTOR
            _lay_facets_of(material, row)
            row.eta[:], row.k[:] = material.eta, material.k
        case Dielectric():
            row.kind, row.ior, row.thin = DIELECTRIC, material.ior, material.thin
            _lay_facets_of(material, row)
            row.transmitted[:] = material.transmittance
        case Plastic():
            row.kind, row.ior, row.nonlinear = PLASTIC, material.ior, material.nonlinear
            _lay_facets_of(material, row)
            row.specular[:] = material.specular
        case Phong():
            row.kind, row.exponent = PHONG, material.exponent


def _lay_facets_of(material: Conductor | Dielectric | Plastic, row: Material) -> None:
    row.density = BECKMANN if material.distribution == "beckmann" else GGX
    row.alpha = material.alpha
    row.correlated = material.masking == "correlated"
    row.walter = material.g1 == "walter"


def _lay_bump(material: MaterialPart, row: Material, steps: list[Step]) -> None:
    """Write what turns the normals of a material, its steps behind those of others."""
    bump = material.bump
    if bump is None:
        return
    own = steps_of(bump.height)
    row.amplitude, row.begin, row.terms = bump.amplitude, len(steps), len(own)
    row.own, row.geometric = bump.coordinates == "own", bump.normals == "geometric"
    steps += own


def _terms(steps: list[Step]) -> Table[Term]:
    rows = table(Term, len(steps))
    for row, step in zip(rows, steps, strict=True):
        row.kind, row.number, row.first, row.second = _STEPS.index(step.kind), step.number, step.first, step.second
        row.center[:] = step.center
    return rows


def _lay_reflectance(reflectance: Reflectance, row: Material, gallery: Gallery) -> None:
    row.cell = 1.0
    if isinstance(reflectance, Image):
        row.texture, row.picture = IMAGE, gallery.hang(reflectance)
        row.bright[:] = 1.0
        return
    if isinstance(reflectance, Checkerboard):
        row.texture, row.picture = CHECKERBOARD, gallery.hang(reflectance)
        row.bright[:], row.dark[:] = reflectance.bright, reflectance.dark
        return
    if isinstance(reflectance, Solid):
        row.texture = SOLID
        row.bright[:] = row.dark[:] = reflectance.color
        return
    kinds = {Checker: CHECKER, Marble: MARBLE}
    row.texture = kinds.get(type(reflectance), STRIPES)
    row.bright[:], row.dark[:], row.cell = reflectance.bright, reflectance.dark, reflectance.cell
