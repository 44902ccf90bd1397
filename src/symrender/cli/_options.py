"""Arguments and options several verbs share, with their completions."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symrender.cli._completions import definitions, scene_names
from symrender.errors import OptionError, SceneError
from symrender.settings import Tonemap

if TYPE_CHECKING:
    from symrender.scene.load import AnyScene
    from symrender.scene.scene import Scene

IMAGES = (".exr", ".npz", ".png")
"""Endings of files that carry the scene they were made of."""
_SIZE = re.compile(r"([0-9]{1,10})(?:[xX]([0-9]{1,10}))?")


SceneArgument = Annotated[
    str,
    typer.Argument(
        help="Gallery name, path of a .yaml, .toml, .json, Mitsuba .xml or .pbrt file, or an image of ours: its scene.",
        autocompletion=scene_names,
    ),
]
Define = Annotated[
    list[str] | None,
    typer.Option(
        "--define",
        "-D",
        metavar="NAME=VALUE",
        help="Change a scene value, repeatable: -D floor.lobe.exponent=64 -D 'camera.eye=[3, -3, 2]'. "
        "symrender params lists names and units.",
        autocompletion=definitions,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Force = Annotated[bool, typer.Option("--force", help="Replace existing files (never an input).")]

Exposure = Annotated[float, typer.Option("--exposure", help="Stops by which pictures are brightened; never values.")]
TonemapOption = Annotated[Tonemap, typer.Option("--tonemap", help="How pictures hold light beyond 1.")]


def any_scene_with(source: str, changes: list[str] | None) -> AnyScene:
    """The scene named ``source`` with ``-D`` changes applied; values are read as YAML, so 64, [3, -3, 2], eye.

    An image file that carries its scene is that scene.
    """
    from symrender.limits import MAX_ITEMS
    from symrender.scene.load import load_any, parse_any

    if Path(source).suffix.lower() in IMAGES:
        scene = parse_any(_recipe(source)[0], source, most=MAX_ITEMS)
    else:
        scene = load_any(source)
    return scene.replace(dict(_change(text) for text in changes)) if changes else scene


def scene_with(source: str, changes: list[str] | None, verb: str) -> Scene:
    """``any_scene_with`` of a scene in units of the series; Unsupported names ``verb`` where it is radiometric."""
    from symrender.scene.load import in_series

    return in_series(any_scene_with(source, changes), verb)


def settings_of(source: str) -> dict[str, Any]:
    """The settings an image file ``source`` was made with; none for any other scene."""
    return _recipe(source)[1] if Path(source).suffix.lower() in IMAGES else {}


def _recipe(source: str) -> tuple[str, dict[str, Any]]:
    from symrender.cli._console import native_output_hidden
    from symrender.errors import ImageError
    from symrender.images.image import read_image

    with native_output_hidden():
        image = read_image(source)
    try:
        return image.recipe()
    except ImageError as error:
        raise ImageError(f"{source}: {error}") from None


def scene_files(source: str) -> list[Path]:
    """The file ``source`` names, if it names one: an input no output may replace."""
    from symrender.scene import gallery

    return [] if source in gallery.all_names() else [Path(source)]


def parse_size(text: str) -> int | tuple[int, int]:
    """``512`` or ``640x480`` as ``size``; OptionError for anything else."""
    match = _SIZE.fullmatch(text)
    if match is None:
        raise OptionError(f"size: must be N or WxH in whole pixels, such as 512 or 640x480, got {text[:40]!r}")
    width, height = match.groups()
    return (int(width), int(height)) if height else int(width)


def _change(text: str) -> tuple[str, Any]:
    from symrender.scene.document import Malformed
    from symrender.scene.parse_yaml import parse_yaml

    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise OptionError(f"define: must be NAME=VALUE, such as floor.lobe.exponent=64, got {text[:60]!r}")
    if value.startswith("(") and value.endswith(")"):
        value = f"[{value[1:-1]}]"
    try:
        read = parse_yaml(value, name)
        problems = read.problems
    except Malformed as error:
        problems = [error.problem]
    if problems:
        raise SceneError(f"{name.strip()}: {problems[0].message}")
    return name.strip(), read.data
