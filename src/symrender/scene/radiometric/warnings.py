"""What is odd about a radiometric scene that is nevertheless valid."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from symrender.limits import MAX_QUADRATURE_TRIANGLES
from symrender.scene.radiometric.lights import Directional, Environment, Point, Sky, Spot
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Box, Mesh, Plane, Shape, Sphere
from symrender.scene.values import Part

_Point = tuple[float, float, float]
_MANY: Final = 5000
"""Triangles from which on a scene is expensive."""
_READY: Final = 4e-4
_BYTES: Final = 9e3
_PIXEL: Final = 1e-5
"""Seconds of a processor and bytes that a triangle takes before the first pixel, and seconds in a pixel of a light.

Measured: dented balls of 4,760 and 19,320 triangles under a point light took 3.1 and 8.8 s and 154 and 283 MB to the
first pixel, and .042 and .19 s a pixel over 100 pixels.
"""


def radiometric_warnings(scene: RadiometricScene) -> tuple[str, ...]:
    """One line for each oddity of ``scene``, naming its part: camera, lights, shapes, materials, in this order."""
    film = tuple(f"film: {note}" for note in scene.film.notes.split("; ") if note) if scene.film is not None else ()
    return (*film, *_camera(scene), *_lights(scene), *_shapes(scene))


def _beyond(shape: Shape, point: _Point) -> str:
    """``behind`` or ``inside`` where a shape parts a point from the side its normal shows to, else nothing."""
    match shape:
        case Plane():
            below = sum(n * (p - q) for n, p, q in zip(shape.normal, point, shape.point, strict=True)) < 0
            return "behind" if below else ""
        case Sphere():
            return "inside" if math.dist(point, shape.center) < shape.radius else ""
        case Box():
            x, y, z = (p - q for p, q in zip(point, shape.center, strict=True))
            turn = math.radians(shape.rotation)
            c, s = math.cos(turn), math.sin(turn)
            within = zip((c * x + s * y, c * y - s * x, z), shape.size, strict=True)
            return "inside" if all(abs(2.0 * place) < size for place, size in within) else ""
    return ""


def _camera(scene: RadiometricScene) -> Iterator[str]:
    for shape in scene.shapes:
        if side := _beyond(shape, scene.camera.eye):
            seen = "reflects there too" if scene.materials[shape.material].two_sided else "is black from there"
            yield f"camera.eye is {side} shapes.{shape.name}, which {seen} and hides what is beyond it"


def _lights(scene: RadiometricScene) -> Iterator[str]:
    if not scene.lights:
        yield "there are no lights: the image is black"
    used = {shape.material for shape in scene.shapes}
    smooth = [name for name in scene.materials if name in used and getattr(scene.materials[name], "alpha", 1.0) == 0.0]
    for light in scene.lights:
        if smooth and isinstance(light, Point | Spot | Directional):
            yield (
                f"lights.{light.name}: no path finds its light in what materials.{smooth[0]} mirrors or bends, for "
                "that is smooth and the light is a point or a direction: the image is without it"
            )
        if isinstance(light, Sky | Environment):
            continue
        for shape in scene.shapes:
            if isinstance(light, Point) and (side := _beyond(shape, light.position)):
                yield f"lights.{light.name} is {side} shapes.{shape.name}: nothing on the other side is lit by it"


def _shapes(scene: RadiometricScene) -> Iterator[str]:
    if not scene.shapes:
        yield "there is nothing to see: no shapes"
    for shape in scene.shapes:
        if isinstance(shape, Mesh) and shape.notes:
            yield f"shapes.{shape.name}: {shape.notes}"
    triangles = sum(len(shape.faces) for shape in scene.shapes if isinstance(shape, Mesh))
    if triangles > MAX_QUADRATURE_TRIANGLES:
        yield f"its meshes have {triangles} triangles, and quadrature takes {MAX_QUADRATURE_TRIANGLES}: paths sample it"
    elif triangles > _MANY:
        yield (
            f"its meshes have {triangles} triangles: an image without noise takes {_READY * triangles:.2g} s and "
            f"{_BYTES * triangles / 1e6:.2g} MB before its first pixel, then {_PIXEL * triangles:.2g} s a pixel for "
            "every light, without bounces; with them far more"
        )
    first: dict[Part, str] = {}
    for shape in scene.shapes:
        same = shape.model_copy(update={"name": "shape", "material": "material", "notes": ""})
        other = first.setdefault(same, shape.name)
        if other != shape.name:
            yield f"shapes.{other} and shapes.{shape.name} are the same shape: rounding decides which is seen"
    used = {shape.material for shape in scene.shapes}
    for name in scene.materials:
        if name not in used:
            yield f"materials.{name} is used by no shape"
