"""A Mitsuba scene as its objects: parameters put in, included files read, old names renamed, shared parts by their id.

Files of version 0.x write names in camelCase, which Mitsuba 3 renames as here.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Final

from symrender.errors import SceneError
from symrender.limits import MAX_FILE_BYTES
from symrender.scene.document import Malformed, Mark, Problem
from symrender.scene.files import Opener, found
from symrender.scene.mitsuba.xml_tree import Count, Element, parse_xml
from symrender.scene.printable import printable
from symrender.scene.read import decoded

MAX_INCLUDES: Final = 15
"""Most files inside each other, as Mitsuba has it."""
MAX_FILES: Final = 256
"""Most files that one scene includes."""
_CAMEL: Final = re.compile(r"(?<=[a-z0-9])([A-Z]+)")
_NOISE: Final = ("sample_count", "samples_per_pass", "seed")
"""What a file may leave to who renders it: the mean of an image does not depend on it."""
_PARAMETER: Final = re.compile(r"\$[A-Za-z_][A-Za-z0-9_]*")
_OLD: Final = (2, 0, 0)
_TEXTURE_SCALES: Final = ("uoffset", "voffset", "uscale", "vscale")


@dataclass
class Objects:
    """What a scene holds: its objects in order, those with an id, folders to look in, and what was wrong."""

    root: Element
    children: list[Element] = field(default_factory=list)
    shared: dict[str, Element] = field(default_factory=dict)
    folders: list[str] = field(default_factory=lambda: [""])
    problems: list[Problem] = field(default_factory=list)
    old: bool = False
    """Whether the scene is of version 0.x or 1.x."""


class _Expander:
    def __init__(self, opener: Opener) -> None:
        self.opener = opener
        self.count = Count()
        self.parameters: dict[str, str] = {}
        self.files = 0
        self.result: Objects

    def tree(self, text: str, file: str = "") -> Element:
        root = parse_xml(text, file, self.count)
        if _is_old(root):
            _rename(root)
        return root

    def walk(self, parent: Element, put: Callable[[Element], None], folder: str, depth: int) -> None:
        """Hand the objects in ``parent`` to ``put``; what is wrong with one does not hide the others."""
        for child in parent.children:
            try:
                self.one(child, put, folder, depth)
            except Malformed as error:
                self.result.problems += error.problems

    def one(self, child: Element, put: Callable[[Element], None], folder: str, depth: int) -> None:
        """Hand one object to ``put``, or what a directive stands for."""
        self.substitute(child)
        given = child.attributes
        match child.tag:
            case "default":
                name, value = _given(child, "name"), _given(child, "value")
                self.parameters.setdefault(name, value)
            case "path":
                self.result.folders.insert(0, _joined(folder, _given(child, "value")))
            case "include":
                self.include(child, put, folder, depth)
            case "alias":
                target, name = _given(child, "id"), _given(child, "as")
                if target not in self.result.shared:
                    raise Malformed(f"alias: nothing has the id {printable(target)} before it", child.mark)
                self.share(name, self.result.shared[target], child.mark)
            case _:
                kept: list[Element] = []
                inner = Element(child.tag, given, child.mark, comments=child.comments)
                self.walk(child, kept.append, folder, depth)
                inner.children = kept
                if "id" in given and child.tag != "ref":
                    self.share(given["id"], inner, child.mark)
                put(inner)

    def share(self, name: str, element: Element, mark: Mark) -> None:
        if name in self.result.shared:
            raise Malformed(f"id {printable(name)}: given twice", mark)
        self.result.shared[name] = element

    def substitute(self, element: Element) -> None:
        """Put parameters into the attributes."""
        for name, value in element.attributes.items():
            if "$" not in value:
                continue
            unknown = [each for each in _PARAMETER.findall(value) if not self._known(each[1:])]
            if unknown and element.attributes.get("name") in _NOISE:
                value, unknown = "1", []
            if unknown:
                raise Malformed(f"{element.tag}: no default says what {printable(unknown[0])} is", element.mark)
            for known in sorted(self.parameters, key=len, reverse=True):
                value = value.replace(f"${known}", self.parameters[known])
                if len(value) > MAX_FILE_BYTES:
                    raise Malformed(f"{element.tag}: {name} is too long", element.mark)
            element.attributes[name] = value

    def _known(self, name: str) -> bool:
        return any(name.startswith(known) for known in self.parameters)

    def include(self, child: Element, put: Callable[[Element], None], folder: str, depth: int) -> None:
        name = _given(child, "filename")
        self.files += 1
        if depth >= MAX_INCLUDES or self.files > MAX_FILES:
            most = f"{MAX_INCLUDES} files inside each other" if depth >= MAX_INCLUDES else f"{MAX_FILES} files"
            raise Malformed(f"include: a scene may include at most {most}", child.mark)
        try:
            path = found(name, [folder, *self.result.folders], self.opener)
            text = decoded(self.opener(path, MAX_FILE_BYTES + 1), path)
        except SceneError as error:
            raise Malformed(f"include: {error}", child.mark) from None
        root = self.tree(text, path)
        if root.tag == "scene":
            self.walk(root, put, str(PurePath(path).parent), depth + 1)
        else:
            self.one(root, put, str(PurePath(path).parent), depth + 1)


def expanded(text: str, opener: Opener) -> Objects:
    """The objects of a scene's text; Malformed where it is no scene at all."""
    expander = _Expander(opener)
    root = expander.tree(text)
    if root.tag != "scene":
        raise Malformed(f"must be a scene, got {printable(root.tag)}", root.mark)
    expander.result = result = Objects(root, old=_is_old(root))
    expander.walk(root, result.children.append, "", 0)
    return result


def _joined(folder: str, name: str) -> str:
    return str(PurePath(folder) / name.replace("\\", "/"))


def _given(element: Element, name: str) -> str:
    if name not in element.attributes:
        raise Malformed(f"{element.tag}: needs {name}", element.mark)
    return element.attributes[name]


def _is_old(root: Element) -> bool:
    """Whether a file is of a version before 2."""
    words = root.attributes.get("version", "3").split(".")
    try:
        return tuple(map(int, words)) < _OLD
    except ValueError:
        return False


def _rename(element: Element) -> None:
    """Give an object of version 0.x, and all in it, the names of version 3."""
    if element.tag == "lookAt":
        element.tag = "lookat"
    name = element.attributes.get("name")
    if name is not None and element.tag != "default":
        element.attributes["name"] = _CAMEL.sub(lambda match: f"_{match[1].lower()}", name)
    for child in element.children:
        _rename(child)
    if element.tag == "texture":
        _make_to_uv(element)


def _make_to_uv(element: Element) -> None:
    """Put uscale, vscale, uoffset and voffset of a texture into a transform."""
    given = {child.attributes.get("name", ""): child for child in element.children}
    moved = {name: given[name].attributes.get("value", "") for name in _TEXTURE_SCALES if name in given}
    if not moved or "to_uv" in given:
        return
    mark = given[next(iter(moved))].mark
    scale = Element("scale", {"x": moved.get("uscale", "1"), "y": moved.get("vscale", "1")}, mark)
    move = Element("translate", {"x": moved.get("uoffset", "0"), "y": moved.get("voffset", "0")}, mark)
    element.children = [child for child in element.children if child.attributes.get("name") not in moved]
    element.children.append(Element("transform", {"name": "to_uv"}, mark, [scale, move]))
