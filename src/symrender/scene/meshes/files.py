"""The files that meshes of a scene name: read where the scene is loaded, in whose place vertices and faces stand."""

from __future__ import annotations

import codecs
from collections.abc import Callable
from pathlib import PurePath
from typing import Any, Final

from symrender.errors import SceneError
from symrender.limits import MAX_MESH_BYTES
from symrender.scene.document import Document, Problem
from symrender.scene.meshes.net import BadMesh
from symrender.scene.meshes.obj import read_obj
from symrender.scene.meshes.ply import read_ply
from symrender.scene.printable import printable, shown
from symrender.scene.read import decoded, read_bytes

Opener = Callable[[str, int], bytes]
"""The first bytes of a file that a scene names, so many of them."""
_SHOWN: Final = 100


def beside(path: str) -> Opener:
    """Opens files as a scene at ``path`` names them: from its folder."""
    folder = PurePath(path).parent
    return lambda name, most: read_bytes(str(folder / name), most)


def read_mesh(name: str, opener: Opener, smooth: bool = False) -> dict[str, Any]:
    """Vertices, faces, coordinates and notes of the file ``name``, and its normals if the mesh is ``smooth``.

    SceneError names it and where in it the fault is.
    """
    origin = printable(name, _SHOWN)
    suffix = PurePath(name).suffix.lower()
    if suffix not in (".obj", ".ply"):
        raise SceneError(f"{origin}: must be a file ending in .obj or .ply")
    data = opener(name, MAX_MESH_BYTES + 1)
    if len(data) > MAX_MESH_BYTES:
        raise SceneError(f"{origin}: a mesh's file may hold at most {MAX_MESH_BYTES} bytes")
    try:
        fields = (read_ply(data) if suffix == ".ply" else read_obj(_text(data, origin))).fields(smooth)
    except BadMesh as error:
        mark = "" if str(error)[:1].isdigit() else " "
        raise SceneError(f"{origin}:{mark}{error}") from None
    return fields | ({"notes": f"{origin}: {fields['notes']}"} if "notes" in fields else {})


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
    changed = list(shapes)
    for index, shape in enumerate(shapes):
        if not _names_file(shape):
            continue
        path = ("shapes", index, "file")
        name, rest = shape["file"], {key: value for key, value in shape.items() if key != "file"}
        changed[index] = rest
        if not isinstance(name, str):
            problems.append(Problem(path, f"must be text, got {shown(name)}"))
        elif "vertices" in rest or "faces" in rest:
            problems.append(Problem(path, "a mesh has a file, or vertices and faces, got both"))
        else:
            try:
                changed[index] = rest | read_mesh(name, opener, rest.get("shading_normals") == "use")
            except SceneError as error:
                problems.append(Problem(path, str(error)))
    read = {**data, "shapes": changed}
    return Document(read, document.origin, document.marks, document.labels, document.problems), problems


def _names_file(shape: Any) -> bool:
    return isinstance(shape, dict) and shape.get("type") == "mesh" and shape.get("file", "") != ""
