"""Image files that a scene names: their bytes, kept in the scene as text, and the pixels that these hold."""

from __future__ import annotations

import base64
import binascii
import hashlib
from functools import lru_cache
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

from symrender.errors import ImageError, SceneError
from symrender.limits import MAX_PICTURE_BYTES, MAX_PICTURE_PIXELS
from symrender.scene.document import Document, Path, Problem
from symrender.scene.files import Opener
from symrender.scene.printable import printable, shown

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

KINDS: Final = ("image", "environment")
"""Values of ``type`` of what holds an image file."""
_SHOWN: Final = 100


def with_pictures(document: Document, opener: Opener) -> tuple[Document, list[Problem]]:
    """The document with the bytes of image files in the place of their names, and what is wrong with these files."""
    problems: list[Problem] = []

    def read(value: Any, path: Path) -> Any:
        if isinstance(value, list):
            return [read(entry, (*path, index)) for index, entry in enumerate(value)]
        if not isinstance(value, dict):
            return value
        if value.get("type") in KINDS and value.get("file", "") != "":
            return _read(value, path, opener, problems)
        return {key: read(entry, (*path, key)) for key, entry in value.items()}

    data = dict(document.data)
    for part in ("materials", "lights"):
        if part in data:
            data[part] = read(data[part], (part,))
    return Document(data, document.origin, document.marks, document.labels, document.problems), problems


def _read(value: dict[str, Any], path: Path, opener: Opener, problems: list[Problem]) -> dict[str, Any]:
    """A texture or a light with the content of its file."""
    name, rest = value["file"], {key: entry for key, entry in value.items() if key != "file"}
    if not isinstance(name, str):
        problems.append(Problem((*path, "file"), f"must be text, got {shown(name)}"))
    elif "data" in rest:
        problems.append(Problem((*path, "file"), "an image has a file, or data, got both"))
    else:
        try:
            rest["data"] = read_picture(name, opener)
        except SceneError as error:
            problems.append(Problem((*path, "file"), str(error)))
    return rest


def read_picture(name: str, opener: Opener) -> str:
    """The bytes of an image file as text in base64; SceneError names the file and what is wrong with it."""
    origin = printable(PurePath(name).as_posix(), _SHOWN)
    data = opener(name, MAX_PICTURE_BYTES + 1)
    if len(data) > MAX_PICTURE_BYTES:
        raise SceneError(f"{origin}: an image file may hold at most {MAX_PICTURE_BYTES} bytes")
    text = base64.b64encode(data).decode("ascii")
    try:
        picture(text)
    except ImageError as error:
        raise SceneError(f"{origin}: {error}") from None
    return text


def content(data: str) -> bytes:
    """The bytes of an image file, of their text in base64; ImageError where it is none."""
    try:
        return base64.b64decode(data.encode("ascii"), validate=True)
    except (UnicodeEncodeError, binascii.Error):
        raise ImageError("must be the bytes of an image file in base64") from None


def digest(data: str) -> str:
    """SHA-256 of an image file, of its bytes' text in base64."""
    return hashlib.sha256(content(data)).hexdigest()


@lru_cache(maxsize=4)
def picture(data: str) -> tuple[Array, bool]:
    """Pixels (h, w, 3) of an image file and whether they are sRGB codes, of its bytes' text in base64."""
    from symrender.images.texels import texels

    return texels(content(data), MAX_PICTURE_PIXELS)
