"""A scene as plain arrays: the only thing kernels ever see.

Nothing is computed. The fields stand in ``scene/records.py``, what their whole numbers mean stands here.
A sphere equal to an earlier one, which cannot be seen, is a speck at its centre: kernels leave out the shape a ray
starts from by its identity, and would meet the other one there, by the last bit, as a shadow or a reflection.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table, record, table
from symrender.limits import MIN_LENGTH
from symrender.scene.camera import PlaneCamera
from symrender.scene.light import DiskLight
from symrender.scene.lobe import Lobe
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, FloorChecker, FloorSolid, Marble, Stripes

Array = npt.NDArray[np.float64]

# texture kinds of a sphere; a floor is SOLID or CHECKER
SOLID: Final = 0
CHECKER: Final = 1
STRIPES: Final = 2
MARBLE: Final = 3

# kinds of a light
POINT: Final = 0
DISK: Final = 1
FALLING: Final = 2
"""A point whose light falls off with the square of its distance, as in radiometric scenes."""
DISTANT: Final = 3
"""A directional light: a point so far away (``AFAR``) that from everywhere in the scene it stands in one direction."""
AFAR: Final = 1e30

# conventions of shading: model, highlight view, terminator, units of the lobes
BLINN: Final = 0
PHONG: Final = 1
RAY: Final = 0
EYE: Final = 1
CUT: Final = 0
OPEN: Final = 1
LOBE_AVERAGE: Final = 0
BRDF_NORMALISED: Final = 1

# kinds of a camera
PLANE: Final = 0
LOOK_AT: Final = 1

# hit classes of an image: what the ray through a pixel's centre meets first
NOTHING: Final = 0
FLOOR: Final = 1
FIRST_SPHERE: Final = 2
"""Sphere j of the scene has hit class ``FIRST_SPHERE + j``; planes follow the spheres."""


@dataclass(frozen=True)
class SceneArrays:
    """The numbers of a scene as records, in the order of its lists."""

    spheres: Table[Sphere]
    floor: Floor
    lights: Table[Light]
    shading: Shading
    camera: Camera
    planes: Table[Plane] = field(default_factory=lambda: table(Plane, 0))


def scene_arrays(scene: Scene) -> SceneArrays:
    """Lay ``scene`` out as records."""
    spheres = table(Sphere, len(scene.spheres))
    earlier: set[tuple[tuple[float, ...], float]] = set()
    for row, sphere in zip(spheres, scene.spheres, strict=True):
        place = (sphere.center, sphere.radius)
        row.center[:], row.color[:] = sphere.center, sphere.color
        row.radius = MIN_LENGTH if place in earlier else sphere.radius
        earlier.add(place)
        match sphere.texture:
            case Checker(ku=ku, kv=kv, dark=dark):
                row.texture, row.ku, row.kv, row.dark = CHECKER, ku, kv, dark
            case Stripes(ku=ku, dark=dark):
                row.texture, row.ku, row.dark = STRIPES, ku, dark
            case Marble(ku=ku, kv=kv):
                row.texture, row.ku, row.kv = MARBLE, ku, kv
        row.weight, row.exponent, row.theta_max = _lobe(sphere.lobe)

    floor = record(Floor)
    if scene.floor is not None:
        floor.present = 1.0
        floor.weight, floor.exponent, floor.theta_max = _lobe(scene.floor.lobe)
        _surface(scene.floor.texture, floor)
    planes = table(Plane, len(scene.planes))
    for plane_row, plane in zip(planes, scene.planes, strict=True):
        plane_row.point[:], plane_row.normal[:], plane_row.along[:] = plane.point, plane.normal, plane.along
        plane_row.weight, plane_row.exponent, plane_row.theta_max = _lobe(plane.lobe)
        _surface(plane.texture, plane_row)

    lights = table(Light, len(scene.lights))
    for light_row, light in zip(lights, scene.lights, strict=True):
        light_row.kind = POINT
        light_row.position[:], light_row.color[:] = light.position, light.color
        if isinstance(light, DiskLight) and light.radius > 0:
            light_row.kind, light_row.radius = DISK, light.radius
            light_row.target[:] = light.target

    shading, s = record(Shading), scene.shading
    shading.ka, shading.kd, shading.ks, shading.shininess = s.ka, s.kd, s.ks, s.shininess
    shading.model = PHONG if s.model == "phong" else BLINN
    shading.highlight_view = EYE if s.highlight_view == "eye" else RAY
    shading.terminator = OPEN if s.specular_terminator == "open" else CUT
    shading.units = BRDF_NORMALISED if s.lobe_units == "brdf_normalised" else LOBE_AVERAGE
    shading.ambient[:], shading.background[:] = scene.ambient, scene.background

    camera = record(Camera)
    camera.eye[:] = scene.camera.eye
    if isinstance(scene.camera, PlaneCamera):
        camera.kind, camera.window_half = PLANE, scene.camera.window_half
        camera.window_center[:] = scene.camera.window_center
    else:
        camera.kind, camera.fov = LOOK_AT, scene.camera.fov
        camera.target[:], camera.up[:] = scene.camera.target, scene.camera.up
    return SceneArrays(spheres, floor, lights, shading, camera, planes)


def lobes_of(arrays: SceneArrays) -> Array:
    """(1 + n + k, 3): weight, exponent and theta_max of the lobes of the floor, of each sphere and of each plane.

    Hit class h has row h - 1.
    """
    floor = arrays.floor
    rows = [(floor.weight, floor.exponent, floor.theta_max)]
    rows += [(sphere.weight, sphere.exponent, sphere.theta_max) for sphere in arrays.spheres]
    rows += [(plane.weight, plane.exponent, plane.theta_max) for plane in arrays.planes]
    return np.array(rows)


def _surface(texture: FloorSolid | FloorChecker, row: Floor | Plane) -> None:
    match texture:
        case FloorChecker(bright=bright, dark=dark, cell=cell, offset=offset):
            row.kind, row.cell = CHECKER, cell
            row.bright[:], row.dark[:], row.offset[:] = bright, dark, offset
        case FloorSolid(color=color):
            row.kind, row.cell = SOLID, 1.0
            row.bright[:] = row.dark[:] = color


def _lobe(lobe: Lobe | None) -> tuple[float, float, float]:
    if lobe is None:
        return 0.0, 0.0, 0.0
    return lobe.weight, lobe.exponent, 0.0 if lobe.mirror else lobe.theta_max
