"""A radiometric scene at another scale and about another origin, and how far squares stand for its planes."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.errors import OptionError, Unsupported
from symrender.runtimes.glimpse import plane_apart
from symrender.scene.load import load_any
from symrender.scene.mitsuba.flats import AGREE
from symrender.scene.mitsuba.plane import frame_of
from symrender.scene.pictures import picture
from symrender.scene.radiometric import lights
from symrender.scene.radiometric.materials import Checker, Diffuse, Marble, Material, Stripes
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Box, Cylinder, Disk, Mesh, Plane, Rectangle, Shape, Sphere, Triangle
from symrender.scene.radiometric.textures import Checkerboard, Image

Triple = tuple[float, float, float]

FAR_REACH: Final = 100.0
"""Half a side of the square that stands for a plane, over the distance to what is farthest of the scene, where bounced
light or a sky reaches the scene from afar.

Single precision knows a place in a square to 6e-8 of its side, so a larger square is a worse place.
"""
_ROOM: Final = 1.05
"""A square over what it must hold."""
_FARTHEST: Final = 1000.0
"""Most half sides over the distance to what is farthest: places are then rounded as far as Mitsuba offsets its rays.

A view to the horizon sees a plane further, so audits set aside what is beyond (``squares`` of the receipt)."""
_SLANT: Final = 1e-4
"""Sine of the angle to a plane below which a directional light crosses it too far away."""


def moved(scene: RadiometricScene, scale: float, center: Triple) -> RadiometricScene:
    """``scene`` with every place p at ``scale`` (p - ``center``), and the same radiance along every ray.

    Lengths become ``scale`` times as long, so intensities of point lights become ``scale`` squared times as large;
    irradiances and radiances stay. Raises Unsupported where one textured material is on a plane, whose cells are
    lengths, and on a sphere, whose cells are angles.
    """
    if not (math.isfinite(scale) and 1e-9 <= scale <= 1e9):
        raise OptionError(f"scale: must be from 1e-9 to 1e9, got {scale!r}")
    if scale == 1.0 and center == (0.0, 0.0, 0.0):
        return scene

    def place(p: Triple) -> list[float]:
        return [scale * (x - c) for x, c in zip(p, center, strict=True)]

    data: dict[str, Any] = scene.model_dump(mode="python")
    for key in ("eye", "target"):
        data["camera"][key] = place(data["camera"][key])

    def way(v: Triple) -> list[float]:
        return [scale * x for x in v]

    on_spheres = {shape.material for shape in scene.shapes if isinstance(shape, Sphere | Cylinder)}
    for shape, row in zip(scene.shapes, data["shapes"], strict=True):
        if isinstance(shape, Sphere):
            row["center"], row["radius"] = place(shape.center), scale * shape.radius
            continue
        if isinstance(shape, Cylinder):
            row["base"], row["axis"], row["radius"] = place(shape.base), way(shape.axis), scale * shape.radius
            continue
        match shape:
            case Plane():
                row["point"] = place(shape.point)
            case Rectangle():
                row["corner"], row["edge_u"], row["edge_v"] = place(shape.corner), way(shape.edge_u), way(shape.edge_v)
            case Triangle():
                row["vertices"] = [place(v) for v in shape.vertices]
            case Disk():
                row["center"], row["radius"] = place(shape.center), scale * shape.radius
            case Box():
                row["center"], row["size"] = place(shape.center), way(shape.size)
            case Mesh():
                row["position"], row["scale"] = place(shape.position), scale * shape.scale
        reflectance = data["materials"][shape.material]
        reflectance = reflectance["diffuse" if "diffuse" in reflectance else "reflectance"]
        if "cell" in reflectance and scale != 1.0:
            if shape.material in on_spheres:
                raise Unsupported(
                    f"materials.{shape.material}: its cells are lengths on {shape.name} and angles on a sphere, so it "
                    "cannot be scaled; give them materials of their own"
                )
            reflectance["cell"] = scale * getattr(scene.materials[shape.material].reflectance, "cell")  # noqa: B009
    for light, row in zip(scene.lights, data["lights"], strict=True):
        if isinstance(light, lights.Point | lights.Spot):
            row["position"] = place(light.position)
            row["intensity"] = [scale**2 * x for x in light.intensity]
    result = load_any(data)
    assert isinstance(result, RadiometricScene)
    return result


def middle(scene: RadiometricScene) -> Triple:
    """The middle of the box about spheres that hold the shapes, or where the camera looks where all are endless."""
    balls = [ball for shape in scene.shapes if (ball := ball_of(shape)) is not None]
    if not balls:
        return scene.camera.target
    low = [min(center[k] - radius for center, radius in balls) for k in range(3)]
    high = [max(center[k] + radius for center, radius in balls) for k in range(3)]
    x, y, z = (0.5 * (a + b) for a, b in zip(low, high, strict=True))
    return (x, y, z)


def ball_of(shape: Shape) -> tuple[Triple, float] | None:
    """Centre and radius of a sphere that holds a shape; None of a plane, which none holds."""
    match shape:
        case Plane():
            return None
        case Sphere() | Disk():
            return shape.center, shape.radius
        case Box():
            return shape.center, 0.5 * math.hypot(*shape.size)
        case Cylinder():
            x, y, z = (b + 0.5 * a for b, a in zip(shape.base, shape.axis, strict=True))
            return (x, y, z), math.hypot(0.5 * math.hypot(*shape.axis), shape.radius)
        case Rectangle():
            u, v = shape.edge_u, shape.edge_v
            x, y, z = (p + 0.5 * (a + b) for p, a, b in zip(shape.corner, u, v, strict=True))
            across = [math.hypot(*(a + side * b for a, b in zip(u, v, strict=True))) for side in (1.0, -1.0)]
            return (x, y, z), 0.5 * max(across)
        case Triangle():
            x, y, z = (sum(p) / 3.0 for p in zip(*shape.vertices, strict=True))
            return (x, y, z), max(math.dist((x, y, z), v) for v in shape.vertices)
        case Mesh():
            # a turn about z leaves distances from the position as they are
            far = max(math.hypot(*vertex) for vertex in shape.vertices)
            return shape.position, shape.scale * far


def cylinder_axes(shape: Cylinder) -> tuple[Triple, Triple]:
    """Unit vectors across the axis of a cylinder, the first towards ``along``, right-handed with the axis."""
    axis = np.array(shape.axis) / math.hypot(*shape.axis)
    east = np.array(shape.along) - (axis @ np.array(shape.along)) * axis
    east /= np.linalg.norm(east)
    first, second = east.tolist(), np.cross(axis, east).tolist()
    return (first[0], first[1], first[2]), (second[0], second[1], second[2])


def takes_checker(shape: Shape) -> bool:
    """Whether other renderers have the coordinates of the shape's texture."""
    match shape:
        case Rectangle():
            along = sum(a * b for a, b in zip(shape.edge_u, shape.edge_v, strict=True))
            return abs(along) <= AGREE * math.hypot(*shape.edge_u) * math.hypot(*shape.edge_v)
        case Cylinder():
            return not shape.caps
    return isinstance(shape, Plane | Sphere)


def caps_of(shape: Shape) -> tuple[Disk, ...]:
    """The disks that close a cylinder, as shapes of their own."""
    if not isinstance(shape, Cylinder) or not shape.caps:
        return ()
    x, y, z = (b + a for b, a in zip(shape.base, shape.axis, strict=True))
    back = (-shape.axis[0], -shape.axis[1], -shape.axis[2])
    return tuple(
        Disk(name=f"{shape.name}-{end}", center=center, normal=normal, radius=shape.radius, along=shape.along,
             material=shape.material)
        for end, center, normal in (("base", shape.base, back), ("top", (x, y, z), shape.axis))
    )  # fmt: skip


def extent(scene: RadiometricScene, about: Triple) -> float:
    """Distance from a place to what is farthest of eye, target, shapes that end and point lights."""
    far = [math.dist(about, scene.camera.eye), math.dist(about, scene.camera.target)]
    balls = (ball_of(shape) for shape in scene.shapes)
    far += [math.dist(about, ball[0]) + ball[1] for ball in balls if ball is not None]
    far += [math.dist(about, light.position) for light in scene.lights if isinstance(light, lights.Point | lights.Spot)]
    return max(far)


def half_side(scene: RadiometricScene, plane: Plane, reach: float | None, seen: float) -> float:
    """Half a side of the square about ``plane.point`` that stands for the plane; whole pairs of cells of a checker.

    It is ``reach`` times the distance to what is farthest, or where that is None as far as the plane is ``seen``, as
    places and lights are apart, and as a sky and bounced light need; more where the sun casts the plane's shadow
    further.
    """
    within = extent(scene, plane.point)
    reflectance = scene.materials[plane.material].reflectance
    far = scene.bounces != 0 or any(isinstance(light, lights.Sky | lights.Environment) for light in scene.lights)
    needed = within * reach if reach else max(FAR_REACH * within if far else 0.0, _ROOM * max(within, seen))
    needed = needed if reach else min(needed, _FARTHEST * within)
    size = math.hypot(*plane.normal)
    side = sum(n * (e - p) for n, e, p in zip(plane.normal, scene.camera.eye, plane.point, strict=True))
    for light in scene.lights:
        if isinstance(light, lights.Directional):
            cross = sum(a * b for a, b in zip(plane.normal, light.direction, strict=True))
            slant = abs(cross) / size / math.hypot(*light.direction)
            if 0.0 < slant < _SLANT:
                raise Unsupported(
                    f"lights.{light.name}: almost parallel to shapes.{plane.name}, whose shadow falls beyond any square"
                )
            # from the eye's own side its light crosses the plane nowhere before what is seen
            if reach is not None or cross * side > 0.0:
                needed = max(needed, within * (1.0 + 2.0 / slant) if slant else 0.0)
    if isinstance(reflectance, Checker):
        period = 2.0 * reflectance.cell
        return period * math.ceil(needed / period)
    return needed


def seen_out_to(scene: RadiometricScene, plane: Plane, size: tuple[int, int], centre: bool) -> float:
    """Largest coordinate about ``plane.point`` of the places where an image would see the plane alone."""
    apart = plane_apart(scene, plane, size, centre)
    return float(np.max(apart, where=np.isfinite(apart), initial=0.0))


def lost(scene: RadiometricScene, plane: Plane, half: float) -> float | None:
    """Most radiance by which a place within ``extent`` of ``plane.point`` differs for a square in the plane's place.

    What lies beyond the square is seen at most an angle a = d/(H - e) below the horizon; e is that distance, H =
    ``half`` half a side, and d how far shapes rise above the plane, or e where there are other planes. An upright place
    gets 2 a of its radiance from there, the most of all places, and the plane itself nothing. Through it enters or is
    missing the sky, and at one bounce the light the plane sends back. None where that is not bounded: more bounces, or
    surfaces that are not diffuse.
    """
    sky = max((max(x.radiance) for x in scene.lights if isinstance(x, lights.Sky)), default=0.0)
    maps = (x for x in scene.lights if isinstance(x, lights.Environment))
    sky = max([sky, *(max(x.scale) * float(picture(x.data)[0].max()) for x in maps)])
    if scene.bounces == 0 and sky == 0.0:
        return 0.0
    used = [scene.materials[shape.material] for shape in scene.shapes]
    if scene.bounces == "all" or not all(isinstance(material, Diffuse) for material in used):
        return None
    within = extent(scene, plane.point)
    share = 2.0 * _rises(scene, plane) / (half - within)
    arrives = sum(max(x.irradiance) for x in scene.lights if isinstance(x, lights.Directional))
    arrives += (
        sum(max(x.intensity) for x in scene.lights if isinstance(x, lights.Point | lights.Spot)) / (half - within) ** 2
    )
    sent = _brightest(scene.materials[plane.material]) / math.pi * (arrives + math.pi * sky)
    seen = sky + (sent if scene.bounces == 1 else 0.0)
    return max(map(_brightest, used)) / math.pi * share * seen


def _rises(scene: RadiometricScene, plane: Plane) -> float:
    """How far shapes are from a plane; of other planes no more than what is farthest in the scene counts."""
    up, rises = frame_of(plane)[2], 0.0
    for shape in scene.shapes:
        ball = ball_of(shape)
        if ball is not None:
            height = sum(n * (c - p) for n, c, p in zip(up, ball[0], plane.point, strict=True))
            rises = max(rises, abs(height) + ball[1])
        elif shape.name != plane.name:
            return extent(scene, plane.point)
    return rises


def _brightest(material: Material) -> float:
    reflectance = material.reflectance
    if isinstance(reflectance, Image):
        return 1.0
    if isinstance(reflectance, Checker | Stripes | Marble | Checkerboard):
        return max(*reflectance.bright, *reflectance.dark)
    return max(reflectance.color)
