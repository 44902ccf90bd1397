"""Wavefront OBJ: vertices and faces of it, everything else of a surface passed over.

Ours and no library's because a message has to name line and column, and the lines of interest are two.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Final

from symrender.scene.meshes.net import NO_NORMALS, BadMesh, Net
from symrender.scene.printable import printable

_WORD: Final = re.compile(r"\S+")
_WHOLE: Final = re.compile(r"[+-]?[0-9]{1,9}")
_COORDINATES: Final = 3
_LINES: Final = re.compile(r"\r\n|\r|\n")
_PASSED_OVER: Final = frozenset((
    "vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p", "mg", "lod", "bevel",
    "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj",
))  # fmt: skip
"""What says nothing of where faces lie: texture coordinates, normals, names, materials, lines, points, attributes."""
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
    smooth = False
    for number, words in _statements(text):
        column, keyword = words[0]
        if keyword == "v":
            _put_vertex(net, words, number)
        elif keyword in ("f", "fo"):
            _put_face(net, words, number, ahead)
            smooth = smooth or any(word.count("/") == 2 and word[-1] != "/" for _, word in words[1:])
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
    if smooth:
        net.notes.append(NO_NORMALS)
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
    corners = []
    for column, word in words[1:]:
        whole = word.split("/", 1)[0]
        index = int(whole) if _WHOLE.fullmatch(whole) else 0
        # from 1, or from -1 backwards
        place = index - 1 if index > 0 else len(net.vertices) + index
        if index == 0 or place < 0:
            raise _no_vertex(net, f"{number}:{column}", word)
        if place >= len(net.vertices):
            ahead.append((place, f"{number}:{column}", word))
        corners.append(place)
    net.put_face(corners, f"{number}:{words[0][0]}")


def _no_vertex(net: Net, where: str, word: str) -> BadMesh:
    return BadMesh(f"{where}: must name one of the {len(net.vertices)} vertices, got '{_short(word)}'")


def _short(word: str) -> str:
    return printable(word, 40)
