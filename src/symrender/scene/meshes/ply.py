"""Stanford PLY, text and binary, through plyfile."""

from __future__ import annotations

import io
import math
import re
import warnings
from typing import Any, Final

from symrender.errors import SceneError, remedy
from symrender.limits import MAX_TRIANGLES
from symrender.scene.meshes.net import BadMesh, Net
from symrender.scene.printable import printable

_HEADER: Final = 1 << 14
"""Bytes within which a header has to end."""
_ELEMENT: Final = re.compile(rb"[ \t]*element[ \t]+(\S+)[ \t]+(\S+)[ \t]*\r?")
_COUNT: Final = re.compile(rb"[0-9]{1,9}")
_AXES: Final = ("x", "y", "z")
_LISTS: Final = ("vertex_indices", "vertex_index")


def read_ply(data: bytes) -> Net:
    """Vertices and faces of a PLY file; BadMesh with the line of its header, or the row of its element."""
    _check_header(data)
    try:
        import plyfile  # type: ignore[import-untyped]
    except ImportError:
        raise SceneError(f"a mesh in PLY is read by plyfile, which is not installed; {remedy('mesh')}") from None
    try:
        with warnings.catch_warnings():
            # what it only warns of, rows without numbers, is no mesh either
            warnings.simplefilter("error")
            file = plyfile.PlyData.read(io.BytesIO(data))
    except (plyfile.PlyParseError, ValueError, TypeError, OverflowError, Warning) as error:
        raise BadMesh(printable(str(error), 200)) from None
    elements = {element.name: element for element in file.elements}
    net = Net()
    for name in ("vertex", "face"):
        if name not in elements:
            raise BadMesh(f"must have an element '{name}', has {printable(', '.join(elements) or 'none', 100)}")
    _put_vertices(net, elements["vertex"])
    _put_faces(net, elements["face"])
    if not net.faces:
        raise BadMesh("element 'face': must have a row, got none")
    return net


def _check_header(data: bytes) -> None:
    """Refuse counts that no memory should be taken for, before plyfile takes it."""
    head, end, _ = data[:_HEADER].partition(b"end_header")
    if not end:
        raise BadMesh(f"must have a header that ends within {_HEADER} bytes")
    for number, line in enumerate(head.split(b"\n"), 1):
        match = _ELEMENT.fullmatch(line)
        if match is None:
            continue
        name = printable(match[1].decode("ascii", "replace"), 40)
        if not _COUNT.fullmatch(match[2]):
            raise BadMesh(f"{number}:1: element '{name}': must have a whole count of rows")
        if int(match[2]) > MAX_TRIANGLES and name in ("vertex", "face"):
            raise BadMesh(f"{number}:1: element '{name}': must have at most {MAX_TRIANGLES} rows, got {int(match[2])}")
        if int(match[2]) > len(data):
            raise BadMesh(f"{number}:1: element '{name}': has more rows than the file has bytes")


def _put_vertices(net: Net, element: Any) -> None:
    names = [each.name for each in element.properties]
    missing = [axis for axis in _AXES if axis not in names]
    if missing:
        raise BadMesh(f"element 'vertex': must have a property '{missing[0]}'")
    columns = [element.data[axis] for axis in _AXES]
    if any(column.dtype.kind not in "fiu" for column in columns):
        raise BadMesh("element 'vertex': x, y and z must be numbers, not lists")
    for row in range(len(columns[0])):
        place = [float(column[row]) for column in columns]
        if not all(map(math.isfinite, place)):
            raise BadMesh(f"element 'vertex': row {row}: must be finite numbers, got {place}")
        net.put_vertex(place, f"element 'vertex': row {row}")


def _put_faces(net: Net, element: Any) -> None:
    name = next((each.name for each in element.properties if each.name in _LISTS), None)
    if name is None:
        raise BadMesh(f"element 'face': must have a property '{_LISTS[0]}'")
    for row, listed in enumerate(element.data[name]):
        where = f"element 'face': row {row}"
        if getattr(listed, "dtype", None) is None or listed.dtype.kind not in "iu" or listed.ndim != 1:
            raise BadMesh(f"{where}: property '{name}': must be a list of whole numbers")
        corners = [int(k) for k in listed]
        wrong = next((k for k in corners if not 0 <= k < len(net.vertices)), None)
        if wrong is not None:
            raise BadMesh(f"{where}: must name some of the {len(net.vertices)} vertices, from 0, got {wrong}")
        net.put_face(corners, where)
