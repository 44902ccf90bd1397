"""The scenes that come with symrender, by name."""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable


def _folder() -> Traversable:
    return resources.files("symrender.scene") / "gallery"


def names() -> tuple[str, ...]:
    """Names of the gallery scenes, in alphabetical order."""
    return tuple(sorted(f.name.removesuffix(".yaml") for f in _folder().iterdir() if f.name.endswith(".yaml")))


def text(name: str) -> str:
    """The YAML text of gallery scene ``name``; KeyError if there is none."""
    if name not in names():
        raise KeyError(name)
    return (_folder() / f"{name}.yaml").read_text(encoding="utf-8")
