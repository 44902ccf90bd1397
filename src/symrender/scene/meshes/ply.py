"""Stanford PLY, text and binary, through plyfile."""

from __future__ import annotations

import codecs
import io
import re
import tempfile
import warnings
from typing import Any, Final

from symrender.errors import SceneError, remedy
from symrender.limits import MAX_TRIANGLES
from symrender.scene.meshes.net import BadMesh, Net
from symrender.scene.printable import printable

_HEADER: Final = 1 << 16
"""Bytes within which a header has to end."""
_LINE: Final = re.compile(rb"([^\r\n]*)(\r\n|\r|\n)")
_COUNT: Final = re.compile(r"[0-9]{1,9}")
_FORMATS: Final = ("ascii", "binary_little_endian", "binary_big_endian")
_TYPES: Final = re.compile("u?(?:char|short|int|int8|int16|int32)|float|double|float32|float64")
_AXES: Final = ("x", "y", "z")
_NORMAL: Final = ("nx", "ny", "nz")
_COORDINATES: Final = (("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))
"""Names of texture coordinates; as in Mitsuba they are those of an image whose rows go down."""
_LARGE: Final = 1 << 20
"""Bytes from which on a file is read at once where that can be done."""
_LISTS: Final = ("vertex_indices", "vertex_index")


def read_ply(data: bytes) -> Net:
    """Vertices and faces of a PLY file; BadMesh with the line of its header, or the row of its element."""
    header, body = _parted(data)
    try:
        import plyfile  # type: ignore[import-untyped]
    except ImportError:
        raise SceneError(f"a mesh in PLY is read by plyfile, which is not installed; {remedy('mesh')}") from None
    try:
        with warnings.catch_warnings():
            # what it only warns of, rows without numbers, is no mesh either; a face without corners is told by its row
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")
            file = _of_triangles(plyfile, header, body) or plyfile.PlyData.read(io.BytesIO(header + body))
    except plyfile.PlyParseError as error:
        raise BadMesh(printable(str(error), 200)) from None
    except (ValueError, TypeError, OverflowError, Warning) as error:
        raise BadMesh(f"its rows cannot be read: {printable(str(error), 200)}") from None
    elements = {element.name: element for element in file.elements}
    net = Net()
    for name in ("vertex", "face"):
        if name not in elements:
            raise BadMesh(f"must have an element '{name}', has {printable(', '.join(elements) or 'none', 100)}")
    _put_vertices(net, elements["vertex"])
    _put_faces(net, elements["face"])
    if not net.polygons:
        raise BadMesh("element 'face': must have a row, got none")
    return net


def _of_triangles(plyfile: Any, header: bytes, body: bytes) -> Any:
    """What plyfile reads of a large binary file if all its faces are triangles, else None.

    It takes rows of one length from a file alone, and other rows one by one, which takes 15 s for 10^6 of them.
    """
    if len(body) < _LARGE or b"\nformat ascii" in header:
        return None
    with tempfile.TemporaryFile() as file:
        file.write(header + body)
        for name in _LISTS:
            file.seek(0)
            try:
                return plyfile.PlyData.read(file, known_list_len={"face": {name: 3}})
            except (plyfile.PlyParseError, ValueError):
                continue
    return None


def _parted(data: bytes) -> tuple[bytes, bytes]:
    """The header as plyfile takes it, in ASCII, without comments, and what follows it.

    Counts that no memory should be taken for are refused before plyfile takes it.
    """
    at = 3 if data.startswith(codecs.BOM_UTF8) else 0
    lines: list[str] = []
    ends: set[bytes] = set()
    number = 0
    while True:
        number += 1
        match = _LINE.match(data, at)
        if match is None or match.end() > _HEADER:
            raise BadMesh(f"must have a header that ends within {_HEADER} bytes")
        text, at = match[1].decode("ascii", "backslashreplace").strip(), match.end()
        if number == 1 and text != "ply":
            raise BadMesh(f"1:1: must begin with the line ply, got '{_short(text)}'")
        words = text.split()
        if number > 1 and words and words[0] not in ("comment", "obj_info"):
            _check_line(words, number, len(data))
        if not words or words[0] not in ("comment", "obj_info"):
            lines.append(" ".join(words))
        if text == "end_header":
            break
        ends.add(match[2])
    if match[2] == b"\r\n" and ends == {b"\r"}:
        at -= 1  # the first byte of what follows is \n
    body = data[at:]
    if any(line.startswith("format ascii") for line in lines):
        body = re.sub(rb"[ \t]*(?:\r\n|\r|\n)\s*", b"\n", body)
        if not body.isascii():
            row = next(k for k, line in enumerate(body.split(b"\n")) if not line.isascii())
            raise BadMesh(f"{number + 1 + row}:1: must be numbers, got bytes that are no ASCII")
    return "\n".join([*lines, ""]).encode("ascii"), body


def _check_line(words: list[str], number: int, size: int) -> None:
    """Refuse a line of a header that says nothing plyfile knows, or counts more rows than there may be."""
    match words:
        case ["end_header"]:
            return
        case ["format", kind, "1.0"] if kind in _FORMATS:
            return
        case ["property", kind, _] if _TYPES.fullmatch(kind):
            return
        case ["property", "list", length, kind, _] if _TYPES.fullmatch(length) and _TYPES.fullmatch(kind):
            return
        case ["element", name, count]:
            where = f"{number}:1: element '{_short(name)}'"
            if not _COUNT.fullmatch(count):
                raise BadMesh(f"{where}: must have a whole count of rows")
            if int(count) > MAX_TRIANGLES and name in ("vertex", "face"):
                raise BadMesh(f"{where}: must have at most {MAX_TRIANGLES} rows, got {int(count)}")
            if int(count) > size:
                raise BadMesh(f"{where}: has more rows than the file has bytes")
        case _:
            known = "format, comment, obj_info, element, property or end_header, as PLY writes them"
            raise BadMesh(f"{number}:1: must be {known}, got '{_short(' '.join(words))}'")


def _short(text: str) -> str:
    return printable(text, 40)


def _put_vertices(net: Net, element: Any) -> None:
    names = [each.name for each in element.properties]
    missing = [axis for axis in _AXES if axis not in names]
    if missing:
        raise BadMesh(f"element 'vertex': must have a property '{missing[0]}'")
    if len(element.data) > MAX_TRIANGLES:
        raise BadMesh(f"element 'vertex': a mesh may have at most {MAX_TRIANGLES} vertices")
    net.vertices = _columns(element, _AXES)
    coordinates = next((pair for pair in _COORDINATES if {*pair} <= {*names}), None)
    if coordinates:
        net.uv = _columns(element, coordinates)
    if {*_NORMAL} <= {*names}:
        net.normals = _columns(element, _NORMAL)


def _columns(element: Any, names: tuple[str, ...]) -> list[list[float]]:
    """Numbers of an element's rows."""
    import numpy as np

    columns = [element.data[name] for name in names]
    if any(column.dtype.kind not in "fiu" for column in columns):
        raise BadMesh(f"element 'vertex': {', '.join(names[:-1])} and {names[-1]} must be numbers, not lists")
    rows = np.stack([column.astype(np.float64) for column in columns], axis=1)
    wrong = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(wrong):
        row = int(wrong[0])
        raise BadMesh(f"element 'vertex': row {row}: must be finite numbers, got {rows[row].tolist()}")
    found: list[list[float]] = rows.tolist()
    return found


def _put_faces(net: Net, element: Any) -> None:
    name = next((each.name for each in element.properties if each.name in _LISTS), None)
    if name is None:
        raise BadMesh(f"element 'face': must have a property '{_LISTS[0]}'")
    rows = element.data[name]
    # of one length each; what is wrong is told below
    if rows.ndim == 2 and rows.min() >= 0 and rows.max() < len(net.vertices):
        for row, face in enumerate(rows.tolist()):
            net.put_face(face, f"element 'face': row {row}")
        return
    for row, listed in enumerate(rows):
        where = f"element 'face': row {row}"
        if getattr(listed, "dtype", None) is None or listed.ndim != 1 or (listed % 1 != 0).any():
            raise BadMesh(f"{where}: property '{name}': must be a list of whole numbers")
        corners = [int(k) for k in listed]
        wrong = next((k for k in corners if not 0 <= k < len(net.vertices)), None)
        if wrong is not None:
            raise BadMesh(f"{where}: must name some of the {len(net.vertices)} vertices, from 0, got {wrong}")
        net.put_face(corners, where)
