"""A scene as plain arrays: the only thing kernels ever see.

Which number stands in which column is fixed here, once; nothing is computed. Kernel text depends on none of it.
A sphere equal to an earlier one, which cannot be seen, is a speck at its centre: kernels leave out the shape a ray
starts from by its identity, and would meet the other one there, by the last bit, as a shadow or a reflection.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.limits import MIN_LENGTH
from symrender.scene.camera import PlaneCamera
from symrender.scene.light import DiskLight
from symrender.scene.lobe import Lobe
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, FloorChecker, Marble, Stripes

Array = npt.NDArray[np.float64]

# spheres[j]: center 0:3, radius 3, colour 4:7, texture kind 7, ku 8, kv 9, dark 10, lobe weight 11, exponent 12,
# theta_max 13 (0 is the mirror)
CENTER: Final = 0
RADIUS: Final = 3
COLOR: Final = 4
TEXTURE: Final = 7
KU: Final = 8
KV: Final = 9
DARK: Final = 10
LOBE: Final = 11
SPHERE_COLUMNS: Final = 14

SOLID: Final = 0
CHECKER: Final = 1
STRIPES: Final = 2
MARBLE: Final = 3

# floor: present 0, kind 1 (SOLID, CHECKER), bright 2:5, dark 5:8, cell 8, offset 9:11, lobe weight 11, exponent 12,
# theta_max 13
FLOOR_PRESENT: Final = 0
FLOOR_KIND: Final = 1
FLOOR_BRIGHT: Final = 2
FLOOR_DARK: Final = 5
FLOOR_CELL: Final = 8
FLOOR_OFFSET: Final = 9
FLOOR_LOBE: Final = 11
FLOOR_COLUMNS: Final = 14

# lights[l]: kind 0 (POINT, DISK), position 1:4, radius 4, colour 5:8, target 8:11
POINT: Final = 0
DISK: Final = 1
LIGHT_COLUMNS: Final = 11

# shading: ka 0, kd 1, ks 2, shininess 3, model 4 (BLINN, PHONG), highlight view 5 (RAY, EYE),
# terminator 6 (CUT, OPEN), ambient 7:10, background 10:13, units of the lobes 13 (LOBE_AVERAGE, BRDF_NORMALISED)
BLINN: Final = 0
PHONG: Final = 1
RAY: Final = 0
EYE: Final = 1
CUT: Final = 0
OPEN: Final = 1
AMBIENT: Final = 7
BACKGROUND: Final = 10
UNITS: Final = 13
LOBE_AVERAGE: Final = 0
BRDF_NORMALISED: Final = 1
SHADING_COLUMNS: Final = 14

# camera: kind 0 (PLANE, LOOK_AT), eye 1:4, then window_half 4, window_center 5:7 (PLANE)
# or target 4:7, up 7:10, fov in degrees 10 (LOOK_AT)
PLANE: Final = 0
LOOK_AT: Final = 1
CAMERA_COLUMNS: Final = 11

# hit classes of an image: what the ray through a pixel's centre meets first
NOTHING: Final = 0
FLOOR: Final = 1
FIRST_SPHERE: Final = 2
"""Sphere j of the scene has hit class ``FIRST_SPHERE + j``."""


@dataclass(frozen=True)
class SceneArrays:
    """The numbers of a scene; float64, C-contiguous, columns as documented in this module.

    ``spheres`` (n, SPHERE_COLUMNS), ``floor`` (FLOOR_COLUMNS,), ``lights`` (m, LIGHT_COLUMNS),
    ``shading`` (SHADING_COLUMNS,), ``camera`` (CAMERA_COLUMNS,).
    """

    spheres: Array
    floor: Array
    lights: Array
    shading: Array
    camera: Array


def _lobe(lobe: Lobe | None) -> tuple[float, float, float]:
    if lobe is None:
        return 0.0, 0.0, 0.0
    return lobe.weight, lobe.exponent, 0.0 if lobe.mirror else lobe.theta_max


def scene_arrays(scene: Scene) -> SceneArrays:
    """Lay ``scene`` out as arrays, in the order of its lists."""
    spheres = np.zeros((len(scene.spheres), SPHERE_COLUMNS))
    earlier: set[tuple[tuple[float, ...], float]] = set()
    for row, sphere in zip(spheres, scene.spheres, strict=True):
        place = (sphere.center, sphere.radius)
        row[:7] = (*sphere.center, MIN_LENGTH if place in earlier else sphere.radius, *sphere.color)
        earlier.add(place)
        match sphere.texture:
            case Checker(ku=ku, kv=kv, dark=dark):
                row[7:11] = CHECKER, ku, kv, dark
            case Stripes(ku=ku, dark=dark):
                row[7:11] = STRIPES, ku, 0.0, dark
            case Marble(ku=ku, kv=kv):
                row[7:11] = MARBLE, ku, kv, 0.0
        row[11:] = _lobe(sphere.lobe)

    floor = np.zeros(FLOOR_COLUMNS)
    if scene.floor is not None:
        floor[FLOOR_PRESENT] = 1.0
        floor[FLOOR_LOBE:] = _lobe(scene.floor.lobe)
        match scene.floor.texture:
            case FloorChecker(bright=bright, dark=dark_color, cell=cell, offset=offset):
                floor[1:11] = (CHECKER, *bright, *dark_color, cell, *offset)
            case solid:
                floor[1:11] = (SOLID, *solid.color, *solid.color, 1.0, 0.0, 0.0)

    lights = np.zeros((len(scene.lights), LIGHT_COLUMNS))
    for row, light in zip(lights, scene.lights, strict=True):
        row[1:4], row[5:8] = light.position, light.color
        if isinstance(light, DiskLight) and light.radius > 0:
            row[0], row[4], row[8:11] = DISK, light.radius, light.target

    s = scene.shading
    shading = np.array(
        [
            *(s.ka, s.kd, s.ks, s.shininess),
            PHONG if s.model == "phong" else BLINN,
            EYE if s.highlight_view == "eye" else RAY,
            OPEN if s.specular_terminator == "open" else CUT,
            *scene.ambient,
            *scene.background,
            BRDF_NORMALISED if s.lobe_units == "brdf_normalised" else LOBE_AVERAGE,
        ]
    )

    camera = np.zeros(CAMERA_COLUMNS)
    camera[1:4] = scene.camera.eye
    if isinstance(scene.camera, PlaneCamera):
        camera[0], camera[4], camera[5:7] = PLANE, scene.camera.window_half, scene.camera.window_center
    else:
        camera[0], camera[4:7], camera[7:10] = LOOK_AT, scene.camera.target, scene.camera.up
        camera[10] = scene.camera.fov
    return SceneArrays(spheres, floor, lights, shading, camera)
