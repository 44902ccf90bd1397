"""What is odd about a scene that is nevertheless valid."""

from __future__ import annotations

import math
from collections.abc import Iterator

from symrender.scene.load import AnyScene
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.warnings import radiometric_warnings
from symrender.scene.scene import Scene
from symrender.scene.shape import Plane, Sphere

_Point = tuple[float, float, float]


def _holding(point: _Point, spheres: tuple[Sphere, ...]) -> Iterator[str]:
    for sphere in spheres:
        if math.dist(point, sphere.center) < sphere.radius:
            yield f"spheres.{sphere.name}"


def _height(plane: Plane, point: _Point) -> float:
    """Distance of a point from a plane, negative behind it."""
    long = max(map(abs, plane.normal))
    normal = [n / long for n in plane.normal]
    size = math.hypot(*normal)
    return sum(n / size * (p - q) for n, p, q in zip(normal, point, plane.point, strict=True))


def _camera(scene: Scene) -> Iterator[str]:
    for name in _holding(scene.camera.eye, scene.spheres):
        yield f"camera.eye is inside {name}: its far side is seen, from within"
    height = scene.camera.eye[2]
    if scene.floor is not None and height < 0:
        yield "camera.eye is below the floor, which is black from below"
    elif scene.floor is not None and height == 0:
        yield "camera.eye lies on the floor plane: the floor cannot be seen"
    for plane in scene.planes:
        over = _height(plane, scene.camera.eye)
        if over < 0:
            yield f"camera.eye is behind planes.{plane.name}, which is black from behind and hides what is beyond it"
        elif over == 0:
            yield f"camera.eye lies in planes.{plane.name}: the plane cannot be seen"


def _lights(scene: Scene) -> Iterator[str]:
    if not scene.lights:
        yield "there are no lights: only ambient and background are seen"
    elif all(max(light.color) == 0 for light in scene.lights):
        yield "all lights are black: only ambient and background are seen"
    for light in scene.lights:
        for name in _holding(light.position, scene.spheres):
            yield f"lights.{light.name} is inside {name}: nothing outside is lit by it"
        if scene.floor is not None and light.position[2] < 0:
            yield f"lights.{light.name} is below the floor: the floor is not lit by it"
        for plane in scene.planes:
            over = _height(plane, light.position)
            if over < 0:
                yield f"lights.{light.name} is behind planes.{plane.name}: nothing in front of the plane is lit by it"
            elif over == 0:
                yield f"lights.{light.name} lies in planes.{plane.name}: the plane is not lit by it"


def _shapes(scene: Scene) -> Iterator[str]:
    if not scene.spheres and scene.floor is None and not scene.planes:
        yield "there is nothing to see: no spheres, no floor and no planes"
    first: dict[tuple[_Point, float], str] = {}
    for sphere in scene.spheres:
        other = first.setdefault((sphere.center, sphere.radius), sphere.name)
        if other != sphere.name:
            yield f"spheres.{other} and spheres.{sphere.name} are the same sphere: the first is seen"
        if scene.floor is not None and sphere.center[2] + sphere.radius <= 0:
            yield f"spheres.{sphere.name} lies below the floor: it cannot be seen from above"
        for plane in scene.planes:
            if _height(plane, sphere.center) + sphere.radius <= 0:
                yield f"spheres.{sphere.name} lies behind planes.{plane.name}: it cannot be seen from in front"
    yield from _undecided(scene)
    surfaces = [(f"spheres.{sphere.name}", sphere.lobe) for sphere in scene.spheres]
    surfaces += [(f"planes.{plane.name}", plane.lobe) for plane in scene.planes]
    for name, lobe in [*surfaces, ("floor", scene.floor.lobe if scene.floor else None)]:
        if lobe is not None and lobe.weight == 0:
            yield f"{name}.lobe.weight is 0: the lobe has no effect"


def _undecided(scene: Scene) -> Iterator[str]:
    from symrender.scene.undecided import undecided  # needs NumPy, which loading does not

    if words := undecided(scene):
        yield words


def warnings(scene: AnyScene) -> tuple[str, ...]:
    """One line for each oddity of ``scene``, naming its part: camera, lights, shapes, in this order."""
    if isinstance(scene, RadiometricScene):
        return radiometric_warnings(scene)
    return (*_camera(scene), *_lights(scene), *_shapes(scene))
