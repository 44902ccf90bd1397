"""A pbrt-v4 scene file as the radiometric scene that means the same, directive by directive; the rest is refused.

The file of one grey channel is a grey scene. Surfaces of pbrt reflect on both sides, so materials are two-sided.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Any, Final

import numpy as np

from symrender.limits import MAX_DEPTH, MAX_NAME, MAX_PART_NAME
from symrender.scene.document import Document, Malformed, Mark, Path, Problem, Unreadable
from symrender.scene.pbrt import camera, lights, materials, shapes
from symrender.scene.pbrt.directives import Directive, directives
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import IDENTITY, Transform
from symrender.scene.printable import printable

_TOLD: Final = re.compile(rf"(shapes|lights|materials)\.([A-Za-z][A-Za-z0-9_-]{{0,{MAX_PART_NAME - 1}}})")
_NO_LETTER: Final = re.compile(r"[^A-Za-z0-9_-]")
_MOVES: Final = ("Identity", "Translate", "Scale", "Rotate", "LookAt", "Transform", "ConcatTransform")
_BEFORE: Final = ("Camera", "Film", "PixelFilter", "Integrator", "Sampler", "Accelerator", "Option", "WorldBegin")
_ANYWHERE: Final = (*_MOVES, "CoordinateSystem", "CoordSysTransform", "ColorSpace")
_OPTIONS: Final = ("disablepixeljitter", "disabletexturefiltering", "seed")
_NOTHING_MISSING: Final = {"bounces": 0, "camera": {"type": "look_at", "eye": [0, -1, 0], "target": [0, 0, 0]}}
"""What stands for an integrator or a camera that is refused, so that the rest is looked at."""
_UNNAMED: Final = materials.Surface({"type": "diffuse", "two_sided": True}, materials.DEFAULT, "", Mark(1, 1))


@dataclass(frozen=True)
class _State:
    """What AttributeBegin keeps and AttributeEnd brings back."""

    at: Transform = IDENTITY
    surface: materials.Surface = _UNNAMED
    lamp: tuple[dict[str, Any], Mark] | None = None
    turned: bool = False


class _Reader:
    """What was read so far: plain data, where each piece stands, and the state for what comes next."""

    def __init__(self, origin: str) -> None:
        stem = PurePath(origin).stem[:MAX_NAME] or "scene"
        self.data: dict[str, Any] = {"units": "radiometric", "name": stem, "materials": {}, "shapes": [], "lights": []}
        self.marks: dict[Path, Mark] = {(): Mark(1, 1)}
        self.state = _State()
        self.kept: list[_State] = []
        self.systems: dict[str, Transform | None] = {}
        self.textures: dict[str, materials.Texture] = {}
        self.named: dict[str, materials.Surface] = {}
        self.head: dict[str, Parameters] = {}
        self.seen_from = IDENTITY
        self.told: dict[str, str] = {}
        self.world = False
        self.problems: list[Problem] = []

    def read(self, directive: Directive) -> None:
        """Take in one directive; what is wrong with it is kept, and what follows is read too."""
        try:
            self._take(directive)
        except Unreadable:
            raise
        except Malformed as error:
            self.problems += error.problems
            if directive.name == "MakeNamedMaterial":
                self.named.setdefault(directive.strings[0], _UNNAMED)
            elif directive.name == "Texture":
                self.textures.setdefault(directive.strings[0], materials.DEFAULT)

    def _take(self, directive: Directive) -> None:
        name = directive.name
        for comment in directive.comments:
            if (found := _TOLD.fullmatch(comment)) is not None:
                self.told[found[1]] = found[2]
        if name not in _ANYWHERE and self.world == (name in _BEFORE):
            where = "before" if name in _BEFORE else "behind"
            raise Malformed(f"must stand {where} WorldBegin", directive.mark, (name,))
        if name in _MOVES:
            self.state = replace(self.state, at=self.state.at.then(directive))
        elif name in _BEFORE:
            self._head(directive)
        elif name in ("CoordinateSystem", "CoordSysTransform", "ColorSpace"):
            self._system(directive)
        elif name in ("AttributeBegin", "AttributeEnd"):
            self._nest(directive)
        elif name in ("Material", "MakeNamedMaterial", "NamedMaterial", "Texture"):
            self._surface(directive)
        elif name == "LightSource":
            self._light(Parameters(directive))
        elif name == "AreaLightSource":
            entry = self._named("lights", lights.area(Parameters(directive)))
            self.state = replace(self.state, lamp=(entry, directive.mark))
        elif name == "Shape":
            self._shape(Parameters(directive))
        elif name == "ReverseOrientation":
            # surfaces that reflect on both sides do not show it, lamps do
            self.state = replace(self.state, turned=not self.state.turned)

    def _head(self, directive: Directive) -> None:
        name = directive.name
        if name == "WorldBegin":
            self.world = True
            self.state, self.systems["world"] = _State(), IDENTITY
            return
        if name == "Option":
            given = directive.strings[0]
            if given not in _OPTIONS:
                raise Parameters(directive).wrong("", f"must be {', '.join(_OPTIONS)}, got {printable(given)}")
            return
        if name in self.head:
            raise Malformed("must be given once", directive.mark, (name,))
        self.head[name] = Parameters(directive)
        if name == "Camera":
            self.seen_from = self.state.at
            self.systems["camera"] = self.seen_from.inverse()

    def _system(self, directive: Directive) -> None:
        (name,) = directive.strings
        parameters = Parameters(directive)
        if directive.name == "ColorSpace":
            parameters.must("", name, "srgb", "white of another is another light")
        elif directive.name == "CoordinateSystem":
            self.systems[name] = self.state.at
        else:
            found = self.systems.get(name)
            if found is None:
                raise parameters.wrong("", f"must be a system of coordinates given before, got {printable(name)}")
            self.state = replace(self.state, at=found)

    def _nest(self, directive: Directive) -> None:
        if directive.name == "AttributeBegin":
            if len(self.kept) >= MAX_DEPTH:
                raise Unreadable(f"nesting must be at most {MAX_DEPTH} deep", directive.mark, ("AttributeBegin",))
            self.kept.append(self.state)
            return
        if not self.kept:
            raise Malformed("must end an AttributeBegin, got none open", directive.mark, ("AttributeEnd",))
        self.state = self.kept.pop()
        self.told.clear()

    def _surface(self, directive: Directive) -> None:
        parameters = Parameters(directive)
        given = directive.strings[0]
        if directive.name == "Texture":
            name, found = materials.texture(parameters, self.textures)
            self.textures[name] = found
        elif directive.name == "NamedMaterial":
            if given not in self.named:
                raise parameters.wrong("", f"must be a material given before, got {printable(given)}")
            self.state = replace(self.state, surface=self.named[given])
        elif directive.name == "MakeNamedMaterial":
            if given in self.named:
                first = self.named[given].mark.line
                raise parameters.wrong("", f"must have a name of its own, got {printable(given)} as on line {first}")
            kind = parameters.word("type", "")
            name = _NO_LETTER.sub("_", given)[:MAX_PART_NAME]
            self.named[given] = materials.surface(parameters, kind, name if name[:1].isalpha() else "", self.textures)
        else:
            told = self.told.pop("materials", "")
            self.state = replace(self.state, surface=materials.surface(parameters, given, told, self.textures))

    def _light(self, parameters: Parameters) -> None:
        entry, marks = lights.light(parameters, self.state.at)
        self._put("lights", entry, parameters.mark, marks)

    def _shape(self, parameters: Parameters) -> None:
        surface = self.state.surface
        entry, cell = shapes.shape(parameters, self.state.at, surface.texture)
        entry["material"] = self._material(surface, materials.entry_of(surface, cell))
        self._put("shapes", entry, parameters.mark, {"radius": parameters.where("radius")})
        if self.state.lamp is not None:
            mirrored = entry["type"] != "sphere" and float(np.linalg.det(self.state.at.matrix[:3, :3])) < 0.0
            if self.state.turned or mirrored:
                raise parameters.wrong(
                    "", "must not emit behind ReverseOrientation or a mirroring, which turn the side that shines"
                )
            lamp, mark = self.state.lamp
            self._put("lights", {**lamp, "shape": self.data["shapes"][-1]["name"]}, mark, {})

    def _material(self, surface: materials.Surface, entry: dict[str, Any]) -> str:
        """The name under which a material stands among those of the scene; same ones without a name are one."""
        have = self.data["materials"]
        name = surface.name or next((name for name, other in have.items() if other == entry), "")
        count = len(have) + 1
        while not name or (have.get(name, entry) != entry and not surface.name):
            name, count = f"material{count}", count + 1
        if have.setdefault(name, entry) != entry:
            raise Malformed(f"must have a name of its own, {name} is another material too", surface.mark, ("Material",))
        self.marks.setdefault(("materials", name), surface.mark)
        return name

    def _named(self, key: str, entry: dict[str, Any]) -> dict[str, Any]:
        """An entry with the name that a comment said, or by number."""
        return {"name": self.told.pop(key, f"{key[:-1]}-{len(self.data[key]) + 1}"), **entry}

    def _put(self, key: str, entry: dict[str, Any], mark: Mark, marks: dict[str, Mark]) -> None:
        """Append to a list of parts."""
        entry = entry if "name" in entry else self._named(key, entry)
        path: Path = (key, len(self.data[key]))
        self.marks[path] = mark
        for field in entry:
            self.marks[(*path, field)] = marks.get(field, mark)
        self.data[key].append(entry)

    def end(self) -> None:
        """Say who looks, and what the file lacks."""
        if not self.world:
            # what stands where is then not known
            self.problems = self.problems[:1] or [Problem((), "must have a WorldBegin, got none", Mark(1, 1))]
            self.data = _NOTHING_MISSING | self.data
            return
        if self.kept:
            self._lacks(f"must end {len(self.kept)} AttributeBegin more", "AttributeEnd")
        for name, told in (
            ("Integrator", '"path" with maxdepth 1, 2 or all'),
            ("Camera", '"perspective"'),
            ("PixelFilter", '"box"; without one pbrt filters by a Gaussian'),
        ):
            if name not in self.head and all(problem.path[:1] != (name,) for problem in self.problems):
                self._lacks(f"must be {told}, got none", name)
        size = camera.DEFAULT_SIZE
        for name in ("PixelFilter", "Film", "Integrator", "Camera"):
            if name not in self.head:
                continue
            try:
                if name == "PixelFilter":
                    camera.pixel_filter(self.head[name])
                elif name == "Film":
                    size = camera.film(self.head[name])
                elif name == "Integrator":
                    self.data["bounces"] = camera.integrator(self.head[name])
                else:
                    self.data["camera"] = camera.camera(self.head[name], self.seen_from, size)
            except Malformed as error:
                self.problems += error.problems
        for field, name in (("bounces", "Integrator"), ("camera", "Camera")):
            if name in self.head:
                self.marks[(field,)] = self.head[name].mark
        if self.problems:
            self.data = _NOTHING_MISSING | self.data

    def _lacks(self, message: str, name: str) -> None:
        self.problems.append(Problem((name,), message, Mark(1, 1)))


def parse_pbrt(text: str, origin: str) -> Document:
    """The scene of a pbrt file as plain data, with which directives have no meaning here, and why.

    Unreadable where the text ends before the scene does, as far as it can be read.
    """
    reader = _Reader(origin)
    try:
        for directive in directives(text, reader.problems):
            reader.read(directive)
    except Unreadable as error:
        error.others = reader.problems
        raise
    reader.end()
    return Document(reader.data, origin, reader.marks, problems=list(dict.fromkeys(reader.problems)))
