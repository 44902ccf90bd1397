"""A radiometric scene as pbrt-v4 reads it: grey ``.pbrt`` files, a program that renders and joins them, a receipt.

pbrt traces spectra. A spectrum that is the same everywhere keeps its number: reflectances and indices as they are,
light as so many of the film's white. So every channel is a grey scene of its own, or all three one where they agree.
What each directive means was read in pbrt's sources, not measured (``docs/bridge.md``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib import resources
from typing import Final, Literal, assert_never

import numpy as np

from symrender.bridge.carried import Carried, Prepared, Rays, prepare
from symrender.bridge.moved import Triple, ball_of, caps_of, cylinder_axes
from symrender.errors import Unsupported
from symrender.scene.mitsuba.flats import corners_of, disk_axes, matrix_of, mesh_indices, mesh_places, said_flat
from symrender.scene.mitsuba.plane import frame_of, said, said_cell
from symrender.scene.radiometric import lights
from symrender.scene.radiometric.materials import (
    Checker,
    Conductor,
    Dielectric,
    Diffuse,
    Marble,
    Material,
    Phong,
    Plastic,
    Solid,
    Stripes,
)
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Box, Cylinder, Disk, Mesh, Plane, Rectangle, Shape, Sphere, Triangle
from symrender.scene.radiometric.textures import Checkerboard, Image

COLORS: Final = ("red", "green", "blue")
SMOOTHEST: Final = 1e-3
"""Roughness below which pbrt takes a conductor for a mirror."""
_ENDLESS: Final = 1_000_000
"""Bounces of a scene with all of them: roulette ends paths long before."""
Channel = Callable[[tuple[float, ...]], str]


def pbrt(
    scene: RadiometricScene,
    *,
    size: int | tuple[int, int] = 256,
    samples: int = 256,
    scale: float = 1.0,
    center: Triple | Literal["middle"] = (0.0, 0.0, 0.0),
    rays: Rays = "box",
    reach: float | None = None,
    calibration: bool = False,
) -> Carried:
    """``scene`` for pbrt-v4: ``scene.pbrt`` if all is grey, else one file a channel; ``run.py``, ``receipt.json``.

    Options as of :func:`symrender.bridge.mitsuba.mitsuba`. Raises Unsupported naming what pbrt cannot state.
    """
    prepared = prepare(
        scene, "pbrt", "sources of pbrt-v4 of 2026-06", size=size, samples=samples, scale=scale, center=center,
        rays=rays, reach=reach,
    )  # fmt: skip
    for name, material in scene.materials.items():
        _refuse(name, material)
    _refuse_backs(scene)
    colored = [
        "\n".join(_document(prepared, samples, lambda color, k=k: repr(float(color[k])))) + "\n"  # type: ignore[misc]
        for k in range(3)
    ]
    grey = colored[0] == colored[1] == colored[2]
    names = ["scene.pbrt"] if grey else [f"scene.{c}.pbrt" for c in COLORS]
    files: dict[str, str | bytes] = dict(zip(names, colored, strict=False))
    if calibration:
        one = lights.Sky(type="sky", name="one", radiance=(1.0, 1.0, 1.0))
        lines = [*_head(prepared, samples), "WorldBegin", *_light(one, lambda color: repr(float(color[0])))]
        files["calibration.pbrt"] = "\n".join(lines) + "\n"
    prepared.receipt["samples"] = samples
    prepared.receipt["files"] = [name for name in files if name.startswith("scene")]
    files["run.py"] = (resources.files("symrender.bridge") / "run_pbrt.txt").read_text("utf-8")
    files["receipt.json"] = prepared.told()
    return Carried(files, prepared.receipt)


def _refuse(name: str, material: Material) -> None:
    """Raise Unsupported where pbrt has no such material."""
    where = f"materials.{name}"
    reflectance = material.reflectance
    if isinstance(material, Phong):
        raise Unsupported(f"{where}: pbrt: has no phong lobe")
    if isinstance(reflectance, Stripes | Marble | Checkerboard | Image):
        raise Unsupported(f"{where}.reflectance: pbrt: has no {reflectance.type}; checker and solid are")
    if isinstance(material, Plastic):
        raise Unsupported(f"{where}: pbrt: has a layer over a diffuse base by random walks, and no plastic as this one")
    if isinstance(material, Diffuse):
        return
    if material.alpha and material.distribution != "ggx":
        raise Unsupported(f"{where}.distribution: pbrt: {material.type}s have ggx, got {material.distribution}")
    if material.alpha and material.masking != "correlated":
        raise Unsupported(f"{where}.masking: pbrt: {material.type}s have masking: correlated, got {material.masking}")
    if 0.0 < material.alpha < SMOOTHEST:
        raise Unsupported(f"{where}.alpha: pbrt: is a mirror below {SMOOTHEST:g}, got {material.alpha:g}")
    if not isinstance(reflectance, Solid) or set(reflectance.color) != {1.0}:
        what = "a conductor with eta and k" if isinstance(material, Conductor) else "a dielectric"
        raise Unsupported(f"{where}.reflectance: pbrt: {what} has no factor; 1 is what it can be")
    if isinstance(material, Dielectric) and set(material.transmittance) != {1.0}:
        raise Unsupported(f"{where}.transmittance: pbrt: a dielectric has no factor; 1 is what it can be")


def _refuse_backs(scene: RadiometricScene) -> None:
    """Raise Unsupported where the eye sees the back of a one-sided surface, which pbrt does not keep black.

    In front of all planes and outside all spheres and boxes no ray meets a back first, nor does what it meets send one
    there. Without bounces it is enough that the eye is in front of flat shapes that end.
    """
    for shape in scene.shapes:
        if isinstance(shape, Mesh) and shape.shading_normals == "use":
            raise Unsupported(f"shapes.{shape.name}.shading_normals: pbrt: use is not written; ignore is")
        if scene.materials[shape.material].two_sided:
            continue
        opened = isinstance(shape, Cylinder) and not shape.caps
        if (opened or isinstance(shape, Rectangle | Triangle | Disk | Mesh)) and scene.bounces != 0:
            raise Unsupported(
                f"shapes.{shape.name}: pbrt: reflects on both sides, and bounced light may reach the back of a "
                f"{shape.type}; give materials.{shape.material} two_sided: true"
            )
        if isinstance(shape, Sphere):
            inside = math.dist(scene.camera.eye, shape.center) < shape.radius
        else:
            inside = _behind(shape, scene.camera.eye)
        if inside:
            raise Unsupported(
                f"shapes.{shape.name}: pbrt: reflects on both sides, and this one is seen from behind; give "
                f"materials.{shape.material} two_sided: true"
            )


def _behind(shape: Plane | Rectangle | Triangle | Disk | Cylinder | Box | Mesh, eye: Triple) -> bool:
    """Whether the eye is behind a flat shape, in a box, or may see a cylinder or a mesh from behind: open or near."""
    place = np.array(eye)
    match shape:
        case Mesh():
            edges = [(face[k], face[(k + 1) % 3]) for face in shape.faces for k in range(3)]
            known = set(edges)
            closed = len(known) == len(edges) and all((b, a) in known for a, b in edges)
            about = ball_of(shape)
            return not closed or about is None or math.dist(eye, about[0]) <= about[1]
        case Plane():
            return sum(n * (e - p) for n, e, p in zip(frame_of(shape)[2], eye, shape.point, strict=True)) < 0.0
        case Triangle():
            a, b, c = (np.array(vertex) for vertex in shape.vertices)
            return bool((place - a) @ np.cross(b - a, c - a) < 0.0)
        case Cylinder():
            axis, way = np.array(shape.axis), place - np.array(shape.base)
            level = float(way @ axis / (axis @ axis))
            within = bool(np.linalg.norm(way - level * axis) < shape.radius)
            return not shape.caps or (within and 0.0 < level < 1.0)
        case Box():
            inside = np.linalg.solve(matrix_of(shape), [*eye, 1.0])[:3]
            return bool((np.abs(inside) < 1.0).all())
    matrix = matrix_of(shape)
    return bool((place - matrix[:3, 3]) @ matrix[:3, 2] < 0.0)


def _finite(shape: Rectangle | Triangle | Disk | Box | Mesh, material: Material) -> list[str]:
    """A shape with flat faces that ends: a disk, or a mesh whose corners go around the normal."""
    if isinstance(shape, Mesh):
        around = " ".join(str(index) for face in shape.faces for index in face)
        flat = [x for place in mesh_places(shape) for x in place]
        shape_line = f'Shape "trianglemesh" "integer indices" [ {around} ]'
        return [f"# shapes.{shape.name}", shape_line, f'  "point3 P" [ {_numbers(flat)} ]']
    lines = [f"# shapes.{shape.name}", f"# {said_flat(shape)}"]
    if isinstance(shape, Disk):
        columns = " ".join(repr(float(x)) for x in disk_axes(shape).T.ravel())
        return [f"ConcatTransform [ {columns} ]", *lines, f'Shape "disk" "float radius" [ {shape.radius!r} ]']
    places = corners_of(shape)
    around = " ".join(str(index) for index in mesh_indices(len(places)))
    flat = [x for place in places for x in place]
    lines += [f'Shape "trianglemesh" "integer indices" [ {around} ]', f'  "point3 P" [ {_numbers(flat)} ]']
    if isinstance(shape, Rectangle) and isinstance(material.reflectance, Checker):
        cell = material.reflectance.cell
        u, v = math.hypot(*shape.edge_u) / cell, math.hypot(*shape.edge_v) / cell
        lines.append(f'  "point2 uv" [ {_numbers([0.0, 0.0, u, 0.0, u, v, 0.0, v])} ]')
    return lines


def _numbers(values: tuple[float, ...] | list[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def _head(prepared: Prepared, samples: int) -> list[str]:
    """Who looks, and how: everything before ``WorldBegin``."""
    scene, (width, height) = prepared.scene, prepared.size
    camera, wide = scene.camera, width / height
    depth = _ENDLESS if scene.bounces == "all" else scene.bounces + 1
    return [
        f"# scene {scene.hash}",
        f'Integrator "path" "integer maxdepth" [ {depth} ]',
        f'Sampler "independent" "integer pixelsamples" [ {samples} ]',
        'PixelFilter "box" "float xradius" [ 0.5 ] "float yradius" [ 0.5 ]',
        f'Film "gbuffer" "integer xresolution" [ {width} ] "integer yresolution" [ {height} ]',
        '  "string filename" "scene.exr" "string sensor" "cie1931" "bool savefp16" false',
        "# pbrt's coordinates are left-handed",
        "Scale -1 1 1",
        f"LookAt {_numbers(camera.eye)}",
        f"  {_numbers(camera.target)}",
        f"  {_numbers(camera.up)}",
        f'Camera "perspective" "float fov" [ {camera.fov!r} ]',
        f'  "float screenwindow" [ {-wide!r} {wide!r} -1 1 ]',
    ]


def _document(prepared: Prepared, samples: int, channel: Channel) -> list[str]:
    scene = prepared.scene
    lines = [*_head(prepared, samples), "WorldBegin"]
    shining = {light.shape: light for light in scene.lights if isinstance(light, lights.Area)}
    for light in scene.lights:
        lines += [] if isinstance(light, lights.Area) else _light(light, channel)
    for shape in scene.shapes:
        lamp = _light(shining[shape.name], channel) if shape.name in shining else []
        for part in (shape, *caps_of(shape)):
            half = prepared.halves.get(shape.name, 0.0)
            lines += _shape(part, scene.materials[shape.material], half, channel, lamp)
    return lines


def _grey(kind: str, name: str, value: str) -> str:
    return f'"{kind} {name}" [ {value} {value} {value} ]'


def _light(light: lights.Light, channel: Channel) -> list[str]:
    match light:
        case lights.Point():
            what = f'"point" {_grey("rgb", "I", channel(light.intensity))} "point3 from" [ {_numbers(light.position)} ]'
        case lights.Spot():
            if light.falloff != "smooth":
                raise Unsupported(f"lights.{light.name}: pbrt's spot falls off smoothly; falloff must be smooth")
            what = f'"spot" {_grey("rgb", "I", channel(light.intensity))} "point3 to" [ {_numbers(light.direction)} ]'
            what += f' "float coneangle" [ {light.cutoff!r} ] "float conedeltaangle" [ {light.cutoff - light.beam!r} ]'
            # moved after it is turned, so that its direction keeps its digits
            there = [f"Translate {_numbers(light.position)}", f"LightSource {what}"]
            return [f"# lights.{light.name}", "AttributeBegin", *(f"  {line}" for line in there), "AttributeEnd"]
        case lights.Directional():
            # what falls on a surface across it is L
            what = f'"distant" {_grey("rgb", "L", channel(light.irradiance))}'
            what += f' "point3 from" [ 0 0 0 ] "point3 to" [ {_numbers(light.direction)} ]'
        case lights.Sky():
            what = f'"infinite" {_grey("rgb", "L", channel(light.radiance))}'
        case lights.Environment():
            raise Unsupported(f"lights.{light.name}: pbrt: an environment is not written; Mitsuba's envmap is")
        case lights.Area():
            # on the outside alone, twosided being false
            return [f"# lights.{light.name}", f'AreaLightSource "diffuse" {_grey("rgb", "L", channel(light.radiance))}']
        case _:
            assert_never(light)
    return [f"# lights.{light.name}", f"LightSource {what}"]


def _shape(shape: Shape, material: Material, half: float, channel: Channel, lamp: list[str]) -> list[str]:
    inner = [*_material(shape, material, channel), *lamp]
    name = f"# shapes.{shape.name}"
    if isinstance(shape, Sphere):
        inner += [f"Translate {_numbers(shape.center)}"]
        if isinstance(material.reflectance, Checker):
            # so that pbrt's azimuth begins where that of a scene does
            inner += ["Rotate 180 0 0 1"]
        inner += [name, f'Shape "sphere" "float radius" [ {shape.radius!r} ]']
    elif isinstance(shape, Cylinder):
        east, north = cylinder_axes(shape)
        if isinstance(material.reflectance, Checker):
            # half a turn, so that pbrt's azimuth begins where that of a scene does
            east, north = (-east[0], -east[1], -east[2]), (-north[0], -north[1], -north[2])
        up, height = tuple(x / math.hypot(*shape.axis) for x in shape.axis), math.hypot(*shape.axis)
        columns = " ".join(
            repr(x) for axis in ((*east, 0.0), (*north, 0.0), (*up, 0.0), (*shape.base, 1.0)) for x in axis
        )
        inner += [f"ConcatTransform [ {columns} ]", name]
        inner += [
            f'Shape "cylinder" "float radius" [ {shape.radius!r} ] "float zmin" [ 0 ] "float zmax" [ {height!r} ]'
        ]
    elif not isinstance(shape, Plane):
        inner += _finite(shape, material)
    else:
        east, north, _ = frame_of(shape)
        cell = material.reflectance.cell if isinstance(material.reflectance, Checker) else half
        corners, places = [], []
        for u, v in ((-half, -half), (half, -half), (half, half), (-half, half)):
            corners += [p + u * e + v * n for p, e, n in zip(shape.point, east, north, strict=True)]
            places += [u / cell, v / cell]
        inner += [
            name,
            f"# {said(shape)}",
            'Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]',
            f'  "point3 P" [ {_numbers(corners)} ]',
            f'  "point2 uv" [ {_numbers(places)} ]',
        ]
    return ["AttributeBegin", *(f"  {line}" for line in inner), "AttributeEnd"]


def _material(shape: Shape, material: Material, channel: Channel) -> list[str]:
    called = f"# materials.{shape.material}"
    if isinstance(material, Conductor):
        # numbers at two wavelengths, and on the line between them
        eta, k = channel(material.eta), channel(material.k)
        return [
            called,
            f'Material "conductor" "spectrum eta" [ 300 {eta} 900 {eta} ] "spectrum k" [ 300 {k} 900 {k} ]',
            f'  "float roughness" [ {material.alpha!r} ] "bool remaproughness" false',
        ]
    if isinstance(material, Dielectric):
        kind = "thindielectric" if material.thin else "dielectric"
        rough = f' "float roughness" [ {material.alpha!r} ] "bool remaproughness" false' if not material.thin else ""
        return [called, f'Material "{kind}" "float eta" [ {material.ior!r} ]{rough}']
    reflectance = material.reflectance
    if not isinstance(reflectance, Checker):
        assert isinstance(reflectance, Solid)
        return [called, f'Material "diffuse" {_grey("rgb", "reflectance", channel(reflectance.color))}']
    name = f"cells of {shape.name}"
    turns = ""
    if isinstance(shape, Cylinder):
        # x = 2 u, y = v
        inverse = 1.0 / reflectance.cell
        turns = f'"float uscale" [ {2.0 * inverse!r} ] "float vscale" [ {inverse!r} ]'
    if isinstance(shape, Sphere):
        # x = 2 u, y = 1 - v
        inverse = 1.0 / reflectance.cell
        turns = f'"float uscale" [ {2.0 * inverse!r} ] "float vscale" [ {-inverse!r} ] "float vdelta" [ {inverse!r} ]'
    return [
        f"# {said_cell(reflectance.cell)}",
        f'Texture "{name}" "spectrum" "checkerboard" {turns}'.rstrip(),
        f"  {_grey('rgb', 'tex1', channel(reflectance.bright))} {_grey('rgb', 'tex2', channel(reflectance.dark))}",
        called,
        f'Material "diffuse" "texture reflectance" "{name}"',
    ]
