"""A radiometric scene as Mitsuba 3 reads it: ``scene.xml``, a program that renders it, and a receipt.

What Mitsuba means by each plugin was checked against its version 3.9.1 along single rays (``docs/bridge.md``).

The file is long because every shape, material, texture and light has its few lines here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib import resources
from typing import Final, Literal, assert_never

import numpy as np

from symrender.bridge.carried import Carried, Rays, prepare
from symrender.bridge.moved import Triple, ball_of, caps_of, cylinder_axes, extent
from symrender.errors import Unsupported
from symrender.images.texels import suffix_of
from symrender.scene.mitsuba.flats import matrix_of, mesh_places, said_flat
from symrender.scene.mitsuba.plane import frame_of, said, said_cell, square
from symrender.scene.pictures import content, digest
from symrender.scene.radiometric import lights
from symrender.scene.radiometric.detail import of_vertices, turned
from symrender.scene.radiometric.materials import (
    Checker,
    Conductor,
    Dielectric,
    Diffuse,
    Marble,
    Material,
    Phong,
    Plastic,
    Stripes,
)
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Box, Cylinder, Disk, Mesh, Plane, Rectangle, Shape, Sphere, Triangle
from symrender.scene.radiometric.textures import Checkerboard, Image

_FACET: Final = "Mitsuba's rough materials have"
_CLIP: Final = 0.01
"""Near clipping distance over the distance from the eye to the nearest surface."""


def mitsuba(
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
    """``scene`` for Mitsuba 3: ``scene.xml``, ``run.py``, ``receipt.json``, and ``calibration.xml`` where asked.

    Places p become ``scale`` (p - ``center``), ``middle`` being that of the spheres; radiance stays as it is
    (:func:`symrender.bridge.moved.moved`). ``rays``: through pixels at random, whose mean is a box filter, or through
    their centres, as truth has them. ``reach``: half a side of the square that stands for a plane, over the distance
    to what is farthest of the scene; None: as far as it is needed (:func:`symrender.bridge.moved.half_side`).
    Raises Unsupported naming what Mitsuba cannot state.
    """
    prepared = prepare(
        scene, "mitsuba", "3.9.1", size=size, samples=samples, scale=scale, center=center, rays=rays, reach=reach
    )
    for name, material in scene.materials.items():
        _refuse(name, material)
    there, halves = prepared.scene, prepared.halves
    width, height = prepared.size
    sensor = _sensor(there, width, height, samples, halves)
    used = {shape.material for shape in there.shapes}
    body: list[str] = []
    for name, material in there.materials.items():
        if name not in used or not isinstance(material.reflectance, Checker):
            body += _material(material, f' id="material-{name}"', None)
    meshes: dict[str, str | bytes] = {}
    shining = {light.shape: light for light in there.lights if isinstance(light, lights.Area)}
    for shape in there.shapes:
        if isinstance(shape, Triangle):
            meshes[f"{shape.name}.ply"] = _ply(shape.vertices, [(0, 1, 2)])
        if isinstance(shape, Mesh):
            meshes[f"{shape.name}.ply"] = _mesh(shape)
        for part in (shape, *caps_of(shape)):
            area = shining.get(shape.name)
            lamp = [] if area is None else _emitter(area, area.name if part is shape else part.name)
            body += _shape(part, there.materials[shape.material], halves.get(shape.name, 0.0), lamp)
    for light in there.lights:
        body += [] if isinstance(light, lights.Area) else _emitter(light)
    pictured = [there.materials[name].reflectance for name in used]
    for held in (*pictured, *there.lights):
        if isinstance(held, Image | lights.Environment):
            meshes[_file_of(held)] = content(held.data)
    files = meshes | {
        "scene.xml": _document([*_integrator(scene), *sensor, *body]),
        "run.py": (resources.files("symrender.bridge") / "run_mitsuba.txt").read_text("utf-8"),
        "receipt.json": prepared.told(),
    }
    if calibration:
        one = _emitter(lights.Sky(type="sky", name="one", radiance=(1.0, 1.0, 1.0)))
        files["calibration.xml"] = _document([*_integrator(scene), *sensor, *one])
    return Carried(files, prepared.receipt)


def _refuse(name: str, material: Material) -> None:
    """Raise Unsupported where Mitsuba has no such material."""
    where = f"materials.{name}"
    if isinstance(material, Phong):
        raise Unsupported(f"{where}: mitsuba: has no phong lobe whose normalisation is this one")
    if isinstance(material.reflectance, Stripes | Marble):
        raise Unsupported(f"{where}.reflectance: mitsuba: has no {material.reflectance.type}; checker and solid are")
    if isinstance(material, Diffuse) or not material.alpha:
        return
    if material.masking != "separable":
        raise Unsupported(f"{where}.masking: mitsuba: {_FACET} masking: separable, got {material.masking}")
    if material.distribution == "beckmann" and material.g1 != "walter":
        raise Unsupported(f"{where}.g1: mitsuba: {_FACET} g1: walter with beckmann, got {material.g1}")


def _numbers(values: tuple[float, ...]) -> str:
    return ", ".join(repr(float(x)) for x in values)


def _rgb(name: str, color: tuple[float, ...]) -> str:
    return f'<rgb name="{name}" value="{_numbers(color)}"/>'


def _nested(head: str, inner: list[str], tag: str) -> list[str]:
    return [f"<{head}>", *(f"  {line}" for line in inner), f"</{tag}>"]


def _document(lines: list[str]) -> str:
    return "\n".join(_nested('scene version="3.0.0"', lines, "scene")) + "\n"


def _integrator(scene: RadiometricScene) -> list[str]:
    depth = -1 if scene.bounces == "all" else scene.bounces + 2
    return _nested('integrator type="path"', [f'<integer name="max_depth" value="{depth}"/>'], "integrator")


def _sensor(scene: RadiometricScene, width: int, height: int, samples: int, halves: dict[str, float]) -> list[str]:
    camera = scene.camera
    near, far = math.inf, 2.0 * extent(scene, camera.eye)
    for shape in scene.shapes:
        if isinstance(shape, Sphere):
            near = min(near, abs(math.dist(camera.eye, shape.center) - shape.radius))
            continue
        if not isinstance(shape, Plane):
            near = min(near, _apart(shape, camera.eye))
            continue
        up = frame_of(shape)[2]
        near = min(near, abs(sum(n * (e - p) for n, e, p in zip(up, camera.eye, shape.point, strict=True))))
        far = max(far, math.dist(camera.eye, shape.point) + 2.0 * halves[shape.name])
    clip = _CLIP * near if 0.0 < near < math.inf else 1e-9 * far
    inner = [
        '<string name="fov_axis" value="y"/>',
        f'<float name="fov" value="{camera.fov!r}"/>',
        f'<float name="near_clip" value="{clip!r}"/>',
        f'<float name="far_clip" value="{2.0 * far!r}"/>',
        *_nested(
            'transform name="to_world"',
            [
                f'<lookat origin="{_numbers(camera.eye)}" target="{_numbers(camera.target)}" '
                f'up="{_numbers(camera.up)}"/>'
            ],
            "transform",
        ),
        *_nested(
            'film type="hdrfilm"',
            [
                f'<integer name="width" value="{width}"/>',
                f'<integer name="height" value="{height}"/>',
                '<string name="pixel_format" value="rgb"/>',
                '<string name="component_format" value="float32"/>',
                '<rfilter type="box"/>',
            ],
            "film",
        ),
        *_nested('sampler type="independent"', [f'<integer name="sample_count" value="{samples}"/>'], "sampler"),
    ]
    return _nested('sensor type="perspective"', inner, "sensor")


def _material(material: Material, identity: str, to_uv: tuple[float, float] | None) -> list[str]:
    wrapped = material.two_sided and not isinstance(material, Dielectric)
    outer = identity if not wrapped else ""
    names: dict[type, str] = {Diffuse: "reflectance", Plastic: "diffuse_reflectance"}
    reflectance = _reflectance(names.get(type(material), "specular_reflectance"), material, to_uv)
    match material:
        case Diffuse():
            kind, lines = "diffuse", reflectance
        case Conductor():
            lines = [*_facets(material), _rgb("eta", material.eta), _rgb("k", material.k), *reflectance]
            kind = "roughconductor" if material.alpha else "conductor"
        case Dielectric():
            lines = [*_facets(material), *_indices(material.ior), *reflectance]
            lines += [_rgb("specular_transmittance", material.transmittance)]
            kind = "thindielectric" if material.thin else "roughdielectric" if material.alpha else "dielectric"
        case Plastic():
            lines = [*_facets(material), *_indices(material.ior), *reflectance]
            lines += [_rgb("specular_reflectance", material.specular)]
            lines += [f'<boolean name="nonlinear" value="{str(material.nonlinear).lower()}"/>']
            kind = "roughplastic" if material.alpha else "plastic"
        case Phong():
            raise AssertionError("refused before")
        case _:
            assert_never(material)
    inner = _nested(f'bsdf type="{kind}"{outer}', lines, "bsdf")
    return _nested(f'bsdf type="twosided"{identity}', inner, "bsdf") if wrapped else inner


def _indices(ior: float) -> list[str]:
    return [f'<float name="int_ior" value="{ior!r}"/>', '<float name="ext_ior" value="1.0"/>']


def _facets(material: Conductor | Dielectric | Plastic) -> list[str]:
    """The roughness of a material, nothing of a smooth one."""
    if not material.alpha:
        return []
    return [
        f'<string name="distribution" value="{material.distribution}"/>',
        f'<float name="alpha" value="{material.alpha!r}"/>',
    ]


def _reflectance(name: str, material: Material, to_uv: tuple[float, float] | None) -> list[str]:
    reflectance = material.reflectance
    if isinstance(reflectance, Image):
        return _nested(f'texture type="bitmap" name="{name}"', [
            f'<string name="filename" value="{_file_of(reflectance)}"/>',
            f'<boolean name="raw" value="{str(reflectance.encoding == "raw").lower()}"/>',
            f'<string name="filter_type" value="{reflectance.filter}"/>',
            f'<string name="wrap_mode" value="{reflectance.wrap}"/>',
            '<string name="format" value="variant"/>',
            *_to_uv(reflectance),
        ], "texture")  # fmt: skip
    if isinstance(reflectance, Checkerboard):
        inner = [_rgb("color0", reflectance.bright), _rgb("color1", reflectance.dark), *_to_uv(reflectance)]
        return _nested(f'texture type="checkerboard" name="{name}"', inner, "texture")
    if not isinstance(reflectance, Checker):
        assert not isinstance(reflectance, Stripes | Marble)
        return [_rgb(name, reflectance.color)]
    u, v = to_uv or _turns(reflectance)
    inner = [
        f"<!-- {said_cell(reflectance.cell)} -->",
        _rgb("color0", reflectance.bright),
        _rgb("color1", reflectance.dark),
        *_nested('transform name="to_uv"', [f'<scale x="{u!r}" y="{v!r}" z="1.0"/>'], "transform"),
    ]
    return _nested(f'texture type="checkerboard" name="{name}"', inner, "texture")


def _to_uv(texture: Image | Checkerboard) -> list[str]:
    """The transform of (u, v), turned, multiplied and moved in this order."""
    (p, q), (x, y) = texture.scale, texture.offset
    steps = [
        f'<rotate x="0" y="0" z="1" angle="{texture.rotation!r}"/>',
        f'<scale x="{p!r}" y="{q!r}" z="1.0"/>',
        f'<translate x="{x!r}" y="{y!r}" z="0.0"/>',
    ]
    return _nested('transform name="to_uv"', steps, "transform")


def _file_of(part: Image | lights.Environment) -> str:
    """What an image file is called, by its content."""
    return f"image-{digest(part.data)[:12]}{suffix_of(content(part.data))}"


def _turns(checker: Checker) -> tuple[float, float]:
    """Scale of (u, v) for a checker on what is turned by half a turn about its axis, where x = 2 u and y = v."""
    return 1.0 / checker.cell, 0.5 / checker.cell


def _apart(shape: Shape, eye: Triple) -> float:
    """No more than the distance from the eye to a shape that ends; not positive where that is not known."""
    ball = ball_of(shape)
    assert ball is not None
    apart = math.dist(eye, ball[0]) - ball[1]
    if isinstance(shape, Rectangle | Disk):
        matrix = matrix_of(shape)
        apart = max(apart, abs(float((np.array(eye) - matrix[:3, 3]) @ matrix[:3, 2])))
    return apart


def _ply(vertices: Sequence[Triple], faces: Sequence[tuple[int, int, int]]) -> str:
    """A mesh; Mitsuba's files of scenes hold none."""
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property float {axis}" for axis in "xyz")]
    rows = [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    rows += [" ".join(map(str, (3, *face))) for face in faces]
    listed = [f"element face {len(faces)}", "property list uchar int vertex_index", "end_header"]
    return "\n".join([*head, *listed, *rows, ""])


def _mesh(shape: Mesh) -> str:
    """A mesh, each face with vertices of its own where these have coordinates or normals."""
    places = mesh_places(shape)
    smooth = shape.shading_normals == "use"
    if not smooth and not shape.uv:
        return _ply(places, shape.faces)
    coordinates, normals = of_vertices([shape], len(shape.faces))
    turn = math.radians(shape.rotation)
    c, s = math.cos(turn), math.sin(turn)
    columns = [np.array(places)[np.array(shape.faces)].reshape(-1, 3)]
    names = ["x", "y", "z"]
    if shape.uv:
        columns, names = [*columns, coordinates.reshape(-1, 2)], [*names, "s", "t"]
    if smooth:
        turned = normals.reshape(-1, 3) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        # Mitsuba takes them to be of length 1
        columns.append(turned / np.linalg.norm(turned, axis=1, keepdims=True))
        names += ["nx", "ny", "nz"]
    rows = np.concatenate(columns, axis=1)
    head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *(f"property float {name}" for name in names)]
    lines = [" ".join(map(repr, row)) for row in rows.tolist()]
    lines += [f"3 {k} {k + 1} {k + 2}" for k in range(0, len(rows), 3)]
    listed = [f"element face {len(shape.faces)}", "property list uchar int vertex_index", "end_header"]
    return "\n".join([*head, *listed, *lines, ""])


def _finite(shape: Rectangle | Disk | Box | Triangle | Mesh) -> tuple[str, list[str]]:
    """Kind and properties of a shape with flat faces that ends."""
    flat = str(not isinstance(shape, Mesh) or shape.shading_normals == "ignore").lower()
    lines = [f'<string name="filename" value="{shape.name}.ply"/>', f'<boolean name="face_normals" value="{flat}"/>']
    if isinstance(shape, Mesh):
        return "ply", lines
    inner = [f"<!-- {said_flat(shape)} -->"]
    if isinstance(shape, Triangle):
        return "ply", inner + lines
    matrix = " ".join(repr(float(x)) for x in matrix_of(shape).ravel())
    kind = "cube" if isinstance(shape, Box) else shape.type
    return kind, inner + _nested('transform name="to_world"', [f'<matrix value="{matrix}"/>'], "transform")


def _shape(shape: Shape, material: Material, half: float, lamp: list[str]) -> list[str]:
    checker = material.reflectance if isinstance(material.reflectance, Checker) else None
    own = f' id="material-{shape.material}:{shape.name}"'
    if isinstance(shape, Plane):
        if isinstance(material.reflectance, Image | Checkerboard):
            raise Unsupported(
                f"shapes.{shape.name}: mitsuba: has no planes, and {material.reflectance.type} on the square in its "
                "place has other (u, v); a rectangle is written"
            )
        matrix = " ".join(repr(x) for x in square(shape, half))
        # the point is a corner of four cells, for half a side is a whole number of pairs of them
        scales = (half / checker.cell, half / checker.cell) if checker else None
        inner = [
            f"<!-- {said(shape)} -->",
            *_nested('transform name="to_world"', [f'<matrix value="{matrix}"/>'], "transform"),
        ]
        kind = "rectangle"
    elif isinstance(shape, Cylinder):
        # half a turn, so that Mitsuba's azimuth begins where that of a scene does
        east, north = (tuple(-shape.radius * x for x in axis) for axis in cylinder_axes(shape))
        rows = zip(east, north, shape.axis, shape.base, strict=True)
        matrix = " ".join(repr(float(x)) for row in (*rows, (0.0, 0.0, 0.0, 1.0)) for x in row)
        inner = _nested('transform name="to_world"', [f'<matrix value="{matrix}"/>'], "transform")
        scales, kind = None, "cylinder"
    elif not isinstance(shape, Sphere):
        kind, inner = _finite(shape)
        scales = None
        if checker and isinstance(shape, Rectangle):
            scales = (0.5 * math.hypot(*shape.edge_u) / checker.cell, 0.5 * math.hypot(*shape.edge_v) / checker.cell)
    else:
        scales, kind = None, "sphere"
        x, y, z = shape.center
        r = shape.radius
        inner = [f'<point name="center" value="{_numbers(shape.center)}"/>', f'<float name="radius" value="{r!r}"/>']
        if checker:
            # half a turn, so that Mitsuba's azimuth begins where that of a scene does
            turned = " ".join(repr(v) for v in (-r, 0.0, 0.0, x, 0.0, -r, 0.0, y, 0.0, 0.0, r, z, 0.0, 0.0, 0.0, 1.0))
            inner = _nested('transform name="to_world"', [f'<matrix value="{turned}"/>'], "transform")
    surface = _material(material, own, scales) if checker else [f'<ref id="material-{shape.material}"/>']
    return _nested(f'shape type="{kind}" id="shape-{shape.name}"', [*inner, *surface, *lamp], "shape")


def _spot(light: lights.Spot) -> list[str]:
    """Turned about the origin and then moved, so that its direction keeps its digits."""
    if light.falloff != "linear":
        raise Unsupported(
            f"lights.{light.name}: Mitsuba's spot falls off linearly in the angle; falloff must be linear"
        )
    x, y, z = (repr(v) for v in light.position)
    up = "0, 0, 1" if abs(light.direction[2]) < max(abs(v) for v in light.direction[:2]) else "0, 1, 0"
    turned = f'<lookat origin="0, 0, 0" target="{_numbers(light.direction)}" up="{up}"/>'
    return [
        *_nested('transform name="to_world"', [turned, f'<translate x="{x}" y="{y}" z="{z}"/>'], "transform"),
        _rgb("intensity", light.intensity),
        f'<float name="cutoff_angle" value="{light.cutoff!r}"/>',
        f'<float name="beam_width" value="{light.beam!r}"/>',
    ]


def _environment(light: lights.Environment) -> list[str]:
    where = f"lights.{light.name}"
    if (light.layout, light.rows, light.filter) != ("latlong", "corners", "bilinear"):
        raise Unsupported(f"{where}: Mitsuba's envmap has layout: latlong, rows: corners and filter: bilinear")
    if len(set(light.scale)) > 1:
        raise Unsupported(f"{where}.scale: Mitsuba's envmap has one factor of all channels, got {list(light.scale)}")
    matrix = np.eye(4)
    # Mitsuba's maps have y up, and their azimuth begins at -z
    matrix[:3, :3] = turned(light) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    rows = " ".join(repr(float(x)) for x in matrix.ravel())
    return [
        f'<string name="filename" value="{_file_of(light)}"/>',
        f'<float name="scale" value="{light.scale[0]!r}"/>',
        *_nested('transform name="to_world"', [f'<matrix value="{rows}"/>'], "transform"),
    ]


def _emitter(light: lights.Light, name: str = "") -> list[str]:
    match light:
        case lights.Point():
            kind = "point"
            inner = [f'<point name="position" value="{_numbers(light.position)}"/>', _rgb("intensity", light.intensity)]
        case lights.Spot():
            kind, inner = "spot", _spot(light)
        case lights.Directional():
            kind = "directional"
            inner = [
                f'<vector name="direction" value="{_numbers(light.direction)}"/>',
                _rgb("irradiance", light.irradiance),
            ]
        case lights.Sky():
            kind, inner = "constant", [_rgb("radiance", light.radiance)]
        case lights.Environment():
            kind, inner = "envmap", _environment(light)
        case lights.Area():
            kind, inner = "area", [_rgb("radiance", light.radiance)]
        case _:
            assert_never(light)
    return _nested(f'emitter type="{kind}" id="light-{name or light.name}"', inner, "emitter")
