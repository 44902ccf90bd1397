"""A scene file of another renderer as a file of our own: YAML, with the meshes and images that it names next to it."""

from __future__ import annotations

import os
from pathlib import Path, PurePath
from typing import Any, Final

from symrender.errors import SceneError
from symrender.limits import MAX_MESH_BYTES
from symrender.scene.document import Document
from symrender.scene.dump import yaml_lines
from symrender.scene.files import Opener, within
from symrender.scene.load import FOREIGN, document_of, load_any

_INLINE: Final = 64
"""Most triangles of a mesh that stands in the YAML itself."""


def converted(
    source: str | os.PathLike[str], folder: str, *, allow_outside: bool = False
) -> tuple[str, dict[str, bytes]]:
    """The YAML of a file of Mitsuba or pbrt, and the files that it names, by their place next to it.

    Parameters
    ----------
    source : str or path
        The ``.xml`` or ``.pbrt`` file, which must load.
    folder : str
        Name of the folder next to the YAML that the files go to.
    allow_outside : bool
        Let it name files outside its own folder.

    Returns
    -------
    (str, dict)
        Text, and bytes by path.

    Raises
    ------
    SceneError
        The file does not load, or is none of another renderer.
    """
    path = os.fspath(source)
    if PurePath(path).suffix.lower() not in FOREIGN:
        raise SceneError(f"{path}: must be a file ending in {' or '.join(FOREIGN)}")
    load_any(path, allow_outside=allow_outside)
    opener = within(path, allow_outside)
    document: Document = document_of(path, allow_outside)
    files: dict[str, bytes] = {}
    names: dict[str, str] = {}

    def kept(name: str) -> str:
        """Copy a file next to the YAML, under a name of its own."""
        if name not in names:
            base, count = PurePath(name).name, 1
            while f"{folder}/{base}" in files:
                base, count = f"{count}-{PurePath(name).name}", count + 1
            names[name] = f"{folder}/{base}"
            files[names[name]] = _whole(opener, name)
        return names[name]

    def told(value: Any) -> Any:
        if isinstance(value, list):
            return [told(entry) for entry in value]
        if not isinstance(value, dict):
            return value
        made = {key: told(entry) for key, entry in value.items()}
        if isinstance(made.get("file"), str) and made["file"]:
            made["file"] = kept(made["file"])
        elif made.get("type") == "mesh" and len(made.get("faces", ())) > _INLINE:
            made = _apart(made, folder, files)
        return made

    data = {key: told(entry) for key, entry in document.data.items()}
    text = "\n".join([f"# made of {PurePath(path).name}", *yaml_lines(data)]) + "\n"
    return text, files


def _whole(opener: Opener, name: str) -> bytes:
    return opener(name, 8 * MAX_MESH_BYTES)


def _apart(mesh: dict[str, Any], folder: str, files: dict[str, bytes]) -> dict[str, Any]:
    """A mesh in a PLY file of its own."""
    columns = ["x", "y", "z"]
    rows = [list(row) for row in mesh["vertices"]]
    for field, names in (("normals", ("nx", "ny", "nz")), ("uv", ("u", "v"))):
        if field in mesh:
            columns += names
            rows = [[*row, *more] for row, more in zip(rows, mesh[field], strict=True)]
    head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *(f"property double {name}" for name in columns)]
    head += [f"element face {len(mesh['faces'])}", "property list uchar int vertex_indices", "end_header"]
    body = [" ".join(repr(float(x)) for x in row) for row in rows]
    body += [f"3 {a} {b} {c}" for a, b, c in mesh["faces"]]
    name = f"{folder}/{mesh['name']}.ply"
    files[name] = ("\n".join([*head, *body]) + "\n").encode("ascii")
    kept = {key: value for key, value in mesh.items() if key not in ("vertices", "faces", "normals", "uv")}
    return kept | {"file": name, "vertex_normals": "file" if "normals" in mesh else "none"}


def write_converted(source: str, target: str, *, allow_outside: bool = False) -> list[Path]:
    """Write what ``converted`` returns to the YAML file ``target`` and next to it; the paths written."""
    path = Path(target)
    text, files = converted(source, f"{path.stem}_files", allow_outside=allow_outside)
    written = [path]
    for name, data in files.items():
        place = path.parent / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(data)
        written.append(place)
    path.write_text(text, encoding="utf-8")
    return written
