"""The scenes that come with symrender, by name."""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable


def _folder() -> Traversable:
    return resources.files("symrender.scene") / "gallery"


def names() -> tuple[str, ...]:
    """Names of the gallery scenes in units of the series, in alphabetical order."""
    return _listed(_folder())


def radiometric_names() -> tuple[str, ...]:
    """Names of the radiometric gallery scenes, in alphabetical order."""
    return _listed(_folder() / "radiometric")


def all_names() -> tuple[str, ...]:
    """Names of all gallery scenes, those in units of the series first."""
    return names() + radiometric_names()


def text(name: str) -> str:
    """The YAML text of gallery scene ``name``; KeyError if there is none."""
    if name not in all_names():
        raise KeyError(name)
    folder = _folder() if name in names() else _folder() / "radiometric"
    return (folder / f"{name}.yaml").read_text(encoding="utf-8")


def mesh(name: str, most: int) -> bytes:
    """The first ``most`` bytes of a mesh's file in the gallery."""
    return (_folder() / "radiometric" / name).read_bytes()[:most]


def _listed(folder: Traversable) -> tuple[str, ...]:
    return tuple(sorted(f.name.removesuffix(".yaml") for f in folder.iterdir() if f.name.endswith(".yaml")))
