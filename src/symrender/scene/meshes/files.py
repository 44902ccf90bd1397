"""The files that meshes of a scene name: read where the scene is loaded, in whose place vertices and faces stand."""

from __future__ import annotations

import codecs
import zlib
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any, Final

from symrender.errors import SceneError
from symrender.limits import MAX_MESH_BYTES
from symrender.scene.document import Document, Problem
from symrender.scene.files import Opener
from symrender.scene.meshes.net import BadMesh, Net
from symrender.scene.meshes.obj import read_obj
from symrender.scene.meshes.placing import PLACING, checked, placed
from symrender.scene.meshes.ply import read_ply
from symrender.scene.printable import printable, shown
from symrender.scene.read import decoded

_SHOWN: Final = 100
_SUFFIXES: Final = (".obj", ".ply", ".serialized")


def read_mesh(
    name: str, opener: Opener, how: Mapping[str, Any] | None = None, known: dict[Any, dict[str, Any]] | None = None
) -> dict[str, Any]:
    """Vertices, faces and notes of the file ``name``, read as ``how`` says.

    ``known`` keeps what files hold, for shapes that name the same. SceneError names the file and where in it the fault
    is.
    """
    told = how or {}
    checked(told)
    suffix = f".{told['format']}" if "format" in told else PurePath(name).suffix.lower()
    key = (name, suffix, told.get("part", 0), told.get("vertex_normals", "none") != "none")
    fields = (known or {}).get(key)
    if fields is None:
        fields = _read(name, opener, suffix, told)
        if known is not None:
            known[key] = fields
    return placed(fields, told)


def _read(name: str, opener: Opener, suffix: str, how: Mapping[str, Any]) -> dict[str, Any]:
    origin = printable(name, _SHOWN)
    if suffix not in _SUFFIXES:
        raise SceneError(f"{origin}: must be a file ending in {', '.join(_SUFFIXES[:-1])} or {_SUFFIXES[-1]}")
    data = opener(name, MAX_MESH_BYTES + 1)
    if len(data) > MAX_MESH_BYTES:
        raise SceneError(f"{origin}: a mesh's file may hold at most {MAX_MESH_BYTES} bytes")
    data = unzipped(data, origin, MAX_MESH_BYTES)
    try:
        smooth = how.get("vertex_normals", "none") != "none"
        fields = _net(data, suffix, origin, how).fields(smooth)
    except BadMesh as error:
        mark = "" if str(error)[:1].isdigit() else " "
        raise SceneError(f"{origin}:{mark}{error}") from None
    return fields | ({"notes": f"{origin}: {fields['notes']}"} if "notes" in fields else {})


def _net(data: bytes, suffix: str, origin: str, how: Mapping[str, Any]) -> Net:
    if suffix == ".serialized":
        from symrender.scene.meshes.serialized import read_serialized

        return read_serialized(data, how.get("part", 0))
    return read_ply(data) if suffix == ".ply" else read_obj(_text(data, origin))


def unzipped(data: bytes, origin: str, most: int) -> bytes:
    """The bytes of a file that gzip packed, as pbrt reads .ply.gz, or those given."""
    if not data.startswith(b"\x1f\x8b"):
        return data
    try:
        inflater = zlib.decompressobj(wbits=31)
        whole = inflater.decompress(data, most + 1)
    except zlib.error as error:
        raise SceneError(f"{origin}: its deflated part is damaged: {error}") from None
    if len(whole) > most:
        raise SceneError(f"{origin}: may hold at most {most} bytes, unpacked")
    return whole


def _text(data: bytes, origin: str) -> str:
    """The text of an OBJ file; where it is not UTF-8 it is Latin-1, as only its names and comments tell these apart."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        if not data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            data = data.decode("latin-1").encode("utf-8")
    return decoded(data, origin, 2 * MAX_MESH_BYTES, "a mesh")


def with_meshes(document: Document, opener: Opener) -> tuple[Document, list[Problem]]:
    """The document with vertices and faces in the place of files of meshes, and what is wrong with these files."""
    data, problems = document.data, list[Problem]()
    shapes = data.get("shapes")
    if not isinstance(shapes, list) or not any(_names_file(shape) for shape in shapes):
        return document, problems
    changed, known = list(shapes), dict[Any, dict[str, Any]]()
    for index, shape in enumerate(shapes):
        if not _names_file(shape):
            continue
        path = ("shapes", index, "file")
        name, rest = shape["file"], {key: value for key, value in shape.items() if key not in ("file", *PLACING)}
        how = {key: shape[key] for key in PLACING if key in shape}
        if rest.get("shading_normals") == "use":
            how.setdefault("vertex_normals", "file")
        changed[index] = rest
        if not isinstance(name, str):
            problems.append(Problem(path, f"must be text, got {shown(name)}"))
        elif "vertices" in rest or "faces" in rest:
            problems.append(Problem(path, "a mesh has a file, or vertices and faces, got both"))
        else:
            try:
                changed[index] = rest | read_mesh(name, opener, how, known)
            except SceneError as error:
                problems.append(Problem(path, str(error)))
    read = {**data, "shapes": changed}
    return Document(read, document.origin, document.marks, document.labels, document.problems), problems


def _names_file(shape: Any) -> bool:
    return isinstance(shape, dict) and shape.get("type") == "mesh" and shape.get("file", "") != ""
