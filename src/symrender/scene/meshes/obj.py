"""Wavefront OBJ: vertices and faces of it, with texture coordinates and normals; everything else is passed over.

As in Mitsuba the second texture coordinate is turned over: v of a file points up, v of an image down.

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
_LINES: Final = re.compile(r"\r\n|\r|\n")
_PASSED_OVER: Final = frozenset((
    "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p", "mg", "lod", "bevel",
    "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj",
))  # fmt: skip
"""What says nothing of faces: names, materials, lines, points, attributes."""
_REFUSED: Final = {
    **dict.fromkeys(("surf", "bzp", "bsp", "cdc", "cdp"), "a free-form surface is not read"),
    **dict.fromkeys(("call", "csh"), "nothing beside the file itself is opened"),
}
_NAMED: Final = 5
"""Most unknown statements that a note names."""


def read_obj(text: str) -> Net:
    """Vertices and faces of an OBJ file; BadMesh with line and column for what is malformed.

    A face may stand before its vertices. Statements that are not known are passed over, and a note names them.
    """
    net = Net()
    ahead: list[tuple[int, str, str]] = []
    unknown: dict[str, None] = {}
    for number, words in _statements(text):
        column, keyword = words[0]
        if keyword == "v":
            _put_vertex(net, words, number)
        elif keyword == "vt":
            u, v = _numbers(words, 2)
            # Mitsuba's images begin at their upper rows
            net.put_beside("uv", [u, 1.0 - v], f"{number}:{column}")
        elif keyword == "vn":
            net.put_beside("normals", _numbers(words, 3), f"{number}:{column}")
        elif keyword in ("f", "fo"):
            _put_face(net, words, number, ahead)
        elif keyword in _REFUSED:
            raise BadMesh(f"{number}:{column}: {_short(keyword)}: {_REFUSED[keyword]}")
        elif keyword not in _PASSED_OVER:
            unknown[_short(keyword)] = None
    for place, where, word in ahead:
        if place >= len(net.vertices):
            raise _no_vertex(net, where, word)
    if not net.polygons:
        raise BadMesh("1:1: must hold a face, got none")
    if unknown:
        more = ", ..." if len(unknown) > _NAMED else ""
        net.notes.append(f"unknown statements are passed over: {', '.join(list(unknown)[:_NAMED])}{more}")
    return net


def _statements(text: str) -> Iterator[tuple[int, list[tuple[int, str]]]]:
    """Line number and (column, word) of every line that says something; a backslash joins a line to the next."""
    words: list[tuple[int, str]] = []
    first, joined = 1, False
    for number, line in enumerate(_LINES.split(text), 1):
        if not joined:
            words, first = [], number
        content = line.split("#", 1)[0].rstrip()
        joined = content.endswith("\\")
        words += [(match.start() + 1, match[0]) for match in _WORD.finditer(content.removesuffix("\\"))]
        if words and not joined:
            yield first, words
    if words and joined:
        yield first, words


def _numbers(words: list[tuple[int, str]], count: int) -> list[float]:
    """The first ``count`` numbers of a statement, 0 where it has fewer, NaN for what is no number."""
    found = [0.0] * count
    for k, (_, word) in enumerate(words[1 : 1 + count]):
        try:
            found[k] = float(word)
        except ValueError:
            found[k] = math.nan
    return found


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


def _put_face(net: Net, words: list[tuple[int, str]], number: int, ahead: list[tuple[int, str, str]]) -> None:
    """Add a face; corners that are not known yet go to ``ahead``, with where they stand and how they are written."""
    corners, coordinates, normals = [], [], []
    for column, word in words[1:]:
        whole, *others = word.split("/")
        index = int(whole) if _WHOLE.fullmatch(whole) else 0
        place = _place(index, len(net.vertices))
        if index == 0 or place < 0:
            raise _no_vertex(net, f"{number}:{column}", word)
        if place >= len(net.vertices):
            ahead.append((place, f"{number}:{column}", word))
        corners.append(place)
        if others and _WHOLE.fullmatch(others[0]):
            coordinates.append(_place(int(others[0]), len(net.uv)))
        if len(others) > 1 and _WHOLE.fullmatch(others[1]):
            normals.append(_place(int(others[1]), len(net.normals)))
    net.put_face(corners, f"{number}:{words[0][0]}")
    for name, named in (("uv", coordinates), ("normals", normals)):
        # a face of which some corners have none has none
        if len(named) == len(corners):
            net.beside[name][len(net.polygons) - 1] = named


def _place(index: int, known: int) -> int:
    """Place in a list of what is counted from 1, or from -1 backwards."""
    return index - 1 if index > 0 else known + index


def _no_vertex(net: Net, where: str, word: str) -> BadMesh:
    return BadMesh(f"{where}: must name one of the {len(net.vertices)} vertices, got '{_short(word)}'")


def _short(word: str) -> str:
    return printable(word, 40)
