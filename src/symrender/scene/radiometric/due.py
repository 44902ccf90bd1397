"""What the language of radiometric scenes has and nothing renders yet: refused by name where it is read or asked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from pydantic_core import PydanticCustomError

from symrender.errors import Unsupported

SHAPES_DUE: Final = ("rectangle", "triangle", "disk", "box")


def not_yet(kinds: tuple[str, ...], known: str, limit: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Validator of a list, after ``limit``: refuses entries of ``kinds``, which are due, and names the ``known``."""

    def check(value: Any) -> Any:
        value = limit(value)
        for index, entry in enumerate(value if isinstance(value, tuple) else ()):
            kind = entry.get("type") if isinstance(entry, Mapping) else None
            if kind in kinds:
                context = {"path": (index, "type")}
                raise PydanticCustomError("scene", f"{kind} is not yet rendered, known are {known}", context)
        return value

    return check


def refuse_bounces(bounces: int | str, reason: str) -> None:
    """Raise ``Unsupported`` where more light is asked of what has no noise than it integrates.

    ``reason`` is what of the scene keeps one bounce from being integrated, empty if nothing does.
    """
    if bounces == 0 or (bounces == 1 and not reason):
        return
    words = f" in a scene with {reason}" if reason and bounces == 1 else ""
    raise Unsupported(
        f"bounces: {bounces} is not yet integrated{words}; 0 (emission and direct light) is, 1 is between diffuse, "
        "ggx and phong surfaces under point and directional lights, and the numeric pipeline samples any"
    )
