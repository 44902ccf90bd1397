"""Scenes from names, files, standard input and dicts."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.document import Document, Malformed, failure
from symrender.scene.parse_yaml import parse_yaml
from symrender.scene.plain import plain
from symrender.scene.scene import Scene
from symrender.scene.validate import scene_of


def parse(text: str, origin: str, suffix: str) -> Scene:
    """The scene in ``text``, read by the parser of ``suffix``; ``origin`` is what messages call it."""
    try:
        data, lines = parse_yaml(text)
    except Malformed as error:
        raise failure(Document(None, origin), [error.problem]) from None
    return scene_of(Document(data, origin, lines))


def load(source: Scene | str | os.PathLike[str] | Mapping[str, Any]) -> Scene:
    """The scene ``source`` names or holds."""
    if isinstance(source, Scene):
        return source
    if isinstance(source, Mapping):
        return scene_of(Document(plain(source)))
    if isinstance(source, str) and source in gallery.names():
        return parse(gallery.text(source), source, ".yaml")
    try:
        return parse(Path(source).read_text(encoding="utf-8"), str(source), ".yaml")
    except OSError as error:
        raise SceneError(f"{source}: cannot be read: {error.strerror}") from None
