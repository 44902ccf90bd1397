"""A Mitsuba 3 scene file as the radiometric scene that means the same, line by line; the rest is refused by name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import PurePath
from typing import Any, Final

from symrender.limits import MAX_NAME, MAX_PART_NAME
from symrender.scene.document import Document, Malformed, Mark, Path, Problem
from symrender.scene.mitsuba.finite import check_chart, flat_fields
from symrender.scene.mitsuba.flats import fields_of, told_shape
from symrender.scene.mitsuba.lights import light
from symrender.scene.mitsuba.plane import square, told, told_cell
from symrender.scene.mitsuba.properties import Properties, name_of, numbers
from symrender.scene.mitsuba.xml_tree import Element, parse_xml
from symrender.scene.printable import printable
from symrender.scene.radiometric.shapes import Plane

FLATS: Final = {"rectangle": "rectangle", "disk": "disk", "cube": "box"}
"""Flat shapes and what they are called here."""
_NOTHING_MISSING: Final = {"bounces": 0, "camera": {"type": "look_at", "eye": [0, -1, 0], "target": [0, 0, 0]}}
"""What stands for an integrator or a sensor that is refused, so that the rest is looked at."""
_NO_LETTER: Final = re.compile(r"[^A-Za-z0-9_-]")


class _Scene:
    """What was read so far: plain data, and where each piece stands."""

    def __init__(self, origin: str) -> None:
        stem = PurePath(origin).stem[:MAX_NAME] or "scene"
        self.data: dict[str, Any] = {"units": "radiometric", "name": stem, "materials": {}, "shapes": [], "lights": []}
        self.marks: dict[Path, Mark] = {(): Mark(1, 1)}
        self.bsdfs: dict[str, Element] = {}
        self.clip: tuple[float, float, Mark] = (0.0, math.inf, Mark(1, 1))
        self.problems: list[Problem] = []

    @contextmanager
    def part(self) -> Iterator[None]:
        """Read a part of the file; what is wrong with it is kept, and the parts behind it are read too."""
        try:
            yield
        except Malformed as error:
            self.problems += error.problems

    def put(self, key: str, entry: dict[str, Any], mark: Mark, marks: dict[str, Mark]) -> None:
        """Append to a list of parts."""
        path: Path = (key, len(self.data[key]))
        self.marks[path] = mark
        for field in entry:
            self.marks[(*path, field)] = marks.get(field, mark)
        self.data[key].append(entry)

    def name(self, element: Element, prefix: str, key: str) -> str:
        """The name of a part: its id without the prefix, made of letters that names have."""
        given = element.attributes.get("id", "").removeprefix(prefix)
        name = _NO_LETTER.sub("_", given)[:MAX_PART_NAME]
        if not name or not name[0].isalpha():
            name = f"{prefix}{len(self.data[key]) + 1}"
        return name


def parse_mitsuba(text: str, origin: str) -> Document:
    """The scene of a Mitsuba file as plain data, with which lines have no meaning here, and why.

    Malformed where it is no scene at all.
    """
    root = parse_xml(text)
    if root.tag != "scene":
        raise Malformed(f"must be a scene, got {printable(root.tag)}", root.mark)
    read = _Scene(origin)
    for child in root.children:
        if child.tag == "bsdf" and "id" in child.attributes:
            with read.part():
                if child.attributes["id"] in read.bsdfs:
                    raise Malformed(f"id {printable(child.attributes['id'])}: given twice", child.mark)
                read.bsdfs[child.attributes["id"]] = child
    for element in read.bsdfs.values():
        with read.part():
            _material(read, element)
    readers = {"integrator": _integrator, "sensor": _sensor, "shape": _shape, "emitter": _emitter}
    for child in root.children:
        if child.tag == "bsdf" and "id" in child.attributes:
            continue
        with read.part():
            if child.tag not in readers:
                known = "integrator, sensor, bsdf with an id, shape and emitter"
                raise Malformed(f"{name_of(child)} has no meaning here; known are {known}", child.mark)
            readers[child.tag](read, child)
    for tag, what in (("integrator", "integrator, whose max_depth is the bounces + 2"), ("sensor", "sensor")):
        if all(child.tag != tag for child in root.children):
            read.problems.append(Problem((), f"scene: needs one {what}", root.mark))
    if read.problems:
        read.data = _NOTHING_MISSING | read.data
    else:
        with read.part():
            _clipped(read)
    return Document(read.data, origin, read.marks, problems=list(dict.fromkeys(read.problems)))


def _clipped(read: _Scene) -> None:
    """Refuse clipping distances that cut a sphere away: a scene has none."""
    near, far, mark = read.clip
    for shape in read.data["shapes"]:
        if shape["type"] == "sphere":
            away = math.dist(read.data["camera"]["eye"], shape["center"])
            if abs(away - shape["radius"]) < near or away > far:
                raise Malformed(f"sensor: near_clip or far_clip cuts {shape['name']} away", mark)


def _integrator(read: _Scene, element: Element) -> None:
    if "bounces" in read.data:
        raise Malformed("a second integrator", element.mark)
    properties = Properties(element)
    kind = element.attributes.get("type")
    if kind not in ("path", "direct"):
        raise properties.wrong("must be path or direct")
    depth = properties.number("max_depth", -1.0) if kind == "path" else 2.0
    if kind == "path":
        properties.number("rr_depth", 5.0)
    if properties.word("hide_emitters", "false") != "false":
        raise properties.wrong("hide_emitters: a sky that lights is seen")
    properties.done("max_depth, rr_depth and hide_emitters")
    bounces: dict[float, int | str] = {2.0: 0, 3.0: 1, -1.0: "all"}
    if depth not in bounces:
        raise properties.wrong(f"max_depth must be 2 (direct light), 3 (one bounce) or -1 (all), got {depth:g}")
    read.data["bounces"] = bounces[depth]
    read.marks[("bounces",)] = element.mark


def _sensor(read: _Scene, element: Element) -> None:
    if "camera" in read.data:
        raise Malformed("a second sensor", element.mark)
    properties = Properties(element)
    if element.attributes.get("type") != "perspective":
        raise properties.wrong("must be perspective")
    for child in list(properties.others):
        if child.tag == "film":
            _film(child)
            properties.others.remove(child)
        elif child.tag == "sampler":
            properties.others.remove(child)
    if not any(child.tag == "film" for child in element.children):
        raise properties.wrong("needs a film with an rfilter box; without one Mitsuba filters by a Gaussian")
    if properties.word("fov_axis", "x") != "y":
        raise properties.wrong("fov_axis must be y: fov is the vertical field of view")
    fov = properties.number("fov")
    transform = properties.take("to_world", "transform")
    read.clip = properties.number("near_clip", 0.01), properties.number("far_clip", 1e4), element.mark
    if transform is None or len(transform.children) != 1 or transform.children[0].tag != "lookat":
        raise properties.wrong("to_world must be one lookat", transform)
    properties.done("fov, fov_axis, to_world, near_clip, far_clip, film and sampler")
    look = transform.children[0]
    camera: dict[str, Any] = {"type": "look_at", "fov": fov}
    for theirs, ours, default in (("origin", "eye", ""), ("target", "target", ""), ("up", "up", "0, 0, 1")):
        text = look.attributes.get(theirs, default)
        camera[ours] = numbers(look, text, 3)
        read.marks[("camera", ours)] = look.mark
    read.data["camera"] = camera
    read.marks[("camera",)] = element.mark


def _film(element: Element) -> None:
    properties = Properties(element)
    if element.attributes.get("type") != "hdrfilm":
        raise properties.wrong("must be hdrfilm")
    filters = [child for child in element.children if child.tag == "rfilter"]
    if len(filters) != 1 or filters[0].attributes.get("type") != "box":
        raise properties.wrong("needs an rfilter box; without one Mitsuba filters by a Gaussian")
    for name in ("width", "height"):
        properties.number(name, 1.0)
    for name in ("pixel_format", "component_format", "file_format"):
        properties.word(name, "")
    properties.others = [child for child in properties.others if child not in filters]
    properties.done("width, height, formats and rfilter")


def _material(read: _Scene, element: Element) -> tuple[str, list[float] | None]:
    """Read a bsdf into the materials: the name it has there, and the scale of its texture where it has one."""
    given = element.attributes.get("id", "").removeprefix("material-").split(":")[0]
    name = _NO_LETTER.sub("_", given)[:MAX_PART_NAME]
    if not name or not name[0].isalpha():
        name = f"material{len(read.data['materials']) + 1}"
    two_sided = element.attributes.get("type") == "twosided"
    if two_sided:
        if len(element.children) != 1 or element.children[0].tag != "bsdf":
            raise Malformed("bsdf twosided: must hold one bsdf", element.mark)
        element = element.children[0]
    material: dict[str, Any] = {"type": "diffuse"}
    with read.part():
        material = _surface(element)
    scales = material.pop("scales", None)
    if two_sided:
        material["two_sided"] = True
    if read.data["materials"].setdefault(name, material) != material:
        raise Malformed(f"id: two different materials are called {name} here", element.mark)
    path: Path = ("materials", name)
    read.marks.setdefault(path, element.mark)
    for child in element.children:
        field = {"specular_reflectance": "reflectance"}.get(
            child.attributes.get("name", ""), child.attributes.get("name")
        )
        read.marks.setdefault((*path, str(field)), child.mark)
    return name, scales


def _surface(element: Element) -> dict[str, Any]:
    properties = Properties(element)
    match element.attributes.get("type"):
        case "diffuse":
            material = {"type": "diffuse"} | _reflectance(properties, "reflectance")
            properties.done("reflectance")
        case "roughconductor":
            distribution = properties.word("distribution", "beckmann")
            if distribution not in ("ggx", "beckmann"):
                raise properties.wrong(f"distribution must be ggx or beckmann, got {printable(distribution)}")
            material = {"type": "conductor", "distribution": distribution, "alpha": properties.number("alpha", 0.1)}
            if distribution == "beckmann":
                material["g1"] = "walter"
            for name in ("eta", "k"):
                material[name] = properties.triple(name, "rgb")[0]
            material |= _reflectance(properties, "specular_reflectance")
            properties.word("sample_visible", "true")
            properties.done("distribution, alpha, eta and k in rgb, specular_reflectance")
        case _:
            raise properties.wrong("no such material here; known are diffuse, roughconductor and twosided")
    return material


def _reflectance(properties: Properties, name: str) -> dict[str, Any]:
    """What a surface reflects, as the field of a material; nothing where it is as by default."""
    texture = properties.named.get(name)
    if texture is None:
        return {}
    if texture.tag == "rgb":
        return {"reflectance": {"type": "solid", "color": properties.triple(name, "rgb")[0]}}
    taken = properties.take(name, "rgb", "texture")
    assert taken is not None
    inner = Properties(taken)
    if taken.attributes.get("type") != "checkerboard":
        raise inner.wrong("no such texture here; known is checkerboard")
    bright, dark = inner.triple("color0", "rgb")[0], inner.triple("color1", "rgb")[0]
    transform = inner.take("to_uv", "transform")
    inner.done("color0, color1 and to_uv")
    if transform is None or len(transform.children) != 1 or transform.children[0].tag != "scale":
        raise inner.wrong("to_uv must be one scale", transform)
    scales = numbers(transform, " ".join(transform.children[0].attributes.get(axis, "1") for axis in "xy"), 2)
    cell = next((cell for comment in taken.comments if (cell := told_cell(comment))), None)
    if cell is None:
        raise inner.wrong("its chart is not known: a comment `symrender cell: LENGTH` would say it")
    return {"reflectance": {"type": "checker", "bright": bright, "dark": dark, "cell": cell}, "scales": scales}


def _shape(read: _Scene, element: Element) -> None:
    kind = str(element.attributes.get("type"))
    name = read.name(element, "shape-", "shapes")
    properties = Properties(element)
    lamps = [child for child in element.children if child.tag == "emitter"]
    if lamps:
        properties.others.remove(lamps[0])
    count = len(read.data["shapes"])
    with read.part():
        _solid(read, element, properties, kind, name)
    for lamp in lamps[:1]:
        _lamp(read, name if len(read.data["shapes"]) > count else "", lamp)


def _solid(read: _Scene, element: Element, properties: Properties, kind: str, name: str) -> None:
    """Read what a shape is but its emitter."""
    plane = next((found for comment in element.comments if (found := told(comment))), None)
    if kind == "sphere" or (kind == "rectangle" and plane is not None):
        material, scales = _surface_of(read, properties)
        transform = properties.take("to_world", "transform")
        matrix = _matrix(properties, transform) if transform is not None else None
        if kind == "sphere":
            entry, due = _sphere(properties, name, material, matrix, scales), (1.0, 0.5)
        else:
            entry, half = _plane(properties, name, material, matrix, plane or {})
            due = (half, half)
        if scales is not None:
            _chart(properties, read.data["materials"][material]["reflectance"]["cell"], scales, due)
        read.put("shapes", entry, element.mark, {})
        properties.done("center, radius, to_world and bsdf")
    elif kind in FLATS:
        _flat(read, element, properties, FLATS[kind], name)
    elif kind == "ply" and (found := told_shape(element.comments, "triangle", name)) is not None:
        # the file beside this one is not opened: it says what the comment says, in single precision
        material, _ = _surface_of(read, properties)
        properties.take("filename", "string")
        properties.take("face_normals", "boolean")
        properties.done("filename, face_normals and bsdf")
        entry = {"type": "triangle", "name": name, "material": material, **fields_of(found)}
        read.put("shapes", entry, element.mark, {})
    else:
        raise properties.wrong(
            "no such shape here; known are sphere, rectangle, disk, cube, and ply with a comment `symrender triangle`"
        )


def _flat(read: _Scene, element: Element, properties: Properties, kind: str, name: str) -> None:
    material, scales = _surface_of(read, properties)
    transform = properties.take("to_world", "transform")
    rows = _matrix(properties, transform) if transform is not None else [float(i % 5 == 0) for i in range(16)]
    properties.done("to_world and bsdf")
    fields = flat_fields(properties, element.comments, kind, rows)
    if scales is not None:
        check_chart(properties, kind, fields, scales, read.data["materials"][material]["reflectance"]["cell"])
    read.put("shapes", {"type": kind, "name": name, "material": material, **fields}, element.mark, {})


def _lamp(read: _Scene, shape: str, element: Element) -> None:
    """The emitter inside a shape as an area light; looked at only where the shape was refused and has no name."""
    properties = Properties(element)
    if element.attributes.get("type") != "area":
        raise properties.wrong("a shape emits as area, no other way")
    radiance, mark = properties.triple("radiance", "rgb")
    properties.done("radiance")
    if not shape:
        return
    name = read.name(element, "light-", "lights")
    read.put("lights", {"type": "area", "name": name, "shape": shape, "radiance": radiance}, element.mark,
             {"radiance": mark})  # fmt: skip


def _surface_of(read: _Scene, properties: Properties) -> tuple[str, list[float] | None]:
    """Name of the material of a shape, and the scale of its texture."""
    found = [child for child in properties.others if child.tag in ("bsdf", "ref")]
    if len(found) != 1:
        raise properties.wrong(f"needs one bsdf, or a ref to one, got {len(found)}")
    properties.others.remove(found[0])
    bsdf = found[0]
    if bsdf.tag == "ref":
        named = read.bsdfs.get(bsdf.attributes.get("id", ""))
        if named is None:
            raise properties.wrong(f"no bsdf has the id {printable(bsdf.attributes.get('id', ''))}", bsdf)
        bsdf = named
    return _material(read, bsdf)


def _matrix(properties: Properties, transform: Element) -> list[float]:
    if len(transform.children) != 1 or transform.children[0].tag != "matrix":
        raise properties.wrong("to_world must be one matrix", transform)
    (child,) = transform.children
    return numbers(child, properties.value(child), 16)


def _sphere(
    properties: Properties, name: str, material: str, matrix: list[float] | None, scales: list[float] | None
) -> dict[str, Any]:
    if matrix is None:
        if scales is not None:
            raise properties.wrong(
                "a texture needs the to_world of half a turn about z, -r 0 0 x 0 -r 0 y 0 0 r z 0 0 0 1"
            )
        center = properties.triple("center", "point")[0]
        return {"type": "sphere", "name": name, "center": center, "radius": properties.number("radius", 1.0),
                "material": material}  # fmt: skip
    r = matrix[10]
    if matrix != [-r, 0, 0, matrix[3], 0, -r, 0, matrix[7], 0, 0, r, matrix[11], 0, 0, 0, 1] or scales is None:
        raise properties.wrong("to_world must be half a turn about z, -r 0 0 x 0 -r 0 y 0 0 r z 0 0 0 1, of a texture")
    center = [matrix[3], matrix[7], matrix[11]]
    return {"type": "sphere", "name": name, "center": center, "radius": r, "material": material}


def _plane(
    properties: Properties, name: str, material: str, matrix: list[float] | None, plane: dict[str, list[float]],
) -> tuple[dict[str, Any], float]:  # fmt: skip
    """A plane by its comment, refused where the square says another one, and half a side of the square."""
    entry: dict[str, Any] = {"type": "plane", "name": name, **plane, "material": material}
    if matrix is None:
        raise properties.wrong("the square of a plane needs its to_world")
    half = sum(x * x for x in matrix[0:9:4]) ** 0.5
    try:
        due = square(Plane(**(entry | {key: tuple(value) for key, value in plane.items()})), half)
    except ValueError:
        raise properties.wrong("its comment names no plane") from None
    sizes = [half, half, 1.0, 1.0] * 4
    if not all(abs(a - b) <= 1e-12 * (abs(b) + size) for a, b, size in zip(matrix, due, sizes, strict=True)):
        raise properties.wrong("its to_world is not a square of the plane that its comment names")
    return entry, half


def _chart(properties: Properties, cell: float, scales: list[float], due: tuple[float, float]) -> None:
    """Refuse a checker that is not the one of that cell in the chart of a scene; ``due`` are its scales for cell 1."""
    pairs = due[0] / (2.0 * cell)
    whole = due[1] != due[0] or abs(pairs - round(pairs)) <= 1e-9 * pairs
    if not whole or any(abs(x * cell - one) > 1e-12 * one for x, one in zip(scales, due, strict=True)):
        raise properties.wrong("its to_uv is not that of a checker of the cell that its comment names")


def _emitter(read: _Scene, element: Element) -> None:
    name = read.name(element, "light-", "lights")
    entry, marks = light(Properties(element), str(element.attributes.get("type")), name)
    read.put("lights", entry, element.mark, marks)
