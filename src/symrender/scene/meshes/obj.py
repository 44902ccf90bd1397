"""Wavefront OBJ: vertices and faces of it, everything else of a surface passed over.

Ours and no library's because a message has to name line and column, and the lines of interest are two.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Final

from symrender.scene.meshes.net import BadMesh, Net
from symrender.scene.printable import printable

_WORD: Final = re.compile(r"\S+")
_WHOLE: Final = re.compile(r"[+-]?[0-9]{1,9}")
_COORDINATES: Final = 3
_PASSED_OVER: Final = frozenset(("vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p", "mg", "lod", "bevel"))
"""What says nothing of where faces lie: texture coordinates, shading normals, names, materials, lines and points."""


def read_obj(text: str) -> Net:
    """Vertices and faces of an OBJ file; BadMesh with line and column for what is malformed or not polygons."""
    net = Net()
    for number, words in _statements(text):
        column, keyword = words[0]
        where = f"{number}:{column}"
        if keyword == "v":
            _put_vertex(net, words, number)
        elif keyword == "f":
            _put_face(net, words, number)
        elif keyword not in _PASSED_OVER:
            raise BadMesh(f"{where}: must be a statement of polygons (v, f, vt, vn, g, o, s), got '{_short(keyword)}'")
    if not net.faces:
        raise BadMesh("1:1: must hold a face, got none")
    return net


def _statements(text: str) -> Iterator[tuple[int, list[tuple[int, str]]]]:
    """Line number and (column, word) of every line that says something; a backslash joins a line to the next."""
    words: list[tuple[int, str]] = []
    first, joined = 1, False
    for number, line in enumerate(text.split("\n"), 1):
        if not joined:
            words, first = [], number
        content = line.rstrip("\r").split("#", 1)[0].rstrip()
        joined = content.endswith("\\")
        words += [(match.start() + 1, match[0]) for match in _WORD.finditer(content.removesuffix("\\"))]
        if words and not joined:
            yield first, words
    if words and joined:
        yield first, words


def _put_vertex(net: Net, words: list[tuple[int, str]], number: int) -> None:
    if len(words) - 1 < _COORDINATES:
        raise BadMesh(f"{number}:{words[0][0]}: a vertex must have 3 coordinates, got {len(words) - 1}")
    place = []
    for column, word in words[1 : 1 + _COORDINATES]:
        try:
            # float() also reads 1_000, which no OBJ writes
            value = float(word) if "_" not in word else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise BadMesh(f"{number}:{column}: must be a finite number, got '{_short(word)}'")
        place.append(value)
    net.put_vertex(place, f"{number}:{words[0][0]}")


def _put_face(net: Net, words: list[tuple[int, str]], number: int) -> None:
    corners = []
    for column, word in words[1:]:
        whole = word.split("/", 1)[0]
        index = int(whole) if _WHOLE.fullmatch(whole) else 0
        # from 1, or from -1 backwards
        place = index - 1 if index > 0 else len(net.vertices) + index
        if index == 0 or not 0 <= place < len(net.vertices):
            known = f"one of the {len(net.vertices)} vertices before it"
            raise BadMesh(f"{number}:{column}: must name {known}, got '{_short(word)}'")
        corners.append(place)
    net.put_face(corners, f"{number}:{words[0][0]}")


def _short(word: str) -> str:
    return printable(word, 40)
