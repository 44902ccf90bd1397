"""A Mitsuba scene file as the radiometric scene that means the same; what has no meaning is reported all at once."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import PurePath
from typing import Any, Final

from symrender.limits import MAX_NAME, MAX_PART_NAME
from symrender.scene.document import Document, Malformed, Mark, Path, Problem, grouped
from symrender.scene.files import Opener, within
from symrender.scene.mitsuba.colours import EMITTED, Reader
from symrender.scene.mitsuba.expand import Objects, expanded
from symrender.scene.mitsuba.lights import light
from symrender.scene.mitsuba.materials import checked_scales, surface
from symrender.scene.mitsuba.properties import Properties, name_of
from symrender.scene.mitsuba.sensor import bounces, camera
from symrender.scene.mitsuba.shapes import Dress, Made, made
from symrender.scene.mitsuba.textures import colour_of
from symrender.scene.mitsuba.transforms import Array, taken_transform
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.printable import printable

_NOTHING_MISSING: Final = {"bounces": 0, "camera": {"type": "look_at", "eye": [0, -1, 0], "target": [0, 0, 0]}}
"""What stands for an integrator or a sensor that is refused, so that the rest is looked at."""
_NO_LETTER: Final = re.compile(r"[^A-Za-z0-9_-]")
_DEFAULT: Final = Element("bsdf", {"type": "diffuse"}, Mark(1, 1))
"""The bsdf of a shape that has none."""
_MEDIA: Final = "a medium is not supported: light travels in a vacuum here"
_SHARED: Final = ("bsdf", "texture", "spectrum", "film", "sampler", "rfilter", "phase", "volume")
"""What may stand in a scene to be referred to, and says nothing alone."""
_OTHERS: Final = ("accel", "camera", "mesh", "light", "brdf", "world")
"""What scenes of Nori and other renderers have, whose files begin alike."""
_DEEPEST: Final = 8
_EXPORTED: Final = "material-"
"""What ids of materials begin with in files that were exported here: they are kept, used or not."""


class _Scene:
    """What was read so far: plain data, and where each piece stands."""

    def __init__(self, origin: str, objects: Objects, opener: Opener) -> None:
        stem = PurePath(origin).stem[:MAX_NAME] or "scene"
        self.data: dict[str, Any] = {"units": "radiometric", "name": stem, "materials": {}, "shapes": [], "lights": []}
        self.marks: dict[Path, Mark] = {(): Mark(1, 1)}
        self.objects = objects
        self.reader = Reader(objects.folders, opener, objects.old)
        self.clip: list[float] = [0.0, math.inf]
        self.clip_mark = Mark(1, 1)
        self.problems: list[Problem] = list(objects.problems)
        self.notes: list[str] = []
        self.names: set[str] = set()
        self.dresses: dict[int, Dress] = {}
        self.resolved: set[int] = set()

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
        """A name of its own for a part: its id without the prefix, made of letters that names have."""
        return self.unique(element.attributes.get("id", "").removeprefix(prefix), prefix, len(self.data[key]) + 1, key)

    def unique(self, given: str, prefix: str, number: int, key: str) -> str:
        """``given`` as a name that no other part of ``key`` has."""
        name = _NO_LETTER.sub("_", given)[:MAX_PART_NAME]
        if not name or not name[0].isalpha():
            name = f"{prefix}{number}"
        first = name
        while f"{key} {name}" in self.names:
            name = f"{first[: MAX_PART_NAME - 7]}-{number}"
            number += 1
        self.names.add(f"{key} {name}")
        return name

    def resolve(self, element: Element, inside: tuple[str, ...] = ()) -> None:
        """Put the objects that it refers to into an element; each shared object is looked at once."""
        if id(element) in self.resolved:
            return
        self.resolved.add(id(element))
        if "id" in element.attributes:
            inside = (*inside, element.attributes["id"])
        kept = []
        for child in element.children:
            if child.tag == "ref":
                with self.part():
                    kept.append(self._referred(child, inside))
                continue
            self.resolve(child, inside)
            kept.append(child)
        element.children = kept

    def _referred(self, child: Element, inside: tuple[str, ...]) -> Element:
        identity = child.attributes.get("id", "")
        target = self.objects.shared.get(identity)
        if target is None:
            what = "no bsdf" if child.attributes.get("name", "bsdf") == "bsdf" else "nothing"
            raise Malformed(f"ref: {what} has the id {printable(identity)}", child.mark)
        if identity in inside or len(inside) >= _DEEPEST:
            raise Malformed(f"ref: {printable(identity)} refers to itself, or too deep", child.mark)
        self.resolve(target, inside)
        named = {"name": child.attributes["name"]} if "name" in child.attributes else {}
        attributes = {key: value for key, value in target.attributes.items() if key != "name"}
        return Element(target.tag, attributes | named, target.mark, target.children, target.comments)


def parse_mitsuba(text: str, origin: str, opener: Opener | None = None) -> Document:
    """The scene of a Mitsuba file as plain data, with which lines have no meaning here, and why.

    ``opener`` opens files that it includes or names; without it they lie in its folder. Malformed where it is no scene
    at all.
    """
    opens = opener or within(origin)
    objects = expanded(text, opens)
    read = _Scene(origin, objects, opens)
    other = next((child for child in objects.children if child.tag in _OTHERS), None)
    if other is not None:
        raise Malformed(f"must be a scene of Mitsuba, got one of another renderer by its {other.tag}", other.mark)
    for child in (*objects.children, *objects.shared.values()):
        read.resolve(child)
    emission_only = _integrated(read)
    readers = {"sensor": _sensor, "shape": _shape, "emitter": _emitter}
    # the camera first: it says whether its image is mirrored
    for child in sorted(objects.children, key=lambda child: child.tag != "sensor"):
        with read.part():
            if child.tag == "medium":
                raise Malformed(f"{name_of(child)}: {_MEDIA}", child.mark)
            if child.tag in ("integrator", *_SHARED) or (child.tag == "emitter" and _is_for_a_shape(child)):
                continue
            if child.tag not in readers:
                known = "integrator, sensor, bsdf, texture, shape and emitter"
                raise Malformed(f"{name_of(child)} has no meaning here; known are {known}", child.mark)
            readers[child.tag](read, child)
    for identity, shared in objects.shared.items():
        if shared.tag == "bsdf" and identity.startswith(_EXPORTED):
            with read.part():
                _dress(read, shared)
    if not any(child.tag == "sensor" for child in objects.children):
        read.problems.append(Problem((), "scene: needs one sensor", objects.root.mark))
    if emission_only:
        read.data["materials"] = {name: {"type": "diffuse", "reflectance": 0.0} for name in read.data["materials"]}
    if read.problems:
        read.data = _NOTHING_MISSING | read.data
    else:
        with read.part():
            _clipped(read)
    return Document(read.data, origin, read.marks, problems=grouped(read.problems))


def _is_for_a_shape(emitter: Element) -> bool:
    """Whether an emitter of a scene is there to be referred to by shapes."""
    return emitter.attributes.get("type") == "area" and "id" in emitter.attributes


def _integrated(read: _Scene) -> bool:
    """Read the integrator; whether it shows emission alone, for which all that reflects is black."""
    integrators = [child for child in read.objects.children if child.tag == "integrator"]
    found: int | str | None = 0
    with read.part():
        if len(integrators) > 1:
            raise Malformed("a second integrator", integrators[1].mark)
        found = bounces(integrators[0] if integrators else None, read.notes)
        read.data["bounces"] = 0 if found is None else found
        read.marks[("bounces",)] = integrators[0].mark if integrators else Mark(1, 1)
    return found is None


def _clipped(read: _Scene) -> None:
    """Refuse clipping distances that cut a sphere away: a scene has none."""
    near, far = read.clip
    for shape in read.data["shapes"]:
        if shape["type"] == "sphere":
            away = math.dist(read.data["camera"]["eye"], shape["center"])
            if abs(away - shape["radius"]) < near or away > far:
                raise Malformed(f"sensor: near_clip or far_clip cuts {shape['name']} away", read.clip_mark)


def _sensor(read: _Scene, element: Element) -> None:
    if "camera" in read.data:
        read.notes.append("of several sensors the first is taken")
        return
    read.data["camera"], film = camera(element, read.clip, read.reader.outer)
    film.notes += read.notes
    read.data["film"] = film.entry()
    read.clip_mark = element.mark
    look = [part for child in element.children if child.tag == "transform" for part in child.children]
    for field in ("eye", "target", "up"):
        read.marks[("camera", field)] = look[0].mark if look else element.mark
    read.marks[("camera",)] = read.marks[("film",)] = element.mark


def _dress(read: _Scene, element: Element) -> Dress:
    """A bsdf as a material of the scene: under which name it stands there."""
    known = read.dresses.get(id(element.children)) if element.children else None
    if known is not None and element.attributes.get("type") is not None:
        return known
    material, scales = checked_scales(surface(element, read.reader))
    have = read.data["materials"]
    identity = element.attributes.get("id", "")
    given = identity.removeprefix(_EXPORTED).split(":")[0]
    if identity.startswith(_EXPORTED):
        # every material of a scene that was exported keeps its name
        name = given if have.get(given) == material else ""
    else:
        name = next((name for name, other in have.items() if other == material), "")
    if not name:
        name = read.unique(given, "material", len(have) + 1, "materials")
        have[name] = material
    path: Path = ("materials", name)
    read.marks.setdefault(path, element.mark)
    for child in element.children:
        field = child.attributes.get("name", "")
        read.marks.setdefault((*path, {"specular_reflectance": "reflectance"}.get(field, field)), child.mark)
    made_of = Dress(name, material, scales)
    if element.children:
        read.dresses[id(element.children)] = made_of
    return made_of


def _shape(read: _Scene, element: Element, outer: Array | None = None, depth: int = 0) -> None:
    kind = str(element.attributes.get("type"))
    world = read.reader.outer if outer is None else outer
    if kind == "shapegroup" and depth == 0:
        return  # is seen where an instance refers to it
    if kind in ("instance", "shapegroup", "merge"):
        _group(read, element, world, depth)
        return
    properties = Properties(element)
    lamps = properties.parts("emitter")
    entry: dict[str, Any] | None = None
    name = ""
    with read.part():
        for child in properties.parts("medium"):
            read.problems.append(Problem((), f"{name_of(child)}: {_MEDIA}", child.mark))
        dress = _surface_of(read, properties)
        shape = made(properties, dress, read.reader, world, bool(lamps))
        _check_chart(properties, shape, dress)
        name = read.name(element, "shape-", "shapes")
        entry = {"type": shape.fields["type"], "name": name, "material": dress.name, **shape.fields}
        read.put("shapes", entry, element.mark, {})
    for lamp in lamps[:1]:
        with read.part():
            _lamp(read, name if entry is not None else "", lamp)


def _group(read: _Scene, element: Element, outer: Array, depth: int) -> None:
    """Read the shapes of a group, or of an instance of one, where they stand."""
    if depth >= _DEEPEST:
        raise Malformed("shape instance: groups of groups are too deep", element.mark)
    properties = Properties(element)
    matrix = taken_transform(properties)
    inner = properties.parts("shape")
    inner += [properties.named.pop(name) for name, child in list(properties.named.items()) if child.tag == "shape"]
    properties.pop("id")
    properties.done("to_world and shapes")
    for child in inner:
        with read.part():
            _shape(read, child, outer if matrix is None else outer @ matrix, depth + 1)


def _check_chart(properties: Properties, shape: Made, dress: Dress) -> None:
    """Refuse a checker with a comment that is not the one of its cell in the chart of a scene."""
    if dress.scales is None or shape.due is None:
        return
    due, cell = shape.due, dress.cell
    pairs = due[0] / (2.0 * cell)
    whole = due[1] != due[0] or abs(pairs - round(pairs)) <= 1e-9 * pairs
    if not whole or any(abs(x * cell - one) > 1e-12 * one for x, one in zip(dress.scales, due, strict=True)):
        raise properties.wrong("its to_uv is not that of a checker of the cell that its comment names")


def _lamp(read: _Scene, shape: str, element: Element) -> None:
    """The emitter inside a shape as an area light; looked at only where the shape was refused and has no name."""
    properties = Properties(element)
    if element.attributes.get("type") != "area":
        raise properties.wrong("a shape emits as area, no other way")
    mark = properties.named["radiance"].mark if "radiance" in properties.named else element.mark
    radiance = colour_of(properties, "radiance", 1.0, read.reader, EMITTED)
    properties.pop("id", "sampling_weight")
    properties.done("radiance")
    if not shape:
        return
    name = read.name(element, "light-", "lights")
    read.put("lights", {"type": "area", "name": name, "shape": shape, "radiance": radiance}, element.mark,
             {"radiance": mark})  # fmt: skip


def _surface_of(read: _Scene, properties: Properties) -> Dress:
    """The material of a shape, diffuse where there is none, black where it only emits."""
    found = properties.parts("bsdf")
    if len(found) > 1:
        raise properties.wrong(f"needs one bsdf, or a ref to one, got {len(found)}")
    if found:
        return _dress(read, found[0])
    lit = any(child.tag == "emitter" for child in properties.element.children)
    return _dress(read, _BLACK if lit else _DEFAULT)


_BLACK: Final = Element(
    "bsdf", {"type": "diffuse"}, Mark(1, 1), [Element("rgb", {"name": "reflectance", "value": "0"}, Mark(1, 1))]
)
"""The bsdf of a shape that emits and has none."""


def _emitter(read: _Scene, element: Element) -> None:
    name = read.name(element, "light-", "lights")
    entry, marks = light(Properties(element), str(element.attributes.get("type")), name, read.reader)
    read.put("lights", entry, element.mark, marks)
