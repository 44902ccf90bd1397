"""What every scene offers, whatever its units: its hash, its parameters, a changed copy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Protocol, Self

from pydantic import Field
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_NAME
from symrender.scene.canonical import scene_hash
from symrender.scene.parameters import Parameter, parameters
from symrender.scene.replace import replace
from symrender.scene.table import html
from symrender.scene.values import Part


class Root(Part):
    """Base of the scenes."""

    name: Annotated[str, Field(max_length=MAX_NAME, description="what files and pages call it")] = "scene"
    description: Annotated[str, Field(max_length=4000, description="a sentence for those who open it")] = ""

    @property
    def hash(self) -> str:
        """SHA-256 of the scene's values; see :func:`symrender.scene.canonical.scene_hash`."""
        return scene_hash(self)

    def parameters(self) -> tuple[Parameter, ...]:
        """Every real number of the scene; see :func:`symrender.scene.parameters.parameters`."""
        return parameters(self)

    def replace(self, changes: Mapping[str, object]) -> Self:
        """This scene with values changed by dotted name; see :func:`symrender.scene.replace.replace`."""
        return replace(self, changes)

    def _repr_html_(self) -> str:
        return html(self.name, self.parameters())


class Named(Protocol):
    """A part with a name."""

    @property
    def name(self) -> str:
        """What messages call it."""


def wrong(message: str, *path: str | int) -> PydanticCustomError:
    """The error of a whole scene that says where in it the fault is."""
    context: dict[str, Any] = {"path": path}
    return PydanticCustomError("scene", message, context)


def check_names(field: str, parts: Sequence[Named]) -> None:
    """Raise PydanticCustomError where two parts of a list share a name."""
    first: dict[str, int] = {}
    for index, part in enumerate(parts):
        if part.name in first:
            raise wrong(f"must be unique, {field}[{first[part.name]}] is '{part.name}' too", field, index, "name")
        first[part.name] = index
