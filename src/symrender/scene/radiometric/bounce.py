"""A radiometric scene as the scene whose lobes the split rule integrates.

What a diffuse hit Q sends to P is (rho_Q/pi) sum_i I_i (N_Q.l_i)/r_i^2: Lambert's term with kd = 1/pi under lights that
fall off; a conductor is a ``sender``. What P makes of it, (rho_P/pi) int cos L dw over the hemisphere of its normal, is
rho_P times the average of L under the lobe of exponent 1 about the normal. A conductor has its own lobe, and phong's is
that of BRDF units, (n + 2)/(2 pi) cos^n over the hemisphere with the cosine inside the integral.

Textures of spheres are linear in what they are mixed of, dark + share (bright - dark): a scene of the dark alone and
one of the difference alone are added. Planes are black behind, so a plane that reflects on both sides is turned to
where it is seen from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Table, chosen, record, table
from symrender.limits import MAX_PLANES
from symrender.scene import arrays as series
from symrender.scene.arrays import BRDF_NORMALISED, CHECKER, LOBE_AVERAGE, MARBLE, PLANE, SOLID, SceneArrays
from symrender.scene.radiometric.arrays import (
    AREA,
    CONDUCTOR,
    DIFFUSE,
    DIRECTIONAL,
    DISK,
    EXTENDED,
    PHONG,
    POINT,
    SKY,
    SPHERE,
    SPOT,
    RadiometricArrays,
)
from symrender.scene.radiometric.records import Glow, Material, Shape
from symrender.scene.radiometric.records import Light as Beam
from symrender.scene.records import Floor, Light, Plane, Shading, Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

LEAST_VEIN: Final = 0.55
VEINS: Final = 0.45
"""The veins of a series' marble are ``LEAST_VEIN`` + ``VEINS`` times the share that is bright."""
SPARE: Final = 2.25
"""Factor by which colours are made smaller and kd larger where differences of veins may exceed 1."""


@dataclass(frozen=True)
class Bounce:
    """Scenes whose lobe averages add up to what arrives, and the hit class of every shape in them.

    A shape equal to an earlier one is not there, and its class is the earlier one's. ``shapes`` are those that are, in
    the order of their classes.
    """

    parts: tuple[SceneArrays, ...]
    classes: Ints
    shapes: tuple[int, ...]
    emitted: Array | None = None
    """(spheres, 3) radiance of spheres, where what they emit is asked."""
    beams: Table[Beam] | None = None
    """The lights along rays, in the order of those of ``parts``, where some of them are spots."""
    glows: Table[Glow] | None = None
    """A sky and spheres that emit, by their place among those of ``parts``, where diffuse shapes send their light."""


def bounce_refusal(arrays: RadiometricArrays) -> str:
    """What of a scene keeps its bounced light from being integrated, as words for a message; empty if nothing does."""
    used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
    words = [EXTENDED[int(light.kind)] for light in arrays.lights if light.kind in EXTENDED]
    if words and any(material.kind != DIFFUSE for material in used) and not arrays.first_gloss:
        return (
            f"{words[0]} beside a conductor or a phong material that reflects after the first hit too "
            "(gloss: first_hit is)"
        )
    if any(shape.kind == DISK for shape in arrays.shapes):
        return "a disk"
    flat = [j for j, shape in enumerate(arrays.shapes) if shape.kind != SPHERE]
    planes = [_material(arrays, j) for j in flat if not _is_dark(arrays, j)]
    if any(material.texture != SOLID and material.kind != DIFFUSE for material in planes):
        return "a texture on a plane of a conductor or a phong material"
    if len(flat) > MAX_PLANES:
        return f"more than {MAX_PLANES} planes"
    return ""


def bounce_scenes(arrays: RadiometricArrays, turned: Flags, own: int) -> Bounce:
    """The scenes in which the light that shape ``own`` reflects is integrated; ``turned`` planes show their back."""
    classes, kept = shape_classes(arrays)
    spheres = [j for j in kept if arrays.shapes[j].kind == SPHERE]
    planes = [j for j in kept if arrays.shapes[j].kind != SPHERE]
    textured = [j for j in spheres if _material(arrays, j).texture != SOLID]
    rays = chosen(arrays.lights, np.isin(arrays.lights["kind"], (POINT, SPOT, DIRECTIONAL)))
    veined = any(_material(arrays, j).texture == MARBLE for j in textured)
    scale = SPARE if veined else 1.0
    parts = []
    for difference in (False, True) if any(_mixed(arrays, j) for j in textured) else (False,):
        rows = table(Sphere, len(spheres))
        for row, j in zip(rows, spheres, strict=True):
            _lay_sphere(arrays.shapes[j], _material(arrays, j), difference, scale, row)
            if _is_dark(arrays, j):
                row.color[:], row.texture = 0.0, SOLID
        sides = table(Plane, len(planes))
        for side, j in zip(sides, planes, strict=True):
            _lay_plane(arrays, j, bool(turned[j]), 0.0 if difference else 1.0 / scale, side)
            if _is_dark(arrays, j):
                side.bright[:], side.dark[:], side.kind = 0.0, 0.0, SOLID
        shading = record(Shading)
        shading.kd = scale / math.pi
        shading.units = BRDF_NORMALISED if _material(arrays, own).kind == PHONG else LOBE_AVERAGE
        parts.append(SceneArrays(rows, record(Floor), _lights(rays), shading, arrays.camera, sides))
    beams = rays if any(light.kind == SPOT for light in rays) else None
    return Bounce(tuple(parts), classes, (*spheres, *planes), None, beams, _glows(arrays, classes))


def lamp_refusal(arrays: RadiometricArrays) -> str:
    """What keeps the light of lamps and the sky on what is glossy from being integrated, as words; empty if nothing."""
    if any(shape.kind == DISK for shape in arrays.shapes):
        return "a disk"
    if any(shape.kind not in (SPHERE, PLANE) for shape in arrays.shapes):
        if any(light.kind == SKY for light in arrays.lights):
            return "a rectangle, a triangle, a box or a mesh, and a sky"
        used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
        if any(material.kind == CONDUCTOR and material.walter for material in used):
            return "a rectangle, a triangle, a box or a mesh, and a conductor of g1: walter"
    if sum(shape.kind == PLANE for shape in arrays.shapes) > MAX_PLANES:
        return f"more than {MAX_PLANES} planes"
    return ""


def lamp_scene(arrays: RadiometricArrays, turned: Flags, own: int) -> Bounce:
    """The scene in which the sky and spheres that emit are as bright as they are, and all else is black."""
    classes, kept = shape_classes(arrays)
    spheres = [j for j in kept if arrays.shapes[j].kind == SPHERE]
    planes = [j for j in kept if arrays.shapes[j].kind == PLANE]
    lamps = [light for light in arrays.lights if light.kind == AREA]
    emitted = np.zeros((len(spheres), 3))
    rows = table(Sphere, len(spheres))
    for k, (row, j) in enumerate(zip(rows, spheres, strict=True)):
        _lay_sphere(arrays.shapes[j], _material(arrays, j), False, 1.0, row)
        row.color[:] = 0.0
        emitted[k] = sum((light.emitted for light in lamps if classes[int(light.emitter)] == classes[j]), np.zeros(3))
    sides = table(Plane, len(planes))
    for side, j in zip(sides, planes, strict=True):
        _lay_plane(arrays, j, bool(turned[j]), 0.0, side)
        side.kind = SOLID
    shading = record(Shading)
    shading.units = BRDF_NORMALISED if _material(arrays, own).kind == PHONG else LOBE_AVERAGE
    shading.background[:] = sum((light.emitted for light in arrays.lights if light.kind == SKY), np.zeros(3))
    dark = SceneArrays(rows, record(Floor), table(Light, 0), shading, arrays.camera, sides)
    return Bounce((dark,), classes, (*spheres, *planes), emitted)


def _material(arrays: RadiometricArrays, j: int) -> Material:
    return arrays.materials[int(arrays.shapes[j].material)]


def _is_dark(arrays: RadiometricArrays, j: int) -> bool:
    """Whether a shape sends nothing on: what is glossy, where gloss reflects at the first hit alone."""
    return arrays.first_gloss and _material(arrays, j).kind != DIFFUSE


def _mixed(arrays: RadiometricArrays, j: int) -> bool:
    """Whether a texture has two reflectances."""
    material = _material(arrays, j)
    return bool((material.bright != material.dark).any()) and not _is_dark(arrays, j)


def shape_classes(arrays: RadiometricArrays) -> tuple[Ints, list[int]]:
    """Hit class by shape, and the shapes that are not equal to an earlier one."""
    first: dict[tuple[float, ...], int] = {}
    same = []
    for j, shape in enumerate(arrays.shapes):
        if shape.kind == SPHERE:
            place = (*shape.place, float(shape.radius))
        else:
            place = (*arrays.frames[j].origin, *arrays.frames[j].up)
        same.append(first.setdefault(tuple(float(x) for x in place), j))
    kept = list(first.values())
    order = [j for j in kept if arrays.shapes[j].kind == SPHERE] + [j for j in kept if arrays.shapes[j].kind != SPHERE]
    number = {j: series.FIRST_SPHERE + k for k, j in enumerate(order)}
    return np.array([number[j] for j in same], dtype=np.int64), sorted(kept)


def _lay_sphere(shape: Shape, material: Material, difference: bool, scale: float, row: Sphere) -> None:
    row.center[:], row.radius = shape.place, shape.radius
    row.weight, row.exponent, row.theta_max = 1.0, _exponent(material), 0.5 * math.pi
    contrast = material.bright - material.dark
    veined = material.texture == MARBLE
    if not difference:
        # what a vein leaves out at least is taken off here
        row.color[:] = (material.dark - (LEAST_VEIN / VEINS if veined else 0.0) * contrast) / scale
        return
    if material.texture == SOLID:
        return
    row.color[:] = contrast / (VEINS * scale if veined else scale)
    row.texture, row.ku, row.kv = material.texture, 2.0 / material.cell, 1.0 / material.cell


def _lay_plane(arrays: RadiometricArrays, j: int, turned: bool, share: float, row: Plane) -> None:
    material, frame = _material(arrays, j), arrays.frames[j]
    row.point[:] = frame.origin
    # seen from behind, y of the texture runs the other way, and stripes show none; squares let x and y change places
    swapped = turned and material.texture == CHECKER
    if turned and material.texture == MARBLE:
        # sin(3 pi y) is odd, and of the other sign a cell further on
        row.point[:] += material.cell * frame.north
    row.normal[:], row.along[:] = -frame.up if turned else frame.up, frame.north if swapped else frame.east
    row.kind, row.cell = material.texture, material.cell
    row.bright[:], row.dark[:] = share * material.bright, share * material.dark
    row.weight, row.exponent, row.theta_max = 1.0, _exponent(material), 0.5 * math.pi


def _exponent(material: Material) -> float:
    return float(material.exponent) if material.kind == PHONG else 1.0


def _glows(arrays: RadiometricArrays, classes: Ints) -> Table[Glow] | None:
    lights = [light for light in arrays.lights if light.kind in (SKY, AREA)]
    rows = table(Glow, len(lights))
    for row, light in zip(rows, lights, strict=True):
        row.radiance[:] = light.emitted
        row.sphere = -1.0 if light.kind == SKY else float(classes[int(light.emitter)] - series.FIRST_SPHERE)
    return rows if lights else None


def _lights(rays: Table[Beam]) -> Table[Light]:
    rows = table(Light, len(rays))
    for row, light in zip(rows, rays, strict=True):
        row.color[:] = light.emitted
        if light.kind in (POINT, SPOT):
            row.kind = series.FALLING
            row.position[:] = light.place
        else:
            row.kind = series.DISTANT
            row.position[:] = -series.AFAR * light.place
    return rows
