"""What a shell offers behind an option: names of the scene the line holds so far."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Final

import typer

if TYPE_CHECKING:
    from symrender.scene.load import AnyScene

DEFAULT_SCENE: Final = "gloss"
Completion = Callable[[typer.Context, str], list[str]]


def scene_names(incomplete: str) -> list[str]:
    """Gallery scenes."""
    from symrender.scene import gallery

    return [name for name in gallery.all_names() if name.startswith(incomplete)]


def definitions(ctx: typer.Context, incomplete: str) -> list[str]:
    """Real numbers of the scene, as ``-D`` takes them."""
    return _starting(incomplete, (f"{name}=" for name in _numbers(ctx)))


def surfaces(ctx: typer.Context, incomplete: str) -> list[str]:
    """Surfaces of the scene."""
    from symrender.scene.scene import Scene

    scene = _scene(ctx)
    if not isinstance(scene, Scene):
        return []
    shapes = [*(f"spheres.{s.name}" for s in scene.spheres), *(f"planes.{p.name}" for p in scene.planes)]
    return _starting(incomplete, [*(["floor"] if scene.floor else []), *shapes])


def layers_of_file(ctx: typer.Context, incomplete: str) -> list[str]:
    """Layers of the image that the line names."""
    from symrender.errors import SymrenderError
    from symrender.images.image import read_image

    try:
        return _starting(incomplete, read_image([*ctx.args, ctx.params.get("file") or ""][0]).layers)
    except SymrenderError:
        return []


def numbers(ctx: typer.Context, incomplete: str) -> list[str]:
    """Real numbers and vectors of the scene, separated by commas."""
    found = _numbers(ctx)
    vectors = dict.fromkeys(name[:-2] for name in found if name[-2:] in (".x", ".y", ".z", ".r", ".g", ".b"))
    return _listed(incomplete, [*vectors, *found])


def ranges(ctx: typer.Context, incomplete: str) -> list[str]:
    """Real numbers of the scene, as ``--over`` takes them, separated by commas."""
    return _listed(incomplete, [f"{name}=" for name in _numbers(ctx)])


def one_of(names: Iterable[str]) -> Completion:
    """Fixed names, separated by commas."""
    known = tuple(names)
    return lambda ctx, incomplete: _listed(incomplete, known)


def _listed(incomplete: str, names: Iterable[str]) -> list[str]:
    before, comma, last = incomplete.rpartition(",")
    taken = before.split(",")
    return [f"{before}{comma}{name}" for name in _starting(last, names) if name not in taken]


def _starting(incomplete: str, names: Iterable[str]) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


def _scene(ctx: typer.Context) -> AnyScene | None:
    from symrender.errors import SymrenderError
    from symrender.scene.load import load_any

    # while a line is being completed, its positional words are still unparsed
    words = [*ctx.args, ctx.params.get("scene") or DEFAULT_SCENE]
    try:
        return load_any(words[0])
    except SymrenderError:
        return None


def _numbers(ctx: typer.Context) -> list[str]:
    scene = _scene(ctx)
    return [p.name for p in scene.parameters()] if scene else []
