"""Scenes from gallery names, files, standard input and dicts."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Mapping
from pathlib import PurePath
from typing import Any, Final

from symrender.errors import SceneError, Unsupported
from symrender.limits import MAX_FOREIGN_BYTES, MAX_KEYS
from symrender.scene import gallery
from symrender.scene.document import Document, Malformed, Mark, Problem, failure
from symrender.scene.files import Opener, beside, within
from symrender.scene.meshes.files import with_meshes
from symrender.scene.nearest import did_you_mean
from symrender.scene.parse_json import parse_json
from symrender.scene.parse_toml import parse_toml
from symrender.scene.parse_yaml import parse_yaml
from symrender.scene.pictures import with_pictures
from symrender.scene.plain import plain
from symrender.scene.printable import printable, shown
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.read import read_file, read_stdin
from symrender.scene.scene import Scene
from symrender.scene.validate import MOST_LISTED, validated

Parser = Callable[[str, str, Opener], Document]
"""The document of a text, its origin and what opens the files that it names."""


def _parse_mitsuba(text: str, origin: str, opener: Opener) -> Document:
    """``parse_mitsuba``, imported when a file asks for it: it needs NumPy, which loading does not."""
    from symrender.scene.mitsuba.read import parse_mitsuba

    return parse_mitsuba(text, origin, opener)


def _parse_pbrt(text: str, origin: str, opener: Opener) -> Document:
    """``parse_pbrt``, imported when a file asks for it, for the same reason."""
    from symrender.scene.pbrt.read import parse_pbrt

    return parse_pbrt(text, origin, opener)


_PARSERS: Final[Mapping[str, tuple[str, Parser]]] = {
    ".yaml": ("YAML", lambda text, origin, _: parse_yaml(text, origin)),
    ".yml": ("YAML", lambda text, origin, _: parse_yaml(text, origin)),
    ".json": ("JSON", lambda text, origin, _: parse_json(text, origin)),
    ".toml": ("TOML", lambda text, origin, _: parse_toml(text, origin)),
    ".xml": ("Mitsuba", _parse_mitsuba),
    ".pbrt": ("pbrt", _parse_pbrt),
}


FOREIGN: Final = (".xml", ".pbrt")
"""Files of other renderers, which open files in their own folder alone."""

AnyScene = Scene | RadiometricScene
Source = Scene | RadiometricScene | str | os.PathLike[str] | Mapping[str, Any]

_ROOTS: Final[Mapping[str, type[Scene] | type[RadiometricScene]]] = {"series": Scene, "radiometric": RadiometricScene}


def parse_any(
    text: str, origin: str, suffix: str = ".yaml", opener: Opener | None = None, most: int = MAX_KEYS
) -> AnyScene:
    """The scene in ``text``, of either units, read as the file ending ``suffix`` says.

    ``origin`` is what messages call it, ``opener`` opens files of meshes; without it they lie in the current folder.
    YAML may hold ``most`` keys and items. Raises SceneError, one line per problem, the first complete in itself.
    """
    language, parser = _PARSERS[suffix]
    opens = opener or beside("")
    try:
        document = parse_yaml(text, origin, most) if language == "YAML" else parser(text, origin, opens)
    except Malformed as error:
        problems = sorted(error.problems, key=lambda problem: problem.mark or Mark(0, 0))
        raise failure(Document(None, origin), problems[:MOST_LISTED], max(0, len(problems) - MOST_LISTED)) from None
    data = document.data
    if not isinstance(data, dict) or not data:
        read = "nothing" if data in (None, {}) else shown(data)
        wanted = f"must be a mapping with a camera, spheres and lights, got {read} (read as {language})"
        raise failure(Document(None, origin), [Problem((), wanted, document.marks.get((), Mark(1, 1)))])
    return _scene_of(document, opens)


def parse(text: str, origin: str, suffix: str = ".yaml", verb: str = "") -> Scene:
    """``parse_any`` of a scene in units of the series; others are refused as ``load`` refuses them."""
    return in_series(parse_any(text, origin, suffix), verb)


def _scene_of(document: Document, opener: Opener) -> AnyScene:
    """The scene a document describes, as its ``units`` say: series, which need not be said, or radiometric.

    ``opener`` opens the files that it names.
    """
    units = document.data.get("units", "series")
    root = _ROOTS.get(units) if isinstance(units, str) else None
    if root is None:
        raise failure(document, [Problem(("units",), f"must be {' or '.join(_ROOTS)}, got {shown(units)}")])
    if root is Scene and "units" in document.data:
        data = {key: value for key, value in document.data.items() if key != "units"}
        document = dataclasses.replace(document, data=data)
    document, problems = with_meshes(document, opener)
    if root is RadiometricScene:
        document, others = with_pictures(document, opener)
        problems += others
    if problems:
        raise failure(document, problems)
    return validated(root, document)


def _load_file(path: str, allow_outside: bool) -> AnyScene:
    suffix = PurePath(path).suffix.lower()
    if suffix not in _PARSERS:
        known = gallery.all_names()
        guess = did_you_mean(path, known) or f", known are {', '.join(known)}"
        endings = ", ".join(_PARSERS)
        raise SceneError(f"{printable(path, 100)}: neither a file ending in {endings} nor a gallery scene{guess}")
    if suffix in FOREIGN:
        return parse_any(read_file(path, MAX_FOREIGN_BYTES), path, suffix, within(path, allow_outside))
    return parse_any(read_file(path), path, suffix, beside(path))


def document_of(path: str, allow_outside: bool = False) -> Document:
    """What a file of another renderer says, as plain data that names the files of its meshes and images."""
    suffix = PurePath(path).suffix.lower()
    return _PARSERS[suffix][1](read_file(path, MAX_FOREIGN_BYTES), path, within(path, allow_outside))


def load_any(source: Source, *, allow_outside: bool = False) -> AnyScene:
    """Load and validate a scene.

    Parameters
    ----------
    source : str, path, mapping or scene
        Name of a gallery scene; file in YAML, TOML or JSON by its ending; a scene of Mitsuba 3 (``.xml``) or pbrt-v4
        (``.pbrt``); ``"-"`` for YAML from standard input; dict with the keys of a file; or a loaded scene.
    allow_outside : bool
        Let a file of Mitsuba or pbrt name files outside its own folder.

    Returns
    -------
    Scene or RadiometricScene
        The scene, frozen; ``replace`` changes numbers by dotted name.

    Raises
    ------
    SceneError
        ``scene.yaml:12:5: spheres[1].radius: must be > 0 and finite, got -1``; further faults follow, one a line.

    Notes
    -----
    Files are refused beyond 2 MiB, 32 levels or 100,000 keys and items, and YAML beyond plain data (tags, anchors,
    aliases, merge keys, several documents). Numbers are those of YAML 1.2, and finite.

    Examples
    --------
    >>> import symrender as sr
    >>> scene = sr.load("gloss").replace({"floor.lobe.exponent": 64})
    >>> scene.floor.lobe.exponent
    64.0
    """
    if isinstance(source, Scene | RadiometricScene):
        return source
    if isinstance(source, Mapping):
        return _scene_of(Document(plain(source)), beside(""))
    if isinstance(source, str):
        if source in gallery.all_names():
            return parse_any(gallery.text(source), source, opener=gallery.mesh)
        return parse_any(read_stdin(), "stdin") if source == "-" else _load_file(source, allow_outside)
    if isinstance(source, os.PathLike):
        path = os.fspath(source)
        return _load_file(path if isinstance(path, str) else os.fsdecode(path), allow_outside)
    raise SceneError(f"scene: must be a name, a path, a mapping or a Scene, got {shown(source)}")


def load(source: Source, verb: str = "") -> Scene:
    """``load_any`` of a scene in units of the series; ``Unsupported`` names ``verb`` where the scene is radiometric."""
    return in_series(load_any(source), verb)


def in_series(scene: AnyScene, verb: str = "") -> Scene:
    """``scene``, or ``Unsupported`` naming it and ``verb`` where it is radiometric."""
    if isinstance(scene, RadiometricScene):
        what = f"{verb}: does not know" if verb else "this does not know"
        known = "render, truth, probe along rays, gradient, hessian, fit and audit do"
        raise Unsupported(f"{what} radiometric scenes yet ({printable(scene.name)}); {known}")
    return scene
