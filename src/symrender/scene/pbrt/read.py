"""A pbrt-v4 scene file as the radiometric scene that means the same; what has no meaning here is reported all at once.

pbrt makes spectra of colours; here they are taken channel by channel, which is the same for grey ones and for lights.
Surfaces of pbrt reflect on both sides, so materials are two-sided. pbrt's coordinates are left-handed: a camera that
is not mirrored sees the scene of its mirror image, which is what is made of it. Long because all directives change one
state.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Any, Final

from symrender.errors import SceneError
from symrender.limits import MAX_DEPTH, MAX_FOREIGN_BYTES, MAX_NAME, MAX_PART_NAME
from symrender.scene.document import Document, Malformed, Mark, Path, Problem, Unreadable, grouped
from symrender.scene.files import Opener, found, within
from symrender.scene.meshes.files import unzipped
from symrender.scene.pbrt import camera, lights, materials, shapes
from symrender.scene.pbrt.directives import Count, Directive, Parameter, directives
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import IDENTITY, MIRROR, Transform
from symrender.scene.printable import printable
from symrender.scene.read import decoded

_TOLD: Final = re.compile(rf"(shapes|lights|materials)\.([A-Za-z][A-Za-z0-9_-]{{0,{MAX_PART_NAME - 1}}})")
_NO_LETTER: Final = re.compile(r"[^A-Za-z0-9_-]")
_MOVES: Final = ("Identity", "Translate", "Scale", "Rotate", "LookAt", "Transform", "ConcatTransform")
_BEFORE: Final = ("Camera", "Film", "PixelFilter", "Integrator", "Sampler", "Accelerator", "Option", "WorldBegin")
_ANYWHERE: Final = (
    *_MOVES, "CoordinateSystem", "CoordSysTransform", "ColorSpace", "Attribute", "Include", "Import", "AttributeBegin",
    "AttributeEnd", "TransformBegin", "TransformEnd", "ReverseOrientation", "MakeNamedMedium",
)  # fmt: skip
_OPTIONS: Final = (
    "disablepixeljitter", "disabletexturefiltering", "disablewavelengthjitter", "seed", "rendercoordsys", "quiet",
    "nthreads", "writepartialimages", "pixelstats", "interactive", "fullscreen",
)  # fmt: skip
_OLD_MATERIALS: Final = frozenset((
    "matte", "plastic", "metal", "glass", "uber", "substrate", "translucent", "mirror", "kdsubsurface", "fourier",
    "disney", "shinymetal", "bluepaint", "brushedmetal", "clay", "felt", "primer", "skin",
))  # fmt: skip
"""Materials that only versions before 4 have."""
_TARGETS: Final = {"Shape": "shape", "LightSource": "light", "AreaLightSource": "light", "Material": "material",
                   "MakeNamedMaterial": "material", "Texture": "texture"}  # fmt: skip
_MOST_INSTANCES: Final = 1 << 16
_MOST_FILES: Final = 4096
_MOST_INCLUDES: Final = 16
"""Most files inside each other."""
_NOTHING_MISSING: Final = {"bounces": 0, "camera": {"type": "look_at", "eye": [0, -1, 0], "target": [0, 0, 0]}}
"""What stands for an integrator or a camera that is refused, so that the rest is looked at."""
_UNNAMED: Final = materials.Surface({"type": "diffuse", "two_sided": True}, materials.DEFAULT, "", Mark(1, 1))
_BLACK: Final = {"type": "diffuse", "reflectance": 0.0}


class _Old(Exception):
    """A file of a version before 4: by what it is known, and where that stands."""


@dataclass(frozen=True)
class _State:
    """What AttributeBegin keeps and AttributeEnd brings back."""

    at: Transform = IDENTITY
    surface: materials.Surface = _UNNAMED
    lamp: tuple[dict[str, Any], Mark] | None = None
    turned: bool = False
    defaults: Mapping[str, Mapping[str, Parameter]] = field(default_factory=dict)


class _Reader:
    """What was read so far: plain data, where each piece stands, and the state for what comes next."""

    def __init__(self, origin: str, opener: Opener) -> None:
        stem = PurePath(origin).stem[:MAX_NAME] or "scene"
        self.data: dict[str, Any] = {"units": "radiometric", "name": stem, "materials": {}, "shapes": [], "lights": []}
        self.marks: dict[Path, Mark] = {(): Mark(1, 1)}
        self.state = _State()
        self.kept: list[_State] = []
        self.systems: dict[str, Transform | None] = {}
        self.shelf = materials.Shelf(opener)
        self.opener = opener
        self.outer = IDENTITY
        self.objects: dict[str, list[tuple[Parameters, _State]]] = {}
        self.object: list[tuple[Parameters, _State]] | None = None
        self.instances = self.files = 0
        self.bytes = 0
        self.count = Count()
        self.names: set[str] = set()
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
                self.shelf.textures.setdefault(directive.strings[0], materials.DEFAULT)

    def file(self, text: str, name: str, depth: int) -> None:
        """Take in the directives of a file, and of those that it includes."""
        for directive in directives(text, self.problems, name, self.count):
            if directive.name in ("Include", "Import"):
                with self.kept_problem():
                    self._include(directive, depth)
            else:
                self.read(directive)

    @contextmanager
    def kept_problem(self) -> Iterator[None]:
        """Keep what is wrong with a directive, and read on."""
        try:
            yield
        except Unreadable:
            raise
        except Malformed as error:
            self.problems += error.problems

    def _include(self, directive: Directive, depth: int) -> None:
        (name,) = directive.strings
        self.files += 1
        if self.files > _MOST_FILES:
            raise Unreadable(f"must be at most {_MOST_FILES} files", directive.mark, (directive.name,))
        if depth >= _MOST_INCLUDES:
            wanted = f"must be at most {_MOST_INCLUDES} files inside each other"
            raise Malformed(wanted, directive.mark, (directive.name,))
        try:
            path = found(name, [""], self.opener)
            data = unzipped(self.opener(path, MAX_FOREIGN_BYTES + 1), path, MAX_FOREIGN_BYTES)
            self.bytes += len(data)
            if self.bytes > MAX_FOREIGN_BYTES:
                raise SceneError(f"the files of a scene may hold at most {MAX_FOREIGN_BYTES} bytes together")
            text = decoded(data, path, MAX_FOREIGN_BYTES)
        except SceneError as error:
            raise Malformed(str(error), directive.mark, (directive.name,)) from None
        before = self.state
        self.file(text, path, depth + 1)
        if directive.name == "Import":
            self.state = before

    def _take(self, directive: Directive) -> None:
        name = directive.name
        _refuse_old(directive)
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
        elif name in ("AttributeBegin", "AttributeEnd", "TransformBegin", "TransformEnd"):
            self._nest(directive)
        elif name in ("ObjectBegin", "ObjectEnd", "ObjectInstance"):
            self._object(directive)
        elif name == "Attribute":
            self._attribute(directive)
        elif name == "MakeNamedMedium":
            raise Malformed("must not be there: a scene has no media", directive.mark, (name,))
        elif name in ("Material", "MakeNamedMaterial", "NamedMaterial", "Texture"):
            self._surface(directive)
        elif name == "LightSource":
            self._light(self._given(directive))
        elif name == "AreaLightSource":
            # it has no name where it emits from several shapes
            entry = lights.area(self._given(directive), self.shelf)
            told = self.told.pop("lights", "")
            self.state = replace(self.state, lamp=({"name": told, **entry} if told else entry, directive.mark))
        elif name == "Shape":
            parameters = self._given(directive)
            if self.object is not None:
                self.object.append((parameters, self.state))
            else:
                self._shape(parameters, self.state, IDENTITY)
        elif name == "ReverseOrientation":
            # surfaces that reflect on both sides do not show it, lamps do
            self.state = replace(self.state, turned=not self.state.turned)

    def _given(self, directive: Directive) -> Parameters:
        """Parameters of a directive, and those that ``Attribute`` gave before."""
        return Parameters(directive).beside(self.state.defaults.get(_TARGETS[directive.name], {}))

    def _attribute(self, directive: Directive) -> None:
        (target,) = directive.strings
        if target not in (*_TARGETS.values(), "medium"):
            raise Malformed(f"must be shape, light, material, medium or texture, got {printable(target)}",
                            directive.mark, ("Attribute",))  # fmt: skip
        merged = {**self.state.defaults.get(target, {}), **directive.parameters}
        self.state = replace(self.state, defaults={**self.state.defaults, target: merged})

    def _object(self, directive: Directive) -> None:
        if directive.name == "ObjectInstance":
            (name,) = directive.strings
            if name not in self.objects or self.object is not None:
                wanted = f"must be an object given before, got {printable(name)}"
                raise Malformed(wanted, directive.mark, (directive.name,))
            for parameters, state in self.objects[name]:
                self.instances += 1
                if self.instances > _MOST_INSTANCES:
                    raise Unreadable(
                        f"must be at most {_MOST_INSTANCES} shapes of instances", directive.mark, ("ObjectInstance",)
                    )
                with self.kept_problem():
                    self._shape(parameters, replace(state, lamp=None), self.state.at)
        elif directive.name == "ObjectBegin":
            if self.object is not None:
                raise Malformed("must not stand in another object", directive.mark, (directive.name,))
            self.object = self.objects[directive.strings[0]] = []
            self.kept.append(self.state)
        else:
            if self.object is None or not self.kept:
                raise Malformed("must end an ObjectBegin, got none open", directive.mark, (directive.name,))
            self.object, self.state = None, self.kept.pop()

    def _head(self, directive: Directive) -> None:
        name = directive.name
        if name == "WorldBegin":
            self.world = True
            if "Camera" in self.head and camera.is_mirrored(self.seen_from):
                self.outer = MIRROR
            self.state, self.systems["world"] = _State(defaults=self.state.defaults), IDENTITY
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
        if directive.name in ("AttributeBegin", "TransformBegin"):
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
            self.shelf.put(self._given(directive))
        elif directive.name == "NamedMaterial":
            if given not in self.named:
                raise parameters.wrong("", f"must be a material given before, got {printable(given)}")
            self.state = replace(self.state, surface=self.named[given])
        elif directive.name == "MakeNamedMaterial":
            if given in self.named:
                first = self.named[given].mark.line
                raise parameters.wrong("", f"must have a name of its own, got {printable(given)} as on line {first}")
            parameters = self._given(directive)
            kind = parameters.word("type", "")
            name = _NO_LETTER.sub("_", given)[:MAX_PART_NAME]
            self.named[given] = materials.surface(parameters, kind, name if name[:1].isalpha() else "", self.shelf)
        else:
            told = self.told.pop("materials", "")
            parameters = self._given(directive)
            self.state = replace(self.state, surface=materials.surface(parameters, given, told, self.shelf))

    def _light(self, parameters: Parameters) -> None:
        entry, marks = lights.light(parameters, self.state.at.inside(self.outer), self.shelf)
        self._put("lights", entry, parameters.mark, marks)

    def _shape(self, parameters: Parameters, state: _State, instance: Transform) -> None:
        """Put a shape into the scene: where it stood in its object, in an instance of that."""
        surface = state.surface
        own = state.at.inside(instance)
        entry, cell = shapes.shape(parameters, own.inside(self.outer), surface.texture, self.shelf, state.turned)
        entry["material"] = self._material(surface, materials.entry_of(surface, cell))
        self._put("shapes", entry, parameters.mark, {"radius": parameters.where("radius")})
        if state.lamp is not None:
            round_one = entry["type"] in ("sphere", "cylinder")
            if (round_one and state.turned) or (entry["type"] in ("disk", "cylinder") and own.mirrors):
                raise parameters.wrong(
                    "", "must not emit behind ReverseOrientation or a mirroring, which turn the side that shines"
                )
            lamp, mark = state.lamp
            self._put("lights", {**lamp, "shape": self.data["shapes"][-1]["name"]}, mark, {})

    def _material(self, surface: materials.Surface, entry: dict[str, Any]) -> str:
        """The name under which a material stands among those of the scene; same ones without a name are one."""
        have = self.data["materials"]
        name = surface.name or next((name for name, other in have.items() if other == entry), "")
        count = len(have) + 1
        while not name or have.get(name, entry) != entry:
            name, count = f"material{count}", count + 1
        have[name] = entry
        self.marks.setdefault(("materials", name), surface.mark)
        return name

    def _named(self, key: str, entry: dict[str, Any]) -> dict[str, Any]:
        """An entry with the name that it or a comment says, or by number where another part has that."""
        name = entry.get("name") or self.told.pop(key, "")
        if not name or f"{key} {name}" in self.names:
            name = f"{key[:-1]}-{len(self.data[key]) + 1}"
        self.names.add(f"{key} {name}")
        return {**entry, "name": name}

    def _put(self, key: str, entry: dict[str, Any], mark: Mark, marks: dict[str, Mark]) -> None:
        """Append to a list of parts."""
        entry = self._named(key, entry)
        path: Path = (key, len(self.data[key]))
        self.marks[path] = mark
        for key_of_entry in entry:
            self.marks[(*path, key_of_entry)] = marks.get(key_of_entry, mark)
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
        if "Camera" not in self.head and all(problem.path[:1] != ("Camera",) for problem in self.problems):
            self._lacks('must be "perspective", got none', "Camera")
        size, notes, filtered = camera.DEFAULT_SIZE, dict[str, None](), dict[str, Any]()
        with self.kept_problem():
            filtered = camera.pixel_filter(self.head.get("PixelFilter"))
        with self.kept_problem():
            size = camera.film(self.head.get("Film"), notes)
        with self.kept_problem():
            bounces = camera.integrator(self.head.get("Integrator"))
            self.data["bounces"] = 0 if bounces is None else bounces
            if bounces is None:
                self.data["materials"] = dict.fromkeys(self.data["materials"], _BLACK)
        if "Camera" in self.head:
            with self.kept_problem():
                at = self.seen_from.after(self.outer)
                self.data["camera"] = camera.camera(self.head["Camera"], at, size, notes)
        for field_name, name in (("bounces", "Integrator"), ("camera", "Camera"), ("film", "Film")):
            if name in self.head:
                self.marks[(field_name,)] = self.head[name].mark
        notes |= self.shelf.notes
        self.data["film"] = {"width": int(size[0]), "height": int(size[1]), **filtered}
        if notes:
            self.data["film"]["notes"] = "; ".join(notes)
        if self.problems:
            self.data = _NOTHING_MISSING | self.data

    def _lacks(self, message: str, name: str) -> None:
        self.problems.append(Problem((name,), message, Mark(1, 1)))


def _refuse_old(directive: Directive) -> None:
    """Raise _Old for what only versions before 4 write."""
    name = directive.name
    if name in ("Material", "MakeNamedMaterial"):
        given = directive.parameters.get("type")
        kind = directive.strings[0] if name == "Material" else given.strings[0] if given and given.strings else ""
        if kind in _OLD_MATERIALS:
            raise _Old(f'Material "{kind}"', directive.mark)
    for parameter in directive.parameters.values():
        if parameter.type == "color":
            raise _Old(f'parameter "color {printable(parameter.name)}"', parameter.mark)


def parse_pbrt(text: str, origin: str, opener: Opener | None = None) -> Document:
    """The scene of a pbrt file as plain data, with which directives have no meaning here, and why.

    ``opener`` opens files that it includes or names; without it they lie in its folder. Unreadable where the text ends
    before the scene does, as far as it can be read.
    """
    reader = _Reader(origin, opener or within(origin))
    try:
        reader.file(text, "", 0)
    except _Old as old:
        what, mark = old.args
        raise Unreadable(f"must be a file of pbrt-v4, got one of an earlier version by its {what}; "
                         "`pbrt --upgrade` writes it anew", mark) from None  # fmt: skip
    except Unreadable as error:
        error.others = reader.problems
        raise
    reader.end()
    return Document(reader.data, origin, reader.marks, problems=grouped(reader.problems))
